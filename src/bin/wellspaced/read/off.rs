//! `.off` files (Geomview's Object File Format, text): a keyword, the numbers of points and polygons, a line a point, a line a
//! polygon. Normals, colours and texture coordinates are passed over; what may be left out in CGAL may be left out here
//! (the keyword, the number of edges). Written by hand: no well-kept crate reads the format.

use std::path::Path;

use super::fields::{Fields, Lines, Numbered, Separator};
use super::source::{Place, Source};
use super::surface::Surface;
use super::too_many;
use crate::failure::Failure;

/// Reads the content of an `.off` file; `source` learns where its elements stand.
pub fn parse_off(path: &Path, content: &[u8], source: &mut Source) -> Result<Surface, Failure> {
    let mut lines = Lines::new(path, content, Separator::Blank);
    let mut fields = lines.expect("keyword OFF")?;
    if let Some(word) = fields.peek().filter(|word| !word.starts_with(|c: char| c.is_ascii_digit())) {
        check_keyword(word, &fields)?;
        fields.text();
        if let Some(word) = fields.peek().filter(|word| word.eq_ignore_ascii_case("binary")) {
            return Err(fields.wrong(word, "files of this kind can't be read, only text can"));
        }
        if fields.peek().is_none() {
            fields = lines.expect("numbers of points and polygons")?;
        }
    }
    let points = fields.count("header", "number of points")?;
    let polygons = fields.count("header", "number of polygons")?;
    if u32::try_from(points).is_err() || u32::try_from(polygons).is_err() {
        return Err(fields.wrong("header", too_many(points.max(polygons), "elements")));
    }
    let mut surface = Surface::default();
    surface.points.reserve(lines.room_for(points, 6));
    for number in 0..points {
        let mut fields = lines.expect(format_args!("point {number} of {points}"))?;
        surface.points.push(fields.point(Numbered("point", number))?);
        source.points.push(u32::try_from(fields.line()).unwrap_or(u32::MAX));
    }
    surface.polygons.reserve(lines.room_for(polygons, 6));
    for number in 0..polygons {
        let element = Numbered("facet", number);
        let mut fields = lines.expect(format_args!("{element} of {polygons}"))?;
        source.facets.push(Place { line: fields.line(), number });
        let corners = fields.count(element, "number of corners")?;
        let mut polygon = Vec::with_capacity(corners.min(64));
        while polygon.len() < corners {
            let name = Numbered("corner", polygon.len());
            let Some(corner) = fields.optional_count(element, name)? else {
                fields = lines.expect(format_args!("{element}, {name} of {corners}"))?;
                continue;
            };
            if corner >= points {
                return Err(fields.wrong(element, format_args!("{name} is point {corner}, which does not exist")));
            }
            polygon.push(corner as u32);
        }
        surface.polygons.push(polygon);
    }
    Ok(surface)
}

/// The keyword is `OFF` behind letters for what stands behind the coordinates of each point.
fn check_keyword(word: &str, fields: &Fields) -> Result<(), Failure> {
    match word.strip_suffix("OFF") {
        Some("" | "C" | "N" | "CN" | "ST" | "STC" | "STN" | "STCN") => Ok(()),
        Some(_) => Err(fields.wrong(word, "only points in three coordinates can be read")),
        None => Err(fields.wrong("keyword", format_args!("is {word:?}, expected OFF"))),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn parse(text: &str) -> Result<(Surface, Source), String> {
        let path = Path::new("in.off");
        let mut source = Source::new(path);
        match parse_off(path, text.as_bytes(), &mut source) {
            Ok(surface) => Ok((surface, source)),
            Err(failure) => Err(failure.message().to_owned()),
        }
    }

    #[test]
    fn headers_of_all_kinds() {
        for header in ["OFF\n3 1 0", "OFF 3 1", "# c\nOFF # d\n\n3 1 3", "COFF\n3 1 0", "STCNOFF 3 1 0", "3 1 0"] {
            let text = format!("{header}\n0 0 0 9 9\n1 0 0\n0 1 0.5\n3 2 0\n 1 # over two lines\n");
            let (surface, source) = parse(&text).unwrap();
            assert_eq!(surface.points, [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 1.0, 0.5)], "{header}");
            assert_eq!(surface.polygons, [[2, 0, 1]]);
            let line = header.lines().count() + 4;
            assert_eq!(source.facets, [Place { line, number: 0 }]);
        }
    }

    #[test]
    fn each_defect_is_named_by_line_and_element() {
        for (text, message) in [
            ("", "in.off:1: keyword OFF: missing, the file ends here"),
            ("PLY\n", "in.off:1: keyword: is \"PLY\", expected OFF"),
            ("4OFF\n", "in.off:1: header: number of points is \"4OFF\", expected a whole number, 0 or more"),
            ("nOFF\n3\n", "in.off:1: nOFF: only points in three coordinates can be read"),
            ("OFF BINARY\n", "in.off:1: BINARY: files of this kind can't be read, only text can"),
            ("OFF\n1\n", "in.off:2: header: number of polygons is missing"),
            ("OFF\n1 1\n0 0\n", "in.off:3: point 0: z coordinate is missing"),
            ("OFF\n1 1 0\n0 0 0\n", "in.off:3: facet 0 of 1: missing, the file ends here"),
            ("OFF\n1 1 0\n0 0 0\n3 0 0\n", "in.off:4: facet 0, corner 2 of 3: missing, the file ends here"),
            ("OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "in.off:4: facet 0: corner 2 is point 1, which does not exist"),
            ("OFF\n5000000000 1\n", "in.off:2: header: 5000000000 elements, but 32-bit indices can't number so many"),
        ] {
            assert_eq!(parse(text).unwrap_err(), message, "{text:?}");
        }
    }
}
