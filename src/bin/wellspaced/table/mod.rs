//! The command `table1`: every data set × bound × rule, ours beside the paper's table. Beside it `lowest-beta` ([`lowest`]).
//!
//! Rows run one after the other, so that their times can be compared.

pub mod lowest;
mod paper;
mod print;
mod row;

use std::io::{self, Write};
use std::path::Path;

use wellspaced::{RefineOptions, Sizing};

use crate::args::{Method, Table1};
use crate::dataset::Dataset;
use crate::failure::Failure;
use crate::mesh::refined;
use crate::progress::Bar;
use crate::read::{read, Content, Format, Input, InputFile, Source};
use crate::report::Seconds;
use row::Row;

/// `wellspaced table1`.
pub fn table1(arguments: &Table1) -> Result<(), Failure> {
    let lines = !arguments.json && !arguments.markdown;
    if lines {
        say(&print::text_header())?;
    }
    let mut rows = Vec::new();
    for dataset in chosen(&arguments.only) {
        let input = load(dataset, arguments)?;
        for radius_edge in paper::RADIUS_EDGES {
            for rule in Method::TABLE {
                rows.push(run(dataset, &input, radius_edge, rule)?);
                if let (true, Some(row)) = (lines, rows.last()) {
                    say(&print::text_row(row, &rows))?;
                }
            }
        }
    }
    match (arguments.json, arguments.markdown) {
        (true, _) => say(&format!("{}\n", print::json(&rows))),
        (_, true) => say(&print::markdown(&rows)),
        _ => say(&print::text_footer(&rows)),
    }
}

/// The data sets of `only`, in a fixed order, or all of the paper's.
fn chosen(only: &[Dataset]) -> impl Iterator<Item = Dataset> + '_ {
    let all = Dataset::ALL.into_iter().chain(Dataset::MORE);
    all.filter(|dataset| only.contains(dataset) || only.is_empty() && Dataset::ALL.contains(dataset))
}

/// The data set of the recipe, or of the file in the user's folder.
fn load(dataset: Dataset, arguments: &Table1) -> Result<Input, Failure> {
    let name = format!("{}.poly", dataset.name());
    match &arguments.data {
        Some(folder) => read(&InputFile { path: folder.join(name), format: Format::Poly }),
        None => Ok(Input {
            content: Content::Domain(dataset.build(arguments.seed)),
            source: Source::new(Path::new(&name)),
            cut: Vec::new(),
        }),
    }
}

fn run(dataset: Dataset, input: &Input, radius_edge: f64, rule: Method) -> Result<Row, Failure> {
    let options =
        RefineOptions { radius_edge, rule: rule.rule(), sparsify: Some(rule.sparsify()), ..RefineOptions::default() };
    let bar = Bar::new(&format!("{} beta {radius_edge} {}", dataset.title(), rule.name()));
    let mut seconds = Seconds::default();
    let result = refined(&input.content, 1, &options, &Sizing::default(), &bar.control(), &mut seconds);
    let (_, report) = result.map_err(|error| input.source.explain(&error))?;
    Ok(Row::new(dataset, radius_edge, rule, &report, &seconds))
}

fn say(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::stdout)
}
