//! Plain lists of points: three numbers a line, further columns ignored, `#` starts a comment. Columns are set apart
//! by blanks or by commas.

use std::path::Path;

use glam::DVec3;

use super::fields::{Lines, Numbered, Separator};
use super::source::Source;
use super::too_many;
use crate::failure::Failure;

/// Reads the content of a `.xyz` file; `source` learns where the points stand. Points are numbered from 1.
pub fn parse_xyz(path: &Path, content: &[u8], source: &mut Source) -> Result<Vec<DVec3>, Failure> {
    let mut lines = Lines::new(path, content, Separator::CommaOrBlank);
    let mut points = Vec::new();
    source.base = 1;
    while let Some(mut fields) = lines.next()? {
        let element = Numbered("point", points.len() + 1);
        if points.len() == u32::MAX as usize {
            return Err(fields.wrong(element, too_many(points.len() + 1, "points")));
        }
        points.push(fields.point(element)?);
        source.points.push(u32::try_from(fields.line()).unwrap_or(u32::MAX));
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Vec<DVec3>, String> {
        let path = Path::new("in.xyz");
        parse_xyz(path, text.as_bytes(), &mut Source::new(path)).map_err(|failure| failure.message().to_owned())
    }

    #[test]
    fn blanks_commas_comments_and_extra_columns() {
        let text = "# x y z\n1 2 3\n\n 4,5 , 6\r\n7\t8\t9 red 10 # last\n-1e-3,.5,0,,\n";
        let points = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0], [-1e-3, 0.5, 0.0]];
        assert_eq!(parse(text).unwrap(), points.map(DVec3::from_array));
        assert!(parse("# none\n").unwrap().is_empty());
    }

    #[test]
    fn each_defect_is_named_by_line_and_element() {
        for (text, message) in [
            ("1 2 3\n# c\n4 5\n", "in.xyz:3: point 2: z coordinate is missing"),
            ("1,,3,4\n", "in.xyz:1: point 1: y coordinate is \"\", expected a number"),
            ("x,y,z\n1,2,3\n", "in.xyz:1: point 1: x coordinate is \"x\", expected a number"),
            ("1 2 inf\n", "in.xyz:1: point 1: z coordinate is not finite"),
        ] {
            assert_eq!(parse(text).unwrap_err(), message, "{text:?}");
        }
    }
}
