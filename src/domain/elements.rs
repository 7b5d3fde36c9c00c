//! The subsegments, or the subfacets, each with its segment or facet, and a word for each vertex that tells of most edges and faces at it that they are none.
//!
//! Most edges and faces of a cavity near the boundary join vertices of the boundary, and few of them are elements of it. A look into the table for each
//! took a large part of the time. So each vertex has a bit set for each other vertex of its elements, by a hash of the other's id (B. H. Bloom,
//! "Space/time trade-offs in hash coding with allowable errors", CACM 13, 1970): where of two vertices one lacks the other's bit, no element has
//! both. The bits of elements that have gone remain, which costs a look into the table at most.

use std::ops::Deref;

use crate::geometry::quality::EDGES;
use crate::leavings::Leavings;
use crate::parted::PartedMap;
use crate::{memory, Control, Error};

/// A map from elements with `N` vertices, the lowest first, to what they are parts of. It is read like any other map.
#[derive(Clone, Debug)]
pub(crate) struct Elements<const N: usize> {
    map: PartedMap<[u32; N], u32>,
    /// By vertex; vertices beyond its end have no element.
    partners: Vec<u64>,
}

/// Parts of segments.
pub(crate) type Subsegments = Elements<2>;
/// Parts of facets.
pub(crate) type Subfacets = Elements<3>;

/// The bit of a vertex.
#[inline]
fn bit(v: u32) -> u64 {
    1 << (v.wrapping_mul(0x9e37_79b1) >> 26)
}

/// The bits of some vertices: tells of most others that they are none of them.
#[derive(Clone, Copy)]
pub(super) struct Corners(u64);

impl Corners {
    pub fn of(vertices: impl IntoIterator<Item = u32>) -> Corners {
        Corners(vertices.into_iter().fold(0, |bits, v| bits | bit(v)))
    }

    /// Whether a vertex may be one of them.
    #[inline]
    pub fn may_have(self, v: u32) -> bool {
        self.0 & bit(v) != 0
    }
}

impl<const N: usize> Default for Elements<N> {
    fn default() -> Self {
        Elements { map: PartedMap::default(), partners: Vec::new() }
    }
}

impl<const N: usize> Deref for Elements<N> {
    type Target = PartedMap<[u32; N], u32>;

    fn deref(&self) -> &Self::Target {
        &self.map
    }
}

impl<const N: usize> Elements<N> {
    /// Puts an element in, or makes it a part of something else. Returns what it was a part of.
    pub fn insert(&mut self, key: [u32; N], of: u32) -> Option<u32> {
        debug_assert!(key.is_sorted());
        note(&mut self.partners, key);
        self.map.insert(key, of)
    }

    /// Takes an element out, and returns what it was a part of.
    pub fn remove(&mut self, key: &[u32; N]) -> Option<u32> {
        self.map.remove(key)
    }

    /// What the element with these vertices, in any order, is a part of, if it is one.
    #[inline]
    pub fn find(&self, mut vertices: [u32; N]) -> Option<u32> {
        let partners = vertices.map(|v| self.partners(v));
        let may_hold = |i: usize, j: usize| Self::may_hold(vertices[i], partners[i], vertices[j], partners[j]);
        if !(0..N).all(|j| (0..j).all(|i| may_hold(i, j))) {
            return None;
        }
        vertices.sort_unstable();
        self.map.get(&vertices).copied()
    }

    /// Room for so many vertices, made in pieces.
    pub fn grow(&mut self, vertices: usize, control: &Control) -> Result<(), Error> {
        let more = vertices.saturating_sub(self.partners.len());
        memory::grow(&mut self.partners, more, "boundary", control)
    }

    /// Makes the list that has an entry for each of so many vertices as long as that, in pieces.
    pub fn lengthen(&mut self, vertices: usize, control: &Control) -> Result<(), Error> {
        memory::lengthen(&mut self.partners, vertices, 0, "boundary", control)
    }

    /// Memory for so many more.
    pub fn try_reserve(&mut self, more: usize) -> Result<(), std::collections::TryReserveError> {
        self.map.try_reserve(more)?;
        self.partners.try_reserve(more)
    }

    /// A vertex's part of what [`may_hold`](Self::may_hold) wants to know of it; `None` for one without an element.
    #[inline]
    pub fn partners(&self, v: u32) -> u64 {
        self.partners.get(v as usize).copied().unwrap_or(0)
    }

    /// A bit for each of [`EDGES`] between these vertices; clear where no element has both ends.
    #[inline(always)]
    pub fn possible_edges(&self, vertices: [u32; 4]) -> u32 {
        let partners = vertices.map(|v| self.partners(v));
        let may_have = |[i, j]: [usize; 2]| Self::may_hold(vertices[i], partners[i], vertices[j], partners[j]);
        EDGES.iter().enumerate().fold(0, |edges, (n, &edge)| edges | u32::from(may_have(edge)) << n)
    }

    /// Whether an element may have both of two vertices with these [`partners`](Self::partners).
    #[inline]
    pub fn may_hold(v: u32, of_v: u64, w: u32, of_w: u64) -> bool {
        of_v & bit(w) != 0 && of_w & bit(v) != 0
    }

    /// Gives the vertices new ids; elements with a vertex that gets `u32::MAX` are gone. What is left is of no use when the control says stop.
    pub fn renumber(&mut self, renamed: impl Fn(u32) -> u32, control: &Control) -> Result<(), Error> {
        self.map.rekey(control, |key, _| {
            let mut key = key.map(&renamed);
            key.sort_unstable();
            Some(key).filter(|key| !key.contains(&u32::MAX))
        })?;
        self.partners.clear();
        let turns = control.turns();
        for &key in self.map.keys() {
            turns.check()?;
            note(&mut self.partners, key);
        }
        Ok(())
    }

    /// A copy, unless the control says stop.
    pub fn try_clone(&self, control: &Control) -> Result<Self, Error> {
        let partners = memory::copied(&self.partners, "boundary", control)?;
        Ok(Elements { map: self.map.try_clone(control)?, partners })
    }

    /// The bytes that it has taken, about.
    pub fn bytes(&self) -> usize {
        self.map.bytes() + self.partners.capacity() * size_of::<u64>()
    }
}

/// Notes an element at its vertices.
fn note<const N: usize>(partners: &mut Vec<u64>, key: [u32; N]) {
    let end = key.into_iter().max().map_or(0, |last| last as usize + 1);
    if partners.len() < end {
        partners.resize(end, 0);
    }
    for (i, v) in key.into_iter().enumerate() {
        let others = key.into_iter().enumerate().filter(|&(j, _)| j != i).fold(0, |others, (_, w)| others | bit(w));
        partners[v as usize] |= others;
    }
}

impl Subfacets {
    /// Bit by slot: whether the face opposite it, of a tetrahedron with these vertices, may be an element.
    #[inline(always)]
    pub fn possible_faces(&self, vertices: [u32; 4]) -> u32 {
        /// Its three edges.
        const SIDES: [u32; 4] = [0b11_1000, 0b10_0110, 0b01_0101, 0b00_1011];
        let edges = self.possible_edges(vertices);
        SIDES.iter().enumerate().fold(0, |faces, (slot, &sides)| faces | u32::from(edges & sides == sides) << slot)
    }
}

impl<const N: usize> Leavings for Elements<N> {
    fn give_back(&mut self) -> bool {
        self.map.give_back() || self.partners.give_back()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangulation::topology::GHOST;

    #[test]
    fn no_subsegment_is_denied() {
        let mut subsegments = Subsegments::default();
        for v in 0..200 {
            subsegments.insert([v, v + 1 + v % 7], v);
        }
        subsegments.renumber(|v| 3 * v + 1, &Control::new()).unwrap();
        let may = |[v, w]: [u32; 2]| Subsegments::may_hold(v, subsegments.partners(v), w, subsegments.partners(w));
        assert_eq!(subsegments.len(), 200);
        for &[v, w] in subsegments.keys() {
            for (n, [i, j]) in EDGES.into_iter().enumerate() {
                let mut vertices = [GHOST; 4];
                (vertices[i], vertices[j]) = (w, v);
                assert_eq!(subsegments.possible_edges(vertices), 1 << n);
            }
        }
        assert!(subsegments.keys().all(|&key| may(key)));
        // 64 bits of which some seven are set.
        let others = (0..200u32).flat_map(|v| (v + 8..200).map(move |w| [3 * v + 1, 3 * w + 1]));
        let (all, wrong) = others.fold((0, 0), |(all, wrong), key| (all + 1, wrong + i32::from(may(key))));
        assert!(wrong * 20 < all, "{wrong} of {all}");
    }

    #[test]
    fn no_subfacet_is_denied() {
        let mut subfacets = Subfacets::default();
        for v in 0..200 {
            assert_eq!(subfacets.insert([v, v + 1 + v % 7, v + 9], v), None);
        }
        // The last ones are gone.
        subfacets.renumber(|v| if v < 200 { 1000 - v } else { u32::MAX }, &Control::new()).unwrap();
        let kept = (0..200u32).filter(|v| v + 9 < 200);
        assert_eq!(subfacets.len(), kept.clone().count());
        for v in kept {
            let [a, b, c] = [v, v + 1 + v % 7, v + 9].map(|v| 1000 - v);
            assert_eq!([[a, b, c], [c, a, b], [b, a, c]].map(|face| subfacets.find(face)), [Some(v); 3]);
            assert_eq!(subfacets.find([a, b, c - 1]), None);
            // Whichever slot of a tetrahedron it is opposite.
            for (slot, v) in [[7, a, b, c], [b, 7, c, a], [c, b, 7, a], [b, a, c, 7]].into_iter().enumerate() {
                assert_eq!(subfacets.possible_faces(v) >> slot & 1, 1);
            }
        }
        assert_eq!(subfacets.remove(&[1000 - 9, 1000 - 1, 1000]), Some(0));
        assert_eq!(subfacets.find([1000, 1000 - 1, 1000 - 9]), None);
    }
}
