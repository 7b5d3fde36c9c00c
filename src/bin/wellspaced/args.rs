//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use wellspaced::{Rule, Sparsify};

use crate::dataset::Dataset;
use crate::read::InputFile;
use crate::write::OutputFile;

/// Quality tetrahedral meshes with few elements: sparse Delaunay refinement of points and piecewise linear domains.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Refine points or a domain until every tetrahedron keeps the radius-edge bound
    Refine(Refine),
    /// Make the Delaunay triangulation of a file's points
    Delaunay(Delaunay),
    /// List every defect of a domain, and its smallest angles; the exit status is 1 if it can't be meshed, which is tried when there is no
    /// other error. Polygons of surfaces that are not planar are warnings: they are cut into triangles
    Check(Check),
    /// Refine every data set of the paper and print the paper's table beside ours
    Table1(Table1),
    /// Find the lowest bound for which each rule ends on each data set of the paper, to 0.01, and print it in Markdown
    LowestBeta(LowestBeta),
    /// Write a data set, one of the paper's or of ours, to standard output as a .poly file
    Dataset(DatasetArguments),
}

/// The files of a command that reads one and writes any number.
#[derive(Debug, Args)]
pub struct Files {
    /// A domain: .poly, .smesh; its surface: .off, .stl, .ply, .obj; or points: .node, .xyz
    #[arg(value_name = "FILE", value_parser = InputFile::parse)]
    pub input: InputFile,
    /// Join facets in one plane that share a side, if their normals differ by at most this angle in degrees, or `off`. Default: 0.01 for
    /// surfaces (.off, .stl, .ply, .obj), off for others. No facet becomes less planar than a facet must be
    #[arg(long, value_name = "ANGLE", value_parser = parse_angle)]
    pub join_coplanar: Option<f64>,
    /// Write the mesh: .vtu, .msh, .mesh, .node and .ele (both for either), or with them .face and .edge; may be given several times. A
    /// tetrahedron's number in .msh and .mesh is its region's attribute if all are different whole numbers above 0, else the region's
    /// position from 1
    #[arg(short, long = "output", value_name = "FILE", value_parser = OutputFile::parse)]
    pub outputs: Vec<OutputFile>,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Use so many threads to triangulate the points and for the pass over Steiner points, 0 for as many as there are processors; the
    /// result is the same in every byte
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=1024))]
    pub threads: u32,
}

/// An angle in degrees from 0 to 90; −1 for `off`.
fn parse_angle(argument: &str) -> Result<f64, String> {
    match argument.parse() {
        _ if argument == "off" => Ok(-1.0),
        Ok(angle) if (0.0..=90.0).contains(&angle) => Ok(angle),
        _ => Err("expected degrees from 0 to 90, or off".to_owned()),
    }
}

/// Arguments of `refine`.
#[derive(Debug, Args)]
pub struct Refine {
    #[command(flatten)]
    pub files: Files,
    /// The bound: no tetrahedron's circumradius is longer than B times its shortest edge
    #[arg(short = 'b', long, value_name = "B")]
    pub radius_edge: f64,
    /// How Steiner points are chosen
    #[arg(long, value_enum, default_value_t = RuleName::Sparse)]
    pub rule: RuleName,
    /// How hard to try to do with fewer Steiner points; `quick` where no level is given, and by default with --rule sparse
    #[arg(long, value_enum, value_name = "LEVEL", num_args = 0..=1, default_missing_value = "quick", require_equals = true)]
    pub sparsify: Option<SparsifyName>,
    /// No pass afterwards: with --rule sparse the same as --sparsify=moves, with the others as --sparsify=off
    #[arg(long, conflicts_with = "sparsify")]
    pub no_sparsify: bool,
    /// The largest length of a tetrahedron's edge, 0 for any; regions of a .poly file have their largest volumes besides
    #[arg(long, value_name = "LENGTH")]
    pub max_edge: Option<f64>,
    /// Put no more Steiner points on segments and facets than it takes to have these in the mesh at all (`on_segments` and `on_facets` count
    /// them); what can't be mended so is counted
    #[arg(long)]
    pub keep_boundary: bool,
    /// Stop at this many vertices, input included
    #[arg(long, value_name = "N")]
    pub max_vertices: Option<usize>,
    /// Stop refining after this many seconds; 0 stops at once
    #[arg(long, value_name = "S")]
    pub max_seconds: Option<f64>,
    /// Stop refining before the mesh takes more memory than this many MiB; 0 stops at once
    #[arg(long, value_name = "MIB")]
    pub max_memory: Option<usize>,
}

/// Arguments of `delaunay`.
#[derive(Debug, Args)]
pub struct Delaunay {
    #[command(flatten)]
    pub files: Files,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct Check {
    /// The file, as for `refine`
    #[arg(value_name = "FILE", value_parser = InputFile::parse)]
    pub input: InputFile,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `table1`.
#[derive(Debug, Args)]
pub struct Table1 {
    /// The seed of the random data sets
    #[arg(long, value_name = "N", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// Take NAME.poly from this folder instead of the recipes
    #[arg(long, value_name = "DIR", conflicts_with = "seed")]
    pub data: Option<PathBuf>,
    /// Only this data set; may be given several times
    #[arg(long = "only", value_name = "NAME", value_enum)]
    pub only: Vec<Dataset>,
    /// Print the table as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Print the table in Markdown, as in the README
    #[arg(long, conflicts_with = "json")]
    pub markdown: bool,
}

/// Arguments of `lowest-beta`.
#[derive(Debug, Args)]
pub struct LowestBeta {
    /// The seed of the random data sets
    #[arg(long, value_name = "N", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
    /// Only this data set; may be given several times
    #[arg(long = "only", value_name = "NAME", value_enum)]
    pub only: Vec<Dataset>,
    /// A refinement that needs more vertices does not end
    #[arg(long, value_name = "N", default_value_t = 300_000)]
    pub max_vertices: usize,
}

/// Arguments of `dataset`.
#[derive(Debug, Args)]
pub struct DatasetArguments {
    /// Which one
    #[arg(value_name = "NAME", value_enum)]
    pub dataset: Dataset,
    /// The seed of the random ones (all but cube1 and helix)
    #[arg(long, value_name = "N", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
}

/// The seed when none is given.
pub const DEFAULT_SEED: u64 = 1;

/// The sampling rules by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RuleName {
    /// Batches of off-centres, fewer and wider apart than the paper's
    Sparse,
    /// Batches of off-centres, as in the paper
    Paper,
    /// The circumcentre of the bad tetrahedron, the classical method
    Circumcenter,
}

impl RuleName {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            RuleName::Sparse => "sparse",
            RuleName::Paper => "paper",
            RuleName::Circumcenter => "circumcenter",
        }
    }
}

/// The levels of the pass that takes Steiner points away again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SparsifyName {
    /// The sampler alone
    Off,
    /// A sample may move a Steiner point near it instead; no pass afterwards
    Moves,
    /// What is found at little cost
    Quick,
    /// Three to five times the time, about an eighth fewer
    Thorough,
}

impl From<SparsifyName> for Sparsify {
    fn from(name: SparsifyName) -> Sparsify {
        match name {
            SparsifyName::Off => Sparsify::Off,
            SparsifyName::Moves => Sparsify::Moves,
            SparsifyName::Quick => Sparsify::Quick,
            SparsifyName::Thorough => Sparsify::Thorough,
        }
    }
}

impl Refine {
    /// The level asked for, if one was.
    pub fn level(&self) -> Option<Sparsify> {
        if self.no_sparsify {
            return Some(if self.rule == RuleName::Sparse { Sparsify::Moves } else { Sparsify::Off });
        }
        self.sparsify.map(Sparsify::from)
    }
}

/// What the table compares: rules, and the sparse one with its pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Method {
    Circumcenter,
    Paper,
    Sampler,
    Moves,
    Quick,
    Thorough,
}

impl Method {
    /// All of them, the one that the others are compared with first.
    pub const TABLE: [Method; 6] =
        [Method::Circumcenter, Method::Paper, Method::Sampler, Method::Moves, Method::Quick, Method::Thorough];

    /// As the options that choose it.
    pub fn name(self) -> &'static str {
        match self {
            Method::Circumcenter => "circumcenter",
            Method::Paper => "paper",
            Method::Sampler => "sparse, sampler",
            Method::Moves => "sparse, no pass",
            Method::Quick => "sparse",
            Method::Thorough => "sparse, thorough",
        }
    }

    pub fn rule(self) -> Rule {
        match self {
            Method::Circumcenter => Rule::Circumcenter,
            Method::Paper => Rule::Paper,
            Method::Sampler | Method::Moves | Method::Quick | Method::Thorough => Rule::Sparse,
        }
    }

    pub fn sparsify(self) -> Sparsify {
        match self {
            Method::Circumcenter | Method::Paper | Method::Sampler => Sparsify::Off,
            Method::Moves => Sparsify::Moves,
            Method::Quick => Sparsify::Quick,
            Method::Thorough => Sparsify::Thorough,
        }
    }
}

impl From<RuleName> for Rule {
    fn from(name: RuleName) -> Rule {
        match name {
            RuleName::Sparse => Rule::Sparse,
            RuleName::Paper => Rule::Paper,
            RuleName::Circumcenter => Rule::Circumcenter,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn names_are_the_command_lines() {
        for rule in RuleName::value_variants() {
            assert_eq!(rule.to_possible_value().unwrap().get_name(), rule.name());
        }
        for dataset in Dataset::value_variants() {
            assert_eq!(dataset.to_possible_value().unwrap().get_name(), dataset.name());
        }
    }
}
