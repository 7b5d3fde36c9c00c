//! Complexes: refused with an error, or meshed; then refined within limits, thinned out, and valid all the while.

use std::sync::atomic::{AtomicUsize, Ordering};

use wellspaced::{
    Control, DVec3, Error, Mesh, Plc, PlcFacet, PlcRegion, PlcSegment, RefineOptions, RefineStatus, Rule, Sparsify,
};

use crate::bytes::{Bytes, Grid};

/// No refinement adds vertices beyond this.
const VERTICES: usize = 400;

/// Cancels what has become too large, or has been told of too often.
fn bounded(calls: usize) -> Control {
    let told = AtomicUsize::new(0);
    Control::with_progress(move |progress| {
        assert!((0.0..=1.0).contains(&progress.fraction), "{progress:?}");
        progress.vertices < 3 * VERTICES && told.fetch_add(1, Ordering::Relaxed) < calls
    })
}

pub fn run(data: &[u8]) {
    let mut bytes = Bytes(data);
    let (plc, exact) = complex(&mut bytes);
    let options = options(&mut bytes);
    let again = bytes.byte();
    if std::env::var_os("FUZZ_TRACE").is_some() {
        eprintln!("{plc:?}\n{options:?} exact {exact}, {again}");
    }
    match Mesh::from_plc(&plc, &bounded(16)) {
        Ok(mut mesh) => {
            valid(&mesh);
            if !plc.facets.is_empty() && mesh.triangulation().dimension() == 3 {
                assert!(!mesh.view().tetrahedra.is_empty(), "a domain without a tetrahedron");
            }
            refine(&mut mesh, &options);
            match again % 4 {
                0 => refine(&mut mesh, &RefineOptions { max_vertices: usize::MAX, ..options }),
                1 => refine(&mut mesh, &RefineOptions { rule: Rule::Circumcenter, ..options }),
                2 if exact => {
                    mesh.sparsify(options.radius_edge, Sparsify::Thorough, &bounded(64))
                        .expect("nothing is asked too much");
                    valid(&mesh);
                }
                _ => {}
            }
        }
        Err(error) => {
            // It must say something, and not be a mere cancellation of a small thing.
            assert!(!error.to_string().is_empty());
            let refused = matches!(
                error,
                Error::InvalidDomain { .. } | Error::Cancelled | Error::NotFinite { .. } | Error::OutOfRange { .. }
            );
            assert!(refused, "{error:?}");
        }
    }
}

fn refine(mesh: &mut Mesh, options: &RefineOptions) {
    let report = mesh.refine(options, &bounded(64)).unwrap_or_else(|error| panic!("{error}"));
    valid(mesh);
    assert_eq!(report.vertices, mesh.triangulation().vertex_count());
    assert_eq!(report.measured, report.status != RefineStatus::Cancelled);
    if report.measured {
        assert_eq!(report.tetrahedra, mesh.view().tetrahedra.len());
    }
    if report.status == RefineStatus::Done {
        assert_eq!(report.bad, 0, "{report:?}");
        mesh.validate_quality(options.radius_edge).unwrap_or_else(|defect| panic!("{defect}"));
    }
}

fn valid(mesh: &Mesh) {
    mesh.validate(3).unwrap_or_else(|defect| panic!("{defect}"));
    let view = mesh.view();
    assert_eq!((view.tetrahedra.len(), view.tetrahedra.len()), (view.neighbours.len(), view.regions.len()));
    for (i, (tet, neighbours)) in view.tetrahedra.iter().zip(view.neighbours).enumerate() {
        assert!(tet.iter().all(|&v| view.points[v as usize].is_finite()));
        for &n in neighbours.iter().filter(|&&n| n != u32::MAX) {
            assert!(view.neighbours[n as usize].contains(&(i as u32)));
        }
    }
}

fn options(bytes: &mut Bytes) -> RefineOptions {
    let rule = [Rule::Sparse, Rule::Paper, Rule::Circumcenter][bytes.below(3)];
    let sparsify = [None, Some(Sparsify::Off), Some(Sparsify::Quick), Some(Sparsify::Thorough)][bytes.below(4)];
    let radius_edge = [2.0, 1.5, 4.0, 1.0, 0.62, 100.0][bytes.below(6)];
    let min_edge = [0.0, 0.0, 0.1, 1.0][bytes.below(4)];
    RefineOptions {
        radius_edge,
        rule,
        sparsify,
        min_edge,
        max_vertices: bytes.below(VERTICES),
        ..RefineOptions::default()
    }
}

/// Faces by their corners.
const TETRAHEDRON: &[&[u32]] = &[&[0, 1, 2], &[0, 1, 3], &[0, 2, 3], &[1, 2, 3]];
const BOX: &[&[u32]] = &[&[0, 1, 3, 2], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 3, 7, 6], &[0, 2, 6, 4], &[1, 3, 7, 5]];
const OCTAHEDRON: &[&[u32]] =
    &[&[0, 2, 4], &[2, 1, 4], &[1, 3, 4], &[3, 0, 4], &[0, 2, 5], &[2, 1, 5], &[1, 3, 5], &[3, 0, 5]];

/// A complex, and whether its coordinates are short.
fn complex(bytes: &mut Bytes) -> (Plc, bool) {
    let mut plc = Plc::default();
    let grid = Grid::of(bytes);
    match bytes.byte() % 5 {
        0 => {
            plc = Plc::boxed(DVec3::splat(-8.0), DVec3::splat(8.0), []);
        }
        1 => {
            let corners: [DVec3; 4] = std::array::from_fn(|_| grid.point(bytes));
            add(&mut plc, &corners, TETRAHEDRON);
        }
        2 => {
            // A slanted box: its sides are not quite planar where coordinates are not exact.
            let [o, a, b, c]: [DVec3; 4] = std::array::from_fn(|_| grid.point(bytes));
            let corners: [DVec3; 8] = std::array::from_fn(|i| {
                let at = |bit: usize, d: DVec3| if i >> bit & 1 == 1 { d } else { DVec3::ZERO };
                o + at(0, a) + at(1, b) + at(2, c)
            });
            add(&mut plc, &corners, BOX);
        }
        3 => {
            let size = f64::from(bytes.byte() % 8 + 1);
            add(
                &mut plc,
                &[DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z].map(|p| p * size),
                OCTAHEDRON,
            );
        }
        _ => {}
    }
    let loose = bytes.below(12);
    plc.points.extend((0..loose).map(|_| grid.point(bytes)));
    let count = plc.points.len() as u32;
    // One index too many is to be refused.
    let corner = |bytes: &mut Bytes| match bytes.byte() {
        255 => count,
        byte => u32::from(byte) % count,
    };
    if count == 0 {
        return (plc, grid.is_exact());
    }
    for _ in 0..bytes.below(4) {
        let ends = [corner(bytes), corner(bytes)];
        plc.segments.push(PlcSegment { ends, marker: 0 });
    }
    for _ in 0..bytes.below(6) {
        let mut facet = PlcFacet::default();
        for _ in 0..bytes.below(3) {
            let polygon = (0..bytes.below(6)).map(|_| corner(bytes)).collect();
            facet.polygons.push(polygon);
        }
        facet.holes.extend((0..bytes.below(2)).map(|_| grid.point(bytes)));
        plc.facets.push(facet);
    }
    plc.holes.extend((0..bytes.below(2)).map(|_| grid.point(bytes)));
    for _ in 0..bytes.below(3) {
        let point = grid.point(bytes);
        let max_volume = (bytes.byte() % 2 == 0).then(|| f64::from(bytes.byte()));
        plc.regions.push(PlcRegion { point, attribute: 1.0, max_volume });
    }
    if bytes.byte() == 255 {
        let place = bytes.below(plc.points.len());
        plc.points[place].y = bytes.any_real();
        return (plc, false);
    }
    (plc, grid.is_exact())
}

/// Adds a closed surface.
fn add(plc: &mut Plc, corners: &[DVec3], faces: &[&[u32]]) {
    let first = plc.points.len() as u32;
    plc.points.extend(corners);
    plc.facets.extend(faces.iter().map(|face| {
        let polygon = face.iter().map(|corner| first + corner).collect();
        PlcFacet { polygons: vec![polygon], ..PlcFacet::default() }
    }));
}
