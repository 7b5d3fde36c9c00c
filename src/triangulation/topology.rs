//! The combinatorial side of the triangulation: tetrahedra, their adjacency, and the free list. It knows no coordinates.
//!
//! Every facet of the hull is joined to one *ghost* vertex, as in Shewchuk's and most later codes, so that
//! each tetrahedron has four neighbours and the whole is a triangulated 3-sphere. The ghost always stands in slot 3.
//! A tetrahedron's four vertices and four neighbours fill half a cache line. A neighbour entry is a
//! *face handle* `4·tetrahedron + slot`, which also names the face as the neighbour sees it, so that no search is needed on
//! the way back (C. Marot, J. Pellerin, J.-F. Remacle, "One machine, one minute, three billion tetrahedra", IJNME 117, 2019).

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::incident::StarWalk;
use crate::leavings::{InPieces, Leavings};
use crate::threads::share_out;
use crate::{memory, Control, Error};

/// The vertex at infinity.
pub const GHOST: u32 = u32::MAX;
/// In slot 0 of a tetrahedron that is on the free list.
const DEAD: u32 = u32::MAX - 1;
/// No face, no tetrahedron.
pub const NONE: u32 = u32::MAX;
/// Face handles have 32 bits.
pub const MAX_TETRAHEDRA: usize = 1 << 30;
/// Vertex ids stay clear of the marks that [`Cavity`](super::cavity::Cavity) keeps among them.
pub const MAX_VERTICES: usize = 1 << 30;

/// `faces[i]` is the face opposite vertex `v[i]`, as its other side's handle.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Tetrahedron {
    /// Vertex ids, positively oriented. With the ghost in slot 3, any point beyond the face `v[0..3]` in its place makes
    /// the tetrahedron positive.
    pub v: [u32; 4],
    /// Handle of the same face in the neighbour opposite each vertex.
    pub n: [u32; 4],
}

/// The tetrahedron of a face handle.
#[inline]
pub fn tet_of(face: u32) -> u32 {
    face >> 2
}

/// The slot opposite the face of a handle.
#[inline]
pub fn slot_of(face: u32) -> usize {
    (face & 3) as usize
}

/// For slots `i ≠ j` the other two, ordered so that `(i, j, k, l)` is an even permutation of the slots.
pub const EVEN_REST: [[[usize; 2]; 4]; 4] = {
    let none = [0, 0];
    [
        [none, [2, 3], [3, 1], [1, 2]],
        [[3, 2], none, [0, 3], [2, 0]],
        [[1, 3], [3, 0], none, [0, 1]],
        [[2, 1], [0, 2], [1, 0], none],
    ]
};

impl Tetrahedron {
    /// One on the free list.
    pub(super) const DEAD: Tetrahedron = Tetrahedron { v: [DEAD; 4], n: [NONE; 4] };

    /// Whether it hangs on the hull's outside.
    #[inline]
    pub fn is_ghost(&self) -> bool {
        self.v[3] == GHOST
    }

    /// Whether it is in the triangulation.
    #[inline]
    pub fn is_live(&self) -> bool {
        self.v[0] != DEAD
    }

    /// The slot of `vertex`.
    #[inline]
    pub fn slot(&self, vertex: u32) -> Option<usize> {
        self.v.iter().position(|&v| v == vertex)
    }

    /// The vertices of the face opposite a slot.
    #[inline]
    pub fn face(&self, slot: usize) -> [u32; 3] {
        const FACE: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
        FACE[slot].map(|i| self.v[i])
    }
}

/// All tetrahedra, an incident one of each vertex, and what regions they belong to.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    /// Live and free ones.
    pub tets: Vec<Tetrahedron>,
    /// A tetrahedron at each vertex, [`NONE`] for removed vertices and below dimension 3.
    pub vertex_tet: Vec<u32>,
    /// One label a tetrahedron, inherited by what replaces it; empty until a domain asks for labels.
    pub region: Vec<u16>,
    pub(super) free: Vec<u32>,
    pub(super) ghosts: usize,
}

impl Topology {
    /// Finite and ghost tetrahedra.
    pub fn live_count(&self) -> usize {
        self.tets.len() - self.free.len()
    }

    /// Tetrahedra without the ghost.
    pub fn finite_count(&self) -> usize {
        self.live_count() - self.ghosts
    }

    /// The tetrahedron of an index.
    #[inline]
    pub fn tet(&self, t: u32) -> &Tetrahedron {
        &self.tets[t as usize]
    }

    /// The same of a place that there may not be: when a copy has taken the place of what has grown meanwhile.
    #[inline]
    pub fn get(&self, t: u32) -> Option<&Tetrahedron> {
        self.tets.get(t as usize)
    }

    /// Whether the labels on the two sides of a face differ, that opposite a slot. Not where there are none.
    #[inline]
    pub fn labels_differ(&self, t: u32, slot: usize) -> bool {
        !self.same_label(t, tet_of(self.tet(t).n[slot]))
    }

    /// Whether two tetrahedra have the same label, or there are none.
    #[inline]
    pub fn same_label(&self, a: u32, b: u32) -> bool {
        let label = |t: u32| self.region.get(t as usize);
        label(a) == label(b)
    }

    /// Asks for a tetrahedron before it is needed.
    #[inline]
    pub fn prefetch(&self, t: u32) {
        memory::prefetch(self.tets.as_ptr().wrapping_add(t as usize));
    }

    /// The live tetrahedra's indices, in storage order.
    pub fn live(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.tets.len() as u32).filter(|&t| self.tet(t).is_live())
    }

    /// The tetrahedra without the ghost.
    pub fn finite(&self) -> impl Iterator<Item = u32> + '_ {
        self.live().filter(|&t| !self.tet(t).is_ghost())
    }

    /// Whether `count` more tetrahedra can be named.
    pub fn has_room(&self, count: usize) -> bool {
        self.tets.len() + count <= self.free.len() + MAX_TETRAHEDRA
    }

    /// Memory for `count` more tetrahedra and a vertex.
    #[inline]
    pub fn reserve(&mut self, count: usize) -> Result<(), Error> {
        let room = |capacity: usize, len: usize| capacity - len + self.free.len() >= count;
        let regions = self.region.is_empty() || room(self.region.capacity(), self.region.len());
        if room(self.tets.capacity(), self.tets.len()) && regions && self.vertex_tet.len() < self.vertex_tet.capacity()
        {
            return Ok(());
        }
        self.grow(count)
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self, count: usize) -> Result<(), Error> {
        memory::reserve(&mut self.tets, count, "tetrahedra")?;
        if !self.region.is_empty() {
            memory::reserve(&mut self.region, count, "regions")?;
        }
        memory::reserve(&mut self.vertex_tet, 1, "vertices")
    }

    /// A copy with room for so many more tetrahedra, unless memory is lacking or the control says stop.
    pub(super) fn try_clone(&self, more: usize, control: &Control) -> Result<Topology, Error> {
        let mut copy = InPieces::new(Topology { ghosts: self.ghosts, ..Topology::default() }, control);
        copy.tets = memory::copied_with_room(&self.tets, more, "tetrahedra", control)?;
        copy.vertex_tet = memory::copied(&self.vertex_tet, "vertices", control)?;
        copy.region = memory::copied(&self.region, "regions", control)?;
        copy.free = memory::copied(&self.free, "tetrahedra", control)?;
        Ok(copy.keep())
    }

    /// Forgets everything but keeps the memory.
    pub(super) fn clear(&mut self) {
        self.vertex_tet.clear();
        self.clear_tetrahedra();
    }

    /// Bytes taken, and to be taken soon.
    pub(super) fn bytes(&self) -> usize {
        memory::bytes(&self.tets)
            + memory::bytes(&self.vertex_tet)
            + memory::bytes(&self.region)
            + memory::bytes(&self.free)
    }

    /// A tetrahedron with these vertices and no neighbours yet.
    #[inline]
    pub fn create(&mut self, v: [u32; 4]) -> u32 {
        debug_assert!(v[..3].iter().all(|&v| v < DEAD));
        self.ghosts += usize::from(v[3] == GHOST);
        let tet = Tetrahedron { v, n: [NONE; 4] };
        match self.free.pop() {
            Some(t) => {
                self.tets[t as usize] = tet;
                t
            }
            None => {
                self.tets.push(tet);
                if !self.region.is_empty() {
                    self.region.push(0);
                }
                self.tets.len() as u32 - 1
            }
        }
    }

    /// Gives a tetrahedron's slot back.
    #[inline]
    pub fn destroy(&mut self, t: u32) {
        let tet = &mut self.tets[t as usize];
        debug_assert!(tet.is_live());
        self.ghosts -= usize::from(tet.is_ghost());
        tet.v = [DEAD; 4];
        self.free.push(t);
    }

    /// Finds slots for `count` tetrahedra: those of the tetrahedra in `old`, which are still to be read and then to be
    /// written over, free ones, and new ones. Ghosts among the old ones are not counted off.
    #[inline]
    pub(super) fn allocate(&mut self, old: &[u32], count: usize, slots: &mut Vec<u32>) {
        slots.clear();
        slots.extend_from_slice(&old[..old.len().min(count)]);
        while slots.len() < count {
            slots.push(match self.free.pop() {
                Some(t) => t,
                None => {
                    self.tets.push(Tetrahedron::DEAD);
                    if !self.region.is_empty() {
                        self.region.push(0);
                    }
                    self.tets.len() as u32 - 1
                }
            });
        }
    }

    /// [`allocate`](Self::allocate) in pieces. Where memory is lacking or the control says stop, half of it may be done.
    pub(super) fn allocate_within(
        &mut self,
        old: &[u32],
        count: usize,
        slots: &mut Vec<u32>,
        control: &Control,
    ) -> Result<(), Error> {
        const PART: usize = 1 << 12;
        slots.clear();
        memory::reserve(slots, count, "star")?;
        let mut part = Vec::new();
        while slots.len() < count {
            control.check()?;
            let next = &old[slots.len().min(old.len())..];
            self.allocate(&next[..next.len().min(PART)], PART.min(count - slots.len()), &mut part);
            slots.extend_from_slice(&part);
        }
        Ok(())
    }

    /// Frees those slots that [`allocate`](Self::allocate) had no use for. The first will be the first to be used.
    #[inline]
    pub(super) fn release(&mut self, old: &[u32], used: usize) {
        for &t in old.iter().skip(used).rev() {
            self.tets[t as usize].v = [DEAD; 4];
            self.free.push(t);
        }
    }

    /// Has each vertex of these tetrahedra name the last one of them that has it.
    #[inline]
    pub(super) fn name_incident(&mut self, tets: &[u32]) {
        for &t in tets {
            for v in self.tet(t).v {
                if v != GHOST {
                    self.vertex_tet[v as usize] = t;
                }
            }
        }
    }

    /// Makes two faces each other's neighbours.
    #[inline]
    pub fn join(&mut self, f: u32, g: u32) {
        self.tets[tet_of(f) as usize].n[slot_of(f)] = g;
        self.tets[tet_of(g) as usize].n[slot_of(g)] = f;
    }

    /// The tetrahedra around the edge in slots `i` and `j` of tetrahedron `t`, beginning with `t`: each with the slots `k` and `l` of its other two
    /// vertices, so that `(vᵢ, vⱼ, vₖ, vₗ)` is even. The next one lies across the face opposite `vₖ`.
    pub fn around_edge(&self, t: u32, i: usize, j: usize) -> AroundEdge<'_> {
        let tet = self.tet(t);
        let [k, _] = EVEN_REST[i][j];
        AroundEdge { topology: self, p: tet.v[i], q: tet.v[j], start: t, next: Some((t, k)) }
    }

    /// A tetrahedron with both vertices, and their slots in it. Linear in the smaller one of their stars.
    pub fn find_edge(&self, p: u32, q: u32) -> Option<(u32, usize, usize)> {
        let t = self.find_tet([p, q])?;
        let tet = self.tet(t);
        Some((t, tet.slot(p)?, tet.slot(q)?))
    }

    /// A handle of the face with these vertices, from one of its two sides; `None` when they span no face. Linear in the smallest one of
    /// their stars.
    pub fn find_face(&self, face: [u32; 3]) -> Option<u32> {
        let t = self.find_tet(face)?;
        let slot = self.tet(t).v.iter().position(|v| !face.contains(v))?;
        Some(4 * t + slot as u32)
    }

    /// A tetrahedron with all of these vertices.
    fn find_tet<const N: usize>(&self, vertices: [u32; N]) -> Option<u32> {
        /// So many tetrahedra of one star are looked through before others are tried: most stars are smaller.
        const FIRST: usize = 16;
        let mut walks = vertices.map(|v| (v != GHOST).then(|| StarWalk::new(self, v)));
        if walks.iter().all(Option::is_none) {
            return None;
        }
        let mut turns = FIRST;
        loop {
            for walk in walks.iter_mut().flatten() {
                for _ in 0..turns {
                    // The whole star of one of them is enough.
                    let t = walk.next(self)?;
                    let v = self.tet(t).v;
                    if vertices.iter().all(|x| v.contains(x)) {
                        return Some(t);
                    }
                }
            }
            turns = turns.saturating_mul(2);
        }
    }

    /// The tetrahedra at a vertex, ghosts included, in the order of a breadth-first walk.
    pub fn star(&self, vertex: u32) -> Vec<u32> {
        StarWalk::new(self, vertex).all(self)
    }

    /// Renumbers the vertices: `new_id[v]` replaces `v`. `vertex_tet` is rebuilt for `count` vertices. Where memory is lacking or the control says
    /// stop, half of it may be done.
    pub fn renumber(&mut self, new_id: &[u32], count: usize, threads: usize, control: &Control) -> Result<(), Error> {
        const PART: usize = 1 << 13;
        // First by old ids, which are neighbours in memory where the vertices are in space. The first of a vertex's tetrahedra counts, whoever
        // comes first, and most of the others need but a look.
        let mut incident = memory::room_in_pieces(new_id.len(), "vertices", control)?;
        for block in new_id.chunks(PART) {
            control.check()?;
            incident.extend(block.iter().map(|_| AtomicU32::new(NONE)));
        }
        let watch = control.watch();
        share_out(threads, self.tets.chunks_mut(PART).enumerate(), |(part, tets)| {
            if !watch.poll() {
                return;
            }
            for (tet, t) in tets.iter_mut().zip((part * PART) as u32..) {
                if !tet.is_live() {
                    continue;
                }
                for v in &mut tet.v {
                    if *v != GHOST {
                        let first = &incident[*v as usize];
                        if first.load(Relaxed) > t {
                            first.fetch_min(t, Relaxed);
                        }
                        *v = new_id[*v as usize];
                    }
                }
            }
        });
        watch.end()?;
        self.vertex_tet.clear();
        memory::lengthen(&mut self.vertex_tet, count, NONE, "vertices", control)?;
        for (incident, new_id) in incident.chunks(PART).zip(new_id.chunks(PART)) {
            control.check()?;
            for (t, &v) in incident.iter().zip(new_id) {
                let t = t.load(Relaxed);
                if t != NONE {
                    self.vertex_tet[v as usize] = t;
                }
            }
        }
        Ok(())
    }

    /// A copy without gaps among the tetrahedra, and the vertices renumbered as by [`renumber`](Self::renumber); and the new place of tetrahedron
    /// `keep`.
    pub fn compacted(
        &self,
        new_id: &[u32],
        count: usize,
        keep: u32,
        control: &Control,
    ) -> Result<(Topology, u32), Error> {
        const PART: usize = 1 << 12;
        let mut place = memory::room_in_pieces::<u32>(self.tets.len(), "tetrahedra", control)?;
        let mut live = 0;
        for part in self.tets.chunks(PART) {
            control.check()?;
            place.extend(part.iter().map(|tet| {
                live += u32::from(tet.is_live());
                if tet.is_live() {
                    live - 1
                } else {
                    NONE
                }
            }));
        }
        let mut copy = InPieces::new(Topology { ghosts: self.ghosts, ..Topology::default() }, control);
        memory::reserve_exact(&mut copy.tets, self.live_count(), "tetrahedra")?;
        if !self.region.is_empty() {
            memory::reserve_exact(&mut copy.region, self.live_count(), "regions")?;
        }
        for (i, part) in self.tets.chunks(PART).enumerate() {
            control.check()?;
            copy.tets.extend(part.iter().filter(|tet| tet.is_live()).map(|tet| Tetrahedron {
                v: tet.v,
                n: tet.n.map(|face| 4 * place[tet_of(face) as usize] + slot_of(face) as u32),
            }));
            if let Some(labels) = self.region.get(i * PART..) {
                let live = part.iter().zip(labels).filter(|(tet, _)| tet.is_live());
                copy.region.extend(live.map(|(_, &label)| label));
            }
        }
        memory::reserve_exact(&mut copy.vertex_tet, count, "vertices")?;
        copy.renumber(new_id, count, 1, control)?;
        Ok((copy.keep(), place.get(keep as usize).copied().unwrap_or(0)))
    }

    /// Forgets all tetrahedra but no vertex.
    pub fn clear_tetrahedra(&mut self) {
        self.tets.clear();
        self.free.clear();
        self.region.clear();
        self.ghosts = 0;
        self.vertex_tet.fill(NONE);
    }
}

impl Leavings for Topology {
    fn give_back(&mut self) -> bool {
        let Topology { tets, vertex_tet, region, free, .. } = self;
        tets.give_back() || vertex_tet.give_back() || region.give_back() || free.give_back()
    }
}

/// Iterator of [`Topology::around_edge`].
pub struct AroundEdge<'a> {
    topology: &'a Topology,
    p: u32,
    q: u32,
    start: u32,
    next: Option<(u32, usize)>,
}

impl Iterator for AroundEdge<'_> {
    type Item = (u32, usize, usize);

    fn next(&mut self) -> Option<Self::Item> {
        let (t, k) = self.next?;
        let tet = self.topology.tet(t);
        let l = (0..4).find(|&l| l != k && tet.v[l] != self.p && tet.v[l] != self.q)?;
        let across = tet.n[k];
        let next = tet_of(across);
        self.next = (next != self.start).then(|| {
            // The vertex to leave behind there is the one that both share: v[l].
            let slot = self.topology.tet(next).slot(tet.v[l]);
            debug_assert!(slot.is_some());
            (next, slot.unwrap_or(0))
        });
        Some((t, k, l))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_rest_is_even() {
        for (i, row) in EVEN_REST.iter().enumerate() {
            for j in (0..4).filter(|&j| j != i) {
                let [k, l] = row[j];
                let p = [i, j, k, l];
                let inversions =
                    (0..4).flat_map(|a| (a + 1..4).map(move |b| (a, b))).filter(|&(a, b)| p[a] > p[b]).count();
                assert_eq!(inversions % 2, 0, "{p:?}");
                let mut sorted = p;
                sorted.sort_unstable();
                assert_eq!(sorted, [0, 1, 2, 3]);
            }
        }
    }
}
