//! What must not happen once the boundary has been recovered: that a vertex takes a subsegment or subfacet out of the triangulation that it may not
//! split, because they meet at a small input angle. Then the element is missing again, its recovery may take out others, and so on.
//! A new vertex can always be left out instead; the tetrahedra that asked for it stay bad and are counted.

use rustc_hash::FxHashSet;

use super::acute::Carrier;
use super::boundary::{edge_key, face_key, Boundary, Encroached, ACUTE, SHARP};
use super::facet::FacetChange;
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::DVec3;

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

    /// Whether inserting a vertex at `p`, on the element `carrier`, would take out elements that it must not, or leave some of its own
    /// missing at a small angle. `found` is what is at the cavity, `split` the subsegment to be split and `changes` what becomes of its facets.
    pub(crate) fn endangers(
        &self,
        t: &Triangulation,
        (carrier, p): (Carrier, DVec3),
        cavity: &Cavity,
        found: &Encroached,
        split: Option<[u32; 2]>,
        changes: &[(u32, FacetChange)],
    ) -> bool {
        let planned =
            |face: [u32; 3]| changes.iter().any(|(_, change)| change.removed.iter().any(|&r| face_key(r) == face));
        let spared_edge = |&edge: &[u32; 2]| {
            let Some(&segment) = self.subsegments.get(&edge) else { return false };
            let middle = 0.5 * t.at(edge[0]) + 0.5 * t.at(edge[1]);
            self.meet_acutely(t, (carrier, p), (Carrier::Segment(segment), middle)) && t.edge_goes(cavity, edge)
        };
        let spared_face = |&face: &[u32; 3]| {
            let Some(&facet) = self.subfacets.get(&face) else { return false };
            let middle = (t.at(face[0]) + t.at(face[1]) + t.at(face[2])) / 3.0;
            self.meet_acutely(t, (carrier, p), (Carrier::Facet(facet), middle)) && t.face_goes(cavity, face)
        };
        if found.lost_segments.iter().any(|&edge| Some(edge) != split)
            || found.lost_facets.iter().any(|&face| !planned(face))
            || found.segments.iter().any(|edge| Some(*edge) != split && spared_edge(edge))
            || found.facets.iter().any(|face| !planned(*face) && spared_face(face))
        {
            return true;
        }
        // A new subfacet is a face if the side that it does not owe to the vertex is an edge of the cavity's surface.
        let acute = |v: &u32| self.kind(*v) & (ACUTE | SHARP) != 0;
        let created = || changes.iter().flat_map(|(_, change)| &change.created).filter(|face| face.iter().any(acute));
        if created().next().is_none() {
            return false;
        }
        let mut surface: FxHashSet<[u32; 2]> = FxHashSet::default();
        for &face in &cavity.faces {
            let [a, b, c] = cavity.face(&t.topology, face);
            surface.extend([[a, b], [b, c], [c, a]].into_iter().filter(|e| !e.contains(&GHOST)).map(edge_key));
        }
        created().any(|&[a, b, _]| !surface.contains(&edge_key([a, b])))
    }
}
