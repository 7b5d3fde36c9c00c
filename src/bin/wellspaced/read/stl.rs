//! `.stl` files, text or binary, by the crate `stl_io`. Their numbers have 32 bits; corners with the same ones are one point.

use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

use glam::DVec3;

use super::fields::Numbered;
use super::surface::Surface;
use crate::failure::Failure;

/// Bytes before the triangles of a binary file: 80 of any content, then their number.
const HEADER: usize = 84;
/// Bytes of one triangle.
const TRIANGLE: usize = 50;
/// The lines of a triangle in a text file; a star stands for a number.
const LINES: [&str; 7] =
    ["facet normal * * *", "outer loop", "vertex * * *", "vertex * * *", "vertex * * *", "endloop", "endfacet"];

/// Reads the content of an `.stl` file.
pub fn parse_stl(path: &Path, content: &[u8]) -> Result<Surface, Failure> {
    let count = content.get(HEADER - 4..HEADER).and_then(|bytes| bytes.try_into().ok()).map(u32::from_le_bytes);
    let length = count.map(|count| HEADER as u64 + TRIANGLE as u64 * u64::from(count));
    // Some binary files begin as text does, but their length gives them away.
    let text = is_text(content) && length != Some(content.len() as u64);
    let content = if text { Cow::from(plain_text(content)) } else { binary(path, content, length)? };
    let mesh = stl_io::read_stl(&mut Cursor::new(&content[..]));
    let mesh = mesh.map_err(|error| if text { wrong_line(path, &content) } else { Failure::in_file(path, error) })?;
    let point = |v: &stl_io::Vertex| DVec3::from_array(v.0.map(f64::from));
    Ok(Surface {
        points: mesh.vertices.iter().map(point).collect(),
        polygons: mesh.faces.iter().map(|face| face.vertices.map(|v| v as u32).to_vec()).collect(),
        markers: Vec::new(),
    })
}

fn is_text(content: &[u8]) -> bool {
    let (keyword, rest) = content.split_at(content.len().min(5));
    keyword.eq_ignore_ascii_case(b"solid") && rest.first().is_none_or(u8::is_ascii_whitespace)
}

/// Text as the crate wants it: small letters, UTF-8, a blank behind the first word, and one solid, for it stops behind the first. The names, which
/// are lost, may be in any encoding. Lines stay where they are.
fn plain_text(content: &[u8]) -> Vec<u8> {
    let mut text = String::from_utf8_lossy(content).into_owned();
    text.make_ascii_lowercase();
    let mut plain = String::with_capacity(text.len() + 16);
    plain.push_str("solid \n");
    let mut ended = false;
    for line in text.lines().skip(1) {
        match line.split_whitespace().next() {
            Some("endsolid") => ended = true,
            Some("solid") if ended => ended = false,
            Some(_) if !ended => plain.push_str(line),
            _ => {}
        }
        plain.push('\n');
    }
    if ended {
        plain.push_str("endsolid\n");
    }
    plain.into_bytes()
}

/// A binary file of the right length or more, with a header that is not taken for text.
fn binary<'a>(path: &Path, content: &'a [u8], length: Option<u64>) -> Result<Cow<'a, [u8]>, Failure> {
    let Some(length) = length else {
        return Err(Failure::in_file(
            path,
            "does not begin with solid, as text does, and is too short for a binary file",
        ));
    };
    if (content.len() as u64) < length {
        let [whole, count] = [content.len() as u64, length].map(|bytes| (bytes - HEADER as u64) / TRIANGLE as u64);
        return Err(Failure::in_file(path, format_args!("facet {whole} of {count}: missing, the file ends here")));
    }
    let mut content = Cow::from(content);
    if is_text(&content) {
        content.to_mut()[..HEADER - 4].fill(0);
    }
    Ok(content)
}

/// The failure for text that the crate refuses: the first line that does not stand where it must.
fn wrong_line(path: &Path, content: &[u8]) -> Failure {
    let text = String::from_utf8_lossy(content);
    let mut lines = text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty());
    for facet in 0.. {
        for (place, expected) in LINES.iter().enumerate() {
            let element = Numbered("facet", facet);
            let Some((line, found)) = lines.next() else {
                let element = if place == 0 { "endsolid".to_owned() } else { element.to_string() };
                return Failure::in_line(path, text.lines().count(), element, "missing, the file ends here");
            };
            if !is_like(found, expected) {
                let expected = expected.replace('*', "NUMBER");
                return Failure::in_line(
                    path,
                    line + 1,
                    element,
                    format_args!("{:?}, expected {expected}", found.trim()),
                );
            }
        }
    }
    Failure::in_file(path, "can't be read as text")
}

fn is_like(line: &str, expected: &str) -> bool {
    let same = |(found, expected): (&str, &str)| match expected {
        "*" => found.parse::<f32>().is_ok_and(f32::is_finite),
        word => found == word,
    };
    let [found, words] = [line, expected].map(str::split_whitespace);
    found.clone().count() == words.clone().count() && found.zip(words).all(same)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_shared() {
        let facet = |corners: &str| format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n");
        let [a, b, c, d] = ["0 0 0", "1 0 0", "1 1 0.5", "0 1 0"].map(|v| format!("vertex {v}\n"));
        let (first, second) = (facet(&format!("{a}{b}{c}")), facet(&format!("{a}{c}{d}")));
        let surface = parse_stl(Path::new("in.stl"), format!("solid x\n{first}{second}endsolid x\n").as_bytes());
        let surface = surface.unwrap();
        assert_eq!(surface.points[2], DVec3::new(1.0, 1.0, 0.5));
        assert_eq!(surface.polygons, [[0, 1, 2], [0, 2, 3]]);
    }

    const FACET: &str =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0.5\nendloop\nendfacet\n";

    #[test]
    fn text_in_capitals_or_without_a_name() {
        let expected = parse_stl(Path::new("in.stl"), format!("solid x\n{FACET}endsolid x\n").as_bytes()).unwrap();
        assert_eq!((expected.points.len(), expected.polygons.len()), (3, 1));
        let capitals = format!("SOLID X\n{}ENDSOLID X\n", FACET.to_ascii_uppercase().replace("0.5", "5E-1"));
        let mixed = format!("Solid\r\n\n  {}EndSolid", FACET.replace("facet ", "Facet ").replace('\n', "\r\n"));
        let latin = [b"solid \xe9\n", FACET.as_bytes(), b"endsolid \xe9\n"].concat();
        for content in [capitals.into_bytes(), mixed.into_bytes(), latin] {
            assert_eq!(parse_stl(Path::new("in.stl"), &content).unwrap(), expected);
        }
    }

    #[test]
    fn all_solids_of_text_are_read() {
        let two = format!("solid a\n{FACET}endsolid a\n\nsolid b\n{}endsolid b\n", FACET.replace("0 0 0", "0 0 9"));
        let surface = parse_stl(Path::new("in.stl"), two.as_bytes()).unwrap();
        assert_eq!(surface.polygons, [[0, 1, 2], [3, 1, 2]]);
        let failure = parse_stl(Path::new("in.stl"), two.replace("0 0 9", "0 0").as_bytes()).unwrap_err();
        assert!(failure.message().starts_with("in.stl:14: facet 1: \"vertex 0 0\""), "{failure:?}");
        assert!(parse_stl(Path::new("in.stl"), two.replace("endsolid b\n", "").as_bytes()).is_err());
    }

    #[test]
    fn wrong_lines_of_text_are_named() {
        let good = format!("solid x\n\n{FACET}");
        for (text, message) in [
            (good.clone(), "9: endsolid: missing, the file ends here"),
            (format!("{good}facet bad\n"), "10: facet 1: \"facet bad\", expected facet normal NUMBER NUMBER NUMBER"),
            (good.replace("1 0 0", "1 0 x"), "6: facet 0: \"vertex 1 0 x\", expected vertex NUMBER NUMBER NUMBER"),
            (good.replace("1 0 0", "1 inf 0"), "6: facet 0: \"vertex 1 inf 0\", expected vertex NUMBER NUMBER NUMBER"),
            (good.replace("endloop\nendfacet\n", ""), "7: facet 0: missing, the file ends here"),
            ("solid".to_owned(), "1: endsolid: missing, the file ends here"),
        ] {
            let failure = parse_stl(Path::new("in.stl"), text.as_bytes()).unwrap_err();
            assert_eq!(failure.message(), format!("in.stl:{message}"));
        }
    }

    #[test]
    fn binary_files_by_their_length() {
        // It begins as text does.
        let mut content = format!("{:80}", "solid box").into_bytes();
        content.extend(2u32.to_le_bytes());
        for x in [0.0f32, 1.0] {
            for number in [0.0, 0.0, 1.0, 0.0, 0.0, x, 1.0, 0.0, x, 0.0, 1.0, x] {
                content.extend(number.to_le_bytes());
            }
            content.extend([0; 2]);
        }
        let path = Path::new("in.stl");
        assert_eq!(parse_stl(path, &content).unwrap().polygons, [[0, 1, 2], [3, 4, 5]]);
        content[..5].fill(b' ');
        let told = |content: &[u8]| parse_stl(path, content).unwrap_err().message().to_owned();
        assert_eq!(told(&content[..183]), "in.stl: facet 1 of 2: missing, the file ends here");
        assert_eq!(told(&content[..90]), "in.stl: facet 0 of 2: missing, the file ends here");
        let short = "in.stl: does not begin with solid, as text does, and is too short for a binary file";
        assert_eq!((told(&content[..83]), told(b"")), (short.to_owned(), short.to_owned()));
    }

    /// Found by fuzzing.
    #[test]
    fn coordinates_of_binary_files_must_be_finite() {
        let mut content = vec![b' '; 80];
        content.extend(1u32.to_le_bytes());
        for x in [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, f32::NAN, 0.0] {
            content.extend(f32::to_le_bytes(x));
        }
        content.extend([0; 2]);
        let path = Path::new("in.stl");
        let failure = parse_stl(path, &content).and_then(|surface| surface.into_domain(path)).unwrap_err();
        assert_eq!(failure.message(), "in.stl: point 2: a coordinate is not finite");
    }
}
