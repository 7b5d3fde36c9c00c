//! Which tetrahedra lie in the domain: a flood that subfacets stop, from outside, from hole seeds and from region seeds.

use super::boundary::Boundary;
use super::outlook::LabelsAhead;
use super::plc::PlcRegion;
use crate::leavings::InPieces;
use crate::triangulation::topology::{slot_of, tet_of};
use crate::triangulation::{Location, Triangulation};
use crate::{memory, Control, DVec3, Error};

/// The label of tetrahedra outside the domain, ghosts included.
pub const OUTSIDE: u16 = 0;
/// The label of tetrahedra in no region of the caller's; region `i` has label `i + 2`.
pub const INSIDE: u16 = 1;

impl Boundary {
    /// Labels all tetrahedra. The subfacets must all be faces of the triangulation. Nothing has changed when memory is lacking or the control says
    /// stop.
    pub(crate) fn label(
        &mut self,
        t: &mut Triangulation,
        holes: &[DVec3],
        regions: &[PlcRegion],
        control: &Control,
    ) -> Result<(), Error> {
        const UNKNOWN: u16 = u16::MAX;
        /// Tetrahedra between two looks at the control.
        const PART: usize = 1 << 14;
        let mut labels = memory::filled(t.topology.tets.len(), UNKNOWN, "regions", control)?;
        let turns = control.turns();
        let mut flood = |seeds: Vec<u32>, label: u16| {
            let mut queue = InPieces::new(seeds, control);
            while let Some(tet) = queue.pop() {
                turns.check()?;
                if labels[tet as usize] != UNKNOWN {
                    continue;
                }
                labels[tet as usize] = label;
                for slot in 0..4 {
                    let next = tet_of(t.topology.tet(tet).n[slot]);
                    if labels[next as usize] == UNKNOWN && !self.is_subfacet(t.topology.tet(tet).face(slot)) {
                        queue.push(next);
                    }
                }
            }
            Ok(())
        };
        let mut ghosts = InPieces::new(Vec::new(), control);
        for (i, part) in t.topology.tets.chunks(PART).enumerate() {
            control.check()?;
            ghosts.extend(
                (i * PART..).zip(part).filter(|(_, tet)| tet.is_live() && tet.is_ghost()).map(|(t, _)| t as u32),
            );
        }
        flood(ghosts.keep(), OUTSIDE)?;
        for &hole in holes {
            flood(t.tetrahedra_at(hole), OUTSIDE)?;
        }
        for (i, region) in regions.iter().enumerate() {
            flood(t.tetrahedra_at(region.point), u16::try_from(i + 2).unwrap_or(UNKNOWN - 1).min(UNKNOWN - 1))?;
        }
        for part in labels.chunks_mut(PART) {
            control.check()?;
            part.iter_mut().filter(|label| **label == UNKNOWN).for_each(|label| *label = INSIDE);
        }
        let label = |face: u32| labels[tet_of(face) as usize];
        let mut parts_labels = true;
        for &face in self.subfacets.keys() {
            control.check()?;
            let apart = |f: u32| label(f) != label(t.topology.tet(tet_of(f)).n[slot_of(f)]);
            if !t.find_face_within(face, control)?.is_some_and(apart) {
                parts_labels = false;
                break;
            }
        }
        self.parts_labels = parts_labels;
        t.topology.region = labels.keep();
        Ok(())
    }

    /// Looks at tetrahedra that have changed: when one of the subfacets at them lies between equal labels, labels don't show subfacets any more. That is so where
    /// facets have the same subfacet, because vertices of both are one by rounding.
    pub(crate) fn note_labels(&mut self, t: &Triangulation, tets: &[u32], control: &Control) -> Result<(), Error> {
        self.parts_labels = self.parts_labels && !self.labels_hide(t, tets, control)?;
        Ok(())
    }

    /// Whether one of the subfacets at these tetrahedra lies between equal labels.
    fn labels_hide(&self, t: &Triangulation, tets: &[u32], control: &Control) -> Result<bool, Error> {
        if t.topology.region.is_empty() {
            return Ok(false);
        }
        let turns = control.turns();
        let hidden = |&tet: &u32| {
            let face = |slot: usize| t.topology.tet(tet).face(slot);
            (0..4).any(|slot| !t.topology.labels_differ(tet, slot) && self.is_subfacet(face(slot)))
        };
        let hides = tets.iter().take_while(|_| turns.go_on()).any(hidden);
        turns.end().map(|()| hides)
    }

    /// The same of a vertex's star that was [looked at](Self::foresee) before it was there.
    pub(crate) fn note_ahead(&mut self, ahead: LabelsAhead) {
        self.parts_labels &= !ahead.hide;
    }

    /// Whether a star hides what was seen of it, for assertions.
    pub(crate) fn hides_as_seen(&self, t: &Triangulation, ahead: LabelsAhead, star: &[u32]) -> bool {
        let hides = self.labels_hide(t, star, Control::never()) == Ok(true);
        ahead.hide == (self.parts_labels && !ahead.parted && hides)
    }
}

impl Triangulation {
    /// A tetrahedron that holds the point, none when it is outside the hull.
    fn tetrahedra_at(&self, p: DVec3) -> Vec<u32> {
        let vertices = match self.locate(p, None) {
            Location::Outside => return Vec::new(),
            Location::Vertex(v) => vec![v],
            Location::Edge(e) => e.to_vec(),
            Location::Face(f) => f.to_vec(),
            Location::Tetrahedron(t) => t.to_vec(),
        };
        let star = self.topology.star(vertices[0]);
        let holds = |&&t: &&u32| {
            let tet = self.topology.tet(t);
            !tet.is_ghost() && vertices.iter().all(|v| tet.v.contains(v))
        };
        star.iter().find(holds).copied().into_iter().collect()
    }
}
