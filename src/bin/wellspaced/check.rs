//! The command `check`: every defect of a domain. A surface's polygons that are not planar are warnings: they have been cut into triangles.

use std::fmt::Write as _;
use std::io::Write as _;

use glam::DVec3;
use serde::Serialize;
use wellspaced::{DomainElement, Plc, PlcCheck, PlcDefect, Severity, SmallAngle};

use crate::args::Check;
use crate::failure::Failure;
use crate::read::{read, Content, Source};

/// `wellspaced check`. Fails, with nothing but the exit status to say so, when the domain can't be meshed.
pub fn check(arguments: &Check) -> Result<(), Failure> {
    let input = read(&arguments.input)?;
    let plc = match input.content {
        Content::Domain(plc) => plc,
        Content::Points(points) => Plc { points, ..Plc::default() },
    };
    let found = plc.check();
    let listed = listed(&found, &input.cut, &input.source);
    let text = if arguments.json { json(&found, &listed, &input.source) } else { text(&found, &listed, &input.source) };
    std::io::stdout().write_all(text.as_bytes()).map_err(Failure::stdout)?;
    let usable = found.errors().next().is_none();
    usable.then_some(()).ok_or_else(|| Failure::new(""))
}

/// An element as the file has it.
#[derive(Serialize)]
struct Element {
    kind: &'static str,
    /// Its number in the file; null for the domain as a whole.
    number: Option<usize>,
    line: Option<usize>,
}

#[derive(Serialize)]
struct Defect {
    kind: &'static str,
    severity: &'static str,
    elements: Vec<Element>,
    /// Null where there is none.
    place: Option<[f64; 3]>,
    measure: f64,
    text: String,
}

#[derive(Serialize)]
struct Angle {
    degrees: f64,
    elements: Vec<Element>,
    place: [f64; 3],
}

#[derive(Serialize)]
struct Found {
    errors: usize,
    warnings: usize,
    defects: Vec<Defect>,
    segment_angle: Option<Angle>,
    facet_angle: Option<Angle>,
}

fn element(element: DomainElement, source: &Source) -> Element {
    let (kind, number, line) = source.place(element);
    Element { kind, number, line }
}

/// A defect as it is told.
struct Listed<'a> {
    defect: &'a PlcDefect,
    severity: &'static str,
    text: String,
}

/// All defects, errors first: those of the domain, and the polygons that were `cut` to make it one.
fn listed<'a>(found: &'a PlcCheck, cut: &'a [PlcDefect], source: &Source) -> Vec<Listed<'a>> {
    let told = |severity, defect| Listed { defect, severity, text: source.describe(defect) };
    let cut = cut.iter().map(|defect| {
        let told = told("warning", defect);
        Listed { text: told.text + "; it is cut into triangles", ..told }
    });
    let warnings = found.defects.iter().filter(|defect| defect.kind.severity() == Severity::Warning);
    let errors = found.errors().map(|defect| told("error", defect));
    errors.chain(cut).chain(warnings.map(|defect| told("warning", defect))).collect()
}

fn json(found: &PlcCheck, listed: &[Listed], source: &Source) -> String {
    let elements = |list: &[DomainElement]| list.iter().map(|&e| element(e, source)).collect();
    let finite = |p: DVec3| p.is_finite().then(|| p.to_array());
    let angle = |angle: &SmallAngle| Angle {
        degrees: angle.degrees,
        elements: elements(&angle.elements),
        place: angle.place.to_array(),
    };
    let errors = found.errors().count();
    let report = Found {
        errors,
        warnings: listed.len() - errors,
        defects: listed
            .iter()
            .map(|Listed { defect, severity, text }| Defect {
                kind: defect.kind.name(),
                severity,
                elements: elements(&defect.elements),
                place: finite(defect.place),
                measure: defect.measure,
                text: text.clone(),
            })
            .collect(),
        segment_angle: found.segment_angle.as_ref().map(angle),
        facet_angle: found.facet_angle.as_ref().map(angle),
    };
    serde_json::to_string(&report).unwrap_or_default() + "\n"
}

fn text(found: &PlcCheck, listed: &[Listed], source: &Source) -> String {
    let mut text = String::new();
    for Listed { severity, text: told, .. } in listed {
        let _ = writeln!(text, "{severity}: {told}");
    }
    let errors = found.errors().count();
    let _ = writeln!(text, "{errors} errors, {} warnings", listed.len() - errors);
    let angles = [("segments", &found.segment_angle), ("facets", &found.facet_angle)];
    for (name, angle) in angles {
        let Some(SmallAngle { degrees, elements: [a, b], place }) = angle else { continue };
        let [a, b] = [a, b].map(|&e| source.name(e));
        let _ = writeln!(
            text,
            "smallest angle between {name}: {degrees:.6} degrees, {a} and {b} at ({}, {}, {})",
            place.x, place.y, place.z
        );
    }
    text
}
