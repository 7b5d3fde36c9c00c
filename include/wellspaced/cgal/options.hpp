// SPDX-License-Identifier: MIT OR Apache-2.0
/// @file
/// wellspaced/cgal/options.hpp: what goes into wellspaced::cgal::refine and what comes out. Included by wellspaced/cgal.hpp.

#ifndef WELLSPACED_CGAL_OPTIONS_HPP
#define WELLSPACED_CGAL_OPTIONS_HPP

#include "../../wellspaced.h"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace wellspaced {
namespace cgal {

/// What wellspaced::cgal::refine shall reach, and when it shall stop.
struct options {
    double radius_edge = 2;           ///< bound on circumradius / shortest edge, 0.62 to 1e6
    wsp_rule rule = WSP_RULE_SPARSE;  ///< how Steiner points are chosen
    /// No shorter edges. 0: 2^-40 of the bounding box's diagonal, but no less than 2^-46 of the largest coordinate.
    double min_edge = 0;
    std::size_t max_vertices = (std::numeric_limits<std::size_t>::max)();  ///< no vertex beyond this many

    options() = default;
    /// The defaults but for the bound, and the rule.
    explicit options(double bound, wsp_rule by = WSP_RULE_SPARSE) : radius_edge(bound), rule(by) {}
};

/// What a new vertex is: WSP_ORIGIN_SAMPLE, WSP_ORIGIN_SEGMENT or WSP_ORIGIN_SUBFACET.
using origin = std::uint32_t;

/// What wellspaced::cgal::refine has done.
struct report {
    wsp_status status = WSP_DONE;  ///< WSP_DONE, WSP_VERTEX_LIMIT, or WSP_UNREFINED: some cells stay bad
    std::size_t samples = 0;         ///< new vertices by the sampling rule
    std::size_t segment_splits = 0;  ///< new vertices that split segments
    std::size_t facet_splits = 0;    ///< new vertices that split facets
    std::size_t refused = 0;         ///< cells that were given up; a later insertion may have mended them by the way

    /// All new vertices.
    std::size_t inserted() const { return samples + segment_splits + facet_splits; }
};

/// The whole triangulation within its convex hull.
struct everywhere {
    /// True for every cell.
    template <class Cell_handle>
    bool operator()(const Cell_handle&) const noexcept {
        return true;
    }
};

/// For callers who want no word of new vertices.
struct ignore {
    /// Does nothing.
    template <class Vertex_handle>
    void operator()(const Vertex_handle&, origin) const noexcept {}
};

}  // namespace cgal
}  // namespace wellspaced

#endif  // WELLSPACED_CGAL_OPTIONS_HPP
