//! Small input angles. Where two boundary elements meet at less than 60° their splits, and the Steiner points between them, can
//! call each other for ever: the nearer to the corner, the nearer the two elements are to each other. The distance
//! between vertices on two such elements is given by the input, so nothing is done about it:
//! - a boundary vertex does not encroach upon an element that it meets acutely;
//! - a tetrahedron whose shortest edge joins two such vertices has nothing split for it, and is counted when it stays bad
//!   (the *seditious* edges of G. Miller, S. Pav, N. Walkington, "When and why Delaunay refinement algorithms work", IJCGA 15, 2005).
//!
//! Together with the concentric shells of [`split`](super::split) around acute vertices, and with the floors of [`pending`](super::pending), this lets
//! refinement end.

use super::boundary::{edge_key, face_key, Boundary, SHARP};
use crate::triangulation::Triangulation;
use crate::{memory, Control, DVec3, Error};

/// The input element of lowest dimension that a boundary vertex lies on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Carrier {
    /// None: it is a free vertex.
    #[default]
    Free,
    /// The vertex is an end of a segment or a corner of a facet.
    Vertex(u32),
    /// Inside this segment.
    Segment(u32),
    /// Inside this facet.
    Facet(u32),
}

/// Whether the angle between two directions is below 60°. This decides what is worth doing, not what is right; rounding may.
pub(crate) fn is_acute(u: DVec3, v: DVec3) -> bool {
    let dot = u.dot(v);
    dot > 0.0 && dot * dot > 0.25 * (1.0 + 1e-9) * u.length_squared() * v.length_squared()
}

/// Where to split a subsegment `pq`: in the middle; with one acute end at the power of two from that end nearest to it, so that
/// all segments there are cut on common shells.
pub(crate) fn split_point([p, q]: [DVec3; 2], acute: [bool; 2]) -> DVec3 {
    let (center, other) = match acute {
        [true, false] => (p, q),
        [false, true] => (q, p),
        _ => return 0.5 * p + 0.5 * q,
    };
    let length = center.distance(other);
    // Between a third and two thirds of the length.
    let radius = (length * 2.0 / 3.0).log2().floor().exp2();
    center + (other - center) * (radius / length)
}

/// Lists of corners up to this length need not be in order.
const FEW: usize = 64;

/// The first two of `corners` that `others` has too. Longer lists are those of facets, and in order.
fn first_shared(corners: &[u32], others: &[u32]) -> [Option<u32>; 2] {
    if corners.len() > FEW && corners.len() > others.len() {
        let mut shared: Vec<u32> = others.iter().copied().filter(|v| corners.binary_search(v).is_ok()).collect();
        shared.sort_unstable();
        return [0, 1].map(|i| shared.get(i).copied());
    }
    let has = |v: &u32| if others.len() > FEW { others.binary_search(v).is_ok() } else { others.contains(v) };
    let mut shared = corners.iter().copied().filter(has);
    [shared.next(), shared.next()]
}

impl Boundary {
    /// The input vertices of a carrier.
    pub(super) fn corners<'a>(&'a self, carrier: &'a Carrier) -> &'a [u32] {
        match carrier {
            Carrier::Free => &[],
            Carrier::Vertex(v) => std::slice::from_ref(v),
            Carrier::Segment(s) => &self.segments[*s as usize].ends,
            Carrier::Facet(f) => &self.facets[*f as usize].corners,
        }
    }

    /// Whether points `p` and `q` on two boundary elements see each other across an acute input angle: the elements differ, neither lies in
    /// the other, and they meet at a vertex or along a line at less than 60°.
    pub(super) fn meet_acutely(&self, t: &Triangulation, (a, p): (Carrier, DVec3), (b, q): (Carrier, DVec3)) -> bool {
        if a == b {
            return false;
        }
        if let (Carrier::Segment(s), Carrier::Facet(f)) | (Carrier::Facet(f), Carrier::Segment(s)) = (a, b) {
            if self.segments[s as usize].facets.contains(&f) {
                return false;
            }
        }
        let (corners, others) = (self.corners(&a), self.corners(&b));
        // An element's own corner is no element that it meets.
        if corners.len() < 2 || others.len() < 2 {
            return false;
        }
        match first_shared(corners, others).map(|v| v.map(|v| t.at(v))) {
            [Some(x), None] => is_acute(p - x, q - x),
            [Some(x), Some(y)] => {
                let along = (y - x).normalize_or_zero();
                is_acute((p - x).reject_from_normalized(along), (q - x).reject_from_normalized(along))
            }
            _ => false,
        }
    }

    /// Finds the segments along which two facets meet at less than 60°.
    pub(super) fn find_sharp(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        let mut sharp = vec![false; self.segments.len()];
        let mut inward: Vec<DVec3> = Vec::new();
        let mut ends_of = memory::room_in_pieces(self.subsegments.len(), "segments", control)?;
        for (&[a, b], &segment) in self.subsegments.iter() {
            turns.check()?;
            ends_of.push(([a, b], segment));
            inward.clear();
            let along = (t.at(b) - t.at(a)).normalize_or_zero();
            for &facet in &self.segments[segment as usize].facets {
                for triangle in self.facets[facet as usize].at_edge([a, b]) {
                    inward.push((t.at(triangle[2]) - t.at(a)).reject_from_normalized(along));
                }
            }
            // Seven directions in a plane have two at less than 60°.
            let close = |(i, u): (usize, &DVec3)| inward[..i].iter().any(|v| is_acute(*u, *v));
            sharp[segment as usize] |= inward.len() > 6 || inward.iter().enumerate().any(close);
        }
        for &([a, b], segment) in &*ends_of {
            turns.check()?;
            if sharp[segment as usize] {
                self.mark(a, SHARP);
                self.mark(b, SHARP);
            }
        }
        self.sharp_segments = sharp;
        Ok(())
    }

    /// The input element of a subsegment or subfacet.
    pub(crate) fn carrier_of(&self, corners: &[u32]) -> Carrier {
        match *corners {
            [a, b] => self.subsegments.get(&edge_key([a, b])).map(|&s| Carrier::Segment(s)),
            [a, b, c] => self.subfacets.get(&face_key([a, b, c])).map(|&f| Carrier::Facet(f)),
            _ => None,
        }
        .unwrap_or_default()
    }

    /// Whether an edge's length is given by an acute input angle.
    pub(crate) fn is_seditious(&self, t: &Triangulation, [v, w]: [u32; 2]) -> bool {
        self.kind(v) != 0
            && self.kind(w) != 0
            && self.meet_acutely(t, (self.carrier(v), t.at(v)), (self.carrier(w), t.at(w)))
    }

    /// Whether a vertex can encroach upon subsegments of a segment, or subfacets of a facet, near `middle`.
    pub(super) fn may_encroach(&self, t: &Triangulation, v: u32, element: Carrier, middle: DVec3) -> bool {
        self.kind(v) == 0 || !self.meet_acutely(t, (self.carrier(v), t.at(v)), (element, middle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_of_corners_share_what_short_ones_would() {
        let long: Vec<u32> = (0..200).map(|v| 3 * v).collect();
        let other: Vec<u32> = (0..300).map(|v| 10 * v).collect();
        for [a, b] in [[&long[..], &[598, 597, 7, 30, 3][..]], [&long, &[4, 6]], [&long, &other], [&long, &[]]] {
            for [a, b] in [[a, b], [b, a]] {
                let mut shared = a.iter().copied().filter(|v| b.contains(v));
                assert_eq!(first_shared(a, b), [shared.next(), shared.next()]);
            }
        }
    }
}
