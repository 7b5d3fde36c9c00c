//! The queue of bad tetrahedra, the one with the shortest shortest edge first. Entries whose tetrahedron has gone are found out when
//! their turn comes, or its neighbourhood's: a tetrahedron is known by its vertices.
//!
//! Most entries die long before their turn. So they wait unsorted in buckets of about equal length (1.6 % wide), and only the bucket whose
//! turn it is becomes a heap, after its dead have been sorted out. The order is that of one large heap, which took
//! two fifths of the time of a refinement.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use crate::geometry::quality::EDGES;
use crate::triangulation::Triangulation;

/// A tetrahedron to be mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
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

/// A priority queue of tetrahedra.
#[derive(Clone, Debug, Default)]
pub struct Queue {
    /// The entries of bucket `current`.
    heap: BinaryHeap<Reverse<Entry>>,
    current: u32,
    /// The entries of all others.
    waiting: BTreeMap<u32, Vec<Entry>>,
    count: usize,
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
    pub fn push(&mut self, t: &Triangulation, tet: u32) {
        let (_, shortest) = shortest_edge(t, tet);
        let entry = Entry { shortest: shortest.to_bits(), v: t.topology.tet(tet).v, t: tet };
        self.count += 1;
        let bucket = entry.bucket();
        if bucket == self.current {
            self.heap.push(Reverse(entry));
        } else {
            self.waiting.entry(bucket).or_default().push(entry);
        }
    }

    /// The next tetrahedron that still exists.
    pub fn pop(&mut self, t: &Triangulation) -> Option<u32> {
        loop {
            if let Some((&first, _)) = self.waiting.first_key_value() {
                if self.heap.is_empty() || first < self.current {
                    self.turn_to(first, t);
                    // All of it may have been dead.
                    continue;
                }
            }
            let Reverse(entry) = self.heap.pop()?;
            self.count -= 1;
            if entry.is_live(t) {
                return Some(entry.t);
            }
        }
    }

    /// Makes a waiting bucket the current one.
    fn turn_to(&mut self, bucket: u32, t: &Triangulation) {
        if !self.heap.is_empty() {
            let entries = std::mem::take(&mut self.heap).into_iter().map(|Reverse(entry)| entry);
            self.waiting.entry(self.current).or_default().extend(entries);
        }
        self.current = bucket;
        let mut entries = self.waiting.remove(&bucket).unwrap_or_default();
        let before = entries.len();
        entries.retain(|entry| entry.is_live(t));
        self.count -= before - entries.len();
        self.heap = entries.into_iter().map(Reverse).collect();
    }

    /// Entries, dead ones included.
    pub fn len(&self) -> usize {
        self.count
    }
}
