//! How the boundary's own bookkeeping changes when a subsegment or subfacet is split.

use glam::DVec3;

use super::acute::Carrier;
use super::boundary::{edge_key, face_key, face_keys, Boundary, Standing, ACUTE, ON_FACET, ON_SEGMENT, SHARP};
use super::facet::{FacetChange, InSpace};
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{slot_of, tet_of};
use crate::triangulation::Triangulation;
use crate::{Control, Error};

impl Boundary {
    /// Where to split a subsegment.
    pub(crate) fn split_point(&self, t: &Triangulation, [a, b]: [u32; 2]) -> DVec3 {
        let acute = |v: u32| self.kind(v) & ACUTE != 0;
        // Around the sharper of two corners more depends on it.
        let acute = match (acute(a), acute(b)) {
            (true, true) => [self.sharpness(a) > self.sharpness(b), self.sharpness(a) < self.sharpness(b)],
            (at_a, at_b) => [at_a, at_b],
        };
        super::acute::split_point([t.at(a), t.at(b)], acute)
    }

    /// What inserting the vertex `new` at `p`, which is not in the triangulation yet, changes in the planar triangulations at subsegment `edge`,
    /// which it splits. `cavity` is that of `p`. [`Error::Cancelled`] when the control says stop.
    pub(crate) fn plan_on_segment(
        &self,
        t: &mut Triangulation,
        cavity: &Cavity,
        edge: [u32; 2],
        new: u32,
        p: DVec3,
        control: &Control,
    ) -> Result<Vec<(u32, FacetChange)>, Error> {
        let key = edge_key(edge);
        let Some(&segment) = self.subsegments.get(&key) else { return Ok(Vec::new()) };
        let subsegments = &self.subsegments;
        let fixed = |e: [u32; 2]| subsegments.contains_key(&edge_key(e));
        let mut changes = Vec::new();
        for &facet in &self.segments[segment as usize].facets {
            let planar = &self.facets[facet as usize];
            let start: Vec<[u32; 3]> = planar.at_edge(key).collect();
            // `None`: a vertex of the facet already, or one that rounding hides from it. Then the facet keeps its triangles at the old edge,
            // which are found missing and split in their turn.
            let change = t.with_point(new, p, |t| {
                let in_space = |face| t.in_space(cavity, face);
                planar.plan((new, &start, Some(key)), t.points(), fixed, in_space, control)
            })?;
            changes.extend(change.map(|change| (facet, change)));
        }
        Ok(changes)
    }

    /// Takes over the split of subsegment `edge`, or of a subfacet, at `vertex`, which is in the triangulation by now, and what was planned in facets for it.
    /// Returns how the vertex stood before. When the control says stop, half of it is done.
    pub(crate) fn split_at(
        &mut self,
        (vertex, p): (u32, DVec3),
        edge: Option<[u32; 2]>,
        changes: &[(u32, FacetChange)],
        control: &Control,
    ) -> Result<Standing, Error> {
        for (facet, change) in changes {
            self.facets[*facet as usize].apply(change, p, control)?;
        }
        let before = self.standing(vertex, edge, changes, control)?;
        if edge.is_none_or(|edge| self.replace_subsegment(edge, vertex)) {
            for (facet, change) in changes {
                self.replace_subfacets(*facet, vertex, change, control)?;
            }
        }
        Ok(before)
    }

    /// Replaces a subsegment by its two parts at vertex `new`; false when it is none.
    fn replace_subsegment(&mut self, edge: [u32; 2], new: u32) -> bool {
        let key = edge_key(edge);
        let Some(segment) = self.subsegments.remove(&key) else { return false };
        for part in key.map(|end| edge_key([end, new])) {
            debug_assert!(!self.subsegments.contains_key(&part), "a subsegment of two segments");
            self.subsegments.insert(part, segment);
        }
        self.put_on(new, segment);
        true
    }

    /// Notes that a vertex lies on a segment.
    pub(super) fn put_on(&mut self, v: u32, segment: u32) {
        let sharp = self.sharp_segments.get(segment as usize) == Some(&true);
        self.mark(v, ON_SEGMENT | if sharp { SHARP } else { 0 });
        self.carry(v, Carrier::Segment(segment));
    }

    /// The subsegment behind which a point of its facet lies, seen from a subfacet.
    pub(crate) fn hides(&self, t: &Triangulation, face: [u32; 3], p: DVec3) -> Option<[u32; 2]> {
        let fixed = |edge: [u32; 2]| self.subsegments.contains_key(&edge_key(edge));
        self.facets[self.facet_of(face)?].hidden_by(face, p, t.points(), fixed).map(edge_key)
    }

    /// The subfacet that a point of its facet lies in, seen from another one that it does not lie in, and the point moved along the facet's normal until
    /// it lies on it. Where facets are uneven, that may be on a tetrahedron of which the point itself is not.
    pub(crate) fn on_the_spot(&self, t: &Triangulation, face: [u32; 3], p: DVec3) -> Option<(DVec3, [u32; 3])> {
        let planar = &self.facets[self.facet_of(face)?];
        let fixed = |edge: [u32; 2]| self.subsegments.contains_key(&edge_key(edge));
        let spot = planar.locate_from(face, p, t.points(), fixed).filter(|&spot| face_key(spot) != face_key(face))?;
        let [a, b, c] = spot.map(|v| t.at(v));
        let (normal, up) = ((b - a).cross(c - a), planar.normal());
        let moved = p + up * ((a - p).dot(normal) / up.dot(normal));
        moved.is_finite().then_some((moved, spot))
    }

    /// What inserting the vertex `new` at `p`, which is not in the triangulation yet, changes in the planar triangulation of subfacet `face`. `None`
    /// when it can't be inserted. `cavity` is that of `p`. [`Error::Cancelled`] when the control says stop.
    pub(crate) fn plan_on_facet(
        &self,
        t: &mut Triangulation,
        cavity: &Cavity,
        face: [u32; 3],
        new: u32,
        p: DVec3,
        control: &Control,
    ) -> Result<Option<(u32, FacetChange)>, Error> {
        let Some(&facet) = self.subfacets.get(&face_key(face)) else { return Ok(None) };
        let planar = &self.facets[facet as usize];
        let Some(start) = planar.triangle(face) else { return Ok(None) };
        let subsegments = &self.subsegments;
        let fixed = |e: [u32; 2]| subsegments.contains_key(&edge_key(e));
        let change = t.with_point(new, p, |t| {
            let in_space = |face| t.in_space(cavity, face);
            planar.plan((new, &[start], None), t.points(), fixed, in_space, control)
        })?;
        Ok(change.map(|change| (facet, change)))
    }

    /// Whether a change of this facet would lay a subfacet on another facet's. Where facets meet at next to no angle and coordinates are coarse, one vertex
    /// may come to stand for both; a face of two facets could not be told from a face of one.
    pub(super) fn covers_another(&self, facet: u32, change: &FacetChange) -> bool {
        change.created.iter().any(|&face| self.is_of_another(facet, face))
    }

    fn is_of_another(&self, facet: u32, face: [u32; 3]) -> bool {
        self.subfacets.get(&face_key(face)).is_some_and(|&other| other != facet)
    }

    /// [`covers_another`](Self::covers_another) for changes of several facets at once: nor may two of them make the same subfacet.
    pub(crate) fn folds(&self, changes: &[(u32, FacetChange)], control: &Control) -> Result<bool, Error> {
        let turns = control.turns();
        for (facet, change) in changes {
            for &face in &change.created {
                turns.check()?;
                if self.is_of_another(*facet, face) {
                    return Ok(true);
                }
            }
        }
        if changes.len() < 2 {
            return Ok(false);
        }
        let keys = face_keys(changes.iter().flat_map(|(_, change)| &change.created), control)?;
        Ok(keys.windows(2).any(|pair| pair[0] == pair[1]))
    }

    /// How a vertex stands on the boundary before the split of `edge` or of a subfacet at it, with these changes.
    fn standing(
        &self,
        vertex: u32,
        edge: Option<[u32; 2]>,
        changes: &[(u32, FacetChange)],
        control: &Control,
    ) -> Result<Standing, Error> {
        let turns = control.turns();
        let parts = edge.into_iter().flat_map(|[a, b]| [[a, b], [a, vertex], [vertex, b]].map(edge_key));
        let faces = changes.iter().flat_map(|(_, change)| change.removed.iter().chain(&change.created));
        let keys = faces.take_while(|_| turns.go_on()).map(|&face| face_key(face));
        let standing = Standing {
            kind: self.kind(vertex),
            carrier: self.carrier(vertex),
            segments: parts.map(|part| (part, self.subsegments.get(&part).copied())).collect(),
            facets: keys.map(|key| (key, self.subfacets.get(&key).copied())).collect(),
        };
        turns.end().map(|()| standing)
    }

    /// Takes a split at a vertex back. The triangulation in space does not matter.
    pub(crate) fn take_back(&mut self, vertex: u32, before: &Standing, changes: Vec<(u32, FacetChange)>) {
        for (facet, change) in changes.into_iter().rev() {
            self.exchange(facet, &change.reversed());
        }
        for &(edge, known) in &before.segments {
            match known {
                Some(segment) => self.subsegments.insert(edge, segment),
                None => self.subsegments.remove(&edge),
            };
        }
        for &(face, known) in &before.facets {
            match known {
                Some(facet) => self.subfacets.insert(face, facet),
                None => self.subfacets.remove(&face),
            };
        }
        // A vertex that was on the boundary before stays there, and what is noted of its elements counts.
        if before.kind == 0 {
            self.unmark(vertex);
        } else {
            self.forget(vertex);
            self.mark(vertex, before.kind);
            self.carry(vertex, before.carrier);
        }
    }

    /// Takes over what changed in a facet.
    fn replace_subfacets(
        &mut self,
        facet: u32,
        new: u32,
        change: &FacetChange,
        control: &Control,
    ) -> Result<(), Error> {
        let turns = control.turns();
        for &face in &change.removed {
            turns.check()?;
            self.subfacets.remove(&face_key(face));
        }
        for &face in &change.created {
            turns.check()?;
            self.subfacets.insert(face_key(face), facet);
        }
        self.mark(new, ON_FACET);
        self.carry(new, Carrier::Facet(facet));
        Ok(())
    }
}

impl Triangulation {
    /// What becomes of a face when a cavity is filled.
    fn in_space(&self, cavity: &Cavity, face: [u32; 3]) -> InSpace {
        let Some(face) = self.find_face(face) else { return InSpace::Missing };
        let across = self.topology.tet(tet_of(face)).n[slot_of(face)];
        match (cavity.contains(tet_of(face)), cavity.contains(tet_of(across))) {
            (true, true) => InSpace::BothGo,
            (false, false) => InSpace::Stays,
            _ => InSpace::OneGoes,
        }
    }

    /// A tetrahedron with this face, finite if there is one; [`Error::Cancelled`] when the control says stop.
    pub(crate) fn face_tetrahedron_within(&self, face: [u32; 3], control: &Control) -> Result<Option<u32>, Error> {
        Ok(self.find_face_within(face, control)?.map(|handle| self.finite_at(tet_of(handle))))
    }
}
