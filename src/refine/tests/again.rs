//! Calls that are stopped early, each of which goes on where another has ended.

use super::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A control that cancels at the report of progress of this number.
fn cancelling(reports: usize) -> Control {
    let count = AtomicUsize::new(0);
    Control::with_progress(move |_| count.fetch_add(1, Ordering::Relaxed) + 1 < reports)
}

/// Calls until one is not cancelled, and returns how many there were.
fn in_calls(reports: usize, mut call: impl FnMut(&Control) -> RefineReport) -> usize {
    let end = (1..400).find(|_| call(&cancelling(reports)).status != RefineStatus::Cancelled);
    end.unwrap_or_else(|| panic!("cancelled at report {reports} each time, it does not end"))
}

#[test]
fn refinements_that_are_cancelled_early_come_to_an_end() {
    for (reports, sparsify) in [(2, Sparsify::Quick), (5, Sparsify::Quick), (2, Sparsify::Thorough), (2, Sparsify::Off)]
    {
        let mut mesh = Mesh::from_plc(&random_box(200, 7), &Control::new()).unwrap();
        let options = RefineOptions { radius_edge: 1.3, sparsify: Some(sparsify), ..RefineOptions::default() };
        let calls = in_calls(reports, |control| mesh.refine(&options, control).unwrap());
        assert!(calls > 1, "{calls}");
        check(&mesh, 1.3, 27.0);
        assert!(mesh.unfinished.is_none() && mesh.triangulation().vertices().eq(0..mesh.view().points.len() as u32));
    }
}

#[test]
fn a_pass_that_is_cancelled_at_each_block_ends_with_about_as_few_vertices() {
    let mut mesh = Mesh::from_plc(&random_box(200, 7), &Control::new()).unwrap();
    let options = RefineOptions { sparsify: Some(Sparsify::Off), ..RefineOptions::default() };
    mesh.refine(&options, &Control::new()).unwrap();
    let (before, mut at_once) = (mesh.triangulation().vertex_count(), mesh.clone());
    at_once.sparsify(2.0, Sparsify::Quick, &Control::new()).unwrap();
    assert!(in_calls(1, |control| mesh.sparsify(2.0, Sparsify::Quick, control).unwrap()) > 5);
    check(&mesh, 2.0, 27.0);
    let fewer = |mesh: &Mesh| (before - mesh.triangulation().vertex_count()) as f64;
    assert!(fewer(&mesh) > 0.8 * fewer(&at_once), "{} and {}", fewer(&mesh), fewer(&at_once));
}

#[test]
fn what_was_tried_is_forgotten_when_something_changes() {
    let mut mesh = Mesh::from_plc(&random_box(200, 7), &Control::new()).unwrap();
    let refine = |mesh: &mut Mesh, radius_edge: f64, control: &Control| {
        mesh.refine(&RefineOptions { radius_edge, ..RefineOptions::default() }, control).unwrap()
    };
    assert_eq!(refine(&mut mesh, 2.0, &cancelling(2)).status, RefineStatus::Cancelled);
    assert!(mesh.unfinished.is_some());
    // A control that is cancelled already changes nothing.
    assert_eq!(refine(&mut mesh, 2.0, &cancelling(1)).status, RefineStatus::Cancelled);
    assert!(mesh.unfinished.is_some());
    assert_eq!(refine(&mut mesh, 1.3, &Control::new()).status, RefineStatus::Done);
    check(&mesh, 1.3, 27.0);
    assert_eq!(refine(&mut mesh, 1.2, &cancelling(2)).status, RefineStatus::Cancelled);
    mesh.forget_view();
    assert!(mesh.unfinished.is_none());
}
