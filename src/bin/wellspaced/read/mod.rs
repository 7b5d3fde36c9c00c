//! Input files by their ending: `.poly` and `.smesh` are domains, `.off`, `.stl`, `.ply` and `.obj` the surfaces of domains, `.node` and `.xyz` are points.

mod fields;
mod node;
mod obj;
mod off;
mod ply;
mod poly;
mod source;
mod stl;
mod surface;
mod warped;
mod xyz;

use std::path::{Path, PathBuf};

use glam::DVec3;
use wellspaced::{Plc, PlcDefect};

pub use source::Source;

use crate::failure::Failure;

/// The kinds of files that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Poly,
    Off,
    Stl,
    Ply,
    Obj,
    Node,
    Xyz,
}

impl Format {
    /// Whether files of this kind hold a surface of polygons.
    pub fn is_surface(self) -> bool {
        matches!(self, Format::Off | Format::Stl | Format::Ply | Format::Obj)
    }
}

/// A file to read, whose ending is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFile {
    pub path: PathBuf,
    pub format: Format,
}

impl InputFile {
    /// Takes a command-line argument.
    pub fn parse(argument: &str) -> Result<Self, String> {
        let path = PathBuf::from(argument);
        let format = match ending(&path).as_deref() {
            Some("poly" | "smesh") => Format::Poly,
            Some("off") => Format::Off,
            Some("stl") => Format::Stl,
            Some("ply") => Format::Ply,
            Some("obj") => Format::Obj,
            Some("node") => Format::Node,
            Some("xyz") => Format::Xyz,
            _ => return Err("unknown ending, expected .poly, .smesh, .off, .stl, .ply, .obj, .node or .xyz".to_owned()),
        };
        Ok(InputFile { path, format })
    }
}

/// The ending of a file's name in lower case.
pub fn ending(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase())
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    Domain(Plc),
    Points(Vec<DVec3>),
}

impl Content {
    pub fn points(&self) -> &[DVec3] {
        match self {
            Content::Domain(plc) => &plc.points,
            Content::Points(points) => points,
        }
    }
}

/// A file's content and where it stands in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    pub content: Content,
    pub source: Source,
    /// The polygons of a surface that were not planar. They can be meshed: each has been cut into triangles.
    pub cut: Vec<PlcDefect>,
}

/// Reads a file.
pub fn read(file: &InputFile) -> Result<Input, Failure> {
    parse(&file.path, file.format, &read_file(&file.path)?)
}

/// Reads the content of a file.
pub fn parse(path: &Path, format: Format, bytes: &[u8]) -> Result<Input, Failure> {
    let mut source = Source::new(path);
    let mut content = match format {
        Format::Poly => {
            let short = ending(path).as_deref() == Some("smesh");
            Content::Domain(poly::parse_poly(path, bytes, short, &mut source)?)
        }
        Format::Stl => Content::Domain(stl::parse_stl(path, bytes)?.into_domain(path)?),
        Format::Ply => Content::Domain(ply::parse_ply(path, bytes)?.into_domain(path)?),
        Format::Obj => Content::Domain(obj::parse_obj(path, bytes)?.into_domain(path)?),
        Format::Off => Content::Domain(off::parse_off(path, bytes, &mut source)?.into_domain(path)?),
        Format::Node => Content::Points(node::parse_node(path, bytes, &mut source)?.points),
        Format::Xyz => Content::Points(xyz::parse_xyz(path, bytes, &mut source)?),
    };
    if content.points().is_empty() {
        return Err(Failure::in_file(path, "holds no points"));
    }
    let mut cut = Vec::new();
    // What these files call a polygon need not be flat; a facet of a complex must be.
    if let (Content::Domain(plc), true) = (&mut content, format.is_surface()) {
        source.number_facets(plc.facets.len());
        let origins = plc.cut_warped();
        source.cut(&origins);
        cut = warped::warped(plc, &origins);
    }
    Ok(Input { content, source, cut })
}

fn read_file(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| Failure::in_file(path, error))
}

fn too_many(count: usize, what: &str) -> String {
    format!("{count} {what}, but 32-bit indices can't number so many")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_decide_and_case_does_not_matter() {
        assert_eq!(InputFile::parse("a/b.POLY").unwrap().format, Format::Poly);
        assert_eq!(InputFile::parse("b.node").unwrap().format, Format::Node);
        assert_eq!(InputFile::parse("c.d.Xyz").unwrap().format, Format::Xyz);
        for wrong in ["b.step", "b", "", "poly", ".poly"] {
            assert!(InputFile::parse(wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn a_file_without_points_is_no_input() {
        let ply = b"ply\nformat ascii 1.0\nelement dot 0\nproperty int x\nend_header\n";
        for (name, content) in [
            ("in.obj", &b"garbage\n"[..]),
            ("in.obj", b""),
            ("in.stl", &[0; 84]),
            ("in.stl", b"solid\nendsolid\n"),
            ("in.ply", ply),
            ("in.off", b"OFF\n0 0 0\n"),
            ("in.xyz", b"# nothing\n"),
            ("in.node", b"0 3\n"),
        ] {
            let file = InputFile::parse(name).unwrap();
            let failure = parse(&file.path, file.format, content).unwrap_err();
            assert_eq!(failure.message(), format!("{name}: holds no points"));
        }
    }
}
