//! Refined meshes of small boxes: CGAL's triangulation of the vertices, the bound kept by exact arithmetic, the
//! boundary conforming, and the domain filled to the last bit.

mod common;

use std::collections::BTreeSet;

use common::*;
use glam::DVec3;
use proptest::prelude::*;
use wellspaced::{Control, Mesh, Plc, RefineOptions, RefineStatus, Rule, Sparsify, StepOptions};
use wellspaced_oracle as oracle;
use wellspaced_oracle::Point;

const LOW: f64 = -4.0;
const HIGH: f64 = 12.0;

fn boxed(points: &[Point]) -> Mesh {
    let plc = Plc::boxed(DVec3::splat(LOW), DVec3::splat(HIGH), dvecs(points));
    Mesh::from_plc(&plc, &Control::default()).unwrap()
}

fn vertices(mesh: &Mesh) -> Vec<Point> {
    mesh.view().points.iter().map(|p| p.to_array()).collect()
}

/// What has to hold of the mesh of a box at any time.
fn fills_the_box(mesh: &Mesh) -> Result<(), TestCaseError> {
    let points = vertices(mesh);
    let cgal = oracle::delaunay(&points).unwrap();
    let view = mesh.view();
    let expected: BTreeSet<_> = cgal.tetrahedra.iter().map(|&t| sorted(t)).collect();
    let found: BTreeSet<_> = view.tetrahedra.iter().map(|&t| sorted(t)).collect();
    same_sets(&found, &expected)?;
    sound_view(mesh)?;
    // Every hull facet lies in a side of the box, and the box is full.
    for facet in &cgal.hull {
        let corners = facet.map(|v| points[v as usize]);
        let in_a_side = (0..3).any(|k| [LOW, HIGH].iter().any(|&side| corners.iter().all(|c| c[k] == side)));
        ensure(in_a_side, || format!("hull facet {corners:?} lies in no side of the box"))?;
    }
    let box_points: Vec<Point> =
        (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| if bit == 0 { LOW } else { HIGH })).collect();
    let box_cells = oracle::delaunay(&box_points).unwrap().tetrahedra;
    let difference = oracle::compare_volumes(&points, view.tetrahedra, &box_points, &box_cells).unwrap();
    ensure(difference == 0, || format!("the volume is {difference:+} against the box"))
}

/// What has to hold when a refinement is done.
fn keeps_the_bound(mesh: &Mesh, beta: f64, unencroached: bool) -> Result<(), TestCaseError> {
    let points = vertices(mesh);
    for tet in mesh.view().tetrahedra {
        let corners = tet.map(|v| points[v as usize]);
        ensure(!oracle::over_bound(corners, beta).unwrap(), || format!("{tet:?} {corners:?} is over {beta}"))?;
    }
    ensure(mesh.bad_short_edges(beta).unwrap().is_empty(), || "bad short edges are left".into())?;
    // No subfacet and no subsegment is encroached, unless vertices have been taken away again or the sparse rule has let them be: by the corner opposite
    // a hull facet or in it at most.
    let view = mesh.view();
    for (tet, neighbours) in view.tetrahedra.iter().zip(view.neighbours) {
        for i in (0..4).filter(|&i| neighbours[i] == u32::MAX) {
            let at = |j: usize| points[tet[(i + j) % 4] as usize];
            let sphere = oracle::side_of_smallest_sphere([at(1), at(2), at(3), at(0)]).unwrap();
            ensure(!unencroached || sphere <= 0, || {
                format!("vertex {} encroaches on the subfacet opposite it in {tet:?}", tet[i])
            })?;
        }
    }
    Ok(())
}

fn refined(points: &[Point], beta: f64, rule: Rule) -> Result<(), TestCaseError> {
    for level in [Sparsify::Off, Sparsify::Moves, Sparsify::Quick, Sparsify::Thorough] {
        refined_with(points, beta, rule, level)?;
    }
    Ok(())
}

fn refined_with(points: &[Point], beta: f64, rule: Rule, level: Sparsify) -> Result<(), TestCaseError> {
    let mut mesh = boxed(points);
    fills_the_box(&mesh)?;
    let input = vertices(&mesh);
    let options = RefineOptions {
        radius_edge: beta,
        rule,
        max_vertices: 200_000,
        sparsify: Some(level),
        ..RefineOptions::default()
    };
    let report = mesh.refine(&options, &Control::default()).unwrap();
    prop_assert_eq!(report.status, RefineStatus::Done);
    prop_assert_eq!(report.bad, 0);
    // A rounded figure: keeps_the_bound has the exact answer.
    prop_assert!(report.worst_radius_edge <= beta * (1.0 + 1e-9));
    prop_assert_eq!(report.vertices, mesh.triangulation().vertex_count());
    prop_assert_eq!(report.tetrahedra, mesh.view().tetrahedra.len());
    prop_assert_eq!(report.input_vertices + report.steiner, report.vertices);
    // The kinds are of this call; the domain's recovery has added some before.
    let added = report.samples + report.segment_splits + report.facet_splits;
    let gone = report.removed + report.replaced;
    prop_assert_eq!(input.len() + added, report.vertices + gone);
    prop_assert!(level != Sparsify::Off || gone == 0);
    let kept = if gone == 0 { input.len() } else { report.input_vertices };
    prop_assert_eq!(&vertices(&mesh)[..kept], &input[..kept], "input vertices keep their ids and places");
    fills_the_box(&mesh)?;
    let lazy = rule == Rule::Sparse && level != Sparsify::Off;
    keeps_the_bound(&mesh, beta, gone == 0 && !lazy)
}

fn any_rule() -> impl Strategy<Value = Rule> {
    prop::sample::select(vec![Rule::Sparse, Rule::Paper, Rule::Circumcenter])
}

fn any_beta() -> impl Strategy<Value = f64> {
    prop::sample::select(vec![1.5, 2.0, 4.0, 8.0])
}

/// A vertex on a segment was moved off the wall by rounding, which left flat tetrahedra there.
#[test]
fn vertices_that_are_moved_stay_on_the_walls() {
    let points = [
        [-4.0, 3.2286231667466776, 10.271999625941632],
        [12.0, 5.435010376549466, 4.0],
        [1.1959175230194585, -4.0, -2.167027809241647],
        [-4.0, 5.2099875152980655, 8.488216093303317],
        [10.095303183213009, 9.510440430821948, -4.0],
        [12.0, 3.290356992969828, 0.06204794480312348],
        [10.926631780588558, 2.200193620197995, -4.0],
    ];
    refined(&points, 2.0, Rule::Circumcenter).unwrap();
}

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn random_points(points in sets(uniform(), 20), beta in any_beta(), rule in any_rule()) {
        refined(&points, beta, rule)?;
    }

    #[test]
    fn grid_points(points in sets(grid(4), 30), beta in any_beta(), rule in any_rule()) {
        refined(&points, beta, rule)?;
    }

    #[test]
    fn points_in_a_plane(points in sets(coplanar(), 12), beta in any_beta(), rule in any_rule()) {
        refined(&points, beta, rule)?;
    }

    #[test]
    fn points_on_the_sides(
        points in sets((0..3usize, any::<bool>(), uniform()).prop_map(|(k, high, p)| {
            let mut p = p.map(|x| 4.0 + 7.0 * x);
            p[k] = if high { HIGH } else { LOW };
            p
        }), 12),
        beta in any_beta(),
        rule in any_rule(),
    ) {
        refined(&points, beta, rule)?;
    }

    #[test]
    fn step_by_step(points in sets(prop_oneof![uniform(), grid(4)], 12), beta in any_beta(), rule in any_rule()) {
        let mut mesh = boxed(&points);
        let options = StepOptions { radius_edge: beta, rule };
        let mut steps = 0;
        let mut stalled = None;
        while let Some(&edge) = mesh.bad_short_edges(beta).unwrap().first() {
            let batch = mesh.steiner_batch(edge, &options).unwrap();
            prop_assert!(!batch.points.is_empty(), "bad edge {:?} gets no Steiner point", edge);
            let before = mesh.triangulation().vertex_count();
            let vertices = mesh.insert_batch(&batch).unwrap();
            prop_assert_eq!(vertices.len(), batch.points.len());
            let mut new: Vec<u32> = vertices.into_iter().flatten().filter(|&v| v as usize >= before).collect();
            new.sort_unstable();
            new.dedup();
            prop_assert_eq!(mesh.triangulation().vertex_count(), before + new.len());
            // A split may give way to one that has to come first: then the next batch is another.
            prop_assert!(stalled.as_ref() != Some(&batch), "batch {:?} adds nothing again", batch);
            stalled = new.is_empty().then_some(batch);
            steps += 1;
            prop_assert!(steps < 20_000, "no end in sight");
            if steps % 64 == 1 {
                fills_the_box(&mesh)?;
            }
        }
        fills_the_box(&mesh)?;
        for tet in mesh.view().tetrahedra {
            let corners = tet.map(|v| mesh.view().points[v as usize].to_array());
            prop_assert!(!oracle::over_bound(corners, beta).unwrap());
        }
    }

    #[test]
    fn bad_short_edges_tell_bad_tetrahedra(points in sets(prop_oneof![uniform(), grid(4)], 20), beta in any_beta()) {
        // Theorem 2: there is a bad short edge iff there is a bad tetrahedron.
        let mesh = boxed(&points);
        let view = mesh.view();
        let over = view.tetrahedra.iter().any(|tet| {
            oracle::over_bound(tet.map(|v| view.points[v as usize].to_array()), beta).unwrap()
        });
        let edges = mesh.bad_short_edges(beta).unwrap();
        prop_assert!(over != edges.is_empty(), "over the bound: {over}, bad short edges: {edges:?}");
    }
}

#[test]
fn an_empty_box_is_refined_to_any_bound() {
    for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
        for beta in [1.2, 1.5, 2.0, 8.0] {
            refined(&[], beta, rule).unwrap();
        }
    }
}

#[test]
fn the_first_data_set_in_small() {
    // Two points at unit distance in a box 16,000 times as large as they are apart, once at its middle, once near a
    // side.
    for points in [[[4.0, 4.0, 4.0], [4.001, 4.0, 4.0]], [[4.0, 4.0, -3.75], [4.001, 4.0, -3.75]]] {
        for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
            for beta in [1.5, 2.0, 4.0, 8.0] {
                refined(&points, beta, rule).unwrap();
            }
        }
    }
}
