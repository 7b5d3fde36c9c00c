//! The queue of bad tetrahedra, the one with the shortest shortest edge first. Entries whose tetrahedron has gone are found out when
//! their turn comes: a tetrahedron is known by its vertices.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::geometry::quality::EDGES;
use crate::triangulation::Triangulation;

/// A tetrahedron to be mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entry {
    /// Bits of the squared length of its shortest edge: for positive numbers they sort as the numbers do.
    shortest: u64,
    /// Its vertices when it was found bad.
    pub v: [u32; 4],
    /// Where it was stored then.
    pub t: u32,
}

/// A priority queue of [`Entry`]s.
#[derive(Clone, Debug, Default)]
pub struct Queue(BinaryHeap<Reverse<Entry>>);

/// The slots of a tetrahedron's shortest edge and its squared length. Among equals the one of the lowest vertices.
pub fn shortest_edge(t: &Triangulation, tet: u32) -> ([usize; 2], f64) {
    let (v, corners) = (t.topology.tet(tet).v, t.corners(tet));
    let key =
        |&[i, j]: &[usize; 2]| (corners[i].distance_squared(corners[j]).to_bits(), v[i].min(v[j]), v[i].max(v[j]));
    let slots = EDGES.into_iter().min_by_key(key).unwrap_or([0, 1]);
    (slots, corners[slots[0]].distance_squared(corners[slots[1]]))
}

impl Queue {
    pub fn push(&mut self, t: &Triangulation, tet: u32) {
        let (_, shortest) = shortest_edge(t, tet);
        self.0.push(Reverse(Entry { shortest: shortest.to_bits(), v: t.topology.tet(tet).v, t: tet }));
    }

    /// The next tetrahedron that still exists.
    pub fn pop(&mut self, t: &Triangulation) -> Option<u32> {
        while let Some(Reverse(entry)) = self.0.pop() {
            if t.topology.tet(entry.t).v == entry.v {
                return Some(entry.t);
            }
        }
        None
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }
}
