//! Points that span no volume: none, one, on a line, in a plane. There is nothing to triangulate yet; what counts is which
//! of them are affinely independent, and that duplicates are found.

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::geometry::predicates::{collinear, orient3d};
use crate::geometry::Sign;
use crate::leavings::{InPieces, Leavings};
use crate::{Control, Error};

/// The state below dimension 3. From then on it is only known that four vertices were affinely independent.
#[derive(Clone, Debug, Default)]
pub struct Lower {
    /// Affinely independent vertices; four of them in dimension 3, where they may have been removed since.
    basis: Vec<u32>,
    /// Empty in dimension 3, where location finds duplicates.
    by_point: ByPoint,
}

/// Vertices by their coordinates' bits, in many maps: when a large one grows, that takes longer than a cancelled call may go on.
#[derive(Clone, Debug, Default)]
pub struct ByPoint(Vec<FxHashMap<[u64; 3], u32>>);

impl ByPoint {
    const MAPS: usize = 256;

    /// The map that a place belongs to.
    fn map(key: &[u64; 3]) -> usize {
        // Coordinates may differ in few bits, high or low ones.
        let mixed = key.iter().fold(0u64, |mixed, &x| (mixed.rotate_left(23) ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        (mixed >> 56) as usize % Self::MAPS
    }

    fn get(&self, key: &[u64; 3]) -> Option<u32> {
        self.0.get(Self::map(key))?.get(key).copied()
    }

    fn insert(&mut self, key: [u64; 3], v: u32) {
        self.map_of(&key).insert(key, v);
    }

    /// The vertex at a point; it is this one if there was none.
    pub(crate) fn first(&mut self, p: DVec3, v: u32) -> u32 {
        let key = key(p);
        *self.map_of(&key).entry(key).or_insert(v)
    }

    fn map_of(&mut self, key: &[u64; 3]) -> &mut FxHashMap<[u64; 3], u32> {
        if self.0.is_empty() {
            self.0.resize_with(Self::MAPS, FxHashMap::default);
        }
        &mut self.0[Self::map(key)]
    }

    fn remove(&mut self, key: &[u64; 3]) {
        if let Some(map) = self.0.get_mut(Self::map(key)) {
            map.remove(key);
        }
    }
}

impl Leavings for ByPoint {
    fn give_back(&mut self) -> bool {
        // A few maps at a time.
        self.0.truncate(self.0.len().saturating_sub(8));
        !self.0.is_empty()
    }
}

impl Leavings for Lower {
    fn give_back(&mut self) -> bool {
        self.by_point.give_back()
    }
}

fn key(p: DVec3) -> [u64; 3] {
    // −0 and 0 are one place.
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

impl Lower {
    pub fn dimension(&self) -> i32 {
        self.basis.len() as i32 - 1
    }

    /// The vertex at a point, below dimension 3.
    pub fn find(&self, p: DVec3) -> Option<u32> {
        self.by_point.get(&key(p))
    }

    /// A copy, unless the control says stop.
    pub fn try_clone(&self, control: &Control) -> Result<Lower, Error> {
        let mut by_point = InPieces::new(ByPoint::default(), control);
        for map in &self.by_point.0 {
            control.check()?;
            by_point.0.push(map.clone());
        }
        Ok(Lower { basis: self.basis.clone(), by_point: by_point.keep() })
    }

    /// Whether a vertex is one of those that span the dimension: without it all others have to be [added](Self::add) anew.
    pub fn rests_on(&self, v: u32) -> bool {
        self.basis.contains(&v)
    }

    /// Takes a vertex at `p` out, below dimension 3, that [nothing rests on](Self::rests_on).
    pub fn remove(&mut self, p: DVec3) {
        debug_assert!(self.dimension() < 3);
        self.by_point.remove(&key(p));
    }

    /// Takes in the new vertex `v` at `p`. Returns the simplex to start from when it was the last one missing for a volume.
    pub fn add(&mut self, v: u32, p: DVec3, points: &[DVec3]) -> Option<[u32; 4]> {
        debug_assert!(self.dimension() < 3);
        self.by_point.insert(key(p), v);
        let at = |i: usize| points[self.basis[i] as usize];
        let independent = match self.basis.len() {
            0 | 1 => true,
            2 => !collinear(at(0), at(1), p),
            _ => orient3d(at(0), at(1), at(2), p) != Sign::Zero,
        };
        if independent {
            self.basis.push(v);
        }
        <[u32; 4]>::try_from(&self.basis[..]).ok()
    }

    /// The volume has been triangulated: what is needed no more, without the vertex that was [added](Self::add) last.
    pub fn forget_points(&mut self, last: DVec3) -> ByPoint {
        self.by_point.remove(&key(last));
        std::mem::take(&mut self.by_point)
    }

    /// Takes the vertex that was [added](Self::add) last back out. `independent` says whether it has raised the dimension.
    pub fn take_back(&mut self, p: DVec3, independent: bool) {
        if independent {
            self.basis.pop();
        }
        self.by_point.remove(&key(p));
    }

    /// Takes back what [`forget_points`](Self::forget_points) took out, and the last vertex of the basis.
    pub fn remember_points(&mut self, by_point: ByPoint) {
        self.by_point = by_point;
        self.basis.pop();
    }
}
