//! Output files by their ending: `.vtu`, or TetGen's pair `.node` and `.ele`.

mod atomic;
mod number;
mod tetgen;
mod vtu;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;
use wellspaced::mesh::MeshView;

pub use tetgen::write_poly;

use crate::failure::Failure;
use crate::read::ending;
use atomic::AtomicFile;

/// The kinds of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Vtu,
    /// `.node` and `.ele`, whichever was named.
    Tetgen,
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
            Some("node" | "ele") => Format::Tetgen,
            _ => return Err("unknown ending, expected .vtu, .node or .ele".to_owned()),
        };
        Ok(OutputFile { path, format })
    }

    /// The files that writing makes.
    fn files(&self) -> Vec<PathBuf> {
        match self.format {
            Format::Vtu => vec![self.path.clone()],
            Format::Tetgen => vec![self.path.with_extension("node"), self.path.with_extension("ele")],
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
pub struct OutputMesh {
    pub points: Vec<DVec3>,
    pub tetrahedra: Vec<[u32; 4]>,
    /// For each point whether it was added.
    pub steiner: Vec<bool>,
    /// For each tetrahedron 0, or 1 + the position of its region in the domain's list.
    pub regions: Vec<u32>,
}

impl OutputMesh {
    /// Closes the gaps that removed vertices leave; the first `input_vertices` ids are the input's.
    pub fn new(view: MeshView, input_vertices: usize) -> Self {
        let mut mesh = OutputMesh::default();
        let mut numbers = Vec::with_capacity(view.points.len());
        for (id, point) in view.points.iter().enumerate() {
            numbers.push(mesh.points.len() as u32);
            if point.is_finite() {
                mesh.points.push(*point);
                mesh.steiner.push(id >= input_vertices);
            }
        }
        mesh.tetrahedra = view.tetrahedra.iter().map(|t| t.map(|corner| numbers[corner as usize])).collect();
        mesh.regions = view.regions.to_vec();
        mesh
    }
}

/// Writes a mesh to all `outputs`. Each file appears whole or not at all, and none appears if one can't be written.
pub fn write(outputs: &[OutputFile], mesh: &OutputMesh) -> Result<(), Failure> {
    let mut places: Vec<PathBuf> = outputs.iter().flat_map(OutputFile::files).collect();
    places.sort();
    places.dedup();
    let mut files = Vec::new();
    for place in &places {
        let mut file = AtomicFile::create(place)?;
        file.fill(|out: &mut dyn Write| write_one(out, place, mesh))?;
        files.push(file);
    }
    files.into_iter().try_for_each(AtomicFile::commit)
}

fn write_one(out: &mut dyn Write, place: &Path, mesh: &OutputMesh) -> io::Result<()> {
    match ending(place).as_deref() {
        Some("node") => tetgen::write_node(out, &mesh.points),
        Some("ele") => tetgen::write_ele(out, &mesh.tetrahedra),
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
        let view =
            MeshView { points: &points, tetrahedra: &[[0, 2, 3, 5]], neighbours: &[[u32::MAX; 4]], regions: &[3] };
        let mesh = OutputMesh::new(view, 3);
        assert_eq!(mesh.points, [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO]);
        assert_eq!(mesh.tetrahedra, [[0, 1, 2, 3]]);
        assert_eq!(mesh.steiner, [false, false, true, true]);
        assert_eq!(mesh.regions, [3]);
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
