// Step by step in a CGAL triangulation of your own types: you ask for bad edges and their Steiner points, and you insert them.
//
// The triangulation has an info() at its vertices. Points near the hull are left out here: that is what refine's boundary rules are for.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <wellspaced/cgal.hpp>

#include <cmath>
#include <cstdio>
#include <random>

int main() {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Vertex = CGAL::Triangulation_vertex_base_with_info_3<char, Kernel>;  // 'i' input, 's' Steiner
    using Structure = CGAL::Triangulation_data_structure_3<Vertex, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
    using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, Structure>;
    using Point = Kernel::Point_3;

    std::mt19937 random(3);
    std::uniform_real_distribution<double> inside(-1.0, 1.0);
    Triangulation dt;
    for (int i = 0; i < 500; ++i) dt.insert(Point(inside(random), inside(random), inside(random)))->info() = 'i';

    // The cells that count: those with their centroid in the middle.
    const auto middle = [](const Triangulation::Cell_handle& c) {
        const Point p = CGAL::centroid(c->vertex(0)->point(), c->vertex(1)->point(), c->vertex(2)->point(), c->vertex(3)->point());
        return std::abs(p.x()) < 0.5 && std::abs(p.y()) < 0.5 && std::abs(p.z()) < 0.5;
    };
    const wellspaced::cgal::options options(1.5);
    const std::size_t before = wellspaced::cgal::bad_short_edges(dt, options.radius_edge, middle).size();
    std::size_t added = 0;
    for (int turn = 0; turn < 10000; ++turn) {
        const auto bad = wellspaced::cgal::bad_short_edges(dt, options.radius_edge, middle);
        if (bad.empty()) break;
        const Triangulation::Cell_handle near = bad.front().first;
        const auto hint = near->vertex(0);
        for (const Point& p : wellspaced::cgal::steiner_batch(dt, bad.front(), options)) {
            dt.insert(p, hint->cell())->info() = 's';
            ++added;
        }
    }
    const std::size_t after = wellspaced::cgal::bad_short_edges(dt, options.radius_edge, middle).size();
    std::printf("%zu bad edges in the middle, %zu points added, %zu bad edges left\n", before, added, after);
    return !(before > 0 && after == 0 && dt.is_valid());
}
