//! Gmsh's `.msh` files, version 4.1, text: tetrahedra by reference, boundary triangles and edges by marker. The reference of a tetrahedron
//! is its region's attribute if all regions have whole numbers above 0 that differ, else 1 + the region's position; it is 0 outside of all.
//!
//! Where all of these are 0 there are no physical groups. Else each element is in one, since readers such as meshio want that of all or of
//! none: markers and references above 0 are the numbers of their groups, and each other one gets the lowest number that is free in the whole
//! file, with a name that tells what it stands for (`$PhysicalNames`: "facet marker -5", "segment marker 0", "no region").

use std::collections::{BTreeMap, BTreeSet};
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

/// The elements of one dimension.
struct Dimension {
    number: usize,
    /// Gmsh's number for their kind.
    kind: u32,
    /// Corners by marker or reference.
    groups: BTreeMap<i64, Vec<Vec<u32>>>,
}

impl Dimension {
    /// The name of a physical group that could not have its marker as its number.
    fn name(&self, marker: i64) -> String {
        match self.number {
            1 => format!("segment marker {marker}"),
            2 => format!("facet marker {marker}"),
            _ => "no region".to_owned(),
        }
    }
}

/// The number of the physical group of each group of elements, as far as there are such; those that are not the marker itself have names.
fn physical(all: &[Dimension; 3]) -> BTreeMap<(usize, i64), i64> {
    let markers = || all.iter().flat_map(|d| d.groups.keys().map(move |&marker| (d.number, marker)));
    if markers().all(|(_, marker)| marker == 0) {
        return BTreeMap::new();
    }
    let used: BTreeSet<i64> = markers().map(|(_, marker)| marker).collect();
    let mut free = (1..).filter(|number| !used.contains(number));
    markers().filter_map(|key| Some((key, if key.1 > 0 { key.1 } else { free.next()? }))).collect()
}

/// Writes a mesh as an `.msh` file.
pub fn write_msh(out: &mut dyn Write, mesh: &OutputMesh) -> io::Result<()> {
    let edges = groups(mesh.edges.iter().map(|&(edge, marker)| (edge, marker.into())));
    let faces = groups(mesh.faces.iter().map(|&(face, marker)| (face, marker.into())));
    let volumes =
        groups(mesh.tetrahedra.iter().zip(mesh.references()).map(|(&tet, reference)| (tet, reference.into())));
    let all = [(1, LINE, edges), (2, TRIANGLE, faces), (3, TETRAHEDRON, volumes)];
    let all = all.map(|(number, kind, groups)| Dimension { number, kind, groups });
    let physical = physical(&all);
    writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat")?;
    write_names(out, &all, &physical)?;
    let low = mesh.points.iter().copied().reduce(DVec3::min).unwrap_or_default().to_array().map(Shortest);
    let high = mesh.points.iter().copied().reduce(DVec3::max).unwrap_or_default().to_array().map(Shortest);
    let [lines, triangles, tetrahedra] = all.each_ref().map(|dimension| dimension.groups.len());
    writeln!(out, "$Entities\n0 {lines} {triangles} {tetrahedra}")?;
    for dimension in &all {
        for (tag, &marker) in dimension.groups.keys().enumerate() {
            write!(out, "{} {} {} {} {} {} {} ", tag + 1, low[0], low[1], low[2], high[0], high[1], high[2])?;
            match physical.get(&(dimension.number, marker)) {
                Some(number) => writeln!(out, "1 {number} 0")?,
                None => writeln!(out, "0 0")?,
            }
        }
    }
    let count = mesh.points.len();
    let dimension = if tetrahedra == 0 { 0 } else { 3 };
    writeln!(out, "$EndEntities\n$Nodes\n1 {count} 1 {count}\n{dimension} 1 0 {count}")?;
    for tag in 1..=count {
        writeln!(out, "{tag}")?;
    }
    for point in mesh.points.iter() {
        let [x, y, z] = point.to_array().map(Shortest);
        writeln!(out, "{x} {y} {z}")?;
    }
    let blocks = lines + triangles + tetrahedra;
    let elements: usize = all.iter().flat_map(|dimension| dimension.groups.values()).map(Vec::len).sum();
    writeln!(out, "$EndNodes\n$Elements\n{blocks} {elements} 1 {elements}")?;
    let mut number = 0;
    for Dimension { number: dimension, kind, groups } in &all {
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

/// Names the physical groups whose number is not the marker.
fn write_names(out: &mut dyn Write, all: &[Dimension; 3], physical: &BTreeMap<(usize, i64), i64>) -> io::Result<()> {
    let named: Vec<_> = physical.iter().filter(|((_, marker), number)| marker != *number).collect();
    if named.is_empty() {
        return Ok(());
    }
    writeln!(out, "$PhysicalNames\n{}", named.len())?;
    for (&(dimension, marker), number) in named {
        writeln!(out, "{dimension} {number} \"{}\"", all[dimension - 1].name(marker))?;
    }
    writeln!(out, "$EndPhysicalNames")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron with so many of its faces and edges marked, as a file.
    fn written(faces: &[i32], edges: &[i32], regions: &[u32], references: &[u32]) -> String {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let mesh = OutputMesh {
            points: points.to_vec().into(),
            tetrahedra: vec![[0, 1, 2, 3]; regions.len()],
            regions: regions.to_vec(),
            region_references: references.to_vec(),
            faces: [[1, 2, 3], [0, 2, 3], [0, 1, 3]].into_iter().zip(faces.iter().copied()).collect(),
            edges: [[0, 1], [1, 2]].into_iter().zip(edges.iter().copied()).collect(),
            ..OutputMesh::default()
        };
        let mut bytes = Vec::new();
        write_msh(&mut bytes, &mesh).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    fn section<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
        let lines = text.lines().skip_while(|line| line[1..] != *name).skip(1);
        lines.take_while(|line| !line.starts_with("$End")).collect()
    }

    /// Dimension by dimension, the physical group of each entity.
    fn groups(text: &str) -> Vec<&str> {
        let lines = &section(text, "Entities")[1..];
        let groups = lines.iter().map(|line| line.splitn(8, ' ').nth(7).unwrap());
        groups.map(|rest| rest.strip_suffix(" 0").unwrap()).collect()
    }

    #[test]
    fn without_markers_and_regions_there_are_no_groups() {
        let text = written(&[0, 0, 0], &[0, 0], &[0], &[]);
        assert_eq!(groups(&text), ["0", "0", "0"]);
        assert!(section(&text, "PhysicalNames").is_empty());
    }

    #[test]
    fn one_marker_puts_everything_into_a_group() {
        let text = written(&[1, 0, 3], &[0, 0], &[0], &[]);
        // Edges, then the faces in the order of their markers, then the tetrahedron.
        assert_eq!(groups(&text), ["1 2", "1 4", "1 1", "1 3", "1 5"]);
        let names = ["3", "1 2 \"segment marker 0\"", "2 4 \"facet marker 0\"", "3 5 \"no region\""];
        assert_eq!(section(&text, "PhysicalNames"), names);
    }

    #[test]
    fn negative_markers_have_groups_of_their_own() {
        let text = written(&[-5, i32::MIN, i32::MAX], &[-5, 2], &[1, 2], &[0, 40, 30]);
        assert_eq!(groups(&text), ["1 1", "1 2", "1 3", "1 4", "1 2147483647", "1 30", "1 40"]);
        let names = ["3", "1 1 \"segment marker -5\"", "2 3 \"facet marker -2147483648\"", "2 4 \"facet marker -5\""];
        assert_eq!(section(&text, "PhysicalNames"), names);
        // Without references regions go by their position, and where all have a number nothing needs a name.
        let text = written(&[7], &[7], &[2, 1], &[]);
        assert_eq!(groups(&text), ["1 7", "1 7", "1 1", "1 2"]);
        assert!(!text.contains("$PhysicalNames"));
    }
}
