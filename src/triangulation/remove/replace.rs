//! What a preview has found, done.

use super::{look, Going, Hole, ADDED, POLL_INTERVAL};
use crate::domain::label::OUTSIDE;
use crate::geometry::Filter;
use crate::leavings::InPieces;
use crate::triangulation::lower::Lower;
use crate::triangulation::topology::{slot_of, tet_of, GHOST, MAX_VERTICES, NONE};
use crate::triangulation::Triangulation;
use crate::{Control, Error};

impl Triangulation {
    /// Does what the last [`preview`](Self::preview) in `hole` found. Returns the new point's vertex. After an error nothing has changed;
    /// the hole is empty in any case.
    ///
    /// # Panics
    /// When the triangulation has changed since the preview, before anything else is changed.
    pub fn replace(&mut self, hole: &mut Hole) -> Result<Option<u32>, Error> {
        self.replace_within(hole, Control::never())
    }

    /// [`replace`](Self::replace) that a control can cancel: [`Error::Cancelled`], and nothing has changed.
    pub(super) fn replace_within(&mut self, hole: &mut Hole, control: &Control) -> Result<Option<u32>, Error> {
        let result = self.replace_found(hole, control);
        hole.clear();
        result
    }

    fn replace_found(&mut self, hole: &mut Hole, control: &Control) -> Result<Option<u32>, Error> {
        let is_there = |going: &Going| self.topology.tets.get(going.t as usize).is_some_and(|tet| tet.v == going.v);
        let mut is_as_found = hole.remove.iter().all(|&v| self.is_vertex(v));
        for part in hole.going.chunks(POLL_INTERVAL) {
            control.check()?;
            is_as_found &= part.iter().all(is_there);
        }
        assert!(is_as_found, "the triangulation has changed since the preview");
        let requested = self.points.len() + usize::from(hole.add.is_some());
        if requested > MAX_VERTICES || !self.topology.has_room(hole.coming.len()) {
            return Err(Error::TooManyVertices { requested, limit: MAX_VERTICES });
        }
        hole.created.clear();
        if hole.flat {
            return self.replace_flat(hole, control);
        }
        let slots = self.points.len();
        let new = hole.add.map(|p| {
            let new = self.next_vertex();
            self.filter.extend(p);
            self.store(new, p);
            new
        });
        let count = hole.going.len() + hole.coming.len();
        let filled = self.change(count, control, |this, control| this.fill_hole(new.unwrap_or(NONE), hole, control));
        if let Err(error) = filled {
            new.into_iter().for_each(|new| self.unstore(new, slots));
            return Err(error);
        }
        for &v in &hole.remove {
            self.free_vertex(v);
        }
        if let Some(&t) = hole.created.last() {
            self.last = t;
        }
        Ok(new)
    }

    /// Where the control says stop, half of it may be done.
    fn fill_hole(&mut self, new: u32, hole: &mut Hole, control: &Control) -> Result<(), Error> {
        let more = hole.coming.len().saturating_sub(hole.going.len());
        if hole.coming.len() >= POLL_INTERVAL {
            self.make_tetrahedra(more, control)?;
        }
        let topology = &mut self.topology;
        let labelled = !topology.region.is_empty();
        let first = hole.going.iter().find(|going| going.v[3] != GHOST);
        let any_label = first.filter(|_| labelled).map_or(OUTSIDE, |going| topology.region[going.t as usize]);
        // Last destroyed is first reused.
        for (turn, going) in hole.going.iter().rev().enumerate() {
            look(turn, control)?;
            topology.destroy(going.t);
        }
        for (turn, coming) in hole.coming.iter().enumerate() {
            look(turn, control)?;
            hole.created.push(topology.create(coming.v.map(|v| if v == ADDED { new } else { v })));
        }
        for (turn, (coming, &t)) in hole.coming.iter().zip(&hole.created).enumerate() {
            look(turn, control)?;
            for (slot, n) in coming.n.into_iter().enumerate() {
                if coming.rim >> slot & 1 != 0 {
                    topology.join(4 * t + slot as u32, hole.faces[n as usize].outside);
                } else {
                    topology.tets[t as usize].n[slot] = 4 * hole.created[tet_of(n) as usize] + slot_of(n) as u32;
                }
            }
            topology.name_incident(&[t]);
            if labelled {
                topology.region[t as usize] = coming.label.unwrap_or(any_label);
            }
        }
        Ok(())
    }

    /// [`replace`](Self::replace) where no tetrahedron is left, or was any.
    fn replace_flat(&mut self, hole: &mut Hole, control: &Control) -> Result<Option<u32>, Error> {
        let mut anew = None;
        if self.dimension() == 3 || hole.remove.iter().any(|&v| self.lower.rests_on(v)) {
            anew = Some(self.lower_without(&hole.remove, control)?);
        }
        for &v in &hole.remove {
            if anew.is_none() {
                self.lower.remove(self.at(v));
            }
            self.free_vertex(v);
        }
        if let Some((lower, filter)) = anew {
            self.topology.clear_tetrahedra();
            control.give_back(std::mem::replace(&mut self.lower, lower));
            self.filter = filter;
        }
        hole.add.map(|p| Ok(self.insert(p, None)?.vertex)).transpose()
    }

    /// The state below dimension 3 of all vertices but these, which span no volume, and their filter.
    pub(in crate::triangulation) fn lower_without(
        &self,
        removed: &[u32],
        control: &Control,
    ) -> Result<(Lower, Filter), Error> {
        let mut removed = removed.to_vec();
        removed.sort_unstable();
        let (mut lower, mut filter) = (InPieces::new(Lower::default(), control), Filter::default());
        for (turn, v) in self.vertices().filter(|v| removed.binary_search(v).is_err()).enumerate() {
            look(turn, control)?;
            let p = self.at(v);
            filter.extend(p);
            let basis = lower.add(v, p, &self.points);
            debug_assert!(basis.is_none());
        }
        Ok((lower.keep(), filter))
    }
}
