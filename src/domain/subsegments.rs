//! The subsegments, each with its segment, and a word for each vertex that tells of most edges at it that they are none.
//!
//! Most edges of a cavity near the boundary join vertices of the boundary, and few of them are subsegments. A look into the table for each of them took
//! a large part of the time. So each vertex has a bit set for each vertex that it has a subsegment to, by a hash of the other's id (B. H. Bloom,
//! "Space/time trade-offs in hash coding with allowable errors", CACM 13, 1970): where one end of an edge lacks the other's bit, the edge
//! is no subsegment. The bits of subsegments that have gone remain, which costs a look into the table at most.

use std::ops::Deref;

use super::boundary::edge_key;
use crate::leavings::Leavings;
use crate::parted::PartedMap;
use crate::{memory, Control, Error};

/// A map from subsegments, lower vertex first, to their segments. It is read like any other map.
#[derive(Clone, Debug, Default)]
pub(crate) struct Subsegments {
    map: PartedMap<[u32; 2], u32>,
    /// By vertex; vertices beyond its end have no subsegment.
    partners: Vec<u64>,
}

/// The bit of a vertex.
#[inline]
fn bit(v: u32) -> u64 {
    1 << (v.wrapping_mul(0x9e37_79b1) >> 26)
}

impl Deref for Subsegments {
    type Target = PartedMap<[u32; 2], u32>;

    fn deref(&self) -> &Self::Target {
        &self.map
    }
}

impl Subsegments {
    /// Puts a subsegment in, or gives it another segment.
    pub fn insert(&mut self, key: [u32; 2], segment: u32) {
        debug_assert!(key[0] < key[1]);
        note(&mut self.partners, key);
        self.map.insert(key, segment);
    }

    /// Takes a subsegment out, and returns its segment.
    pub fn remove(&mut self, key: &[u32; 2]) -> Option<u32> {
        self.map.remove(key)
    }

    /// Room for so many vertices, made in pieces.
    pub fn grow(&mut self, vertices: usize, control: &Control) -> Result<(), Error> {
        let more = vertices.saturating_sub(self.partners.len());
        memory::grow(&mut self.partners, more, "boundary", control)
    }

    /// Memory for so many more.
    pub fn try_reserve(&mut self, more: usize) -> Result<(), std::collections::TryReserveError> {
        self.map.try_reserve(more)?;
        self.partners.try_reserve(more)
    }

    /// A vertex's part of what [`may_hold`](Self::may_hold) wants to know of it; `None` for one without a subsegment.
    #[inline]
    pub fn partners(&self, v: u32) -> u64 {
        self.partners.get(v as usize).copied().unwrap_or(0)
    }

    /// Whether two vertices, with their [`partners`](Self::partners), may have a subsegment between them.
    #[inline]
    pub fn may_hold(v: u32, of_v: u64, w: u32, of_w: u64) -> bool {
        of_v & bit(w) != 0 && of_w & bit(v) != 0
    }

    /// Gives the vertices new ids. What is left is of no use when the control says stop.
    pub fn renumber(&mut self, renamed: impl Fn(u32) -> u32, control: &Control) -> Result<(), Error> {
        self.map.rekey(control, |key, _| Some(edge_key(key.map(&renamed))))?;
        self.partners.clear();
        let turns = control.turns();
        for &key in self.map.keys() {
            turns.check()?;
            note(&mut self.partners, key);
        }
        Ok(())
    }

    /// A copy, unless the control says stop.
    pub fn try_clone(&self, control: &Control) -> Result<Subsegments, Error> {
        let partners = memory::copied(&self.partners, "boundary", control)?;
        Ok(Subsegments { map: self.map.try_clone(control)?, partners })
    }

    /// The bytes that it has taken, about.
    pub fn bytes(&self) -> usize {
        self.map.bytes() + self.partners.capacity() * size_of::<u64>()
    }
}

/// Notes a subsegment at its ends.
fn note(partners: &mut Vec<u64>, [a, b]: [u32; 2]) {
    if partners.len() <= b as usize {
        partners.resize(b as usize + 1, 0);
    }
    partners[a as usize] |= bit(b);
    partners[b as usize] |= bit(a);
}

impl Leavings for Subsegments {
    fn give_back(&mut self) -> bool {
        self.map.give_back() || self.partners.give_back()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_subsegment_is_denied() {
        let mut subsegments = Subsegments::default();
        for v in 0..200 {
            subsegments.insert([v, v + 1 + v % 7], v);
        }
        subsegments.renumber(|v| 3 * v + 1, &Control::new()).unwrap();
        let may = |[v, w]: [u32; 2]| Subsegments::may_hold(v, subsegments.partners(v), w, subsegments.partners(w));
        assert_eq!(subsegments.len(), 200);
        assert!(subsegments.keys().all(|&key| may(key)));
        // 64 bits of which some seven are set.
        let others = (0..200u32).flat_map(|v| (v + 8..200).map(move |w| [3 * v + 1, 3 * w + 1]));
        let (all, wrong) = others.fold((0, 0), |(all, wrong), key| (all + 1, wrong + i32::from(may(key))));
        assert!(wrong * 20 < all, "{wrong} of {all}");
    }
}
