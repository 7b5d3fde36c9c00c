//! Where a subfacet is split while the boundary is being recovered. A circumcentre does not do near a small input angle: facets that meet there
//! would split each other for ever, the same picture coming again at each smaller scale. One rule makes the points of all facets around a
//! vertex fit one another:
//!
//! *Split on a sphere* (D. Cohen-Steiner, É. Colin de Verdière, M. Yvinec, "Conforming Delaunay triangulations in 3D", CGTA 28, 2004): a subfacet
//!   with an acute input vertex and two others at one distance from it is split at that distance too. The ball about the vertex stays
//!   empty, however often its sphere is cut; near a segment the pieces of the arc have a power of two as length, so that
//!   the arcs of several facets are cut alike.
//! Deviation: the paper covers all segments by balls of a size known beforehand. Here spheres are used about acute input vertices alone, and
//! only where splits at circumcentres have come nearer to the vertex than a part of its shortest segment; a sphere shrinks
//! when something is found in it.

use glam::DVec3;

use super::boundary::{edge_key, Boundary, ACUTE, ON_SEGMENT};
use super::planar::PLANARITY;
use crate::geometry::circumsphere::triangle_circumcenter;
use crate::leavings::InPieces;
use crate::parted::PartedMap;
use crate::triangulation::incident::StarWalk;
use crate::triangulation::topology::GHOST;
use crate::triangulation::Triangulation;
use crate::{Control, Error};

/// How to split a subfacet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FacetSplit {
    /// At this point, whose circle in the facet the triangle is in conflict with.
    At(DVec3, [u32; 3]),
    /// This subsegment has to be split instead.
    Segment([u32; 2]),
}

/// Distances from an acute vertex count as equal within this: they differ by rounding, or by a factor of two.
const SAME_SHELL: f64 = 1e-6;

/// Splits at circumcentres may come as near to an acute vertex as this part of its shortest segment.
const DEEP: f64 = 0.26;

impl Boundary {
    /// Where to split a subfacet.
    pub(crate) fn facet_split(&self, t: &Triangulation, face: [u32; 3]) -> FacetSplit {
        let protected = if self.recovering { self.shell_split(t, face) } else { None };
        protected.unwrap_or_else(|| {
            let [a, b, c] = self.in_plane(t, face);
            FacetSplit::At(triangle_circumcenter(a, b, c), face)
        })
    }

    /// A subfacet's corners; where its facet is uneven put into the facet's plane at the first of them: there the planes of slender triangles stand at any
    /// angle.
    pub(crate) fn in_plane(&self, t: &Triangulation, face: [u32; 3]) -> [DVec3; 3] {
        let corners = face.map(|v| t.at(v));
        let Some(facet) = self.facet_of(face) else { return corners };
        let normal = self.facets[facet].normal();
        let heights = corners.map(|p| (p - corners[0]).dot(normal));
        let size = corners[1].distance(corners[0]).max(corners[2].distance(corners[0]));
        if heights.iter().all(|height| height.abs() <= PLANARITY * size) {
            return corners;
        }
        [0, 1, 2].map(|i| corners[i] - normal * heights[i])
    }

    /// The split on a sphere about an acute input vertex, once the splits around it have come near to it.
    fn shell_split(&self, t: &Triangulation, face: [u32; 3]) -> Option<FacetSplit> {
        let distance = |v: u32, x: u32| t.at(v).distance(t.at(x));
        let others = |i: usize| [face[(i + 1) % 3], face[(i + 2) % 3]];
        let deep = |&i: &usize| {
            let shortest = self.shortest_at.get(&face[i]).copied().unwrap_or(0.0);
            let [v, w] = others(i);
            distance(v, face[i]).min(distance(w, face[i])) < DEEP * shortest
        };
        // The corner with the smallest angle, where there are several.
        let angle = |i: usize| {
            let [x, a, b] = [0, 1, 2].map(|k| t.at(face[(i + k) % 3]));
            (a - x).normalize_or_zero().dot((b - x).normalize_or_zero())
        };
        let i = (0..3).filter(deep).max_by(|&i, &j| angle(i).total_cmp(&angle(j)))?;
        let (x, center) = (face[i], t.at(face[i]));
        let direction = |v: u32| (t.at(v) - center).normalize_or_zero();
        // All facets at the vertex are cut on the largest sphere about it that has nothing inside.
        let nearest = t.nearest_neighbour(x).map_or(0.0, |v| distance(v, x));
        let radius = (nearest * (1.0 + SAME_SHELL)).log2().floor().exp2();
        let limit = radius * (1.0 + SAME_SHELL);
        if let Some(beyond) = others(i).into_iter().filter(|&v| distance(v, x) > limit).max_by(|&v, &w| {
            let first = |v: u32| (self.is_subsegment([x, v]), distance(v, x));
            first(v).partial_cmp(&first(w)).unwrap_or(std::cmp::Ordering::Equal)
        }) {
            return Some(if self.is_subsegment([x, beyond]) {
                FacetSplit::Segment(edge_key([x, beyond]))
            } else {
                FacetSplit::At(center + direction(beyond) * radius, face)
            });
        }
        let [near, far] = others(i);
        if self.is_subsegment([near, far]) {
            // The facet ends within the sphere: a smaller one is wanted.
            let sides = [[x, near], [x, far], [near, far]];
            return sides
                .into_iter()
                .find(|&side| self.is_subsegment(side))
                .map(|side| FacetSplit::Segment(edge_key(side)));
        }
        let on_segment = |v: u32| self.kind(v) & ON_SEGMENT != 0;
        let (from, to) = match (on_segment(near), on_segment(far)) {
            (true, false) => (near, far),
            (false, true) => (far, near),
            _ => {
                return Some(FacetSplit::At(
                    center + (direction(near) + direction(far)).normalize_or_zero() * radius,
                    face,
                ))
            }
        };
        // A chord of a power of two between a third and two thirds, from the segment's end.
        let chord = t.at(from).distance(t.at(to));
        let step = (chord * 2.0 / 3.0).log2().floor().exp2();
        let half_angle = |chord: f64| (chord / (2.0 * radius)).min(1.0).asin();
        let (whole, part) = (2.0 * half_angle(chord), 2.0 * half_angle(step));
        let rotated = (direction(from) * (whole - part).sin() + direction(to) * part.sin()) / whole.sin();
        Some(FacetSplit::At(center + rotated.normalize_or_zero() * radius, face))
    }

    /// Notes how long the shortest segment at each acute vertex is.
    pub(super) fn find_shortest(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        let mut shortest = InPieces::new(PartedMap::default(), control);
        for [a, b] in self.subsegments.keys().copied() {
            turns.check()?;
            let length = t.at(a).distance(t.at(b));
            for v in [a, b].into_iter().filter(|&v| self.kind(v) & ACUTE != 0) {
                let known: &mut f64 = shortest.entry(v).or_insert(length);
                *known = known.min(length);
            }
        }
        self.shortest_at = shortest.keep();
        Ok(())
    }
}

impl Triangulation {
    /// The vertex nearest to a vertex: one that it has an edge to.
    pub(crate) fn nearest_neighbour(&self, vertex: u32) -> Option<u32> {
        let mut walk = StarWalk::new(&self.topology, vertex);
        let mut nearest = (f64::INFINITY, GHOST);
        while let Some(tet) = walk.next(&self.topology) {
            for v in self.topology.tet(tet).v.into_iter().filter(|&v| v != GHOST && v != vertex) {
                let near = (self.at(v).distance_squared(self.at(vertex)), v);
                if near < nearest {
                    nearest = near;
                }
            }
        }
        Some(nearest.1).filter(|&v| v != GHOST)
    }
}
