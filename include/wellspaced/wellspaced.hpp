// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced.hpp: the C++17 face of wellspaced.h, header-only.
///
/// Handles are move-only objects that free themselves, errors are exceptions (wsp::error), lists are vectors. What a
/// function does, costs and refuses is told in wellspaced.h at the C function of the same name.
///
///     wsp::plc domain;
///     domain.add_box({0, 0, 0}, {1, 1, 1});
///     domain.add_points(points);                  // std::vector<std::array<double, 3>>, or (const double*, count)
///     wsp::triangulation mesh(domain);
///     wsp::report report = mesh.refine(2.0);
///
/// Conventions
/// - Statuses below 0 are thrown as wsp::error. Functions that may end early, but with a usable result, return the
///   status, or a report that has it: 0 or one of WSP_CANCELLED, WSP_VERTEX_LIMIT, WSP_UNREFINED, WSP_TIME_LIMIT and
///   WSP_MEMORY_LIMIT. Where a cancellation leaves nothing to return (an object to be made, a list), WSP_CANCELLED is thrown, too.
/// - Spans (wsp::span, wsp::points) only refer to memory of the caller. They are made from a pointer and a count or from
///   any contiguous container: std::vector, std::array, std::span, a mapped array of Eigen...
/// - A callback that throws cancels its call, and what it threw comes out of that call unchanged. No exception ever
///   crosses the C frames between.
/// - A moved-from handle is empty: it can be destroyed and assigned to. Members of an empty wsp::plc, wsp::triangulation or
///   wsp::control throw WSP_ERR_NULL; those of an empty wsp::batch or wsp::mesh_batch give 0, NULL or a list of nothing (its edge
///   is of two WSP_NONE). As an argument an empty control is as good as none, any other empty handle is WSP_ERR_NULL.
/// - Threads: as in wellspaced.h. A const member function is a call that takes the handle as const.

#ifndef WELLSPACED_WELLSPACED_HPP
#define WELLSPACED_WELLSPACED_HPP

#include "../wellspaced.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

/// The C++ face of wellspaced.h.
namespace wsp {

/// What a failed call throws: its status, and wsp_last_error() as what().
class error : public std::exception {
public:
    /// An error of this status and text.
    error(wsp_status status, const char* message) : status_(status), message_(std::make_shared<std::string>(message)) {}

    /// The status of the call that failed.
    wsp_status status() const noexcept { return status_; }
    /// What wsp_last_error said.
    const char* what() const noexcept override { return message_->c_str(); }

private:
    wsp_status status_;
    std::shared_ptr<const std::string> message_;  // shared, so that copying an exception can't throw
};

/// Throws for a status below 0 and gives back the others.
inline wsp_status check(wsp_status status) {
    if (status < 0) throw error(status, wsp_last_error());
    return status;
}

/// Three coordinates.
using point = std::array<double, 3>;
/// An edge: the ids of its two vertices.
using edge = wsp_edge;
/// Where a point is.
using location = wsp_location;
/// Where a Steiner point comes from.
using origin = wsp_origin;
/// An element of a complex by its position in its list.
using element = wsp_element;

/// Elements of somebody else's contiguous memory, for reading.
template <class T>
class span {
public:
    /// What the elements are.
    using value_type = T;

    constexpr span() noexcept = default;
    /// So many elements.
    constexpr span(const T* data, std::size_t size) noexcept : data_(data), size_(size) {}
    /// The elements of a contiguous container.
    template <class Container,
              class = std::enable_if_t<
                  std::is_convertible_v<decltype(std::data(std::declval<const Container&>())), const T*>>>
    constexpr span(const Container& container) noexcept : data_(std::data(container)), size_(std::size(container)) {}

    /// The first element.
    constexpr const T* data() const noexcept { return data_; }
    /// How many elements there are.
    constexpr std::size_t size() const noexcept { return size_; }
    /// Whether there are no elements.
    constexpr bool empty() const noexcept { return size_ == 0; }
    /// The first element.
    constexpr const T* begin() const noexcept { return data_; }
    /// Behind the last element.
    constexpr const T* end() const noexcept { return data_ + size_; }
    /// Element `i`, unchecked.
    constexpr const T& operator[](std::size_t i) const noexcept { return data_[i]; }

private:
    const T* data_ = nullptr;
    std::size_t size_ = 0;
};

/// Points of somebody else's contiguous memory: three doubles each.
class points {
public:
    points() noexcept = default;
    /// So many points, three doubles each.
    points(const double* xyz, std::size_t count) noexcept : xyz_(xyz), count_(count) {}

    /// A contiguous container of doubles (x y z x y z ...; any other length than a multiple of three throws), or of
    /// structs that consist of three doubles, such as std::array<double, 3>.
    template <class Container, class Data = decltype(std::data(std::declval<const Container&>()))>
    points(const Container& container) {
        using value = std::remove_cv_t<std::remove_pointer_t<Data>>;
        if constexpr (std::is_same_v<value, double>) {
            xyz_ = std::data(container);
            count_ = std::size(container) / 3;
            if (std::size(container) % 3 != 0)
                throw error(WSP_ERR_ARGUMENT, "wsp::points: the number of doubles is not a multiple of 3");
        } else {
            static_assert(std::is_standard_layout_v<value> && sizeof(value) == 3 * sizeof(double) &&
                              alignof(value) == alignof(double),
                          "a point is three doubles");
            xyz_ = reinterpret_cast<const double*>(std::data(container));
            count_ = std::size(container);
        }
    }

    /// The first coordinate.
    const double* data() const noexcept { return xyz_; }
    /// How many points there are.
    std::size_t size() const noexcept { return count_; }
    /// Whether there are no points.
    bool empty() const noexcept { return count_ == 0; }
    /// Point `i`, unchecked.
    point operator[](std::size_t i) const noexcept { return {xyz_[3 * i], xyz_[3 * i + 1], xyz_[3 * i + 2]}; }

private:
    const double* xyz_ = nullptr;
    std::size_t count_ = 0;
};

/// Options of a triangulation that are born with the defaults.
struct triangulation_options : wsp_triangulation_options {
    triangulation_options() { check(wsp_triangulation_options_init(this, sizeof(wsp_triangulation_options))); }
    /// 0: as many threads as there are processors.
    explicit triangulation_options(std::uint32_t at_most) : triangulation_options() { threads = at_most; }
};

/// Options of the sampler that are born with the defaults.
struct sampler_options : wsp_sampler_options {
    sampler_options() { check(wsp_sampler_options_init(this, sizeof(wsp_sampler_options))); }
    /// The defaults but for the bound, and the rule.
    explicit sampler_options(double bound, wsp_rule chosen = WSP_RULE_SPARSE) : sampler_options() {
        radius_edge = bound;
        rule = chosen;
    }
};

/// Options of a refinement that are born with the defaults.
struct refine_options : wsp_refine_options {
    refine_options() { check(wsp_refine_options_init(this, sizeof(wsp_refine_options))); }
    /// The defaults but for the bound, and the rule.
    explicit refine_options(double bound, wsp_rule chosen = WSP_RULE_SPARSE) : refine_options() {
        radius_edge = bound;
        rule = chosen;
    }
};

/// A report that is born as that of an empty mesh.
struct report : wsp_report {
    report() { check(wsp_report_init(this, sizeof(wsp_report))); }
};

/// How large tetrahedra may be at most, for triangulation::refine. Of several sources the smallest length counts at each place; a
/// length that is not positive and finite asks for nothing, and so do elements that a list does not reach.
struct sizing {
    /// Fills in the largest length of an edge at each of the points; what it leaves alone asks for nothing. It must give the same
    /// answer each time. Within it the triangulation that is being refined must not be used.
    using callback = std::function<void(points at, double* max_edge)>;

    double everywhere = 0;         ///< the largest length of an edge anywhere; the smaller of this and refine_options::max_edge counts
    std::vector<double> regions;   ///< in each region, in the order in which they were added to the complex
    std::vector<double> vertices;  ///< at each vertex, by id; interpolated between them
    callback at;                   ///< at any point; empty for none
};

namespace detail {

template <class T, void (*Free)(T*)>
struct deleter {
    void operator()(T* handle) const noexcept { Free(handle); }
};

template <class T, void (*Free)(T*)>
using handle = std::unique_ptr<T, deleter<T, Free>>;

// What a callback of a running call has thrown. Callbacks run on the thread of their call, so the innermost one that is
// running on the thread is theirs.
class running_call {
public:
    running_call() noexcept : outer_(innermost()) { innermost() = this; }
    running_call(const running_call&) = delete;
    running_call& operator=(const running_call&) = delete;
    ~running_call() { innermost() = outer_; }

    // The end of the call: throws what a callback has thrown, or for an error.
    wsp_status finish(wsp_status status) {
        if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
        return check(status);
    }

    static void keep_exception() noexcept {
        if (innermost() != nullptr) innermost()->thrown_ = std::current_exception();
    }

private:
    static running_call*& innermost() noexcept {
        static thread_local running_call* call = nullptr;
        return call;
    }

    running_call* outer_;
    std::exception_ptr thrown_;
};

// What a wsp_sizing refers to while its call runs.
class running_sizes : public wsp_sizing {
public:
    running_sizes(const sizing& sizes, wsp_control* control) : sizes_(sizes), control_(control) {
        check(wsp_sizing_init(this, sizeof(wsp_sizing)));
        region_max_edge = sizes.regions.data();
        region_count = sizes.regions.size();
        vertex_max_edge = sizes.vertices.data();
        vertex_count = sizes.vertices.size();
        if (sizes.at) callback = &told;
        user = this;
    }

private:
    // A sizing callback has no word for 'cancel': the control has. Until the call has noticed, nothing more is asked for.
    static void told(void* self, const double* xyz, std::size_t n, double* max_edge) noexcept {
        auto& to = *static_cast<running_sizes*>(self);
        std::fill_n(max_edge, n, 0.0);
        if (to.thrown_) return;
        try {
            to.sizes_.at(points(xyz, n), max_edge);
        } catch (...) {
            to.thrown_ = true;
            std::fill_n(max_edge, n, 0.0);
            running_call::keep_exception();
            wsp_control_cancel(to.control_);
        }
    }

    const sizing& sizes_;
    wsp_control* control_;
    bool thrown_ = false;
};

// The two calls of a list.
template <class T, class Ask>
std::vector<T> list(const Ask& ask, std::size_t guess) {
    std::vector<T> items(guess);
    std::size_t count = 0;
    wsp_status status = check(ask(items.data(), items.size(), &count));
    if (status == WSP_INCOMPLETE || count > items.size()) {
        items.resize(count);
        check(ask(items.data(), items.size(), &count));
    }
    items.resize(count);
    return items;
}

}  // namespace detail

/// Progress of long calls, and their cancellation from any thread.
class control {
public:
    /// What a callback is told: wsp_progress. It returns false to cancel.
    using callback = std::function<bool(const wsp_progress&)>;

    control() : control(callback()) {}
    /// A control that tells of progress.
    explicit control(callback progress)
        : progress_(progress ? std::make_unique<callback>(std::move(progress)) : nullptr) {
        wsp_control* made = nullptr;
        check(wsp_control_new(progress_ ? &told : nullptr, progress_.get(), &made));
        handle_.reset(made);
    }

    /// Told line by line what calls do; `level` is WSP_LOG_INFO or WSP_LOG_WARNING. What it throws cancels its call and comes out of it.
    using log = std::function<void(std::uint32_t level, const char* text)>;
    /// For calls that begin from now on; an empty function takes the log away. Not while a call with this control runs.
    void set_log(log lines) {
        auto next = lines ? std::make_unique<logger>(logger{std::move(lines), handle_.get()}) : nullptr;
        check(wsp_control_set_log(handle_.get(), next ? &logged : nullptr, next.get()));
        log_ = std::move(next);
    }

    /// Asks every call with this control to stop, until it is reset. Any thread may.
    void cancel() { check(wsp_control_cancel(handle_.get())); }
    /// Takes a cancellation back, also that of a callback that returned false or threw.
    void reset() { check(wsp_control_reset(handle_.get())); }

    /// The C handle, which stays this object's.
    wsp_control* get() const noexcept { return handle_.get(); }

private:
    static std::int32_t told(void* user, const wsp_progress* progress) noexcept {
        try {
            return (*static_cast<callback*>(user))(*progress) ? 0 : 1;
        } catch (...) {
            detail::running_call::keep_exception();
            return 1;
        }
    }

    struct logger {
        log lines;
        wsp_control* control;
    };

    static void logged(void* user, std::uint32_t level, const char* text) noexcept {
        auto& to = *static_cast<logger*>(user);
        try {
            to.lines(level, text);
        } catch (...) {
            detail::running_call::keep_exception();
            wsp_control_cancel(to.control);
        }
    }

    std::unique_ptr<logger> log_;  // before the handle, which refers to them
    std::unique_ptr<callback> progress_;
    detail::handle<wsp_control, wsp_control_free> handle_;
};

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

    /// Joins neighbours whose normals differ by at most so many degrees. How many facets there are then: they get new positions.
    std::size_t join_coplanar(double degrees) {
        std::size_t facets = 0;
        wsp::check(wsp_plc_join_coplanar(get(), degrees, &facets));
        return facets;
    }
    /// WSP_DONE, or WSP_CANCELLED: then the complex is as it was.
    wsp_status join_coplanar(double degrees, const control& control) {
        detail::running_call call;
        return call.finish(wsp_plc_join_coplanar_within(get(), degrees, control.get(), nullptr));
    }

    /// The C handle, which stays this object's.
    wsp_plc* get() const noexcept { return handle_.get(); }

private:
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

#endif  // WELLSPACED_WELLSPACED_HPP
