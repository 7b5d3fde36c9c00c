// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced.hpp: the C++17 face of wellspaced.h, header-only.
///
/// Handles are move-only objects that free themselves, errors are exceptions (wsp::error), lists are vectors. What a
/// function does, costs and refuses is told in wellspaced.h at the C function of the same name.
///
///     wsp::plc domain;
///     domain.add_box({0, 0, 0}, {1, 1, 1});
///     domain.add_points(points);                  // std::vector<std::array<double, 3>>, or (const double*, count)
///     wsp::triangulation mesh(domain);
///     wsp::report report = mesh.refine(2.0);
///
/// Conventions
/// - Statuses below 0 are thrown as wsp::error. Functions that may end early, but with a usable result, return the
///   status, or a report that has it: 0 or one of WSP_CANCELLED, WSP_VERTEX_LIMIT, WSP_UNREFINED, WSP_TIME_LIMIT and
///   WSP_MEMORY_LIMIT. Where a cancellation leaves nothing to return (an object to be made, a list), WSP_CANCELLED is thrown, too.
/// - Spans (wsp::span, wsp::points) only refer to memory of the caller. They are made from a pointer and a count or from
///   any contiguous container: std::vector, std::array, std::span, a mapped array of Eigen...
/// - A callback that throws cancels its call, and what it threw comes out of that call unchanged. No exception ever
///   crosses the C frames between.
/// - A moved-from handle is empty: it can be destroyed and assigned to. Members of an empty wsp::plc, wsp::triangulation or
///   wsp::control throw WSP_ERR_NULL; those of an empty wsp::batch or wsp::mesh_batch give 0, NULL or a list of nothing (its edge
///   is of two WSP_NONE). As an argument an empty control is as good as none, any other empty handle is WSP_ERR_NULL.
/// - Threads: as in wellspaced.h. A const member function is a call that takes the handle as const.

#ifndef WELLSPACED_WELLSPACED_HPP
#define WELLSPACED_WELLSPACED_HPP

#include "../wellspaced.h"

#include "cpp/basics.hpp"
#include "cpp/control.hpp"
#include "cpp/plc.hpp"
#include "cpp/sampler.hpp"
#include "cpp/triangulation.hpp"

/// The C++ face of wellspaced.h.
namespace wsp {}

#endif  // WELLSPACED_WELLSPACED_HPP
