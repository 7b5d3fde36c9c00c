//! Faces by their vertices: how the two sides of a hole's faces find each other.

use super::look;
use crate::triangulation::topology::NONE;
use crate::{memory, Control, Error};

/// The vertices of the face opposite a slot, counterclockwise seen from outside.
#[inline]
pub fn oriented_face(v: &[u32; 4], slot: usize) -> [u32; 3] {
    const FACE: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
    FACE[slot].map(|i| v[i])
}

/// The face turned so that its lowest vertex stands first.
#[inline]
pub fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Whether two faces have the same vertices and go round the same way.
#[inline]
pub fn same_face([a, b, c]: [u32; 3], [d, e, f]: [u32; 3]) -> bool {
    // No branches: how one is turned against the other is anybody's guess.
    (a == d) & (b == e) & (c == f) | (a == e) & (b == f) & (c == d) | (a == f) & (b == d) & (c == e)
}

/// Faces by their [rotated] vertices: a hash table with open addressing that keeps its memory.
#[derive(Clone, Debug, Default)]
pub struct FaceTable {
    pub keys: Vec<[u32; 3]>,
    slots: Vec<u32>,
}

impl FaceTable {
    pub fn clear(&mut self) {
        self.keys.clear();
    }

    /// Makes the table of `keys`, or none: [`Error::Cancelled`] when the control says so.
    pub fn index(&mut self, control: &Control) -> Result<(), Error> {
        self.slots.clear();
        let count = (2 * self.keys.len()).next_power_of_two().max(2);
        memory::lengthen(&mut self.slots, count, NONE, "hole", control)?;
        for (i, &key) in self.keys.iter().enumerate() {
            look(i, control)?;
            let mut slot = self.first_slot(key);
            while self.slots[slot] != NONE {
                slot = (slot + 1) & (self.slots.len() - 1);
            }
            self.slots[slot] = i as u32;
        }
        Ok(())
    }

    #[inline]
    fn first_slot(&self, [a, b, c]: [u32; 3]) -> usize {
        let mixed = (u64::from(a) ^ u64::from(b) << 20 ^ u64::from(c) << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (mixed >> (64 - self.slots.len().trailing_zeros())) as usize
    }

    /// The position of a key.
    #[inline]
    pub fn find(&self, key: [u32; 3]) -> Option<u32> {
        let mut slot = self.first_slot(key);
        loop {
            let i = self.slots[slot];
            if i == NONE {
                return None;
            }
            if self.keys[i as usize] == key {
                return Some(i);
            }
            slot = (slot + 1) & (self.slots.len() - 1);
        }
    }
}
