// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced/cpp/triangulation.hpp: triangulations, their views and their refinement. Included by wellspaced/wellspaced.hpp.

#ifndef WELLSPACED_CPP_TRIANGULATION_HPP
#define WELLSPACED_CPP_TRIANGULATION_HPP

#include "../../wellspaced.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "plc.hpp"

namespace wsp {

/// The Steiner points of one step.
class batch {
public:
    /// Takes a batch of the C functions over.
    explicit batch(wsp_batch* adopted) noexcept : handle_(adopted) {}

    /// The edge that the batch was computed for.
    wsp_edge edge() const noexcept { return wsp_batch_edge(get()); }
    /// How many points there are.
    std::size_t size() const noexcept { return wsp_batch_count(get()); }
    /// Whether there are no points.
    bool empty() const noexcept { return size() == 0; }
    /// Both refer to the batch's memory.
    wsp::points points() const noexcept { return {wsp_batch_points(get()), size()}; }
    /// Where each point comes from; of the batch's memory, too.
    span<origin> origins() const noexcept { return {wsp_batch_origins(get()), size()}; }
    /// The rule that the batch was computed by.
    wsp_rule rule() const noexcept { return wsp_batch_rule(get()); }
    /// The span of the component that was sampled, in radians; see wsp_batch_span.
    double span_angle() const noexcept { return wsp_batch_span(get()); }
    /// The sampling angle, in radians; see wsp_batch_theta.
    double theta() const noexcept { return wsp_batch_theta(get()); }

    /// The C handle, which stays this object's.
    wsp_batch* get() const noexcept { return handle_.get(); }

private:
    detail::handle<wsp_batch, wsp_batch_free> handle_;
};

/// A mesh's arrays in place: they refer to the triangulation's memory until its next change.
struct mesh_view {
    points vertices;                                  ///< by vertex id
    span<std::array<std::uint32_t, 4>> tetrahedra;    ///< vertex ids, positively oriented
    span<std::array<std::uint32_t, 4>> neighbours;    ///< across the face opposite each vertex, or WSP_NONE
    span<std::uint32_t> regions;                      ///< of each tetrahedron: 1 + the region's position, or 0
};

/// The arrays of a domain's boundary in place, as wsp_boundary_view has them: they refer to the triangulation's memory until its next change.
struct boundary_view {
    span<std::array<std::uint32_t, 3>> faces;            ///< vertex ids, counterclockwise seen from outside the first tetrahedron
    span<std::uint32_t> face_facets;                     ///< as plc::add_facet numbers them
    span<std::int32_t> face_markers;                     ///< those of their facets
    span<std::array<std::uint32_t, 2>> face_tetrahedra;  ///< on the two sides, WSP_NONE for none: then there is but the first
    span<std::array<std::uint32_t, 2>> edges;            ///< vertex ids
    span<std::uint32_t> edge_segments;                   ///< a number for each segment
    span<std::int32_t> edge_markers;                     ///< those of their segments
    span<std::uint8_t> vertex_kinds;                     ///< by vertex id: one of the WSP_ON_ constants
    span<std::uint32_t> vertex_elements;                 ///< the segment or facet that a vertex lies inside of, or WSP_NONE
};

/// A Delaunay triangulation, and the domain that it fills once one is set.
class triangulation {
public:
    triangulation() {
        wsp_triangulation* made = nullptr;
        check(wsp_triangulation_new(nullptr, &made));
        handle_.reset(made);
    }
    /// Insertions of many points and passes over Steiner points may use so many threads, 0 for as many as there are processors.
    static triangulation with_threads(std::uint32_t threads) {
        const triangulation_options options(threads);
        wsp_triangulation* made = nullptr;
        check(wsp_triangulation_new(&options, &made));
        return triangulation(made);
    }
    /// Triangulates a complex and makes it the domain. See wsp_triangulation_from_plc.
    explicit triangulation(const plc& domain) : handle_(from(domain, nullptr, nullptr)) {}
    /// The same on so many threads.
    triangulation(const plc& domain, const triangulation_options& options) : handle_(from(domain, &options, nullptr)) {}
    /// If the control cancels, these throw wsp::error of status WSP_CANCELLED: there is no triangulation then.
    triangulation(const plc& domain, const control& control) : handle_(from(domain, nullptr, control.get())) {}
    /// The same on so many threads, within a control.
    triangulation(const plc& domain, const triangulation_options& options, const control& control)
        : handle_(from(domain, &options, control.get())) {}

    /// A copy that shares nothing with this.
    triangulation clone() const {
        wsp_triangulation* made = nullptr;
        check(wsp_triangulation_clone(get(), &made));
        return triangulation(made);
    }
    /// If the control cancels, this throws wsp::error of status WSP_CANCELLED.
    triangulation clone(const control& control) const {
        wsp_triangulation* made = nullptr;
        detail::running_call call;
        const wsp_status status = call.finish(wsp_triangulation_clone_within(get(), control.get(), &made));
        if (status == WSP_CANCELLED) throw error(status, wsp_status_string(status));
        return triangulation(made);
    }

    /// The vertex id of each point.
    std::vector<std::uint32_t> insert(points list) {
        std::vector<std::uint32_t> ids(list.size());
        check(wsp_triangulation_insert(get(), list.data(), list.size(), ids.data(), nullptr));
        return ids;
    }
    /// The vertex id of the point.
    std::uint32_t insert(const wsp::point& p) {
        std::uint32_t id = WSP_NONE;
        check(wsp_triangulation_insert(get(), p.data(), 1, &id, nullptr));
        return id;
    }
    /// WSP_DONE, or WSP_CANCELLED: then nothing has been inserted. `ids` is left empty then.
    wsp_status insert(points list, const control& control, std::vector<std::uint32_t>* ids = nullptr) {
        std::vector<std::uint32_t> made(ids ? list.size() : 0);
        detail::running_call call;
        const wsp_status status = call.finish(wsp_triangulation_insert(
            get(), list.data(), list.size(), ids ? made.data() : nullptr, control.get()));
        if (status == WSP_CANCELLED) made.clear();
        if (ids) ids->swap(made);
        return status;
    }

    /// The others keep their ids.
    void remove(std::uint32_t vertex) { check(wsp_triangulation_remove(get(), vertex)); }
    /// WSP_DONE, or WSP_CANCELLED.
    wsp_status remove(std::uint32_t vertex, const control& control) {
        detail::running_call call;
        return call.finish(wsp_triangulation_remove_within(get(), vertex, control.get()));
    }

    /// Makes the convex hull of the present points the domain.
    void use_hull_as_domain() { check(wsp_triangulation_use_hull_as_domain(get())); }
    /// WSP_DONE, or WSP_CANCELLED: then there is still no domain.
    wsp_status use_hull_as_domain(const control& control) {
        detail::running_call call;
        return call.finish(wsp_triangulation_use_hull_as_domain_within(get(), control.get()));
    }

    /// Whether a domain has been set.
    bool has_domain() const {
        std::uint32_t answer = 0;
        check(wsp_triangulation_has_domain(get(), &answer));
        return answer != 0;
    }
    /// -1 without points, 0 to 2 for points in a place, line or plane, 3 otherwise.
    int dimension() const {
        std::int32_t answer = 0;
        check(wsp_triangulation_dimension(get(), &answer));
        return answer;
    }
    /// How many vertices there are.
    std::size_t vertex_count() const {
        std::size_t answer = 0;
        check(wsp_triangulation_counts(get(), &answer, nullptr));
        return answer;
    }
    /// How many tetrahedra the convex hull has.
    std::size_t tetrahedron_count() const {
        std::size_t answer = 0;
        check(wsp_triangulation_counts(get(), nullptr, &answer));
        return answer;
    }
    /// Where a vertex is.
    wsp::point point(std::uint32_t vertex) const {
        wsp::point p{};
        check(wsp_triangulation_point(get(), vertex, p.data()));
        return p;
    }
    /// What of the hull `p` is in; `hint` is a vertex near it.
    wsp::location locate(const wsp::point& p, std::uint32_t hint = WSP_NONE) const {
        wsp::location answer{};
        check(wsp_triangulation_locate(get(), p.data(), hint, &answer));
        return answer;
    }
    /// The mesh's arrays in place.
    mesh_view view() const { return view(nullptr); }
    /// If the control cancels, this throws wsp::error of status WSP_CANCELLED.
    mesh_view view(const control& control) const { return view(control.get()); }
    /// The domain's boundary. Without a domain its arrays are empty.
    boundary_view boundary() const { return boundary(nullptr); }
    /// If the control cancels, this throws wsp::error of status WSP_CANCELLED.
    boundary_view boundary(const control& control) const { return boundary(control.get()); }

    /// Throws WSP_ERR_NOT_VALID with what is wrong. For WSP_VALIDATE_QUALITY give the bound.
    void validate(std::uint32_t level = WSP_VALIDATE_DELAUNAY, double radius_edge = 2.0) const {
        check(wsp_triangulation_validate(get(), level, radius_edge));
    }
    /// WSP_DONE, or WSP_CANCELLED.
    wsp_status validate(const control& control, std::uint32_t level = WSP_VALIDATE_DELAUNAY, double radius_edge = 2.0) const {
        detail::running_call call;
        return call.finish(wsp_triangulation_validate_within(get(), level, radius_edge, control.get()));
    }

    /// The bad short edges of the domain, the shortest first.
    std::vector<edge> bad_short_edges(double radius_edge) const { return bad_short_edges(radius_edge, nullptr); }
    /// If the control cancels, this throws wsp::error of status WSP_CANCELLED.
    std::vector<edge> bad_short_edges(double radius_edge, const control& control) const {
        return bad_short_edges(radius_edge, control.get());
    }
    /// The vertices around an edge in order; `closed` is NULL or becomes whether they form a ring.
    std::vector<std::uint32_t> link(edge e, bool* closed = nullptr) const {
        std::uint32_t ring = 0;
        auto around = detail::list<std::uint32_t>(
            [&](std::uint32_t* out, std::size_t room, std::size_t* count) {
                return wsp_edge_link(get(), e, out, room, count, &ring);
            },
            32);
        if (closed) *closed = ring != 0;
        return around;
    }
    /// What the refinement would insert next for an edge. See wsp_steiner_batch.
    batch steiner_batch(edge e, const sampler_options& options = {}) const {
        wsp_batch* made = nullptr;
        check(wsp_steiner_batch(get(), e, &options, &made));
        return batch(made);
    }
    /// The vertex of each point, or WSP_NONE for points that could not be inserted.
    std::vector<std::uint32_t> insert(const batch& steiner) {
        std::vector<std::uint32_t> ids(steiner.size());
        check(wsp_triangulation_insert_batch(get(), steiner.get(), ids.data()));
        return ids;
    }

    /// Look at the report's status: it is 0 or above.
    wsp::report refine(const refine_options& options) { return refine(options, nullptr); }
    /// Within a control, too: after a cancellation the status is WSP_CANCELLED.
    wsp::report refine(const refine_options& options, const control& control) { return refine(options, control.get()); }
    /// With the defaults but for the bound.
    wsp::report refine(double radius_edge) { return refine(refine_options(radius_edge)); }
    /// Within limits of size, too: see wsp_refine_sized.
    wsp::report refine(const refine_options& options, const sizing& sizes) { return refine(options, sizes, control()); }
    /// What `sizes.at` throws cancels the control as well, until it is reset.
    wsp::report refine(const refine_options& options, const sizing& sizes, const control& control) {
        refine_options limited = options;
        if (sizes.everywhere > 0 && std::isfinite(sizes.everywhere))
            limited.max_edge = limited.max_edge == 0 ? sizes.everywhere : (std::min)(limited.max_edge, sizes.everywhere);
        const detail::running_sizes given(sizes, control.get());
        wsp::report done;
        detail::running_call call;
        call.finish(wsp_refine_sized(get(), &limited, &given, control.get(), &done));
        return done;
    }

    /// Takes Steiner points away again where every tetrahedron that comes keeps the bound; see wsp_sparsify_mesh.
    wsp::report sparsify(double radius_edge, wsp_sparsify level = WSP_SPARSIFY_DEFAULT) {
        return sparsify(radius_edge, level, nullptr);
    }
    /// Within a control, too: after a cancellation the status is WSP_CANCELLED.
    wsp::report sparsify(double radius_edge, const control& control, wsp_sparsify level = WSP_SPARSIFY_DEFAULT) {
        return sparsify(radius_edge, level, control.get());
    }

    /// The C handle, which stays this object's.
    wsp_triangulation* get() const noexcept { return handle_.get(); }

private:
    using handle = detail::handle<wsp_triangulation, wsp_triangulation_free>;

    explicit triangulation(wsp_triangulation* adopted) noexcept : handle_(adopted) {}

    static handle from(const plc& domain, const wsp_triangulation_options* options, wsp_control* control) {
        detail::running_call call;
        wsp_triangulation* made = nullptr;
        const wsp_status status = wsp_triangulation_from_plc(domain.get(), options, control, &made);
        handle owner(made);
        if (call.finish(status) != WSP_DONE) throw error(status, wsp_status_string(status));
        return owner;
    }
    wsp::report refine(const refine_options& options, wsp_control* control) {
        wsp::report done;
        detail::running_call call;
        call.finish(wsp_refine(get(), &options, control, &done));
        return done;
    }
    wsp::report sparsify(double radius_edge, wsp_sparsify level, wsp_control* control) {
        wsp::report done;
        detail::running_call call;
        call.finish(wsp_sparsify_mesh(get(), radius_edge, level, control, &done));
        return done;
    }
    mesh_view view(wsp_control* control) const {
        wsp_mesh_view arrays;
        check(wsp_mesh_view_init(&arrays, sizeof arrays));
        detail::running_call call;
        const wsp_status status = call.finish(wsp_triangulation_view_within(get(), &arrays, control));
        if (status == WSP_CANCELLED) throw error(status, wsp_status_string(status));
        const auto quads = [&](const std::uint32_t* ids) {
            return span<std::array<std::uint32_t, 4>>(reinterpret_cast<const std::array<std::uint32_t, 4>*>(ids),
                                                      arrays.tetrahedra_count);
        };
        return {{arrays.points, arrays.points_count}, quads(arrays.tetrahedra), quads(arrays.neighbours),
                {arrays.regions, arrays.tetrahedra_count}};
    }
    boundary_view boundary(wsp_control* control) const {
        wsp_boundary_view arrays;
        check(wsp_boundary_view_init(&arrays, sizeof arrays));
        detail::running_call call;
        const wsp_status status = call.finish(wsp_triangulation_boundary(get(), control, &arrays));
        if (status == WSP_CANCELLED) throw error(status, wsp_status_string(status));
        const auto pairs = [](const std::uint32_t* ids, std::size_t count) {
            return span<std::array<std::uint32_t, 2>>(reinterpret_cast<const std::array<std::uint32_t, 2>*>(ids), count);
        };
        const std::size_t faces = arrays.faces_count, edges = arrays.edges_count, vertices = arrays.vertices_count;
        return {{reinterpret_cast<const std::array<std::uint32_t, 3>*>(arrays.faces), faces},
                {arrays.face_facets, faces},
                {arrays.face_markers, faces},
                pairs(arrays.face_tetrahedra, faces),
                pairs(arrays.edges, edges),
                {arrays.edge_segments, edges},
                {arrays.edge_markers, edges},
                {arrays.vertex_kinds, vertices},
                {arrays.vertex_elements, vertices}};
    }
    std::vector<edge> bad_short_edges(double radius_edge, wsp_control* control) const {
        return detail::list<edge>(
            [&](edge* out, std::size_t room, std::size_t* count) {
                detail::running_call call;
                const wsp_status status =
                    call.finish(wsp_bad_short_edges_within(get(), radius_edge, control, out, room, count));
                if (status == WSP_CANCELLED) throw error(status, wsp_status_string(status));
                return status;
            },
            64);
    }

    handle handle_;
};

}  // namespace wsp

#endif  // WELLSPACED_CPP_TRIANGULATION_HPP
