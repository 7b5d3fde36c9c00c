//! `.obj` files by the crate `tobj`: points and faces; normals, textures and materials are passed over. Each object or group is a part: its
//! number, from 1, becomes its facets' marker.

use std::borrow::Cow;
use std::path::Path;

use glam::DVec3;

use super::fields::Numbered;
use super::surface::Surface;
use crate::failure::Failure;

/// Reads the content of an `.obj` file.
pub fn parse_obj(path: &Path, content: &[u8]) -> Result<Surface, Failure> {
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..tobj::LoadOptions::default() };
    let no_materials = |_: &Path| Ok(Default::default());
    let (content, points) = points_and_faces(path, content)?;
    let mut reader = content.as_bytes();
    let loaded = tobj::load_obj_buf(&mut reader, &options, no_materials);
    let (models, _) = loaded.map_err(|error| {
        // What is left unread tells in which line it stopped.
        let line = content[..content.len() - reader.len()].lines().count();
        Failure::in_line(path, line, "line", error)
    })?;
    let mut surface = Surface::default();
    for (number, model) in models.iter().enumerate() {
        let base = surface.points.len() as u32;
        surface.points.extend(model.mesh.positions.chunks_exact(3).map(DVec3::from_slice));
        let mut corners = model.mesh.indices.iter().map(|&v| base + v);
        let faces = model.mesh.indices.len() / 3;
        // Without a list of sizes all faces are triangles.
        let sizes = if model.mesh.face_arities.is_empty() { vec![3; faces] } else { model.mesh.face_arities.clone() };
        for size in sizes {
            surface.polygons.push(corners.by_ref().take(size as usize).collect());
            surface.markers.push(i32::try_from(number + 1).unwrap_or(i32::MAX));
        }
    }
    // The crate has no points but those of faces. Alone they are as good as those of other files.
    if surface.polygons.is_empty() {
        surface.points = points;
    }
    Ok(surface)
}

/// The lines without what is passed over, some of it unread by `tobj`: an index of a normal or a texture beyond all of them would overflow there.
/// What is kept is looked at, so that what is wrong is named by its line: the crate tells no lines. Also the points.
fn points_and_faces(path: &Path, content: &[u8]) -> Result<(String, Vec<DVec3>), Failure> {
    let content = String::from_utf8_lossy(content);
    // A corner may be a point that comes later.
    let count = content.lines().filter(|line| line.split_whitespace().next() == Some("v")).count();
    let mut kept = String::with_capacity(content.len());
    let mut points = Vec::new();
    let mut lines = content.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        let mut line = Cow::from(line);
        let mut joined = 0;
        // A comment may end in one, as a folder's name does.
        let goes_on = |line: &str| line.trim_end().strip_suffix('\\').map(str::len).filter(|_| !line.starts_with('#'));
        while let Some(length) = goes_on(&line) {
            let line = line.to_mut();
            line.truncate(length);
            line.push(' ');
            line.push_str(lines.next().map_or("", |(_, next)| next));
            joined += 1;
        }
        let mut words = line.split_whitespace();
        match words.next() {
            Some("vn" | "vt" | "l" | "p") => {}
            Some("v") => {
                points.push(point(path, number + 1, points.len() + 1, words)?);
                keep_words(
                    &mut kept,
                    "v",
                    line.split_whitespace().skip(1).take(if is_weighted(&line) { 4 } else { 3 }),
                );
            }
            Some("f") => {
                let corners = words.map(|corner| corner.split('/').next().unwrap_or_default());
                if let Some(wrong) = corners.clone().position(|corner| !is_point(corner, points.len(), count)) {
                    let corner = line.split_whitespace().nth(wrong + 1).unwrap_or_default();
                    let element = format_args!("facet with corner \"{corner}\"");
                    return Err(Failure::in_line(path, number + 1, element, "that is no point"));
                }
                keep_words(&mut kept, "f", corners);
            }
            _ => kept.push_str(&line),
        }
        // Lines stay where they are.
        kept.extend(std::iter::repeat_n('\n', joined + 1));
    }
    Ok((kept, points))
}

fn keep_words<'a>(kept: &mut String, keyword: &str, words: impl Iterator<Item = &'a str>) {
    kept.push_str(keyword);
    for word in words {
        kept.push(' ');
        kept.push_str(word);
    }
}

/// Four numbers are a point and its weight; others behind the third are a colour.
fn is_weighted(line: &str) -> bool {
    line.split_whitespace().count() == 5
}

/// The point of a line whose words behind the first are these.
fn point<'a>(
    path: &Path,
    line: usize,
    number: usize,
    words: impl Iterator<Item = &'a str> + Clone,
) -> Result<DVec3, Failure> {
    let wrong = |problem: String| Failure::in_line(path, line, Numbered("point", number), problem);
    let mut rest = words.clone();
    let mut real = |name: &str| {
        let word = rest.next().ok_or_else(|| wrong(format!("{name} is missing")))?;
        word.parse::<f64>().map_err(|_| wrong(format!("{name} is {word:?}, expected a number")))
    };
    let point = DVec3::new(real("x coordinate")?, real("y coordinate")?, real("z coordinate")?);
    if !point.is_finite() {
        return Err(wrong("a coordinate is not finite".to_owned()));
    }
    if words.count() != 4 {
        return Ok(point);
    }
    match real("weight")? {
        0.0 => Err(wrong("weight is 0".to_owned())),
        weight => Ok(point / weight),
    }
}

/// Whether a face's corner is one of so many points in all, by its number or by how far it is before the next of those so far.
fn is_point(corner: &str, so_far: usize, count: usize) -> bool {
    let places = |largest: usize| 1..=i64::try_from(largest).unwrap_or(i64::MAX);
    corner
        .parse::<i64>()
        .is_ok_and(|v| places(count).contains(&v) || v.checked_neg().is_some_and(|v| places(so_far).contains(&v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_of_any_size_and_parts() {
        let text = "# c\nmtllib none.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nf 1 2 3 4\no b\nv 0 0 1e-3\nf 1/1 2/2 5/5\n";
        let surface = parse_obj(Path::new("in.obj"), text.as_bytes()).unwrap();
        let at = |polygon: &[u32]| polygon.iter().map(|&v| surface.points[v as usize]).collect::<Vec<_>>();
        assert_eq!(at(&surface.polygons[0])[2], DVec3::new(1.0, 1.0, 0.1));
        assert_eq!(at(&surface.polygons[1]), [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 0.0, 1e-3)]);
        assert_eq!((surface.polygons[0].len(), &surface.markers[..]), (4, &[1, 2][..]));
    }

    #[test]
    fn each_defect_is_named_by_line() {
        for (text, message) in [
            ("v 0 0\n", "1: point 1: z coordinate is missing"),
            ("v 0 0 0\n\nv 0 y 0\n", "3: point 2: y coordinate is \"y\", expected a number"),
            ("v 0 0 inf\n", "1: point 1: a coordinate is not finite"),
            ("# v:\\\nv 0 0\n", "2: point 1: z coordinate is missing"),
            ("v 0 0 0 0\n", "1: point 1: weight is 0"),
            ("v 0 0 0 w\n", "1: point 1: weight is \"w\", expected a number"),
            ("v 0 0 0\nf 1 2/1 1\n", "2: facet with corner \"2/1\": that is no point"),
            ("v 0 0 0\nf -2 1 1\nv 1 0 0\n", "2: facet with corner \"-2\": that is no point"),
            ("v 0 0 0\nf 1 0 1\n", "2: facet with corner \"0\": that is no point"),
            ("v 0 \\\n0 0\nv 0\n", "3: point 2: y coordinate is missing"),
            ("v 0 0 0\n\nusemtl\nv 1 0 0\n", "3: line: material parse error"),
        ] {
            let failure = parse_obj(Path::new("in.obj"), text.as_bytes()).map(|_| text).unwrap_err();
            assert_eq!(failure.message(), format!("in.obj:{message}"));
        }
    }

    #[test]
    fn lines_go_on_behind_a_backslash() {
        let text = "v 0 0 0\nv 2 0 0 2\nv 1 1 \\\r\n0.1 1 0.5 0\nv 0 1 0\nf 1 2 \\\n\\\n -2 \\\n4\n";
        let surface = parse_obj(Path::new("in.obj"), text.as_bytes()).unwrap();
        assert_eq!(surface.points[..3], [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.1)]);
        assert_eq!(surface.polygons, [[0, 1, 2, 3]]);
        // Not behind the last line.
        let same = parse_obj(Path::new("in.obj"), text.replace("\n4\n", "\n4\\").as_bytes()).unwrap();
        assert_eq!(same, surface);
    }

    #[test]
    fn points_without_faces_are_kept() {
        let surface = parse_obj(Path::new("in.obj"), b"o a\nv 0 0 0\nv 2 0 4 2\nl 1 2\n").unwrap();
        assert_eq!((&surface.points[..], surface.polygons.len()), (&[DVec3::ZERO, DVec3::new(1.0, 0.0, 2.0)][..], 0));
    }

    #[test]
    fn normals_and_textures_are_not_looked_at() {
        // The last index times three is more than 64 bits hold.
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nvn nothing\nvt 0 0\nvn 0 0 1\nf 1/-9999999999/1 2//-6148914691236517206 3/1\n";
        let surface = parse_obj(Path::new("in.obj"), text.as_bytes()).unwrap();
        assert_eq!((surface.points.len(), &surface.polygons[..]), (3, &[vec![0, 1, 2]][..]));
        for corner in ["-6148914691236517206", "9223372036854775807", "x", "/1"] {
            let failure = parse_obj(Path::new("in.obj"), text.replace("3/1", corner).as_bytes()).unwrap_err();
            assert!(failure.message().starts_with("in.obj:7: "), "{failure:?}");
        }
    }
}
