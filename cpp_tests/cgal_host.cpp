// wellspaced/cgal.hpp with the types that users have: kernels, info() at vertices and cells, tags; domains; exceptions.
//
//   cgal_host NAME     epick, epeck, parallel, domain, slanted, hulls, lower, far, throwing
#ifdef WELLSPACED_TEST_TBB
#define CGAL_LINKED_WITH_TBB
#endif
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "wellspaced/cgal.hpp"

namespace {

namespace wc = wellspaced::cgal;
using Epick = CGAL::Exact_predicates_inexact_constructions_kernel;
using Epeck = CGAL::Exact_predicates_exact_constructions_kernel;
using Plain = CGAL::Delaunay_triangulation_3<Epick>;

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

template <class Dt>
void fill(Dt& dt, int count, unsigned seed, double half = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> inside(-1.0, 1.0);
  for (int i = 0; i < count; ++i) {
    const double x = inside(random), y = inside(random), z = inside(random);
    dt.insert(typename Dt::Point(x, y, z));
  }
  for (int i = 0; i < 8; ++i)
    dt.insert(typename Dt::Point(i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half));
}

template <class Dt>
void require_done(Dt& dt, const wc::report& done, double bound) {
  require(done.status == WSP_DONE, "not done");
  require(wc::bad_short_edges(dt, bound).empty(), "bad edges are left");
  require(dt.is_valid(), "the triangulation is not valid");
  for (auto v = dt.finite_vertices_begin(); v != dt.finite_vertices_end(); ++v) {
    using std::abs;
    const auto p = v->point();
    require(abs(CGAL::to_double(p.x())) <= 3 && abs(CGAL::to_double(p.y())) <= 3 && abs(CGAL::to_double(p.z())) <= 3,
            "a vertex outside the box");
  }
}

template <class Dt>
void refine(wsp_rule rule, double bound) {
  Dt dt;
  fill(dt, 150, 5);
  const auto first = dt.finite_vertices_begin();
  const typename Dt::Vertex_handle kept = first;
  const typename Dt::Point place = kept->point();
  const std::size_t before = dt.number_of_vertices();
  std::size_t told = 0;
  const wc::report done = wc::refine(dt, wc::options(bound, rule), wc::everywhere(),
                                     [&](typename Dt::Vertex_handle v, wc::origin) { told += dt.is_vertex(v); });
  require_done(dt, done, bound);
  require(told == done.inserted() && dt.number_of_vertices() == before + told && told > 0, "the callback's count");
  require(dt.is_vertex(kept) && kept->point() == place, "a handle of before");
  require(wc::refine(dt, wc::options(bound, rule)).inserted() == 0, "a second refinement adds something");
}

// Each side of a wall through the box, one of them refined.
void domain() {
  Plain all, dt;
  fill(all, 150, 6);
  // The wall has to be made of facets of the triangulation before it can be the boundary: points on it, denser than the others come
  // near it, see to that.
  for (auto v = all.finite_vertices_begin(); v != all.finite_vertices_end(); ++v)
    if (std::abs(v->point().x()) > 0.4) dt.insert(v->point());
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j) dt.insert(Plain::Point(0, 0.5 * i, 0.5 * j));
  for (auto c = dt.finite_cells_begin(); c != dt.finite_cells_end(); ++c) {
    double least = 0, most = 0;
    for (int i = 0; i < 4; ++i) {
      least = std::min(least, c->vertex(i)->point().x());
      most = std::max(most, c->vertex(i)->point().x());
    }
    require(least == 0 || most == 0, "a cell on both sides of the wall");
  }
  const auto right = [](const Plain::Cell_handle& c) {
    return c->vertex(0)->point().x() + c->vertex(1)->point().x() + c->vertex(2)->point().x() + c->vertex(3)->point().x() > 0;
  };
  bool outside = false;
  std::size_t on_wall = 0;
  const wc::report done = wc::refine(dt, wc::options(1.8), right, [&](Plain::Vertex_handle v, wc::origin) {
    outside = outside || v->point().x() < 0;
    on_wall += v->point().x() == 0;
  });
  std::printf("domain: %zu points, %zu on the wall\n", done.inserted(), on_wall);
  require(done.inserted() > on_wall && on_wall > 0 && !outside, "points outside the domain");
  require(done.status == WSP_DONE && done.refused == 0, "cells were given up");
  require(wc::bad_short_edges(dt, 1.8, right).empty(), "bad edges are left in the domain");
  require(!wc::bad_short_edges(dt, 1.8).empty(), "the other side was refined, too");
  require(dt.is_valid(), "the triangulation is not valid");
}

// A box turned about an axis of no symmetry: its sides can't hold their new vertices exactly.
void slanted() {
  Plain box, dt;
  fill(box, 100, 7);
  const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(0.4), e = std::sin(0.4);
  for (auto v = box.finite_vertices_begin(); v != box.finite_vertices_end(); ++v) {
    const auto p = v->point();
    const double x = c * p.x() - s * p.y(), y = s * p.x() + c * p.y();
    dt.insert(Plain::Point(x, d * y - e * p.z(), e * y + d * p.z()));
  }
  // Corners of one side that are coplanar but for rounding are of several facets then, and all is as for any polyhedron.
  wc::options options(2);
  options.max_vertices = 20000;
  const wc::report done = wc::refine(dt, options);
  require(done.status == WSP_DONE && done.refused == 0, "cells were given up");
  require(dt.is_valid(), "the triangulation is not valid");
  // A split lies off its side by rounding, in or out: what is between is flat, and was no cell of the hull when the refinement began.
  const auto is_solid = [&](const Plain::Cell_handle& cell) {
    for (int side = 0; side < 6; ++side) {
      bool is_on = true;
      for (int i = 0; i < 4; ++i) {
        // Turned back.
        const auto p = cell->vertex(i)->point();
        const double y = d * p.y() + e * p.z();
        const double q[3] = {c * p.x() + s * y, c * y - s * p.x(), d * p.z() - e * p.y()};
        is_on = is_on && std::abs(q[side / 2] - (side % 2 ? 3 : -3)) < 1e-13;
      }
      if (is_on) return false;
    }
    return true;
  };
  require(wc::bad_short_edges(dt, 2, is_solid).empty(), "bad edges are left");
  std::printf("slanted: %zu points, %zu bad edges of flat cells\n", done.inserted(), wc::bad_short_edges(dt, 2).size());
}

// Hulls of a few random points, whose facets are slanted and meet at all angles: each ends, and says what is left.
void hulls() {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> inside(0.0, 1.0);
    Plain dt;
    for (unsigned i = 0; i < 4 + 3 * seed; ++i) {
      const double x = inside(random), y = inside(random), z = inside(random);
      dt.insert(Plain::Point(x, y, z));
    }
    const std::size_t before = dt.number_of_vertices();
    std::size_t told = 0;
    const wc::report done =
        wc::refine(dt, wc::options(2), wc::everywhere(), [&](Plain::Vertex_handle v, wc::origin) { told += dt.is_vertex(v); });
    const std::size_t left = wc::bad_short_edges(dt, 2).size();
    std::printf("hull %u: %zu points, %zu cells given up, %zu bad edges\n", seed, done.inserted(), done.refused, left);
    require(told == done.inserted() && dt.number_of_vertices() == before + told, "the callback's count");
    require(done.status == (done.refused > 0 ? WSP_UNREFINED : WSP_DONE), "the status of a hull");
    require(left <= done.refused && (left > 0) == (done.refused > 0), "bad edges that the report does not count");
    require(dt.number_of_vertices() < 3000 && dt.is_valid(), "the triangulation of a hull");
  }
  // A cube of which no facet is exactly planar, whose second refinement comes upon its own points.
  Plain cube;
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (int i = 0; i < 8; ++i) {
    const double x = i & 1, y = i >> 1 & 1, z = i >> 2 & 1, v = s * x + c * y;
    cube.insert(Plain::Point(c * x - s * y, c * v - s * z, s * v + c * z));
  }
  require(wc::refine(cube, wc::options(1.5)).status == WSP_DONE && wc::bad_short_edges(cube, 1.5).empty(), "a turned cube");
  wc::options limited(1.5);
  limited.max_vertices = 1000;
  wc::refine(cube, limited);
  // The way of domains, too, which looks at cells with corners where its points are to come.
  const auto all = [](const Plain::Cell_handle&) { return true; };
  wc::refine(cube, limited, all);
  require(cube.is_valid(), "the turned cube, refined again");
}

void lower() {
  Plain dt;
  require(wc::refine(dt).inserted() == 0, "the empty triangulation");
  for (int i = 0; i < 4; ++i) dt.insert(Plain::Point(i, i * i, 0));
  require(wc::refine(dt).inserted() == 0 && wc::bad_short_edges(dt, 2).empty(), "dimension 2");
  for (double bound : {0.1, 1e7, std::nan("")}) {
    try {
      wc::refine(dt, wc::options(bound));
      require(false, "a bound that can't be");
    } catch (const std::invalid_argument&) {
    }
  }
  Plain limited;
  fill(limited, 150, 5);
  wc::options options(2);
  options.max_vertices = limited.number_of_vertices() + 10;
  require(wc::refine(limited, options).status == WSP_VERTEX_LIMIT, "the limit's status");
  require(limited.number_of_vertices() == options.max_vertices && limited.is_valid(), "the limit");
}

// Two points 2^-28 apart in a box at 2^21: the default for the shortest edge is 2^-46 of that then, more than 2^-40 of the diagonal.
void far_away() {
  const double at = std::ldexp(1, 21), floor = std::ldexp(1, 21 - 46);
  const auto shortest_new = [&](double min_edge) {
    Plain dt;
    for (int i = 0; i < 8; ++i) dt.insert(Plain::Point(at + (i & 1 ? 3 : -3), i & 2 ? 3 : -3, i & 4 ? 3 : -3));
    dt.insert(Plain::Point(at, 0, 0));
    dt.insert(Plain::Point(at + std::ldexp(1, -28), 0, 0));
    wc::options options(2);
    options.min_edge = min_edge;
    std::vector<Plain::Vertex_handle> added;
    const wc::report done = wc::refine(dt, options, wc::everywhere(), [&](Plain::Vertex_handle v, wc::origin) { added.push_back(v); });
    require(!added.empty() && dt.is_valid(), "the box far away");
    require((done.status == WSP_UNREFINED) == (min_edge == 0) && (done.refused > 0) == (min_edge == 0), "the status far away");
    double least = 1;
    for (auto v : added)
      for (auto w = dt.finite_vertices_begin(); w != dt.finite_vertices_end(); ++w)
        if (v != Plain::Vertex_handle(w)) least = std::min(least, std::sqrt(CGAL::squared_distance(v->point(), w->point())));
    return least;
  };
  require(shortest_new(0) >= floor, "a shorter edge than the default's floor");
  require(shortest_new(std::ldexp(1, -37)) < floor, "no shorter edge where one is allowed");
}

void throwing() {
  Plain dt;
  fill(dt, 150, 5);
  int left = 20;
  bool thrown = false;
  try {
    wc::refine(dt, wc::options(2), wc::everywhere(), [&](Plain::Vertex_handle, wc::origin) {
      if (--left == 0) throw std::domain_error("enough");
    });
  } catch (const std::domain_error&) {
    thrown = true;
  }
  require(thrown && dt.is_valid(), "the callback's exception");
  require_done(dt, wc::refine(dt), 2);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string name = argc > 1 ? argv[1] : "";
  try {
    using Vertex = CGAL::Triangulation_vertex_base_with_info_3<int, Epick>;
    using Cell = CGAL::Triangulation_cell_base_with_info_3<std::string, Epick, CGAL::Delaunay_triangulation_cell_base_3<Epick>>;
    using With_info = CGAL::Delaunay_triangulation_3<Epick, CGAL::Triangulation_data_structure_3<Vertex, Cell>>;
    if (name == "epick") {
      for (wsp_rule rule : {WSP_RULE_SPARSE, WSP_RULE_PAPER, WSP_RULE_CIRCUMCENTER})
        for (double bound : {1.5, 2., 4.}) refine<With_info>(rule, bound);
    } else if (name == "epeck") {
      refine<CGAL::Delaunay_triangulation_3<Epeck>>(WSP_RULE_SPARSE, 2);
#ifdef WELLSPACED_TEST_TBB
    } else if (name == "parallel") {
      using Structure = CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_3<Epick>,
                                                             CGAL::Delaunay_triangulation_cell_base_3<Epick>, CGAL::Parallel_tag>;
      refine<CGAL::Delaunay_triangulation_3<Epick, Structure>>(WSP_RULE_SPARSE, 2);
#endif
    } else if (name == "domain") {
      domain();
    } else if (name == "slanted") {
      slanted();
    } else if (name == "hulls") {
      hulls();
    } else if (name == "lower") {
      lower();
    } else if (name == "far") {
      far_away();
    } else if (name == "throwing") {
      throwing();
    } else {
      throw std::runtime_error("no such test");
    }
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "cgal_host %s: %s\n", name.c_str(), problem.what());
    return 1;
  }
}
