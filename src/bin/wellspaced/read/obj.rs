//! `.obj` files by the crate `tobj`: points and faces; normals, textures and materials are passed over. Each object or group is a part: its
//! number, from 1, becomes its facets' marker.

use std::path::Path;

use glam::DVec3;

use super::surface::Surface;
use crate::failure::Failure;

/// Reads the content of an `.obj` file.
pub fn parse_obj(path: &Path, content: &[u8]) -> Result<Surface, Failure> {
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..tobj::LoadOptions::default() };
    let no_materials = |_: &Path| Ok(Default::default());
    let content = points_and_faces(path, content)?;
    let mut reader = content.as_bytes();
    let loaded = tobj::load_obj_buf(&mut reader, &options, no_materials);
    let (models, _) = loaded.map_err(|error| Failure::in_file(path, error))?;
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
    Ok(surface)
}

/// The lines without what is passed over, some of it unread by `tobj`: an index of a normal or a texture beyond all of them would overflow there.
fn points_and_faces(path: &Path, content: &[u8]) -> Result<String, Failure> {
    /// Larger than any index of a vertex, and far from overflow.
    const LARGEST: i64 = 1 << 32;
    let content = String::from_utf8_lossy(content);
    let mut kept = String::with_capacity(content.len());
    for (number, line) in content.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            // Lines stay where they are.
            Some("vn" | "vt" | "l" | "p") => {}
            Some("f") => {
                kept.push('f');
                for corner in words {
                    let vertex = corner.split('/').next().unwrap_or_default();
                    if vertex.parse::<i64>().map_or(true, |v| !(-LARGEST..=LARGEST).contains(&v)) {
                        let element = format_args!("facet with corner \"{corner}\"");
                        return Err(Failure::in_line(path, number + 1, element, "that is no point"));
                    }
                    kept.push(' ');
                    kept.push_str(vertex);
                }
            }
            _ => kept.push_str(line),
        }
        kept.push('\n');
    }
    Ok(kept)
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
        let failure = parse_obj(Path::new("in.obj"), b"v 0 0\n").unwrap_err();
        assert!(failure.message().starts_with("in.obj: "), "{failure:?}");
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
