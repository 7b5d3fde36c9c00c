//! Which subsegments and subfacets could not be split, and for what.
//!
//! An element is known by the ids of its vertices, and a vertex that goes leaves its id to another one, somewhere else. So what is noted of an element counts only as
//! long as none of its vertices has left the boundary since. That another vertex was in the way, which has gone, is not seen: the next call tries again.

use super::boundary::{edge_key, face_key};
use crate::leavings::{InPieces, Leavings};
use crate::parted::PartedMap;
use crate::{Control, Error};

/// What is noted of an element.
#[derive(Clone, Copy, Debug)]
struct Note {
    /// The length of the shortest edge that its split would have made: it can be asked for by something that is content with such edges. −1 when it can't
    /// be at all.
    reach: f64,
    /// How many vertices had left the boundary by then.
    when: u32,
}

impl Note {
    /// Whether none of these vertices has left since.
    fn outlives(&self, vertices: &[u32], left: &PartedMap<u32, u32>) -> bool {
        vertices.iter().all(|v| left.get(v).is_none_or(|&left| left <= self.when))
    }
}

/// The elements whose split was refused.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blocked {
    segments: PartedMap<[u32; 2], Note>,
    facets: PartedMap<[u32; 3], Note>,
    /// How many vertices have left the boundary, and by id which of them that was.
    gone: u32,
    left: PartedMap<u32, u32>,
}

impl Blocked {
    /// Notes that a subsegment could not be split.
    pub fn block_segment(&mut self, edge: [u32; 2], reach: f64) {
        self.segments.insert(edge_key(edge), Note { reach, when: self.gone });
    }

    /// Notes that a subfacet could not be split.
    pub fn block_facet(&mut self, face: [u32; 3], reach: f64) {
        self.facets.insert(face_key(face), Note { reach, when: self.gone });
    }

    /// What the split of a subsegment, lower vertex first, has failed at.
    pub fn reach_of_segment(&self, edge: [u32; 2]) -> Option<f64> {
        self.segments.get(&edge).filter(|note| self.counts(note, &edge)).map(|note| note.reach)
    }

    /// What the split of a subfacet, its vertices in order, has failed at.
    pub fn reach_of_facet(&self, face: [u32; 3]) -> Option<f64> {
        self.facets.get(&face).filter(|note| self.counts(note, &face)).map(|note| note.reach)
    }

    fn counts(&self, note: &Note, vertices: &[u32]) -> bool {
        note.when == self.gone || note.outlives(vertices, &self.left)
    }

    /// Lets a subfacet be tried again.
    pub fn forget_facet(&mut self, face: [u32; 3]) {
        self.facets.remove(&face_key(face));
    }

    /// Notes that a vertex leaves the boundary.
    pub fn leave(&mut self, v: u32) {
        self.gone += 1;
        self.left.insert(v, self.gone);
    }

    #[cfg(test)]
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty() && self.facets.is_empty()
    }

    pub fn clear(&mut self) {
        self.segments.clear();
        self.facets.clear();
        self.left.clear();
        self.gone = 0;
    }

    /// The subsegments, in order, those among them that count no more.
    pub fn segments<'a>(&self, control: &'a Control) -> Result<InPieces<'a, Vec<[u32; 2]>>, Error> {
        self.segments.sorted_keys(control)
    }

    /// The subfacets, likewise.
    pub fn facets<'a>(&self, control: &'a Control) -> Result<InPieces<'a, Vec<[u32; 3]>>, Error> {
        self.facets.sorted_keys(control)
    }

    /// A copy, unless the control says stop.
    pub fn try_clone(&self, control: &Control) -> Result<Blocked, Error> {
        let mut copy = InPieces::new(Blocked::default(), control);
        copy.segments = self.segments.try_clone(control)?;
        copy.facets = self.facets.try_clone(control)?;
        copy.left = self.left.try_clone(control)?;
        copy.gone = self.gone;
        Ok(copy.keep())
    }

    /// Gives the vertices new ids. Half of it may be done when the control says stop.
    pub fn rekey(
        &mut self,
        control: &Control,
        edge: impl Fn([u32; 2]) -> Option<[u32; 2]>,
        face: impl Fn([u32; 3]) -> Option<[u32; 3]>,
    ) -> Result<(), Error> {
        let Blocked { segments, facets, left, .. } = self;
        segments.rekey(control, |key, note| note.outlives(&key, left).then(|| edge(key)).flatten())?;
        facets.rekey(control, |key, note| note.outlives(&key, left).then(|| face(key)).flatten())?;
        // All that is left counts.
        left.clear();
        Ok(())
    }
}

impl Leavings for Blocked {
    fn give_back(&mut self) -> bool {
        let Blocked { segments, facets, left, .. } = self;
        segments.give_back() || facets.give_back() || left.give_back()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_goes_with_the_vertices_that_it_was_made_for() {
        let mut blocked = Blocked::default();
        blocked.block_facet([7, 5, 6], 0.25);
        blocked.block_segment([6, 5], -1.0);
        assert_eq!((blocked.reach_of_facet([5, 6, 7]), blocked.reach_of_segment([5, 6])), (Some(0.25), Some(-1.0)));
        blocked.leave(7);
        assert_eq!((blocked.reach_of_facet([5, 6, 7]), blocked.reach_of_segment([5, 6])), (None, Some(-1.0)));
        // Another vertex with that id.
        blocked.block_facet([5, 6, 7], 0.5);
        blocked.leave(8);
        assert_eq!((blocked.reach_of_facet([5, 6, 7]), blocked.reach_of_segment([5, 6])), (Some(0.5), Some(-1.0)));
    }

    #[test]
    fn notes_follow_their_vertices_to_new_ids() {
        let mut blocked = Blocked::default();
        blocked.block_segment([1, 2], 0.5);
        blocked.leave(1);
        blocked.block_segment([1, 3], 0.25);
        let control = Control::new();
        blocked.rekey(&control, |edge| Some(edge.map(|v| v + 10)), Some).unwrap();
        assert_eq!((blocked.reach_of_segment([11, 12]), blocked.reach_of_segment([11, 13])), (None, Some(0.25)));
        assert_eq!(blocked.segments(&control).unwrap()[..], [[11, 13]]);
    }
}
