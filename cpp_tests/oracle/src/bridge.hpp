// The face of reference.hpp that cxx can carry to Rust. Exceptions become Err.
#pragma once

#include <cstdint>

#include "rust/cxx.h"

namespace oracle {

struct Answer;

Answer delaunay(rust::Slice<const double> xyz);
std::int32_t orientation(rust::Slice<const double> xyz);
std::int32_t side_of_oriented_sphere(rust::Slice<const double> xyz);
std::int32_t side_of_smallest_sphere(rust::Slice<const double> xyz);
std::int32_t side_of_diametral_sphere(rust::Slice<const double> xyz);
bool over_bound(rust::Slice<const double> xyz, double beta);
std::int32_t compare_volumes(rust::Slice<const double> xyz_a, rust::Slice<const std::uint32_t> a,
                             rust::Slice<const double> xyz_b, rust::Slice<const std::uint32_t> b);

}  // namespace oracle
