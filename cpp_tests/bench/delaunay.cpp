// One run of one library on one set of points, for script/bench: a process each, so that its peak memory is its own.
//
//   delaunay ENGINE SET N [THREADS]
//
// ENGINE: wellspaced, cgal, tetgen; SET: uniform, sphere, grid, tenths; THREADS: 1 by default, which the peers are left at.
// Prints the processor seconds (user and system) and the seconds by the clock that the triangulation took, the number of its
// tetrahedra, and the process's peak memory in MiB, points included.
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tetgen.h>

#include "../cgal/point_sets.hpp"
#include "wellspaced.h"

namespace {

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "delaunay: %s\n", what);
  std::exit(1);
}

rusage usage() {
  rusage r;
  if (getrusage(RUSAGE_SELF, &r) != 0) fail("getrusage");
  return r;
}

struct Seconds {
  double processor, clock;
  Seconds operator-(const Seconds& before) const { return {processor - before.processor, clock - before.clock}; }
};

Seconds seconds() {
  const rusage r = usage();
  const auto of = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  const std::chrono::duration<double> clock = std::chrono::steady_clock::now().time_since_epoch();
  return {of(r.ru_utime) + of(r.ru_stime), clock.count()};
}

// getrusage's figure would begin with that of the program that started this one.
double peak_mebibytes() {
  std::FILE* status = std::fopen("/proc/self/status", "r");
  if (status == nullptr) fail("/proc/self/status");
  double kibibytes = 0;
  for (char line[256]; std::fgets(line, sizeof line, status) != nullptr;) std::sscanf(line, "VmHWM: %lf", &kibibytes);
  std::fclose(status);
  return kibibytes / 1024;
}

// Directions all around, radii within a thousandth of 1.
point_sets::Coordinates jittered_sphere(std::size_t n) {
  point_sets::Random random(2);
  point_sets::Coordinates c;
  c.reserve(3 * n);
  while (c.size() < 3 * n) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const double r = std::sqrt(x * x + y * y + z * z);
    if (r <= 0.1 || r > 1) continue;
    const double scale = random.uniform(0.999, 1.001) / r;
    point_sets::add(c, scale * x, scale * y, scale * z);
  }
  return c;
}

point_sets::Coordinates points(const std::string& set, std::size_t n) {
  if (set == "uniform") {
    point_sets::Random random(1);
    point_sets::Coordinates c(3 * n);
    for (double& x : c) x = random.uniform(0, 1);
    return c;
  }
  if (set == "sphere") return jittered_sphere(n);
  const int side = int(std::lround(std::cbrt(double(n))));
  if (set == "grid") return point_sets::grid(side);
  // Multiples of 0.1 as doubles have them: cospherical where boxes are, nearly so elsewhere.
  if (set == "tenths") return point_sets::grid(side, 0.1);
  fail("no such set");
}

struct Result {
  Seconds seconds;
  std::size_t tetrahedra;
};

Result wellspaced(const point_sets::Coordinates& c, unsigned threads) {
  wsp_triangulation* t = nullptr;
  wsp_triangulation_options options;
  if (wsp_triangulation_options_init(&options, sizeof options) != WSP_DONE) fail(wsp_last_error());
  options.threads = threads;
  const Seconds before = seconds();
  if (wsp_triangulation_new(&options, &t) != WSP_DONE) fail(wsp_last_error());
  if (wsp_triangulation_insert(t, c.data(), c.size() / 3, nullptr, nullptr) != WSP_DONE) fail(wsp_last_error());
  const Seconds after = seconds();
  std::size_t vertices = 0, tetrahedra = 0;
  if (wsp_triangulation_counts(t, &vertices, &tetrahedra) != WSP_DONE) fail(wsp_last_error());
  wsp_triangulation_free(t);
  return {after - before, tetrahedra};
}

Result cgal(const point_sets::Coordinates& c) {
  using Triangulation = CGAL::Delaunay_triangulation_3<CGAL::Exact_predicates_inexact_constructions_kernel>;
  std::vector<Triangulation::Point> list;
  list.reserve(c.size() / 3);
  for (std::size_t i = 0; i < c.size(); i += 3) list.emplace_back(c[i], c[i + 1], c[i + 2]);
  const Seconds before = seconds();
  const Triangulation t(list.begin(), list.end());
  return {seconds() - before, t.number_of_finite_cells()};
}

Result tetgen(point_sets::Coordinates& c) {
  tetgenio in, out;
  in.numberofpoints = int(c.size() / 3);
  in.pointlist = c.data();
  char options[] = "QNEF";
  tetgenbehavior behavior;
  if (!behavior.parse_commandline(options)) fail("tetgen's options");
  const Seconds before = seconds();
  tetrahedralize(&behavior, &in, &out);
  const Seconds after = seconds();
  in.pointlist = nullptr;
  return {after - before, std::size_t(out.numberoftetrahedra)};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) fail("usage: delaunay ENGINE SET N [THREADS]");
  point_sets::Coordinates c = points(argv[2], std::strtoull(argv[3], nullptr, 10));
  const std::string engine = argv[1];
  Result result;
  if (engine == "wellspaced") result = wellspaced(c, argc == 5 ? unsigned(std::strtoul(argv[4], nullptr, 10)) : 1);
  else if (engine == "cgal") result = cgal(c);
  else if (engine == "tetgen") result = tetgen(c);
  else fail("no such engine");
  std::printf("%.6f %.6f %zu %.1f\n", result.seconds.processor, result.seconds.clock, result.tetrahedra, peak_mebibytes());
}
