//! Medit's `.mesh` files, text: each list of elements with a reference number. Of vertices, edges and triangles it is the marker; of a
//! tetrahedron its region's attribute if all regions have whole numbers above 0 that differ, else 1 + the region's position; 0 outside of all.

use std::io::{self, Write};

use super::number::Shortest;
use super::OutputMesh;

/// Writes a mesh as a `.mesh` file.
pub fn write_mesh(out: &mut dyn Write, mesh: &OutputMesh) -> io::Result<()> {
    writeln!(out, "MeshVersionFormatted 2\nDimension 3\nVertices\n{}", mesh.points.len())?;
    for (point, marker) in mesh.points.iter().zip(&mesh.point_markers) {
        let [x, y, z] = point.to_array().map(Shortest);
        writeln!(out, "{x} {y} {z} {marker}")?;
    }
    writeln!(out, "Edges\n{}", mesh.edges.len())?;
    for ([a, b], marker) in &mesh.edges {
        writeln!(out, "{} {} {marker}", a + 1, b + 1)?;
    }
    writeln!(out, "Triangles\n{}", mesh.faces.len())?;
    for ([a, b, c], marker) in &mesh.faces {
        writeln!(out, "{} {} {} {marker}", a + 1, b + 1, c + 1)?;
    }
    writeln!(out, "Tetrahedra\n{}", mesh.tetrahedra.len())?;
    for ([a, b, c, d], reference) in mesh.tetrahedra.iter().zip(mesh.references()) {
        writeln!(out, "{} {} {} {} {reference}", a + 1, b + 1, c + 1, d + 1)?;
    }
    writeln!(out, "End")
}
