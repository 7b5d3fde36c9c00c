// What CGAL says: its Delaunay triangulation and exact answers to the questions that the tests ask.
//
// A plain C++17 face, so that CGAL's templates are compiled once (reference.cpp) and serve both the
// C++ cross-checks and the Rust oracle. CGAL is GPL: this is linked by tests only.
#ifndef WELLSPACED_TESTS_CGAL_REFERENCE_HPP
#define WELLSPACED_TESTS_CGAL_REFERENCE_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace reference {

using Point = std::array<double, 3>;
using Edge = std::array<std::uint32_t, 2>;
using Triangle = std::array<std::uint32_t, 3>;
using Tetrahedron = std::array<std::uint32_t, 4>;

// Vertices are positions in the caller's list; of several equal points the first stands for all.
struct Delaunay {
  int dimension = -1;                   // -1 (no points) to 3
  std::size_t vertices = 0;             // distinct points
  std::vector<Tetrahedron> tetrahedra;  // finite ones, positively oriented; only in dimension 3
  std::vector<Triangle> hull;           // hull facets in dimension 3, the triangles in dimension 2
  std::vector<Edge> chain;              // the edges in dimension 1
};

// Throws std::invalid_argument if a coordinate is not finite.
Delaunay delaunay(const double* xyz, std::size_t count);

// Sign of det[b-a, c-a, d-a].
int orientation(const Point& a, const Point& b, const Point& c, const Point& d);

// +1 if e is inside the sphere through the positively oriented tetrahedron abcd, 0 on it, -1 outside;
// the signs change places if abcd is negatively oriented.
int side_of_oriented_sphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& e);

// +1 if e is inside the smallest sphere through a, b and c, 0 on it, -1 outside.
int side_of_smallest_sphere(const Point& a, const Point& b, const Point& c, const Point& e);

// The same for the smallest sphere through a and b.
int side_of_diametral_sphere(const Point& a, const Point& b, const Point& e);

// Whether the circumradius is larger than beta times the shortest edge: exact, with beta as the double it is.
// A flat tetrahedron counts as over every bound.
bool over_bound(const Point& a, const Point& b, const Point& c, const Point& d, double beta);

// The positions of the tetrahedra over the bound.
std::vector<std::size_t> all_over_bound(const double* xyz, const Tetrahedron* tetrahedra, std::size_t count, double beta);

// Sign of (sum of the tetrahedra's signed volumes) - (volume of the box from low to high): exact.
int compare_volume_with_box(const double* xyz, const Tetrahedron* tetrahedra, std::size_t count, const Point& low,
                            const Point& high);

// Sign of (sum of the first list's signed volumes) - (sum of the second's): exact.
int compare_volumes(const double* xyz_a, const Tetrahedron* a, std::size_t count_a, const double* xyz_b,
                    const Tetrahedron* b, std::size_t count_b);

}  // namespace reference

#endif
