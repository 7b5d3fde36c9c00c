// Point sets for the comparison with CGAL: random ones, and those on which inexact triangulations fail.
// The same on every machine: no generator of the standard library's distributions is used.
#ifndef WELLSPACED_TESTS_POINT_SETS_HPP
#define WELLSPACED_TESTS_POINT_SETS_HPP

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace point_sets {

using Coordinates = std::vector<double>;

// Sebastiano Vigna's SplitMix64.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  // In [low, high).
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53; }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits() % n); }

 private:
  std::uint64_t state_;
};

inline void add(Coordinates& c, double x, double y, double z) { c.insert(c.end(), {x, y, z}); }

inline void shuffle(Coordinates& c, Random& random) {
  for (std::size_t i = c.size() / 3; i > 1; --i) {
    const std::size_t j = random.below(i);
    for (std::size_t k = 0; k < 3; ++k) std::swap(c[3 * (i - 1) + k], c[3 * j + k]);
  }
}

inline Coordinates uniform(std::size_t n, std::uint64_t seed = 1) {
  Random random(seed);
  Coordinates c;
  for (std::size_t i = 0; i < 3 * n; ++i) c.push_back(random.uniform(-1, 1));
  return c;
}

// Rounded to the sphere: nearly cospherical, nothing exactly so.
inline Coordinates sphere(std::size_t n) {
  Random random(2);
  Coordinates c;
  while (c.size() < 3 * n) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const double r = std::sqrt(x * x + y * y + z * z);
    if (r > 0.1 && r <= 1) add(c, x / r, y / r, z / r);
  }
  return c;
}

inline Coordinates grid(int n, double step = 1, double origin = 0) {
  Random random(3);
  Coordinates c;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) add(c, origin + step * x, origin + step * y, origin + step * z);
  shuffle(c, random);
  return c;
}

// All integer points on the sphere of this squared radius, and its centre if asked for: exactly cospherical.
inline Coordinates cospherical(int radius2, bool centre) {
  Random random(4);
  Coordinates c;
  const int r = static_cast<int>(std::sqrt(static_cast<double>(radius2))) + 1;
  for (int x = -r; x <= r; ++x)
    for (int y = -r; y <= r; ++y)
      for (int z = -r; z <= r; ++z)
        if (x * x + y * y + z * z == radius2) add(c, x, y, z);
  if (centre) add(c, 0, 0, 0);
  shuffle(c, random);
  return c;
}

// On the plane x + 2y = z, on a grid there (cocircular) or anywhere that doubles can say exactly.
inline Coordinates coplanar(std::size_t n, bool on_grid, std::size_t off) {
  Random random(5);
  Coordinates c;
  for (std::size_t i = 0; i < n; ++i) {
    const double range = on_grid ? 24 : 1 << 20;
    const double x = std::floor(random.uniform(0, range)), y = std::floor(random.uniform(0, range));
    add(c, x, y, x + 2 * y);
  }
  for (std::size_t i = 0; i < off; ++i) add(c, random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
  shuffle(c, random);
  return c;
}

inline Coordinates collinear(std::size_t n, std::size_t off) {
  Random random(6);
  Coordinates c;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = std::floor(random.uniform(-100000, 100000));
    add(c, t, 1 - 2 * t, 3 * t);
  }
  for (std::size_t i = 0; i < off; ++i) add(c, random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
  shuffle(c, random);
  return c;
}

// Clusters of ever smaller size, down to a few units in the last place.
inline Coordinates clustered(std::size_t n) {
  Random random(7);
  Coordinates c;
  const std::size_t clusters = 12;
  Coordinates centres = uniform(clusters, 8);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = i % clusters;
    const double size = std::pow(0.05, static_cast<double>(k));
    add(c, centres[3 * k] + size * random.uniform(-1, 1), centres[3 * k + 1] + size * random.uniform(-1, 1),
        centres[3 * k + 2] + size * random.uniform(-1, 1));
  }
  shuffle(c, random);
  return c;
}

// Each point of a small set many times.
inline Coordinates duplicated(std::size_t n) {
  Random random(9);
  const Coordinates some = uniform(n / 10, 10), lattice = grid(5, 0.25);
  Coordinates c;
  while (c.size() < 3 * n) {
    const Coordinates& from = random.below(2) == 0 ? some : lattice;
    const std::size_t i = random.below(from.size() / 3);
    add(c, from[3 * i], from[3 * i + 1], from[3 * i + 2]);
  }
  return c;
}

inline std::map<std::string, Coordinates (*)()> all() {
  return {
      {"none", [] { return Coordinates(); }},
      {"one", [] { return uniform(1); }},
      {"random_100", [] { return uniform(100); }},
      {"random_1000", [] { return uniform(1000); }},
      {"random_10000", [] { return uniform(10000); }},
      {"random_100000", [] { return uniform(100000); }},
      {"sphere", [] { return sphere(10000); }},
      {"grid_20", [] { return grid(20); }},
      {"grid_20_of_tenths", [] { return grid(20, 0.1, 1e6); }},
      {"cospherical", [] { return cospherical(5 * 5 * 13 * 13, false); }},
      {"cospherical_and_centre", [] { return cospherical(2601, true); }},
      {"coplanar", [] { return coplanar(2000, false, 0); }},
      {"coplanar_grid", [] { return coplanar(2000, true, 0); }},
      {"coplanar_few_off", [] { return coplanar(2000, false, 4); }},
      {"coplanar_grid_few_off", [] { return coplanar(2000, true, 4); }},
      {"collinear", [] { return collinear(1000, 0); }},
      {"collinear_few_off", [] { return collinear(1000, 4); }},
      {"collinear_one_off", [] { return collinear(1000, 1); }},
      {"clustered", [] { return clustered(10000); }},
      {"duplicated", [] { return duplicated(10000); }},
  };
}

}  // namespace point_sets

#endif
