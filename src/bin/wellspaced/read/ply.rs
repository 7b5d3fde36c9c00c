//! `.ply` files, text or binary, by the crate `ply-rs-bw`: the properties `x`, `y`, `z` of the element `vertex`, and `vertex_indices` or
//! `vertex_index` of the element `face`; all else is passed over.

use std::io::{self, BufRead};
use std::path::Path;

use glam::DVec3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, ElementDef, Encoding, Header, Property};

use super::fields::Numbered;
use super::surface::Surface;
use crate::failure::Failure;

/// Reads the content of a `.ply` file.
pub fn parse_ply(path: &Path, content: &[u8]) -> Result<Surface, Failure> {
    let file = File { path, content, parser: Parser::new() };
    let mut rest = content;
    let header = file.parser.read_header(&mut rest).map_err(|error| file.header_failure(&error))?;
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    for (name, definition) in &header.elements {
        let start = rest;
        let elements = file.parser.read_payload_for_element(&mut rest, definition, &header);
        let elements = elements.map_err(|_| file.element_failure(start, definition, &header))?;
        match name.as_str() {
            "vertex" => vertices = elements,
            "face" => faces = elements,
            _ => {}
        }
    }
    let mut surface = Surface::default();
    for (number, vertex) in vertices.iter().enumerate() {
        let coordinate = |name: &str| {
            let value = vertex.get(name).and_then(real);
            value.ok_or_else(|| Failure::in_file(path, format_args!("point {number}: {name} is missing or no number")))
        };
        surface.points.push(DVec3::new(coordinate("x")?, coordinate("y")?, coordinate("z")?));
    }
    for (number, face) in faces.iter().enumerate() {
        let list = face.get("vertex_indices").or_else(|| face.get("vertex_index")).and_then(indices);
        let Some(list) = list else {
            return Err(Failure::in_file(path, format_args!("facet {number}: has no list vertex_indices")));
        };
        let known = |v: i64| usize::try_from(v).is_ok_and(|v| v < surface.points.len());
        if let Some(v) = list.iter().find(|&&v| !known(v)) {
            return Err(Failure::in_file(path, format_args!("facet {number}: point {v} does not exist")));
        }
        surface.polygons.push(list.into_iter().map(|v| v as u32).collect());
    }
    Ok(surface)
}

/// A file whose errors are told: the crate's own words take several lines, and only those for text have a line's number.
struct File<'a> {
    path: &'a Path,
    content: &'a [u8],
    parser: Parser<DefaultElement>,
}

impl File<'_> {
    fn header_failure(&self, error: &io::Error) -> Failure {
        let said = error.to_string();
        let line = said.strip_prefix("Line ").and_then(|rest| rest.split_once(':')?.0.parse::<usize>().ok());
        let Some(number) = line else {
            let problem = match said.as_str() {
                _ if self.content.is_empty() => "missing, the file ends here",
                said if said.contains("format") => "has no line format",
                said if said.contains("version") => "has no version that can be read",
                _ => "is not text",
            };
            return Failure::in_file(self.path, format_args!("header: {problem}"));
        };
        match self.content.lines().nth(number - 1) {
            Some(Ok(line)) if number == 1 => {
                Failure::in_line(self.path, 1, "header", format_args!("is {line:?}, expected ply"))
            }
            Some(Ok(line)) => {
                Failure::in_line(self.path, number, "header", format_args!("{line:?} can't be used here"))
            }
            _ => Failure::in_line(self.path, number, "end_header", "missing, the file ends here"),
        }
    }

    /// The failure of some elements that begin at `start`. They are read again one by one: the first that can't be read is the wrong one.
    fn element_failure(&self, start: &[u8], definition: &ElementDef, header: &Header) -> Failure {
        let one = ElementDef { count: 1, ..definition.clone() };
        let (mut rest, mut number) = (start, 0);
        let mut before = rest;
        while number < definition.count && self.parser.read_payload_for_element(&mut rest, &one, header).is_ok() {
            before = rest;
            number += 1;
        }
        let element = match definition.name.as_str() {
            "vertex" => Numbered("point", number).to_string(),
            "face" => Numbered("facet", number).to_string(),
            other => format!("{other} {number}"),
        };
        let text = header.encoding == Encoding::Ascii;
        let problem = match before {
            [] => "missing, the file ends here",
            _ if text => "is not what the header says: a number is missing, or is none or out of range",
            _ if rest.is_empty() => "is cut off, the file ends in it",
            _ => "is not what the header says",
        };
        if text {
            let line = self.content[..self.content.len() - before.len()].iter().filter(|&&b| b == b'\n').count() + 1;
            return Failure::in_line(self.path, line, element, problem);
        }
        Failure::in_file(self.path, format_args!("{element}: {problem}"))
    }
}

fn real(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(v) => v.into(),
        Property::UChar(v) => v.into(),
        Property::Short(v) => v.into(),
        Property::UShort(v) => v.into(),
        Property::Int(v) => v.into(),
        Property::UInt(v) => v.into(),
        Property::Float(v) => v.into(),
        Property::Double(v) => v,
        _ => return None,
    })
}

fn indices(property: &Property) -> Option<Vec<i64>> {
    fn all<T: Copy + Into<i64>>(list: &[T]) -> Vec<i64> {
        list.iter().map(|&v| v.into()).collect()
    }
    Some(match property {
        Property::ListChar(list) => all(list),
        Property::ListUChar(list) => all(list),
        Property::ListShort(list) => all(list),
        Property::ListUShort(list) => all(list),
        Property::ListInt(list) => all(list),
        Property::ListUInt(list) => all(list),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty float y\n\
        property int z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

    #[test]
    fn numbers_of_any_kind() {
        let text = format!("{HEADER}0.1 0.5 0 9\n1 0 -2 9\n0 1 3 9\n3 2 1 0\n");
        let surface = parse_ply(Path::new("in.ply"), text.as_bytes()).unwrap();
        assert_eq!(surface.points[..2], [DVec3::new(0.1, 0.5, 0.0), DVec3::new(1.0, 0.0, -2.0)]);
        assert_eq!(surface.polygons, [[2, 1, 0]]);
    }

    #[test]
    fn defects_are_named() {
        let text = format!("{HEADER}0 0 0 9\n1 0 0 9\n0 1 0 9\n3 2 1 3\n");
        let failure = parse_ply(Path::new("in.ply"), text.as_bytes()).unwrap_err();
        assert_eq!(failure.message(), "in.ply: facet 0: point 3 does not exist");
    }

    #[test]
    fn what_the_crate_refuses_is_one_line() {
        let points = "0 0 0 9\n1 0 0 9\n0 1 0 9\n";
        let binary = HEADER.replace("ascii", "binary_little_endian");
        let vertices = [0; 17 * 3];
        let unread = "is not what the header says: a number is missing, or is none or out of range";
        let with = |header: &str, body: &[u8]| [header.as_bytes(), body].concat();
        for (content, message) in [
            (vec![], "header: missing, the file ends here".to_owned()),
            (b"ply\n\xff\n".to_vec(), "header: is not text".to_owned()),
            (b"plx\n".to_vec(), "1: header: is \"plx\", expected ply".to_owned()),
            (b"ply\nend_header\n".to_vec(), "header: has no line format".to_owned()),
            (b"ply\nformat ascii 1.0\n".to_vec(), "3: end_header: missing, the file ends here".to_owned()),
            (
                b"ply\nformat ascii 1.0\nelement vertex -1\n".to_vec(),
                "3: header: \"element vertex -1\" can't be used here".to_owned(),
            ),
            (
                b"ply\nformat ascii 1.0\nproperty int x\n".to_vec(),
                "3: header: \"property int x\" can't be used here".to_owned(),
            ),
            (with(HEADER, b"0 0 0 9\n1 0 0\n"), format!("12: point 1: {unread}")),
            (with(HEADER, b"0 0 0 9\n1 0 x 9\n"), format!("12: point 1: {unread}")),
            (with(HEADER, b"0 0 0 9\n"), "12: point 1: missing, the file ends here".to_owned()),
            (with(HEADER, points.as_bytes()), "14: facet 0: missing, the file ends here".to_owned()),
            (with(HEADER, format!("{points}3 0 1\n").as_bytes()), format!("14: facet 0: {unread}")),
            (with(&binary, &vertices[..20]), "point 1: is cut off, the file ends in it".to_owned()),
            (with(&binary, &vertices), "facet 0: missing, the file ends here".to_owned()),
            (
                with(&binary, &[&vertices[..], &[3, 0, 0]].concat()),
                "facet 0: is cut off, the file ends in it".to_owned(),
            ),
        ] {
            let failure = parse_ply(Path::new("in.ply"), &content).unwrap_err();
            let colon = if message.starts_with(|c: char| c.is_ascii_digit()) { "" } else { " " };
            assert_eq!(failure.message(), format!("in.ply:{colon}{message}"));
        }
    }
}
