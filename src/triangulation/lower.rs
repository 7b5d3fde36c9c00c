//! Points that span no volume: none, one, on a line, in a plane. There is nothing to triangulate yet; what counts is which
//! of them are affinely independent, and that duplicates are found.

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::geometry::predicates::{collinear, orient3d};
use crate::geometry::Sign;

/// The state below dimension 3. From then on it is only known that four vertices were affinely independent.
#[derive(Clone, Debug, Default)]
pub struct Lower {
    /// Affinely independent vertices; four of them in dimension 3, where they may have been removed since.
    basis: Vec<u32>,
    /// Vertices by their coordinates' bits; empty in dimension 3, where location finds duplicates.
    by_point: FxHashMap<[u64; 3], u32>,
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
        self.by_point.get(&key(p)).copied()
    }

    /// Takes vertex `v` at `p` out, below dimension 3. False when it is one of those that span the dimension: then all have to be
    /// [added](Self::add) anew.
    pub fn remove(&mut self, v: u32, p: DVec3) -> bool {
        debug_assert!(self.dimension() < 3);
        self.by_point.remove(&key(p));
        !self.basis.contains(&v)
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

    /// The volume has been triangulated.
    pub fn forget_points(&mut self) {
        self.by_point = FxHashMap::default();
    }

    /// It could not be: takes the last vertex that was [added](Self::add) back out.
    pub fn take_back(&mut self, p: DVec3) {
        self.basis.pop();
        self.by_point.remove(&key(p));
    }
}
