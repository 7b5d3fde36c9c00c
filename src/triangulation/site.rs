//! The triangulation as the hot loops see it: without bounds checks, which would be a fifth of their instructions, and without exclusive
//! borrows, so that several threads can work on one triangulation, each in its own [territory](super::territory).

use std::marker::PhantomData;

use glam::DVec3;

use super::topology::{slot_of, tet_of, Tetrahedron, GHOST};
use super::Triangulation;
use crate::geometry::perturbation::in_conflict;
use crate::geometry::{Filter, Sign};
use crate::memory;

/// Tetrahedra and points.
#[derive(Clone, Copy)]
pub(super) struct Site<'a> {
    tets: *mut Tetrahedron,
    /// Tetrahedra are stored below this.
    room: usize,
    points: &'a [DVec3],
    of: PhantomData<&'a [Tetrahedron]>,
}

// SAFETY: every access is an unsafe call, whose caller promises that no other thread is in its way.
unsafe impl Send for Site<'_> {}
// SAFETY: as above.
unsafe impl Sync for Site<'_> {}

impl<'a> Site<'a> {
    /// A triangulation to read. Nothing may be written through it.
    #[inline]
    pub fn of(t: &'a Triangulation) -> Self {
        let tets = &t.topology.tets[..];
        Site { tets: tets.as_ptr().cast_mut(), room: tets.len(), points: &t.points, of: PhantomData }
    }

    /// Tetrahedra to change, of which there may be as many as the list's memory holds. The list is not to be touched as long as
    /// this is in use.
    #[inline]
    pub fn new(tets: &'a mut Vec<Tetrahedron>, points: &'a [DVec3]) -> Self {
        Site { tets: tets.as_mut_ptr(), room: tets.capacity(), points, of: PhantomData }
    }

    /// How many tetrahedra the memory holds.
    pub fn room(self) -> usize {
        self.room
    }

    /// The points by vertex.
    #[inline(always)]
    pub fn points(self) -> &'a [DVec3] {
        self.points
    }

    /// # Safety
    /// `t` is a live tetrahedron: a start that was checked, or what a live tetrahedron names as its neighbour. No other thread writes it, nor does
    /// this one as long as the reference is in use.
    #[inline(always)]
    pub unsafe fn tet(self, t: u32) -> &'a Tetrahedron {
        debug_assert!((t as usize) < self.room);
        // SAFETY: the caller's promise.
        let tet = unsafe { &*self.tets.add(t as usize) };
        debug_assert!(tet.is_live());
        tet
    }

    /// Asks for a tetrahedron before it is needed.
    #[inline(always)]
    pub fn prefetch(self, t: u32) {
        memory::prefetch(self.tets.wrapping_add(t as usize));
    }

    /// The vertex opposite a face.
    ///
    /// # Safety
    /// As [`tet`](Self::tet), for the face's tetrahedron.
    #[inline(always)]
    pub unsafe fn apex(self, face: u32) -> u32 {
        // SAFETY: the caller's promise.
        unsafe { self.tet(tet_of(face)) }.v[slot_of(face)]
    }

    /// Whether a place has a live tetrahedron.
    ///
    /// # Safety
    /// `t` has been written, and no other thread writes it.
    #[inline(always)]
    pub unsafe fn is_live(self, t: u32) -> bool {
        debug_assert!((t as usize) < self.room);
        // SAFETY: the caller's promise.
        unsafe { &*self.tets.add(t as usize) }.is_live()
    }

    /// # Safety
    /// `t` is below the room, and no other thread has anything to do with it.
    #[inline(always)]
    pub unsafe fn put(self, t: u32, tet: Tetrahedron) {
        debug_assert!((t as usize) < self.room);
        // SAFETY: the caller's promise.
        unsafe { self.tets.add(t as usize).write(tet) };
    }

    /// Changes a tetrahedron's vertices.
    ///
    /// # Safety
    /// As [`put`](Self::put).
    #[inline(always)]
    pub unsafe fn set_vertices(self, t: u32, v: [u32; 4]) {
        debug_assert!((t as usize) < self.room);
        // SAFETY: the caller's promise.
        unsafe { (&raw mut (*self.tets.add(t as usize)).v).write(v) };
    }

    /// Changes whose neighbour a face knows.
    ///
    /// # Safety
    /// The face's tetrahedron is below the room, and no other thread has anything to do with it.
    #[inline(always)]
    pub unsafe fn link(self, face: u32, neighbour: u32) {
        debug_assert!((tet_of(face) as usize) < self.room);
        // SAFETY: the caller's promise.
        unsafe { (&raw mut (*self.tets.add(tet_of(face) as usize)).n[slot_of(face)]).write(neighbour) };
    }

    /// # Safety
    /// `v` is a vertex of a live tetrahedron, and not the ghost.
    #[inline(always)]
    pub unsafe fn point(self, v: u32) -> &'a DVec3 {
        debug_assert!((v as usize) < self.points.len());
        // SAFETY: tetrahedra are made of vertices whose points are stored.
        unsafe { self.points.get_unchecked(v as usize) }
    }

    /// The corners of a tetrahedron without the ghost.
    ///
    /// # Safety
    /// As [`tet`](Self::tet).
    #[inline(always)]
    pub unsafe fn corners(self, t: u32) -> [DVec3; 4] {
        // SAFETY: the caller's promise.
        unsafe {
            let [a, b, c, d] = self.tet(t).v;
            [*self.point(a), *self.point(b), *self.point(c), *self.point(d)]
        }
    }

    /// The corner of a tetrahedron that lies at a point.
    ///
    /// # Safety
    /// As [`tet`](Self::tet).
    #[inline(always)]
    pub unsafe fn vertex_at(self, t: u32, point: DVec3) -> Option<u32> {
        // SAFETY: the caller's promise.
        unsafe { self.tet(t).v.into_iter().find(|&v| v != GHOST && *self.point(v) == point) }
    }

    /// Whether `p` lies inside the circumsphere of tetrahedron `t`, after perturbation; for a ghost, whether it lies beyond the
    /// hull facet, or on its plane and inside its circle.
    ///
    /// # Safety
    /// As [`tet`](Self::tet), and for a ghost it is so for the tetrahedron on the other side of the hull facet too.
    pub unsafe fn conflicts(self, filter: &Filter, t: u32, p: DVec3) -> bool {
        // SAFETY: the caller's promise.
        unsafe {
            let tet = self.tet(t);
            if !tet.is_ghost() {
                return in_conflict(filter, self.corners(t), p);
            }
            let [a, b, c] = [*self.point(tet.v[0]), *self.point(tet.v[1]), *self.point(tet.v[2])];
            match filter.orient3d(a, b, c, p) {
                Sign::Positive => true,
                Sign::Negative => false,
                // On the facet's plane the circle decides, and every sphere through it has the same answer there, perturbed or not:
                // the coefficient of a fourth corner is the orientation of the facet and p, which is 0.
                Sign::Zero => in_conflict(filter, self.corners(tet_of(tet.n[3])), p),
            }
        }
    }
}
