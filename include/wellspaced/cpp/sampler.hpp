// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced/cpp/sampler.hpp: the sampler and predicates for a triangulation of another kind. Included by wellspaced/wellspaced.hpp.

#ifndef WELLSPACED_CPP_SAMPLER_HPP
#define WELLSPACED_CPP_SAMPLER_HPP

#include "../../wellspaced.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "control.hpp"

namespace wsp {

/// The sampler for any host's triangulation: edge p q and the points around it in order.
inline std::vector<point> sample_edge(const point& p, const point& q, points link, bool closed,
                                      const sampler_options& options = {}) {
    return detail::list<point>(
        [&](point* out, std::size_t room, std::size_t* count) {
            return wsp_sample_edge(p.data(), q.data(), link.data(), link.size(), closed, &options,
                                   out ? out->data() : nullptr, room, count);
        },
        16);
}

/// The same for a bad tetrahedron, whose first two corners are the ends of its shortest edge. See wsp_sample_tetrahedron.
inline std::vector<point> sample_tetrahedron(const std::array<point, 4>& corners, points link, bool closed,
                                             const sampler_options& options = {}) {
    return detail::list<point>(
        [&](point* out, std::size_t room, std::size_t* count) {
            return wsp_sample_tetrahedron(corners[0].data(), link.data(), link.size(), closed, &options,
                                          out ? out->data() : nullptr, room, count);
        },
        16);
}

/// A host's arrays as wsp_sample_mesh takes them. They refer to the host's memory.
struct mesh_arrays : wsp_mesh_view {
    /// Of `across` and `facet_numbers` there are none or one for each tetrahedron or face.
    mesh_arrays(wsp::points vertices, span<std::array<std::uint32_t, 4>> tets,
                span<std::array<std::uint32_t, 4>> across = {}, span<std::array<std::uint32_t, 3>> inner_faces = {},
                span<std::uint32_t> facet_numbers = {}) {
        check(wsp_mesh_view_init(this, sizeof(wsp_mesh_view)));
        if ((!across.empty() && across.size() != tets.size()) ||
            (!facet_numbers.empty() && facet_numbers.size() != inner_faces.size()))
            throw error(WSP_ERR_ARGUMENT, "wsp::mesh_arrays: arrays that belong together differ in length");
        points = vertices.data();
        points_count = vertices.size();
        tetrahedra = tets.empty() ? nullptr : tets.data()->data();
        tetrahedra_count = tets.size();
        neighbours = across.empty() ? nullptr : across.data()->data();
        faces = inner_faces.empty() ? nullptr : inner_faces.data()->data();
        faces_count = inner_faces.size();
        facets = facet_numbers.data();
    }
};

/// One round on a host's arrays: points that may all be inserted together. See wsp_sample_mesh.
class mesh_batch {
public:
    /// The round's points for these arrays.
    explicit mesh_batch(const mesh_arrays& mesh, const sampler_options& options = {}) : mesh_batch(mesh, options, nullptr) {}
    /// If the control cancels, this throws wsp::error of status WSP_CANCELLED.
    mesh_batch(const mesh_arrays& mesh, const sampler_options& options, const control& control)
        : mesh_batch(mesh, options, control.get()) {}

    /// WSP_DONE, or WSP_UNREFINED: there are no points, but bad tetrahedra that can't be mended. A moved-from batch keeps it.
    wsp_status status() const noexcept { return status_; }

    /// How many points there are.
    std::size_t size() const noexcept { return wsp_mesh_batch_count(get()); }
    /// Whether there are no points.
    bool empty() const noexcept { return size() == 0; }
    /// Both refer to the batch's memory.
    span<wsp_steiner_point> points() const noexcept { return {wsp_mesh_batch_points(get()), size()}; }
    /// The bad short edges of the arrays, shortest first; of the batch's memory, too.
    span<edge> bad_edges() const noexcept {
        std::size_t count = 0;
        const edge* first = wsp_mesh_batch_bad_edges(get(), &count);
        return {first, count};
    }
    /// Bad tetrahedra and encroached boundary elements that can't be mended.
    std::size_t refused() const noexcept { return wsp_mesh_batch_refused(get()); }

    /// The C handle, which stays this object's.
    wsp_mesh_batch* get() const noexcept { return handle_.get(); }

private:
    mesh_batch(const mesh_arrays& mesh, const sampler_options& options, wsp_control* control) {
        detail::running_call call;
        wsp_mesh_batch* made = nullptr;
        const wsp_status status = wsp_sample_mesh(&mesh, &options, control, &made);
        handle_.reset(made);
        status_ = call.finish(status);
        if (status_ == WSP_CANCELLED) throw error(status_, wsp_status_string(status_));
    }

    detail::handle<wsp_mesh_batch, wsp_mesh_batch_free> handle_;
    wsp_status status_ = WSP_DONE;
};

/// Whether edge p q with the points around it in order is bad. See wsp_is_bad_edge.
inline bool is_bad_edge(const point& p, const point& q, points link, bool closed, double radius_edge) {
    std::uint32_t bad = 0;
    check(wsp_is_bad_edge(p.data(), q.data(), link.data(), link.size(), closed, radius_edge, &bad));
    return bad != 0;
}

/// Which tetrahedra are bad, exactly: 1 or 0 for each. `corners` has four points a tetrahedron; any other number throws.
inline std::vector<std::uint8_t> bad_tetrahedra(points corners, double radius_edge) {
    if (corners.size() % 4 != 0)
        throw error(WSP_ERR_ARGUMENT, "wsp::bad_tetrahedra: the number of corners is not a multiple of 4");
    std::vector<std::uint8_t> bad(corners.size() / 4);
    check(wsp_bad_tetrahedra(corners.data(), bad.size(), radius_edge, bad.data()));
    return bad;
}

/// The exact sign of det[b-a, c-a, d-a]: 1 if a b c d is positively oriented, 0 if it is flat, else -1.
inline int orientation(const point& a, const point& b, const point& c, const point& d) {
    std::int32_t sign = 0;
    check(wsp_orientation(a.data(), b.data(), c.data(), d.data(), &sign));
    return sign;
}

/// Where `p` is to the circumsphere of the positively oriented a b c d, exactly: 1 inside, 0 on it, -1 outside.
inline int side_of_sphere(const point& a, const point& b, const point& c, const point& d, const point& p) {
    std::int32_t sign = 0;
    check(wsp_side_of_sphere(a.data(), b.data(), c.data(), d.data(), p.data(), &sign));
    return sign;
}

/// The version of the library that is loaded.
inline const char* version() noexcept { return wsp_version(); }

}  // namespace wsp

#endif  // WELLSPACED_CPP_SAMPLER_HPP
