//! `.ply` files, text or binary, by the crate `ply-rs-bw`: the properties `x`, `y`, `z` of the element `vertex`, and `vertex_indices` or
//! `vertex_index` of the element `face`; all else is passed over.

use std::path::Path;

use glam::DVec3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use super::surface::Surface;
use crate::failure::Failure;

/// Reads the content of a `.ply` file.
pub fn parse_ply(path: &Path, content: &[u8]) -> Result<Surface, Failure> {
    let mut reader = content;
    let ply = Parser::<DefaultElement>::new().read_ply(&mut reader);
    let ply = ply.map_err(|error| Failure::in_file(path, error))?;
    let mut surface = Surface::default();
    for (number, vertex) in ply.payload.get("vertex").into_iter().flatten().enumerate() {
        let coordinate = |name: &str| {
            let value = vertex.get(name).and_then(real);
            value.ok_or_else(|| Failure::in_file(path, format_args!("point {number}: {name} is missing or no number")))
        };
        surface.points.push(DVec3::new(coordinate("x")?, coordinate("y")?, coordinate("z")?));
    }
    for (number, face) in ply.payload.get("face").into_iter().flatten().enumerate() {
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
        let failure = parse_ply(Path::new("in.ply"), b"plx\n").unwrap_err();
        assert!(failure.message().starts_with("in.ply: "), "{failure:?}");
    }
}
