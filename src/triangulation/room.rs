//! Room made before it is needed, where a call can stop. A list that has no room left is moved to where there is some, all of it: with a million points the
//! tetrahedra alone are 200 MB, and nobody could cancel meanwhile. So between two steps of a long call a look is taken whether the next ones have room, and if
//! not, the list is copied in pieces, with looks at the control between them.
//!
//! A step that wants more than was made ready still gets it, at once.

use super::cavity::Cavity;
use super::Triangulation;
use crate::{memory, Control, Error};

/// Places that are kept ready. A step of a refinement takes some tens.
const AHEAD: usize = memory::STEP;
/// Shorter lists are moved when it comes to it: that takes less than a millisecond.
const LARGE: usize = 1 << 15;

/// Whether a list of so many is to be moved.
#[inline]
fn lacks_room(len: usize, capacity: usize, free: usize) -> bool {
    len >= LARGE && capacity - len + free < AHEAD
}

impl Triangulation {
    /// Whether [`make_room_ahead`](Self::make_room_ahead) has something to do.
    #[inline]
    pub(crate) fn lacks_room_ahead(&self) -> bool {
        let vertex_tet = &self.topology.vertex_tet;
        self.lacks_tetrahedra_ahead()
            || lacks_room(self.points.len(), self.points.capacity(), 0)
            || lacks_room(vertex_tet.len(), vertex_tet.capacity(), 0)
    }

    #[inline]
    fn lacks_tetrahedra_ahead(&self) -> bool {
        let tets = &self.topology.tets;
        lacks_room(tets.len(), tets.capacity(), self.topology.free.len())
    }

    /// Room for some thousand more tetrahedra and vertices, unless memory is lacking or the control says stop.
    #[cold]
    #[inline(never)]
    pub(crate) fn make_room_ahead(&mut self, control: &Control) -> Result<(), Error> {
        self.make_tetrahedra(AHEAD, control)?;
        memory::grow(&mut self.points, AHEAD, "points", control)?;
        memory::grow(&mut self.topology.vertex_tet, AHEAD, "vertices", control)
    }

    /// Room for so many more tetrahedra, if they are not there yet.
    #[cold]
    pub(super) fn make_tetrahedra(&mut self, count: usize, control: &Control) -> Result<(), Error> {
        let more = count.saturating_sub(self.topology.free.len());
        memory::grow(&mut self.topology.tets, more, "tetrahedra", control)?;
        if !self.topology.region.is_empty() {
            memory::grow(&mut self.topology.region, more, "regions", control)?;
        }
        Ok(())
    }

    /// The same for a loop that inserts vertices whose points are stored already, with this cavity.
    #[inline]
    pub(super) fn tetrahedra_ahead(&mut self, cavity: &mut Cavity, control: &Control) -> Result<(), Error> {
        if self.lacks_tetrahedra_ahead() {
            self.make_tetrahedra(AHEAD, control)?;
            cavity.grow_for(self, control)?;
        }
        Ok(())
    }

    /// The same for insertions with the triangulation's own cavity.
    #[inline]
    pub(super) fn room_ahead(&mut self, control: &Control) -> Result<(), Error> {
        if self.lacks_room_ahead() {
            self.make_room_ahead(control)?;
            let mut cavity = std::mem::take(&mut self.scratch);
            let grown = cavity.grow_for(self, control);
            self.scratch = cavity;
            grown?;
        }
        Ok(())
    }

    /// How many tetrahedra and vertices there is room for: so long are lists made that have an entry for each.
    pub(crate) fn room(&self) -> (usize, usize) {
        (self.topology.tets.capacity(), self.points.capacity())
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::triangulation::topology::Tetrahedron;

    /// A triangulation that is large only by what it has: no test has time for a million points.
    fn large(tets: usize) -> Triangulation {
        let mut t = Triangulation::new();
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        t.insert_many(&corners, &Control::new()).unwrap().unwrap();
        t.topology.tets.reserve_exact(tets);
        t.topology.tets.resize(tets, Tetrahedron::DEAD);
        t
    }

    /// Its tetrahedra, and where they are.
    fn state(t: &Triangulation) -> (*const Tetrahedron, usize, Vec<[[u32; 4]; 2]>) {
        let tets = &t.topology.tets;
        (tets.as_ptr(), tets.capacity(), tets.iter().map(|tet| [tet.v, tet.n]).collect())
    }

    #[test]
    fn a_list_is_moved_in_pieces_and_a_cancelled_move_changes_nothing() {
        let control = Control::new();
        let count = 1 << 18;
        let pieces = count * size_of::<Tetrahedron>() / memory::PIECE;
        let mut t = large(count);
        let before = state(&t);
        assert!(t.lacks_room_ahead());
        let looks = control.looks(None, || t.make_room_ahead(&control).unwrap());
        assert!(looks >= pieces, "{looks}");
        let after = state(&t);
        assert!(!t.lacks_room_ahead() && after.0 != before.0 && after.2 == before.2);
        for last in [1, 2, pieces] {
            let mut t = large(count);
            let before = state(&t);
            let looks = control.looks(Some(last), || assert_eq!(t.make_room_ahead(&control), Err(Error::Cancelled)));
            // The one that says so, and what is given back then is not given back.
            assert!(looks <= last + 1, "{looks}");
            assert!(state(&t) == before);
        }
    }

    #[test]
    fn marks_and_numbers_grow_with_the_lists() {
        let mut t = large(LARGE);
        t.room_ahead(&Control::new()).unwrap();
        assert!(!t.lacks_room_ahead());
        let (tetrahedra, vertices) = t.room();
        assert!(tetrahedra >= LARGE + AHEAD);
        assert_eq!(t.scratch.marks.len(), tetrahedra);
        // A search finds all that it needs.
        t.insert(DVec3::splat(0.1), None).unwrap();
        assert!(vertices >= 5 && t.scratch.marks.len() == tetrahedra && t.room().0 == tetrahedra);
    }
}
