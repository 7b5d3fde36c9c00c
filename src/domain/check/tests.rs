use super::*;
use crate::{PlcFacet, PlcSegment};
use PlcDefectKind::*;

fn facet(polygon: &[u32]) -> PlcFacet {
    PlcFacet { polygons: vec![polygon.to_vec()], ..PlcFacet::default() }
}

fn unit_box() -> Plc {
    Plc::boxed(DVec3::ZERO, DVec3::splat(4.0), [])
}

/// The kinds found, each with its elements.
fn found(plc: &Plc) -> Vec<(PlcDefectKind, Vec<DomainElement>)> {
    plc.check().defects.into_iter().map(|defect| (defect.kind, defect.elements)).collect()
}

fn with_points(points: &[[f64; 3]]) -> Plc {
    let mut plc = unit_box();
    plc.points.extend(points.iter().copied().map(DVec3::from));
    plc
}

const fn f(i: usize) -> DomainElement {
    DomainElement::Facet(i)
}

const fn p(i: usize) -> DomainElement {
    DomainElement::Point(i)
}

const fn s(i: usize) -> DomainElement {
    DomainElement::Segment(i)
}

#[test]
fn a_box_is_sound_and_has_right_angles() {
    let check = unit_box().check();
    assert_eq!(check.defects, []);
    assert_eq!(check.segment_angle.unwrap().degrees, 90.0);
    assert!((check.facet_angle.unwrap().degrees - 90.0).abs() < 1e-12);
}

#[test]
fn every_defect_is_found_and_not_only_the_first() {
    // A point on a facet and one on a side, a duplicate point, a segment through a facet, a dangling triangle.
    let mut plc = with_points(&[[1.0, 1.0, 0.0], [2.0, 0.0, 0.0], [4.0, 4.0, 4.0], [1.0, 2.0, 3.0], [1.0, 2.0, 5.0]]);
    plc.segments.push(PlcSegment { ends: [11, 12], marker: 0 });
    plc.points.extend([[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [1.0, 2.0, 1.0]].map(DVec3::from));
    plc.facets.push(facet(&[13, 14, 15]));
    let open = (OpenEdge, vec![f(6)]);
    let expected = [
        (SegmentThroughFacet, vec![s(0), f(1)]),
        (DuplicatePoint, vec![p(10), p(7)]),
        (PointOnSegment, vec![p(9), f(0)]),
        (PointOnFacet, vec![p(8), f(0)]),
        open.clone(),
        open.clone(),
        open,
    ];
    assert_eq!(found(&plc), expected);
    let place = plc.check().defects[0].place;
    assert_eq!(place, DVec3::new(1.0, 2.0, 4.0));
    let error = plc.arrange(&Control::new()).unwrap_err();
    assert_eq!(error.to_string(), "segment 0: goes through facet 1 at (1, 2, 4)");
}

#[test]
fn crossing_by_less_than_rounding_is_seen() {
    // The segment ends one unit in the last place beyond the facet's plane, or before it, or on it.
    let up = f64::from_bits(4f64.to_bits() + 1);
    for (z, kind) in [(up, Some(SegmentThroughFacet)), (4.0, Some(PointOnFacet)), (4.0 - f64::EPSILON * 2.0, None)] {
        let mut plc = with_points(&[[1.0, 2.0, 3.0], [1.0, 2.0, z]]);
        plc.segments.push(PlcSegment { ends: [8, 9], marker: 0 });
        assert_eq!(plc.check().defects.first().map(|defect| defect.kind), kind, "{z:?}");
    }
}

#[test]
fn facets_that_cross_or_overlap() {
    // Two triangles through one another.
    let mut plc = with_points(&[
        [1.0, 1.0, 1.0],
        [3.0, 1.0, 1.0],
        [1.0, 3.0, 1.0],
        [1.5, 1.5, 0.5],
        [1.5, 1.5, 1.5],
        [3.0, 3.0, 3.0],
    ]);
    plc.facets.extend([facet(&[8, 9, 10]), facet(&[11, 12, 13])]);
    let through: Vec<_> = found(&plc).into_iter().filter(|(kind, _)| *kind == SegmentThroughFacet).collect();
    // Two sides of the one go through the other.
    assert_eq!(through, [(SegmentThroughFacet, vec![f(7), f(6)]), (SegmentThroughFacet, vec![f(7), f(6)])]);

    // Two in one plane: overlapping, the same, side by side.
    for (third, kind) in [([2.0, 2.0, 1.0], Some(FacetsOverlap)), ([3.0, -3.0, 1.0], None)] {
        let mut plc = with_points(&[[1.0, 1.0, 1.0], [3.0, 1.0, 1.0], [1.0, 3.0, 1.0], third]);
        plc.facets.extend([facet(&[8, 9, 10]), facet(&[8, 9, 11])]);
        let errors: Vec<_> = plc.check().errors().map(|defect| defect.kind).filter(|k| *k == FacetsOverlap).collect();
        assert_eq!(errors.first().copied(), kind);
    }
    let mut plc = unit_box();
    plc.facets.push(facet(&[2, 3, 1, 0]));
    assert_eq!(found(&plc)[0], (DuplicateFacet, vec![f(6), f(0)]));
}

#[test]
fn segments_that_cross() {
    let mut plc = with_points(&[[1.0, 1.0, 1.0], [3.0, 3.0, 3.0], [1.0, 3.0, 1.0], [3.0, 1.0, 3.0]]);
    plc.segments.extend([[8, 9], [10, 11]].map(|ends| PlcSegment { ends, marker: 0 }));
    assert_eq!(found(&plc), [(SegmentsCross, vec![s(0), s(1)])]);
    assert_eq!(plc.check().defects[0].place, DVec3::splat(2.0));
}

#[test]
fn elements_defective_by_themselves() {
    let mut plc = with_points(&[[f64::NAN, 0.0, 0.0], [1e300, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]);
    plc.segments.extend([[10, 10], [10, 99], [10, 11], [11, 10]].map(|ends| PlcSegment { ends, marker: 0 }));
    plc.facets.push(facet(&[10, 11, 10]));
    plc.facets.push(facet(&[0, 1, 3, 6]));
    plc.facets.push(PlcFacet::default());
    plc.holes.push(DVec3::NAN);
    let expected = [
        (NotFinite, vec![p(8)]),
        (NotFinite, vec![DomainElement::Hole(0)]),
        (OutOfRange, vec![p(9)]),
        (NoSuchPoint, vec![s(1)]),
        (Empty, vec![f(8)]),
        (NoLength, vec![s(0)]),
        (NoArea, vec![f(6)]),
        (NotPlanar, vec![f(7)]),
        (DuplicateSegment, vec![s(3), s(2)]),
    ];
    assert_eq!(found(&plc), expected);
    assert!(plc.arrange(&Control::new()).is_err());
}

#[test]
fn edges_of_one_and_of_three_facets() {
    // A wall from one side of the floor to the other: it shares three sides of the box.
    let mut plc = unit_box();
    plc.facets.push(facet(&[0, 1, 7, 6]));
    let found = found(&plc);
    assert_eq!(found.iter().filter(|(kind, _)| *kind == NonManifoldEdge).count(), 2);
    assert!((plc.check().facet_angle.unwrap().degrees - 45.0).abs() < 1e-9);
    plc.facets.truncate(5);
    assert_eq!(super::tests::found(&plc).iter().filter(|(kind, _)| *kind == OpenEdge).count(), 4);
}

#[test]
fn a_fan_of_many_segments_has_its_smallest_angle() {
    let count = 200;
    let mut plc = Plc { points: vec![DVec3::ZERO], ..Plc::default() };
    for i in 0..count {
        let angle = f64::from(i) * 0.02 + if i == 100 { 0.015 } else { 0.0 };
        plc.points.push(DVec3::new(angle.cos(), angle.sin(), 0.0));
        plc.segments.push(PlcSegment { ends: [0, i as u32 + 1], marker: 0 });
    }
    let angle = plc.check().segment_angle.unwrap();
    assert!((angle.degrees - 0.005f64.to_degrees()).abs() < 1e-9, "{angle:?}");
    assert_eq!(angle.elements, [s(100), s(101)]);
}
