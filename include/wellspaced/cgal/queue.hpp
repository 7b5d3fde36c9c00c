// SPDX-License-Identifier: MIT OR Apache-2.0
//
// wellspaced/cgal/queue.hpp: the queue of bad cells, the one with the shortest shortest edge first, among equals by their vertices' numbers.
// Included by wellspaced/cgal.hpp.
//
// Most die before their turn: they wait unsorted in buckets 1.6 % wide, as in src/refine/queue.rs, as little more than their places. When it is their
// turn most have gone, which hashes of their vertices tell; the rest is looked at anew. Numbers are looked up only for those of one
// length whose turn it is.

#ifndef WELLSPACED_CGAL_QUEUE_HPP
#define WELLSPACED_CGAL_QUEUE_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "geometry.hpp"
#include "numbers.hpp"

namespace wellspaced {
namespace cgal {
namespace detail {

template <class Dt>
class queue {
public:
    using cell = typename Dt::Cell_handle;
    using vertex = typename Dt::Vertex_handle;

    // A cell as it was when it was queued.
    struct entry {
        double squared;
        cell at;
        std::array<vertex, 4> v;
    };
    using vertex_numbers = std::array<std::uint32_t, 4>;

    queue(const Dt& dt, const numbers<vertex>& of) : dt_(dt), numbers_(of) {}

    void push(cell c, double squared) {
        const entry e = entry_of(c, squared);
        const std::uint32_t in = bucket(squared);
        if (in > current_)
            list(in).push_back({e.at, hash(e.v)});
        else if (!group_.empty() && squared == group_.front().e.squared)
            join(e);
        else
            push_now(e);
        ++count_;
    }

    // The next cell that is still there, and its vertices' numbers. `judge` is asked about cells: the square of a bad one's shortest edge, or
    // anything negative for one that is not to be mended.
    template <class Judge>
    bool pop(entry& e, vertex_numbers& n, const Judge& judge) {
        for (;;) {
            if (count_ == 0) return false;
            while (first_ < lists_.size() && lists_[first_].empty()) ++first_;
            const bool idle = group_.empty() && heap_.empty();
            if (idle && first_ < lists_.size()) {
                turn(judge);
                continue;
            }
            if (!heap_.empty() && !group_.empty() && heap_.front().squared < group_.front().e.squared) dissolve();
            if (group_.empty()) assemble();
            if (choose(e, n)) return true;
        }
    }
    bool empty() const { return count_ == 0; }

    // Whether the cell is still what it was: its memory stays, but may serve another cell now or none.
    bool is_live(const entry& e) const {
        if (!dt_.tds().cells().is_used(e.at)) return false;
        for (int i = 0; i < 4; ++i)
            if (e.at->vertex(i) != e.v[i]) return false;
        return true;
    }

private:
    // A cell whose turn is far.
    struct waiting {
        cell at;
        std::uint32_t hash;
    };
    // What the heap moves about of an entry.
    struct ticket {
        double squared;
        std::uint32_t place;
        bool operator<(const ticket& other) const { return squared > other.squared; }
    };
    // One of several cells of the same length, most often of one edge.
    struct member {
        entry e;
        vertex_numbers n, sorted;
        bool operator<(const member& other) const { return sorted > other.sorted; }
    };

    static entry entry_of(cell c, double squared) {
        return {squared, c, {c->vertex(0), c->vertex(1), c->vertex(2), c->vertex(3)}};
    }
    // What tells most cells from those that come to their memory.
    static std::uint32_t hash(const std::array<vertex, 4>& v) {
        std::uint64_t h = 0;
        for (const vertex& w : v) h = (h + reinterpret_cast<std::uintptr_t>(&*w)) * 0x9E3779B97F4A7C15u;
        return static_cast<std::uint32_t>(h >> 32);
    }

    // Takes the first of the heap into the group, and all of their length.
    void assemble() {
        if (heap_.empty()) return;
        const double squared = heap_.front().squared;
        while (!heap_.empty() && heap_.front().squared == squared) {
            std::pop_heap(heap_.begin(), heap_.end());
            const entry e = now_[heap_.back().place];
            heap_.pop_back();
            if (is_live(e))
                join(e);
            else
                --count_;
        }
        if (!heap_.empty()) fetch(now_[heap_.front().place].at);
    }
    // Puts the group back.
    void dissolve() {
        for (const member& m : group_) push_now(m.e);
        group_.clear();
    }
    void join(const entry& e) {
        member m{e, {}, {}};
        for (int i = 0; i < 4; ++i) m.n[i] = numbers_.find(e.v[i]);
        m.sorted = m.n;
        const auto order = [&](int i, int j) {
            if (m.sorted[j] < m.sorted[i]) std::swap(m.sorted[i], m.sorted[j]);
        };
        order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
        group_.push_back(m);
        std::push_heap(group_.begin(), group_.end());
    }
    // The first of the group by its numbers. False if that has gone.
    bool choose(entry& e, vertex_numbers& n) {
        if (group_.empty()) return false;
        std::pop_heap(group_.begin(), group_.end());
        e = group_.back().e;
        n = group_.back().n;
        group_.pop_back();
        --count_;
        return is_live(e);
    }

    // Exponent and six bits of the mantissa.
    static std::uint32_t bucket(double squared) {
        std::uint64_t bits;
        std::memcpy(&bits, &squared, sizeof bits);
        return static_cast<std::uint32_t>(bits >> 46);
    }
    std::vector<waiting>& list(std::uint32_t in) {
        if (lists_.empty()) base_ = in;
        if (in < base_) {
            std::vector<std::vector<waiting>> more(base_ - in + lists_.size());
            std::move(lists_.begin(), lists_.end(), more.begin() + (base_ - in));
            lists_.swap(more);
            base_ = in;
            first_ = 0;
        }
        if (in - base_ >= lists_.size()) lists_.resize(in - base_ + 1);
        first_ = (std::min)(first_, static_cast<std::size_t>(in - base_));
        return lists_[in - base_];
    }
    ticket ticket_of(const entry& e) {
        now_.push_back(e);
        return {e.squared, static_cast<std::uint32_t>(now_.size() - 1)};
    }
    void push_now(const entry& e) {
        heap_.push_back(ticket_of(e));
        std::push_heap(heap_.begin(), heap_.end());
    }
    // Makes the first waiting bucket the current one.
    template <class Judge>
    void turn(const Judge& judge) {
        next_.clear();
        next_.swap(lists_[first_]);
        current_ = base_ + static_cast<std::uint32_t>(first_);
        now_.clear();
        for (std::size_t i = 0; i < next_.size(); ++i) {
            if (i + 8 < next_.size()) fetch(next_[i + 8].at);
            const waiting& w = next_[i];
            --count_;
            if (!dt_.tds().cells().is_used(w.at)) continue;
            entry e = entry_of(w.at, 0);
            if (hash(e.v) != w.hash) continue;
            e.squared = judge(w.at);
            if (!(e.squared >= 0)) continue;
            ++count_;
            // Beside a bucket's border rounding may have it that the edge is longer than it was when the cell was queued.
            if (bucket(e.squared) > current_)
                list(bucket(e.squared)).push_back(w);
            else
                heap_.push_back(ticket_of(e));
        }
        std::make_heap(heap_.begin(), heap_.end());
    }

    const Dt& dt_;
    const numbers<vertex>& numbers_;
    std::vector<ticket> heap_;  // the current bucket's, and any shorter that have come since
    std::vector<member> group_;  // a heap too: all of one length, no longer than the others'
    std::vector<waiting> next_;
    std::vector<entry> now_;  // those of the heap, and others gone
    std::uint32_t current_ = 0, base_ = 0;
    std::vector<std::vector<waiting>> lists_;
    std::size_t first_ = 0;  // none before it has any
    std::size_t count_ = 0;
};

}  // namespace detail
}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_QUEUE_HPP
