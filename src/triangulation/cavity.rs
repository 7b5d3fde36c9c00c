//! Insertion of a point as two steps: find its *cavity* (the tetrahedra whose circumspheres hold it;
//! A. Bowyer, D. F. Watson, both The Computer Journal 24, 1981), then replace the cavity by the
//! star of the point. Between the two a caller can look at what would go and what would come, and drop it.
//!
//! The marks of visited tetrahedra live in the [`Cavity`], so that finding one does not change the triangulation.
//! `search` does the finding, `star` the filling.

use glam::DVec3;

use super::labels::Labels;
use super::site::Site;
use super::star::StarBuilder;
use super::topology::{slot_of, tet_of, Topology, GHOST};
use super::Triangulation;
use crate::geometry::Filter;
use crate::leavings::Leavings;
use crate::{memory, Control, Error};

/// The cavity of one point, and scratch memory to find the next one in.
#[derive(Clone, Debug, Default)]
pub struct Cavity {
    /// One byte a tetrahedron: whether it is in the cavity.
    pub(super) marks: Vec<u8>,
    /// The tetrahedra that go.
    pub tets: Vec<u32>,
    /// The faces between the cavity and the rest, as handles inside it: each becomes a tetrahedron with the new point.
    pub faces: Vec<u32>,
    /// What the last insertion created, in the order of `faces`.
    pub created: Vec<u32>,
    /// Scratch of the search: for each of `tets` the face that it was found across, as a handle on its own side.
    pub(super) entries: Vec<u32>,
    /// Numbers for the cavity's vertices.
    pub(super) labels: Labels,
    pub(super) star: StarBuilder,
    /// Whether the star that replaces it is [planned](Self::plan).
    pub(super) planned: bool,
}

impl Cavity {
    /// Whether a tetrahedron belongs to the cavity.
    #[inline]
    pub fn contains(&self, t: u32) -> bool {
        self.marks.get(t as usize).is_some_and(|&mark| mark != 0)
    }

    /// A number from 0 on for each of its vertices, as long as it is the last one that was found.
    #[inline]
    pub fn number(&self, v: u32) -> usize {
        self.labels.number(v)
    }

    /// Forgets the cavity; its memory stays for the next one.
    #[inline]
    pub fn clear(&mut self) {
        self.unmark();
        self.clear_lists();
    }

    /// Takes the marks back.
    #[inline]
    pub(super) fn unmark(&mut self) {
        memory::reset_at(&mut self.marks, 0, self.tets.iter().copied());
    }

    #[inline]
    pub(super) fn clear_lists(&mut self) {
        self.tets.clear();
        self.faces.clear();
        self.entries.clear();
        self.planned = false;
    }

    /// Memory for cavities among that many tetrahedra and vertices.
    pub(crate) fn reserve(&mut self, tetrahedra: usize, vertices: usize, control: &Control) -> Result<(), Error> {
        self.clear();
        if self.marks.len() < tetrahedra {
            self.marks = memory::zeroed(tetrahedra, "marks", control)?.keep();
        }
        self.labels.reserve(vertices, control)
    }

    /// Makes room for marks of so many tetrahedra, so that the next search asks for no memory.
    pub(super) fn reserve_marks(&mut self, tetrahedra: usize) -> Result<(), Error> {
        let more = tetrahedra.saturating_sub(self.marks.len());
        memory::reserve(&mut self.marks, more, "marks")
    }

    /// As long as the triangulation has room for tetrahedra and vertices, in pieces, so that no search has to do it. The cavity is forgotten.
    #[cold]
    #[inline(never)]
    pub(crate) fn grow_for(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        self.clear();
        let (tetrahedra, vertices) = t.room();
        memory::lengthen(&mut self.marks, tetrahedra, 0, "marks", control)?;
        self.labels.grow(vertices, control)
    }

    /// The bytes of its marks.
    pub(crate) fn bytes(&self) -> usize {
        self.marks.capacity()
    }

    /// Makes an empty cavity with marks for all tetrahedra.
    #[inline]
    pub(super) fn begin(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        if self.marks.len() < t.topology.tets.len() {
            return self.grow_for(t, control);
        }
        self.clear();
        Ok(())
    }

    /// The vertices of one of `faces`; the ghost may be one.
    pub fn face(&self, topology: &Topology, face: u32) -> [u32; 3] {
        topology.tet(tet_of(face)).face(slot_of(face))
    }

    /// The finite vertices around the cavity, each once, a few more often: those of the tetrahedron that the search began with, and what each
    /// further one brought.
    pub fn rim<'a>(&'a self, topology: &'a Topology) -> impl Iterator<Item = u32> + 'a {
        let first = self.entries.first().map(|&entry| topology.tet(tet_of(entry)).v);
        let brought = self.entries.iter().skip(1).map(|&entry| topology.tet(tet_of(entry)).v[slot_of(entry)]);
        first.into_iter().flatten().chain(brought).filter(|&v| v != GHOST)
    }
}

impl Leavings for Cavity {
    fn give_back(&mut self) -> bool {
        self.marks.give_back() || self.labels.give_back() || self.star.large.give_back()
    }
}

impl Triangulation {
    /// Whether `p` lies inside the circumsphere of tetrahedron `t`, after perturbation; for a ghost, whether it lies beyond the
    /// hull facet, or on its plane and inside its circle.
    #[inline]
    pub(crate) fn conflicts(&self, filter: &Filter, t: u32, p: DVec3) -> bool {
        assert!(self.topology.tet(t).is_live());
        // SAFETY: a live tetrahedron, and nothing changes the triangulation meanwhile.
        unsafe { Site::of(self).conflicts(filter, t, p) }
    }
}
