// SPDX-License-Identifier: MIT OR Apache-2.0
//
// wellspaced/cgal/refiner.hpp: Algorithm 2 of the paper in a CGAL triangulation, as src/refine/refiner.rs has it. Included by wellspaced/cgal.hpp.
//
// Every choice is made as there: by lengths, then by the numbers of vertices, never by how CGAL stores them. On the same points, numbered
// alike, both insert the same Steiner points in the same order (cpp_tests/bench/cgal.cpp checks it).

#ifndef WELLSPACED_CGAL_REFINER_HPP
#define WELLSPACED_CGAL_REFINER_HPP

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <iterator>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "boundary.hpp"
#include "geometry.hpp"
#include "hole.hpp"
#include "numbers.hpp"
#include "options.hpp"
#include "queue.hpp"

namespace wellspaced {
namespace cgal {
namespace detail {

inline wsp_sampler_options sampler(const options& o) {
    wsp_sampler_options s;
    check(wsp_sampler_options_init(&s, sizeof s));
    s.radius_edge = o.radius_edge;
    s.rule = o.rule;
    return s;
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

// One refinement.
template <class Dt, class Domain, class On_insert>
class refiner {
public:
    using vertex = typename Dt::Vertex_handle;
    using cell = typename Dt::Cell_handle;
    using facet = typename Dt::Facet;
    using boundary_type = boundary<Dt, Domain>;
    using edge_key = typename boundary_type::edge_key;
    using face_key = typename boundary_type::face_key;
    using queue_type = queue<Dt>;

    refiner(Dt& dt, const options& o, const Domain& domain, On_insert& on_insert)
        : dt_(dt),
          options_(o),
          sampler_(sampler(o)),
          on_insert_(on_insert),
          boundary_(dt, domain, number(dt)),
          queue_(dt, numbers_),
          hole_(dt, o.radius_edge) {
        const double least = default_min_edge(dt);
        min_edge_squared_ = o.min_edge > 0 ? o.min_edge * o.min_edge : least * least;
    }

    report run() {
        for (const edge_key& e : boundary_.first_segments())
            if (needs_split(e)) segments_.push_back(e);
        for (const facet& f : boundary_.first_facets()) {
            const face_key k = boundary_.key(f);
            if (boundary_.vertex_encroaches(f.first->vertex(f.second), k) ||
                boundary_.vertex_encroaches(dt_.mirror_vertex(f.first, f.second), k))
                facets_.push_back(k);
        }
        boundary_.sort(segments_);
        boundary_.sort(facets_);
        for (auto c = dt_.finite_cells_begin(); c != dt_.finite_cells_end(); ++c) {
            const double squared = judge(c);
            if (squared >= 0) queue_.push(c, squared);
        }
        typename queue_type::entry next;
        typename queue_type::vertex_numbers names;
        for (;;) {
            if (dt_.number_of_vertices() >= options_.max_vertices) {
                if (!segments_.empty() || !facets_.empty() || !queue_.empty()) report_.status = WSP_VERTEX_LIMIT;
                return report_;
            }
            if (boundary_step()) continue;
            if (!queue_.pop(next, names, [&](cell c) { return judge(c); })) break;
            mend(next, names);
        }
        if (report_.refused > 0 && any_bad()) report_.status = WSP_UNREFINED;
        return report_;
    }

private:
    enum class placed { inserted, encroaches, refused };

    const numbers<vertex>& number(const Dt& dt) {
        for (auto v = dt.finite_vertices_begin(); v != dt.finite_vertices_end(); ++v) numbers_.add(v);
        return numbers_;
    }

    // The square of a bad cell's shortest edge; -1 if the cell is none, or not of the domain.
    double judge(cell c) const {
        if (dt_.is_infinite(c)) return -1;
        const corners p = corners_of(c);
        return is_bad(p, options_.radius_edge) && boundary_.contains(c) ? shortest_squared(p) : -1;
    }

    bool any_bad() const {
        for (auto c = dt_.finite_cells_begin(); c != dt_.finite_cells_end(); ++c)
            if (judge(c) >= 0) return true;
        return false;
    }

    vertex insert() {
        const vertex v = hole_.fill();
        numbers_.add(v);
        return v;
    }

    // After an insertion and what the boundary makes of it.
    void finish(vertex v, origin from) {
        const auto* added = boundary_.look(v);
        for (const auto& bad : hole_.judged()) {
            const cell c = hole_.star()[bad.star];
            if (boundary_.contains(c, added, hole_.star_corners(bad.star))) queue_.push(c, bad.squared);
        }
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

    // Rules 1 and 2: splits one element of the boundary. False if none waits.
    bool boundary_step() {
        while (!segments_.empty()) {
            const edge_key e = segments_.front();
            segments_.pop_front();
            if (!boundary_.is_segment(e) || blocked_segments_.count(e)) continue;
            split(e);
            return true;
        }
        while (!facets_.empty()) {
            const face_key f = facets_.front();
            facets_.pop_front();
            cell c;
            if (blocked_facets_.count(f) || !is_subfacet(f, c)) continue;
            split(f, c);
            return true;
        }
        return false;
    }

    bool is_subfacet(const face_key& f, cell& c) const {
        int i, j, k;
        return dt_.is_facet(f[0], f[1], f[2], c, i, j, k) && boundary_.is_wall(c, 6 - i - j - k);
    }

    void split(const edge_key& e) {
        vec p = boundary_.split_point(e);
        cell c;
        int i, j;
        if (!dt_.is_edge(e[0], e[1], c, i, j)) c = e[0]->cell();
        const auto near = [&](vertex v) { return squared_distance(to_vec(v->point()), p) < min_edge_squared_; };
        if (!usable(p) || near(e[0]) || near(e[1]) || !hole_.find(p, c)) {
            blocked_segments_.insert(e);
            return;
        }
        boundary_.look_around(hole_);
        boundary_.encroached_segments(hole_, found_.segments);
        boundary_.encroached_facets(hole_, found_.facets);
        const vertex v = insert();
        const std::size_t segments = segments_.size(), facets = facets_.size();
        for (const edge_key& part : boundary_.split(e, v))
            if (is_encroached(part, v)) segments_.push_back(part);
        ++report_.segment_splits;
        queue_boundary(v, segments, facets);
        finish(v, WSP_ORIGIN_SEGMENT);
    }

    void split(const face_key& f, cell c) {
        vec p = triangle_circumcenter(to_vec(f[0]->point()), to_vec(f[1]->point()), to_vec(f[2]->point()));
        if (!usable(p) || !hole_.find(p, c) || hole_.clearance() < min_edge_squared_) {
            blocked_facets_.insert(f);
            return;
        }
        boundary_.look_around(hole_);
        boundary_.encroached_segments(hole_, found_.segments);
        bool deferred = false;
        for (const edge_key& e : found_.segments)
            if (!blocked_segments_.count(e)) {
                segments_.push_back(e);
                deferred = true;
            }
        if (deferred) {
            facets_.push_front(f);
            return;
        }
        boundary_.encroached_facets(hole_, found_.facets);
        const vertex v = insert();
        const std::size_t segments = segments_.size(), facets = facets_.size();
        boundary_.split(f, v);
        ++report_.facet_splits;
        queue_boundary(v, segments, facets);
        finish(v, WSP_ORIGIN_SUBFACET);
    }

    // Queues what the new vertex of the boundary encroaches upon or has removed, and what at it is encroached, in the order of numbers
    // behind the queues' first `segments` and `facets`.
    void queue_boundary(vertex v, std::size_t segments, std::size_t facets) {
        cell c;
        int i, j;
        for (const edge_key& e : found_.segments)
            if (boundary_.is_segment(e) && !blocked_segments_.count(e) &&
                (boundary_.may_encroach(v, e) || !dt_.is_edge(e[0], e[1], c, i, j)))
                segments_.push_back(e);
        for (const face_key& f : found_.facets)
            if (!blocked_facets_.count(f) && boundary_.may_encroach(v, f)) facets_.push_back(f);
        const auto* added = boundary_.look(v);
        for (std::size_t n = 0; n < hole_.star().size(); ++n) {
            const cell at = hole_.star()[n];
            const auto& places = hole_.star_corners(n);
            for (int k = 0; k < 3; ++k) {
                // The face of the new vertex and the two other corners.
                const auto *b = boundary_.known(places[(k + 1) % 3]), *d = boundary_.known(places[(k + 2) % 3]);
                const int slot = (hole_.slot_in_star(n) + 1 + k) & 3;
                if (!b || !d || !boundary_.is_wall(at, slot, added, b, d) || !boundary_.contains(at, added, places)) continue;
                const face_key f = boundary_type::key(added, b, d);
                if (boundary_.vertex_encroaches(at->vertex(slot), f) ||
                    boundary_.vertex_encroaches(dt_.mirror_vertex(at, slot), f))
                    facets_.push_back(f);
            }
        }
        boundary_.sort(segments_, segments);
        boundary_.sort(facets_, facets);
    }

    // Whether a subsegment at the new vertex is missing or encroached: it shows in the star.
    bool is_encroached(const edge_key& e, vertex v) const {
        const vertex end = e[0] == v ? e[1] : e[0];
        bool missing = true;
        for (const cell& c : hole_.star()) {
            if (!c->has_vertex(end)) continue;
            missing = false;
            for (int k = 0; k < 4; ++k) {
                const vertex w = c->vertex(k);
                if (w != v && w != end && boundary_.vertex_encroaches(w, e)) return true;
            }
        }
        return missing;
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

    // The slots of the shortest edge of a cell, the lower vertex first, and of the other two likewise. Among equals the edge of the
    // lowest vertices.
    static std::array<int, 4> slots_of(const corners& p, const typename queue_type::vertex_numbers& n) {
        std::array<int, 4> best{};
        double least = std::numeric_limits<double>::infinity();
        for (int a = 0; a < 4; ++a)
            for (int b = 0; b < 4; ++b) {
                if (n[a] >= n[b]) continue;
                const double d = squared_distance(p[a], p[b]);
                if (d > least || (d == least && std::make_pair(n[best[0]], n[best[1]]) < std::make_pair(n[a], n[b]))) continue;
                least = d;
                best[0] = a, best[1] = b;
            }
        best[2] = best[0] != 0 && best[1] != 0 ? 0 : best[0] != 1 && best[1] != 1 ? 1 : 2;
        best[3] = 6 - best[0] - best[1] - best[2];
        if (n[best[3]] < n[best[2]]) std::swap(best[2], best[3]);
        return best;
    }

    // Samples the shortest edge of a bad cell.
    void mend(const typename queue_type::entry& bad, const typename queue_type::vertex_numbers& n) {
        const corners p = corners_of(bad.at);
        const std::array<int, 4> slots = slots_of(p, n);
        if (boundary_.is_seditious(bad.v[slots[0]], bad.v[slots[1]])) {
            ++report_.refused;
            return;
        }
        sample(bad.at, p, slots);
        bool any = false;
        cell near = bad.at;
        for (vec& s : points_) {
            if (dt_.number_of_vertices() >= options_.max_vertices) break;
            const placed became = place(s, near);
            any = any || became != placed::refused;
            if (became == placed::encroaches) break;
            if (became == placed::inserted) near = hole_.star().front();
        }
        if (!queue_.is_live(bad)) return;
        // It comes again.
        if (any || dt_.number_of_vertices() >= options_.max_vertices)
            queue_.push(bad.at, bad.squared);
        else
            ++report_.refused;
    }

    // The Steiner points of a cell's shortest edge. Most edges have few.
    void sample(cell c, const corners& p, const std::array<int, 4>& slots) {
        const corners ordered{p[slots[0]], p[slots[1]], p[slots[2]], p[slots[3]]};
        bool closed = false;
        link_.clear();
        if (options_.rule != WSP_RULE_CIRCUMCENTER) {
            // No wall has a free vertex, nor is a cell with one flat.
            const bool is_free = !boundary_.look(c->vertex(slots[0])) || !boundary_.look(c->vertex(slots[1]));
            const auto wall = [&](cell at, int slot) {
                const cell next = at->neighbor(slot);
                return is_free ? !boundary_.contains_round(next) : !boundary_.contains(next) || boundary_.is_wall(at, slot);
            };
            closed = link_of<Dt>(c, slots[0], slots[1], wall, link_);
        }
        std::size_t count = 0;
        points_.resize((std::max)(points_.capacity(), std::size_t(16)));
        const auto call = [&] {
            check(wsp_sample_tetrahedron(ordered[0].data(), link_.empty() ? nullptr : link_[0].data(), link_.size(), closed, &sampler_,
                                         points_[0].data(), points_.size(), &count));
        };
        call();
        if (count > points_.size()) {
            points_.resize(count);
            call();
        }
        points_.resize(count);
    }

    // Rule 3.
    placed place(vec& s, cell near) {
        if (!usable(s) || !hole_.find(s, near)) return placed::refused;
        const bool inside = boundary_.look_around(hole_);
        const auto blocked = [](const auto& set) { return [&](const auto& item) { return set.count(item) != 0; }; };
        auto &e = found_.segments;
        auto &f = found_.facets;
        boundary_.encroached_segments(hole_, e);
        bool encroaches = !e.empty();
        e.erase(std::remove_if(e.begin(), e.end(), blocked(blocked_segments_)), e.end());
        f.clear();
        if (e.empty()) {
            boundary_.encroached_facets(hole_, f);
            encroaches = encroaches || !f.empty();
            f.erase(std::remove_if(f.begin(), f.end(), blocked(blocked_facets_)), f.end());
        }
        if (encroaches) {
            if (options_.rule == WSP_RULE_SPARSE) boundary_.keep_nearest(s, found_);
            segments_.insert(segments_.end(), e.begin(), e.end());
            facets_.insert(facets_.end(), f.begin(), f.end());
            return found_.empty() ? placed::refused : placed::encroaches;
        }
        if (!inside || hole_.clearance() < min_edge_squared_) return placed::refused;
        const vertex v = insert();
        ++report_.samples;
        finish(v, WSP_ORIGIN_SAMPLE);
        return placed::inserted;
    }

    Dt& dt_;
    const options options_;
    const wsp_sampler_options sampler_;
    On_insert& on_insert_;
    numbers<vertex> numbers_;
    boundary_type boundary_;
    queue_type queue_;
    hole<Dt> hole_;
    report report_;
    double min_edge_squared_ = 0;
    std::deque<edge_key> segments_;
    std::deque<face_key> facets_;
    std::unordered_set<edge_key, handles_hash<2>> blocked_segments_;
    std::unordered_set<face_key, handles_hash<3>> blocked_facets_;
    typename boundary_type::encroached found_;
    std::vector<vec> link_, points_;
};

}  // namespace detail
}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_REFINER_HPP
