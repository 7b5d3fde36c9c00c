// SPDX-License-Identifier: MIT OR Apache-2.0
//
// wellspaced/cgal.hpp: wellspaced's Steiner points for CGAL::Delaunay_triangulation_3. Header-only over libwellspaced; this
// file includes no GPL code by itself, but CGAL's 3D triangulations are GPL.
//
//     CGAL::Delaunay_triangulation_3<K> dt(points.begin(), points.end());
//     wellspaced::cgal::refine(dt);                               // in its convex hull, circumradius / shortest edge <= 2
//
// Three levels, each usable by itself:
// - bad_short_edges(dt, beta) and steiner_batch(dt, edge, options): look only; insert the points as you like.
// - refine(dt, options): the whole loop, in place, with the boundary rules for the convex hull.
// - refine(dt, options, domain, on_insert): in the cells for which domain(cell) holds, and on_insert(vertex, origin) is told
//   of each new vertex, to set its info() for instance.
//
// Domains. `domain` is asked for cells as they come and go, so it has to judge by the place of a cell (of its centroid, say),
// not by what it stores. The boundary of the domain is what lies between its cells and the others when refine is called: exactly coplanar
// neighbours make a facet, edges between facets are segments. Facets and segments are split where a vertex or a sample encroaches upon them
// (rules 1 to 3 of the paper), and no sample leaves the domain. The boundary need not be parallel to the axes, but facets must be convex.
// Where they or segments meet at less than 60 degrees, cells between may stay bad; the report counts those that were given up.
//
// What is kept: handles of vertices stay valid, those of cells as after dt.insert. Kernel, vertex and cell types and tags
// are free (Fast_location excepted: its hierarchy must be told of points by its own insert); with Parallel_tag nobody else may use `dt` during
// the call. Coordinates are taken as doubles; new points have double coordinates. CGAL 5.5 and later.
//
// Errors: std::invalid_argument for options, std::runtime_error for coordinates that are not finite or beyond
// 2^-142 to 2^201. `dt` is a valid Delaunay triangulation whenever an exception leaves refine, also when on_insert throws.
//
// Cost: with the triangulation of the input 1.4 to 2.1 times CGAL's insertion of the same points one by one in the same order, at a bound of 2
// on sets of 10,000 to 40,000 vertices (cpp_tests/bench/cgal.cpp); more on very small ones.

#ifndef WELLSPACED_CGAL_HPP
#define WELLSPACED_CGAL_HPP

#include "../wellspaced.h"

#include <CGAL/Delaunay_triangulation_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <iterator>
#include <limits>
#include <map>
#include <queue>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cgal/boundary.hpp"

namespace wellspaced {
namespace cgal {

struct options {
    double radius_edge = 2;                                               // bound on circumradius / shortest edge, 0.62 to 1e6
    wsp_rule rule = WSP_RULE_SPARSE;                                      // how Steiner points are chosen
    double min_edge = 0;                                                  // no shorter edges; 0: 2^-40 of the bounding box's diagonal
    std::size_t max_vertices = (std::numeric_limits<std::size_t>::max)();  // no vertex beyond this many

    options() = default;
    explicit options(double bound, wsp_rule by = WSP_RULE_SPARSE) : radius_edge(bound), rule(by) {}
};

// What a new vertex is: WSP_ORIGIN_SAMPLE, WSP_ORIGIN_SEGMENT or WSP_ORIGIN_SUBFACET.
using origin = std::uint32_t;

struct report {
    wsp_status status = WSP_DONE;  // WSP_DONE, WSP_VERTEX_LIMIT, or WSP_UNREFINED: some cells stay bad
    std::size_t samples = 0, segment_splits = 0, facet_splits = 0;
    std::size_t refused = 0;  // cells that were given up; a later insertion may have mended them by the way

    std::size_t inserted() const { return samples + segment_splits + facet_splits; }
};

// The whole triangulation within its convex hull.
struct everywhere {
    template <class Cell_handle>
    bool operator()(const Cell_handle&) const noexcept {
        return true;
    }
};

// For callers who want no word of new vertices.
struct ignore {
    template <class Vertex_handle>
    void operator()(const Vertex_handle&, origin) const noexcept {}
};

namespace detail {

inline void check(wsp_status status) {
    if (status >= 0) return;
    if (status == WSP_ERR_OPTION || status == WSP_ERR_STRUCT_SIZE || status == WSP_ERR_ARGUMENT)
        throw std::invalid_argument(wsp_last_error());
    throw std::runtime_error(wsp_last_error());
}

inline wsp_sampler_options sampler(const options& o) {
    wsp_sampler_options s;
    check(wsp_sampler_options_init(&s, sizeof s));
    s.radius_edge = o.radius_edge;
    s.rule = o.rule;
    return s;
}

using corners = std::array<vec, 4>;

template <class Cell>
corners corners_of(const Cell& c) {
    return {to_vec(c->vertex(0)->point()), to_vec(c->vertex(1)->point()), to_vec(c->vertex(2)->point()),
            to_vec(c->vertex(3)->point())};
}

// The slots of the shortest edge, and its squared length.
struct shortest {
    int i = 0, j = 1;
    double squared = 0;

    explicit shortest(const corners& p) {
        squared = squared_distance(p[0], p[1]);
        for (int a = 0; a < 4; ++a)
            for (int b = a + 1; b < 4; ++b) {
                const double d = squared_distance(p[a], p[b]);
                if (d < squared) squared = d, i = a, j = b;
            }
    }
};

// Not finite for flat cells.
inline vec circumcenter(const corners& p) {
    const vec u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    const vec vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
    const vec n = combine(1, combine(dot(u, u), vw, dot(v, v), wu), dot(w, w), uv);
    return combine(1, p[0], 1 / (2 * dot(u, vw)), n);
}

// Whether the circumradius exceeds `bound` times the shortest edge. In floating point where that is safe (the
// reasons for the margins are in src/geometry/quality.rs, doubled here for other rounding modes), else exactly, by the library.
inline bool is_bad(const corners& p, double bound) {
    const vec u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    const vec vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
    const double uu = dot(u, u), vv = dot(v, v), ww = dot(w, w);
    const vec n = {uu * vw[0] + vv * wu[0] + ww * uv[0], uu * vw[1] + vv * wu[1] + ww * uv[1],
                   uu * vw[2] + vv * wu[2] + ww * uv[2]};
    const double volume = dot(u, vw), left = dot(n, n);
    const double edge = (std::min)({uu, vv, ww, squared_distance(p[1], p[2]), squared_distance(p[1], p[3]),
                                    squared_distance(p[2], p[3])});
    const double longest = (std::max)({uu, vv, ww});
    const double right = 4 * bound * bound * edge * volume * volume;
    const double slack = 8e-14, scale3 = longest * std::sqrt(longest), scale4 = longest * longest;
    const double error = slack * scale4 * (std::sqrt(left) + slack * scale4) +
                         slack * scale3 * 4 * bound * bound * edge * (std::abs(volume) + slack * scale3);
    if (longest > 1e-60 && longest < 1e60) {
        if (left - right > error) return true;
        if (right - left > error) return false;
    }
    std::uint8_t bad = 0;
    check(wsp_bad_tetrahedra(p[0].data(), 1, bound, &bad));
    return bad != 0;
}

// Steiner points of an edge from its link. Most edges have few.
inline void sample(const vec& p, const vec& q, const std::vector<vec>& link, bool closed, const wsp_sampler_options& options,
                   std::vector<vec>& points) {
    std::size_t count = 0;
    points.resize(16);
    check(wsp_sample_edge(p.data(), q.data(), link.data()->data(), link.size(), closed, &options, points.data()->data(),
                          points.size(), &count));
    if (count > points.size()) {
        points.resize(count);
        check(wsp_sample_edge(p.data(), q.data(), link.data()->data(), link.size(), closed, &options,
                              points.data()->data(), points.size(), &count));
    }
    points.resize(count);
}

// The vertices around edge (i, j) of `c`, between the walls around `c`. Returns whether they form a ring.
template <class Dt, class Wall>
bool link_of(typename Dt::Cell_handle c, int i, int j, const Wall& wall, std::vector<vec>& link) {
    using vertex = typename Dt::Vertex_handle;
    link.clear();
    const vertex p = c->vertex(i), q = c->vertex(j);
    const int first = CGAL::Triangulation_utils_3::next_around_edge(i, j);
    const vertex start = c->vertex(6 - i - j - first);
    // Around one way: from the vertex `behind`, each cell shows the next.
    typename Dt::Cell_handle at = c;
    vertex behind = start;
    link.push_back(to_vec(start->point()));
    bool closed = false;
    for (;;) {
        const int a = at->index(p), b = at->index(q), k = at->index(behind), l = 6 - a - b - k;
        const vertex ahead = at->vertex(l);
        if (at != c || ahead != start) link.push_back(to_vec(ahead->point()));
        if (wall(at, k)) break;
        at = at->neighbor(k);
        behind = ahead;
        if (at == c) {
            link.pop_back();  // the first again
            closed = true;
            break;
        }
    }
    if (closed) return true;
    // And the other way, from the first cell.
    const std::size_t forward = link.size();
    at = c;
    behind = c->vertex(first);
    for (;;) {
        const int a = at->index(p), b = at->index(q), k = at->index(behind), l = 6 - a - b - k;
        const vertex ahead = at->vertex(l);
        if (at != c) link.push_back(to_vec(ahead->point()));
        if (wall(at, k)) break;
        at = at->neighbor(k);
        behind = ahead;
    }
    std::reverse(link.begin() + static_cast<std::ptrdiff_t>(forward), link.end());
    std::rotate(link.begin(), link.begin() + static_cast<std::ptrdiff_t>(forward), link.end());
    return false;
}

// Bad cells, the one with the shortest shortest edge first, among equals the one that was found first. Most die before their turn:
// they wait unsorted in buckets 1.6 % wide, as in src/refine/queue.rs.
template <class Dt>
class queue {
public:
    using cell = typename Dt::Cell_handle;
    struct entry {
        double squared;
        std::uint64_t number;
        cell at;
        std::array<typename Dt::Vertex_handle, 4> v;
        bool operator<(const entry& other) const {
            return squared != other.squared ? squared > other.squared : number > other.number;
        }
    };

    explicit queue(const Dt& dt) : dt_(dt) {}

    void push(cell c, double squared) {
        const entry e{squared, count_++, c, {c->vertex(0), c->vertex(1), c->vertex(2), c->vertex(3)}};
        const std::uint64_t in = bucket(squared);
        if (in == current_)
            heap_.push(e);
        else
            waiting_[in].push_back(e);
    }
    bool pop(cell& c) {
        for (;;) {
            if (!waiting_.empty() && (heap_.empty() || waiting_.begin()->first < current_)) {
                turn();
                continue;
            }
            if (heap_.empty()) return false;
            const entry e = heap_.top();
            heap_.pop();
            if (!is_live(e)) continue;
            c = e.at;
            return true;
        }
    }
    bool empty() const { return heap_.empty() && waiting_.empty(); }

private:
    static std::uint64_t bucket(double squared) {
        std::uint64_t bits;
        std::memcpy(&bits, &squared, sizeof bits);
        return bits >> 46;
    }
    // A cell's memory stays, but may serve another cell now or none.
    bool is_live(const entry& e) const {
        if (!dt_.tds().cells().is_used(e.at)) return false;
        for (int i = 0; i < 4; ++i)
            if (e.at->vertex(i) != e.v[i]) return false;
        return true;
    }
    void turn() {
        for (; !heap_.empty(); heap_.pop()) waiting_[current_].push_back(heap_.top());
        current_ = waiting_.begin()->first;
        std::vector<entry> list = std::move(waiting_.begin()->second);
        waiting_.erase(waiting_.begin());
        list.erase(std::remove_if(list.begin(), list.end(), [&](const entry& e) { return !is_live(e); }), list.end());
        heap_ = std::priority_queue<entry>(std::less<entry>(), std::move(list));
    }

    const Dt& dt_;
    std::priority_queue<entry> heap_;
    std::uint64_t current_ = 0, count_ = 0;
    std::map<std::uint64_t, std::vector<entry>> waiting_;
};

// One refinement: Algorithm 2 of the paper, as src/refine/refiner.rs has it.
template <class Dt, class Domain, class On_insert>
class refiner {
public:
    using vertex = typename Dt::Vertex_handle;
    using cell = typename Dt::Cell_handle;
    using facet = typename Dt::Facet;
    using point = typename Dt::Point;
    using boundary_type = boundary<Dt, Domain>;
    using edge_key = typename boundary_type::edge_key;
    using face_key = typename boundary_type::face_key;

    refiner(Dt& dt, const options& o, const Domain& domain, On_insert& on_insert)
        : dt_(dt), options_(o), sampler_(sampler(o)), on_insert_(on_insert), boundary_(dt, domain), queue_(dt) {
        vec low, high;
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
        for (auto v = dt.finite_vertices_begin(); v != dt.finite_vertices_end(); ++v) {
            const vec p = to_vec(v->point());
            for (int k = 0; k < 3; ++k) low[k] = (std::min)(low[k], p[k]), high[k] = (std::max)(high[k], p[k]);
        }
        const double least = o.min_edge > 0 ? o.min_edge : std::sqrt(squared_distance(low, high)) * std::ldexp(1, -40);
        min_edge_squared_ = least * least;
    }

    report run() {
        boundary_.each_segment([&](const edge_key& e) {
            if (needs_split(e)) segments_.push_back(e);
        });
        for (const facet& f : boundary_.first_facets()) {
            const face_key k = face_of(f);
            if (boundary_.vertex_encroaches(f.first->vertex(f.second), k) ||
                boundary_.vertex_encroaches(dt_.mirror_vertex(f.first, f.second), k))
                facets_.push_back(k);
        }
        for (auto c = dt_.finite_cells_begin(); c != dt_.finite_cells_end(); ++c) watch(c);
        cell c;
        for (;;) {
            if (dt_.number_of_vertices() >= options_.max_vertices) {
                if (!segments_.empty() || !facets_.empty() || !queue_.empty()) report_.status = WSP_VERTEX_LIMIT;
                return report_;
            }
            if (boundary_step()) continue;
            if (!queue_.pop(c)) break;
            mend(c);
        }
        if (report_.refused > 0 && any_bad()) report_.status = WSP_UNREFINED;
        return report_;
    }

private:
    enum class placed { inserted, encroaches, refused };

    bool any_bad() const {
        for (auto c = dt_.finite_cells_begin(); c != dt_.finite_cells_end(); ++c)
            if (boundary_.contains(c) && is_bad(corners_of(c), options_.radius_edge)) return true;
        return false;
    }

    static face_key face_of(const facet& f) {
        return boundary_type::key(f.first->vertex((f.second + 1) & 3), f.first->vertex((f.second + 2) & 3),
                                  f.first->vertex((f.second + 3) & 3));
    }

    void watch(cell c) {
        if (dt_.is_infinite(c)) return;
        const corners p = corners_of(c);
        if (is_bad(p, options_.radius_edge) && boundary_.contains(c)) queue_.push(c, shortest(p).squared);
    }

    // The cavity of `p`. `near` is a cell near it. False where there is a vertex at `p`.
    bool find_cavity(const point& p, cell near) {
        cells_.clear();
        rim_.clear();
        cell start = near;
        if (dt_.is_infinite(near) || dt_.side_of_sphere(near, p, true) != CGAL::ON_BOUNDED_SIDE) {
            typename Dt::Locate_type type;
            int i, j;
            start = dt_.locate(p, type, i, j, near);
            if (type == Dt::VERTEX) return false;
        }
        dt_.find_conflicts(p, start, std::back_inserter(rim_), std::back_inserter(cells_));
        return true;
    }

    bool is_too_near(const vec& p) const {
        for (const facet& f : rim_)
            for (int i = 1; i < 4; ++i) {
                const vertex v = f.first->vertex((f.second + i) & 3);
                if (!dt_.is_infinite(v) && squared_distance(to_vec(v->point()), p) < min_edge_squared_) return true;
            }
        return false;
    }

    vertex insert(const point& p) {
        const vertex v = dt_.insert_in_hole(p, cells_.begin(), cells_.end(), rim_.front().first, rim_.front().second);
        star_.clear();
        dt_.incident_cells(v, std::back_inserter(star_));
        return v;
    }

    // After an insertion and what the boundary makes of it.
    void finish(vertex v, origin from) {
        for (const cell& c : star_) watch(c);
        on_insert_(v, from);
    }

    // Magnitudes below what the exact predicates hold become 0. False for those above.
    static bool usable(vec& p) {
        for (double& x : p) {
            if (!(std::abs(x) <= std::ldexp(1, 201))) return false;
            if (std::abs(x) < std::ldexp(1, -142)) x = 0;
        }
        return true;
    }
    static point to_point(const vec& p) { return point(p[0], p[1], p[2]); }

    // Rules 1 and 2: splits one element of the boundary. False if none waits.
    bool boundary_step() {
        while (!segments_.empty()) {
            const edge_key e = segments_.front();
            segments_.pop_front();
            if (!boundary_.is_segment(e) || has(blocked_segments_, e)) continue;
            split(e);
            return true;
        }
        while (!facets_.empty()) {
            const face_key f = facets_.front();
            facets_.pop_front();
            cell c;
            if (has(blocked_facets_, f) || !is_subfacet(f, c)) continue;
            split(f, c);
            return true;
        }
        return false;
    }

    template <class List, class Item>
    static bool has(const List& list, const Item& item) {
        return std::find(list.begin(), list.end(), item) != list.end();
    }

    bool is_subfacet(const face_key& f, cell& c) const {
        int i, j, k;
        return dt_.is_facet(f[0], f[1], f[2], c, i, j, k) && boundary_.is_wall(c, 6 - i - j - k);
    }

    void split(const edge_key& e) {
        vec p = boundary_.split_point(e);
        const point at = to_point(p);
        cell c;
        int i, j;
        if (!dt_.is_edge(e[0], e[1], c, i, j)) c = e[0]->cell();
        if (!usable(p) || !find_cavity(at, c) || is_too_near(p)) {
            blocked_segments_.push_back(e);
            return;
        }
        boundary_.encroached_by(at, cells_, found_);
        const vertex v = insert(at);
        const auto parts = boundary_.split(e, v);
        ++report_.segment_splits;
        enqueue_for(v);
        for (const edge_key& part : parts)
            if (needs_split(part)) segments_.push_back(part);
        enqueue_new_facets(v);
        finish(v, WSP_ORIGIN_SEGMENT);
    }

    void split(const face_key& f, cell c) {
        vec p = triangle_circumcenter(to_vec(f[0]->point()), to_vec(f[1]->point()), to_vec(f[2]->point()));
        const point at = to_point(p);
        if (!usable(p) || !find_cavity(at, c) || is_too_near(p)) {
            blocked_facets_.push_back(f);
            return;
        }
        boundary_.encroached_by(at, cells_, found_);
        bool deferred = false;
        for (const edge_key& e : found_.segments)
            if (!has(blocked_segments_, e)) {
                segments_.push_back(e);
                deferred = true;
            }
        if (deferred) {
            facets_.push_front(f);
            return;
        }
        const vertex v = insert(at);
        boundary_.split(f, v);
        ++report_.facet_splits;
        enqueue_for(v);
        enqueue_new_facets(v);
        finish(v, WSP_ORIGIN_SUBFACET);
    }

    // What the new vertex of the boundary encroaches upon.
    void enqueue_for(vertex v) {
        cell c;
        for (const edge_key& e : found_.segments)
            if (boundary_.vertex_encroaches(v, e)) segments_.push_back(e);
        for (const face_key& f : found_.facets)
            if (boundary_.vertex_encroaches(v, f)) facets_.push_back(f);
    }

    bool needs_split(const edge_key& e) const {
        cell c;
        int i, j;
        if (!dt_.is_edge(e[0], e[1], c, i, j)) return true;
        auto around = dt_.incident_cells(c, i, j);
        const auto done = around;
        do {
            for (int k = 0; k < 4; ++k) {
                const vertex v = around->vertex(k);
                if (v != e[0] && v != e[1] && boundary_.vertex_encroaches(v, e)) return true;
            }
        } while (++around != done);
        return false;
    }

    void enqueue_new_facets(vertex v) {
        for (const cell& c : star_) {
            if (!boundary_.contains(c)) continue;
            const int own = c->index(v);
            for (int slot = 0; slot < 4; ++slot) {
                if (slot == own || !boundary_.is_wall(c, slot)) continue;
                const face_key f = face_of(facet(c, slot));
                if (boundary_.vertex_encroaches(c->vertex(slot), f) ||
                    boundary_.vertex_encroaches(dt_.mirror_vertex(c, slot), f))
                    facets_.push_back(f);
            }
        }
    }

    void mend(cell c) {
        const std::array<vertex, 4> before{c->vertex(0), c->vertex(1), c->vertex(2), c->vertex(3)};
        const corners p = corners_of(c);
        const shortest edge(p);
        if (boundary_.is_seditious(before[edge.i], before[edge.j])) {
            ++report_.refused;
            return;
        }
        if (options_.rule == WSP_RULE_CIRCUMCENTER) {
            points_.assign(1, circumcenter(p));
        } else {
            const auto wall = [&](cell at, int slot) {
                return !boundary_.contains(at->neighbor(slot)) || boundary_.is_wall(at, slot);
            };
            const bool closed = link_of<Dt>(c, edge.i, edge.j, wall, link_);
            sample(p[edge.i], p[edge.j], link_, closed, sampler_, points_);
        }
        bool any = false;
        cell near = c;
        for (vec& s : points_) {
            if (dt_.number_of_vertices() >= options_.max_vertices) break;
            const placed became = place(s, near);
            any = any || became != placed::refused;
            if (became == placed::encroaches) break;
            if (became == placed::inserted) near = star_.front();
        }
        if (any && near != c) return look_again(c, before, p);
        if (any)
            queue_.push(c, edge.squared);
        else
            ++report_.refused;
    }

    // The cell comes again if it is still there.
    void look_again(cell c, const std::array<vertex, 4>& before, const corners& p) {
        if (!dt_.tds().cells().is_used(c)) return;
        for (int i = 0; i < 4; ++i)
            if (c->vertex(i) != before[i]) return;
        queue_.push(c, shortest(p).squared);
    }

    // Rule 3.
    placed place(vec& s, cell near) {
        if (!usable(s)) return placed::refused;
        const point at = to_point(s);
        if (!find_cavity(at, near)) return placed::refused;
        boundary_.encroached_by(at, cells_, found_);
        if (!found_.empty()) {
            const auto blocked = [](const auto& list) { return [&](const auto& item) { return has(list, item); }; };
            auto &e = found_.segments;
            auto &f = found_.facets;
            e.erase(std::remove_if(e.begin(), e.end(), blocked(blocked_segments_)), e.end());
            f.erase(std::remove_if(f.begin(), f.end(), blocked(blocked_facets_)), f.end());
            if (!e.empty()) f.clear();
            if (options_.rule == WSP_RULE_SPARSE) boundary_.keep_nearest(s, found_);
            segments_.insert(segments_.end(), e.begin(), e.end());
            facets_.insert(facets_.end(), f.begin(), f.end());
            return found_.empty() ? placed::refused : placed::encroaches;
        }
        for (const cell& c : cells_)
            if (!boundary_.contains(c)) return placed::refused;
        if (is_too_near(s)) return placed::refused;
        const vertex v = insert(at);
        ++report_.samples;
        finish(v, WSP_ORIGIN_SAMPLE);
        return placed::inserted;
    }

    Dt& dt_;
    const options options_;
    const wsp_sampler_options sampler_;
    On_insert& on_insert_;
    boundary_type boundary_;
    queue<Dt> queue_;
    report report_;
    double min_edge_squared_ = 0;
    std::deque<edge_key> segments_;
    std::deque<face_key> facets_;
    std::vector<edge_key> blocked_segments_;
    std::vector<face_key> blocked_facets_;
    typename boundary_type::encroached found_;
    std::vector<cell> cells_, star_;
    std::vector<facet> rim_;
    std::vector<vec> link_, points_;
};

}  // namespace detail

// The bad short edges for a bound, the shortest first: no finite cell is bad if there are none. An edge is CGAL's triple of a
// cell and two slots in it; the cell is a bad one. Linear in the triangulation.
template <class Dt, class Domain = everywhere>
std::vector<typename Dt::Edge> bad_short_edges(const Dt& dt, double radius_edge, const Domain& domain = Domain()) {
    struct found {
        double squared;
        std::size_t number;
        typename Dt::Edge edge;
    };
    std::vector<found> all;
    if (dt.dimension() == 3)
        for (auto c = dt.finite_cells_begin(); c != dt.finite_cells_end(); ++c) {
            const detail::corners p = detail::corners_of(c);
            if (!domain(c) || !detail::is_bad(p, radius_edge)) continue;
            const detail::shortest s(p);
            all.push_back({s.squared, all.size(), typename Dt::Edge(c, s.i, s.j)});
        }
    std::sort(all.begin(), all.end(), [](const found& a, const found& b) {
        return a.squared != b.squared ? a.squared < b.squared : a.number < b.number;
    });
    std::vector<typename Dt::Edge> edges;
    std::vector<std::array<typename Dt::Vertex_handle, 2>> seen;  // of the present length
    double length = -1;
    for (const found& f : all) {
        if (f.squared != length) seen.clear();
        length = f.squared;
        typename Dt::Vertex_handle a = f.edge.first->vertex(f.edge.second), b = f.edge.first->vertex(f.edge.third);
        if (b < a) std::swap(a, b);
        const std::array<typename Dt::Vertex_handle, 2> ends{a, b};
        if (std::find(seen.begin(), seen.end(), ends) != seen.end()) continue;
        seen.push_back(ends);
        edges.push_back(f.edge);
    }
    return edges;
}

// The Steiner points of an edge, to be inserted together; none if it is not bad. Boundary rules are the caller's here: the points
// of an edge at the hull may lie outside.
template <class Dt>
std::vector<typename Dt::Point> steiner_batch(const Dt& dt, const typename Dt::Edge& edge, const options& o = options()) {
    std::vector<detail::vec> link, points;
    const auto hull = [&](typename Dt::Cell_handle c, int slot) { return dt.is_infinite(c->neighbor(slot)); };
    typename Dt::Cell_handle c = edge.first;
    int i = edge.second, j = edge.third;
    if (dt.is_infinite(c)) {
        const auto p = c->vertex(i), q = c->vertex(j);
        auto around = dt.incident_cells(edge);
        while (dt.is_infinite(around)) ++around;
        c = around;
        i = c->index(p), j = c->index(q);
    }
    const bool closed = detail::link_of<Dt>(c, i, j, hull, link);
    detail::sample(detail::to_vec(c->vertex(i)->point()), detail::to_vec(c->vertex(j)->point()), link, closed,
                   detail::sampler(o), points);
    std::vector<typename Dt::Point> result;
    for (const detail::vec& p : points) result.emplace_back(p[0], p[1], p[2]);
    return result;
}

// Inserts Steiner points until no cell of the domain is bad. Below dimension 3 there is nothing to do.
template <class Dt, class Domain = everywhere, class On_insert = ignore>
report refine(Dt& dt, const options& o = options(), const Domain& domain = Domain(), On_insert on_insert = On_insert()) {
    if (!(o.min_edge >= 0 && o.min_edge <= (std::numeric_limits<double>::max)()))
        throw std::invalid_argument("wellspaced::cgal::refine: min_edge is not a finite length");
    // The sampler checks the other options as soon as it is called: here even if there is nothing to do.
    const double unit[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const wsp_sampler_options s = detail::sampler(o);
    std::size_t count = 0;
    detail::check(wsp_sample_edge(unit, unit + 3, unit + 6, 2, 0, &s, nullptr, 0, &count));
    if (dt.dimension() < 3) return report();
    return detail::refiner<Dt, Domain, On_insert>(dt, o, domain, on_insert).run();
}

}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_HPP
