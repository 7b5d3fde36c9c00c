//! Bounding boxes to be found by place: R-trees of the `rstar` crate. One tree of a million boxes takes a second to make, and none of it can be cancelled. So
//! the boxes are sorted along the axis in which they reach farthest, and every few thousand in that order are a tree. Few of the trees have anything to do with
//! one box.

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{Envelope, RTree, AABB};

use crate::leavings::{InPieces, Leavings};
use crate::sorting::sort_by;
use crate::{memory, Control, DVec3, Error};

/// Boxes of a tree: about a millisecond to make it.
const PART: usize = 1 << 13;

type Boxed = GeomWithData<Rectangle<[f64; 3]>, u32>;

/// As many are looked through faster than a tree of them.
const FEW: usize = 64;

/// Boxes by number.
#[derive(Default)]
pub(super) struct Boxes {
    trees: Vec<RTree<Boxed>>,
    /// The lower and upper corners of all, if they are few.
    few: Vec<[DVec3; 2]>,
}

impl Boxes {
    /// The bounding boxes of lists of points, numbered in their order; [`Error::Cancelled`] when the control says so before they are ready.
    pub fn new<const N: usize>(
        elements: impl Iterator<Item = [DVec3; N]>,
        control: &Control,
    ) -> Result<InPieces<'_, Boxes>, Error> {
        let turns = control.turns();
        let mut all = memory::room_in_pieces(elements.size_hint().0, "boxes", control)?;
        let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (points, i) in elements.zip(0..) {
            turns.check()?;
            let low = points.into_iter().reduce(DVec3::min).unwrap_or_default();
            let high = points.into_iter().reduce(DVec3::max).unwrap_or_default();
            (least, most) = (least.min(low), most.max(high));
            all.push((low, high, i));
        }
        if all.len() > PART {
            let reach = most - least;
            let axis = (0..3).max_by(|&i, &j| reach[i].total_cmp(&reach[j])).unwrap_or(0);
            let place = |&(low, high, _): &(DVec3, DVec3, u32)| 0.5 * low[axis] + 0.5 * high[axis];
            sort_by(&mut all, &control.watch(), |a, b| place(a).total_cmp(&place(b)).then(a.2.cmp(&b.2)))?;
        }
        let mut boxes = InPieces::new(Boxes::default(), control);
        if all.len() <= FEW {
            boxes.few.extend(all.iter().map(|&(low, high, _)| [low, high]));
        }
        for part in all.chunks(PART) {
            control.check()?;
            let boxed = |&(low, high, i): &(DVec3, DVec3, u32)| {
                GeomWithData::new(Rectangle::from_corners(low.to_array(), high.to_array()), i)
            };
            boxes.trees.push(RTree::bulk_load(part.iter().map(boxed).collect()));
        }
        Ok(boxes)
    }

    /// Those within `reach` of a point, sorted.
    pub fn at_point(&self, p: DVec3, reach: f64) -> Vec<u32> {
        if !self.few.is_empty() {
            let [least, most] = [p - reach, p + reach];
            let meets = |[low, high]: [DVec3; 2]| low.cmple(most).all() && high.cmpge(least).all();
            return self.few.iter().zip(0..).filter(|(&corners, _)| meets(corners)).map(|(_, i)| i).collect();
        }
        let envelope = AABB::from_corners((p - reach).to_array(), (p + reach).to_array());
        let near = self.trees.iter().filter(|tree| tree.root().envelope().intersects(&envelope));
        let mut found: Vec<u32> =
            near.flat_map(|tree| tree.locate_in_envelope_intersecting(envelope)).map(|boxed| boxed.data).collect();
        found.sort_unstable();
        found
    }

    /// Calls `each` for every two of these that meet, the lower one first, in no order.
    pub fn each_pair(
        &self,
        control: &Control,
        mut each: impl FnMut(u32, u32) -> Result<(), Error>,
    ) -> Result<(), Error> {
        for (i, tree) in self.trees.iter().enumerate() {
            join(tree, tree, control, |a, b| if a < b { each(a, b) } else { Ok(()) })?;
            for other in &self.trees[i + 1..] {
                join(tree, other, control, |a, b| each(a.min(b), a.max(b)))?;
            }
        }
        Ok(())
    }

    /// Calls `each` for every one of these and one of the others that meet, in no order.
    pub fn each_pair_with(
        &self,
        others: &Boxes,
        control: &Control,
        mut each: impl FnMut(u32, u32) -> Result<(), Error>,
    ) -> Result<(), Error> {
        for tree in &self.trees {
            for other in &others.trees {
                join(tree, other, control, &mut each)?;
            }
        }
        Ok(())
    }
}

/// Calls `each` for all pairs of one of the boxes of a tree and one of another's that meet.
fn join(
    tree: &RTree<Boxed>,
    other: &RTree<Boxed>,
    control: &Control,
    mut each: impl FnMut(u32, u32) -> Result<(), Error>,
) -> Result<(), Error> {
    control.check()?;
    if !tree.root().envelope().intersects(&other.root().envelope()) {
        return Ok(());
    }
    let turns = control.turns();
    for (a, b) in tree.intersection_candidates_with_other_tree(other) {
        turns.check()?;
        each(a.data, b.data)?;
    }
    Ok(())
}

impl Leavings for Boxes {
    fn give_back(&mut self) -> bool {
        self.trees.pop().is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small boxes all over the place, some of them large.
    fn edges(count: usize) -> Vec<[DVec3; 2]> {
        let mut state = 5u64;
        let mut next = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / (1 << 24) as f64
        };
        let mut point = move || DVec3::new(next(), 3.0 * next(), next());
        let mut edge = |i: usize| {
            let (p, q) = (point(), point());
            [p, p + (q - p) * if i % 500 == 0 { 0.5 } else { 0.01 }]
        };
        (0..count).map(&mut edge).collect()
    }

    fn meet([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> bool {
        a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all()
    }

    #[test]
    fn several_trees_find_what_each_by_itself_would() {
        let control = Control::new();
        let edges = edges(2 * PART + 100);
        let boxes = Boxes::new(edges.iter().copied(), &control).unwrap();
        assert_eq!(boxes.trees.len(), 3);
        let few = Boxes::new(edges[..200].iter().copied(), &control).unwrap();
        let numbers = |of: [DVec3; 2]| (0u32..).zip(&edges).filter(move |(_, &edge)| meet(of, edge)).map(|(i, _)| i);
        for &[p, _] in &edges[..50] {
            assert!(boxes.at_point(p, 0.01).into_iter().eq(numbers([p - 0.01, p + 0.01])));
        }
        for count in [0, 1, FEW, FEW + 1] {
            let boxes = Boxes::new(edges[..count].iter().copied(), &control).unwrap();
            for &[p, _] in &edges[..50] {
                let found: Vec<u32> = numbers([p - 0.3, p + 0.3]).filter(|&i| (i as usize) < count).collect();
                assert_eq!(boxes.at_point(p, 0.3), found);
            }
        }
        let sorted = |mut pairs: Vec<(u32, u32)>| {
            pairs.sort_unstable();
            pairs
        };
        let (mut pairs, mut within) = (Vec::new(), Vec::new());
        let note = |list: &mut Vec<(u32, u32)>, pair| {
            list.push(pair);
            Ok(())
        };
        few.each_pair_with(&boxes, &control, |i, j| note(&mut pairs, (i, j))).unwrap();
        let of = |i: u32| numbers(edges[i as usize]).map(move |j| (i, j));
        assert_eq!(sorted(pairs), (0..200).flat_map(of).collect::<Vec<_>>());
        boxes.each_pair(&control, |i, j| note(&mut within, (i, j))).unwrap();
        let all = 0..edges.len() as u32;
        assert_eq!(sorted(within), all.flat_map(of).filter(|(i, j)| i < j).collect::<Vec<_>>());
    }

    #[test]
    fn one_look_at_the_control_for_each_tree_and_more_while_sorting() {
        let control = Control::new();
        let edges = edges(4 * PART);
        let looks = control.looks(None, || drop(Boxes::new(edges.iter().copied(), &control).unwrap()));
        assert!(looks >= edges.len() / 256 + 4, "{looks}");
        // Memory that goes is looked after, too.
        for last in [1, looks / 2, looks - 10] {
            let cancelled = || assert!(matches!(Boxes::new(edges.iter().copied(), &control), Err(Error::Cancelled)));
            assert!(control.looks(Some(last), cancelled) <= last + 2);
        }
    }
}
