#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <wellspaced/cgal.hpp>

#include <cstdio>
#include <random>

int main() {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Triangulation = CGAL::Delaunay_triangulation_3<Kernel>;

    std::mt19937 random(7);
    std::uniform_real_distribution<double> inside(0.0, 1.0);
    Triangulation dt;
    for (int i = 0; i < 300; ++i) dt.insert({inside(random), inside(random), inside(random)});
    for (int i = 0; i < 8; ++i) dt.insert({i & 1 ? 2.0 : -1.0, i & 2 ? 2.0 : -1.0, i & 4 ? 2.0 : -1.0});

    wellspaced::cgal::report done = wellspaced::cgal::refine(dt);  // circumradius at most twice the shortest edge
    std::printf("%zu points added, %zu cells, %zu bad edges left\n", done.inserted(), dt.number_of_finite_cells(),
                wellspaced::cgal::bad_short_edges(dt, 2.0).size());
    return done.status;
}
