// What wellspaced/cgal.hpp costs and whether it does as wellspaced's own kernel does: the refinement of a domain's points in CGAL, beside CGAL's
// insertion of the very same points, in one process by turns, and beside the Steiner points of the own kernel.
//
//   cgal FILE BETA RULE [RUNS]     FILE: a .poly of points in a box; RULE: sparse, paper, circumcenter
//
// Plain insertion, which the overhead is over, is what a host would do that had the list of Steiner points: it inserts them one by
// one in the same order, each located from the one before. Both sides include the triangulation of the input.
//
// Prints: Steiner points here and there, and how many of them, one by one, are the same to the last bit; seconds of the triangulation of the
// input, of the refinement, of plain insertion, of the same points at once in CGAL's own spatial order; and the medians of the paired
// ratios of the whole (triangulation and refinement) to each. Exits with 1 if bad cells are left or the counts differ: several orders
// of the input are tried where it is small.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "../cgal/poly_file.hpp"
#include "wellspaced/cgal.hpp"
#include "wellspaced/wellspaced.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Dt = CGAL::Delaunay_triangulation_3<Kernel>;
using Point = Dt::Point;

double seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: %s FILE BETA RULE [RUNS]\n", argv[0]);
    return 2;
  }
  const poly_file::Poly poly = poly_file::read(argv[1]);
  const std::string name = argv[3];
  const wsp_rule rule = name == "paper"          ? WSP_RULE_PAPER
                        : name == "circumcenter" ? WSP_RULE_CIRCUMCENTER
                                                 : WSP_RULE_SPARSE;
  const wellspaced::cgal::options options(std::atof(argv[2]), rule);
  const int runs = argc > 4 ? std::max(1, std::atoi(argv[4])) : 1;
  std::vector<Point> input;
  for (std::size_t i = 0; i < poly.xyz.size(); i += 3) input.emplace_back(poly.xyz[i], poly.xyz[i + 1], poly.xyz[i + 2]);

  std::vector<double> first, refined, ordered, sorted, over_ordered, over_sorted;
  wellspaced::cgal::report report;
  std::size_t bad = 0;
  for (int run = 0; run < runs; ++run) {
    std::vector<Point> steiner;
    double t0 = seconds();
    Dt dt(input.begin(), input.end());
    double t1 = seconds();
    report = wellspaced::cgal::refine(dt, options, wellspaced::cgal::everywhere(),
                                      [&](Dt::Vertex_handle v, wellspaced::cgal::origin) { steiner.push_back(v->point()); });
    double t2 = seconds();
    first.push_back(t1 - t0);
    refined.push_back(t2 - t1);
    const double whole = t2 - t0;
    bad = wellspaced::cgal::bad_short_edges(dt, options.radius_edge).size();
    {
      t0 = seconds();
      Dt plain(input.begin(), input.end());
      t1 = seconds();
      Dt::Cell_handle hint = plain.infinite_vertex()->cell();
      for (const Point& p : steiner) hint = plain.insert(p, hint)->cell();
      t2 = seconds();
      if (plain.number_of_finite_cells() != dt.number_of_finite_cells()) return std::fprintf(stderr, "cells differ\n"), 1;
      ordered.push_back(t2 - t1);
      over_ordered.push_back(whole / (t2 - t0));
    }
    {
      t0 = seconds();
      Dt plain(input.begin(), input.end());
      t1 = seconds();
      plain.insert(steiner.begin(), steiner.end());
      t2 = seconds();
      sorted.push_back(t2 - t1);
      over_sorted.push_back(whole / (t2 - t0));
    }
  }

  // The same points in the same order, here and in the own kernel: several orders where that costs little.
  wsp::point low{input[0].x(), input[0].y(), input[0].z()}, high = low;
  for (const Point& p : input)
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  std::vector<Point> box;
  for (int i = 0; i < 8; ++i)
    box.emplace_back(i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
  const auto is_corner = [&](const Point& p) { return std::find(box.begin(), box.end(), p) != box.end(); };
  input.erase(std::remove_if(input.begin(), input.end(), is_corner), input.end());
  std::mt19937 random(1);
  std::size_t here = 0, there = 0, same = 0;
  const int orders = report.inserted() < 2000 ? 10 : 1;
  for (int order = 0; order < orders; ++order) {
    Dt dt;
    for (const Point& p : box) dt.insert(p);
    for (const Point& p : input) dt.insert(p);
    std::vector<Point> steiner;
    wellspaced::cgal::refine(dt, options, wellspaced::cgal::everywhere(),
                             [&](Dt::Vertex_handle v, wellspaced::cgal::origin) { steiner.push_back(v->point()); });
    bad += wellspaced::cgal::bad_short_edges(dt, options.radius_edge).size();
    here += steiner.size();
    std::vector<wsp::point> points;
    for (const Point& p : input) points.push_back({p.x(), p.y(), p.z()});
    wsp::plc domain;
    domain.add_box(low, high);
    domain.add_points(points);
    wsp::triangulation own(domain);
    wsp::refine_options alone(options.radius_edge, rule);
    alone.sparsify = WSP_SPARSIFY_OFF;  // CGAL's side takes nothing away again
    there += own.refine(alone).steiner;
    const wsp::mesh_view view = own.view();
    const std::size_t first = box.size() + input.size();
    std::size_t k = 0;
    for (; k < steiner.size() && first + k < view.vertices.size(); ++k) {
      const double* p = view.vertices.data() + 3 * (first + k);
      if (p[0] != steiner[k].x() || p[1] != steiner[k].y() || p[2] != steiner[k].z()) {
        if (std::getenv("WELLSPACED_VERBOSE"))
          std::fprintf(stderr, "order %d: point %zu is %.17g %.17g %.17g here, %.17g %.17g %.17g there\n", order, k, steiner[k].x(),
                       steiner[k].y(), steiner[k].z(), p[0], p[1], p[2]);
        break;
      }
    }
    same += k;
    std::shuffle(input.begin(), input.end(), random);
  }
  std::printf(
      "%zu steiner (once: %zu samples, %zu on segments, %zu on facets), own kernel %zu, the same %zu; delaunay %.4f s, refine %.4f s, "
      "plain in order %.4f s, plain sorted %.4f s; whole / plain in order %.2f, whole / plain sorted %.2f; bad %zu, refused %zu\n",
      here, report.samples, report.segment_splits, report.facet_splits, there, same, median(first), median(refined),
      median(ordered), median(sorted), median(over_ordered), median(over_sorted), bad, report.refused);
  return bad != 0 || here != there || same != here;
}
