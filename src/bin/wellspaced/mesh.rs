//! The commands `refine` and `delaunay`: read, mesh, write, report.

use std::collections::BTreeMap;
use std::io::Write;

use glam::DVec3;
use wellspaced::geometry::quality::{min_dihedral_degrees, radius_edge};
use wellspaced::{Control, DomainElement, Error, Mesh, Plc, RefineOptions, RefineReport, Sizing, Unrefined};

use crate::args::{Delaunay, Files, Refine};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::read::{read, Content, Format, Input, Source};
use crate::report::{status_name, timed, Report, Seconds};
use crate::write::{write, OutputMesh};

/// `wellspaced refine`.
pub fn refine(arguments: &Refine) -> Result<(), Failure> {
    let mut options = RefineOptions {
        radius_edge: arguments.radius_edge,
        rule: arguments.rule.into(),
        sparsify: arguments.level(),
        keep_boundary: arguments.keep_boundary,
        ..RefineOptions::default()
    };
    if let Some(limit) = arguments.max_vertices {
        options.max_vertices = limit;
    }
    if let Some(limit) = arguments.max_seconds {
        // On a command line 0 is no time, not all the time.
        options.max_seconds = if limit == 0.0 { f64::MIN_POSITIVE } else { limit };
    }
    if let Some(limit) = arguments.max_memory {
        options.max_memory = limit.saturating_mul(1 << 20).max(1);
    }
    options.check().map_err(Failure::usage)?;
    let max_edge = arguments.max_edge.unwrap_or(0.0);
    if !(max_edge >= 0.0 && max_edge.is_finite()) {
        let expected = "a length, or 0 for any";
        return Err(Failure::usage(Error::InvalidOption { name: "max_edge", value: max_edge, expected }));
    }
    let files = &arguments.files;
    let mut seconds = Seconds::default();
    let mut input = open(files, &mut seconds)?;
    let degrees = files.join_coplanar.unwrap_or_else(|| join_degrees(files.input.format));
    if let Content::Domain(plc) = &mut input.content {
        join(degrees, plc, &mut input.source);
    }
    let bar = Bar::new("refine");
    let sizing = Sizing { uniform: max_edge, ..Sizing::default() };
    let threads = files.threads as usize;
    let refined = refined(&input.content, threads, &options, &sizing, &bar.control(), &mut seconds);
    let (mesh, report) = refined.map_err(|error| match &input.content {
        Content::Domain(plc) => input.source.explain_domain(&error, plc),
        Content::Points(_) => input.source.explain(&error),
    })?;
    drop(bar);
    save(files, &mesh, report.input_vertices, &input.content, &mut seconds)?;
    print(
        files,
        &Report {
            input_vertices: report.input_vertices,
            vertices: report.vertices,
            tetrahedra: report.tetrahedra,
            steiner: report.steiner,
            bad: Some(report.bad),
            unrefined: Some(reasons(&report)),
            too_large: Some(report.too_large),
            on_segments: Some(report.on_segments),
            on_facets: Some(report.on_facets),
            worst_radius_edge: report.worst_radius_edge,
            min_dihedral_degrees: report.min_dihedral_degrees,
            rule: Some(arguments.rule.name()),
            radius_edge: Some(arguments.radius_edge),
            status: status_name(report.status),
            seconds,
        },
    )
}

/// The angle in degrees up to which coplanar facets of such a file are joined by default; below 0 for none.
pub fn join_degrees(format: Format) -> f64 {
    if format.is_surface() {
        0.01
    } else {
        -1.0
    }
}

/// Joins coplanar facets, unless the angle is below 0.
pub fn join(degrees: f64, plc: &mut Plc, source: &mut Source) {
    if degrees >= 0.0 {
        let group = plc.join_coplanar(degrees);
        source.join(&group, plc.facets.len());
    }
}

/// The mesh of a domain. When there is none because of its holes, the error says so: that the facets enclose nothing would send a reader to them.
pub fn domain_mesh(threads: usize, plc: &Plc, control: &Control) -> Result<Mesh, Error> {
    Mesh::from_plc_on(threads, plc, control).map_err(|error| match error {
        Error::InvalidDomain { element: element @ DomainElement::Whole, .. } if !plc.holes.is_empty() => {
            let whole = Plc { holes: Vec::new(), ..plc.clone() };
            match Mesh::from_plc_on(threads, &whole, control) {
                Ok(_) => Error::InvalidDomain { element, problem: "its holes take all of it".to_owned() },
                Err(_) => error,
            }
        }
        error => error,
    })
}

/// How many tetrahedra were left for each reason, if any were.
pub fn reasons(report: &RefineReport) -> BTreeMap<&'static str, usize> {
    let reasons = Unrefined::ALL.iter().zip(report.unrefined);
    reasons.filter(|&(_, count)| count > 0).map(|(reason, count)| (reason.name(), count)).collect()
}

/// Triangulates, on so many threads, and refines: a domain as given, points in their convex hull.
pub fn refined(
    content: &Content,
    threads: usize,
    options: &RefineOptions,
    sizing: &Sizing,
    control: &Control,
    seconds: &mut Seconds,
) -> Result<(Mesh, RefineReport), Error> {
    let mut mesh = timed(&mut seconds.delaunay, || match content {
        Content::Domain(plc) => domain_mesh(threads, plc, control),
        Content::Points(points) => {
            let mut mesh = triangulated(points, threads, control)?;
            mesh.use_hull_as_domain()?;
            Ok(mesh)
        }
    })?;
    let report = timed(&mut seconds.refine, || mesh.refine_sized(options, sizing, control))?;
    Ok((mesh, report))
}

/// `wellspaced delaunay`.
pub fn delaunay(arguments: &Delaunay) -> Result<(), Failure> {
    let files = &arguments.files;
    let mut seconds = Seconds::default();
    let input = open(files, &mut seconds)?;
    let bar = Bar::new("delaunay");
    let control = bar.control();
    let mesh = timed(&mut seconds.delaunay, || triangulated(input.content.points(), files.threads as usize, &control));
    let mesh = mesh.map_err(|error| input.source.explain(&error))?;
    drop(bar);
    let vertices = mesh.triangulation().vertex_count();
    save(files, &mesh, vertices, &input.content, &mut seconds)?;
    let (worst_radius_edge, min_dihedral_degrees) = extremes(&mesh);
    print(
        files,
        &Report {
            input_vertices: vertices,
            vertices,
            tetrahedra: mesh.triangulation().tetrahedron_count(),
            steiner: 0,
            bad: None,
            unrefined: None,
            too_large: None,
            on_segments: None,
            on_facets: None,
            worst_radius_edge,
            min_dihedral_degrees,
            rule: None,
            radius_edge: None,
            status: "done",
            seconds,
        },
    )
}

fn triangulated(points: &[DVec3], threads: usize, control: &Control) -> Result<Mesh, Error> {
    let mut mesh = Mesh::new();
    mesh.set_threads(threads);
    mesh.insert(points, None, control)?;
    Ok(mesh)
}

/// The largest radius-edge ratio and the smallest dihedral angle, as [`RefineReport`] has them.
fn extremes(mesh: &Mesh) -> (f64, f64) {
    let points = mesh.triangulation().points();
    let shapes = mesh.elements().map(|(t, _)| t.map(|corner| points[corner as usize]));
    shapes.fold((0.0, 180.0), |(worst, least), shape| {
        (f64::max(worst, radius_edge(shape)), f64::min(least, min_dihedral_degrees(shape)))
    })
}

/// Reads the input, having looked first whether the outputs can be written.
fn open(files: &Files, seconds: &mut Seconds) -> Result<Input, Failure> {
    for output in &files.outputs {
        output.check(&[&files.input.path])?;
    }
    let input = timed(&mut seconds.read, || read(&files.input))?;
    for output in &files.outputs {
        output.check(&input.source.files())?;
    }
    Ok(input)
}

fn save(
    files: &Files,
    mesh: &Mesh,
    input_vertices: usize,
    content: &Content,
    seconds: &mut Seconds,
) -> Result<(), Failure> {
    if files.outputs.is_empty() {
        return Ok(());
    }
    let plc = match content {
        Content::Domain(plc) => Some(plc),
        Content::Points(_) => None,
    };
    timed(&mut seconds.write, || write(&files.outputs, &OutputMesh::new(mesh, input_vertices, plc)))
}

fn print(files: &Files, report: &Report) -> Result<(), Failure> {
    let text = if files.json { report.json() + "\n" } else { report.text() };
    std::io::stdout().write_all(text.as_bytes()).map_err(Failure::stdout)
}
