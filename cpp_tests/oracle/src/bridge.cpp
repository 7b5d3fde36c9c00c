#include "bridge.hpp"

#include <cstddef>
#include <stdexcept>
#include <vector>

#include "reference.hpp"
#include "wellspaced-oracle/src/lib.rs.h"

namespace oracle {
namespace {

using Doubles = rust::Slice<const double>;
using Ids = rust::Slice<const std::uint32_t>;

reference::Point point(Doubles xyz, std::size_t i) {
  if (3 * i + 2 >= xyz.size()) throw std::invalid_argument("too few coordinates");
  return {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
}

template <class List>
rust::Vec<std::uint32_t> flat(const List& list) {
  rust::Vec<std::uint32_t> ids;
  for (const auto& simplex : list)
    for (auto id : simplex) ids.push_back(id);
  return ids;
}

std::vector<reference::Tetrahedron> tetrahedra(Doubles xyz, Ids ids) {
  if (ids.size() % 4 != 0) throw std::invalid_argument("tetrahedra have four vertices");
  std::vector<reference::Tetrahedron> list(ids.size() / 4);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] >= xyz.size() / 3) throw std::out_of_range("a tetrahedron names a vertex that does not exist");
    list[i / 4][i % 4] = ids[i];
  }
  return list;
}

}  // namespace

Answer delaunay(Doubles xyz) {
  const auto dt = reference::delaunay(xyz.data(), xyz.size() / 3);
  return {dt.dimension, dt.vertices, flat(dt.tetrahedra), flat(dt.hull), flat(dt.chain)};
}

std::int32_t orientation(Doubles p) { return reference::orientation(point(p, 0), point(p, 1), point(p, 2), point(p, 3)); }

std::int32_t side_of_oriented_sphere(Doubles p) {
  return reference::side_of_oriented_sphere(point(p, 0), point(p, 1), point(p, 2), point(p, 3), point(p, 4));
}

std::int32_t side_of_smallest_sphere(Doubles p) {
  return reference::side_of_smallest_sphere(point(p, 0), point(p, 1), point(p, 2), point(p, 3));
}

std::int32_t side_of_diametral_sphere(Doubles p) {
  return reference::side_of_diametral_sphere(point(p, 0), point(p, 1), point(p, 2));
}

bool over_bound(Doubles p, double beta) {
  return reference::over_bound(point(p, 0), point(p, 1), point(p, 2), point(p, 3), beta);
}

std::int32_t compare_volumes(Doubles xyz_a, Ids a, Doubles xyz_b, Ids b) {
  const auto left = tetrahedra(xyz_a, a), right = tetrahedra(xyz_b, b);
  return reference::compare_volumes(xyz_a.data(), left.data(), left.size(), xyz_b.data(), right.data(), right.size());
}

}  // namespace oracle
