//! VTK's XML files of unstructured grids (`.vtu`), which ParaView opens. Arrays are inline base64 of little-endian numbers behind their length in
//! bytes, which every reader of the format knows.
//!
//! | of points | |
//! |---|---|
//! | `steiner` | 1 for points that were added |
//! | `kind` | what the point lies on: 0 nothing, 1 it is an input vertex, 2 a segment, 3 a facet |
//! | `element` | the position, from 0, of the segment or facet that the point was put on; -1 for others, also for the input's corners |
//! | `marker` | the point's own in the input, or that of its segment or facet; else 0 |
//!
//! Segments are counted with those of the input first, then facets' sides that are none of these; facets as they are meshed, that is when
//! polygons have been cut or joined.
//!
//! | of tetrahedra | |
//! |---|---|
//! | `radius_edge`, `min_dihedral_degrees` | their quality |
//! | `region` | 0, or 1 + the position of the region |
//! | `attribute` | the region's attribute, 0 outside of all; where there are regions |
//!
//! Written by hand: the document is this one fixed skeleton, without a text that would need escaping, and the
//! arrays stream through the encoder, so that no second copy of a big mesh is made.

use std::io::{self, BufWriter, IntoInnerError, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use wellspaced::geometry::quality::{min_dihedral_degrees, radius_edge};

use super::OutputMesh;

/// VTK's number for a tetrahedron.
const VTK_TETRA: u8 = 10;

/// Writes a mesh as a `.vtu` file.
pub fn write_vtu(out: &mut dyn Write, mesh: &OutputMesh) -> io::Result<()> {
    let (points, cells) = (mesh.points.len(), mesh.tetrahedra.len());
    writeln!(out, r#"<?xml version="1.0"?>"#)?;
    writeln!(out, r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">"#)?;
    writeln!(out, "<UnstructuredGrid>")?;
    writeln!(out, r#"<Piece NumberOfPoints="{points}" NumberOfCells="{cells}">"#)?;

    writeln!(out, "<Points>")?;
    let coordinates = mesh.points.iter().flat_map(|p| p.to_array()).map(f64::to_le_bytes);
    array(out, r#"type="Float64" Name="Points" NumberOfComponents="3""#, 3 * points, coordinates)?;
    writeln!(out, "</Points>\n<Cells>")?;
    let corners = mesh.tetrahedra.iter().flatten().map(|&corner| i64::from(corner).to_le_bytes());
    array(out, r#"type="Int64" Name="connectivity""#, 4 * cells, corners)?;
    let ends = (1..=cells as i64).map(|cell| (4 * cell).to_le_bytes());
    array(out, r#"type="Int64" Name="offsets""#, cells, ends)?;
    array(out, r#"type="UInt8" Name="types""#, cells, (0..cells).map(|_| [VTK_TETRA]))?;
    writeln!(out, "</Cells>")?;

    writeln!(out, r#"<PointData Scalars="steiner">"#)?;
    array(out, r#"type="UInt8" Name="steiner""#, points, mesh.steiner.iter().map(|&flag| [u8::from(flag)]))?;
    array(out, r#"type="UInt8" Name="kind""#, mesh.point_kinds.len(), mesh.point_kinds.iter().map(|&kind| [kind]))?;
    let elements = mesh.point_elements.iter().map(|&element| element.to_le_bytes());
    array(out, r#"type="Int32" Name="element""#, mesh.point_elements.len(), elements)?;
    let markers = mesh.point_markers.iter().map(|&marker| marker.to_le_bytes());
    array(out, r#"type="Int32" Name="marker""#, mesh.point_markers.len(), markers)?;
    writeln!(out, "</PointData>")?;
    writeln!(out, r#"<CellData Scalars="radius_edge">"#)?;
    let shapes = || mesh.tetrahedra.iter().map(|t| t.map(|corner| mesh.points[corner as usize]));
    let ratios = shapes().map(|shape| radius_edge(shape).to_le_bytes());
    array(out, r#"type="Float64" Name="radius_edge""#, cells, ratios)?;
    let angles = shapes().map(|shape| min_dihedral_degrees(shape).to_le_bytes());
    array(out, r#"type="Float64" Name="min_dihedral_degrees""#, cells, angles)?;
    let regions = mesh.regions.iter().map(|&region| region.to_le_bytes());
    array(out, r#"type="UInt32" Name="region""#, cells, regions)?;
    if !mesh.attributes.is_empty() {
        let attributes = mesh.attributes.iter().map(|&attribute| attribute.to_le_bytes());
        array(out, r#"type="Float64" Name="attribute""#, cells, attributes)?;
    }
    writeln!(out, "</CellData>")?;
    writeln!(out, "</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

/// One `DataArray` of `count` numbers of `N` bytes.
fn array<const N: usize>(
    out: &mut dyn Write,
    attributes: &str,
    count: usize,
    numbers: impl Iterator<Item = [u8; N]>,
) -> io::Result<()> {
    writeln!(out, r#"<DataArray {attributes} format="binary">"#)?;
    // The encoder is quick with long pieces only.
    let mut encoder = BufWriter::with_capacity(3 << 14, EncoderWriter::new(&mut *out, &STANDARD));
    encoder.write_all(&((count * N) as u64).to_le_bytes())?;
    let mut written = 0;
    for number in numbers {
        encoder.write_all(&number)?;
        written += 1;
    }
    assert_eq!(written, count, "length of the array {attributes}");
    encoder.into_inner().map_err(IntoInnerError::into_error)?.finish()?;
    writeln!(out, "\n</DataArray>")
}

#[cfg(test)]
mod tests {
    use base64::Engine;
    use glam::DVec3;

    use super::*;

    /// The bytes of the array of this name, checked against the length before them.
    fn decoded(text: &str, name: &str) -> Vec<u8> {
        let start = text.find(&format!("Name=\"{name}\"")).unwrap();
        let start = start + text[start..].find('\n').unwrap() + 1;
        let end = start + text[start..].find('\n').unwrap();
        let bytes = STANDARD.decode(&text[start..end]).unwrap();
        assert_eq!(u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize, bytes.len() - 8, "{name}");
        bytes[8..].to_vec()
    }

    fn reals(text: &str, name: &str) -> Vec<f64> {
        decoded(text, name).chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    }

    #[test]
    fn every_array_holds_what_it_says() {
        let points = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]].map(DVec3::from_array);
        let mesh = OutputMesh {
            points: points.to_vec().into(),
            tetrahedra: vec![[0, 2, 1, 3]],
            steiner: vec![false, false, true, false],
            regions: vec![7],
            point_markers: vec![0, -3, 1, 2],
            point_kinds: vec![1, 1, 2, 0],
            point_elements: vec![-1, -1, 5, -1],
            attributes: vec![-2.5],
            ..OutputMesh::default()
        };
        let mut bytes = Vec::new();
        write_vtu(&mut bytes, &mesh).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains(r#"NumberOfPoints="4" NumberOfCells="1""#));
        assert_eq!(reals(&text, "Points"), [1.0, 1.0, 1.0, -1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, -1.0]);
        let corners = decoded(&text, "connectivity");
        assert_eq!(corners.chunks_exact(8).map(|b| b[0]).collect::<Vec<_>>(), [0, 2, 1, 3]);
        assert_eq!(decoded(&text, "offsets"), 4i64.to_le_bytes());
        assert_eq!(decoded(&text, "types"), [10]);
        assert_eq!(decoded(&text, "region"), [7, 0, 0, 0]);
        assert_eq!(decoded(&text, "steiner"), [0, 0, 1, 0]);
        assert_eq!(decoded(&text, "kind"), [1, 1, 2, 0]);
        assert_eq!(decoded(&text, "element"), [-1, -1, 5, -1i32].map(i32::to_le_bytes).concat());
        assert_eq!(reals(&text, "attribute"), [-2.5]);
        assert_eq!(decoded(&text, "marker")[4..8], (-3i32).to_le_bytes());
        // The regular tetrahedron: R/l = sqrt(6)/4, dihedral angles acos(1/3).
        assert!((reals(&text, "radius_edge")[0] - 0.375f64.sqrt()).abs() < 1e-14);
        assert!((reals(&text, "min_dihedral_degrees")[0] - 70.528_779_365_509_31).abs() < 1e-12);
    }

    #[test]
    fn a_mesh_without_tetrahedra_is_a_whole_document() {
        let mut bytes = Vec::new();
        let mesh = OutputMesh {
            points: vec![DVec3::ZERO].into(),
            steiner: vec![false],
            point_kinds: vec![1],
            point_elements: vec![-1],
            point_markers: vec![0],
            ..OutputMesh::default()
        };
        write_vtu(&mut bytes, &mesh).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.ends_with("</VTKFile>\n"));
        assert!(decoded(&text, "radius_edge").is_empty());
        assert!(!text.contains("\"attribute\""), "without regions");
    }
}
