//! How many points the loops need against the refinement of our own, and how many rounds.

use super::*;
use crate::{Mesh, RefineOptions, Sparsify};

const RULES: [Rule; 3] = [Rule::Sparse, Rule::Paper, Rule::Circumcenter];
const BOUNDS: [f64; 3] = [1.5, 2.0, 4.0];

/// Points that the loop adds, and those that the refinement does one by one. The loop's rounds are few.
fn counts(points: &[DVec3], half: f64, options: &ArrayOptions) -> [usize; 2] {
    let points = boxed(points, half);
    let mut least = f64::INFINITY;
    for (i, p) in points.iter().enumerate() {
        least = points[..i].iter().map(|q| q.distance(*p)).fold(least, f64::min);
    }
    let doublings = (points[0].distance(points[7]) / least).log2();
    let mut host = Host::new(&points);
    let rounds = host.refine(options);
    host.t.validate(3).unwrap();
    // What the guide tells hosts to allow is 10 each, and some more.
    assert!(rounds as f64 <= 10.0 * doublings + 20.0, "{rounds} rounds, {doublings} doublings, {options:?}");
    let plc = Plc::boxed(points[0], points[7], points[8..].iter().copied());
    let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    let ArrayOptions { radius_edge, rule, .. } = *options;
    let own = RefineOptions { radius_edge, rule, sparsify: Some(Sparsify::Off), ..RefineOptions::default() };
    let own = mesh.refine(&own, &Control::new()).unwrap();
    [host.t.vertex_count() - points.len(), own.steiner]
}

#[test]
fn a_loop_ends_within_a_tenth_of_the_refinements_count() {
    let points = random_points(400, 1);
    for rule in RULES {
        for radius_edge in BOUNDS {
            let options = ArrayOptions { radius_edge, rule, ..ArrayOptions::default() };
            let [loops, own] = counts(&points, 1.5, &options);
            assert!(loops.abs_diff(own) * 10 <= own, "{loops} in rounds, {own} one by one, {options:?}");
        }
    }
}

/// Few points in a wide box: single sets differ by up to a third, up or down, and sums over six sets by no more than a tenth.
#[test]
fn loops_on_few_points_end_near_the_refinements_count() {
    for radius_edge in BOUNDS {
        for rule in RULES {
            let options = ArrayOptions { radius_edge, rule, ..ArrayOptions::default() };
            let mut sums = [0usize; 2];
            for seed in 2..8 {
                let [loops, own] = counts(&random_points(30, seed), 100.0, &options);
                assert!(loops * 10 <= own * 14, "{loops} in rounds, {own} one by one, seed {seed}, {options:?}");
                sums = [sums[0] + loops, sums[1] + own];
            }
            let [loops, own] = sums;
            assert!(loops.abs_diff(own) * 10 <= own, "{loops} in rounds, {own} one by one, {options:?}");
        }
    }
}
