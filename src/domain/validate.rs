//! The invariants of a boundary, checked one by one and exactly: its elements are in the triangulation, its facets are what its list of subfacets says,
//! and where two labels meet there is a subfacet.

use super::boundary::{face_key, Boundary};
use crate::triangulation::incident::Search;
use crate::triangulation::{Defect, Triangulation};
use crate::{Control, Error};

impl Boundary {
    /// The first broken invariant, unless the control says stop.
    pub(crate) fn first_defect(&self, t: &Triangulation, control: &Control) -> Result<Option<Defect>, Error> {
        if let Some(missing) = self.first_missing(t, control)? {
            return Ok(Some(missing));
        }
        match self.first_misfit(control)? {
            None => self.first_leak(t, control),
            misfit => Ok(misfit),
        }
    }

    /// The first missing element: every subsegment is an edge and every subfacet a face of the triangulation when there is none.
    pub(crate) fn first_missing(&self, t: &Triangulation, control: &Control) -> Result<Option<Defect>, Error> {
        for &[a, b] in &*self.subsegments.sorted_keys(control)? {
            control.check()?;
            if Search::new(&t.topology, [a, b]).finish(&t.topology, control)?.is_none() {
                return Ok(Some(Defect::MissingSubsegment { edge: [a, b] }));
            }
        }
        for &face in &*self.subfacets.sorted_keys(control)? {
            control.check()?;
            if Search::new(&t.topology, face).finish(&t.topology, control)?.is_none() {
                return Ok(Some(Defect::MissingSubfacet { face }));
            }
        }
        Ok(None)
    }

    /// The lowest triangle that its facet has but the list of subfacets has not, has for another facet, or the other way round.
    fn first_misfit(&self, control: &Control) -> Result<Option<Defect>, Error> {
        let turns = control.turns();
        let (mut lowest, mut fitting) = (None, 0);
        for (facet, planar) in self.facets.iter().enumerate() {
            for triangle in planar.each_triangle() {
                turns.check()?;
                let face = face_key(triangle);
                if self.facet_of(face) == Some(facet) {
                    fitting += 1;
                } else if lowest.is_none_or(|lowest| face < lowest) {
                    lowest = Some(face);
                }
            }
        }
        if lowest.is_none() && fitting != self.subfacets.len() {
            for &face in &*self.subfacets.sorted_keys(control)? {
                turns.check()?;
                let facet = self.facet_of(face).map(|facet| &self.facets[facet]);
                if facet.and_then(|planar| planar.triangle(face)).is_none() {
                    lowest = Some(face);
                    break;
                }
            }
        }
        Ok(lowest.map(|face| Defect::FacetMismatch { face }))
    }

    /// The first face that parts two labels and is no subfacet, unless the control says stop.
    fn first_leak(&self, t: &Triangulation, control: &Control) -> Result<Option<Defect>, Error> {
        let turns = control.turns();
        let leak = t.topology.live().find_map(|tet| {
            let face = |slot: usize| t.topology.tet(tet).face(slot);
            let leaks =
                |&slot: &usize| !turns.go_on() || t.topology.labels_differ(tet, slot) && !self.is_subfacet(face(slot));
            (0..4).find(leaks).map(|slot| Defect::LabelLeak { face: face(slot) })
        });
        turns.end().map(|()| leak)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::facet::FacetChange;
    use crate::{DVec3, Mesh, Plc};

    #[test]
    fn facets_and_the_list_of_subfacets_must_agree() {
        let control = Control::new();
        let mesh = Mesh::from_plc(&Plc::boxed(DVec3::ZERO, DVec3::ONE, []), &control).unwrap();
        let (t, sound) = (mesh.triangulation(), &mesh.domain.as_ref().unwrap().boundary);
        assert_eq!(sound.first_defect(t, &control), Ok(None));
        let triangle = sound.facets[2].triangles()[0];
        let (face, mismatch) = (face_key(triangle), |face| Ok(Some(Defect::FacetMismatch { face })));

        let mut unlisted = sound.clone();
        unlisted.subfacets.remove(&face);
        assert_eq!(unlisted.first_defect(t, &control), mismatch(face));

        let mut another = sound.clone();
        another.subfacets.insert(face, 3);
        assert_eq!(another.first_defect(t, &control), mismatch(face));

        let mut torn = sound.clone();
        let change = FacetChange { removed: vec![triangle], created: Vec::new() };
        torn.facets[2].apply(&change, DVec3::ZERO, &Control::new()).unwrap();
        assert_eq!(torn.first_defect(t, &control), mismatch(face));

        // As when two facets are folded onto each other.
        let mut folded = sound.clone();
        let change = FacetChange { removed: Vec::new(), created: vec![sound.facets[3].triangles()[0]] };
        folded.facets[2].apply(&change, DVec3::ZERO, &Control::new()).unwrap();
        assert_eq!(folded.first_defect(t, &control), mismatch(face_key(change.created[0])));
    }
}
