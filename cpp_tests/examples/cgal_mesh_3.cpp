// From CGAL's Mesh_3: a ball is meshed by it, and the space around the ball, up to a box, is filled with quality tetrahedra.
//
// Mesh_3 grades by a sizing field; here none is needed: tetrahedra grow away from the ball as fast as the bound allows.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>
#include <wellspaced/cgal.hpp>

#include <cstdio>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Mesh = CGAL::Mesh_complex_3_in_triangulation_3<CGAL::Mesh_triangulation_3<Domain>::type>;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel>;

int main() {
    namespace p = CGAL::parameters;
    const auto ball = [](const Kernel::Point_3& q) { return CGAL::squared_distance(q, Kernel::Point_3(CGAL::ORIGIN)) - 1; };
    const Domain domain = Domain::create_implicit_mesh_domain(ball, Kernel::Sphere_3(CGAL::ORIGIN, 4));
    const Mesh mesh = CGAL::make_mesh_3<Mesh>(
        domain, CGAL::Mesh_criteria_3<Mesh::Triangulation>(p::facet_angle = 25, p::facet_size = 0.3, p::facet_distance = 0.03,
                                                           p::cell_radius_edge_ratio = 2, p::cell_size = 0.4),
        p::no_perturb(), p::no_exude());

    // Mesh_3 keeps weighted points; without weights they are those of a Delaunay triangulation.
    Triangulation dt;
    for (auto v = mesh.triangulation().finite_vertices_begin(); v != mesh.triangulation().finite_vertices_end(); ++v)
        if (mesh.in_dimension(v) >= 0) dt.insert(v->point().point());
    const std::size_t from_mesh_3 = dt.number_of_vertices();
    for (int i = 0; i < 8; ++i) dt.insert({i & 1 ? 20. : -20., i & 2 ? 20. : -20., i & 4 ? 20. : -20.});

    const auto done = wellspaced::cgal::refine(dt, wellspaced::cgal::options(2));
    const std::size_t left = wellspaced::cgal::bad_short_edges(dt, 2).size();
    std::printf("%zu vertices from Mesh_3, %zu added, %zu cells up to the box, %zu bad edges left\n", from_mesh_3, done.inserted(),
                dt.number_of_finite_cells(), left);
    return !(from_mesh_3 > 50 && left == 0 && dt.is_valid());
}
