// The library, through its C API alone, beside CGAL: exact equality of the sets of tetrahedra, exact bounds, exact
// volumes.
//
//   cgal_crosscheck delaunay SET             point_sets.hpp has the sets
//   cgal_crosscheck refine FILE BETA RULE    FILE: a .poly of a box; RULE: paper or circumcenter
//   cgal_crosscheck step FILE BETA RULE      the same, as a host would: ask for an edge, its batch, insert it
//   cgal_crosscheck list                     the sets
//
// The calls are made in the floating-point mode that WELLSPACED_TEST_MODE names: host_mode.hpp.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cgal/point_sets.hpp"
#include "cgal/poly_file.hpp"
#include "cgal/reference.hpp"
#include "host_mode.hpp"
#include "wellspaced.h"

namespace {

using point_sets::Coordinates;
using reference::Point;
using reference::Tetrahedron;
using reference::Triangle;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

void require(bool holds, const std::string& what) {
  if (!holds) fail(what);
}

void done(wsp_status status, const char* call) {
  if (status != WSP_DONE)
    fail(std::string(call) + ": " + wsp_status_string(status) + (status < 0 ? std::string(": ") + wsp_last_error() : ""));
}
#define IN_MODE(call) host_mode::in_mode([&] { return call; })
#define DONE(call) done(IN_MODE(call), #call)

struct Free {
  void operator()(wsp_triangulation* t) const { wsp_triangulation_free(t); }
  void operator()(wsp_plc* p) const { wsp_plc_free(p); }
  void operator()(wsp_batch* b) const { wsp_batch_free(b); }
};
using Triangulation = std::unique_ptr<wsp_triangulation, Free>;
using Plc = std::unique_ptr<wsp_plc, Free>;
using Batch = std::unique_ptr<wsp_batch, Free>;

Triangulation empty_triangulation() {
  wsp_triangulation* t = nullptr;
  DONE(wsp_triangulation_new(nullptr, &t));
  return Triangulation(t);
}

wsp_mesh_view view_of(const Triangulation& t) {
  wsp_mesh_view view;
  DONE(wsp_mesh_view_init(&view, sizeof view));
  DONE(wsp_triangulation_view(t.get(), &view));
  return view;
}

Tetrahedron tetrahedron(const wsp_mesh_view& view, std::size_t i) {
  const std::uint32_t* t = view.tetrahedra + 4 * i;
  return {t[0], t[1], t[2], t[3]};
}

std::vector<Tetrahedron> tetrahedra(const wsp_mesh_view& view) {
  std::vector<Tetrahedron> list(view.tetrahedra_count);
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = tetrahedron(view, i);
  return list;
}

Point point(const double* xyz, std::uint32_t i) {
  const double* p = xyz + 3 * std::size_t{i};
  return {p[0], p[1], p[2]};
}

template <class Simplex>
std::vector<Simplex> normal_form(std::vector<Simplex> list) {
  for (auto& simplex : list) std::sort(simplex.begin(), simplex.end());
  std::sort(list.begin(), list.end());
  return list;
}

std::string text(const std::vector<Tetrahedron>& list) {
  std::string s = std::to_string(list.size());
  for (std::size_t i = 0; i < std::min<std::size_t>(list.size(), 3); ++i) {
    s += i == 0 ? " (" : ", ";
    for (auto v : list[i]) s += std::to_string(v) + " ";
  }
  return s + (list.empty() ? "" : ")");
}

// Both lists in normal form.
void require_same(const std::vector<Tetrahedron>& ours, const std::vector<Tetrahedron>& cgals) {
  if (ours == cgals) return;
  std::vector<Tetrahedron> only_ours, only_cgals;
  std::set_difference(ours.begin(), ours.end(), cgals.begin(), cgals.end(), std::back_inserter(only_ours));
  std::set_difference(cgals.begin(), cgals.end(), ours.begin(), ours.end(), std::back_inserter(only_cgals));
  fail("other tetrahedra than CGAL's: only here " + text(only_ours) + ", only there " + text(only_cgals));
}

// The view's faces without a neighbour. Checks orientations and neighbours on the way.
std::vector<Triangle> sound_view(const wsp_mesh_view& view) {
  std::vector<Triangle> boundary;
  const auto face = [&](std::size_t t, int i) {
    Triangle f;
    for (int k = 0, n = 0; k < 4; ++k)
      if (k != i) f[n++] = view.tetrahedra[4 * t + k];
    std::sort(f.begin(), f.end());
    return f;
  };
  for (std::size_t t = 0; t < view.tetrahedra_count; ++t) {
    const auto v = tetrahedron(view, t);
    require(reference::orientation(point(view.points, v[0]), point(view.points, v[1]), point(view.points, v[2]),
                                   point(view.points, v[3])) == 1,
            "tetrahedron " + std::to_string(t) + " is not positively oriented");
    for (int i = 0; i < 4; ++i) {
      const std::uint32_t n = view.neighbours[4 * t + i];
      if (n == WSP_NONE) {
        boundary.push_back(face(t, i));
        continue;
      }
      require(n < view.tetrahedra_count, "a neighbour that does not exist");
      int back = 0;
      while (back < 4 && view.neighbours[4 * std::size_t{n} + back] != t) ++back;
      require(back < 4 && face(n, back) == face(t, i), "neighbours disagree on the face between them");
    }
  }
  return normal_form(boundary);
}

// Whether `t` is CGAL's triangulation of the points, of which the i-th became vertex ids[i].
void require_cgals(const Triangulation& t, const Coordinates& xyz, const std::vector<std::uint32_t>& ids) {
  const auto cgal = reference::delaunay(xyz.data(), xyz.size() / 3);
  std::int32_t dimension = 0;
  std::size_t vertices = 0, cells = 0;
  DONE(wsp_triangulation_dimension(t.get(), &dimension));
  DONE(wsp_triangulation_counts(t.get(), &vertices, &cells));
  require(dimension == cgal.dimension,
          "dimension " + std::to_string(dimension) + ", CGAL says " + std::to_string(cgal.dimension));
  require(vertices == cgal.vertices,
          std::to_string(vertices) + " vertices, CGAL says " + std::to_string(cgal.vertices));
  const auto view = view_of(t);
  require(cells == view.tetrahedra_count, "the count of tetrahedra is not the view's");
  for (std::size_t i = 0; i < ids.size(); ++i)
    require(ids[i] < view.points_count && point(view.points, ids[i]) == point(xyz.data(), static_cast<std::uint32_t>(i)),
            "vertex " + std::to_string(ids[i]) + " is not where point " + std::to_string(i) + " was put");
  auto expected = cgal.tetrahedra;
  for (auto& cell : expected)
    for (auto& v : cell) v = ids[v];
  require_same(normal_form(tetrahedra(view)), normal_form(expected));
  const auto boundary = sound_view(view);
  if (dimension == 3) {
    auto hull = cgal.hull;
    for (auto& facet : hull)
      for (auto& v : facet) v = ids[v];
    require(boundary == normal_form(hull), "another hull than CGAL's");
  }
  DONE(wsp_triangulation_validate(t.get(), WSP_VALIDATE_DELAUNAY, 0));
  std::printf("%zu points: %zu vertices, dimension %d, %zu tetrahedra: CGAL's\n", ids.size(), vertices,
              static_cast<int>(dimension), cells);
}

void delaunay(const std::string& name) {
  const auto sets = point_sets::all();
  const auto found = sets.find(name);
  require(found != sets.end(), "no point set " + name);
  const Coordinates xyz = found->second();
  const std::size_t n = xyz.size() / 3;

  std::vector<std::uint32_t> ids(n);
  auto bulk = empty_triangulation();
  DONE(wsp_triangulation_insert(bulk.get(), xyz.data(), n, ids.data(), nullptr));
  require_cgals(bulk, xyz, ids);

  // The same in pieces: single points, then half of the rest, then the rest.
  auto pieces = empty_triangulation();
  std::fill(ids.begin(), ids.end(), WSP_NONE);
  const std::size_t singles = 500;
  for (std::size_t i = 0, piece; i < n; i += piece) {
    piece = i < singles ? 1 : i == singles ? (n - i + 1) / 2 : n - i;
    DONE(wsp_triangulation_insert(pieces.get(), xyz.data() + 3 * i, piece, ids.data() + i, nullptr));
  }
  require_cgals(pieces, xyz, ids);
}

struct Domain {
  Triangulation triangulation;
  Coordinates input;
  Point low, high;
};

// Whether `t` is CGAL's triangulation of its own vertices.
void require_cgals_of_its_vertices(const Triangulation& t) {
  const auto view = view_of(t);
  const Coordinates xyz(view.points, view.points + 3 * view.points_count);
  std::vector<std::uint32_t> ids(view.points_count);
  std::iota(ids.begin(), ids.end(), 0u);
  require_cgals(t, xyz, ids);
}

Domain box_of(const std::string& path) {
  const auto poly = poly_file::read(path);
  wsp_plc* raw = nullptr;
  DONE(wsp_plc_new(&raw));
  const Plc plc(raw);
  DONE(wsp_plc_add_points(plc.get(), poly.xyz.data(), poly.xyz.size() / 3, nullptr, nullptr));
  std::vector<std::uint32_t> corners;
  std::vector<std::size_t> starts{0};
  for (const auto& polygon : poly.facets) {
    corners.insert(corners.end(), polygon.begin(), polygon.end());
    starts.push_back(corners.size());
  }
  const std::size_t facets = poly.facets.size();
  DONE(wsp_plc_add_facets(plc.get(), corners.data(), starts.data(), facets, nullptr, facets, nullptr, nullptr));
  wsp_triangulation* t = nullptr;
  DONE(wsp_triangulation_from_plc(plc.get(), nullptr, nullptr, &t));
  Domain domain{Triangulation(t), poly.xyz, {}, {}};
  for (int k = 0; k < 3; ++k) {
    domain.low[k] = std::numeric_limits<double>::infinity();
    domain.high[k] = -domain.low[k];
    for (std::size_t i = k; i < poly.xyz.size(); i += 3) {
      domain.low[k] = std::min(domain.low[k], poly.xyz[i]);
      domain.high[k] = std::max(domain.high[k], poly.xyz[i]);
    }
  }
  require_cgals_of_its_vertices(domain.triangulation);
  return domain;
}

void require_refined(const Domain& domain, double beta, bool unencroached = true) {
  const auto view = view_of(domain.triangulation);
  // The data sets have no duplicates: the first vertices are the input's.
  require(std::equal(domain.input.begin(), domain.input.end(), view.points), "an input vertex was moved");

  require_cgals_of_its_vertices(domain.triangulation);

  // The bound, exactly.
  const auto cells = tetrahedra(view);
  const auto over = reference::all_over_bound(view.points, cells.data(), cells.size(), beta);
  require(over.empty(), std::to_string(over.size()) + " tetrahedra are over the bound");
  std::size_t edges = 0;
  DONE(wsp_bad_short_edges(domain.triangulation.get(), beta, nullptr, 0, &edges));
  require(edges == 0, std::to_string(edges) + " bad short edges are left");

  // Boundary facets conform: each lies in a side of the box, and together with the exact volume they leave no part of the box
  // out. None is encroached, unless vertices have been taken away again or the sparse rule has let them be.
  for (std::size_t t = 0; t < cells.size(); ++t) {
    for (int i = 0; i < 4; ++i) {
      if (view.neighbours[4 * t + i] != WSP_NONE) continue;
      const Point a = point(view.points, cells[t][(i + 1) % 4]), b = point(view.points, cells[t][(i + 2) % 4]),
                  c = point(view.points, cells[t][(i + 3) % 4]), opposite = point(view.points, cells[t][i]);
      bool in_a_side = false;
      for (int k = 0; k < 3; ++k)
        for (double side : {domain.low[k], domain.high[k]})
          in_a_side = in_a_side || (a[k] == side && b[k] == side && c[k] == side);
      require(in_a_side, "a boundary facet lies in no side of the box");
      require(!unencroached || reference::side_of_smallest_sphere(a, b, c, opposite) <= 0,
              "vertex " + std::to_string(cells[t][i]) + " encroaches on a subfacet");
    }
  }
  require(reference::compare_volume_with_box(view.points, cells.data(), cells.size(), domain.low, domain.high) == 0,
          "the volumes do not add up to the box's");
  std::printf("every radius-edge ratio is at most %g, the boundary conforms, the volumes add up\n", beta);
}

wsp_rule rule_of(const std::string& name) {
  if (name == "paper") return WSP_RULE_PAPER;
  if (name == "sparse") return WSP_RULE_SPARSE;
  if (name == "circumcenter") return WSP_RULE_CIRCUMCENTER;
  fail("no rule " + name);
}

void refine(const std::string& path, double beta, const std::string& rule, wsp_sparsify level) {
  const auto domain = box_of(path);
  std::size_t before = 0;
  DONE(wsp_triangulation_counts(domain.triangulation.get(), &before, nullptr));
  wsp_refine_options options;
  DONE(wsp_refine_options_init(&options, sizeof options));
  options.radius_edge = beta;
  options.rule = rule_of(rule);
  options.sparsify = level;
  wsp_report report;
  DONE(wsp_report_init(&report, sizeof report));
  DONE(wsp_refine(domain.triangulation.get(), &options, nullptr, &report));
  require(report.bad == 0, "bad is not 0");
  const bool lazy = options.rule == WSP_RULE_SPARSE && level != WSP_SPARSIFY_OFF;
  require_refined(domain, beta, report.removed + report.replaced == 0 && !lazy);
  const auto view = view_of(domain.triangulation);
  require(report.vertices == view.points_count && report.tetrahedra == view.tetrahedra_count &&
              report.steiner == view.points_count - domain.input.size() / 3 &&
              report.vertices + report.removed + report.replaced ==
                  before + report.samples + report.segment_splits + report.facet_splits,
          "the report counts otherwise than the view");
  // A rounded figure: require_refined has the exact answer.
  require(report.worst_radius_edge > 0 && report.worst_radius_edge <= beta * (1 + 1e-9),
          "worst_radius_edge is over the bound");
}

void step(const std::string& path, double beta, const std::string& rule) {
  const auto domain = box_of(path);
  wsp_triangulation* t = domain.triangulation.get();
  wsp_sampler_options options;
  DONE(wsp_sampler_options_init(&options, sizeof options));
  options.radius_edge = beta;
  options.rule = rule_of(rule);
  std::size_t vertices = 0, steps = 0;
  Coordinates stalled;
  DONE(wsp_triangulation_counts(t, &vertices, nullptr));
  for (;; ++steps) {
    wsp_edge edge;
    std::size_t count = 0;
    const wsp_status status = IN_MODE(wsp_bad_short_edges(t, beta, &edge, 1, &count));
    if (count > 1) require(status == WSP_INCOMPLETE, "a list cut short is not said to be incomplete");
    else done(status, "wsp_bad_short_edges");
    if (count == 0) break;
    wsp_batch* raw = nullptr;
    DONE(wsp_steiner_batch(t, edge, &options, &raw));
    const Batch batch(raw);
    const Coordinates points(wsp_batch_points(batch.get()),
                             wsp_batch_points(batch.get()) + 3 * wsp_batch_count(batch.get()));
    require(!points.empty(), "a bad edge gets an empty batch");
    // A batch may give way to a boundary split that has to come first: then the next is another.
    require(points != stalled, "a batch adds no vertex and comes again");
    DONE(wsp_triangulation_insert_batch(t, batch.get(), nullptr));
    std::size_t now = 0;
    DONE(wsp_triangulation_counts(t, &now, nullptr));
    stalled = now > vertices ? Coordinates() : points;
    vertices = now;
    require(vertices < 1000000, "no end in sight");
  }
  std::printf("%zu steps\n", steps);
  require(steps > 0, "there was nothing to refine");
  require_refined(domain, beta);
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && arguments[0] == "list") {
    for (const auto& entry : point_sets::all()) std::printf("%s\n", entry.first.c_str());
  } else if (arguments.size() == 2 && arguments[0] == "delaunay") {
    delaunay(arguments[1]);
  } else if (arguments.size() == 4 && arguments[0] == "refine") {
    refine(arguments[1], std::stod(arguments[2]), arguments[3], WSP_SPARSIFY_OFF);
    refine(arguments[1], std::stod(arguments[2]), arguments[3], WSP_SPARSIFY_MOVES);
    refine(arguments[1], std::stod(arguments[2]), arguments[3], WSP_SPARSIFY_QUICK);
  } else if (arguments.size() == 4 && arguments[0] == "step") {
    step(arguments[1], std::stod(arguments[2]), arguments[3]);
  } else {
    std::fprintf(stderr, "usage: cgal_crosscheck delaunay SET | refine FILE BETA RULE | step FILE BETA RULE | list\n");
    return 2;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cgal_crosscheck: %s\n", error.what());
    return 1;
  }
}
