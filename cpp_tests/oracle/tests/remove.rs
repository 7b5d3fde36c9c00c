//! After any mixture of insertions and removals the set of tetrahedra is CGAL's of the points that are left.

mod common;

use common::*;
use proptest::prelude::*;
use wellspaced::triangulation::remove::{Hole, Replacement};
use wellspaced::Triangulation;
use wellspaced_oracle::Point;

/// What is done to the triangulation next.
#[derive(Clone, Debug)]
enum Step {
    Insert(Point),
    InsertMany(Vec<Point>),
    Remove(prop::sample::Index),
    /// Some vertices at once, and one point in their place.
    Replace(Vec<prop::sample::Index>, Option<Point>),
    /// A comparison half-way.
    Compare,
}

fn steps(point: impl Strategy<Value = Point> + 'static, most: usize) -> impl Strategy<Value = Vec<Step>> {
    let point = point.boxed();
    let index = any::<prop::sample::Index>;
    let step = prop_oneof![
        20 => point.clone().prop_map(Step::Insert),
        3 => prop::collection::vec(point.clone(), 2..20).prop_map(Step::InsertMany),
        24 => index().prop_map(Step::Remove),
        6 => (prop::collection::vec(index(), 0..4), prop::option::of(point)).prop_map(|(r, a)| Step::Replace(r, a)),
        2 => Just(Step::Compare),
    ];
    prop::collection::vec(step, 0..most)
}

/// A triangulation, and what its vertices should be.
#[derive(Default)]
struct Kept {
    triangulation: Triangulation,
    points: Vec<Point>,
    ids: Vec<u32>,
    hole: Hole,
}

impl Kept {
    fn add(&mut self, point: Point, id: u32) {
        if !self.ids.contains(&id) {
            self.ids.push(id);
            self.points.push(point);
        }
    }

    fn forget(&mut self, i: usize) -> u32 {
        self.points.swap_remove(i);
        self.ids.swap_remove(i)
    }

    fn compare(&self) -> Result<(), TestCaseError> {
        same_as_cgal(&self.triangulation, &self.points, &self.ids)
    }

    fn step(&mut self, step: &Step) -> Result<(), TestCaseError> {
        match step {
            Step::Insert(point) => {
                let inserted = self.triangulation.insert(dvec(point), None).unwrap();
                prop_assert_eq!(inserted.is_new, !self.ids.contains(&inserted.vertex));
                self.add(*point, inserted.vertex);
            }
            Step::InsertMany(points) => {
                for (&point, id) in points.iter().zip(insert_many(&mut self.triangulation, points)) {
                    self.add(point, id);
                }
            }
            Step::Remove(index) if !self.ids.is_empty() => {
                let id = self.forget(index.index(self.ids.len()));
                self.triangulation.remove(id).unwrap();
            }
            Step::Remove(_) => {}
            Step::Replace(remove, add) => {
                let mut gone = Vec::new();
                for index in remove {
                    if !self.ids.is_empty() {
                        let id = self.forget(index.index(self.ids.len()));
                        gone.push(id);
                    }
                }
                let add = add.filter(|add| self.points.iter().all(|p| dvec(p) != dvec(add)));
                let replacement = Replacement { remove: &gone, add: add.as_ref().map(dvec) };
                self.triangulation.preview(&replacement, &|_| false, &mut self.hole).unwrap();
                if let Some(id) = self.triangulation.replace(&mut self.hole).unwrap() {
                    self.add(add.expect("one was added"), id);
                }
            }
            Step::Compare => self.compare()?,
        }
        Ok(())
    }
}

fn run(first: &[Point], steps: &[Step]) -> Result<(), TestCaseError> {
    let mut kept = Kept::default();
    kept.step(&Step::InsertMany(first.to_vec()))?;
    for step in steps {
        kept.step(step)?;
    }
    kept.compare()
}

macro_rules! mixed_sequences {
    ($($name:ident: $point:expr, $most:expr;)*) => {
        proptest! {
            #![proptest_config(config(60))]
            $(
                #[test]
                fn $name(first in prop::collection::vec($point, 0..$most), steps in steps($point, $most)) {
                    run(&first, &steps)?;
                }
            )*
        }
    };
}

mixed_sequences! {
    uniform_points: uniform(), 60;
    grid_of_two: grid(2), 30;
    grid_of_three: grid(3), 60;
    grid_of_four: grid(4), 80;
    points_on_one_sphere: cospherical(), 60;
    points_beside_one_sphere: on_sphere(), 60;
    points_beside_a_grid: grid_nudged(), 50;
    points_in_a_plane: coplanar(), 30;
    points_in_a_plane_and_others: prop_oneof![8 => coplanar(), 1 => grid(6)], 50;
    points_on_a_line_and_others: prop_oneof![8 => collinear(), 1 => grid(3)], 40;
    clusters: clustered(), 60;
    all_magnitudes: mixed_exponents(), 40;
    mixtures: mixed(), 60;
}

/// Numbers below `n` in the order of a fixed pseudo-random sequence.
fn shuffled(n: u32) -> Vec<u32> {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let mut keyed: Vec<(u64, u32)> = (0..n).map(|i| (next(), i)).collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, i)| i).collect()
}

fn scattered(n: u32) -> Vec<Point> {
    let coordinate = |i: u32, base: u32| {
        // Halton's sequence.
        let (mut i, mut scale, mut x) = (i + 1, 1.0, 0.0);
        while i > 0 {
            scale /= f64::from(base);
            x += scale * f64::from(i % base);
            i /= base;
        }
        x
    };
    (0..n).map(|i| [2, 3, 5].map(|base| coordinate(i, base))).collect()
}

/// Removes the first `count` of a random order and compares with CGAL.
fn remove_some(points: &[Point], count: usize) {
    let (mut triangulation, ids) = bulk(points);
    let order = shuffled(points.len() as u32);
    for &i in &order[..count] {
        triangulation.remove(ids[i as usize]).unwrap();
    }
    let left: Vec<Point> = order[count..].iter().map(|&i| points[i as usize]).collect();
    let ids: Vec<u32> = order[count..].iter().map(|&i| ids[i as usize]).collect();
    same_as_cgal(&triangulation, &left, &ids).unwrap();
}

/// Empties a grid of n³ points in an order, with a comparison every so many.
fn empty_grid(n: u32, order: &[u32], every: usize) {
    let points: Vec<Point> = (0..n * n * n).map(|i| [i % n, i / n % n, i / n / n].map(f64::from)).collect();
    let (mut triangulation, ids) = bulk(&points);
    for (done, &i) in order.iter().enumerate() {
        if done % every == 0 || order.len() - done < 30 {
            let left: Vec<Point> = order[done..].iter().map(|&i| points[i as usize]).collect();
            let ids: Vec<u32> = order[done..].iter().map(|&i| ids[i as usize]).collect();
            same_as_cgal(&triangulation, &left, &ids).unwrap();
        }
        triangulation.remove(ids[i as usize]).unwrap();
    }
    assert_eq!((triangulation.vertex_count(), triangulation.dimension()), (0, -1));
}

#[test]
fn half_of_ten_thousand_points() {
    remove_some(&scattered(10_000), 5_000);
}

#[test]
fn a_small_grid_emptied() {
    let order = shuffled(12 * 12 * 12);
    empty_grid(12, &order, 100);
    let in_order: Vec<u32> = (0..9 * 9 * 9).collect();
    empty_grid(9, &in_order, 50);
}

#[test]
#[ignore = "takes half a minute"]
fn half_of_a_hundred_thousand_points() {
    remove_some(&scattered(100_000), 50_000);
}

#[test]
#[ignore = "takes half a minute"]
fn a_large_grid_emptied() {
    let order = shuffled(30 * 30 * 30);
    empty_grid(30, &order, 2_000);
    let in_order: Vec<u32> = (0..30 * 30 * 30).collect();
    empty_grid(30, &in_order, 2_000);
}
