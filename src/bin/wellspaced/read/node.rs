//! TetGen's `.node` files, and the list of points that a `.poly` file starts with, which has the same form:
//! `<points> [3] [attributes] [markers 0|1]`, then `<number> <x> <y> <z> [attributes] [marker]` a line.

use std::path::Path;

use glam::DVec3;

use super::fields::{Fields, Lines, Numbered, Separator};
use super::source::Source;
use super::{read_file, too_many};
use crate::failure::Failure;

/// A list of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    pub points: Vec<DVec3>,
    /// One a point, or none.
    pub markers: Vec<i32>,
}

/// Reads a `.node` file; `source` learns where the points stand.
pub fn read_node(path: &Path, source: &mut Source) -> Result<Points, Failure> {
    parse_node(path, &read_file(path)?, source)
}

/// Reads the content of a `.node` file.
pub fn parse_node(path: &Path, content: &[u8], source: &mut Source) -> Result<Points, Failure> {
    let mut lines = Lines::new(path, content, Separator::Blank);
    let header = Header::parse(lines.expect("number of points")?)?;
    let points = parse_points(&mut lines, &header, path, source)?;
    lines.expect_end(format_args!("point {}", last_number(header.count, source.base)))?;
    Ok(points)
}

fn last_number(count: usize, base: usize) -> usize {
    (count + base).saturating_sub(1)
}

/// What the first line of a list of points says.
pub struct Header {
    pub count: usize,
    attributes: usize,
    markers: bool,
}

impl Header {
    pub fn parse(mut fields: Fields) -> Result<Self, Failure> {
        let element = "list of points";
        let count = fields.count(element, "number of points")?;
        if u32::try_from(count).is_err() {
            return Err(fields.wrong(element, too_many(count, "points")));
        }
        let dimension = fields.optional_count(element, "dimension")?.unwrap_or(3);
        if dimension != 3 {
            return Err(fields.wrong(element, format_args!("dimension is {dimension}, expected 3")));
        }
        let attributes = fields.optional_count(element, "number of attributes")?.unwrap_or(0);
        let markers = match fields.optional_count(element, "number of markers")?.unwrap_or(0) {
            0 => false,
            1 => true,
            other => return Err(fields.wrong(element, format_args!("number of markers is {other}, expected 0 or 1"))),
        };
        Ok(Header { count, attributes, markers })
    }
}

/// Reads the points that a header announced.
pub fn parse_points(lines: &mut Lines, header: &Header, path: &Path, source: &mut Source) -> Result<Points, Failure> {
    let room = lines.room_for(header.count, 8);
    let mut list = Points { points: Vec::with_capacity(room), markers: Vec::new() };
    source.points_path = path.to_owned();
    source.points = Vec::with_capacity(room);
    for index in 0..header.count {
        let mut fields = lines.expect(format_args!("point {} of {}", index + 1, header.count))?;
        let element = Numbered("point", index + source.base);
        let number = fields.count(element, "number")?;
        if index == 0 {
            if number > 1 {
                return Err(fields.wrong(Numbered("point", number), "the first point must have number 0 or 1"));
            }
            source.base = number;
        } else if number != index + source.base {
            return Err(fields.wrong(element, format_args!("number is {number}, expected {}", element.1)));
        }
        let element = Numbered("point", number);
        list.points.push(fields.point(element)?);
        for attribute in 1..=header.attributes {
            fields.real(element, format_args!("attribute {attribute}"))?;
        }
        if header.markers {
            list.markers.push(fields.marker(element)?);
        }
        source.points.push(u32::try_from(fields.line()).unwrap_or(u32::MAX));
    }
    Ok(list)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<(Points, Source), String> {
        let path = Path::new("in.node");
        let mut source = Source::new(path);
        match parse_node(path, text.as_bytes(), &mut source) {
            Ok(points) => Ok((points, source)),
            Err(failure) => Err(failure.message().to_owned()),
        }
    }

    #[test]
    fn attributes_markers_comments_and_one_based_numbers() {
        let text = "\u{feff}# a list\n\n2 3 2 1 # two\r\n  1  0.5 -1e3 +2  7 8  -4\n# between\n2\t1,2,3 9 9\n";
        let (points, source) = parse(text).unwrap();
        assert_eq!(points.points, [DVec3::new(0.5, -1e3, 2.0), DVec3::new(1.0, 2.0, 3.0)]);
        assert_eq!(points.markers, [-4, 0]);
        assert_eq!((source.base, source.points), (1, vec![4, 6]));
    }

    #[test]
    fn the_header_may_hold_the_count_alone() {
        let (points, source) = parse("1\n0 1 2 3").unwrap();
        assert_eq!(points, Points { points: vec![DVec3::new(1.0, 2.0, 3.0)], markers: vec![] });
        assert_eq!(source.base, 0);
        assert!(parse("0 3 0 0\n").unwrap().0.points.is_empty());
    }

    #[test]
    fn each_defect_is_named_by_line_and_element() {
        for (text, message) in [
            ("", "in.node:1: number of points: missing, the file ends here"),
            ("# nothing\n\n", "in.node:2: number of points: missing, the file ends here"),
            ("x 3\n", "in.node:1: list of points: number of points is \"x\", expected a whole number, 0 or more"),
            ("-1 3\n", "in.node:1: list of points: number of points is \"-1\", expected a whole number, 0 or more"),
            ("2 2 0 0\n", "in.node:1: list of points: dimension is 2, expected 3"),
            ("2 3 0 7\n", "in.node:1: list of points: number of markers is 7, expected 0 or 1"),
            ("5000000000 3\n", "in.node:1: list of points: 5000000000 points, but 32-bit indices can't number so many"),
            ("2 3\n0 0 0 0\n", "in.node:2: point 2 of 2: missing, the file ends here"),
            ("1 3\n0 0 0 0\n1 1 1 1\n", "in.node:3: line: unexpected, point 0 should have been the last"),
            ("1 3\n2 0 0 0\n", "in.node:2: point 2: the first point must have number 0 or 1"),
            ("2 3\n0 0 0 0\n3 0 0 0\n", "in.node:3: point 1: number is 3, expected 1"),
            ("2 3\n1 0 0 0\n# c\n2 0 1\n", "in.node:4: point 2: z coordinate is missing"),
            ("1 3\n0 0 O 0\n", "in.node:2: point 0: y coordinate is \"O\", expected a number"),
            ("1 3\n0 0 1e999 0\n", "in.node:2: point 0: y coordinate is not finite"),
            ("1 3\n0 nan 0 0\n", "in.node:2: point 0: x coordinate is not finite"),
            ("1 3 1\n0 0 0 0\n", "in.node:2: point 0: attribute 1 is missing"),
            ("1 3 0 1\n0 0 0 0 1.5\n", "in.node:2: point 0: marker is \"1.5\", expected a whole number of 32 bits"),
        ] {
            assert_eq!(parse(text).unwrap_err(), message, "{text:?}");
        }
        let path = Path::new("in.node");
        let failure = parse_node(path, b"1 3\n\xff\xfe\n", &mut Source::new(path)).unwrap_err();
        assert_eq!(failure.message(), "in.node:2: line: is not text");
    }

    #[test]
    fn a_wrong_count_does_not_ask_for_memory() {
        assert!(parse("4294967295 3\n0 0 0 0\n").unwrap_err().starts_with("in.node:2: point 2 of 4294967295: missing"));
    }
}
