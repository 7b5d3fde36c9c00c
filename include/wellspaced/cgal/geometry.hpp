// SPDX-License-Identifier: MIT OR Apache-2.0
//
// wellspaced/cgal/geometry.hpp: arithmetic of the CGAL adapter. Included by wellspaced/cgal.hpp.
//
// What is built here (lengths, circumcentres, split points) has the same bits as what the library builds, operation by operation as in
// src/geometry, so that a refinement in CGAL takes the same way as the library's own. What is decided is decided in floating point
// where a safe margin allows it, and else exactly, by the library or by the user's kernel.

#ifndef WELLSPACED_CGAL_GEOMETRY_HPP
#define WELLSPACED_CGAL_GEOMETRY_HPP

#include "../../wellspaced.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace wellspaced {
namespace cgal {
namespace detail {

inline void check(wsp_status status) {
    if (status >= 0) return;
    if (status == WSP_ERR_OPTION || status == WSP_ERR_STRUCT_SIZE || status == WSP_ERR_ARGUMENT)
        throw std::invalid_argument(wsp_last_error());
    throw std::runtime_error(wsp_last_error());
}

// Cells and vertices lie scattered in memory: asks for one that is about to be read.
template <class Handle>
inline void fetch(Handle h) {
#if defined(__GNUC__)
    const char* at = reinterpret_cast<const char*>(&*h);
    __builtin_prefetch(at);
    __builtin_prefetch(at + sizeof(*h) - 1);
#else
    (void)h;
#endif
}

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

// The default for the shortest edge: 2^-40 of the bounding box's diagonal, but no less than 2^-46 of the largest coordinate.
template <class Dt>
double default_min_edge(const Dt& dt) {
    vec low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    double largest = 0;
    for (auto v = dt.finite_vertices_begin(); v != dt.finite_vertices_end(); ++v) {
        const vec p = to_vec(v->point());
        for (int k = 0; k < 3; ++k) {
            low[k] = (std::min)(low[k], p[k]), high[k] = (std::max)(high[k], p[k]);
            largest = (std::max)(largest, std::abs(p[k]));
        }
    }
    // Far from the origin, coordinates round more coarsely than a small box's diagonal tells.
    return (std::max)(std::sqrt(squared_distance(low, high)) * std::ldexp(1, -40), largest * std::ldexp(1, -46));
}

// The circumcentre of a triangle. Where the corners share a coordinate exactly, so does the result.
inline vec triangle_circumcenter(const vec& a, const vec& b, const vec& c) {
    const vec u = b - a, v = c - a, n = cross(u, v);
    const vec m = cross(combine(dot(u, u), v, -dot(v, v), u), n);
    const double d = 2 * dot(n, n);
    return {a[0] + m[0] / d, a[1] + m[1] / d, a[2] + m[2] / d};
}

inline bool is_acute(const vec& u, const vec& v) {
    const double d = dot(u, v);
    return d > 0 && d * d > 0.25 * (1 + 1e-9) * dot(u, u) * dot(v, v);
}

using corners = std::array<vec, 4>;

template <class Cell>
corners corners_of(const Cell& c) {
    return {to_vec(c->vertex(0)->point()), to_vec(c->vertex(1)->point()), to_vec(c->vertex(2)->point()),
            to_vec(c->vertex(3)->point())};
}

// The square of the shortest edge.
inline double shortest_squared(const corners& p) {
    return (std::min)({squared_distance(p[0], p[1]), squared_distance(p[0], p[2]), squared_distance(p[0], p[3]),
                       squared_distance(p[1], p[2]), squared_distance(p[1], p[3]), squared_distance(p[2], p[3])});
}

enum class judgement { no, yes, unsure };

// Whether a tetrahedron's circumradius exceeds the square root of `bound4`, over 2, times its shortest edge, in floating point. u, v, w are
// its edges at one corner, uu, vv, ww their squared lengths, `edge` the square of the shortest. The reasons for the
// margins are in src/geometry/quality.rs: with L the longest of u, v, w, the volume is off by less than 8e-14 L^3 and n by
// less than 8e-14 L^4 in any rounding mode, which is 1e-8 of both where they are not tiny.
inline judgement judge(const vec& u, const vec& v, const vec& w, double uu, double vv, double ww, double edge, double bound4) {
    const vec vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
    const vec n = {uu * vw[0] + vv * wu[0] + ww * uv[0], uu * vw[1] + vv * wu[1] + ww * uv[1],
                   uu * vw[2] + vv * wu[2] + ww * uv[2]};
    const double volume = dot(u, vw), left = dot(n, n), squared = volume * volume;
    const double longest = (std::max)({uu, vv, ww}), longest2 = longest * longest;
    const double right = bound4 * edge * squared;
    if (longest > 1e-60 && longest < 1e60 && left > 1e-10 * longest2 * longest2) {
        // A volume that is lost to rounding makes the tetrahedron worse still.
        const double most = squared + 1e-7 * squared + 1e-10 * longest2 * longest * 1e-3;
        if (left > 1.0000001 * bound4 * edge * most) return judgement::yes;
        if (squared > 1e-10 * longest2 * longest && left < 0.9999999 * right) return judgement::no;
    }
    return judgement::unsure;
}

// The same for a tetrahedron, decided.
inline bool is_bad(const corners& p, double radius_edge) {
    const vec u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    const judgement found = judge(u, v, w, dot(u, u), dot(v, v), dot(w, w), shortest_squared(p), 4 * radius_edge * radius_edge);
    if (found != judgement::unsure) return found == judgement::yes;
    std::uint8_t bad = 0;
    check(wsp_bad_tetrahedra(p[0].data(), 1, radius_edge, &bad));
    return bad != 0;
}

// 1 if the origin lies inside the circumsphere of the positively oriented tetrahedron a b c e, -1 if outside, 0 if floating point can't say; the
// other way about if it is negatively oriented. aa to ee are the squared lengths. The determinant is a sum of 24 products, each at most
// most^2.5 and off by 20u of that, or 40u in other rounding modes, with `most` the largest of them.
inline int in_sphere(const vec& a, const vec& b, const vec& c, const vec& e, double aa, double bb, double cc, double ee) {
    const double m = aa > bb ? aa : bb, n = cc > ee ? cc : ee, most = m > n ? m : n;
    if (!(most > 1e-50 && most < 1e50)) return 0;
    const double ab = a[0] * b[1] - b[0] * a[1], bc = b[0] * c[1] - c[0] * b[1], ce = c[0] * e[1] - e[0] * c[1],
                 ea = e[0] * a[1] - a[0] * e[1], ac = a[0] * c[1] - c[0] * a[1], be = b[0] * e[1] - e[0] * b[1];
    const double abc = a[2] * bc - b[2] * ac + c[2] * ab, bce = b[2] * ce - c[2] * be + e[2] * bc,
                 cea = c[2] * ea + e[2] * ac + a[2] * ce, eab = e[2] * ab + a[2] * be + b[2] * ea;
    const double d = (ee * abc - cc * eab) + (bb * cea - aa * bce);
    const double square = most * most;
    if (!(d * d > 4e-26 * square * square * most)) return 0;
    return d < 0 ? 1 : -1;
}

// The sign of the volume of the tetrahedron of the origin, a, b and c, 0 if floating point can't say. aa to cc are the squared lengths. The
// determinant is a sum of 6 products, each at most most^1.5 and off by 5u of that, or 10u in other rounding modes.
inline int orientation(const vec& a, const vec& b, const vec& c, double aa, double bb, double cc) {
    const double m = aa > bb ? aa : bb, most = m > cc ? m : cc;
    if (!(most > 1e-50 && most < 1e50)) return 0;
    const double d = a[0] * (b[1] * c[2] - c[1] * b[2]) + b[0] * (c[1] * a[2] - a[1] * c[2]) + c[0] * (a[1] * b[2] - b[1] * a[2]);
    if (!(d * d > 1e-28 * most * most * most)) return 0;
    return d > 0 ? 1 : -1;
}

// For three points that have coordinate `axis` in common with the origin: 1 if that lies inside the circle through them, -1 if outside, 0 if
// floating point can't say. In the plane the determinants are sums of 6 products, each off by 5u, and of 12, each off by 10u, and twice that
// in other rounding modes.
inline int in_circle(const vec& a, const vec& b, const vec& c, double aa, double bb, double cc, int axis) {
    const int x = axis == 0 ? 1 : 0, y = axis == 2 ? 1 : 2;
    const double m = aa > bb ? aa : bb, most = m > cc ? m : cc;
    if (!(most > 1e-50 && most < 1e50)) return 0;
    const double ab = a[x] * b[y] - b[x] * a[y], bc = b[x] * c[y] - c[x] * b[y], ca = c[x] * a[y] - a[x] * c[y];
    const double area = ab + bc + ca, d = aa * bc + bb * ca + cc * ab;
    if (!(std::abs(area) > 1e-14 * most && std::abs(d) > 4e-14 * most * most)) return 0;
    return (area > 0) == (d > 0) ? 1 : -1;
}

// Whether p lies inside the smallest ball of a segment, or of a triangle; see src/geometry/encroachment.rs. u and v are the segment's ends, seen
// from p.
inline judgement in_ball(const vec& u, const vec& v) {
    const double d = dot(u, v);
    const double error = 8e-15 * (std::max)({std::abs(u[0] * v[0]), std::abs(u[1] * v[1]), std::abs(u[2] * v[2])});
    return d < -error ? judgement::yes : d > error ? judgement::no : judgement::unsure;
}
inline judgement in_ball(const vec& a, const vec& b, const vec& c, const vec& p) {
    const vec u = b - a, v = c - a, w = p - a, n = cross(u, v);
    const double uu = dot(u, u), vv = dot(v, v), ww = dot(w, w);
    const vec m = cross(combine(uu, v, -vv, u), n);
    const double difference = ww * dot(n, n) - dot(w, m), longest = (std::max)(uu, vv);
    const double error = 6e-14 * longest * longest * (ww + std::sqrt(ww * longest));
    if (!(longest > 1e-60 && longest < 1e60 && ww > 1e-60 && ww < 1e60)) return judgement::unsure;
    return difference < -error ? judgement::yes : difference > error ? judgement::no : judgement::unsure;
}

}  // namespace detail
}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_GEOMETRY_HPP
