//! `.stl` files, text or binary, by the crate `stl_io`. Their numbers have 32 bits; corners with the same ones are one point.

use std::io::Cursor;
use std::path::Path;

use glam::DVec3;

use super::surface::Surface;
use crate::failure::Failure;

/// Reads the content of an `.stl` file.
pub fn parse_stl(path: &Path, content: &[u8]) -> Result<Surface, Failure> {
    let mesh = stl_io::read_stl(&mut Cursor::new(content)).map_err(|error| Failure::in_file(path, error))?;
    let point = |v: &stl_io::Vertex| DVec3::from_array(v.0.map(f64::from));
    Ok(Surface {
        points: mesh.vertices.iter().map(point).collect(),
        polygons: mesh.faces.iter().map(|face| face.vertices.map(|v| v as u32).to_vec()).collect(),
        markers: Vec::new(),
    })
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
        let failure = parse_stl(Path::new("in.stl"), b"solid x\nfacet bad\n").unwrap_err();
        assert!(failure.message().starts_with("in.stl: "), "{failure:?}");
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
