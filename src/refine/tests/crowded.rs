//! The boundary beside a vertex with all others around it: each split changes a large star.

use super::refiner::{Placed, Refiner};
use super::restore::Element;
use super::split::Split;
use super::*;
use crate::domain::pending::Demand;
use crate::samples::facet;

const COUNT: usize = 5000;

/// A triangle from the centre of a sphere on which most vertices are, within a box, and a point that encroaches upon it.
fn centred() -> Mesh {
    let mut plc = Plc::boxed(DVec3::splat(-2.0), DVec3::splat(2.0), on_a_sphere(COUNT));
    let centre = plc.points.len() as u32;
    plc.points.extend([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.1, 0.4, 0.0], [0.2, 0.15, 0.01]].map(DVec3::from));
    plc.facets.push(facet([centre, centre + 1, centre + 2], 7));
    Mesh::from_plc(&plc, &Control::new()).unwrap()
}

/// The longest side of the triangle at the centre.
fn side(mesh: &Mesh) -> [u32; 2] {
    let centre = COUNT as u32 + 8;
    let boundary = mesh.boundary().unwrap();
    let at_centre = |&([a, b], _): &([u32; 2], u32)| a == centre || b == centre;
    let length = |[a, b]: [u32; 2]| mesh.triangulation().at(a).distance(mesh.triangulation().at(b));
    let sides = boundary.subsegments().into_iter().filter(at_centre).map(|(edge, _)| edge);
    sides.max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap()
}

#[test]
fn a_refinement_is_cancelled_amid_splits_in_large_stars() {
    let mesh = centred();
    let vertices = mesh.view().points.len();
    for sparsify in [Some(Sparsify::Off), None] {
        let some = RefineOptions { max_vertices: vertices + 4, sparsify, ..RefineOptions::default() };
        let control = Control::new();
        let looks = control.looks(None, || assert!(mesh.clone().refine(&some, &control).is_ok()));
        assert!(looks > 100, "{looks}");
        let mut changed = 0;
        for (turn, last) in (1..looks).step_by(looks / 50).enumerate() {
            let mut mesh = mesh.clone();
            control.looks(Some(last), || {
                let report = mesh.refine(&some, &control).unwrap();
                assert_eq!(report.status, RefineStatus::Cancelled, "look {last} of {looks}");
            });
            mesh.validate(3).unwrap();
            changed += usize::from(mesh.view().points.len() > vertices);
            if turn % 10 == 0 {
                let all = RefineOptions { sparsify, ..RefineOptions::default() };
                assert_eq!(mesh.refine(&all, &Control::new()).unwrap().status, RefineStatus::Done);
                check(&mesh, 2.0, 64.0);
            }
        }
        assert!(changed > 5, "{changed}");
    }
}

/// Has `insert` insert a vertex and cancels it at each look: it does all of it or nothing, and then the call ends. How often it did nothing, and how often it
/// left out a look at what it had created.
fn cancel_at_each_look(mesh: &Mesh, insert: impl Fn(&mut Refiner) -> Result<bool, Error>) -> [usize; 2] {
    let vertices = mesh.triangulation().vertex_count();
    let elements = |mesh: &Mesh| mesh.boundary().map(|boundary| (boundary.subsegments(), boundary.subfacets()));
    let [mut refused, mut cut_short] = [0; 2];
    for last in 1.. {
        let mut changed = mesh.clone();
        let control = Control::new();
        let (t, boundary) = changed.parts();
        let mut refiner = Refiner::new(t, boundary.unwrap(), &RefineOptions::default());
        refiner.watch_with(&control);
        let mut inserted = None;
        let looks = control.looks(Some(last), || inserted = Some(insert(&mut refiner)));
        match inserted.unwrap() {
            Err(error) => {
                assert_eq!((error, refiner.is_cut_short), (Error::Cancelled, false));
                refused += 1;
                assert_eq!(changed.triangulation().vertex_count(), vertices);
                assert!(elements(&changed) == elements(mesh));
            }
            Ok(inserted) => {
                assert!(inserted);
                // Though the control is as new.
                let end = refiner.limit(&mut 0, "refine", &control).unwrap();
                let is_cut_short = end == Some(RefineStatus::Cancelled);
                assert_eq!(is_cut_short, looks >= last);
                cut_short += usize::from(is_cut_short);
                assert_eq!(changed.triangulation().vertex_count(), vertices + 1);
                if !is_cut_short {
                    changed.validate(3).unwrap();
                    break;
                }
            }
        }
        if last % 16 == 0 {
            changed.validate(3).unwrap();
        }
    }
    [refused, cut_short]
}

#[test]
fn a_split_in_a_large_star_is_done_whole_or_not_at_all() {
    let mesh = centred();
    let star = mesh.triangulation().topology.star(COUNT as u32 + 8).len();
    assert!(star > COUNT / 2, "{star}");
    let edge = side(&mesh);
    let [refused, cut_short] = cancel_at_each_look(&mesh, |refiner| {
        refiner.transact(Element::Segment(edge), Demand::NONE).map(|split| matches!(split, Split::Done(_)))
    });
    assert!(refused > 20 && cut_short > 10, "{refused} {cut_short}");
}

#[test]
fn a_sample_in_a_large_star_is_inserted_whole_or_not_at_all() {
    let mesh = centred();
    let [refused, cut_short] = cancel_at_each_look(&mesh, |refiner| {
        let near = refiner.t.recent();
        let placed = refiner.place(DVec3::new(-0.1, -0.1, 0.05), near);
        placed.map(|placed| matches!(placed, Placed::Inserted(_)))
    });
    assert!(refused > 20 && cut_short > 10, "{refused} {cut_short}");
}

/// Two fans of triangles around the centre of a sphere, one just above the other: what splits one takes out some of the other.
fn layered() -> Mesh {
    let mut plc = Plc::boxed(DVec3::splat(-2.0), DVec3::splat(2.0), on_a_sphere(COUNT));
    for height in [0.0, 0.01] {
        let centre = plc.points.len() as u32;
        plc.points.push(DVec3::Z * height);
        let angles = (0..6).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_3 + height);
        plc.points.extend(angles.map(|angle| DVec3::new(0.5 * angle.cos(), 0.5 * angle.sin(), height)));
        plc.facets.extend((0..6).map(|i| facet([centre, centre + 1 + i, centre + 1 + (i + 1) % 6], 7)));
    }
    Mesh::from_plc(&plc, &Control::new()).unwrap()
}

/// A cylinder between two round facets with many corners.
fn cylinder() -> Mesh {
    const SIDES: u32 = 600;
    let corner = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k % SIDES) / f64::from(SIDES)).sin_cos();
        DVec3::new(cos, sin, if k < SIDES { 0.0 } else { 2.0 })
    };
    let sides = (0..SIDES).map(|k| vec![k, (k + 1) % SIDES, SIDES + (k + 1) % SIDES, SIDES + k]);
    let polygons = sides.chain([(0..SIDES).collect(), (SIDES..2 * SIDES).collect()]);
    let facets = polygons.map(|polygon| PlcFacet { polygons: vec![polygon], ..PlcFacet::default() }).collect();
    let plc = Plc { points: (0..2 * SIDES).map(corner).collect(), facets, ..Plc::default() };
    Mesh::from_plc(&plc, &Control::new()).unwrap()
}

/// Has an element split and cancels that at each of many looks: the split and all that follows is done or nothing is. How many vertices there are more after it,
/// and how often it was cancelled, in all and in its second half.
fn split_whole_or_not_at_all(mesh: &Mesh, element: Element) -> [usize; 3] {
    let split = |mesh: &mut Mesh, control: &Control| {
        let (t, boundary) = mesh.parts();
        let mut refiner = Refiner::new(t, boundary.unwrap(), &RefineOptions::default());
        refiner.watch_with(control);
        refiner.transact(element, Demand::NONE)
    };
    let state = |mesh: &Mesh| {
        let boundary = mesh.boundary().unwrap();
        let vertices = mesh.triangulation().vertex_count();
        (vertices, boundary.subsegments(), boundary.subfacets(), mesh.inside().count())
    };
    let (before, control, mut whole) = (state(mesh), Control::new(), mesh.clone());
    let looks = control.looks(None, || assert!(matches!(split(&mut whole, &control), Ok(Split::Done(_)))));
    whole.validate(3).unwrap();
    let after = state(&whole);
    let (mut cancelled, mut amid) = (0, 0);
    for last in (1..looks).step_by(looks / 90 + 1) {
        let mut mesh = mesh.clone();
        let mut done = Err(Error::Cancelled);
        let made = control.looks(Some(last), || done = split(&mut mesh, &control));
        assert!(made <= last + 12, "{made} of {last}");
        match done {
            Err(error) => {
                assert_eq!(error, Error::Cancelled);
                assert!(state(&mesh) == before, "look {last} of {looks}");
                cancelled += 1;
                amid += usize::from(2 * last > looks);
            }
            Ok(_) => assert!(state(&mesh) == after, "look {last} of {looks}"),
        }
        mesh.validate(3).unwrap();
    }
    [after.0 - before.0, cancelled, amid]
}

#[test]
fn splits_that_follow_a_large_one_are_done_with_it_or_not_at_all() {
    let mesh = layered();
    let [vertices, cancelled, amid] = split_whole_or_not_at_all(&mesh, Element::Segment(side(&mesh)));
    assert!(vertices >= 2 && cancelled > 60 && amid > 20, "{vertices} {cancelled} {amid}");
}

#[test]
fn a_split_that_changes_a_whole_round_facet_is_done_or_not() {
    let mesh = cylinder();
    let area = |face: [u32; 3]| {
        let [a, b, c] = face.map(|v| mesh.triangulation().at(v));
        (b - a).cross(c - a).z.abs()
    };
    let faces = mesh.boundary().unwrap().subfacets().into_iter().map(|(face, _)| face);
    let flat = faces.filter(|face| face.iter().all(|&v| mesh.triangulation().at(v).z == 0.0));
    let face = flat.max_by(|&a, &b| area(a).total_cmp(&area(b))).unwrap();
    let [vertices, cancelled, amid] = split_whole_or_not_at_all(&mesh, Element::Facet(face));
    assert!(vertices >= 1 && cancelled > 30 && amid > 10, "{vertices} {cancelled} {amid}");
}
