//! What must not happen once the boundary has been recovered: that a free vertex takes a subsegment or subfacet out of the triangulation. It does so
//! only near small input angles, or where an element must not be split: elsewhere it would encroach upon the element, and not be inserted.

use super::boundary::{Boundary, Encroached};
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{slot_of, tet_of};
use crate::triangulation::Triangulation;

impl Triangulation {
    /// Whether an edge goes with a cavity.
    fn edge_goes(&self, cavity: &Cavity, [a, b]: [u32; 2]) -> bool {
        let found = self.topology.find_edge(a, b);
        found.is_some_and(|(tet, i, j)| self.topology.around_edge(tet, i, j).all(|(t, _, _)| cavity.contains(t)))
    }

    /// Whether a face goes with a cavity.
    fn face_goes(&self, cavity: &Cavity, face: [u32; 3]) -> bool {
        let Some(side) = self.topology.find_face(face) else { return false };
        cavity.contains(tet_of(side)) && cavity.contains(tet_of(self.topology.tet(tet_of(side)).n[slot_of(side)]))
    }
}

impl Boundary {
    /// Whether any of what is at a cavity would go with it.
    pub(crate) fn loses(&self, t: &Triangulation, cavity: &Cavity, found: &Encroached) -> bool {
        found.loses()
            || found.segments.iter().any(|&edge| t.edge_goes(cavity, edge))
            || found.facets.iter().any(|&face| t.face_goes(cavity, face))
    }
}
