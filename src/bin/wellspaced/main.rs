//! The command `wellspaced`: files in, meshes out, over the library's plain Rust API.
//!
//! | module | idea |
//! |---|---|
//! | [`args`] | the command line |
//! | [`read`] | input files, and naming what is wrong in them |
//! | [`write`] | output files, whole or not at all |
//! | [`mesh`] | `refine` and `delaunay` |
//! | [`check`] | `check`: every defect of a domain |
//! | [`table`] | `table1`: the paper's table beside ours, and `lowest-beta` |
//! | [`dataset`] | `dataset`: the paper's data sets as recipes |
//! | [`report`], [`progress`], [`failure`] | what is said on standard output and standard error |

mod args;
mod check;
mod dataset;
mod failure;
mod mesh;
mod progress;
mod read;
mod report;
mod table;
mod write;

use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command, DatasetArguments};
use failure::Failure;

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Refine(arguments) => mesh::refine(&arguments),
        Command::Delaunay(arguments) => mesh::delaunay(&arguments),
        Command::Check(arguments) => check::check(&arguments),
        Command::Table1(arguments) => table::table1(&arguments),
        Command::LowestBeta(arguments) => table::lowest::lowest_beta(&arguments),
        Command::Dataset(arguments) => dataset(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// `wellspaced dataset`.
fn dataset(arguments: &DatasetArguments) -> Result<(), Failure> {
    let mut out = BufWriter::new(io::stdout().lock());
    write::write_poly(&mut out, &arguments.dataset.build(arguments.seed)).map_err(Failure::stdout)?;
    out.flush().map_err(Failure::stdout)
}
