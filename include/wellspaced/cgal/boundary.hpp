// SPDX-License-Identifier: MIT OR Apache-2.0
//
// wellspaced/cgal/boundary.hpp: the boundary of a domain within a CGAL triangulation. Included by wellspaced/cgal.hpp.
//
// The domain is a set of cells. The faces between its cells and the others are its subfacets; exactly coplanar neighbours
// are of one facet, and edges between facets are subsegments. Then each vertex knows the facets that it lies on, which is all that is
// kept but for the subsegments: a face of three vertices of one facet, with the domain on one side of it, is a subfacet, and
// a cell of four is flat. (A split of a slanted facet lies off its plane by rounding, which makes such cells. They are
// no part of the domain.)
//
// Small angles are treated as in wellspaced's own refinement: G. Miller, S. Pav, N. Walkington, "When and why Delaunay refinement
// algorithms work", IJCGA 15, 2005.

#ifndef WELLSPACED_CGAL_BOUNDARY_HPP
#define WELLSPACED_CGAL_BOUNDARY_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry.hpp"
#include "numbers.hpp"

namespace wellspaced {
namespace cgal {
namespace detail {

// Hashes of small arrays of handles.
template <std::size_t N>
struct handles_hash {
    template <class Handle>
    std::size_t operator()(const std::array<Handle, N>& handles) const noexcept {
        std::uint64_t h = 0;
        for (const Handle& handle : handles)
            h = (h ^ reinterpret_cast<std::uintptr_t>(&*handle) >> 4) * 0x9E3779B97F4A7C15u;
        return static_cast<std::size_t>(h ^ h >> 29);
    }
};

template <class Dt, class Domain>
class boundary {
public:
    using vertex = typename Dt::Vertex_handle;
    using cell = typename Dt::Cell_handle;
    using facet = typename Dt::Facet;
    using edge_key = std::array<vertex, 2>;
    using face_key = std::array<vertex, 3>;

    struct encroached {
        std::vector<edge_key> segments;
        std::vector<face_key> facets;
        bool empty() const { return segments.empty() && facets.empty(); }
        void clear() {
            segments.clear();
            facets.clear();
        }
    };

    struct info {
        vertex v;
        std::uint32_t number = 0;
        std::vector<int> facets;  // in order
        std::uint64_t mask = 0;   // a bit for each, the same for several where there are more than 64 facets
        int segment = -1;         // the segment that it lies inside
        int corner = -1;          // or its number as a corner, where segments end
        bool acute = false;
        bool on_segment() const { return segment >= 0 || corner >= 0; }
    };

    boundary(const Dt& dt, const Domain& domain, const numbers<vertex>& of) : dt_(dt), domain_(domain), numbers_(of) { find(); }

    // What is known of a vertex of the boundary; NULL for the others, which are nearly all.
    const info* look(vertex v) const {
        const std::uint32_t at = places_.find(v);
        return at == numbers<vertex>::none ? nullptr : &infos_[at];
    }

    // Keys name their vertices in order of their numbers.
    static edge_key key(const info* a, const info* b) {
        return a->number < b->number ? edge_key{a->v, b->v} : edge_key{b->v, a->v};
    }
    static face_key key(const info* a, const info* b, const info* c) {
        if (b->number < a->number) std::swap(a, b);
        if (c->number < b->number) std::swap(b, c);
        if (b->number < a->number) std::swap(a, b);
        return {a->v, b->v, c->v};
    }
    // The key of a face of vertices of the boundary.
    face_key key(const facet& f) const {
        return key(look(f.first->vertex((f.second + 1) & 3)), look(f.first->vertex((f.second + 2) & 3)),
                   look(f.first->vertex((f.second + 3) & 3)));
    }
    // Sorts keys by the numbers of their vertices, from `first` on.
    template <class List>
    void sort(List& list, std::size_t first = 0) const {
        if (list.size() < first + 2) return;
        using item = typename List::value_type;
        std::sort(list.begin() + static_cast<std::ptrdiff_t>(first), list.end(), [&](const item& a, const item& b) {
            return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), [&](vertex v, vertex w) {
                return look(v)->number < look(w)->number;
            });
        });
    }

    // Whether a cell is of the domain.
    bool contains(cell c) const { return !dt_.is_infinite(c) && !is_flat(c) && domain_(c); }
    // The same for one with a vertex that is not on the boundary, so that the cell can't be flat.
    bool contains_round(cell c) const { return !dt_.is_infinite(c) && domain_(c); }

    // Whether a face has the domain on one side only.
    bool is_wall(cell c, int slot) const {
        const info* v[3];
        for (int i = 0, n = 0; i < 4; ++i)
            if (i != slot && (v[n++] = look(c->vertex(i))) == nullptr) return false;
        return is_wall(c, slot, v[0], v[1], v[2]);
    }
    // The same where it is known what its vertices are.
    bool is_wall(cell c, int slot, const info* a, const info* b, const info* d) const {
        return common(a, b, d) >= 0 && contains(c) != contains(c->neighbor(slot));
    }

    bool is_segment(const edge_key& e) const { return segments_.count(e) != 0; }

    // Looks up the corners of a hole. Returns whether the cells in conflict lie in the domain.
    template <class Hole>
    bool look_around(const Hole& hole) {
        known_.clear();
        on_boundary_ = 0;
        for (const auto& corner : hole.corners()) {
            known_.push_back(look(corner.v));
            on_boundary_ += known_.back() != nullptr;
        }
        inside_.clear();
        bool all = true;
        for (std::size_t n = 0; n < hole.cells().size(); ++n) {
            const bool inside = contains(hole.cells()[n], hole.cell_corners()[n]);
            inside_.push_back(inside);
            all = all && inside;
        }
        return all;
    }
    // What is known of one of them.
    const info* known(std::size_t place) const { return known_[place]; }
    // Whether a cell is of the domain whose corners are at these places, or the vertex besides that `added` tells of.
    bool contains(cell c, const std::array<std::uint32_t, 4>& places) const {
        return contains(c, known_[places[0]], known_[places[1]], known_[places[2]], known_[places[3]]);
    }
    bool contains(cell c, const info* added, const std::array<std::uint32_t, 3>& places) const {
        return contains(c, added, known_[places[0]], known_[places[1]], known_[places[2]]);
    }

    // The subsegments that the point of the hole looked at last encroaches upon, in order.
    template <class Hole>
    void encroached_segments(const Hole& hole, std::vector<edge_key>& found) {
        found.clear();
        if (on_boundary_ < 2) return;
        // Pairs of vertices first, most of which are too far apart from the point for that, then whether they are ends of a subsegment.
        const auto& corners = hole.corners();
        on_segment_.clear();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (!known_[i] || !known_[i]->on_segment()) continue;
            for (std::size_t j : on_segment_) {
                const judgement near = in_ball(corners[i].from, corners[j].from);
                if (near == judgement::no) continue;
                const edge_key e = key(known_[i], known_[j]);
                if (is_segment(e) && are_neighbors(hole, i, j) &&
                    (near == judgement::yes || encroaches(e, hole.at(), hole.place_of_point())))
                    found.push_back(e);
            }
            on_segment_.push_back(i);
        }
        sort(found);
    }
    // And the subfacets.
    template <class Hole>
    void encroached_facets(const Hole& hole, std::vector<face_key>& found) const {
        found.clear();
        if (on_boundary_ < 3) return;
        const auto& corners = hole.corners();
        for (std::size_t n = 0; n < hole.cells().size(); ++n) {
            const auto& places = hole.cell_corners()[n];
            const info* const v[4] = {known_[places[0]], known_[places[1]], known_[places[2]], known_[places[3]]};
            if ((v[0] != nullptr) + (v[1] != nullptr) + (v[2] != nullptr) + (v[3] != nullptr) < 3) continue;
            for (int i = 0; i < 4; ++i) {
                const info *a = v[(i + 1) & 3], *b = v[(i + 2) & 3], *d = v[(i + 3) & 3];
                if (common(a, b, d) < 0) continue;
                const auto &p = corners[places[(i + 1) & 3]], &q = corners[places[(i + 2) & 3]], &r = corners[places[(i + 3) & 3]];
                const judgement near = in_ball(p.at, q.at, r.at, hole.place_of_point());
                if (near == judgement::no) continue;
                const face_key f = key(a, b, d);
                if (!has(found, f) && (inside_[n] != 0) != contains(hole.cells()[n]->neighbor(i)) &&
                    (near == judgement::yes || encroaches(f, hole.at(), hole.place_of_point())))
                    found.push_back(f);
            }
        }
        sort(found);
    }

    // Keeps the one element that `p` encroaches upon whose centre is nearest to it.
    void keep_nearest(const vec& p, encroached& found) const {
        const auto nearest = [](auto& list, const auto& distance) {
            if (list.size() < 2) return;
            const auto by = [&](const auto& a, const auto& b) { return distance(a) < distance(b); };
            list = {*std::min_element(list.begin(), list.end(), by)};
        };
        nearest(found.segments, [&](const edge_key& e) { return squared_distance(p, middle(e)); });
        nearest(found.facets, [&](const face_key& f) {
            return squared_distance(p, triangle_circumcenter(at(f[0]), at(f[1]), at(f[2])));
        });
    }

    // Where to split a subsegment: its middle, or with one acute end a power of two from there.
    vec split_point(const edge_key& e) const {
        const info *a = look(e[0]), *b = look(e[1]);
        if (a->acute == b->acute) return middle(e);
        const vec center = at(a->acute ? e[0] : e[1]), other = at(a->acute ? e[1] : e[0]);
        const double length = std::sqrt(squared_distance(center, other));
        const double radius = std::exp2(std::floor(std::log2(length * 2 / 3)));
        const vec along = other - center;
        const double share = radius / length;
        return {center[0] + along[0] * share, center[1] + along[1] * share, center[2] + along[2] * share};
    }

    // An edge whose length is given by an acute input angle.
    bool is_seditious(vertex a, vertex b) const {
        const info *v = look(a), *w = look(b);
        return v && w && meet_acutely(carrier(v), at(a), carrier(w), at(b));
    }

    bool vertex_encroaches(vertex v, const edge_key& e) const {
        return !dt_.is_infinite(v) && encroaches(e, v->point(), at(v)) && may_encroach(v, e);
    }
    bool vertex_encroaches(vertex v, const face_key& f) const {
        return !dt_.is_infinite(v) && encroaches(f, v->point(), at(v)) && may_encroach(v, f);
    }
    // Whether it does if it lies in the element's ball.
    bool may_encroach(vertex v, const edge_key& e) const {
        const auto segment = segments_.find(e);
        return segment != segments_.end() &&
               may_encroach(v, {carried_by::segment, segment->second}, middle(e));
    }
    bool may_encroach(vertex v, const face_key& f) const {
        const int facet_of = common(look(f[0]), look(f[1]), look(f[2]));
        const vec a = at(f[0]), b = at(f[1]), c = at(f[2]);
        return may_encroach(v, {carried_by::facet, facet_of},
                            {(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3});
    }

    // A vertex has come to split this subsegment: it lies on the facets that both ends are on.
    std::array<edge_key, 2> split(const edge_key& e, vertex v) {
        const int segment = segments_.at(e);
        segments_.erase(e);
        info& added = add(v);
        added.segment = segment;
        lie_on(added, segment_list_[segment].facets);
        const std::array<edge_key, 2> parts{key(look(e[0]), &added), key(look(e[1]), &added)};
        for (const edge_key& part : parts) segments_[part] = segment;
        return parts;
    }
    // A vertex has come to split this subfacet.
    void split(const face_key& f, vertex v) {
        const int facet_of = common(look(f[0]), look(f[1]), look(f[2]));
        lie_on(add(v), {facet_of});
    }

    const std::vector<edge_key>& first_segments() const { return first_segments_; }
    const std::vector<facet>& first_facets() const { return first_facets_; }

private:
    enum class carried_by { none, vertex, segment, facet };
    struct carrier_type {
        carried_by kind;
        int index;
        bool operator==(const carrier_type& other) const { return kind == other.kind && index == other.index; }
    };
    struct segment_info {
        std::vector<vertex> ends;
        std::vector<int> facets;
    };

    template <class List, class Item>
    static bool has(const List& list, const Item& item) {
        return std::find(list.begin(), list.end(), item) != list.end();
    }

    info& add(vertex v) {
        const std::uint32_t known = places_.find(v);
        if (known != numbers<vertex>::none) return infos_[known];
        places_.add(v);
        infos_.emplace_back();
        infos_.back().v = v;
        infos_.back().number = numbers_.find(v);
        return infos_.back();
    }

    static void lie_on(info& v, const std::vector<int>& facets) {
        v.facets = facets;
        v.mask = 0;
        for (int f : facets) v.mask |= std::uint64_t(1) << (f & 63);
    }

    bool contains(cell c, const info* v0, const info* v1, const info* v2, const info* v3) const {
        if (dt_.is_infinite(c)) return false;
        if (v0 && v1 && v2 && v3) {
            const info* const v[4] = {v0, v1, v2, v3};
            if (are_flat(v)) return false;
        }
        return domain_(c);
    }

    // Whether two corners of the hole are of one of its cells.
    template <class Hole>
    static bool are_neighbors(const Hole& hole, std::size_t i, std::size_t j) {
        for (const auto& places : hole.cell_corners())
            if (std::count(places.begin(), places.end(), i) + std::count(places.begin(), places.end(), j) == 2) return true;
        return false;
    }

    // A facet that all three are on, or -1.
    static int common(const info* a, const info* b, const info* c) {
        if (!a || !b || !c || (a->mask & b->mask & c->mask) == 0) return -1;
        for (int f : a->facets)
            if (has(b->facets, f) && has(c->facets, f)) return f;
        return -1;
    }

    static bool are_flat(const info* const (&v)[4]) {
        if ((v[0]->mask & v[1]->mask & v[2]->mask & v[3]->mask) == 0) return false;
        for (int f : v[0]->facets)
            if (has(v[1]->facets, f) && has(v[2]->facets, f) && has(v[3]->facets, f)) return true;
        return false;
    }
    bool is_flat(cell c) const {
        const info* v[4];
        for (int i = 0; i < 4; ++i)
            if ((v[i] = look(c->vertex(i))) == nullptr) return false;
        return are_flat(v);
    }

    vec at(vertex v) const { return to_vec(v->point()); }
    vec middle(const edge_key& e) const { return combine(0.5, at(e[0]), 0.5, at(e[1])); }

    bool encroaches(const edge_key& e, const typename Dt::Point& p, const vec& at_p) const {
        const judgement found = in_ball(at(e[0]) - at_p, at(e[1]) - at_p);
        if (found != judgement::unsure) return found == judgement::yes;
        return dt_.geom_traits().side_of_bounded_sphere_3_object()(e[0]->point(), e[1]->point(), p) ==
               CGAL::ON_BOUNDED_SIDE;
    }
    bool encroaches(const face_key& f, const typename Dt::Point& p, const vec& at_p) const {
        const judgement found = in_ball(at(f[0]), at(f[1]), at(f[2]), at_p);
        if (found != judgement::unsure) return found == judgement::yes;
        return dt_.geom_traits().side_of_bounded_sphere_3_object()(f[0]->point(), f[1]->point(), f[2]->point(), p) ==
               CGAL::ON_BOUNDED_SIDE;
    }

    carrier_type carrier(const info* v) const {
        if (v->corner >= 0) return {carried_by::vertex, v->corner};
        if (v->segment >= 0) return {carried_by::segment, v->segment};
        return v->facets.empty() ? carrier_type{carried_by::none, 0} : carrier_type{carried_by::facet, v->facets[0]};
    }
    const std::vector<vertex>& corners(const carrier_type& of) const {
        static const std::vector<vertex> none;
        if (of.kind == carried_by::segment) return segment_list_[of.index].ends;
        return of.kind == carried_by::facet ? facet_corners_[of.index] : none;
    }
    bool meet_acutely(carrier_type a, const vec& p, carrier_type b, const vec& q) const {
        if (a == b) return false;
        if (a.kind == carried_by::facet && b.kind == carried_by::segment) std::swap(a, b);
        if (a.kind == carried_by::segment && b.kind == carried_by::facet && has(segment_list_[a.index].facets, b.index))
            return false;
        std::vector<vertex> shared;
        for (const vertex& v : corners(a))
            if (has(corners(b), v)) shared.push_back(v);
        if (shared.empty() || corners(a).size() < 2 || corners(b).size() < 2) return false;
        const vec x = at(shared[0]);
        vec u = p - x, v = q - x;
        if (shared.size() > 1) {
            const vec along = at(shared[1]) - x;
            const double length = dot(along, along);
            u = combine(1, u, -dot(u, along) / length, along);
            v = combine(1, v, -dot(v, along) / length, along);
        }
        return is_acute(u, v);
    }
    bool may_encroach(vertex v, carrier_type element, const vec& near) const {
        const info* on = look(v);
        return !on || !meet_acutely(carrier(on), at(v), element, near);
    }

    static int root(std::vector<int>& parent, int x) {
        while (parent[x] != x) x = parent[x] = parent[parent[x]];
        return x;
    }

    // Facets and segments of the cells that the domain has now.
    void find() {
        std::vector<std::array<vertex, 3>> faces;
        for (auto f = dt_.finite_facets_begin(); f != dt_.finite_facets_end(); ++f) {
            const cell c = f->first, d = c->neighbor(f->second);
            const auto inside = [&](cell x) { return !dt_.is_infinite(x) && domain_(x); };
            if (inside(c) == inside(d)) continue;
            first_facets_.push_back(*f);
            faces.push_back({c->vertex((f->second + 1) & 3), c->vertex((f->second + 2) & 3),
                             c->vertex((f->second + 3) & 3)});
        }
        for (const auto& face : faces)
            for (const vertex& v : face) add(v);
        // The faces at each edge, in the order in which they were met.
        std::unordered_map<edge_key, std::size_t, handles_hash<2>> position;
        std::vector<std::pair<edge_key, std::vector<int>>> edges;
        for (std::size_t i = 0; i < faces.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const edge_key e = key(look(faces[i][k]), look(faces[i][(k + 1) % 3]));
                const auto place = position.emplace(e, edges.size());
                if (place.second) edges.push_back({e, {}});
                edges[place.first->second].second.push_back(static_cast<int>(i));
            }
        std::vector<int> parent(faces.size());
        for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<int>(i);
        const auto orientation = dt_.geom_traits().orientation_3_object();
        for (const auto& at_edge : edges)
            for (std::size_t i = 0; i < at_edge.second.size(); ++i)
                for (std::size_t j = 0; j < i; ++j) {
                    const auto &f = faces[at_edge.second[i]], &g = faces[at_edge.second[j]];
                    for (const vertex& apex : g)
                        if (apex != at_edge.first[0] && apex != at_edge.first[1] &&
                            orientation(f[0]->point(), f[1]->point(), f[2]->point(), apex->point()) == CGAL::COPLANAR)
                            parent[root(parent, at_edge.second[i])] = root(parent, at_edge.second[j]);
                }
        std::vector<int> number(faces.size(), -1);
        int facets = 0;
        for (std::size_t i = 0; i < faces.size(); ++i) {
            int& of = number[root(parent, static_cast<int>(i))];
            if (of < 0) of = facets++;
            for (const vertex& v : faces[i]) {
                std::vector<int>& on = add(v).facets;
                if (!has(on, of)) on.insert(std::upper_bound(on.begin(), on.end(), of), of);
            }
        }
        for (info& v : infos_) lie_on(v, std::vector<int>(v.facets));
        facet_corners_.resize(facets);
        std::vector<std::vector<int>> around;
        for (const auto& at_edge : edges) {
            std::vector<int> of;
            for (int face : at_edge.second) {
                const int f = number[root(parent, face)];
                if (!has(of, f)) of.insert(std::upper_bound(of.begin(), of.end(), f), f);
            }
            if (of.size() == 1 && at_edge.second.size() == 2) continue;
            first_segments_.push_back(at_edge.first);
            around.push_back(of);
        }
        join_segments(around);
    }

    // Subsegments that go on straight at a vertex are of one segment.
    void join_segments(const std::vector<std::vector<int>>& around) {
        std::vector<std::vector<int>> at_vertex(infos_.size());
        std::vector<vertex> order;
        for (std::size_t i = 0; i < first_segments_.size(); ++i)
            for (const vertex& v : first_segments_[i]) {
                std::vector<int>& list = at_vertex[places_.find(v)];
                if (list.empty()) order.push_back(v);
                list.push_back(static_cast<int>(i));
            }
        std::vector<int> parent(first_segments_.size());
        for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<int>(i);
        int corners = 0;
        for (const vertex& v : order) {
            const std::vector<int>& list = at_vertex[places_.find(v)];
            std::vector<vec> directions;
            for (int i : list) {
                const edge_key& e = first_segments_[i];
                vec d = at(e[0] == v ? e[1] : e[0]) - at(v);
                const double length = std::sqrt(dot(d, d));
                directions.push_back({d[0] / length, d[1] / length, d[2] / length});
            }
            info& on = add(v);
            for (std::size_t i = 0; i < directions.size(); ++i)
                for (std::size_t j = 0; j < i; ++j) on.acute |= dot(directions[i], directions[j]) > 0.5 + 1e-9;
            if (list.size() == 2 && around[list[0]] == around[list[1]] && dot(directions[0], directions[1]) < -1 + 1e-9)
                parent[root(parent, list[0])] = root(parent, list[1]);
            else
                on.corner = corners++;
        }
        std::vector<int> number(first_segments_.size(), -1);
        for (std::size_t i = 0; i < first_segments_.size(); ++i) {
            int& of = number[root(parent, static_cast<int>(i))];
            if (of < 0) {
                of = static_cast<int>(segment_list_.size());
                segment_list_.push_back({{}, around[i]});
            }
            segments_[first_segments_[i]] = of;
            for (const vertex& v : first_segments_[i]) {
                info& on = add(v);
                if (on.corner < 0)
                    on.segment = of;
                else
                    segment_list_[of].ends.push_back(v);
            }
        }
        for (const vertex& v : order) {
            const info* on = look(v);
            if (on->corner >= 0)
                for (int f : on->facets) facet_corners_[f].push_back(v);
        }
    }

    const Dt& dt_;
    const Domain& domain_;
    const numbers<vertex>& numbers_;
    numbers<vertex> places_{4};  // of `infos_`; sparse, for most questions are after free vertices
    std::deque<info> infos_;
    std::vector<const info*> known_;  // of the corners of the hole looked at last
    std::size_t on_boundary_ = 0;     // how many of them are
    std::vector<char> inside_;        // whether its cells are in the domain
    std::vector<std::size_t> on_segment_;
    std::unordered_map<edge_key, int, handles_hash<2>> segments_;
    std::vector<segment_info> segment_list_;
    std::vector<std::vector<vertex>> facet_corners_;
    std::vector<edge_key> first_segments_;
    std::vector<facet> first_facets_;
};

}  // namespace detail
}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_BOUNDARY_HPP
