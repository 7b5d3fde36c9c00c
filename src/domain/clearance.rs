//! Rule 3 as the sparse rule has it: boundary elements are split only where it can't be helped.
//!
//! Ruppert's and Shewchuk's rules split an element as soon as any vertex lies in its smallest ball. Their proofs that refinement ends use less: a vertex
//! that a sample `p` calls for on a facet may be as near as `r/√2` to what is there, `r` being the distance from `p` to the nearest vertex, its *clearance*,
//! and the one that this calls for on a segment as near as `r/2`; with `r ≥ β·l`, `l` the edge being mended, no edge shorter than `l` comes for β ≥ 2. So with
//! [`Rule::Sparse`](crate::refine::Rule::Sparse) an element gives way to a sample when
//! - the sample encroaches upon it and is nearer to it than `r/2`, or
//! - the sample lies beyond it, or would take it out of the triangulation.
//!
//! Otherwise the sample is inserted. It is at least `r/2` away from the whole element, so from every vertex that will ever split it, be it called for by a sample or
//! by a split: the same bound that the chain of splits has. Elements that are edges and faces are not split for what is in their balls already, input vertices
//! or vertices on other elements either.
//!
//! The boundary conforms, and all tetrahedra keep the bound; balls of elements need not be empty. Where that leaves a tetrahedron unmended which the
//! classical rules might mend, the refinement goes on with those.

use super::boundary::{edge_key, face_key, Boundary, Encroached, ON_FACET, ON_SEGMENT};
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::quality::EDGES;
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::DVec3;

/// How near a sample may come to an element that it encroaches upon, as a share of its clearance, squared: (½)².
const SHARE2: f64 = 0.25;

impl Boundary {
    /// The elements at the tetrahedra `tets` that have to give way to a sample `p` whose clearance that is. `goes` says which tetrahedra the
    /// sample would remove. `found` is filled, in a fixed order.
    pub(crate) fn in_the_way(
        &self,
        t: &Triangulation,
        (p, clearance): (DVec3, f64),
        tets: impl Iterator<Item = u32>,
        goes: impl Fn(u32) -> bool,
        found: &mut Encroached,
    ) {
        found.clear();
        let near2 = SHARE2 * clearance * clearance;
        for id in tets {
            let tet = t.topology.tet(id);
            let kinds = tet.v.map(|v| if v == GHOST { 0 } else { self.kind(v) });
            if kinds == [0; 4] {
                continue;
            }
            let count = |bit: u8| kinds.iter().filter(|&&kind| kind & bit != 0).count();
            if count(ON_SEGMENT) >= 2 {
                for [i, j] in EDGES {
                    let edge = edge_key([tet.v[i], tet.v[j]]);
                    if kinds[i] & kinds[j] & ON_SEGMENT == 0
                        || !self.is_subsegment(edge)
                        || found.segments.contains(&edge)
                    {
                        continue;
                    }
                    let [a, b] = edge.map(|v| t.at(v));
                    let near = || {
                        let distance2 = (p - a).cross(b - a).length_squared() / (b - a).length_squared();
                        distance2 < near2 && encroaches_segment([a, b], p)
                    };
                    if near() || t.topology.around_edge(id, i, j).all(|(around, _, _)| goes(around)) {
                        found.segments.push(edge);
                    }
                }
            }
            if count(ON_FACET) >= 3 {
                for slot in 0..4 {
                    let face = tet.face(slot);
                    if !self.is_subfacet(face) || found.facets.contains(&face_key(face)) {
                        continue;
                    }
                    let key = face_key(face);
                    let corners = key.map(|v| t.at(v));
                    let near = || {
                        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                        let height = normal.dot(p - corners[0]);
                        height * height < near2 * normal.length_squared() && encroaches_facet(corners, p)
                    };
                    if goes(id) && goes(tet_of(tet.n[slot])) || near() {
                        found.facets.push(key);
                    }
                }
            }
        }
    }

    /// Adds to `found` the elements that a vertex at `p` on the boundary, whose cavity that is, takes out of the triangulation. Those with empty balls
    /// are among what it encroaches upon already.
    pub(crate) fn add_removed(&self, t: &Triangulation, p: DVec3, cavity: &Cavity, found: &mut Encroached) {
        if !self.tolerant {
            return;
        }
        let mut gone = Encroached::default();
        self.in_the_way(t, (p, 0.0), cavity.tets.iter().copied(), |t| cavity.contains(t), &mut gone);
        gone.segments.retain(|s| !found.segments.contains(s));
        gone.facets.retain(|f| !found.facets.contains(f));
        found.segments.append(&mut gone.segments);
        found.facets.append(&mut gone.facets);
    }

    /// Begins a refinement in which only elements that are missing, or [in the way](Self::in_the_way), are split.
    pub(crate) fn be_tolerant(&mut self, t: &Triangulation) {
        self.tolerant = true;
        self.pending_segments.clear();
        self.pending_facets.clear();
        self.enqueue_all(t);
    }

    /// Goes back to the classical rules, and queues what they ask for.
    pub(crate) fn be_strict(&mut self, t: &Triangulation) {
        self.tolerant = false;
        self.pending_segments.clear();
        self.pending_facets.clear();
        self.enqueue_all(t);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Control, Mesh, Plc};

    fn in_the_way(p: DVec3, clearance: f64) -> Encroached {
        let mut mesh = Mesh::from_plc(&Plc::boxed(DVec3::ZERO, DVec3::splat(4.0), []), &Control::new()).unwrap();
        let (t, boundary) = mesh.parts();
        let (mut cavity, mut found) = (Cavity::default(), Encroached::default());
        t.prepare(p, t.recent(), &mut cavity).unwrap();
        let tets = cavity.tets.iter().copied();
        boundary.unwrap().in_the_way(t, (p, clearance), tets, |t| cavity.contains(t), &mut found);
        found
    }

    #[test]
    fn elements_give_way_to_what_is_near() {
        // Over the facet z = 0, away from the segments: those of its halves that hold the foot, or both on the diagonal.
        let near = in_the_way(DVec3::new(2.5, 2.25, 0.75), 1.75);
        assert!(near.segments.is_empty() && !near.facets.is_empty(), "{near:?}");
        assert!(in_the_way(DVec3::new(2.5, 2.25, 0.875), 1.75).is_empty());
        // Beside the segment along x.
        assert_eq!(in_the_way(DVec3::new(2.0, 0.3, 0.3), 1.0).segments.len(), 1);
        assert!(in_the_way(DVec3::new(2.0, 0.5, 0.5), 1.0).segments.is_empty());
    }

    #[test]
    fn elements_give_way_to_what_lies_beyond() {
        assert!(!in_the_way(DVec3::new(2.0, 1.5, -1.0), 1e-9).facets.is_empty());
    }
}
