// SPDX-License-Identifier: MIT OR Apache-2.0
//
// wellspaced/cgal/hole.hpp: insertion into a CGAL triangulation as two steps, with a look between them. Included by wellspaced/cgal.hpp.
//
// The cells in conflict with a point are searched from one of them through their faces; each face of their outline becomes a cell with the
// point (A. Bowyer, D. F. Watson, both The Computer Journal 24, 1981). dt.find_conflicts and insert_in_hole do the same, but
// mark each cell twice and copy their lists, and know nothing of what the refinement wants to know: here the outline's vertices are gathered
// once, with their differences from the point, so that distances, encroachment and the quality of the cells to come are known before
// anything changes. Where floating point can't say whether a cell is in conflict, dt.side_of_sphere does, with CGAL's perturbation.
// The star is filled with the operations that CGAL documents for its data structure; cells meet across an edge of the outline, found in a
// table of pairs of its vertices.

#ifndef WELLSPACED_CGAL_HOLE_HPP
#define WELLSPACED_CGAL_HOLE_HPP

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "geometry.hpp"

namespace wellspaced {
namespace cgal {
namespace detail {

template <class Dt>
class hole {
public:
    using vertex = typename Dt::Vertex_handle;
    using cell = typename Dt::Cell_handle;
    using facet = typename Dt::Facet;
    using point = typename Dt::Point;

    // A bad cell that the insertion has made, and the square of its shortest edge.
    struct bad_cell {
        cell at;
        double squared;
    };

    hole(Dt& dt, double radius_edge) : dt_(dt), radius_edge_(radius_edge), bound4_(4 * radius_edge * radius_edge) {}

    // Looks at what inserting `p` would do. `near` is a cell near it. False where there is a vertex at `p`.
    bool find(const vec& p, cell near) {
        place_ = p;
        at_ = point(p[0], p[1], p[2]);
        infinite_ = dt_.infinite_vertex();
        cell start = near;
        if (dt_.is_infinite(near) || !conflicts(near)) {
            typename Dt::Locate_type type;
            int i, j;
            start = dt_.locate(at_, type, i, j, near);
            if (type == Dt::VERTEX) return false;
        }
        search(start);
        gather();
        return true;
    }

    const point& at() const { return at_; }
    const std::vector<cell>& cells() const { return cells_; }
    // How many of the vertices around the hole pass a test.
    template <class Test>
    std::size_t count(const Test& test) const {
        std::size_t n = 0;
        for (const corner& c : corners_) n += test(c.v);
        return n;
    }
    // The square of the distance to the nearest vertex.
    double clearance() const {
        double least = std::numeric_limits<double>::infinity();
        for (const corner& c : corners_)
            if (c.v != infinite_ && c.squared < least) least = c.squared;
        return least;
    }

    // Inserts the point. Nothing has changed when memory is out.
    vertex fill() {
        auto& tds = dt_.tds();
        star_.clear();
        const vertex v = tds.create_vertex();
        v->set_point(at_);
        try {
            star_.reserve(outline_.size());
            for (const facet& f : outline_) {
                vertex of[4];
                for (int k = 0; k < 4; ++k) of[k] = k == f.second ? v : f.first->vertex(k);
                star_.push_back(tds.create_cell(of[0], of[1], of[2], of[3]));
            }
        } catch (...) {
            tds.delete_cells(star_.begin(), star_.end());
            tds.delete_vertex(v);
            throw;
        }
        for (std::size_t n = 0; n < outline_.size(); ++n) {
            const cell inner = outline_[n].first, made = star_[n];
            const int slot = outline_[n].second;
            const cell beyond = inner->neighbor(slot);
            beyond->set_neighbor(beyond->index(inner), made);
            made->set_neighbor(slot, beyond);
            const std::array<std::uint32_t, 3>& c = labels_[n];
            // c[k] is in slot (slot + 1 + k) & 3; the neighbour across it shares the other two.
            for (int k = 0; k < 3; ++k) {
                std::uint32_t a = c[(k + 1) % 3], b = c[(k + 2) % 3];
                if (b < a) std::swap(a, b);
                std::uint32_t& open = open_[a * width_ + b];
                const std::uint32_t here = static_cast<std::uint32_t>(4 * n) + static_cast<std::uint32_t>((slot + 1 + k) & 3);
                if (open == none) {
                    open = here;
                } else {
                    const cell other = star_[open / 4];
                    made->set_neighbor(static_cast<int>(here % 4), other);
                    other->set_neighbor(static_cast<int>(open % 4), made);
                    open = none;
                }
            }
        }
        for (const corner& c : corners_) c.v->set_cell(star_[c.face]);
        v->set_cell(star_.front());
        tds.delete_cells(cells_.begin(), cells_.end());
        return v;
    }

    // The cells at the new vertex, and those of them that are bad.
    const std::vector<cell>& star() const { return star_; }
    const std::vector<bad_cell>& judged() {
        bad_.clear();
        for (std::size_t n = 0; n < labels_.size(); ++n) {
            const corner &a = corners_[labels_[n][0]], &b = corners_[labels_[n][1]], &c = corners_[labels_[n][2]];
            if (a.v == infinite_ || b.v == infinite_ || c.v == infinite_) continue;
            const double edge = (std::min)({a.squared, b.squared, c.squared, squared_distance(a.at, b.at),
                                            squared_distance(a.at, c.at), squared_distance(b.at, c.at)});
            const judgement found =
                judge(a.from, b.from, c.from, a.squared, b.squared, c.squared, edge, bound4_);
            if (found == judgement::no || (found == judgement::unsure && !is_bad({place_, a.at, b.at, c.at}, radius_edge_)))
                continue;
            bad_.push_back({star_[n], edge});
        }
        return bad_;
    }

private:
    static constexpr std::uint32_t none = 0xFFFFFFFF;
    // Whether the user's coordinates are doubles, so that differences of them are what they seem.
    static constexpr bool is_double = std::is_same<typename Dt::Geom_traits::FT, double>::value;
    struct corner {
        vertex v;
        vec at, from;
        double squared;
        std::size_t face;  // one of the outline that it is at
    };
    struct visited {
        cell at;
        std::uint32_t search = 0, inside = 0;
    };
    struct label {
        vertex v;
        std::uint32_t turn = 0, number = 0;
    };

    // Whether a cell's circumsphere holds the point, after CGAL's perturbation.
    bool conflicts(cell c) const {
        if (is_double) {
            vec q[4];
            double ww[4], most = 0;
            for (int k = 0; k < 4; ++k) {
                const vertex v = c->vertex(k);
                if (v == infinite_) return dt_.side_of_sphere(c, at_, true) == CGAL::ON_BOUNDED_SIDE;
                q[k] = to_vec(v->point()) - place_;
                ww[k] = dot(q[k], q[k]);
                if (ww[k] > most) most = ww[k];
            }
            const int found = in_sphere(q, ww, most);
            if (found != 0) return found > 0;
        }
        return dt_.side_of_sphere(c, at_, true) == CGAL::ON_BOUNDED_SIDE;
    }

    void search(cell start) {
        cells_.clear();
        outline_.clear();
        if (++search_ == 0) seen_.assign(seen_.size(), {}), search_ = 1;
        seen_count_ = 0;
        cells_.push_back(start);
        for (int j = 0; j < 4; ++j) fetch(start->neighbor(j));
        see(start).inside = 1;
        for (std::size_t n = 0; n < cells_.size(); ++n)
            for (int k = 0; k < 4; ++k) {
                const cell c = cells_[n], across = c->neighbor(k);
                const std::size_t before = seen_count_;
                visited& seen = see(across);
                if (seen_count_ != before && conflicts(across)) {
                    seen.inside = 1;
                    cells_.push_back(across);
                    for (int j = 0; j < 4; ++j) fetch(across->neighbor(j));
                }
                if (seen.inside == 0) outline_.emplace_back(c, k);
            }
    }
    // What is known of a cell; a new entry if it has not been seen.
    visited& see(cell c) {
        if (4 * seen_count_ > 3 * seen_.size()) {
            std::vector<visited> old(2 * seen_.size());
            old.swap(seen_);
            for (const visited& v : old)
                if (v.search == search_) place_of(v.at) = v;
        }
        visited& found = place_of(c);
        if (found.search != search_) {
            found.at = c;
            found.search = search_;
            found.inside = 0;
            ++seen_count_;
        }
        return found;
    }
    visited& place_of(cell c) {
        std::size_t i = (reinterpret_cast<std::uintptr_t>(&*c) >> 3) * 0x9E3779B97F4A7C15u >> 32;
        for (;; ++i) {
            visited& v = seen_[i & (seen_.size() - 1)];
            if (v.search != search_ || v.at == c) return v;
        }
    }

    // The outline's vertices, each once.
    void gather() {
        corners_.clear();
        labels_.clear();
        // By Euler's formula: n vertices, 2n - 4 faces.
        const std::size_t most = outline_.size() / 2 + 2;
        while (table_.size() < 4 * most) table_ = std::vector<label>(2 * table_.size());
        if (width_ < most) {
            width_ = 2 * most;
            open_.assign(width_ * width_, std::uint32_t(none));
        }
        if (++turn_ == 0) table_.assign(table_.size(), {}), turn_ = 1;
        for (const facet& f : outline_) {
            std::array<std::uint32_t, 3> three;
            for (int k = 0; k < 3; ++k) three[k] = label_of(f.first->vertex((f.second + 1 + k) & 3));
            labels_.push_back(three);
        }
    }
    std::uint32_t label_of(vertex v) {
        const std::uintptr_t hash = (reinterpret_cast<std::uintptr_t>(&*v) >> 3) * 0x9E3779B97F4A7C15u >> 32;
        for (std::size_t i = hash;; ++i) {
            label& l = table_[i & (table_.size() - 1)];
            if (l.turn != turn_) {
                l.v = v;
                l.turn = turn_;
                l.number = static_cast<std::uint32_t>(corners_.size());
                corner c{v, {}, {}, 0, labels_.size()};
                if (v != infinite_) {
                    c.at = to_vec(v->point());
                    c.from = c.at - place_;
                    c.squared = dot(c.from, c.from);
                }
                corners_.push_back(c);
                return l.number;
            }
            if (l.v == v) return l.number;
        }
    }

    Dt& dt_;
    const double radius_edge_, bound4_;
    vec place_{};
    point at_;
    vertex infinite_;
    std::vector<visited> seen_ = std::vector<visited>(256);  // those of search number `search_`
    std::uint32_t search_ = 0;
    std::size_t seen_count_ = 0;
    std::vector<cell> cells_, star_;
    std::vector<facet> outline_;
    std::vector<corner> corners_;
    std::vector<std::array<std::uint32_t, 3>> labels_;  // of each face of the outline
    std::vector<label> table_ = std::vector<label>(256);
    std::uint32_t turn_ = 0;
    std::size_t width_ = 0;
    std::vector<std::uint32_t> open_;  // by two vertices: the cell and slot that wait for the other side, all `none` between calls
    std::vector<bad_cell> bad_;
};

}  // namespace detail
}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_HOLE_HPP
