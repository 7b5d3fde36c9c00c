// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced/cpp/basics.hpp: errors, points, and the spans that lists are given as. Included by wellspaced/wellspaced.hpp.

#ifndef WELLSPACED_CPP_BASICS_HPP
#define WELLSPACED_CPP_BASICS_HPP

#include "../../wellspaced.h"

#include <array>
#include <cstddef>
#include <exception>
#include <iterator>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

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

}  // namespace wsp

#endif  // WELLSPACED_CPP_BASICS_HPP
