//! Output files by their ending: `.vtu`, `.msh`, `.mesh`, or TetGen's pair `.node` and `.ele`, with `.face` and `.edge` if one of those is named.

mod atomic;
mod gmsh;
mod medit;
mod number;
mod tetgen;
mod vtu;

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;
use wellspaced::domain::Carrier;
use wellspaced::{Location, Mesh, Plc, PlcRegion};

pub use tetgen::write_poly;

use crate::failure::Failure;
use crate::read::ending;
use atomic::AtomicFile;

/// The kinds of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Vtu,
    Gmsh,
    Medit,
    /// `.node` and `.ele`, whichever was named.
    Tetgen,
    /// These and `.face` and `.edge`.
    TetgenAll,
}

/// A file to write, whose ending is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    path: PathBuf,
    format: Format,
}

impl OutputFile {
    /// Takes a command-line argument.
    pub fn parse(argument: &str) -> Result<Self, String> {
        let path = PathBuf::from(argument);
        let format = match ending(&path).as_deref() {
            Some("vtu") => Format::Vtu,
            Some("msh") => Format::Gmsh,
            Some("mesh") => Format::Medit,
            Some("node" | "ele") => Format::Tetgen,
            Some("face" | "edge") => Format::TetgenAll,
            _ => return Err("unknown ending, expected .vtu, .msh, .mesh, .node, .ele, .face or .edge".to_owned()),
        };
        Ok(OutputFile { path, format })
    }

    /// The files that writing makes.
    fn files(&self) -> Vec<PathBuf> {
        let with = |endings: &[&str]| endings.iter().map(|ending| self.path.with_extension(ending)).collect();
        match self.format {
            Format::Vtu | Format::Gmsh | Format::Medit => vec![self.path.clone()],
            Format::Tetgen => with(&["node", "ele"]),
            Format::TetgenAll => with(&["node", "ele", "face", "edge"]),
        }
    }

    /// Refuses, before any work, what could not be written or would replace one of the `inputs`.
    pub fn check(&self, inputs: &[&Path]) -> Result<(), Failure> {
        let folder = match self.path.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            return Err(Failure::in_file(&self.path, format_args!("there is no folder {}", folder.display())));
        }
        for file in self.files() {
            let Ok(file) = file.canonicalize() else { continue };
            if inputs.iter().any(|input| input.canonicalize().is_ok_and(|input| input == file)) {
                return Err(Failure::usage(format_args!("output {} would replace the input", file.display())));
            }
        }
        Ok(())
    }
}

/// A mesh ready to write: no gaps in the numbers of its vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputMesh<'a> {
    pub points: Cow<'a, [DVec3]>,
    pub tetrahedra: Vec<[u32; 4]>,
    /// For each point whether it was added.
    pub steiner: Vec<bool>,
    /// For each point its own marker in the input, or that of the segment or facet that it was put on; 0 for others.
    pub point_markers: Vec<i32>,
    /// For each point what it lies on: 0 nothing, 1 it is an input vertex, 2 a segment, 3 a facet.
    pub point_kinds: Vec<u8>,
    /// For each point the position of the segment or facet that it was put on, by its kind; -1 for other kinds.
    pub point_elements: Vec<i32>,
    /// For each tetrahedron 0, or 1 + the position of its region in the domain's list.
    pub regions: Vec<u32>,
    /// For each number in `regions` the one that stands for it in files which know one number only; empty where that is the same.
    pub region_references: Vec<u32>,
    /// For each tetrahedron its region's attribute; empty when there are no regions.
    pub attributes: Vec<f64>,
    /// The faces on facets, each with the facet's marker.
    pub faces: Vec<([u32; 3], i32)>,
    /// The edges on segments, each with the segment's marker.
    pub edges: Vec<([u32; 2], i32)>,
}

impl<'a> OutputMesh<'a> {
    /// Closes the gaps that removed vertices leave; the first `input_vertices` ids are the input's. `plc` is the domain that the mesh was made from.
    pub fn new(mesh: &'a Mesh, input_vertices: usize, plc: Option<&Plc>) -> Self {
        let points = mesh.triangulation().points();
        let numbers = numbers(points);
        let mut new = Self::numbered(points, &numbers, mesh.elements(), input_vertices);
        let count = new.points.len();
        new.point_markers = vec![0; count];
        new.point_kinds = vec![0; count];
        new.point_elements = vec![-1; count];
        if let Some(plc) = plc.filter(|plc| !plc.point_markers.is_empty()) {
            for (point, &marker) in plc.points.iter().zip(&plc.point_markers) {
                if let Location::Vertex(v) = mesh.triangulation().locate(*point, None) {
                    new.point_markers[numbers[v as usize] as usize] = marker;
                }
            }
        }
        if let Some(plc) = plc.filter(|plc| !plc.regions.is_empty()) {
            let attribute = |&region: &u32| match region {
                0 => 0.0,
                _ => plc.regions.get(region as usize - 1).map_or(0.0, |region| region.attribute),
            };
            new.attributes = new.regions.iter().map(attribute).collect();
            new.region_references = region_references(&plc.regions);
        }
        let Some(boundary) = mesh.boundary() else { return new };
        let renumbered = |v: u32| numbers[v as usize];
        for (face, facet) in boundary.subfacets() {
            new.faces.push((face.map(renumbered), boundary.facets()[facet as usize].marker));
        }
        for (edge, segment) in boundary.subsegments() {
            new.edges.push((edge.map(renumbered), boundary.segments()[segment as usize].marker));
        }
        for v in mesh.triangulation().vertices() {
            let (kind, element, marker) = match boundary.carrier(v) {
                Carrier::Vertex(_) => (1, None, None),
                Carrier::Segment(s) => (2, Some(s), Some(boundary.segments()[s as usize].marker)),
                Carrier::Facet(f) => (3, Some(f), Some(boundary.facets()[f as usize].marker)),
                _ => (u8::from((v as usize) < input_vertices), None, None),
            };
            let number = renumbered(v) as usize;
            new.point_kinds[number] = kind;
            new.point_elements[number] = element.and_then(|element| i32::try_from(element).ok()).unwrap_or(-1);
            new.point_markers[number] = marker.unwrap_or(new.point_markers[number]);
        }
        new
    }

    /// Points and tetrahedra, by those numbers.
    fn numbered(
        points: &'a [DVec3],
        numbers: &[u32],
        elements: impl Iterator<Item = ([u32; 4], u32)>,
        input_vertices: usize,
    ) -> Self {
        let ids = (0..points.len()).filter(|&id| points[id].is_finite());
        let steiner: Vec<bool> = ids.map(|id| id >= input_vertices).collect();
        let points = match steiner.len() == points.len() {
            true => Cow::Borrowed(points),
            false => points.iter().copied().filter(|point| point.is_finite()).collect(),
        };
        let renumbered = |v: [u32; 4]| v.map(|corner| numbers[corner as usize]);
        let (tetrahedra, regions) = elements.map(|(v, region)| (renumbered(v), region)).unzip();
        OutputMesh { points, tetrahedra, steiner, regions, ..OutputMesh::default() }
    }

    /// For each tetrahedron the number that stands for its region in files which know one number only.
    fn references(&self) -> impl Iterator<Item = u32> + '_ {
        let reference = |&region: &u32| self.region_references.get(region as usize).copied().unwrap_or(region);
        self.regions.iter().map(reference)
    }
}

/// The numbers that stand for the regions, behind the 0 outside of all: their attributes, if these can tell them apart in every format; else none.
fn region_references(regions: &[PlcRegion]) -> Vec<u32> {
    let mut seen = BTreeSet::new();
    let whole = |attribute: f64| attribute.fract() == 0.0 && (1.0..=f64::from(i32::MAX)).contains(&attribute);
    let numbers = regions.iter().map(|region| whole(region.attribute).then_some(region.attribute as u32));
    let numbers = numbers.map(|number| number.filter(|&number| seen.insert(number)));
    std::iter::once(Some(0)).chain(numbers).collect::<Option<_>>().unwrap_or_default()
}

/// The number of each id without those that have no vertex.
fn numbers(points: &[DVec3]) -> Vec<u32> {
    let mut next = 0;
    let number = |point: &DVec3| {
        let number = next;
        next += u32::from(point.is_finite());
        number
    };
    points.iter().map(number).collect()
}

/// Writes a mesh to all `outputs`. Each file appears whole or not at all, and none appears if one can't be written.
pub fn write(outputs: &[OutputFile], mesh: &OutputMesh) -> Result<(), Failure> {
    let mut places: Vec<PathBuf> = outputs.iter().flat_map(OutputFile::files).collect();
    places.sort();
    places.dedup();
    let mut files = Vec::new();
    for place in &places {
        files.push(AtomicFile::create(place)?);
    }
    // Each by a thread of its own: making text of numbers takes longer than writing it.
    std::thread::scope(|scope| {
        let mut writers = Vec::new();
        for (file, place) in files.iter_mut().zip(&places) {
            let fill = move || file.fill(|out: &mut dyn Write| write_one(out, place, mesh));
            let writer = std::thread::Builder::new().spawn_scoped(scope, fill);
            writers.push(writer.map_err(|error| Failure::in_file(place, error))?);
        }
        let written = |writer: std::thread::ScopedJoinHandle<'_, _>| match writer.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        writers.into_iter().try_for_each(written)
    })?;
    files.into_iter().try_for_each(AtomicFile::commit)
}

fn write_one(out: &mut dyn Write, place: &Path, mesh: &OutputMesh) -> io::Result<()> {
    match ending(place).as_deref() {
        Some("node") => tetgen::write_node(out, &mesh.points, &mesh.point_markers),
        Some("ele") => tetgen::write_ele(out, &mesh.tetrahedra, &mesh.attributes),
        Some("face") => tetgen::write_marked(out, &mesh.faces),
        Some("edge") => tetgen::write_marked(out, &mesh.edges),
        Some("msh") => gmsh::write_msh(out, mesh),
        Some("mesh") => medit::write_mesh(out, mesh),
        _ => vtu::write_vtu(out, mesh),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_decide() {
        assert_eq!(OutputFile::parse("a.b.vtu").unwrap().files(), [Path::new("a.b.vtu")]);
        for name in ["x/m.node", "x/m.ele", "x/m.ELE"] {
            assert_eq!(OutputFile::parse(name).unwrap().files(), [Path::new("x/m.node"), Path::new("x/m.ele")]);
        }
        for wrong in ["m.vtk", "m", "", ".vtu"] {
            assert!(OutputFile::parse(wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn removed_vertices_leave_no_gap() {
        let points = [DVec3::X, DVec3::NAN, DVec3::Y, DVec3::Z, DVec3::NAN, DVec3::ZERO];
        let mesh = OutputMesh::numbered(&points, &numbers(&points), std::iter::once(([0, 2, 3, 5], 3)), 3);
        assert_eq!(*mesh.points, [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO]);
        assert_eq!(*mesh.tetrahedra, [[0, 1, 2, 3]]);
        assert_eq!(mesh.steiner, [false, false, true, true]);
        assert_eq!(*mesh.regions, [3]);
    }

    #[test]
    fn attributes_stand_for_regions_that_they_tell_apart() {
        let references = |attributes: &[f64]| {
            let region = |&attribute: &f64| PlcRegion { point: DVec3::ZERO, attribute, max_volume: None };
            region_references(&attributes.iter().map(region).collect::<Vec<_>>())
        };
        assert_eq!(references(&[40.0, 30.0]), [0, 40, 30]);
        assert_eq!(references(&[f64::from(i32::MAX)]), [0, i32::MAX as u32]);
        for wrong in [[30.0, 30.0], [1.5, 2.0], [0.0, 1.0], [-1.0, 1.0], [2147483648.0, 1.0], [f64::NAN, 1.0]] {
            assert_eq!(references(&wrong), [0; 0], "{wrong:?}");
        }
    }

    #[test]
    fn an_output_never_replaces_the_input() {
        let folder = std::env::temp_dir().join(format!("wellspaced-write-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let input = folder.join("m.node");
        std::fs::write(&input, "0 3\n").unwrap();
        let output = |name: &str| OutputFile::parse(folder.join(name).to_str().unwrap()).unwrap();
        let refused = output("m.ele").check(&[&input]);
        let allowed = output("m.vtu").check(&[&input]);
        let nowhere = output("none/m.vtu").check(&[]);
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(refused.unwrap_err().message().contains("would replace the input"));
        assert_eq!(allowed, Ok(()));
        assert!(nowhere.unwrap_err().message().contains("there is no folder"));
    }
}
