// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced/cpp/control.hpp: options and reports, and the control of long calls. Included by wellspaced/wellspaced.hpp.

#ifndef WELLSPACED_CPP_CONTROL_HPP
#define WELLSPACED_CPP_CONTROL_HPP

#include "../../wellspaced.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "basics.hpp"

namespace wsp {

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

}  // namespace wsp

#endif  // WELLSPACED_CPP_CONTROL_HPP
