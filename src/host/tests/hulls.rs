//! Loops on the convex hulls of bare random points: slanted facets that meet at any angles, of which the arrays say nothing.

use super::*;

/// Batch, insert, repeat. The number of rounds, and the last batch.
fn refine(points: &[DVec3], options: &ArrayOptions, most: usize) -> (usize, ArrayBatch) {
    let mut host = Host::new(points);
    for round in 0..most {
        let batch = host.round(options);
        if batch.points.is_empty() {
            return (round, batch);
        }
        for point in &batch.points {
            let p = point.position;
            let inside = p.abs().max_element() <= 1.0 + 1e-9;
            assert!(inside, "{point:?} lies outside, in round {round} of {} points", points.len());
            assert!(host.t.insert(p, None).unwrap().is_new);
        }
    }
    panic!("no end in {most} rounds: {} vertices of {}", host.t.vertex_count(), points.len());
}

/// These went on for ever: splits that lie off their planes by rounding tore the facets into pieces, whose circumcentres may be anywhere.
#[test]
fn loops_on_hulls_of_random_points_end() {
    let cases: [(usize, &[u64]); 4] =
        [(5, &[0, 1, 2, 5, 9, 10, 11]), (10, &[0, 2, 4, 8, 9, 10]), (30, &[0, 1, 2, 5, 6]), (100, &[0, 1])];
    for (n, seeds) in cases {
        for &seed in seeds {
            let (rounds, last) = refine(&random_points(n, seed), &ArrayOptions::default(), 400);
            assert!(rounds < 100, "{rounds} rounds for {n} points, seed {seed}");
            // What is left is counted.
            assert!(last.bad_edges.is_empty() || last.refused >= last.bad_edges.len());
        }
    }
}

#[test]
fn a_least_distance_ends_loops_early() {
    let points = random_points(30, 1);
    let mut least = f64::INFINITY;
    for (i, p) in points.iter().enumerate() {
        least = points[..i].iter().map(|q| q.distance(*p)).fold(least, f64::min);
    }
    let options = ArrayOptions { min_edge: 0.5 * least, ..ArrayOptions::default() };
    let mut host = Host::new(&points);
    let mut rounds = 0;
    loop {
        let batch = host.round(&options);
        if batch.points.is_empty() {
            assert!(batch.refused > 0);
            break;
        }
        for point in &batch.points {
            let near = host.t.points().iter().map(|q| q.distance(point.position)).fold(f64::INFINITY, f64::min);
            assert!(near >= options.min_edge, "{point:?} at {near}");
            host.t.insert(point.position, None).unwrap();
        }
        rounds += 1;
        assert!(rounds < 400, "no end");
    }
    let (without, _) = refine(&points, &ArrayOptions::default(), 400);
    assert!(rounds < without, "{rounds} rounds, {without} without");
}
