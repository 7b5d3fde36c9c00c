//! The command `lowest-beta`: the least bound for which each method ends, by data set.
//!
//! A refinement ends when it leaves no tetrahedron bad within a number of vertices. The bound is bisected in steps of 0.01, on the
//! assumption that what ends for one bound ends for all above it; the table says what was tried and nothing more.

use wellspaced::{RefineOptions, RefineStatus, Sizing};

use super::{chosen, say};
use crate::args::{LowestBeta, Method};
use crate::dataset::Dataset;
use crate::failure::Failure;
use crate::mesh::refined;
use crate::progress::Bar;
use crate::read::{Content, Source};
use crate::report::Seconds;

/// What is compared: all but the thorough pass, which takes too long.
const METHODS: [Method; 5] = [Method::Circumcenter, Method::Paper, Method::Sampler, Method::Moves, Method::Quick];
/// Bounds are multiples of one over this.
const STEPS: f64 = 100.0;
/// Tried from here, in steps of a hundredth.
const LOWEST: usize = 90;
/// No method is expected to need more.
const HIGHEST: usize = 150;

/// `wellspaced lowest-beta`.
pub fn lowest_beta(arguments: &LowestBeta) -> Result<(), Failure> {
    let methods = METHODS;
    let names: Vec<String> = methods.iter().map(|method| format!(" `{}` |", method.name())).collect();
    say(&format!("| data set |{}\n|---|{}\n", names.concat(), "--:|".repeat(methods.len())))?;
    for dataset in chosen(&arguments.only) {
        let content = Content::Domain(dataset.build(arguments.seed));
        say(&format!("| {} |", dataset.title()))?;
        for method in methods {
            let found = lowest(|bound| ends(dataset, &content, bound, method, arguments.max_vertices))?;
            say(&found.map_or(" none |".to_owned(), |bound| format!(" {bound:.2} |")))?;
        }
        say("\n")?;
    }
    Ok(())
}

/// The least bound for which `ends` says yes, if it does so for any.
fn lowest(mut ends: impl FnMut(f64) -> Result<bool, Failure>) -> Result<Option<f64>, Failure> {
    let (mut low, mut high) = (LOWEST, HIGHEST + 1);
    while low < high {
        let middle = (low + high) / 2;
        if middle <= HIGHEST && ends(middle as f64 / STEPS)? {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Ok((low <= HIGHEST).then_some(low as f64 / STEPS))
}

fn ends(
    dataset: Dataset,
    content: &Content,
    radius_edge: f64,
    method: Method,
    max_vertices: usize,
) -> Result<bool, Failure> {
    let options = RefineOptions {
        radius_edge,
        rule: method.rule(),
        sparsify: Some(method.sparsify()),
        max_vertices,
        ..RefineOptions::default()
    };
    let bar = Bar::new(&format!("{} beta {radius_edge} {}", dataset.title(), method.name()));
    let result = refined(content, 1, &options, &Sizing::default(), &bar.control(), &mut Seconds::default());
    let source = Source::new(std::path::Path::new(dataset.name()));
    let (_, report) = result.map_err(|error| source.explain(&error))?;
    Ok(report.status == RefineStatus::Done && report.bad == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bisection_finds_the_least() {
        for least in [0.9, 0.91, 1.04, 1.37, 1.49, 1.5] {
            let found = lowest(|bound| Ok(bound >= least)).unwrap_or_default();
            assert_eq!(found, Some(least));
        }
        assert_eq!(lowest(|_| Ok(false)).unwrap_or_default(), None);
        assert_eq!(lowest(|_| Ok(true)).unwrap_or_default(), Some(LOWEST as f64 / STEPS));
    }
}
