//! Points that span no volume: none, one, on a line, in a plane. There is nothing to triangulate yet; what counts is which
//! of them are affinely independent, and that duplicates are found.

use glam::DVec3;

use crate::geometry::predicates::{collinear, orient3d};
use crate::geometry::Sign;
use crate::leavings::Leavings;
use crate::parted::PartedMap;
use crate::{Control, Error};

/// The state below dimension 3. From then on it is only known that four vertices were affinely independent.
#[derive(Clone, Debug, Default)]
pub struct Lower {
    /// Affinely independent vertices; four of them in dimension 3, where they may have been removed since.
    basis: Vec<u32>,
    /// Empty in dimension 3, where location finds duplicates.
    by_point: ByPoint,
}

/// Vertices by their coordinates' bits.
#[derive(Clone, Debug, Default)]
pub struct ByPoint(PartedMap<[u64; 3], u32>);

impl ByPoint {
    /// The vertex at a point; it is this one if there was none.
    pub(crate) fn first(&mut self, p: DVec3, v: u32) -> u32 {
        *self.0.entry(key(p)).or_insert(v)
    }
}

impl Leavings for ByPoint {
    fn give_back(&mut self) -> bool {
        self.0.give_back()
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
        self.by_point.0.get(&key(p)).copied()
    }

    /// A copy, unless the control says stop.
    pub fn try_clone(&self, control: &Control) -> Result<Lower, Error> {
        Ok(Lower { basis: self.basis.clone(), by_point: ByPoint(self.by_point.0.try_clone(control)?) })
    }

    /// Whether a vertex is one of those that span the dimension: without it all others have to be [added](Self::add) anew.
    pub fn rests_on(&self, v: u32) -> bool {
        self.basis.contains(&v)
    }

    /// Takes a vertex at `p` out, below dimension 3, that [nothing rests on](Self::rests_on).
    pub fn remove(&mut self, p: DVec3) {
        debug_assert!(self.dimension() < 3);
        self.by_point.0.remove(&key(p));
    }

    /// Takes in the new vertex `v` at `p`. Returns the simplex to start from when it was the last one missing for a volume.
    pub fn add(&mut self, v: u32, p: DVec3, points: &[DVec3]) -> Option<[u32; 4]> {
        debug_assert!(self.dimension() < 3);
        self.by_point.0.insert(key(p), v);
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
        self.by_point.0.remove(&key(last));
        std::mem::take(&mut self.by_point)
    }

    /// Takes the vertex that was [added](Self::add) last back out. `independent` says whether it has raised the dimension.
    pub fn take_back(&mut self, p: DVec3, independent: bool) {
        if independent {
            self.basis.pop();
        }
        self.by_point.0.remove(&key(p));
    }

    /// Takes back what [`forget_points`](Self::forget_points) took out, and the last vertex of the basis.
    pub fn remember_points(&mut self, by_point: ByPoint) {
        self.by_point = by_point;
        self.basis.pop();
    }
}
