// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced/cpp/plc.hpp: piecewise linear complexes: what a domain is made from, and what is wrong with it. Included by wellspaced/wellspaced.hpp.

#ifndef WELLSPACED_CPP_PLC_HPP
#define WELLSPACED_CPP_PLC_HPP

#include "../../wellspaced.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "control.hpp"

namespace wsp {

/// What is wrong, or may be, with a complex.
struct defect {
    wsp_defect_kind kind = 0;       ///< a WSP_DEFECT_ constant
    bool is_error = false;          ///< the complex can't be meshed; otherwise a warning
    std::vector<element> elements;  ///< the one or two that it is about
    point place{};                  ///< a point where it is; NaN where that means nothing
    double measure = 0;             ///< a number that goes with the kind
    std::string text;               ///< all of it in words
};

/// An angle at which two elements of a complex meet.
struct input_angle {
    double degrees = std::numeric_limits<double>::quiet_NaN();  ///< NaN if no two meet
    std::vector<element> elements;                              ///< the two; none if no two meet
    point place{};                                              ///< where they meet
};

/// What plc::check has found. It refers to nothing.
struct plc_check {
    std::vector<defect> defects;  ///< errors first
    std::size_t errors = 0;       ///< how many of them are errors: the complex can be meshed if there are none
    input_angle segment_angle;    ///< the smallest at which two segments meet
    input_angle facet_angle;      ///< the smallest at which two facets meet
};

/// A piecewise linear complex.
class plc {
public:
    plc() {
        wsp_plc* made = nullptr;
        wsp::check(wsp_plc_new(&made));
        handle_.reset(made);
    }

    /// The position of the first of them. Markers: none, or one a point.
    std::uint32_t add_points(points list, span<std::int32_t> markers = {}) {
        std::uint32_t first = 0;
        wsp::check(wsp_plc_add_points(get(), list.data(), list.size(), marked(markers, list.size()), &first));
        return first;
    }
    /// The position of the first of its eight points. The facets' markers are `marker` to `marker + 5`.
    std::uint32_t add_box(const point& low, const point& high, std::int32_t marker = 1) {
        std::uint32_t first = 0;
        wsp::check(wsp_plc_add_box(get(), low.data(), high.data(), marker, &first));
        return first;
    }
    /// Two positions of points a segment. Markers: none, or one a segment.
    void add_segments(span<std::array<std::uint32_t, 2>> ends, span<std::int32_t> markers = {}) {
        const std::uint32_t* flat = ends.empty() ? nullptr : ends.data()->data();
        wsp::check(wsp_plc_add_segments(get(), flat, ends.size(), marked(markers, ends.size())));
    }
    /// A facet of one polygon; its position.
    std::uint32_t add_facet(span<std::uint32_t> polygon, std::int32_t marker = 0) {
        const std::size_t starts[2] = {0, polygon.size()};
        std::uint32_t first = 0;
        wsp::check(wsp_plc_add_facets(get(), polygon.data(), starts, 1, nullptr, 1, &marker, &first));
        return first;
    }
    /// A facet of one polygon; its position.
    std::uint32_t add_facet(std::initializer_list<std::uint32_t> polygon, std::int32_t marker = 0) {
        return add_facet(span<std::uint32_t>(polygon.begin(), polygon.size()), marker);
    }
    /// Facets as lists of lists; without `facet_starts` each polygon is a facet. The position of the first.
    std::uint32_t add_facets(span<std::uint32_t> vertices, span<std::size_t> polygon_starts,
                             span<std::size_t> facet_starts = {}, span<std::int32_t> markers = {}) {
        const std::size_t polygons = polygon_starts.empty() ? 0 : polygon_starts.size() - 1;
        const std::size_t facets = facet_starts.empty() ? polygons : facet_starts.size() - 1;
        if (!polygon_starts.empty() && polygon_starts[polygons] > vertices.size())
            throw error(WSP_ERR_ARGUMENT, "wsp::plc::add_facets: polygon_starts ends beyond vertices");
        std::uint32_t first = 0;
        wsp::check(wsp_plc_add_facets(get(), vertices.data(), polygon_starts.data(), polygons,
                                 facet_starts.empty() ? nullptr : facet_starts.data(), facets,
                                 marked(markers, facets), &first));
        return first;
    }
    /// Takes the part of a facet around `p` out of it.
    void add_facet_hole(std::uint32_t facet, const point& p) { wsp::check(wsp_plc_add_facet_hole(get(), facet, p.data())); }
    /// Takes the volume around `p` out of the domain.
    void add_hole(const point& p) { wsp::check(wsp_plc_add_hole(get(), p.data())); }
    /// Labels the volume around `p`; a `max_volume` above 0 is the largest of a tetrahedron there.
    void add_region(const point& p, double attribute, double max_volume = 0) {
        wsp::check(wsp_plc_add_region(get(), p.data(), attribute, max_volume));
    }

    /// How many points there are.
    std::size_t point_count() const { return counts()[0]; }
    /// How many segments there are in the list.
    std::size_t segment_count() const { return counts()[1]; }
    /// How many facets there are.
    std::size_t facet_count() const { return counts()[2]; }

    /// Every defect, and the smallest angles: see wsp_plc_check.
    plc_check check() const { return check(nullptr); }
    /// If the control cancels, this throws wsp::error of status WSP_CANCELLED.
    plc_check check(const control& control) const { return check(control.get()); }

    /// Joins neighbours whose normals differ by at most so many degrees. Of each facet that there was: the number of the one that it is a part of now.
    std::vector<std::uint32_t> join_coplanar(double degrees) {
        std::vector<std::uint32_t> joined;
        join_coplanar(degrees, nullptr, &joined);
        return joined;
    }
    /// WSP_DONE, or WSP_CANCELLED: then the complex is as it was, and `joined`, which may be NULL, is empty.
    wsp_status join_coplanar(double degrees, const control& control, std::vector<std::uint32_t>* joined = nullptr) {
        return join_coplanar(degrees, control.get(), joined);
    }

    /// The C handle, which stays this object's.
    wsp_plc* get() const noexcept { return handle_.get(); }

private:
    wsp_status join_coplanar(double degrees, wsp_control* control, std::vector<std::uint32_t>* joined) {
        std::vector<std::uint32_t> made(facet_count());
        detail::running_call call;
        const wsp_status status =
            call.finish(wsp_plc_join_coplanar_groups(get(), degrees, control, made.data(), made.size(), nullptr));
        if (joined) *joined = status == WSP_DONE ? std::move(made) : std::vector<std::uint32_t>();
        return status;
    }
    plc_check check(wsp_control* control) const {
        detail::running_call call;
        wsp_check* made = nullptr;
        const wsp_status status = wsp_plc_check_within(get(), control, &made);
        const detail::handle<wsp_check, wsp_check_free> owner(made);
        if (call.finish(status) == WSP_CANCELLED) throw error(status, wsp_status_string(status));
        plc_check found;
        found.defects.resize(wsp_check_count(made, &found.errors));
        for (std::size_t i = 0; i < found.defects.size(); ++i) {
            const wsp_defect d = filled([&](wsp_defect* out) { return wsp_check_defect(made, i, out); });
            found.defects[i] = {d.kind, d.is_error != 0, elements_of(d), place_of(d), d.measure, wsp_check_text(made, i)};
        }
        for (const std::uint32_t between_facets : {0u, 1u}) {
            const wsp_defect d = filled([&](wsp_defect* out) { return wsp_check_angle(made, between_facets, out); });
            (between_facets ? found.facet_angle : found.segment_angle) = {d.measure, elements_of(d), place_of(d)};
        }
        return found;
    }
    template <class Fill>
    static wsp_defect filled(const Fill& fill) {
        wsp_defect d;
        wsp::check(wsp_defect_init(&d, sizeof d));
        wsp::check(fill(&d));
        return d;
    }
    static std::vector<element> elements_of(const wsp_defect& d) { return {d.elements, d.elements + d.element_count}; }
    static point place_of(const wsp_defect& d) { return {d.place[0], d.place[1], d.place[2]}; }

    std::array<std::size_t, 3> counts() const {
        std::array<std::size_t, 3> c{};
        wsp::check(wsp_plc_counts(get(), &c[0], &c[1], &c[2]));
        return c;
    }
    static const std::int32_t* marked(span<std::int32_t> markers, std::size_t count) {
        if (markers.empty()) return nullptr;
        if (markers.size() != count) throw error(WSP_ERR_ARGUMENT, "wsp::plc: as many markers as elements, or none");
        return markers.data();
    }

    detail::handle<wsp_plc, wsp_plc_free> handle_;
};

}  // namespace wsp

#endif  // WELLSPACED_CPP_PLC_HPP
