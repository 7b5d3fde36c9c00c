//! Small numbers for the vertices of a cavity, given while it is [searched](super::search): each tetrahedron that is found brings one vertex that
//! may be new. So that nothing has to be cleared, numbers go on from cavity to cavity.

use crate::leavings::Leavings;
use crate::{memory, Control, Error};

/// The first number of a cavity is a multiple of this: the lowest bits of the first so many count from 0.
pub(super) const ALIGNMENT: u32 = 256;

/// The numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct Labels {
    /// Of each vertex, behind the ghost's: its number in the last cavity that it was in.
    of: Vec<u32>,
    /// The first number of this cavity.
    first: u32,
    /// The next one to be given.
    next: u32,
}

/// The numbers as the search gives them.
#[derive(Clone, Copy)]
pub(super) struct Giver {
    of: *mut u32,
    first: u32,
    next: u32,
}

impl Labels {
    /// Begins with a new cavity among so many vertices.
    #[inline]
    pub fn begin(&mut self, vertices: usize) -> Giver {
        // There are fewer than 2^30 vertices.
        if self.of.len() <= vertices || self.next > 3 << 30 {
            self.make_room(vertices);
        }
        // The first cavity's are greater than 0.
        self.first = (self.next & !(ALIGNMENT - 1)) + ALIGNMENT;
        Giver { of: self.of.as_mut_ptr(), first: self.first, next: self.first }
    }

    #[cold]
    #[inline(never)]
    fn make_room(&mut self, vertices: usize) {
        if self.next > 3 << 30 {
            self.of.fill(0);
            self.next = 0;
        }
        if self.of.len() <= vertices {
            self.of.resize((vertices + 1).next_power_of_two().max(64), 0);
        }
    }

    /// Takes the numbers as given.
    #[inline]
    pub fn end(&mut self, giver: Giver) {
        self.next = giver.next;
    }

    /// The number of a vertex of the cavity.
    ///
    /// # Safety
    /// A vertex of the cavity, or the ghost.
    #[inline(always)]
    pub unsafe fn of(&self, v: u32) -> u32 {
        let entry = v.wrapping_add(1) as usize;
        debug_assert!((self.first..self.next).contains(&self.of[entry]));
        // SAFETY: `begin` made one for the ghost and each vertex.
        unsafe { *self.of.get_unchecked(entry) }
    }

    /// How many vertices of the cavity have numbers.
    #[inline]
    pub fn count(&self) -> usize {
        (self.next - self.first) as usize
    }

    /// The number of a vertex of the cavity, counted from 0.
    #[inline]
    pub fn number(&self, v: u32) -> usize {
        debug_assert!((self.first..self.next).contains(&self.of[v.wrapping_add(1) as usize]));
        self.of[v.wrapping_add(1) as usize].wrapping_sub(self.first) as usize
    }

    /// Whether the ghost is a vertex of the cavity.
    #[inline]
    pub fn has_ghost(&self) -> bool {
        self.of.first().is_some_and(|&label| label >= self.first)
    }

    /// Makes room for more vertices, so that the next search asks for no memory. The numbers that were given stay.
    pub fn reserve_room(&mut self, vertices: usize) -> Result<(), Error> {
        let more = (vertices + 1).next_power_of_two().saturating_sub(self.of.len());
        memory::reserve(&mut self.of, more, "labels")
    }

    /// Room for so many vertices, made in pieces. The numbers that were given stay.
    pub fn grow(&mut self, vertices: usize, control: &Control) -> Result<(), Error> {
        memory::lengthen(&mut self.of, (vertices + 1).next_power_of_two(), 0, "labels", control)
    }

    /// Memory for that many vertices. The numbers that were given are gone then.
    pub fn reserve(&mut self, vertices: usize, control: &Control) -> Result<(), Error> {
        if self.of.len() <= vertices {
            *self = Labels { of: memory::zeroed(vertices + 1, "labels", control)?.keep(), ..Labels::default() };
        }
        Ok(())
    }
}

impl Leavings for Labels {
    fn give_back(&mut self) -> bool {
        self.of.give_back()
    }
}

impl Giver {
    /// Asks for a vertex's number before it is given one.
    #[inline(always)]
    pub fn prefetch(&self, v: u32) {
        memory::prefetch(self.of.wrapping_add(v.wrapping_add(1) as usize));
    }

    /// Gives a vertex a number if it has none.
    ///
    /// # Safety
    /// One of the vertices that room was made for, or the ghost, and the numbers still exist.
    #[inline(always)]
    pub unsafe fn give(&mut self, v: u32) {
        // SAFETY: the caller's promise.
        let entry = unsafe { &mut *self.of.add(v.wrapping_add(1) as usize) };
        let is_new = *entry < self.first;
        *entry = if is_new { self.next } else { *entry };
        self.next += u32::from(is_new);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangulation::topology::GHOST;

    #[test]
    fn every_vertex_of_a_cavity_has_a_number_of_its_own() {
        let mut labels = Labels::default();
        let number = |labels: &mut Labels, vertices: &[u32], among: usize| -> Vec<u32> {
            let mut giver = labels.begin(among);
            // SAFETY: vertices that there is room for.
            vertices.iter().for_each(|&v| unsafe { giver.give(v) });
            labels.end(giver);
            // SAFETY: vertices with numbers.
            vertices.iter().map(|&v| unsafe { labels.of(v) } % ALIGNMENT).collect()
        };
        assert!(!labels.has_ghost());
        assert_eq!(number(&mut labels, &[7, 3, 7, 9, 3], 10), [0, 1, 0, 2, 1]);
        assert!(!labels.has_ghost());
        assert_eq!(number(&mut labels, &[9, GHOST, 7, 9], 1000), [0, 1, 2, 0]);
        assert!(labels.has_ghost());
        assert_eq!(number(&mut labels, &[999, 9], 1000), [0, 1]);
        assert!(!labels.has_ghost());
        // More than the lowest bits tell apart do no harm to the next cavity.
        let many: Vec<u32> = (0..1000).collect();
        assert_eq!(number(&mut labels, &many, 1000)[999], 999 % ALIGNMENT);
        assert_eq!(number(&mut labels, &many[..5], 1000), [0, 1, 2, 3, 4]);
        // When they come to an end.
        labels.next = u32::MAX - ALIGNMENT;
        assert_eq!(number(&mut labels, &[4, GHOST, 3], 1000), [0, 1, 2]);
        assert_eq!(labels.next, ALIGNMENT + 3);
        labels.reserve(5000, &Control::new()).unwrap();
        assert_eq!(number(&mut labels, &[4999, 4], 5000), [0, 1]);
    }
}
