// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced/cgal/hull.hpp: convex hulls that no box is. Included by wellspaced/cgal.hpp.
///
/// A slanted facet can't hold new points exactly: they lie off its plane by rounding, the hull gets flat cells there, and its facets come apart
/// into triangles that meet at nearly 180 degrees. wellspaced's own kernel knows its facets whatever becomes of the hull. So there the
/// refinement of the hull is done by it, on the same points, and its Steiner points are inserted here, in the same order.

#ifndef WELLSPACED_CGAL_HULL_HPP
#define WELLSPACED_CGAL_HULL_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <unordered_set>
#include <vector>

#include "geometry.hpp"
#include "options.hpp"

namespace wellspaced {
namespace cgal {
namespace detail {

// Whether each facet of the hull is parallel to two axes: then new points are put on it exactly.
template <class Dt>
bool is_box_like(const Dt& dt) {
    std::vector<typename Dt::Cell_handle> outside;
    dt.incident_cells(dt.infinite_vertex(), std::back_inserter(outside));
    return std::all_of(outside.begin(), outside.end(), [&](typename Dt::Cell_handle c) {
        const int ghost = c->index(dt.infinite_vertex());
        const vec a = to_vec(c->vertex((ghost + 1) & 3)->point()), b = to_vec(c->vertex((ghost + 2) & 3)->point()),
                  d = to_vec(c->vertex((ghost + 3) & 3)->point());
        return (a[0] == b[0] && a[0] == d[0]) || (a[1] == b[1] && a[1] == d[1]) || (a[2] == b[2] && a[2] == d[2]);
    });
}

// The cells at the outside of the hull that are flat but for rounding: less high, or less wide, than the shortest edge may be.
template <class Dt>
std::unordered_set<const void*> flat_outside(const Dt& dt) {
    using cell = typename Dt::Cell_handle;
    std::unordered_set<const void*> flat;
    const double least = default_min_edge(dt);
    const auto is_flat = [&](cell c) {
        const corners p = corners_of(c);
        double widest = 0, longest = 0;
        for (int k = 0; k < 4; ++k) {
            const vec n = cross(p[(k + 2) & 3] - p[(k + 1) & 3], p[(k + 3) & 3] - p[(k + 1) & 3]);
            widest = (std::max)(widest, dot(n, n));
            for (int j = 0; j < k; ++j) longest = (std::max)(longest, squared_distance(p[j], p[k]));
        }
        const double volume = dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]), width = std::sqrt(widest);
        // Four on one segment have no plane that they could be high above.
        return std::abs(volume) < least * width || width < least * std::sqrt(longest);
    };
    std::vector<cell> outside;
    dt.incident_cells(dt.infinite_vertex(), std::back_inserter(outside));
    while (!outside.empty()) {
        const cell c = outside.back();
        outside.pop_back();
        for (int k = 0; k < 4; ++k) {
            const cell next = c->neighbor(k);
            if (!dt.is_infinite(next) && flat.count(&*next) == 0 && is_flat(next)) {
                flat.insert(&*next);
                outside.push_back(next);
            }
        }
    }
    return flat;
}

template <class Dt, class On_insert>
report refine_hull(Dt& dt, const options& o, On_insert& on_insert) {
    using vertex = typename Dt::Vertex_handle;
    struct free_mesh {
        void operator()(wsp_triangulation* t) const { wsp_triangulation_free(t); }
    };
    std::vector<double> xyz;
    for (auto v = dt.finite_vertices_begin(); v != dt.finite_vertices_end(); ++v) {
        const vec p = to_vec(v->point());
        xyz.insert(xyz.end(), p.begin(), p.end());
    }
    wsp_triangulation* made = nullptr;
    check(wsp_triangulation_new(nullptr, &made));
    const std::unique_ptr<wsp_triangulation, free_mesh> mesh(made);
    check(wsp_triangulation_insert(mesh.get(), xyz.data(), xyz.size() / 3, nullptr, nullptr));
    wsp_refine_options options;
    check(wsp_refine_options_init(&options, sizeof options));
    options.radius_edge = o.radius_edge;
    options.rule = o.rule;
    options.min_edge = o.min_edge;
    options.max_vertices = o.max_vertices;
    options.sparsify = WSP_SPARSIFY_OFF;
    wsp_report done;
    check(wsp_report_init(&done, sizeof done));
    const wsp_status status = wsp_refine(mesh.get(), &options, nullptr, &done);
    check(status);
    wsp_mesh_view view;
    check(wsp_mesh_view_init(&view, sizeof view));
    check(wsp_triangulation_view(mesh.get(), &view));
    wsp_boundary_view boundary;
    check(wsp_boundary_view_init(&boundary, sizeof boundary));
    check(wsp_triangulation_boundary(mesh.get(), nullptr, &boundary));

    report result;
    result.status = status;
    result.refused = done.bad;
    typename Dt::Cell_handle near = dt.infinite_vertex()->cell();
    for (std::size_t id = done.input_vertices; id < view.points_count; ++id) {
        const double* p = view.points + 3 * id;
        const vertex v = dt.insert(typename Dt::Point(p[0], p[1], p[2]), near);
        near = v->cell();
        const std::uint8_t kind = boundary.vertex_kinds[id];
        const origin from = kind == WSP_ON_SEGMENT ? WSP_ORIGIN_SEGMENT : kind == WSP_ON_FACET ? WSP_ORIGIN_SUBFACET : WSP_ORIGIN_SAMPLE;
        ++(from == WSP_ORIGIN_SEGMENT ? result.segment_splits : from == WSP_ORIGIN_SUBFACET ? result.facet_splits : result.samples);
        on_insert(v, from);
    }
    return result;
}

}  // namespace detail
}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_HULL_HPP
