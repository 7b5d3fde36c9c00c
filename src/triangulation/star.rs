//! A cavity replaced by the star of the new vertex.
//!
//! The new tetrahedra find each other through the edges of the cavity's surface: each occurs once in either direction. The vertices
//! of the surface have small [labels](super::labels), and a square table holds the face that each directed edge belongs to. It is written in
//! one pass and read in a second, without clearing, hashing or branches. Only cavities with more than
//! 256 vertices are [planned ahead](super::large_star) instead.

use std::mem::MaybeUninit;

use super::cavity::Cavity;
use super::labels::{Labels, ALIGNMENT};
use super::large_star::LargeStar;
use super::site::Site;
use super::topology::{slot_of, tet_of, NONE};
use super::Triangulation;
use crate::{Control, Error};

/// A tetrahedron to come: its place is free only once all of them have been read.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
struct Planned {
    v: [u32; 4],
    /// The face outside the cavity.
    outside: u32,
    /// The labels of the vertices beside the new one, in the order of [`REST`], eight bits each.
    labels: u32,
}

/// Slots `i` and the three others, which are `i` xor each of these: in this order an even permutation.
pub(super) const REST: [usize; 3] = [1, 2, 3];

/// Scratch memory for one star after another.
#[derive(Clone, Debug, Default)]
pub(super) struct StarBuilder {
    /// For large cavities: the face at each directed edge.
    table: Vec<u32>,
    planned: Vec<Planned>,
    /// For larger ones.
    pub(super) large: LargeStar,
    /// Those of what a new tetrahedron comes from.
    pub(super) regions: Vec<u16>,
}

/// Table sizes: most cavities have fewer than 32 vertices.
const SMALL: usize = 32;
const LARGE: usize = ALIGNMENT as usize;

/// The number of faces on a cavity's surface, which is a triangulated sphere, with that many vertices.
const fn faces_of(vertices: usize) -> usize {
    2 * vertices - 4
}

impl Triangulation {
    /// Replaces the cavity by the star of vertex `new`, whose point is in place. `cavity.created` names the new tetrahedra.
    /// Without `incidence`, `vertex_tet` is left for later. What [`Cavity::plan`] plans is planned. Only where it was planned the control
    /// [is looked at](Self::fill_large).
    #[inline]
    pub(super) fn fill_cavity(
        &mut self,
        new: u32,
        cavity: &mut Cavity,
        incidence: bool,
        control: &Control,
    ) -> Result<(), Error> {
        if cavity.planned {
            return self.fill_large(new, cavity, incidence, control);
        }
        let topology = &mut self.topology;
        let count = cavity.faces.len();
        if cavity.labels.has_ghost() {
            topology.ghosts -= cavity.tets.iter().filter(|&&t| topology.tet(t).is_ghost()).count();
        }
        topology.allocate(&cavity.tets, count, &mut cavity.created);
        if !topology.region.is_empty() {
            // Slots are reused at once: read the labels before they are overwritten.
            let regions = &mut cavity.star.regions;
            regions.clear();
            regions.extend(cavity.faces.iter().map(|&face| topology.region[tet_of(face) as usize]));
            for (&t, &region) in cavity.created.iter().zip(regions.iter()) {
                topology.region[t as usize] = region;
            }
        }
        // SAFETY: the cavity is one of this triangulation, which has not changed since, and this is its only user.
        topology.ghosts += unsafe { cavity.fill(Site::new(&mut topology.tets, &self.points), new, control) }?;
        topology.release(&cavity.tets, count);
        if incidence {
            topology.name_incident(&cavity.created);
            topology.vertex_tet[new as usize] = cavity.created[0];
        }
        cavity.clear_lists();
        Ok(())
    }
}

impl Cavity {
    /// Plans the star that replaces it, if it is a large one and no plan is there yet. After an error, that of a cancellation perhaps, the cavity is as it was.
    ///
    /// # Safety
    /// The cavity is one of `site` as it is.
    #[inline]
    pub(super) unsafe fn plan(&mut self, site: Site, control: &Control) -> Result<(), Error> {
        if self.faces.len() > faces_of(LARGE) && !self.planned {
            // SAFETY: the caller's promise.
            unsafe { self.star.large.plan(site, &self.faces, &self.labels, control) }?;
            self.planned = true;
        }
        Ok(())
    }

    /// Writes the star of vertex `new` to the places that are listed in `created`, one for each of the cavity's faces; the cavity's own places
    /// come first. Returns how many ghosts it has. The marks are taken back, the lists are not. Where the control says stop, which only a planned one asks,
    /// some of the star is written and the rest is not.
    ///
    /// # Safety
    /// The cavity is one of `site` as it is, and [planned](Self::plan). Its tetrahedra, their neighbours, and what is at the places are nobody else's.
    #[inline]
    pub(super) unsafe fn fill(&mut self, site: Site, new: u32, control: &Control) -> Result<usize, Error> {
        self.unmark();
        let Cavity { faces, created, star, labels, planned, .. } = self;
        debug_assert_eq!(faces.len(), created.len());
        debug_assert!(*planned || faces.len() <= faces_of(LARGE));
        // SAFETY: the caller's promise.
        unsafe {
            match faces.len() {
                n if n <= faces_of(SMALL) => build_small(site, new, faces, created, labels),
                n if n <= faces_of(LARGE) => star.build_large(site, new, faces, created, labels),
                _ => return star.large.write(site, new, faces, created, control),
            }
            if !labels.has_ghost() {
                return Ok(0);
            }
            Ok(created.iter().filter(|&&t| site.tet(t).is_ghost()).count())
        }
    }
}

/// For cavities of ordinary size. What it needs lies on the stack, where no register is needed to find it.
///
/// # Safety
/// As [`Cavity::fill`], and there are at most `faces_of(SMALL)` faces.
unsafe fn build_small(site: Site, new: u32, faces: &[u32], created: &[u32], labels: &Labels) {
    let mut table = MaybeUninit::<[u32; SMALL * SMALL]>::uninit();
    let mut planned = MaybeUninit::<[Planned; faces_of(SMALL)]>::uninit();
    let (table, planned) = (table.as_mut_ptr().cast(), planned.as_mut_ptr().cast());
    // SAFETY: the caller's promise.
    unsafe { build::<SMALL>(site, new, (faces, created), labels, table, planned) };
}

/// # Safety
/// As [`Cavity::fill`], and there are at most `faces_of(SIZE)` faces, so that they have at most `SIZE` vertices. In `table` there is room for a
/// square of that many elements, in `planned` for all faces.
#[inline(always)]
unsafe fn build<const SIZE: usize>(
    site: Site,
    new: u32,
    (faces, created): (&[u32], &[u32]),
    labels: &Labels,
    table: *mut u32,
    planned: *mut Planned,
) {
    debug_assert!(faces.len() <= faces_of(SIZE));
    // A power of two. As an alternative of bits, not as a sum, whose terms the compiler would add to the address one by one.
    let at = |k: u32, l: u32| ((k % SIZE as u32 * SIZE as u32) | (l % SIZE as u32)) as usize;
    for (i, (&face, &t)) in faces.iter().zip(created).enumerate() {
        // SAFETY: a tetrahedron of the cavity, whose vertices have labels. There is room.
        unsafe {
            let (tet, slot) = (site.tet(tet_of(face)), slot_of(face));
            let rest = REST.map(|other| slot ^ other);
            let [a, b, c] = [labels.of(tet.v[rest[0]]), labels.of(tet.v[rest[1]]), labels.of(tet.v[rest[2]])];
            table.add(at(b, c)).write(4 * t + rest[0] as u32);
            table.add(at(c, a)).write(4 * t + rest[1] as u32);
            table.add(at(a, b)).write(4 * t + rest[2] as u32);
            let planned = planned.add(i);
            // It is read again much later: writing it in parts costs nothing.
            (&raw mut (*planned).v).write(tet.v);
            (&raw mut (*planned).v[slot]).write(new);
            (&raw mut (*planned).outside).write(tet.n[slot]);
            (&raw mut (*planned).labels).write(a & 0xff | (b & 0xff) << 8 | c << 16);
        }
    }
    for (i, (&face, &t)) in faces.iter().zip(created).enumerate() {
        // SAFETY: the plans have been written, and so have all entries of the table, because the surface is closed. A place of the star, and
        // a neighbour of the cavity.
        unsafe {
            let planned = planned.add(i);
            let slot = slot_of(face) as u32;
            let rest = REST.map(|other| slot ^ other as u32);
            let (labels, outside) = ((*planned).labels, (*planned).outside);
            let (a, b, c) = (labels, labels >> 8, labels >> 16);
            // Not a whole tetrahedron at once: it would be read just after it was written in parts.
            site.set_vertices(t, (*planned).v);
            site.link(4 * t + slot, outside);
            site.link(4 * t + rest[0], table.add(at(c, b)).read());
            site.link(4 * t + rest[1], table.add(at(a, c)).read());
            site.link(4 * t + rest[2], table.add(at(b, a)).read());
            site.link(outside, 4 * t + slot);
        }
    }
}

impl StarBuilder {
    /// For larger ones.
    ///
    /// # Safety
    /// As [`Cavity::fill`], and there are at most `faces_of(LARGE)` faces.
    #[cold]
    unsafe fn build_large(&mut self, site: Site, new: u32, faces: &[u32], created: &[u32], labels: &Labels) {
        self.table.resize(LARGE * LARGE, NONE);
        self.planned.resize(faces_of(LARGE), Planned::default());
        let (table, planned) = (self.table.as_mut_ptr(), self.planned.as_mut_ptr());
        // SAFETY: the caller's promise.
        unsafe { build::<LARGE>(site, new, (faces, created), labels, table, planned) };
    }
}
