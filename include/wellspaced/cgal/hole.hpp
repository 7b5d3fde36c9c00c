// SPDX-License-Identifier: MIT OR Apache-2.0
//
// wellspaced/cgal/hole.hpp: insertion into a CGAL triangulation as two steps, with a look between them. Included by wellspaced/cgal.hpp.
//
// The cells in conflict with a point are searched from one of them through their faces; each face of their outline becomes a cell with the
// point (A. Bowyer, D. F. Watson, both The Computer Journal 24, 1981). dt.find_conflicts and insert_in_hole do the same, but
// copy their lists and know nothing of what the refinement wants to know: here the vertices of the cells are gathered once, with their
// differences from the point, which serve the search itself, distances, encroachment and the quality of the cells to come, before anything
// changes. Cells are marked with the data that CGAL's cells have for that (`tds_data`), which are clear again when the search is over. Where
// floating point can't say whether a cell is in conflict, dt.side_of_sphere does, with CGAL's perturbation.
// The star is filled with the operations that CGAL documents for its data structure; cells meet across an edge of the outline, found in a
// table of pairs of its vertices, or where there are very many by sorting them.

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
        std::size_t star;  // its place in it
        double squared;
    };

    hole(Dt& dt, double radius_edge) : dt_(dt), radius_edge_(radius_edge), bound4_(4 * radius_edge * radius_edge) {}

    // What a vertex around the hole is, seen from the point: `from` is the way from there, `squared` its squared length. Of the infinite vertex
    // that is infinite.
    struct corner {
        vertex v;
        vec at, from;
        double squared;
    };
    // Places of corners in `corners()`.
    using place = std::uint32_t;

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
        return true;
    }

    const point& at() const { return at_; }
    const vec& place_of_point() const { return place_; }
    // The cells in conflict, and the places of the corners of each.
    const std::vector<cell>& cells() const { return cells_; }
    const std::vector<std::array<place, 4>>& cell_corners() const { return cell_corners_; }
    // The vertices of the cells in conflict, each once.
    const std::vector<corner>& corners() const { return corners_; }
    // The square of the distance to the nearest vertex.
    double clearance() const {
        double least = std::numeric_limits<double>::infinity();
        for (const corner& c : corners_)
            if (c.squared < least) least = c.squared;
        return least;
    }

    // Inserts the point. Nothing has changed when memory is out.
    vertex fill() {
        auto& tds = dt_.tds();
        star_.clear();
        // As wide as this hole needs it: rows that are far apart share no cache lines.
        const std::size_t width = corners_.size();
        const bool is_large = width > most_in_table;
        if (is_large)
            sort_sides();
        else if (open_.size() < width * width)
            open_.assign(2 * width * width, std::uint32_t(none));
        const vertex v = tds.create_vertex();
        v->set_point(at_);
        try {
            star_.reserve(outline_.size());
            for (const facet& f : outline_) {
                const std::array<place, 3>& c = labels_[star_.size()];
                vertex of[4];
                of[f.second] = v;
                for (int k = 0; k < 3; ++k) of[(f.second + 1 + k) & 3] = corners_[c[k]].v;
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
            const std::array<place, 3>& c = labels_[n];
            for (place k : c) corners_[k].v->set_cell(made);
            if (is_large) continue;
            for (int k = 0; k < 3; ++k) {
                const side s = side_of(n, k);
                std::uint32_t& open = open_[s.a * width + s.b];
                if (open == none) {
                    open = s.here;
                } else {
                    meet(s.here, open);
                    open = none;
                }
            }
        }
        if (is_large)
            for (std::size_t n = 0; n + 1 < sides_.size(); n += 2) meet(sides_[n].second, sides_[n + 1].second);
        v->set_cell(star_.front());
        tds.delete_cells(cells_.begin(), cells_.end());
        return v;
    }

    // The cells at the new vertex, in each of them its slot, and the places of the three corners in the slots that follow it.
    const std::vector<cell>& star() const { return star_; }
    int slot_in_star(std::size_t n) const { return outline_[n].second; }
    const std::array<place, 3>& star_corners(std::size_t n) const { return labels_[n]; }
    // Those of them that are bad.
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
            bad_.push_back({n, edge});
        }
        return bad_;
    }

private:
    static constexpr std::uint32_t none = 0xFFFFFFFF;
    // Of more vertices a table would take more than four megabytes.
    static constexpr std::size_t most_in_table = 1024;

    // A side of a face of the outline: its vertices, the lower place first, and four times the face's place and the slot of the star's cell that it is
    // across from.
    struct side {
        place a, b;
        std::uint32_t here;
    };
    // Corner k of a face is in slot (slot + 1 + k) & 3 of the star's cell; the neighbour across it shares the other two.
    side side_of(std::size_t n, int k) const {
        const std::array<place, 3>& c = labels_[n];
        const place a = c[(k + 1) % 3], b = c[(k + 2) % 3];
        const std::uint32_t slot = static_cast<std::uint32_t>((outline_[n].second + 1 + k) & 3);
        return {(std::min)(a, b), (std::max)(a, b), static_cast<std::uint32_t>(4 * n) + slot};
    }
    // All of them by their vertices: in order, each is there from both sides.
    void sort_sides() {
        sides_.clear();
        sides_.reserve(3 * labels_.size());
        for (std::size_t n = 0; n < labels_.size(); ++n)
            for (int k = 0; k < 3; ++k) {
                const side s = side_of(n, k);
                sides_.emplace_back(std::uint64_t(s.a) << 32 | s.b, s.here);
            }
        std::sort(sides_.begin(), sides_.end());
    }
    // Makes two cells of the star neighbours, each given as four times its place in it and the slot.
    void meet(std::uint32_t a, std::uint32_t b) {
        star_[a / 4]->set_neighbor(static_cast<int>(a % 4), star_[b / 4]);
        star_[b / 4]->set_neighbor(static_cast<int>(b % 4), star_[a / 4]);
    }
    // Whether the user's coordinates are doubles, so that differences of them are what they seem.
    static constexpr bool is_double = std::is_same<typename Dt::Geom_traits::FT, double>::value;
    struct label {
        vertex v;
        std::uint32_t turn = 0;
        place number = 0;
        label() = default;
        label(vertex of, std::uint32_t in, place at) : v(of), turn(in), number(at) {}
    };

    // Whether a finite cell's circumsphere holds the point, after CGAL's perturbation.
    bool conflicts(cell c) const {
        if (is_double) {
            vec q[4];
            double ww[4];
            for (int k = 0; k < 4; ++k) {
                q[k] = to_vec(c->vertex(k)->point()) - place_;
                ww[k] = dot(q[k], q[k]);
            }
            const int found = in_sphere(q[0], q[1], q[2], q[3], ww[0], ww[1], ww[2], ww[3]);
            if (found != 0) return found > 0;
        }
        // CGAL has no answer for a cell's own corner, which is in conflict with nothing.
        for (int k = 0; k < 4; ++k)
            if (c->vertex(k)->point() == at_) return false;
        return dt_.side_of_sphere(c, at_, true) == CGAL::ON_BOUNDED_SIDE;
    }
    // Whether that is so of the neighbour across the face opposite slot `k` of a cell in conflict. `apex` is the neighbour's fourth vertex; the others
    // are corners already. With it in that slot of the cell, the corners are those of the neighbour negatively oriented; in the order that begins at
    // slot k once more so if k is odd. An infinite cell is in conflict with what lies beyond its finite face; so it is with what is just
    // on it, if that is in the face's circle.
    bool conflicts(cell across, const std::array<place, 4>& own, int k, const corner& apex) const {
        if (is_double) {
            const corner &a = corners_[own[(k + 1) & 3]], &b = corners_[own[(k + 2) & 3]], &c = corners_[own[(k + 3) & 3]];
            if (apex.v == infinite_) return beyond(across, a, b, c, (k & 1) != 0);
            if (a.v == infinite_) return beyond(across, apex, b, c, (k & 1) == 0);
            if (b.v == infinite_) return beyond(across, apex, a, c, (k & 1) != 0);
            if (c.v == infinite_) return beyond(across, apex, a, b, (k & 1) == 0);
            const int found = in_sphere(apex.from, a.from, b.from, c.from, apex.squared, a.squared, b.squared, c.squared);
            if (found != 0) return (found > 0) == ((k & 1) != 0);
        }
        return dt_.side_of_sphere(across, at_, true) == CGAL::ON_BOUNDED_SIDE;
    }

    // The same for an infinite cell with the finite face a b c, from the other side of which the point is seen as `positive` says.
    bool beyond(cell across, const corner& a, const corner& b, const corner& c, bool positive) const {
        const int side = orientation(a.from, b.from, c.from, a.squared, b.squared, c.squared);
        if (side != 0) return (side > 0) == positive;
        for (int axis = 0; axis < 3; ++axis)
            if (a.at[axis] == place_[axis] && b.at[axis] == place_[axis] && c.at[axis] == place_[axis]) {
                const int found = in_circle(a.from, b.from, c.from, a.squared, b.squared, c.squared, axis);
                if (found != 0) return found > 0;
            }
        return dt_.side_of_sphere(across, at_, true) == CGAL::ON_BOUNDED_SIDE;
    }

    // Takes the marks of a search out of the cells again, also when the exact arithmetic runs out of memory.
    struct unmark {
        const hole& of;
        ~unmark() {
            for (const cell& c : of.cells_) c->tds_data().clear();
            for (const facet& f : of.outline_) f.first->neighbor(f.second)->tds_data().clear();
        }
    };

    // Cells are marked as CGAL's own search marks them: in conflict, or looked at and not.
    void search(cell start) {
        cells_.clear();
        cell_corners_.clear();
        outline_.clear();
        labels_.clear();
        corners_.clear();
        if (++turn_ == 0) table_.assign(table_.size(), {}), turn_ = 1;
        const unmark marks{*this};
        cells_.push_back(start);
        for (int j = 0; j < 4; ++j) fetch(start->neighbor(j));
        start->tds_data().mark_in_conflict();
        std::array<place, 4> own;
        corner apex;
        for (int k = 0; k < 4; ++k) {
            look_at(start->vertex(k), apex);
            own[k] = place_at(apex);
        }
        cell_corners_.push_back(own);
        for (std::size_t n = 0; n < cells_.size(); ++n) {
            const cell c = cells_[n];
            own = cell_corners_[n];
            // The cell that led here is in conflict, too.
            for (int k = 0; k < 4; ++k) {
                const cell across = c->neighbor(k);
                auto& mark = across->tds_data();
                if (mark.is_in_conflict()) continue;
                if (mark.is_clear()) {
                    const int opposite = across->index(c);
                    look_at(across->vertex(opposite), apex);
                    if (conflicts(across, own, k, apex)) {
                        add(across, opposite, own, k, apex);
                        mark.mark_in_conflict();
                        continue;
                    }
                }
                outline_.emplace_back(c, k);
                labels_.push_back({own[(k + 1) & 3], own[(k + 2) & 3], own[(k + 3) & 3]});
                mark.mark_on_boundary();
            }
        }
    }
    // A further cell in conflict, across slot `k` of one with the corners `own`.
    void add(cell c, int opposite, const std::array<place, 4>& own, int k, const corner& apex) {
        std::array<place, 4> places;
        const place a = own[(k + 1) & 3], b = own[(k + 2) & 3], d = own[(k + 3) & 3];
        const vertex at_a = corners_[a].v, at_b = corners_[b].v;
        for (int i = 0; i < 4; ++i) {
            if (i == opposite) continue;
            const vertex v = c->vertex(i);
            places[i] = v == at_a ? a : v == at_b ? b : d;
            fetch(c->neighbor(i));
        }
        places[opposite] = place_at(apex);
        cells_.push_back(c);
        cell_corners_.push_back(places);
    }

    void look_at(vertex v, corner& c) const {
        c.v = v;
        if (v == infinite_) {
            c.at = c.from = vec{};
            c.squared = std::numeric_limits<double>::infinity();
            return;
        }
        c.at = to_vec(v->point());
        c.from = c.at - place_;
        c.squared = dot(c.from, c.from);
    }
    // The place of a corner, a new one if it has none.
    place place_at(const corner& c) {
        if (table_.size() < 4 * (corners_.size() + 1)) {
            table_ = std::vector<label>(2 * table_.size());
            for (std::size_t n = 0; n < corners_.size(); ++n) label_of(corners_[n].v) = {corners_[n].v, turn_, static_cast<place>(n)};
        }
        label& l = label_of(c.v);
        if (l.turn != turn_) {
            l = {c.v, turn_, static_cast<place>(corners_.size())};
            corners_.push_back(c);
        }
        return l.number;
    }
    label& label_of(vertex v) {
        const std::uintptr_t hash = (reinterpret_cast<std::uintptr_t>(&*v) >> 3) * 0x9E3779B97F4A7C15u >> 32;
        for (std::size_t i = hash;; ++i) {
            label& l = table_[i & (table_.size() - 1)];
            if (l.turn != turn_ || l.v == v) return l;
        }
    }

    Dt& dt_;
    const double radius_edge_, bound4_;
    vec place_{};
    point at_;
    vertex infinite_;
    std::vector<cell> cells_, star_;
    std::vector<std::array<place, 4>> cell_corners_;
    std::vector<facet> outline_;
    std::vector<corner> corners_;
    std::vector<std::array<place, 3>> labels_;  // the corners of each face of the outline
    std::vector<label> table_ = std::vector<label>(256);
    std::uint32_t turn_ = 0;
    std::vector<std::uint32_t> open_;  // by two vertices: the cell and slot that wait for the other side, all `none` between calls
    std::vector<std::pair<std::uint64_t, std::uint32_t>> sides_;  // where there are very many
    std::vector<bad_cell> bad_;
};

}  // namespace detail
}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_HOLE_HPP
