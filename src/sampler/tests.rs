use proptest::prelude::*;

use super::*;
use crate::{Control, Triangulation};

fn ring(count: usize, radius: f64, height: f64) -> Vec<DVec3> {
    (0..count)
        .map(|i| {
            let angle = i as f64 * std::f64::consts::TAU / count as f64;
            DVec3::new(radius * angle.cos(), radius * angle.sin(), height * (i % 2) as f64)
        })
        .collect()
}

const P: DVec3 = DVec3::new(0.0, 0.0, -0.5);
const Q: DVec3 = DVec3::new(0.0, 0.0, 0.5);

#[test]
fn a_distant_ring_gets_eight_samples_that_close_the_disk() {
    for beta in [1.5, 2.0, 4.0] {
        let link = ring(12, 100.0, 0.1);
        let samples = sample_edge(P, Q, &link, true, beta, Rule::Paper).unwrap();
        assert_eq!(samples.points.len(), 8);
        assert_eq!(samples.span, std::f64::consts::TAU);
        // After the insertion the facet is the octagon of the chords: its corners are on the rim.
        let facet = VoronoiFacet::new(P, Q, &samples.points, true);
        let core = facet.core_radius(beta);
        for corner in facet.corners() {
            assert!(corner.length() <= core && corner.length() > core * (1.0 - 1e-8));
        }
        assert!(!is_bad_edge(P, Q, &samples.points, true, beta));
    }
}

#[test]
fn the_paper_s_sample_counts() {
    use std::f64::consts::PI;
    let cases = [(0.1, 1), (0.499 * PI, 1), (0.5 * PI, 2), (0.74 * PI, 2), (0.76 * PI, 3), (PI, 4), (2.0 * PI, 8)];
    for (span, count) in cases {
        assert_eq!(paper::sample_count(span), count, "{span}");
    }
}

#[test]
fn our_own_sample_counts() {
    let cases = [(1, 1), (125, 1), (127, 2), (209, 2), (211, 3), (293, 3), (295, 4), (360, 4)];
    for (degrees, count) in cases {
        assert_eq!(sparse::sample_count(f64::from(degrees).to_radians()), count, "{degrees}");
    }
    let link = ring(12, 100.0, 0.1);
    let samples = sample_edge(P, Q, &link, true, 2.0, Rule::Sparse).unwrap();
    assert_eq!(samples.points.len(), 4);
    assert!(!is_bad_edge(P, Q, &samples.points, true, 2.0));
}

#[test]
fn good_edges_get_nothing() {
    let link = ring(6, 1.0, 0.0);
    assert!(!is_bad_edge(P, Q, &link, true, 2.0));
    assert_eq!(sample_edge(P, Q, &link, true, 2.0, Rule::Paper), None);
    assert_eq!(sample_edge(P, Q, &link, true, 2.0, Rule::Circumcenter), None);
    assert_eq!(sample_edge(P, Q, &[], true, 2.0, Rule::Paper), None);
    assert_eq!(sample_edge(P, Q, &[DVec3::X], false, 2.0, Rule::Paper), None);
}

#[test]
fn several_components_give_the_largest() {
    // Near vertices left and right leave components above and below; the lower one is wider, as a vertex above is nearer.
    let link = [
        DVec3::new(2.0, 0.0, 0.0),
        DVec3::new(0.0, 30.0, 0.0),
        DVec3::new(-2.0, 0.3, 0.0),
        DVec3::new(0.0, -50.0, 0.0),
    ];
    let samples = sample_edge(P, Q, &link, true, 2.0, Rule::Paper).unwrap();
    assert!(samples.points.iter().all(|s| s.y < 0.0), "{samples:?}");
}

#[test]
fn samples_beyond_the_facet_stop_at_its_side() {
    // The square facet reaches 2.07 (half a side), the disk 1.94: each of the eight rays leaves the facet before d ≈ 3.7.
    let link = [DVec3::X * 4.2, DVec3::Y * 4.2, DVec3::NEG_X * 4.2, DVec3::NEG_Y * 4.2];
    let facet = VoronoiFacet::new(P, Q, &link, true);
    let samples = sample_edge(P, Q, &link, true, 2.0, Rule::Paper).unwrap();
    for s in &samples.points {
        let (d, r) = (s.distance(P), link.iter().map(|l| l.distance(*s)).fold(f64::INFINITY, f64::min));
        assert!(d <= r * (1.0 + 1e-12) && d >= 2.0 * facet.length * (1.0 - 1e-8), "{s}: {d} {r}");
    }
    // The samples on the sides would be nearer than β to those at the corners: one at a time.
    assert_eq!(samples.points.len(), 1);
}

#[test]
fn a_lone_sample_goes_to_a_crowded_corner() {
    // A short edge of a unit sphere's surface; the link's first and last vertices are its neighbours, the others are on the far side, at their distances from
    // the centre.
    let sample = |edge: f64, far: [f64; 2]| {
        let on_sphere = |x: f64, y: f64| DVec3::new(x, y, (1.0 - x * x - y * y).sqrt());
        let [p, q] = [on_sphere(-0.5 * edge, 0.0), on_sphere(0.5 * edge, 0.0)];
        let [b, c] = [DVec3::new(0.6, 0.0, -0.8) * far[0], DVec3::new(-0.48, 0.36, -0.8) * far[1]];
        let link = [on_sphere(0.0, 0.25), b, c, on_sphere(0.0, -0.25)];
        let facet = VoronoiFacet::new(p, q, &link, false);
        let [batch, first] =
            [sample_component(&facet, &mut Vec::new(), 2.0, Rule::Sparse), sample_first(&facet, &mut Vec::new(), 2.0)];
        assert_eq!(batch, first);
        batch.unwrap().points[0]
    };
    assert!(sample(0.28, [1.0; 2]).length() < 1e-8);
    assert!(sample(0.28, [1.0001; 2]).length() < 1e-3);
    // Nobody else is there, or it is farther than a sample reaches.
    for (edge, far) in [(0.28, [1.01; 2]), (0.2, [1.0; 2])] {
        let distance = 1.0 - sample(edge, far).length();
        assert!((distance / edge - 3.05).abs() < 0.1, "{}", distance / edge);
    }
}

#[test]
fn a_facet_that_misses_its_disk_falls_back_to_the_circumcentre() {
    let link = [DVec3::new(0.1, 0.0, 0.0), DVec3::new(-3.0, 90.0, 0.0), DVec3::new(-3.0, -90.0, 0.0)];
    let samples = sample_edge(P, Q, &link, true, 2.0, Rule::Paper).unwrap();
    assert_eq!((samples.points.len(), samples.span), (1, 0.0));
}

#[test]
fn hull_edges_are_sampled_inside() {
    let link = [DVec3::new(50.0, 0.0, 0.0), DVec3::new(40.0, 40.0, 3.0), DVec3::new(0.0, 50.0, 0.0)];
    let samples = sample_edge(P, Q, &link, false, 2.0, Rule::Paper).unwrap();
    assert_eq!(samples.points.len(), 2);
    assert!(samples.points.iter().all(|s| s.x > 0.0 && s.y > 0.0));
}

fn cloud() -> impl Strategy<Value = Vec<DVec3>> {
    let point = (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z): (f64, f64, f64)| DVec3::new(x, y, z));
    prop::collection::vec(point, 8..40)
}

proptest! {
    /// Lemmas 1 and 2 on all bad short edges of random triangulations.
    #[test]
    fn samples_keep_their_distances(points in cloud(), beta in 2.0..6.0f64, shrink in 1e-3..1.0f64) {
        // Draw two points together, so that bad edges abound.
        let mut points = points;
        points[1] = points[0] + (points[1] - points[0]) * shrink;
        let mut t = Triangulation::new();
        t.insert_many(&points, &Control::new()).unwrap();
        let mut edges: Vec<[u32; 2]> = t.tetrahedra().flat_map(|v| EDGES.map(|[i, j]| [v[i].min(v[j]), v[i].max(v[j])])).collect();
        edges.sort_unstable();
        edges.dedup();
        for [p, q] in edges {
            let (link, closed) = t.link([p, q]).unwrap();
            let link: Vec<DVec3> = link.into_iter().map(|v| t.point(v).unwrap()).collect();
            let (p, q) = (t.point(p).unwrap(), t.point(q).unwrap());
            let bad = is_bad_edge(p, q, &link, closed, beta);
            let samples = sample_edge(p, q, &link, closed, beta, Rule::Paper);
            prop_assert_eq!(bad, samples.is_some());
            let length = p.distance(q) * (1.0 - 1e-8);
            let check = |samples: Option<Samples>, to_vertices: f64| {
                let Some(samples) = samples.filter(|s| s.span > 0.0) else { return Ok(()) };
                for (i, s) in samples.points.iter().enumerate() {
                    for &v in &points {
                        prop_assert!(s.distance(v) >= to_vertices * length, "Lemma 1: {} from {}", s, v);
                    }
                    for r in &samples.points[..i] {
                        prop_assert!(s.distance(*r) >= beta * length, "Lemma 2: {} from {}", s, r);
                    }
                }
                Ok(())
            };
            check(samples, beta)?;
            // Our own rule keeps the distance of its widest piece, or β where the facet ends before.
            let widest = paper::sample_distance(sparse::MAX_THETA, 1.0, beta).hypot(0.5);
            prop_assert!(widest > 1.0);
            check(sample_edge(p, q, &link, closed, beta, Rule::Sparse), widest.min(beta))?;
            if bad {
                // Each sample by its own angle; the first alone may have a wider piece, down to β = 1.
                let facet = VoronoiFacet::new(p, q, &link, closed);
                for beta in [beta, 0.25 * beta + 0.5] {
                    let own = |s: &Samples| paper::sample_distance(s.theta.max(80f64.to_radians()), 1.0, beta).hypot(0.5).min(beta);
                    let mut arcs = Vec::new();
                    if let Some(first) = sample_first(&facet, &mut arcs, beta) {
                        let least = own(&first);
                        prop_assert!(least >= sparse::WIDE_DISTANCE.min(beta) || first.theta <= sparse::MAX_THETA);
                        prop_assert!(least >= 1.0);
                        check(Some(first), least)?;
                    }
                    if let Some(all) = sample_component(&facet, &mut arcs, beta, Rule::Sparse).filter(|s| s.points.len() == 1) {
                        let least = own(&all);
                        check(Some(all), least)?;
                    }
                }
            }
        }
    }

    /// Theorem 2: there is a bad tetrahedron exactly when there is a bad short edge.
    #[test]
    fn bad_tetrahedra_have_bad_short_edges(points in cloud(), beta in 1.0..3.0f64) {
        let mut t = Triangulation::new();
        t.insert_many(&points, &Control::new()).unwrap();
        for v in t.tetrahedra() {
            let corners = v.map(|v| t.point(v).unwrap());
            let shortest = EDGES.into_iter().min_by(|&[i, j], &[k, l]| {
                corners[i].distance_squared(corners[j]).total_cmp(&corners[k].distance_squared(corners[l]))
            }).unwrap().map(|i| v[i]);
            let (link, closed) = t.link(shortest).unwrap();
            let link: Vec<DVec3> = link.into_iter().map(|v| t.point(v).unwrap()).collect();
            let [p, q] = shortest.map(|v| t.point(v).unwrap());
            if exceeds_radius_edge(corners, beta) {
                prop_assert!(is_bad_short_edge(p, q, &link, closed, beta));
                prop_assert!(is_bad_edge(p, q, &link, closed, beta));
            }
        }
    }
}
