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
    let mut reader = content;
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
}
