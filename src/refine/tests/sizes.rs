//! Sizes at vertices, over several calls.

use super::*;
use crate::Sizing;

/// The corners of the unit box, refined with these sizes at them.
fn unit_box() -> Mesh {
    Mesh::from_plc(&Plc::boxed(DVec3::ZERO, DVec3::ONE, []), &Control::new()).unwrap()
}

fn refine_with(mesh: &mut Mesh, vertices: &[f64], max_vertices: usize) -> RefineReport {
    let options = RefineOptions { max_vertices, ..RefineOptions::default() };
    mesh.refine_sized(&options, &Sizing { vertices, ..Sizing::default() }, &Control::new()).unwrap()
}

const GRADED: [f64; 8] = [0.05, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4];

#[test]
fn sizes_at_vertices_are_the_same_in_a_second_call() {
    let mut mesh = unit_box();
    let first = refine_with(&mut mesh, &GRADED, usize::MAX);
    assert_eq!((first.status, first.too_large), (RefineStatus::Done, 0));
    assert!(first.vertices < 2000, "{}", first.vertices);
    let second = refine_with(&mut mesh, &GRADED, usize::MAX);
    assert_eq!(second.status, RefineStatus::Done);
    assert!(second.vertices * 100 <= first.vertices * 101, "{} after {}", second.vertices, first.vertices);
    // A list that reaches what has come asks for what it says there.
    let mut all = vec![0.4; second.vertices];
    all[0] = 0.05;
    assert_eq!(refine_with(&mut mesh, &all, usize::MAX).status, RefineStatus::Done);
}

#[test]
fn what_a_limit_has_stopped_ends_like_a_single_call() {
    let mut whole = unit_box();
    let single = refine_with(&mut whole, &GRADED, usize::MAX).vertices as f64;
    for limit in [30, 100, 200] {
        let mut mesh = unit_box();
        assert_eq!(refine_with(&mut mesh, &GRADED, limit).status, RefineStatus::VertexLimit);
        let both = refine_with(&mut mesh, &GRADED, usize::MAX);
        assert_eq!((both.status, both.too_large), (RefineStatus::Done, 0));
        assert!((0.85..1.15).contains(&(both.vertices as f64 / single)), "{} of {single}", both.vertices);
    }
}

#[test]
fn one_size_stays_near_its_vertex() {
    for alone in [&[0.05][..], &[0.05, 0.0, -1.0, f64::NAN, f64::INFINITY, 0.0, 0.0, 0.0]] {
        let mut mesh = unit_box();
        let report = refine_with(&mut mesh, alone, usize::MAX);
        assert_eq!((report.status, report.too_large), (RefineStatus::Done, 0));
        // The size everywhere takes 46 915.
        assert!((20..4000).contains(&report.vertices), "{}", report.vertices);
        let (view, far) = (mesh.view(), DVec3::ONE);
        let near = view.points.iter().filter(|p| p.length() < 0.2).count();
        let away = view.points.iter().filter(|p| p.distance(far) < 0.2).count();
        assert!(near > 20 * away, "{near} and {away}");
        assert!(refine_with(&mut mesh, alone, usize::MAX).vertices * 100 <= report.vertices * 101);
    }
    assert_eq!(refine_with(&mut unit_box(), &[0.0, f64::NAN], usize::MAX).vertices, 8);
}

#[test]
fn finding_sizes_can_be_cancelled() {
    let mut mesh = Mesh::from_plc(&random_box(300, 3), &Control::new()).unwrap();
    let sizing = Sizing { vertices: &[0.3; 308], ..Sizing::default() };
    for looks in 1..40 {
        let control = Control::new();
        let refine = || {
            let report = mesh.refine_sized(&RefineOptions::default(), &sizing, &control).unwrap();
            assert_eq!(report.status, RefineStatus::Cancelled);
        };
        control.looks(Some(looks), refine);
    }
    let report = mesh.refine_sized(&RefineOptions::default(), &sizing, &Control::new()).unwrap();
    assert_eq!((report.status, report.too_large), (RefineStatus::Done, 0));
    check(&mesh, 2.0, 27.0);
}
