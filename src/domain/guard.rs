//! What must not happen once the boundary has been recovered: that a vertex takes a subsegment or subfacet out of the triangulation that it may not
//! split, because they meet at a small input angle. Then the element is missing again, its recovery may take out others, and so on.
//! A new vertex can always be left out instead; the tetrahedra that asked for it stay bad and are counted.

use rustc_hash::FxHashSet;

use super::acute::Carrier;
use super::boundary::{edge_key, face_key, Boundary, Encroached, ACUTE};
use super::facet::FacetChange;
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::DVec3;

impl Boundary {
    /// Whether inserting a vertex at `p`, on the element `carrier`, would take out elements that it must not, or leave some of its own
    /// missing at an acute vertex. `found` is what is at the cavity, `split` the subsegment to be split and `changes` what becomes of its facets.
    pub(crate) fn endangers(
        &self,
        t: &Triangulation,
        (carrier, p): (Carrier, DVec3),
        cavity: &Cavity,
        found: &Encroached,
        split: Option<[u32; 2]>,
        changes: &[(u32, FacetChange)],
    ) -> bool {
        let edge_goes = |[a, b]: [u32; 2]| match t.topology.find_edge(a, b) {
            Some((tet, i, j)) => t.topology.around_edge(tet, i, j).all(|(around, _, _)| cavity.contains(around)),
            None => false,
        };
        let face_goes = |face: [u32; 3]| match t.topology.find_face(face) {
            Some(side) => {
                cavity.contains(tet_of(side)) && cavity.contains(tet_of(t.topology.tet(tet_of(side)).n[slot_of(side)]))
            }
            None => false,
        };
        let planned = |face: [u32; 3]| {
            changes.iter().any(|(_, change)| change.removed.iter().any(|&r| face_key(r) == face))
        };
        let spared_edge = |&edge: &[u32; 2]| {
            let Some(&segment) = self.subsegments.get(&edge) else { return false };
            let middle = 0.5 * t.at(edge[0]) + 0.5 * t.at(edge[1]);
            self.meet_acutely(t, (carrier, p), (Carrier::Segment(segment), middle)) && edge_goes(edge)
        };
        let spared_face = |&face: &[u32; 3]| {
            let Some(&facet) = self.subfacets.get(&face) else { return false };
            let middle = (t.at(face[0]) + t.at(face[1]) + t.at(face[2])) / 3.0;
            self.meet_acutely(t, (carrier, p), (Carrier::Facet(facet), middle)) && face_goes(face)
        };
        if found.lost_segments.iter().any(|&edge| Some(edge) != split)
            || found.lost_facets.iter().any(|&face| !planned(face))
            || found.segments.iter().any(|edge| Some(*edge) != split && spared_edge(edge))
            || found.facets.iter().any(|face| !planned(*face) && spared_face(face))
        {
            return true;
        }
        // A new subfacet is a face if the side that it does not owe to the vertex is an edge of the cavity's surface.
        let acute = |v: &u32| self.kind(*v) & ACUTE != 0;
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
