// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced/cgal.hpp: wellspaced's Steiner points for CGAL::Delaunay_triangulation_3. Header-only over libwellspaced; this
/// file includes no GPL code by itself, but CGAL's 3D triangulations are GPL.
///
///     CGAL::Delaunay_triangulation_3<K> dt(points.begin(), points.end());
///     wellspaced::cgal::refine(dt);                               // in its convex hull, circumradius / shortest edge <= 2
///
/// Three levels, each usable by itself:
/// - bad_short_edges(dt, beta) and steiner_batch(dt, edge, options): look only; insert the points as you like.
/// - refine(dt, options): the whole loop, in place, with the boundary rules for the convex hull.
/// - refine(dt, options, domain, on_insert): in the cells for which domain(cell) holds, and on_insert(vertex, origin) is told
///   of each new vertex, to set its info() for instance.
///
/// Domains. `domain` is asked for cells as they come and go, so it has to judge by the place of a cell (of its centroid, say),
/// not by what it stores. The boundary of the domain is what lies between its cells and the others when refine is called: exactly coplanar
/// neighbours make a facet, edges between facets are segments. Facets and segments are split where a vertex or a sample encroaches upon them
/// (rules 1 to 3 of the paper), and no sample leaves the domain. The boundary need not be parallel to the axes, but facets must be convex.
/// Where they or segments meet at less than 60 degrees, cells between may stay bad; the report counts those that were given up.
/// Points on a facet that is not parallel to two axes lie off its plane by rounding. A convex hull with such facets is therefore refined by the
/// library's own kernel, whose Steiner points are inserted here (cgal/hull.hpp): that ends whatever the angles. The flat cells that rounding leaves at the
/// outside are no part of the hull then, and bad_short_edges(dt, beta) does not count them; call refine once, for the next call would take the points
/// beside the facets for corners. With a `domain` of slanted facets, and angles below 60 degrees, give options::max_vertices.
///
/// What is kept: handles of vertices stay valid, those of cells as after dt.insert. Kernel, vertex and cell types and tags
/// are free (Fast_location excepted: its hierarchy must be told of points by its own insert; refine does not compile for it); with
/// Parallel_tag nobody else may use `dt` during the call. Coordinates are taken as doubles; new points have double coordinates. Tested with
/// CGAL 5.5.1 in each run of the tests; with 6.0.1 and 6.2.1 the examples and the comparisons with the library's own kernel passed, too (for all
/// tests: -D WELLSPACED_CGAL_INCLUDE=...). Of the triangulation and its data structure what CGAL documents is used (locate, create_cell, create_vertex,
/// delete_cells, set_neighbor, incident_cells and the like, side_of_sphere, Compact_container::is_used), but for side_of_sphere's third argument (perturb)
/// and the marks of cells (tds_data, in these versions the same).
///
/// Order: that of the library's own refinement without its pass (WSP_SPARSIFY_OFF). Vertices are numbered as `dt` lists them; where they were
/// inserted one by one in the order of the library's input, the same Steiner points come in the same order, bit by bit
/// (in a box along the axes; elsewhere facets are found otherwise than they were given to the library).
///
/// Errors: std::invalid_argument for options, std::runtime_error for coordinates that are not finite or beyond
/// 2^-142 to 2^201. `dt` is a valid Delaunay triangulation whenever an exception leaves refine, also when on_insert throws.
///
/// Cost, with the triangulation of the input, over CGAL's insertion of the same points one by one in the same order, each located from the one
/// before: 0.9 to 1.3 times on sets of 10,000 input points, 1.3 to 1.4 times on one of 1,000 about lines, and 2.2 to 2.4 times on those of 10 and
/// 32, where plain insertion is fastest and most samples only find what has to be split before them (cpp_tests/bench/cgal.cpp).

#ifndef WELLSPACED_CGAL_HPP
#define WELLSPACED_CGAL_HPP

#include "../wellspaced.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Location_policy.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "cgal/boundary.hpp"
#include "cgal/geometry.hpp"
#include "cgal/hull.hpp"
#include "cgal/options.hpp"
#include "cgal/refiner.hpp"

/// wellspaced in the meshers of others.
namespace wellspaced {
/// wellspaced in CGAL's triangulations.
namespace cgal {

/// The bad short edges for a bound, the shortest first: no finite cell is bad if there are none, but for those that rounding has left at the outside
/// of a slanted hull. An edge is CGAL's triple of a cell and two slots in it; the cell is a bad one. Linear in the triangulation.
template <class Dt, class Domain = everywhere>
std::vector<typename Dt::Edge> bad_short_edges(const Dt& dt, double radius_edge, const Domain& domain = Domain()) {
    struct found {
        double squared;
        std::size_t number;
        typename Dt::Edge edge;
    };
    std::vector<found> all;
    std::unordered_set<const void*> flat;
    if (std::is_same<Domain, everywhere>::value && dt.dimension() == 3) flat = detail::flat_outside(dt);
    if (dt.dimension() == 3)
        for (auto c = dt.finite_cells_begin(); c != dt.finite_cells_end(); ++c) {
            const detail::corners p = detail::corners_of(c);
            if (!domain(c) || flat.count(&*c) != 0 || !detail::is_bad(p, radius_edge)) continue;
            int i = 0, j = 1;
            double least = std::numeric_limits<double>::infinity();
            for (int a = 0; a < 4; ++a)
                for (int b = a + 1; b < 4; ++b) {
                    const double d = detail::squared_distance(p[a], p[b]);
                    if (d < least) least = d, i = a, j = b;
                }
            all.push_back({least, all.size(), typename Dt::Edge(c, i, j)});
        }
    std::sort(all.begin(), all.end(), [](const found& a, const found& b) {
        return a.squared != b.squared ? a.squared < b.squared : a.number < b.number;
    });
    std::vector<typename Dt::Edge> edges;
    std::vector<std::array<typename Dt::Vertex_handle, 2>> seen;  // of the present length
    double length = -1;
    for (const found& f : all) {
        if (f.squared != length) seen.clear();
        length = f.squared;
        typename Dt::Vertex_handle a = f.edge.first->vertex(f.edge.second), b = f.edge.first->vertex(f.edge.third);
        if (b < a) std::swap(a, b);
        const std::array<typename Dt::Vertex_handle, 2> ends{a, b};
        if (std::find(seen.begin(), seen.end(), ends) != seen.end()) continue;
        seen.push_back(ends);
        edges.push_back(f.edge);
    }
    return edges;
}

/// The Steiner points of an edge, to be inserted together; none if it is not bad. Boundary rules are the caller's here: the points
/// of an edge at the hull may lie outside.
template <class Dt>
std::vector<typename Dt::Point> steiner_batch(const Dt& dt, const typename Dt::Edge& edge, const options& o = options()) {
    std::vector<detail::vec> link, points;
    const auto hull = [&](typename Dt::Cell_handle c, int slot) { return dt.is_infinite(c->neighbor(slot)); };
    typename Dt::Cell_handle c = edge.first;
    int i = edge.second, j = edge.third;
    if (dt.is_infinite(c)) {
        const auto p = c->vertex(i), q = c->vertex(j);
        auto around = dt.incident_cells(edge);
        while (dt.is_infinite(around)) ++around;
        c = around;
        i = c->index(p), j = c->index(q);
    }
    const bool closed = detail::link_of<Dt>(c, i, j, hull, link);
    const detail::vec p = detail::to_vec(c->vertex(i)->point()), q = detail::to_vec(c->vertex(j)->point());
    const wsp_sampler_options s = detail::sampler(o);
    std::size_t count = 0;
    for (std::size_t room = 16; points.size() < (std::max)(count, room); room = count) {
        points.resize(room);
        detail::check(wsp_sample_edge(p.data(), q.data(), link.data()->data(), link.size(), closed, &s, points.data()->data(),
                                      points.size(), &count));
    }
    points.resize(count);
    std::vector<typename Dt::Point> result;
    for (const detail::vec& p : points) result.emplace_back(p[0], p[1], p[2]);
    return result;
}

/// Inserts Steiner points until no cell of the domain is bad. Below dimension 3 there is nothing to do.
template <class Dt, class Domain = everywhere, class On_insert = ignore>
report refine(Dt& dt, const options& o = options(), const Domain& domain = Domain(), On_insert on_insert = On_insert()) {
    static_assert(!std::is_same<typename Dt::Location_policy, CGAL::Fast_location>::value,
                  "wellspaced::cgal::refine: no triangulations with CGAL::Fast_location, whose hierarchy has to be told of each point by "
                  "its own insert; take one with the default, CGAL::Compact_location");
    if (!(o.min_edge >= 0 && o.min_edge <= (std::numeric_limits<double>::max)()))
        throw std::invalid_argument("wellspaced::cgal::refine: min_edge is not a finite length");
    // The sampler checks the other options as soon as it is called: here even if there is nothing to do.
    const double unit[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const wsp_sampler_options s = detail::sampler(o);
    std::size_t count = 0;
    detail::check(wsp_sample_edge(unit, unit + 3, unit + 6, 2, 0, &s, nullptr, 0, &count));
    if (dt.dimension() < 3) return report();
    if (std::is_same<Domain, everywhere>::value && !detail::is_box_like(dt)) return detail::refine_hull(dt, o, on_insert);
    return detail::refiner<Dt, Domain, On_insert>(dt, o, domain, on_insert).run();
}

}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_HPP
