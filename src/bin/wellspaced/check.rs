//! The command `check`: every defect of a domain. A surface's polygons that are not planar are warnings: they have been cut into triangles.

use std::fmt::Write as _;
use std::io::Write as _;

use serde::Serialize;
use wellspaced::{DomainElement, Error, Plc, PlcCheck, PlcDefect, Severity, SmallAngle};

use crate::args::Check;
use crate::failure::Failure;
use crate::mesh::{domain_mesh, join, join_degrees};
use crate::progress::Bar;
use crate::read::{read, Content, Format, Source};

/// `wellspaced check`. Fails, with nothing but the exit status to say so, when the domain can't be meshed.
pub fn check(arguments: &Check) -> Result<(), Failure> {
    let input = read(&arguments.input)?;
    let plc = match input.content {
        Content::Domain(plc) => plc,
        Content::Points(points) => Plc { points, ..Plc::default() },
    };
    let found = plc.check();
    let mut defects = defects(&found, &input.cut, &input.source);
    let mut errors = found.errors().count();
    // Whether the facets enclose something shows in a mesh only. Points alone need not.
    if errors == 0 && !(plc.facets.is_empty() && plc.segments.is_empty()) {
        if let Some(defect) = not_meshable(plc, arguments.input.format, &input.source)? {
            defects.insert(0, defect);
            errors = 1;
        }
    }
    let told = if arguments.json {
        json(&found, errors, defects, &input.source)
    } else {
        text(&found, errors, &defects, &input.source)
    };
    std::io::stdout().write_all(told.as_bytes()).map_err(Failure::stdout)?;
    (errors == 0).then_some(()).ok_or_else(|| Failure::new(""))
}

/// Why `refine` would find no mesh of a domain that has no defect by itself.
fn not_meshable(mut plc: Plc, format: Format, source: &Source) -> Result<Option<Defect>, Failure> {
    let mut source = source.clone();
    join(join_degrees(format), &mut plc, &mut source);
    let bar = Bar::new("check");
    match domain_mesh(0, &plc, &bar.control()) {
        Ok(_) => Ok(None),
        Err(error) => {
            let failure = source.explain_domain(&error, &plc);
            let Error::InvalidDomain { element: of, .. } = error else { return Err(failure) };
            Ok(Some(Defect {
                kind: "not_meshable",
                severity: "error",
                elements: vec![element(of, &source)],
                place: None,
                measure: 0.0,
                text: failure.message().to_owned(),
            }))
        }
    }
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

fn elements(list: &[DomainElement], source: &Source) -> Vec<Element> {
    list.iter().map(|&e| element(e, source)).collect()
}

/// All defects, errors first: those of the domain, and the polygons that were `cut` to make it one.
fn defects(found: &PlcCheck, cut: &[PlcDefect], source: &Source) -> Vec<Defect> {
    let told = |severity, defect: &PlcDefect| Defect {
        kind: defect.kind.name(),
        severity,
        elements: elements(&defect.elements, source),
        place: defect.place.is_finite().then(|| defect.place.to_array()),
        measure: defect.measure,
        text: source.describe(defect),
    };
    let cut = cut.iter().map(|defect| {
        let told = told("warning", defect);
        Defect { text: told.text + "; it is cut into triangles", ..told }
    });
    let warnings = found.defects.iter().filter(|defect| defect.kind.severity() == Severity::Warning);
    let errors = found.errors().map(|defect| told("error", defect));
    errors.chain(cut).chain(warnings.map(|defect| told("warning", defect))).collect()
}

fn json(found: &PlcCheck, errors: usize, defects: Vec<Defect>, source: &Source) -> String {
    let angle = |angle: &SmallAngle| Angle {
        degrees: angle.degrees,
        elements: elements(&angle.elements, source),
        place: angle.place.to_array(),
    };
    let report = Found {
        errors,
        warnings: defects.len() - errors,
        defects,
        segment_angle: found.segment_angle.as_ref().map(angle),
        facet_angle: found.facet_angle.as_ref().map(angle),
    };
    serde_json::to_string(&report).unwrap_or_default() + "\n"
}

fn text(found: &PlcCheck, errors: usize, defects: &[Defect], source: &Source) -> String {
    let mut text = String::new();
    for Defect { severity, text: told, .. } in defects {
        let _ = writeln!(text, "{severity}: {told}");
    }
    let _ = writeln!(text, "{errors} errors, {} warnings", defects.len() - errors);
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
