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

namespace wellspaced {
namespace cgal {
namespace detail {

using vec = std::array<double, 3>;

inline vec operator-(const vec& a, const vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const vec& a, const vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline vec cross(const vec& a, const vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline vec combine(double s, const vec& a, double t, const vec& b) {
    return {s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]};
}
inline double squared_distance(const vec& a, const vec& b) {
    const vec d = a - b;
    return dot(d, d);
}

template <class Point>
vec to_vec(const Point& p) {
    return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
}

// The circumcentre of a triangle. Where the corners share a coordinate exactly, so does the result.
inline vec triangle_circumcenter(const vec& a, const vec& b, const vec& c) {
    const vec u = b - a, v = c - a, n = cross(u, v);
    const vec m = cross(combine(dot(u, u), v, -dot(v, v), u), n);
    return combine(1, a, 1 / (2 * dot(n, n)), m);
}

inline bool is_acute(const vec& u, const vec& v) {
    const double d = dot(u, v);
    return d > 0 && d * d > 0.25 * (1 + 1e-9) * dot(u, u) * dot(v, v);
}

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

    boundary(const Dt& dt, const Domain& domain) : dt_(dt), domain_(domain), filter_(1024, 0) { find(); }

    static edge_key key(vertex a, vertex b) { return a < b ? edge_key{a, b} : edge_key{b, a}; }
    static face_key key(vertex a, vertex b, vertex c) {
        face_key k{a, b, c};
        std::sort(k.begin(), k.end());
        return k;
    }

    // Whether a cell is of the domain.
    bool contains(cell c) const { return !dt_.is_infinite(c) && !is_flat(c) && domain_(c); }

    // Whether a face has the domain on one side only.
    bool is_wall(cell c, int slot) const {
        const info* v[3];
        for (int i = 0, n = 0; i < 4; ++i)
            if (i != slot && (v[n++] = look(c->vertex(i))) == nullptr) return false;
        return common(v[0], v[1], v[2]) >= 0 && contains(c) != contains(c->neighbor(slot));
    }

    bool is_segment(const edge_key& e) const { return segments_.count(e) != 0; }

    // What a point encroaches upon around its cavity.
    template <class Cells>
    void encroached_by(const typename Dt::Point& p, const Cells& cells, encroached& found) const {
        found.clear();
        for (const cell& c : cells) {
            const info* v[4];
            int on_facet = 0, on_segment = 0;
            for (int i = 0; i < 4; ++i) {
                v[i] = look(c->vertex(i));
                on_facet += v[i] != nullptr;
                on_segment += v[i] != nullptr && v[i]->on_segment();
            }
            if (on_segment >= 2)
                for (int i = 0; i < 4; ++i)
                    for (int j = i + 1; j < 4; ++j) {
                        if (!v[i] || !v[j] || !v[i]->on_segment() || !v[j]->on_segment()) continue;
                        const edge_key e = key(c->vertex(i), c->vertex(j));
                        if (is_segment(e) && !has(found.segments, e) && encroaches(e, p)) found.segments.push_back(e);
                    }
            if (on_facet >= 3)
                for (int i = 0; i < 4; ++i) {
                    if (!is_wall(c, i)) continue;
                    const face_key f = key(c->vertex((i + 1) & 3), c->vertex((i + 2) & 3), c->vertex((i + 3) & 3));
                    if (!has(found.facets, f) && encroaches(f, p)) found.facets.push_back(f);
                }
        }
    }

    // Keeps the one element that `p` encroaches upon most.
    void keep_nearest(const vec& p, encroached& found) const {
        const auto depth = [&](const vec& center, vertex corner) {
            return squared_distance(p, center) / squared_distance(at(corner), center);
        };
        const auto nearest = [](auto& list, const auto& depth_of) {
            if (list.size() < 2) return;
            const auto by = [&](const auto& a, const auto& b) { return depth_of(a) < depth_of(b); };
            list = {*std::min_element(list.begin(), list.end(), by)};
        };
        nearest(found.segments, [&](const edge_key& e) { return depth(middle(e), e[0]); });
        nearest(found.facets, [&](const face_key& f) {
            return depth(triangle_circumcenter(at(f[0]), at(f[1]), at(f[2])), f[0]);
        });
    }

    // Where to split a subsegment: its middle, or with one acute end a power of two from there.
    vec split_point(const edge_key& e) const {
        const info *a = look(e[0]), *b = look(e[1]);
        if (a->acute == b->acute) return middle(e);
        const vec center = at(a->acute ? e[0] : e[1]), other = at(a->acute ? e[1] : e[0]);
        const double length = std::sqrt(squared_distance(center, other));
        const double radius = std::exp2(std::floor(std::log2(length * 2 / 3)));
        return combine(1, center, radius / length, other - center);
    }

    // An edge whose length is given by an acute input angle.
    bool is_seditious(vertex a, vertex b) const {
        const info *v = look(a), *w = look(b);
        return v && w && meet_acutely(carrier(v), at(a), carrier(w), at(b));
    }

    bool vertex_encroaches(vertex v, const edge_key& e) const {
        if (dt_.is_infinite(v) || !encroaches(e, v->point())) return false;
        const auto segment = segments_.find(e);
        return segment != segments_.end() &&
               may_encroach(v, {carried_by::segment, segment->second}, middle(e));
    }
    bool vertex_encroaches(vertex v, const face_key& f) const {
        if (dt_.is_infinite(v) || !encroaches(f, v->point())) return false;
        const int facet_of = common(look(f[0]), look(f[1]), look(f[2]));
        const vec a = at(f[0]), b = at(f[1]), c = at(f[2]);
        return may_encroach(v, {carried_by::facet, facet_of},
                            {(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3});
    }

    // A vertex has come to split this subsegment: it lies on the facets that both ends are on.
    std::array<edge_key, 2> split(const edge_key& e, vertex v) {
        const int segment = segments_.at(e);
        segments_.erase(e);
        const std::array<edge_key, 2> parts{key(e[0], v), key(e[1], v)};
        info& added = add(v);
        added.segment = segment;
        added.facets = segment_list_[segment].facets;
        for (const edge_key& part : parts) segments_[part] = segment;
        return parts;
    }
    // A vertex has come to split this subfacet.
    void split(const face_key& f, vertex v) {
        const int facet_of = common(look(f[0]), look(f[1]), look(f[2]));
        add(v).facets = {facet_of};
    }

    template <class Visit>
    void each_segment(const Visit& visit) const {
        for (const edge_key& e : first_segments_) visit(e);
    }
    const std::vector<facet>& first_facets() const { return first_facets_; }

private:
    enum class carried_by { none, vertex, segment, facet };
    struct carrier_type {
        carried_by kind;
        int index;
        bool operator==(const carrier_type& other) const { return kind == other.kind && index == other.index; }
    };
    struct info {
        std::vector<int> facets;  // in order
        int segment = -1;         // the segment that it lies inside
        int corner = -1;          // or its number as a corner, where segments end
        bool acute = false;
        bool on_segment() const { return segment >= 0 || corner >= 0; }
    };
    struct segment_info {
        std::vector<vertex> ends;
        std::vector<int> facets;
    };

    template <class List, class Item>
    static bool has(const List& list, const Item& item) {
        return std::find(list.begin(), list.end(), item) != list.end();
    }

    static std::size_t hash(vertex v) {
        return static_cast<std::size_t>((reinterpret_cast<std::uintptr_t>(&*v) >> 4) * 0x9E3779B97F4A7C15u >> 20);
    }

    // NULL for vertices that are on no facet: nearly all, which a bit tells.
    const info* look(vertex v) const {
        if (!filter_[hash(v) & (filter_.size() - 1)]) return nullptr;
        const auto found = vertices_.find(v);
        return found == vertices_.end() ? nullptr : &found->second;
    }

    info& add(vertex v) {
        if (64 * vertices_.size() > filter_.size()) {
            filter_.assign(4 * filter_.size(), 0);
            for (const auto& known : vertices_) filter_[hash(known.first) & (filter_.size() - 1)] = 1;
        }
        filter_[hash(v) & (filter_.size() - 1)] = 1;
        return vertices_[v];
    }

    // A facet that all three are on, or -1.
    static int common(const info* a, const info* b, const info* c) {
        if (!a || !b || !c) return -1;
        for (int f : a->facets)
            if (has(b->facets, f) && has(c->facets, f)) return f;
        return -1;
    }

    bool is_flat(cell c) const {
        const info* v[4];
        for (int i = 0; i < 4; ++i)
            if ((v[i] = look(c->vertex(i))) == nullptr) return false;
        for (int f : v[0]->facets)
            if (has(v[1]->facets, f) && has(v[2]->facets, f) && has(v[3]->facets, f)) return true;
        return false;
    }

    vec at(vertex v) const { return to_vec(v->point()); }
    vec middle(const edge_key& e) const { return combine(0.5, at(e[0]), 0.5, at(e[1])); }

    bool encroaches(const edge_key& e, const typename Dt::Point& p) const {
        return dt_.geom_traits().side_of_bounded_sphere_3_object()(e[0]->point(), e[1]->point(), p) ==
               CGAL::ON_BOUNDED_SIDE;
    }
    bool encroaches(const face_key& f, const typename Dt::Point& p) const {
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
        // The faces at each edge, in the order in which they were met.
        std::unordered_map<edge_key, std::size_t, handles_hash<2>> position;
        std::vector<std::pair<edge_key, std::vector<int>>> edges;
        for (std::size_t i = 0; i < faces.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const edge_key e = key(faces[i][k], faces[i][(k + 1) % 3]);
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
        std::unordered_map<vertex, std::vector<int>, vertex_hash> at_vertex;
        std::vector<vertex> order;
        for (std::size_t i = 0; i < first_segments_.size(); ++i)
            for (const vertex& v : first_segments_[i]) {
                std::vector<int>& list = at_vertex[v];
                if (list.empty()) order.push_back(v);
                list.push_back(static_cast<int>(i));
            }
        std::vector<int> parent(first_segments_.size());
        for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<int>(i);
        int corners = 0;
        for (const vertex& v : order) {
            const std::vector<int>& list = at_vertex[v];
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

    struct vertex_hash {
        std::size_t operator()(const vertex& v) const noexcept { return hash(v); }
    };

    const Dt& dt_;
    const Domain& domain_;
    std::vector<char> filter_;  // a power of two long
    std::unordered_map<vertex, info, vertex_hash> vertices_;
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
