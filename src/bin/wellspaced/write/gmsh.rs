//! Gmsh's `.msh` files, version 4.1, text: tetrahedra by region, boundary triangles and edges by marker. Each marker above 0 is a physical
//! group; regions are physical groups of volumes, from 1.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;

use super::number::Shortest;
use super::OutputMesh;

/// Gmsh's numbers for the kinds of elements.
const LINE: u32 = 1;
const TRIANGLE: u32 = 2;
const TETRAHEDRON: u32 = 4;

/// Elements of one dimension by marker.
fn groups<const N: usize>(elements: impl Iterator<Item = ([u32; N], i64)>) -> BTreeMap<i64, Vec<Vec<u32>>> {
    let mut groups: BTreeMap<i64, Vec<Vec<u32>>> = BTreeMap::new();
    for (corners, marker) in elements {
        groups.entry(marker).or_default().push(corners.to_vec());
    }
    groups
}

/// Writes a mesh as an `.msh` file.
pub fn write_msh(out: &mut dyn Write, mesh: &OutputMesh) -> io::Result<()> {
    let edges = groups(mesh.edges.iter().map(|&(edge, marker)| (edge, marker.into())));
    let faces = groups(mesh.faces.iter().map(|&(face, marker)| (face, marker.into())));
    let volumes = groups(mesh.tetrahedra.iter().zip(mesh.regions.iter()).map(|(&tet, &region)| (tet, region.into())));
    let all = [(1, LINE, edges), (2, TRIANGLE, faces), (3, TETRAHEDRON, volumes)];
    writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat")?;
    let low = mesh.points.iter().copied().reduce(DVec3::min).unwrap_or_default().to_array().map(Shortest);
    let high = mesh.points.iter().copied().reduce(DVec3::max).unwrap_or_default().to_array().map(Shortest);
    writeln!(out, "$Entities\n0 {} {} {}", all[0].2.len(), all[1].2.len(), all[2].2.len())?;
    for (_, _, groups) in &all {
        for (tag, &marker) in groups.keys().enumerate() {
            write!(out, "{} {} {} {} {} {} {} ", tag + 1, low[0], low[1], low[2], high[0], high[1], high[2])?;
            match marker {
                1.. => writeln!(out, "1 {marker} 0")?,
                _ => writeln!(out, "0 0")?,
            }
        }
    }
    let count = mesh.points.len();
    let dimension = if all[2].2.is_empty() { 0 } else { 3 };
    writeln!(out, "$EndEntities\n$Nodes\n1 {count} 1 {count}\n{dimension} 1 0 {count}")?;
    for tag in 1..=count {
        writeln!(out, "{tag}")?;
    }
    for point in mesh.points.iter() {
        let [x, y, z] = point.to_array().map(Shortest);
        writeln!(out, "{x} {y} {z}")?;
    }
    let blocks: usize = all.iter().map(|(_, _, groups)| groups.len()).sum();
    let elements: usize = all.iter().flat_map(|(_, _, groups)| groups.values()).map(Vec::len).sum();
    writeln!(out, "$EndNodes\n$Elements\n{blocks} {elements} 1 {elements}")?;
    let mut number = 0;
    for (dimension, kind, groups) in &all {
        for (tag, list) in groups.values().enumerate() {
            writeln!(out, "{dimension} {} {kind} {}", tag + 1, list.len())?;
            for corners in list {
                number += 1;
                write!(out, "{number}")?;
                for corner in corners {
                    write!(out, " {}", corner + 1)?;
                }
                writeln!(out)?;
            }
        }
    }
    writeln!(out, "$EndElements")
}
