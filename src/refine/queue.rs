//! The queue of bad tetrahedra, the one with the shortest shortest edge first. Entries whose tetrahedron has gone are found out when
//! their turn comes, or its neighbourhood's: a tetrahedron is known by its vertices.
//!
//! Most entries die long before their turn. So they wait unsorted in buckets of about equal length (1.6 % wide), and only the bucket whose
//! turn it is becomes a heap, after its dead have been sorted out. The order is that of one large heap, which took
//! two fifths of the time of a refinement.
//!
//! Among equals vertex ids decide, in order and not as they are stored, so that any triangulation whose vertices are numbered alike is
//! refined alike: `wellspaced/cgal.hpp` does the same.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::geometry::quality::EDGES;
use crate::leavings::{Each, Leavings};
use crate::triangulation::Triangulation;
use crate::{memory, Error};

/// A tetrahedron to be mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Entry {
    /// Bits of the squared length of its shortest edge: for positive numbers they sort as the numbers do.
    shortest: u64,
    /// Its vertices when it was found bad.
    v: [u32; 4],
    /// Where it was stored then.
    t: u32,
}

impl Entry {
    /// Exponent and six bits of the mantissa.
    fn bucket(&self) -> u32 {
        (self.shortest >> 46) as u32
    }

    fn is_live(&self, t: &Triangulation) -> bool {
        t.topology.tet(self.t).v == self.v
    }
}

impl Ord for Entry {
    #[inline]
    fn cmp(&self, other: &Entry) -> Ordering {
        self.shortest.cmp(&other.shortest).then_with(|| {
            let sorted = |mut v: [u32; 4]| {
                v.sort_unstable();
                v
            };
            (sorted(self.v), self.v, self.t).cmp(&(sorted(other.v), other.v, other.t))
        })
    }
}

impl PartialOrd for Entry {
    #[inline]
    fn partial_cmp(&self, other: &Entry) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A priority queue of tetrahedra.
#[derive(Clone, Debug, Default)]
pub struct Queue {
    /// The entries of bucket `current`.
    heap: BinaryHeap<Reverse<Entry>>,
    current: u32,
    /// The entries of all others.
    waiting: Buckets,
    count: usize,
}

impl Leavings for Queue {
    fn give_back(&mut self) -> bool {
        let mut rest = Each(std::mem::take(&mut self.waiting.lists));
        let more = rest.give_back();
        self.waiting.lists = rest.0;
        more || {
            let mut heap = std::mem::take(&mut self.heap).into_vec();
            let more = heap.give_back();
            self.heap = heap.into();
            more
        }
    }
}

/// Entries by bucket.
#[derive(Clone, Debug, Default)]
struct Buckets {
    /// The bucket that stands first, a multiple of 64.
    first: u32,
    lists: Vec<Vec<Entry>>,
    /// A bit for each: whether there is anything in it.
    filled: Vec<u64>,
    /// What the lists have taken, about.
    bytes: usize,
}

impl Buckets {
    #[inline]
    fn push(&mut self, entry: Entry) -> Result<(), Error> {
        let bucket = entry.bucket();
        let place = bucket.wrapping_sub(self.first) as usize;
        let place = if place < self.lists.len() { place } else { self.make_place(bucket) };
        let list = &mut self.lists[place];
        if list.len() == list.capacity() {
            memory::reserve(list, 1, "bad tetrahedra")?;
            self.bytes += list.capacity() * size_of::<Entry>() / 2;
        }
        self.filled[place / 64] |= 1 << (place % 64);
        list.push(entry);
        Ok(())
    }

    /// Makes places up to that of `bucket`, which has none yet.
    #[cold]
    fn make_place(&mut self, bucket: u32) -> usize {
        if self.lists.is_empty() {
            self.first = bucket / 64 * 64;
        }
        if bucket < self.first {
            let more = (self.first - bucket).div_ceil(64);
            self.filled.splice(0..0, (0..more).map(|_| 0));
            self.lists.splice(0..0, (0..64 * more).map(|_| Vec::new()));
            self.first -= 64 * more;
        }
        let place = (bucket - self.first) as usize;
        if place >= self.lists.len() {
            self.filled.resize(place / 64 + 1, 0);
            self.lists.resize_with(64 * self.filled.len(), Vec::new);
        }
        place
    }

    /// The first that is not empty.
    fn first_filled(&self) -> Option<u32> {
        let (word, bits) = self.filled.iter().enumerate().find(|(_, &bits)| bits != 0)?;
        Some(self.first + 64 * word as u32 + bits.trailing_zeros())
    }

    fn take(&mut self, bucket: u32) -> Vec<Entry> {
        let place = bucket.wrapping_sub(self.first) as usize;
        let Some(list) = self.lists.get_mut(place) else { return Vec::new() };
        self.filled[place / 64] &= !(1 << (place % 64));
        self.bytes = self.bytes.saturating_sub(list.capacity() * size_of::<Entry>());
        std::mem::take(list)
    }
}

/// The slots of a tetrahedron's shortest edge and its squared length. Among equals the one of the lowest vertices.
pub fn shortest_edge(t: &Triangulation, tet: u32) -> ([usize; 2], f64) {
    let (v, corners) = (t.topology.tet(tet).v, t.corners(tet));
    let mut best = ([0, 1], f64::INFINITY);
    for [i, j] in EDGES {
        let length = corners[i].distance_squared(corners[j]);
        let vertices = |[i, j]: [usize; 2]| (v[i].min(v[j]), v[i].max(v[j]));
        if length < best.1 || length == best.1 && vertices([i, j]) < vertices(best.0) {
            best = ([i, j], length);
        }
    }
    best
}

impl Queue {
    /// Queues a tetrahedron, whose shortest edge squared that is.
    pub fn push(&mut self, t: &Triangulation, tet: u32, shortest: f64) -> Result<(), Error> {
        let entry = Entry { shortest: shortest.to_bits(), v: t.topology.tet(tet).v, t: tet };
        self.count += 1;
        if entry.bucket() == self.current {
            if self.heap.len() == self.heap.capacity() {
                self.heap.try_reserve(1).map_err(|_| Error::OutOfMemory { what: "bad tetrahedra" })?;
            }
            self.heap.push(Reverse(entry));
            return Ok(());
        }
        self.waiting.push(entry)
    }

    /// The bytes that it has taken, about.
    pub fn bytes(&self) -> usize {
        self.heap.capacity() * size_of::<Entry>() + self.waiting.bytes
    }

    /// The next tetrahedron that still exists.
    pub fn pop(&mut self, t: &Triangulation) -> Result<Option<u32>, Error> {
        loop {
            if let Some(first) = self.waiting.first_filled() {
                if self.heap.is_empty() || first < self.current {
                    self.turn_to(first, t)?;
                    // All of it may have been dead.
                    continue;
                }
            }
            let Some(Reverse(entry)) = self.heap.pop() else { return Ok(None) };
            self.count -= 1;
            if entry.is_live(t) {
                return Ok(Some(entry.t));
            }
        }
    }

    /// Makes a waiting bucket the current one.
    fn turn_to(&mut self, bucket: u32, t: &Triangulation) -> Result<(), Error> {
        if !self.heap.is_empty() {
            for Reverse(entry) in std::mem::take(&mut self.heap) {
                self.waiting.push(entry)?;
            }
        }
        self.current = bucket;
        let mut entries = self.waiting.take(bucket);
        let before = entries.len();
        entries.retain(|entry| entry.is_live(t));
        self.count -= before - entries.len();
        // In place: the two are laid out alike.
        self.heap = entries.into_iter().map(Reverse).collect();
        Ok(())
    }

    /// Entries, dead ones included.
    pub fn len(&self) -> usize {
        self.count
    }
}
