//! What a split of a boundary element may cost. Near small input angles splits could go on for ever, each smaller than the one that asked for
//! it. In the analysis of J. R. Shewchuk ("Tetrahedral mesh generation by Delaunay refinement", SoCG 1998) a split that a
//! bad tetrahedron asks for makes no edge shorter than β/2 times the tetrahedron's shortest, unless input angles are small. So this is
//! demanded of such a split, and of those that follow from it at acute input vertices: one that can't keep it is left out.

use super::acute::Carrier;
use super::boundary::{Boundary, ACUTE, SHARP};
use crate::geometry::quality::EDGES;
use crate::leavings::InPieces;
use crate::parted::PartedMap;
use crate::triangulation::Triangulation;
use crate::{memory, Control, DVec3, Error};

/// What is demanded of a split.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Demand {
    /// It shall make no edge shorter than this.
    pub length: f64,
    /// It follows from another split. Then this counts at acute vertices only: elsewhere the input bounds the lengths.
    pub follows: bool,
}

impl Demand {
    /// Nothing.
    pub const NONE: Demand = Demand { length: 0.0, follows: false };

    /// For a split that shall make no edge shorter than this.
    pub fn of(length: f64) -> Demand {
        Demand { length, follows: false }
    }

    /// For splits that follow from one with this demand.
    pub fn following(self) -> Demand {
        Demand { follows: true, ..self }
    }
}

/// The cosine of 10°: corners at which segments meet at a smaller angle are needles.
const NEEDLE: f64 = 0.9848;

/// No split of what meets at a needle is finer than this part of its distance from the corner. A strip of triangles whose diagonals make needles is as
/// wide as that at an angle of 1.1°, and can be filled well if it is wider.
const AT_NEEDLE: f64 = 0.02;

/// On the shells around an acute vertex a segment is split between a third and two thirds of its length, not in the middle.
pub(crate) const OFF_MIDDLE: f64 = 0.6;

/// At an acute vertex no split comes nearer than this part of the room that it had. Two segments at 20°, cut in the middle, have their cuts at 0.17.
const ROOM: f64 = 0.15;

/// Of as many corners the sharp ones are looked for among all sharp ones.
const MANY: usize = 64;

impl Boundary {
    /// Whether an element must stay as it is, given whether it is in the triangulation.
    pub(crate) fn keeps(&self, exists: bool) -> bool {
        self.kept && exists && !self.recovering
    }

    /// The length that a demand comes to for an element with these corners. At an acute vertex it is at least a part of the distance
    /// that the nearest vertex had when the boundary had been recovered.
    pub(crate) fn demanded(&self, demand: Demand, corners: &[u32]) -> f64 {
        let acute = corners.iter().filter(|&&v| self.kind(v) & ACUTE != 0);
        let room = acute.map(|v| self.room_at.get(v).copied().unwrap_or(0.0)).reduce(f64::max);
        match room {
            Some(room) => (OFF_MIDDLE * demand.length).max(ROOM * room),
            None if demand.follows && !corners.iter().any(|&v| self.kind(v) & SHARP != 0) => 0.0,
            None => demand.length,
        }
    }

    /// Near a corner at which segments meet at a very small angle, splits of what meets there must not be finer than this. There the distances between
    /// elements are far smaller than their distance from the corner, and well-spaced points would be as many as the angle is small.
    pub(crate) fn needle_floor(&self, t: &Triangulation, carrier: Carrier, p: DVec3) -> f64 {
        let floor = |v: &u32| AT_NEEDLE * t.at(*v).distance(p);
        let corners = self.corners(&carrier);
        // A facet may have very many, which are in order.
        if corners.len() > MANY && corners.len() > self.sharpness.len() {
            let needles = self.sharpness.iter().filter(|(_, &sharpness)| sharpness > NEEDLE).map(|(v, _)| v);
            return needles.filter(|v| corners.binary_search(v).is_ok()).map(floor).fold(0.0, f64::max);
        }
        corners.iter().filter(|&&v| self.sharpness(v) > NEEDLE).map(floor).fold(0.0, f64::max)
    }

    /// Notes the distance of the nearest vertex to each acute vertex, once the boundary has been recovered.
    pub(crate) fn find_room(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        if self.shortest_at.is_empty() {
            self.room_at = PartedMap::default();
            return Ok(());
        }
        let turns = control.turns();
        let mut nearest = memory::filled(t.vertex_slots(), f64::INFINITY, "vertices", control)?;
        // The nearest vertex is one that it has an edge to, and each edge is one of a finite tetrahedron.
        let finite = |&tet: &u32| !t.topology.tet(tet).is_ghost();
        for tet in t.topology.live().filter(finite) {
            turns.check()?;
            let v = t.topology.tet(tet).v;
            for [i, j] in EDGES.map(|edge| edge.map(|slot| v[slot])) {
                if (self.kind(i) | self.kind(j)) & ACUTE != 0 {
                    let distance = t.at(i).distance_squared(t.at(j));
                    for end in [i, j] {
                        let known = &mut nearest[end as usize];
                        *known = known.min(distance);
                    }
                }
            }
        }
        let mut room_at = InPieces::new(PartedMap::default(), control);
        for &v in self.shortest_at.keys() {
            turns.check()?;
            let distance = nearest[v as usize].sqrt();
            if distance.is_finite() {
                room_at.insert(v, distance);
            }
        }
        self.room_at = room_at.keep();
        Ok(())
    }

    /// Whether a subsegment exists and its split is not known to miss the demand.
    pub(crate) fn waits_segment(&self, edge: [u32; 2], demand: Demand) -> bool {
        let blocked = |reach: f64| reach < self.demanded(demand, &edge);
        self.subsegments.contains_key(&edge) && !self.blocked.reach_of_segment(edge).is_some_and(blocked)
    }

    /// Whether a subfacet exists and its split is not known to miss the demand.
    pub(crate) fn waits_facet(&self, face: [u32; 3], demand: Demand) -> bool {
        let blocked = |reach: f64| reach < self.demanded(demand, &face);
        self.subfacets.contains_key(&face) && !self.blocked.reach_of_facet(face).is_some_and(blocked)
    }
}
