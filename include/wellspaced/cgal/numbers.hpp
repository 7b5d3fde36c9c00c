// SPDX-License-Identifier: MIT OR Apache-2.0
//
// wellspaced/cgal/numbers.hpp: numbers for vertices, 0, 1, 2, … in the order in which they are told. Included by wellspaced/cgal.hpp.
//
// CGAL's vertices have none, and their addresses say nothing. Where lengths are equal, numbers decide, as ids do in the
// library's own refinement: so both take the same way. A table with linear probing (D. Knuth, TAOCP 3, 6.4); nothing is ever taken out.

#ifndef WELLSPACED_CGAL_NUMBERS_HPP
#define WELLSPACED_CGAL_NUMBERS_HPP

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace wellspaced {
namespace cgal {
namespace detail {

template <class Handle>
class numbers {
public:
    static constexpr std::uint32_t none = 0xFFFFFFFF;

    // At least `room` places for each handle, a power of two.
    explicit numbers(std::size_t room = 2) : room_(room), slots_(64) {}

    std::uint32_t find(Handle h) const {
        for (std::size_t i = hash(h);; ++i) {
            const slot& s = slots_[i & (slots_.size() - 1)];
            if (s.number == none || s.handle == h) return s.number;
        }
    }

    // Tells a new handle, and returns its number.
    std::uint32_t add(Handle h) {
        if (room_ * (count_ + 1) > slots_.size()) {
            std::vector<slot> old(2 * slots_.size());
            old.swap(slots_);
            for (const slot& s : old)
                if (s.number != none) put(s);
        }
        put({h, count_});
        return count_++;
    }

private:
    struct slot {
        Handle handle;
        std::uint32_t number = none;
        slot() = default;
        slot(Handle h, std::uint32_t n) : handle(h), number(n) {}
    };

    static std::size_t hash(Handle h) {
        return static_cast<std::size_t>((reinterpret_cast<std::uintptr_t>(&*h) >> 3) * 0x9E3779B97F4A7C15u >> 32);
    }
    void put(const slot& s) {
        std::size_t i = hash(s.handle) & (slots_.size() - 1);
        while (slots_[i].number != none) i = (i + 1) & (slots_.size() - 1);
        slots_[i] = s;
    }

    std::size_t room_;
    std::uint32_t count_ = 0;
    std::vector<slot> slots_;
};

}  // namespace detail
}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_NUMBERS_HPP
