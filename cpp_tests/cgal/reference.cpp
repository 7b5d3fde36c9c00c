#include "reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Interval_nt.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

namespace reference {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex_base = CGAL::Triangulation_vertex_base_with_info_3<std::uint32_t, Kernel>;
using Cell_base = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<Vertex_base, Cell_base>>;
using Exact = CGAL::Exact_rational;
using Interval = CGAL::Interval_nt_advanced;

Kernel::Point_3 kernel_point(const Point& p) { return {p[0], p[1], p[2]}; }

Point load(const double* xyz, std::uint32_t i) { return {xyz[3 * std::size_t(i)], xyz[3 * std::size_t(i) + 1], xyz[3 * std::size_t(i) + 2]}; }

template <class FT>
using Vector = std::array<FT, 3>;

template <class FT>
Vector<FT> difference(const Point& p, const Point& q) {
  return {FT(p[0]) - FT(q[0]), FT(p[1]) - FT(q[1]), FT(p[2]) - FT(q[2])};
}

template <class FT>
Vector<FT> cross(const Vector<FT>& u, const Vector<FT>& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

template <class FT>
FT dot(const Vector<FT>& u, const Vector<FT>& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

// For each of the six edges pq the sign that decides: circumradius^2 - beta^2 |pq|^2, freed of its denominator
// 4 det^2. The circumcentre is d + N / (2 det) with N below.
template <class FT>
std::array<FT, 6> bound_excess(const Point& pa, const Point& pb, const Point& pc, const Point& pd, double beta) {
  const auto a = difference<FT>(pa, pd), b = difference<FT>(pb, pd), c = difference<FT>(pc, pd);
  const auto ab = difference<FT>(pa, pb), bc = difference<FT>(pb, pc), ca = difference<FT>(pc, pa);
  const auto b_c = cross(b, c), c_a = cross(c, a), a_b = cross(a, b);
  const FT det = dot(a, b_c), aa = dot(a, a), bb = dot(b, b), cc = dot(c, c);
  Vector<FT> n;
  for (int i = 0; i < 3; ++i) n[i] = aa * b_c[i] + bb * c_a[i] + cc * a_b[i];
  const FT numerator = dot(n, n);
  const FT scale = FT(4) * FT(beta) * FT(beta) * det * det;
  return {numerator - scale * aa,         numerator - scale * bb,         numerator - scale * cc,
          numerator - scale * dot(ab, ab), numerator - scale * dot(bc, bc), numerator - scale * dot(ca, ca)};
}

bool over_bound_exact(const Point& a, const Point& b, const Point& c, const Point& d, double beta) {
  const auto excess = bound_excess<Exact>(a, b, c, d, beta);
  return std::any_of(excess.begin(), excess.end(), [](const Exact& x) { return CGAL::sign(x) == CGAL::POSITIVE; });
}

Exact exact_volume6(const double* xyz, const Tetrahedron* tetrahedra, std::size_t count) {
  Exact sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& t = tetrahedra[i];
    const Point a = load(xyz, t[0]);
    sum += dot(difference<Exact>(load(xyz, t[1]), a),
               cross(difference<Exact>(load(xyz, t[2]), a), difference<Exact>(load(xyz, t[3]), a)));
  }
  return sum;
}

}  // namespace

Delaunay delaunay(const double* xyz, std::size_t count) {
  if (count > std::numeric_limits<std::uint32_t>::max()) throw std::invalid_argument("too many points");
  for (std::size_t i = 0; i < 3 * count; ++i)
    if (!std::isfinite(xyz[i])) throw std::invalid_argument("a coordinate is not finite");

  // CGAL inserts a range in its own order, so which of two equal points it meets first is not ours to say:
  // only the first of each is handed over.
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const Point p = load(xyz, i), q = load(xyz, j);
    return p < q || (p == q && i < j);
  });
  order.erase(std::unique(order.begin(), order.end(),
                          [&](std::uint32_t i, std::uint32_t j) { return load(xyz, i) == load(xyz, j); }),
              order.end());
  std::vector<std::pair<Kernel::Point_3, std::uint32_t>> points;
  points.reserve(order.size());
  for (auto i : order) points.emplace_back(kernel_point(load(xyz, i)), i);
  const Triangulation dt(points.begin(), points.end());

  Delaunay result;
  result.dimension = dt.dimension();
  result.vertices = dt.number_of_vertices();
  if (dt.dimension() == 3) {
    result.tetrahedra.reserve(dt.number_of_finite_cells());
    for (auto c = dt.finite_cells_begin(); c != dt.finite_cells_end(); ++c)
      result.tetrahedra.push_back(
          {c->vertex(0)->info(), c->vertex(1)->info(), c->vertex(2)->info(), c->vertex(3)->info()});
    std::vector<Triangulation::Cell_handle> infinite;
    dt.incident_cells(dt.infinite_vertex(), std::back_inserter(infinite));
    for (auto c : infinite) {
      Triangle facet;
      int k = 0;
      for (int i = 0; i < 4; ++i)
        if (!dt.is_infinite(c->vertex(i))) facet[k++] = c->vertex(i)->info();
      result.hull.push_back(facet);
    }
  } else if (dt.dimension() == 2) {
    for (auto f = dt.finite_facets_begin(); f != dt.finite_facets_end(); ++f) {
      Triangle facet;
      int k = 0;
      for (int i = 0; i < 4; ++i)
        if (i != f->second) facet[k++] = f->first->vertex(i)->info();
      result.hull.push_back(facet);
    }
  } else if (dt.dimension() == 1) {
    for (auto e = dt.finite_edges_begin(); e != dt.finite_edges_end(); ++e)
      result.chain.push_back({e->first->vertex(e->second)->info(), e->first->vertex(e->third)->info()});
  }
  return result;
}

int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  return CGAL::orientation(kernel_point(a), kernel_point(b), kernel_point(c), kernel_point(d));
}

int side_of_oriented_sphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& e) {
  return CGAL::side_of_oriented_sphere(kernel_point(a), kernel_point(b), kernel_point(c), kernel_point(d),
                                       kernel_point(e));
}

int side_of_smallest_sphere(const Point& a, const Point& b, const Point& c, const Point& e) {
  return CGAL::side_of_bounded_sphere(kernel_point(a), kernel_point(b), kernel_point(c), kernel_point(e));
}

int side_of_diametral_sphere(const Point& a, const Point& b, const Point& e) {
  return CGAL::side_of_bounded_sphere(kernel_point(a), kernel_point(b), kernel_point(e));
}

bool over_bound(const Point& a, const Point& b, const Point& c, const Point& d, double beta) {
  if (orientation(a, b, c, d) == 0) return true;
  {
    // Intervals settle nearly all; the compiler is told of the rounding mode by -frounding-math.
    const CGAL::Protect_FPU_rounding<true> upward;
    const auto excess = bound_excess<Interval>(a, b, c, d, beta);
    bool certain = true;
    for (const auto& x : excess) {
      if (x.inf() > 0) return true;
      certain = certain && x.sup() <= 0;
    }
    if (certain) return false;
  }
  return over_bound_exact(a, b, c, d, beta);
}

std::vector<std::size_t> all_over_bound(const double* xyz, const Tetrahedron* tetrahedra, std::size_t count, double beta) {
  std::vector<std::size_t> over;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& t = tetrahedra[i];
    if (over_bound(load(xyz, t[0]), load(xyz, t[1]), load(xyz, t[2]), load(xyz, t[3]), beta)) over.push_back(i);
  }
  return over;
}

int compare_volume_with_box(const double* xyz, const Tetrahedron* tetrahedra, std::size_t count, const Point& low,
                            const Point& high) {
  const auto side = difference<Exact>(high, low);
  return CGAL::sign(Exact(exact_volume6(xyz, tetrahedra, count) - Exact(6) * side[0] * side[1] * side[2]));
}

int compare_volumes(const double* xyz_a, const Tetrahedron* a, std::size_t count_a, const double* xyz_b,
                    const Tetrahedron* b, std::size_t count_b) {
  return CGAL::sign(Exact(exact_volume6(xyz_a, a, count_a) - exact_volume6(xyz_b, b, count_b)));
}

}  // namespace reference
