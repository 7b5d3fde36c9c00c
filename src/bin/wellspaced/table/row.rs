//! One line of the table: a data set refined to a bound by a rule, beside what the paper printed.

use serde::Serialize;
use wellspaced::RefineReport;

use super::paper::{printed, Printed};
use crate::args::Method;
use crate::dataset::Dataset;
use crate::report::{status_name, Seconds};

/// A result.
#[derive(Clone, Debug)]
pub struct Row {
    pub dataset: Dataset,
    pub radius_edge: f64,
    pub rule: Method,
    pub input_vertices: usize,
    pub vertices: usize,
    pub tetrahedra: usize,
    pub steiner: usize,
    pub bad: usize,
    pub status: &'static str,
    /// Triangulation and refinement.
    pub seconds: f64,
}

impl Row {
    pub fn new(dataset: Dataset, radius_edge: f64, rule: Method, report: &RefineReport, seconds: &Seconds) -> Self {
        Row {
            dataset,
            radius_edge,
            rule,
            input_vertices: report.input_vertices,
            vertices: report.vertices,
            tetrahedra: report.tetrahedra,
            steiner: report.steiner,
            bad: report.bad,
            status: status_name(report.status),
            seconds: seconds.delaunay + seconds.refine,
        }
    }

    /// What the paper has in this place.
    pub fn printed(&self) -> Option<Printed> {
        printed(self.dataset, self.radius_edge, self.rule)
    }
}

/// Steiner points as a share of what circumcentres need for the same data set and bound: ours and the paper's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    pub ours: f64,
    /// The paper's printed table.
    pub printed: Option<f64>,
}

/// The ratio of one row, if `rows` has the circumcentre's and this is not itself it.
pub fn ratio(row: &Row, rows: &[Row]) -> Option<Ratio> {
    let same = |other: &&Row| {
        other.dataset == row.dataset
            && other.radius_edge == row.radius_edge
            && other.rule == Method::Circumcenter
            && row.rule != Method::Circumcenter
    };
    let base = rows.iter().find(same)?;
    let divide = |steiner: usize, base: usize| steiner as f64 / base as f64;
    let printed = row.printed().zip(base.printed()).map(|(row, base)| divide(row.steiner, base.steiner));
    Some(Ratio { ours: divide(row.steiner, base.steiner), printed })
}

/// The geometric means of a rule's ratios, over one bound or over all.
pub fn mean_ratio(rule: Method, radius_edge: Option<f64>, rows: &[Row]) -> Option<Ratio> {
    let wanted = |row: &&Row| row.rule == rule && radius_edge.is_none_or(|bound| bound == row.radius_edge);
    let ratios: Vec<Ratio> = rows.iter().filter(wanted).filter_map(|row| ratio(row, rows)).collect();
    if ratios.is_empty() {
        return None;
    }
    let printed: Option<Vec<f64>> = ratios.iter().map(|ratio| ratio.printed).collect();
    let ours: Vec<f64> = ratios.iter().map(|ratio| ratio.ours).collect();
    Some(Ratio { ours: geometric_mean(&ours), printed: printed.map(|printed| geometric_mean(&printed)) })
}

fn geometric_mean(numbers: &[f64]) -> f64 {
    (numbers.iter().map(|number| number.ln()).sum::<f64>() / numbers.len() as f64).exp()
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A row of made-up numbers.
    pub fn row(dataset: Dataset, radius_edge: f64, rule: Method, steiner: usize) -> Row {
        Row {
            dataset,
            radius_edge,
            rule,
            input_vertices: 10,
            vertices: 10 + steiner,
            tetrahedra: 5 * steiner,
            steiner,
            bad: 0,
            status: "done",
            seconds: 0.25,
        }
    }

    #[test]
    fn ratios_compare_within_a_data_set_and_bound() {
        let rows = [
            row(Dataset::Cube1, 2.0, Method::Circumcenter, 200),
            row(Dataset::Cube1, 2.0, Method::Paper, 100),
            row(Dataset::Cube1, 4.0, Method::Circumcenter, 80),
            row(Dataset::Cube1, 4.0, Method::Paper, 10),
            row(Dataset::Helix, 2.0, Method::Paper, 10),
        ];
        assert_eq!(ratio(&rows[0], &rows), None);
        assert_eq!(ratio(&rows[4], &rows), None);
        let printed = (220.0 - 12.0) / (265.0 - 12.0);
        assert_eq!(ratio(&rows[1], &rows), Some(Ratio { ours: 0.5, printed: Some(printed) }));
        let all = mean_ratio(Method::Paper, None, &rows).unwrap();
        assert!((all.ours - 0.25).abs() < 1e-15, "{all:?}");
        let at_four = mean_ratio(Method::Paper, Some(4.0), &rows).unwrap();
        assert!((at_four.ours - 0.125).abs() < 1e-15, "{at_four:?}");
        assert_eq!(mean_ratio(Method::Circumcenter, None, &rows), None);
    }
}
