//! Where a boundary was refined lazily, and something else goes on: another rule, one batch at a time, or without splits.

use super::*;
use crate::samples::thin_plate;

/// A plate of which nearly all of the boundary is encroached, with two points near to each other inside; and its volume.
fn meshed() -> (Mesh, f64) {
    let mut plate = thin_plate();
    plate.points.extend([DVec3::new(3.0, 1.0, 2.9), DVec3::new(3.3, 1.0, 2.8)]);
    let mesh = Mesh::from_plc(&plate, &Control::new()).unwrap();
    let volume = volume(&mesh);
    (mesh, volume)
}

#[test]
fn any_rule_goes_on_where_one_was_cancelled() {
    let lazily = RefineOptions::default();
    let (mesh, whole) = meshed();
    let control = Control::new();
    let looks = control.looks(None, || assert!(mesh.clone().refine(&lazily, &control).is_ok()));
    assert!(looks > 200, "{looks}");
    let mut midway = 0;
    // The last ones come when all is done, while memory is given back.
    for (turn, last) in (1..looks * 3 / 4).step_by(looks / 16).enumerate() {
        let mut mesh = mesh.clone();
        control.looks(Some(last), || {
            let report = mesh.refine(&lazily, &control).unwrap();
            assert_eq!(report.status, RefineStatus::Cancelled, "look {last} of {looks}");
            midway += usize::from(report.segment_splits + report.facet_splits > 0);
        });
        mesh.validate(3).unwrap();
        let rule = [Rule::Circumcenter, Rule::Paper, Rule::Sparse][turn % 3];
        let options = RefineOptions { rule, sparsify: Some(Sparsify::Off), ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        assert_eq!((report.status, report.bad), (RefineStatus::Done, 0), "{rule:?}");
        check(&mesh, 2.0, whole);
        // What the other has left encroached has been split.
        let (t, boundary) = mesh.parts();
        let boundary = boundary.unwrap();
        boundary.enqueue_all(t, &Control::new()).unwrap();
        assert_eq!((boundary.next_pending_segment(), boundary.next_pending_facet()), (None, None), "{rule:?}");
    }
    assert!(midway > 3, "{midway}");
}

#[test]
fn steps_go_on_where_one_stopped_at_a_limit() {
    let (mut mesh, whole) = meshed();
    let lazily = RefineOptions { max_vertices: 80, ..RefineOptions::default() };
    assert_eq!(mesh.refine(&lazily, &Control::new()).unwrap().status, RefineStatus::VertexLimit);
    refine_in_steps(&mut mesh);
    check(&mesh, 2.0, whole);
}

#[test]
fn a_kept_boundary_stays_as_a_lazy_refinement_has_left_it() {
    let (mut mesh, whole) = meshed();
    let input = mesh.boundary().unwrap().subfacets();
    let some = RefineOptions { max_vertices: 80, ..RefineOptions::default() };
    assert_eq!(mesh.refine(&some, &Control::new()).unwrap().status, RefineStatus::VertexLimit);
    let before = mesh.boundary().unwrap().subfacets();
    assert_ne!(before, input);
    for rule in [Rule::Sparse, Rule::Circumcenter] {
        let kept = RefineOptions { rule, keep_boundary: true, ..RefineOptions::default() };
        let report = mesh.refine(&kept, &Control::new()).unwrap();
        mesh.validate(3).unwrap();
        assert_eq!(mesh.boundary().unwrap().subfacets(), before);
        assert_eq!((report.segment_splits, report.facet_splits), (0, 0));
        assert_eq!(report.bad, report.unrefined.iter().sum::<usize>());
        assert!(report.bad > 0, "{rule:?}");
    }
    let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
    assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
    check(&mesh, 2.0, whole);
}
