//! Which tetrahedra a thread may touch while others work on the same triangulation.
//!
//! After C. Marot, J. Pellerin, J.-F. Remacle, "One machine, one minute, three billion tetrahedra", IJNME 117, 2019: every vertex belongs to one
//! territory, and a tetrahedron to the territory that three of its vertices are in, if there is one; a ghost to the one that two of its
//! three vertices are in. No tetrahedron belongs to two. An insertion replaces or links anew nothing but what belongs to its territory;
//! where it would have to, it is put off. Other than there, nothing is read that may change meanwhile:
//!
//! - A tetrahedron with two vertices in a territory (a ghost too) belongs to no other, so nobody else changes it. It may be read.
//! - All neighbours of a tetrahedron that belongs to a territory have two vertices in it; of a ghost, where all three of its
//!   vertices are. That much is asked of what an insertion replaces.
//! - A new tetrahedron has the new vertex and three of an old one that belonged to the territory, so it belongs there too.
//!
//! So no decision depends on what another thread does, or when: what a territory's insertions do is the same in every run.

use crate::geometry::lanes::Lanes;

/// Which vertices are own.
pub(super) trait Territory: Copy {
    /// A bit for each slot with an own vertex; the ghost is nobody's.
    ///
    /// # Safety
    /// Vertices of a live tetrahedron.
    unsafe fn of<L: Lanes>(self, v: &[u32; 4]) -> u32;
}

/// The territory of one who is alone. The ghost is own, too: there is nothing to look for.
#[derive(Clone, Copy)]
pub(super) struct Everywhere;

impl Territory for Everywhere {
    #[inline(always)]
    unsafe fn of<L: Lanes>(self, _: &[u32; 4]) -> u32 {
        0b1111
    }
}

/// One of several territories: vertices with ids next to each other.
#[derive(Clone, Copy)]
pub(super) struct Ids {
    first: u32,
    count: u32,
}

impl Ids {
    /// The vertices from `first` to before `end`.
    pub fn new(first: u32, end: u32) -> Self {
        Ids { first, count: end.saturating_sub(first) }
    }
}

impl Territory for Ids {
    #[inline(always)]
    unsafe fn of<L: Lanes>(self, v: &[u32; 4]) -> u32 {
        // The ghost's number is the greatest: it is in no range.
        L::within(v, self.first, self.count)
    }
}

/// One of several territories: vertices with one label.
#[derive(Clone, Copy)]
pub(super) struct Own<'a> {
    /// By vertex, behind the ghost's.
    labels: &'a [u8],
    label: u8,
}

/// The ghost's label.
pub(super) const NOBODY: u8 = u8::MAX;

impl<'a> Own<'a> {
    /// The territory of a label. Labels begin with [`NOBODY`] for the ghost, then there is one for each vertex.
    pub fn new(labels: &'a [u8], label: u8) -> Self {
        assert!(labels.first() == Some(&NOBODY) && label != NOBODY);
        Own { labels, label }
    }
}

impl Territory for Own<'_> {
    #[inline(always)]
    unsafe fn of<L: Lanes>(self, v: &[u32; 4]) -> u32 {
        let is_own = |slot: usize| {
            // The ghost's number is the greatest: one more is 0.
            let at = v[slot].wrapping_add(1) as usize;
            debug_assert!(at < self.labels.len());
            // SAFETY: there is a label for the ghost and each vertex.
            u32::from(unsafe { *self.labels.get_unchecked(at) } == self.label) << slot
        };
        is_own(0) | is_own(1) | is_own(2) | is_own(3)
    }
}
