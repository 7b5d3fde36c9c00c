//! Where a subfacet is split while the boundary is being recovered. A circumcentre does not do near a small input angle: facets that meet there
//! would split each other for ever, the same picture coming again at each smaller scale. Two rules make the points of all facets around a
//! vertex, or around a segment, fit one another:
//!
//! - *Split on a sphere* (D. Cohen-Steiner, É. Colin de Verdière, M. Yvinec, "Conforming Delaunay triangulations in 3D", CGTA 28, 2004): a subfacet
//!   with an acute input vertex and two others at one distance from it is split at that distance too. The ball about the vertex stays
//!   empty, however often its sphere is cut; near a segment the pieces of the arc have a power of two as length, so that
//!   the arcs of several facets are cut alike.
//! - *Collars* (A. Rand, N. Walkington, "3D Delaunay refinement of sharp domains without a local feature size oracle", IMR 2008): a subfacet at a
//!   subsegment, whose facets meet at less than 90°, is split at the apex of a right isosceles triangle over the subsegment. The apices of all
//!   facets lie on the subsegment's diametral sphere, so that the triangles are faces as soon as its ball is empty.
//!
//! Deviation: both papers cover all acute elements by balls of a size known beforehand. Here a rule is applied where a subfacet turns out to
//! be missing, and a ball shrinks when something is found in it.

use glam::DVec3;

use super::boundary::{edge_key, face_key, Boundary, ACUTE, ON_SEGMENT};
use crate::geometry::circumsphere::triangle_circumcenter;
use crate::triangulation::Triangulation;

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

/// The height of a collar's triangles over half of their base: a little more than that of a right angle, so that rounding
/// doesn't put the apex into the base's ball.
const COLLAR_HEIGHT: f64 = 1.0 + 1.0 / 64.0;

impl Boundary {
    /// Where to split a subfacet.
    pub(crate) fn facet_split(&self, t: &Triangulation, face: [u32; 3]) -> FacetSplit {
        let m: u32 = std::env::var("WSM").ok().and_then(|v| v.parse().ok()).unwrap_or(3);
        let protected = self.recovering.then(|| (m & 1 != 0).then(|| self.shell_split(t, face)).flatten().or_else(|| (m & 2 != 0).then(|| self.collar_split(t, face)).flatten()));
        if std::env::var("WST").is_ok() { eprintln!("facet {face:?} kinds {:?} d {:?} -> {:?}", face.map(|v| self.kind(v)), [0,1,2].map(|i| t.at(face[i]).distance(t.at(face[(i+1)%3]))), protected); }
        protected.flatten().unwrap_or_else(|| {
            let [a, b, c] = face.map(|v| t.at(v));
            FacetSplit::At(triangle_circumcenter(a, b, c), face)
        })
    }

    /// The split on a sphere about an acute input vertex.
    fn shell_split(&self, t: &Triangulation, face: [u32; 3]) -> Option<FacetSplit> {
        let acute = (0..3).filter(|&i| self.kind(face[i]) & ACUTE != 0);
        // The corner with the smallest angle, where there are several.
        let angle = |i: usize| {
            let [x, a, b] = [0, 1, 2].map(|k| t.at(face[(i + k) % 3]));
            (a - x).normalize_or_zero().dot((b - x).normalize_or_zero())
        };
        let i = acute.max_by(|&i, &j| angle(i).total_cmp(&angle(j)))?;
        let x = face[i];
        let (mut near, mut far) = (face[(i + 1) % 3], face[(i + 2) % 3]);
        let center = t.at(x);
        let distance = |v: u32| t.at(v).distance(center);
        if distance(near) > distance(far) {
            std::mem::swap(&mut near, &mut far);
        }
        let radius = distance(near);
        let direction = |v: u32| (t.at(v) - center).normalize_or_zero();
        if distance(far) > radius * (1.0 + SAME_SHELL) {
            if self.is_subsegment([x, far]) {
                return Some(FacetSplit::Segment(edge_key([x, far])));
            }
            return Some(FacetSplit::At(center + direction(far) * radius, face));
        }
        if self.is_subsegment([near, far]) {
            // The facet ends within the sphere: a smaller one is wanted.
            let sides = [[x, near], [x, far], [near, far]];
            return sides.into_iter().find(|&side| self.is_subsegment(side)).map(|side| FacetSplit::Segment(edge_key(side)));
        }
        let on_segment = |v: u32| self.kind(v) & ON_SEGMENT != 0;
        let (from, to) = match (on_segment(near), on_segment(far)) {
            (true, false) => (near, far),
            (false, true) => (far, near),
            _ => return Some(FacetSplit::At(center + (direction(near) + direction(far)).normalize_or_zero() * radius, face)),
        };
        // A chord of a power of two between a third and two thirds, from the segment's end.
        let chord = t.at(from).distance(t.at(to));
        let step = (chord * 2.0 / 3.0).log2().floor().exp2();
        let half_angle = |chord: f64| (chord / (2.0 * radius)).min(1.0).asin();
        let (whole, part) = (2.0 * half_angle(chord), 2.0 * half_angle(step));
        let rotated = (direction(from) * (whole - part).sin() + direction(to) * part.sin()) / whole.sin();
        Some(FacetSplit::At(center + rotated.normalize_or_zero() * radius, face))
    }

    /// The split at the apex of a collar's triangle.
    fn collar_split(&self, t: &Triangulation, face: [u32; 3]) -> Option<FacetSplit> {
        let &facet = self.subfacets.get(&face_key(face))?;
        for i in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| face[(i + k) % 3]);
            let Some(&segment) = self.subsegments.get(&edge_key([a, b])) else { continue };
            if !self.sharp_segments.get(segment as usize).copied().unwrap_or(false) {
                continue;
            }
            let edge = edge_key([a, b]);
            let (p, q, r) = (t.at(edge[0]), t.at(edge[1]), t.at(c));
            let along = q - p;
            let inward = (r - p).reject_from(along).normalize_or_zero();
            let middle = 0.5 * p + 0.5 * q;
            let half = 0.5 * along.length();
            let apex = middle + inward * (half * COLLAR_HEIGHT);
            // It is there already, or something is nearer to the segment.
            if r.distance(middle) < half * (COLLAR_HEIGHT * COLLAR_HEIGHT) {
                return Some(FacetSplit::Segment(edge));
            }
            let found = self.facets[facet as usize].locate_from(face, apex, t.points(), |e| self.is_subsegment(e));
            return Some(match found {
                Some(triangle) => FacetSplit::At(apex, triangle),
                None => FacetSplit::Segment(edge),
            });
        }
        None
    }

    /// Finds the segments along which two facets meet at less than 90°.
    pub(super) fn find_sharp(&mut self, t: &Triangulation) {
        let mut sharp = vec![false; self.segments.len()];
        let mut inward: Vec<DVec3> = Vec::new();
        for (&[a, b], &segment) in &self.subsegments {
            inward.clear();
            let along = (t.at(b) - t.at(a)).normalize_or_zero();
            for &facet in &self.segments[segment as usize].facets {
                for triangle in self.facets[facet as usize].at_edge([a, b]) {
                    inward.push((t.at(triangle[2]) - t.at(a)).reject_from_normalized(along).normalize_or_zero());
                }
            }
            // Five directions in a plane have two at less than 90°.
            let close = |(i, u): (usize, &DVec3)| inward[..i].iter().any(|v| u.dot(*v) > 1e-9);
            sharp[segment as usize] |= inward.len() > 4 || inward.iter().enumerate().any(close);
        }
        self.sharp_segments = sharp;
    }
}
