//! What a split of a boundary element may cost. Near small input angles splits could go on for ever, each smaller than the one that asked for
//! it. In the analysis of J. R. Shewchuk ("Tetrahedral mesh generation by Delaunay refinement", SoCG 1998) a split that a
//! bad tetrahedron asks for makes no edge shorter than β/2 times the tetrahedron's shortest, unless input angles are small. So this is
//! demanded of such a split, and of those that follow from it at acute input vertices: one that can't keep it is left out.

use super::boundary::{Boundary, ACUTE, SHARP};
use crate::triangulation::Triangulation;

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

impl Boundary {
    /// Whether an element must stay as it is, given whether it is in the triangulation.
    pub(crate) fn keeps(&self, exists: bool) -> bool {
        self.kept && exists && !self.recovering
    }

    /// The length that a demand comes to for an element with these corners. At an acute vertex it is at least half the distance
    /// that the nearest vertex had when the boundary had been recovered.
    pub(crate) fn demanded(&self, demand: Demand, corners: &[u32]) -> f64 {
        let acute = corners.iter().filter(|&&v| self.kind(v) & ACUTE != 0);
        let room = acute.map(|v| self.room_at.get(v).copied().unwrap_or(0.0)).reduce(f64::max);
        match room {
            Some(room) => demand.length.max(0.5 * room),
            None if demand.follows && !corners.iter().any(|&v| self.kind(v) & SHARP != 0) => 0.0,
            None => demand.length,
        }
    }

    /// Notes the distance of the nearest vertex to each acute vertex, once the boundary has been recovered.
    pub(crate) fn find_room(&mut self, t: &Triangulation) {
        let room = |&v: &u32| t.nearest_neighbour(v).map(|w| (v, t.at(v).distance(t.at(w))));
        self.room_at = self.shortest_at.keys().filter_map(room).collect();
    }

    /// Whether a subsegment exists and its split is not known to miss the demand.
    pub(crate) fn waits_segment(&self, edge: [u32; 2], demand: Demand) -> bool {
        let blocked = |&reach: &f64| reach < self.demanded(demand, &edge);
        self.subsegments.contains_key(&edge) && !self.blocked_segments.get(&edge).is_some_and(blocked)
    }

    /// Whether a subfacet exists and its split is not known to miss the demand.
    pub(crate) fn waits_facet(&self, face: [u32; 3], demand: Demand) -> bool {
        let blocked = |&reach: &f64| reach < self.demanded(demand, &face);
        self.subfacets.contains_key(&face) && !self.blocked_facets.get(&face).is_some_and(blocked)
    }
}
