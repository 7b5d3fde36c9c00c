//! Division of space among threads: every vertex is in one [territory](super::territory).
//!
//! A k-d tree (J. L. Bentley, "Multidimensional binary search trees used for associative searching", CACM 18, 1975) whose planes leave as many
//! points on one side as on the other. Territories are convex, so that walks within them seldom leave them. How many there
//! are depends on the number of points, never on that of threads, so that the result doesn't either.
//!
//! Insertions near a plane would reach beyond it. So the points on either side of each are set apart, a *zone* as thick as some
//! cavities, to be inserted before the rest: once the zone is filled, cavities on one side of it hardly reach the other.

use std::ops::Range;

use glam::DVec3;

use super::order::splitmix;
use super::territory::{Ids, Own, NOBODY};
use crate::{memory, Control, Error};

/// So many points are divided in two.
const POINTS: usize = 1 << 16;
/// The unit for what is divided further.
const MANY_POINTS: usize = 1 << 19;
/// More territories than by this depth leave threads with nothing to do.
pub(super) const MAX_DEPTH: u32 = 6;
/// So many points a territory tell where the planes go.
const SAMPLE: usize = 1 << 11;

/// How deep a tree so many points are divided by; 0 means that they are too few. The planes' area grows as the square of the cube root of the
/// number of territories; this way the share of the points that lie there stays the same.
pub(super) fn depth(points: usize) -> u32 {
    let units = (points / MANY_POINTS) as u128;
    let mut depth = u32::from(points >= POINTS);
    while depth > 0 && depth < MAX_DEPTH && (2u128 << depth).pow(3) <= units * units {
        depth += 1;
    }
    depth
}

/// The positions of some of so many points, enough to divide them all; the same ones each time.
pub(super) fn sample(points: usize, depth: u32) -> impl Iterator<Item = usize> {
    let count = SAMPLE << depth;
    (0..count.min(points)).map(move |i| if count >= points { i } else { (splitmix(i as u64) % points as u64) as usize })
}

/// Which way the planes lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Planes {
    /// Across the longest side of what they divide.
    AlongAxes,
    /// Along no axis, to divide a zone of the former.
    Oblique,
}

const NORMALS: [DVec3; 3] =
    [DVec3::new(0.55, 0.31, 0.78), DVec3::new(0.71, -0.43, 0.59), DVec3::new(0.38, 0.77, -0.51)];

/// A plane: what lies below `cut` is on one side, and what lies from `low` to `high` is in the zone.
#[derive(Clone, Copy, Debug, Default)]
struct Plane {
    normal: DVec3,
    low: f64,
    cut: f64,
    high: f64,
}

/// A division of space.
#[derive(Debug)]
pub(super) struct Division {
    /// The root, then the planes of the next depth, and so on.
    planes: Vec<Plane>,
    depth: u32,
}

impl Division {
    /// No division.
    pub fn none() -> Division {
        Division { planes: Vec::new(), depth: 0 }
    }

    /// Divides so many points, of which there is a sample. A tree of less depth has the same planes; the zones are thicker the fewer the points.
    pub fn new(mut sample: Vec<DVec3>, count: usize, depth: u32, kind: Planes) -> Division {
        let mut planes = vec![Plane::default(); (1 << depth) - 1];
        let mut heights = Vec::with_capacity(sample.len());
        for level in 0..depth {
            let mut rest = &mut sample[..];
            for i in 0..1 << level {
                let share = rest.len() / ((1 << level) - i);
                let (cell, others) = std::mem::take(&mut rest).split_at_mut(share);
                rest = others;
                let normal = match kind {
                    Planes::AlongAxes => longest_side(cell),
                    Planes::Oblique => NORMALS[level as usize % NORMALS.len()],
                };
                cell.sort_unstable_by(|&p, &q| normal.dot(p).total_cmp(&normal.dot(q)));
                heights.clear();
                heights.extend(cell.iter().map(|&p| normal.dot(p)));
                planes[(1 << level) - 1 + i] = plane_through(normal, &heights, (count >> level) as f64, kind);
            }
        }
        Division { planes, depth }
    }

    /// How deep the tree is; there are twice as many territories with each level.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// The territory of a point, and whether it is in a zone.
    #[inline]
    pub fn place(&self, p: DVec3) -> (u8, bool) {
        let (mut node, mut in_zone) = (0, false);
        for _ in 0..self.depth {
            let Plane { normal, low, cut, high } = self.planes[node];
            let height = normal.dot(p);
            in_zone |= (low <= height) & (height < high);
            node = 2 * node + 1 + usize::from(height >= cut);
        }
        ((node - self.planes.len()) as u8, in_zone)
    }

    /// The territories' boxes within one: their lowest and highest corners. For planes along the axes.
    pub fn boxes(&self, low: DVec3, high: DVec3) -> Vec<(DVec3, DVec3)> {
        let mut boxes = vec![(low, high)];
        for node in 0..self.planes.len() {
            let Plane { normal, cut, .. } = self.planes[node];
            let (low, high) = boxes[node];
            boxes.push((low, DVec3::select(normal.cmpgt(DVec3::ZERO), high.min(normal * cut), high)));
            boxes.push((DVec3::select(normal.cmpgt(DVec3::ZERO), low.max(normal * cut), low), high));
        }
        boxes.split_off(self.planes.len())
    }

    /// Sets those of `pending` that are in a zone apart, in order, and shares the rest out among the territories, which have labels; vertices that
    /// are not named here nor `present` have none.
    pub fn share(
        &self,
        points: &[DVec3],
        pending: &[u32],
        present: impl Iterator<Item = u32>,
        control: &Control,
    ) -> Result<(Vec<u32>, Partition), Error> {
        /// Points between two looks at the control.
        const PART: usize = 1 << 15;
        let mut labels = memory::filled(points.len() + 1, NOBODY, "labels", control)?.keep();
        for (turn, v) in present.enumerate() {
            if turn % PART == 0 {
                control.check()?;
            }
            labels[v as usize + 1] = self.place(points[v as usize]).0;
        }
        let mut zone = Vec::new();
        let mut own = vec![Vec::new(); 1 << self.depth];
        for (turn, &v) in pending.iter().enumerate() {
            if turn % PART == 0 {
                control.check()?;
            }
            let (territory, in_zone) = self.place(points[v as usize]);
            labels[v as usize + 1] = territory;
            if in_zone {
                zone.push(v);
            } else {
                own[usize::from(territory)].push(v);
            }
        }
        let mut ends: Vec<usize> = own.iter().map(Vec::len).collect();
        (1..ends.len()).for_each(|i| ends[i] += ends[i - 1]);
        Ok((zone, Partition { pending: own.concat(), ends, territories: Territories::Labels(labels) }))
    }
}

fn longest_side(points: &[DVec3]) -> DVec3 {
    let (low, high) =
        points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let size = high - low;
    if size.x >= size.y && size.x >= size.z {
        DVec3::X
    } else if size.y >= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    }
}

/// The plane in the middle of a sample of so many points, whose heights are sorted.
fn plane_through(normal: DVec3, heights: &[f64], count: f64, kind: Planes) -> Plane {
    if heights.is_empty() {
        return Plane::default();
    }
    let thickness = match kind {
        Planes::AlongAxes => THICKNESS,
        Planes::Oblique => OBLIQUE_THICKNESS,
    };
    let middle = heights.len() / 2;
    let half = ((thickness / count.cbrt() * heights.len() as f64) as usize).min(middle);
    let at = |i: usize| heights[i.min(heights.len() - 1)];
    Plane { normal, low: at(middle - half), cut: at(middle), high: at(middle + half) }
}

/// How many points a zone holds on either side of a plane, as multiples of what lies side by side on it where points fill a cube evenly.
const THICKNESS: f64 = 1.0;
const OBLIQUE_THICKNESS: f64 = 0.5;

/// Points to insert, and whose they are.
#[derive(Debug)]
pub(super) struct Partition {
    /// The vertices, those of one territory behind those of another.
    pub pending: Vec<u32>,
    /// Where each territory's pending vertices end.
    ends: Vec<usize>,
    territories: Territories,
}

/// Whose vertices are.
#[derive(Debug)]
enum Territories {
    /// Territory i begins with the i-th of these ids and ends with the next.
    Ids(Vec<u32>),
    /// The territory of each vertex, behind the ghost's.
    Labels(Vec<u8>),
}

/// A territory of either kind.
#[derive(Clone, Copy)]
pub(super) enum AnyTerritory<'a> {
    Ids(Ids),
    Own(Own<'a>),
}

impl Partition {
    /// Vertices to insert, in order, and the first id of each territory, then the end of the last.
    pub fn of_ids(pending: Vec<u32>, firsts: Vec<u32>) -> Partition {
        let ends = firsts[1..].iter().map(|&end| pending.partition_point(|&v| v < end)).collect();
        Partition { pending, ends, territories: Territories::Ids(firsts) }
    }

    /// Number of territories.
    pub fn count(&self) -> usize {
        self.ends.len()
    }

    fn range(&self, territory: usize) -> Range<usize> {
        let start = if territory == 0 { 0 } else { self.ends[territory - 1] };
        start..self.ends[territory]
    }

    /// The vertices to insert in a territory.
    pub fn pending_in(&self, territory: usize) -> &[u32] {
        &self.pending[self.range(territory)]
    }

    /// A territory.
    pub fn territory(&self, territory: usize) -> AnyTerritory<'_> {
        match &self.territories {
            Territories::Ids(firsts) => AnyTerritory::Ids(Ids::new(firsts[territory], firsts[territory + 1])),
            Territories::Labels(labels) => AnyTerritory::Own(Own::new(labels, territory as u8)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::territory::Territory;
    use super::*;
    use crate::geometry::lanes::Portable;

    fn points() -> Vec<DVec3> {
        (0..40_000u32)
            .map(|i| DVec3::new((i * 7919 % 211) as f64, (i * 104_729 % 30_700) as f64, (i % 2 * 500) as f64))
            .collect()
    }

    fn sampled(points: &[DVec3]) -> Vec<DVec3> {
        sample(points.len(), 3).map(|i| points[i]).collect()
    }

    /// Which territory a vertex is in.
    fn whose(partition: &Partition, v: u32) -> Option<usize> {
        let is_in = |&territory: &usize| {
            // SAFETY: a vertex that the partition knows, and the ghost.
            let bits = unsafe {
                match partition.territory(territory) {
                    AnyTerritory::Ids(own) => own.of::<Portable>(&[v, u32::MAX, v, u32::MAX]),
                    AnyTerritory::Own(own) => own.of::<Portable>(&[v, u32::MAX, v, u32::MAX]),
                }
            };
            assert!(bits == 0 || bits == 0b101);
            bits != 0
        };
        let mut found = (0..partition.count()).filter(is_in);
        let first = found.next();
        assert_eq!(found.next(), None);
        first
    }

    #[test]
    fn every_vertex_has_one_territory() {
        let points = points();
        let (pending, present): (Vec<u32>, Vec<u32>) = (0..39_000).partition(|i| i % 3 != 0);
        for kind in [Planes::AlongAxes, Planes::Oblique] {
            let division = Division::new(sampled(&points), pending.len(), 3, kind);
            let (zone, partition) =
                division.share(&points, &pending, present.iter().copied(), &Control::new()).unwrap();
            assert_eq!(partition.count(), 8);
            assert!(zone.is_sorted());
            assert!(zone.len() > pending.len() / 50 && zone.len() < pending.len() * 9 / 10, "{}", zone.len());
            assert!((0..39_000).all(|v| whose(&partition, v) == Some(division.place(points[v as usize]).0.into())));
            assert!((39_000..40_000).all(|v| whose(&partition, v).is_none()));
            let mut all = zone;
            for territory in 0..8 {
                let own = partition.pending_in(territory);
                assert!(own.is_sorted());
                assert!(own.iter().all(|&v| whose(&partition, v) == Some(territory)));
                all.extend(own);
            }
            all.sort_unstable();
            assert_eq!(all, pending);
        }
    }

    #[test]
    fn ranges_of_ids_are_territories() {
        let partition = Partition::of_ids(vec![5, 7, 9, 20, 21], vec![4, 10, 10, 30]);
        assert_eq!((0..3).map(|i| partition.pending_in(i)).collect::<Vec<_>>(), [&[5, 7, 9][..], &[], &[20, 21]]);
        assert_eq!(
            [3, 4, 9, 10, 29, 30].map(|v| whose(&partition, v)),
            [None, Some(0), Some(0), Some(2), Some(2), None]
        );
    }

    #[test]
    fn a_tree_of_less_depth_has_the_same_planes() {
        let points = points();
        let sample = sampled(&points);
        let deep = Division::new(sample.clone(), points.len(), 3, Planes::AlongAxes);
        let shallow = Division::new(sample, points.len() / 7, 1, Planes::AlongAxes);
        for &p in &points {
            assert_eq!(deep.place(p).0 >> 2, shallow.place(p).0);
        }
        let [thin, thick] = [deep.planes[0], shallow.planes[0]];
        assert_eq!((thin.normal, thin.cut), (thick.normal, thick.cut));
        assert!(thick.low < thin.low && thin.low < thin.cut && thin.cut < thin.high && thin.high < thick.high);
    }

    #[test]
    fn territories_are_boxes() {
        let points = points();
        let filter = crate::geometry::Filter::for_points(&points);
        let (low, high) = filter.bounding_box();
        let division = Division::new(sampled(&points), points.len(), 3, Planes::AlongAxes);
        let boxes = division.boxes(low, high);
        assert_eq!(boxes.len(), 8);
        for p in points {
            let (low, high) = boxes[usize::from(division.place(p).0)];
            assert!(p.cmpge(low).all() && p.cmple(high).all(), "{p} in {low}, {high}");
        }
        let volumes = boxes.iter().map(|&(low, high)| (high - low).element_product());
        assert!((volumes.sum::<f64>() / (high - low).element_product() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn points_in_one_place_are_not_divided_but_do_no_harm() {
        let points = vec![DVec3::ONE; 1000];
        let pending: Vec<u32> = (0..1000).collect();
        let division = Division::new(points.clone(), 1000, 3, Planes::AlongAxes);
        let (zone, partition) = division.share(&points, &pending, std::iter::empty(), &Control::new()).unwrap();
        assert_eq!(zone.len() + partition.pending.len(), 1000);
        assert_eq!(division.place(DVec3::ONE), division.place(points[7]));
    }

    #[test]
    fn few_points_are_not_divided() {
        assert_eq!([0, POINTS - 1, POINTS, 867_000, 8_670_000].map(depth), [0, 0, 1, 1, 2]);
        assert_eq!(depth(1 << 30), MAX_DEPTH);
    }
}
