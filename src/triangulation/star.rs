//! A cavity replaced by the star of the new vertex.
//!
//! The new tetrahedra find each other through the edges of the cavity's surface: each occurs once in either direction. The vertices
//! of the surface get small labels, and a square table holds the face that each directed edge belongs to. It is written in one pass
//! and read in a second, without clearing, hashing or branches. Only cavities with more than
//! 256 vertices are sorted instead.

use super::cavity::{zeroed, Cavity};
use super::site::Site;
use super::topology::{slot_of, tet_of, Tetrahedron, EVEN_REST, GHOST, NONE};
use super::Triangulation;

/// A tetrahedron to come: its slots are free only once all of them have been read.
#[derive(Clone, Copy, Debug, Default)]
struct Planned {
    v: [u32; 4],
    /// The face outside the cavity.
    outside: u32,
    /// The slot of the new vertex.
    slot: u8,
    /// The labels of [`REST`]'s slots.
    labels: [u8; 3],
}

/// For each slot `i` the other three, ordered so that `(i, j, k, l)` is an even permutation of the slots.
const REST: [[u8; 3]; 4] = {
    let mut result = [[0; 3]; 4];
    let mut i = 0;
    while i < 4 {
        let j = (i + 1) % 4;
        let [k, l] = EVEN_REST[i][j];
        result[i] = [j as u8, k as u8, l as u8];
        i += 1;
    }
    result
};

/// Scratch memory for one star after another.
#[derive(Clone, Debug, Default)]
pub(super) struct StarBuilder {
    /// Of each vertex, behind the ghost's: the stamp of the star that it got a label in, shifted, and the label.
    labels: Vec<u32>,
    stamp: u32,
    /// The face at each directed edge.
    table: Vec<u32>,
    planned: Vec<Planned>,
    sorted: Vec<(u64, u32)>,
    regions: Vec<u16>,
}

/// Table sizes: most cavities have fewer than 32 vertices.
const SMALL: usize = 32;
const LARGE: usize = 256;
const LABEL_BITS: u32 = LARGE.trailing_zeros();

/// The number of faces on a cavity's surface, which is a triangulated sphere, with that many vertices.
const fn faces_of(vertices: usize) -> usize {
    2 * vertices - 4
}

impl Triangulation {
    /// Replaces the cavity by the star of vertex `new`, whose point is in place. `cavity.created` names the new tetrahedra.
    /// Without `incidence`, `vertex_tet` is left for later.
    #[inline]
    pub(super) fn fill_cavity(&mut self, new: u32, cavity: &mut Cavity, incidence: bool) {
        let topology = &mut self.topology;
        let count = cavity.faces.len();
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
        topology.ghosts += unsafe { cavity.fill(Site::new(&mut topology.tets, &self.points), new) };
        topology.release(&cavity.tets, count);
        if incidence {
            for &t in &cavity.created {
                for v in topology.tet(t).v {
                    if v != GHOST {
                        topology.vertex_tet[v as usize] = t;
                    }
                }
            }
            topology.vertex_tet[new as usize] = cavity.created[0];
        }
        cavity.clear_lists();
    }
}

impl Cavity {
    /// Writes the star of vertex `new` to the places that are listed in `created`, one for each of the cavity's faces; the cavity's own places
    /// come first. Returns how many ghosts it has. The marks are taken back, the lists are not.
    ///
    /// # Safety
    /// The cavity is one of `site` as it is. Its tetrahedra, their neighbours, and what is at the places are nobody else's.
    #[inline]
    pub(super) unsafe fn fill(&mut self, site: Site, new: u32) -> usize {
        let Cavity { marks, tets, faces, created, star, .. } = self;
        debug_assert_eq!(faces.len(), created.len());
        for &t in tets.iter() {
            marks[t as usize] = 0;
        }
        // SAFETY: the caller's promise.
        unsafe {
            match faces.len() {
                n if n <= faces_of(SMALL) => star.build::<SMALL>(site, new, faces, created),
                n if n <= faces_of(LARGE) => star.build::<LARGE>(site, new, faces, created),
                _ => star.build_by_sorting(site, new, faces, created),
            }
        }
    }
}

/// `v` with `new` in a slot. Masked, so that there is neither a branch nor a wide read of what was just written in parts.
#[inline(always)]
fn with(v: [u32; 4], slot: usize, new: u32) -> [u32; 4] {
    const MASK: [[u32; 4]; 4] = [[!0, 0, 0, 0], [0, !0, 0, 0], [0, 0, !0, 0], [0, 0, 0, !0]];
    let mask = MASK[slot];
    let select = |i: usize| (v[i] & !mask[i]) | (new & mask[i]);
    [select(0), select(1), select(2), select(3)]
}

impl StarBuilder {
    /// # Safety
    /// As [`Cavity::fill`].
    unsafe fn build<const SIZE: usize>(&mut self, site: Site, new: u32, faces: &[u32], created: &[u32]) -> usize {
        let vertices = site.points().len();
        if self.labels.len() < vertices + 1 {
            self.labels.resize((vertices + 1).next_power_of_two().max(64), 0);
        }
        if self.table.len() < SIZE * SIZE {
            self.table.resize(SIZE * SIZE, NONE);
        }
        self.stamp += 1;
        if self.stamp >> (u32::BITS - LABEL_BITS) != 0 {
            self.labels.fill(0);
            self.stamp = 1;
        }
        let stamp = self.stamp << LABEL_BITS;
        let table = &mut self.table[..SIZE * SIZE];
        let at = |k: u8, l: u8| k as usize % SIZE * SIZE + l as usize % SIZE;
        if self.planned.len() < faces.len() {
            self.planned.resize(2 * faces.len(), Planned::default());
        }
        let planned = &mut self.planned[..faces.len()];
        let labels = &mut self.labels[..];
        let mut count = 0;
        // The ghost's entry is the first.
        let mut label = |v: u32| {
            let entry = &mut labels[v.wrapping_add(1) as usize];
            let fresh = *entry < stamp;
            let label = if fresh { stamp + count } else { *entry };
            count += u32::from(fresh);
            *entry = label;
            label as u8
        };
        for ((&face, &t), planned) in faces.iter().zip(created).zip(planned.iter_mut()) {
            // SAFETY: a tetrahedron of the cavity.
            let (tet, slot) = (unsafe { site.tet(tet_of(face)) }, slot_of(face));
            let [i, j, k] = REST[slot].map(|i| i as usize & 3);
            let (a, b, c) = (label(tet.v[i]), label(tet.v[j]), label(tet.v[k]));
            table[at(b, c)] = 4 * t + i as u32;
            table[at(c, a)] = 4 * t + j as u32;
            table[at(a, b)] = 4 * t + k as u32;
            planned.v = with(tet.v, slot, new);
            planned.outside = tet.n[slot];
            planned.slot = slot as u8;
            planned.labels = [a, b, c];
        }
        debug_assert_eq!(faces.len(), faces_of(count as usize));
        let mut ghosts = 0;
        for (planned, &t) in planned.iter().zip(created) {
            let &Planned { v, outside, slot, labels: [a, b, c] } = planned;
            let slot = slot as usize & 3;
            let [i, j, k] = REST[slot].map(|i| i as usize & 3);
            ghosts += usize::from(v[3] == GHOST);
            // SAFETY: a place of the star, and a neighbour of the cavity.
            unsafe {
                // Not a whole tetrahedron at once: it would be read just after it was written in parts.
                site.set_vertices(t, v);
                site.link(4 * t + slot as u32, outside);
                site.link(4 * t + i as u32, table[at(c, b)]);
                site.link(4 * t + j as u32, table[at(a, c)]);
                site.link(4 * t + k as u32, table[at(b, a)]);
                site.link(outside, 4 * t + slot as u32);
            }
        }
        ghosts
    }

    /// For stars of any size: the two faces of an edge become neighbours in sorted order.
    ///
    /// # Safety
    /// As [`Cavity::fill`].
    #[cold]
    unsafe fn build_by_sorting(&mut self, site: Site, new: u32, faces: &[u32], created: &[u32]) -> usize {
        let plan = |&face: &u32| {
            // SAFETY: a tetrahedron of the cavity.
            let (tet, slot) = (unsafe { site.tet(tet_of(face)) }, slot_of(face));
            Planned { v: with(tet.v, slot, new), outside: tet.n[slot], slot: slot as u8, labels: [0; 3] }
        };
        self.planned.clear();
        self.planned.extend(faces.iter().map(plan));
        self.sorted.clear();
        let mut ghosts = 0;
        for (planned, &t) in self.planned.iter().zip(created) {
            let slot = planned.slot as usize;
            ghosts += usize::from(planned.v[3] == GHOST);
            // SAFETY: a place of the star, and a neighbour of the cavity.
            unsafe {
                site.put(t, Tetrahedron { v: planned.v, n: [planned.outside; 4] });
                site.link(planned.outside, 4 * t + slot as u32);
            }
            for j in REST[slot].map(usize::from) {
                let [k, l] = EVEN_REST[slot][j].map(|i| planned.v[i]);
                self.sorted.push((u64::from(k.min(l)) << 32 | u64::from(k.max(l)), 4 * t + j as u32));
            }
        }
        self.sorted.sort_unstable();
        for pair in self.sorted.chunks_exact(2) {
            debug_assert_eq!(pair[0].0, pair[1].0);
            // SAFETY: places of the star.
            unsafe {
                site.link(pair[0].1, pair[1].1);
                site.link(pair[1].1, pair[0].1);
            }
        }
        ghosts
    }

    /// Memory for stars among that many vertices, or `false` where there is none.
    pub fn reserve(&mut self, vertices: usize) -> bool {
        self.labels.len() > vertices || zeroed(vertices + 1).map(|labels| self.labels = labels).is_some()
    }
}
