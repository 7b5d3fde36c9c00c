//! The table as text for a terminal, as Markdown for the README, and as JSON.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::{json, Value};

use super::paper::RADIUS_EDGES;
use super::row::{mean_ratio, ratio, Ratio, Row};
use crate::args::Method;

/// A number with commas between its thousands.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// The lines above the text table.
pub fn text_header() -> String {
    let titles = format!(
        "{:<10} {:>6}  {:>4}  {:<16} {:>17} {:>19} {:>17} {:>5} {:>13} {:>8}\n",
        "data set",
        "input",
        "beta",
        "rule",
        "vertices (paper)",
        "tetrahedra (paper)",
        "Steiner (paper)",
        "bad",
        "ratio (paper)",
        "seconds"
    );
    format!("{titles}{}\n", "-".repeat(titles.trim_end().chars().count()))
}

/// One line of the text table; `rows` are those done so far.
pub fn text_row(row: &Row, rows: &[Row]) -> String {
    let printed = row.printed();
    let beside =
        |ours: usize, paper: Option<String>| format!("{} ({})", grouped(ours), paper.unwrap_or("-".to_owned()));
    let misprint = |sic: bool| if sic { "?" } else { "" };
    let tetrahedra = printed.map(|p| format!("{}{}", grouped(p.tetrahedra), misprint(p.misprint)));
    let mut line = format!(
        "{:<10} {:>6}  {:>4}  {:<16} {:>17} {:>19} {:>17} {:>5} {:>13} {:>8.3}",
        row.dataset.title(),
        grouped(row.input_vertices),
        row.radius_edge,
        row.rule.name(),
        beside(row.vertices, printed.map(|p| grouped(p.vertices))),
        beside(row.tetrahedra, tetrahedra),
        beside(row.steiner, printed.map(|p| grouped(p.steiner))),
        row.bad,
        ratio(row, rows).map(text_ratio).unwrap_or_default(),
        row.seconds,
    );
    if row.status != "done" {
        let _ = write!(line, "  {}", row.status);
    }
    line + "\n"
}

fn text_ratio(Ratio { ours, printed }: Ratio) -> String {
    match printed {
        Some(printed) => format!("{ours:.3} ({printed:.3})"),
        None => format!("{ours:.3}"),
    }
}

/// The lines below the text table.
pub fn text_footer(rows: &[Row]) -> String {
    let mut text =
        String::from("\nGeometric mean of Steiner points over circumcenter's, (the paper's printed numbers):\n");
    for rule in Method::TABLE {
        let Some(all) = mean_ratio(rule, None, rows) else { continue };
        let _ = write!(text, "{:<16} {}", rule.name(), text_ratio(all));
        for bound in RADIUS_EDGES {
            if let Some(mean) = mean_ratio(rule, Some(bound), rows) {
                let _ = write!(text, "   beta {bound}: {}", text_ratio(mean));
            }
        }
        text.push('\n');
    }
    text
}

/// Whether the paper has this rule.
fn is_printed(rule: Method) -> bool {
    match rule {
        Method::Circumcenter | Method::Paper => true,
        Method::Sampler | Method::Moves | Method::Quick | Method::Thorough => false,
    }
}

/// The table in Markdown: one line a data set and bound, ours beside the paper's.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::from("| data set (input vertices) | β |");
    for rule in Method::TABLE {
        let printed = if is_printed(rule) { " printed |" } else { "" };
        let _ = write!(text, " `{}` vertices |{printed} tetrahedra |{printed}", rule.name());
    }
    text.push_str(" bad |\n|---|---|");
    for rule in Method::TABLE {
        text.push_str(&"--:|".repeat(if is_printed(rule) { 4 } else { 2 }));
    }
    text.push_str("--:|\n");
    let mut last = None;
    for line in rows.chunk_by(|a, b| (a.dataset, a.radius_edge) == (b.dataset, b.radius_edge)) {
        let Some(first) = line.first() else { continue };
        let title = match last.replace(first.dataset) == Some(first.dataset) {
            true => String::new(),
            false => format!("{} ({})", first.dataset.title(), grouped(first.input_vertices)),
        };
        let _ = write!(text, "| {title} | {} |", first.radius_edge);
        for row in line {
            let (vertices, tetrahedra) = match row.printed() {
                Some(p) if p.misprint => (grouped(p.vertices), format!("{} (sic)", grouped(p.tetrahedra))),
                Some(p) => (grouped(p.vertices), grouped(p.tetrahedra)),
                None => Default::default(),
            };
            let ours = [grouped(row.vertices), grouped(row.tetrahedra)];
            let _ = match is_printed(row.rule) {
                true => write!(text, " {} | {vertices} | {} | {tetrahedra} |", ours[0], ours[1]),
                false => write!(text, " {} | {} |", ours[0], ours[1]),
            };
        }
        let _ = writeln!(text, " {} |", line.iter().map(|row| row.bad).sum::<usize>());
    }
    text.push_str("\nSteiner points as a share of `circumcenter`'s, geometric mean over the data sets:\n\n| rule |");
    for bound in RADIUS_EDGES {
        let _ = write!(text, " β = {bound} |");
    }
    text.push_str(" all |\n|---|");
    text.push_str(&"--:|".repeat(RADIUS_EDGES.len() + 1));
    text.push('\n');
    let bounds = || RADIUS_EDGES.into_iter().map(Some).chain([None]);
    for rule in Method::TABLE {
        let means: Vec<Option<Ratio>> = bounds().map(|bound| mean_ratio(rule, bound, rows)).collect();
        if means.iter().all(Option::is_none) {
            continue;
        }
        let mut means_line = |name: &str, pick: &dyn Fn(Ratio) -> Option<f64>| {
            let _ = write!(text, "| {name} |");
            for mean in &means {
                match mean.and_then(pick) {
                    Some(mean) => drop(write!(text, " {mean:.3} |")),
                    None => text.push_str(" |"),
                }
            }
            text.push('\n');
        };
        means_line(&format!("`{}`", rule.name()), &|ratio| Some(ratio.ours));
        if is_printed(rule) {
            means_line(&format!("`{}`, as the paper printed it", rule.name()), &|ratio| ratio.printed);
        }
    }
    text
}

/// The table as one JSON object.
pub fn json(rows: &[Row]) -> Value {
    let lines: Vec<Value> = rows
        .iter()
        .map(|row| {
            let printed = row.printed().map(|p| {
                json!({
                    "vertices": p.vertices, "tetrahedra": p.tetrahedra, "steiner": p.steiner, "misprint": p.misprint,
                })
            });
            json!({
                "data_set": row.dataset.name(),
                "radius_edge": row.radius_edge,
                "rule": row.rule.name(),
                "input_vertices": row.input_vertices,
                "vertices": row.vertices,
                "tetrahedra": row.tetrahedra,
                "steiner": row.steiner,
                "bad": row.bad,
                "status": row.status,
                "seconds": row.seconds,
                "paper": printed,
                "steiner_ratio": ratio(row, rows),
            })
        })
        .collect();
    let mut means = BTreeMap::new();
    for rule in Method::TABLE {
        let mut by_bound = BTreeMap::new();
        for bound in RADIUS_EDGES {
            if let Some(mean) = mean_ratio(rule, Some(bound), rows) {
                by_bound.insert(bound.to_string(), mean);
            }
        }
        if let Some(mean) = mean_ratio(rule, None, rows) {
            by_bound.insert("all".to_owned(), mean);
            means.insert(rule.name(), by_bound);
        }
    }
    json!({ "rows": lines, "mean_steiner_ratio": means })
}

#[cfg(test)]
mod tests {
    use super::super::row::tests::row;
    use super::*;
    use crate::dataset::Dataset;

    fn rows() -> Vec<Row> {
        vec![
            row(Dataset::Helix, 8.0, Method::Circumcenter, 1_234_567),
            row(Dataset::Helix, 8.0, Method::Paper, 500),
            row(Dataset::Helix, 8.0, Method::Sampler, 450),
            row(Dataset::Helix, 8.0, Method::Moves, 400),
            row(Dataset::Helix, 8.0, Method::Quick, 300),
            row(Dataset::Helix, 8.0, Method::Thorough, 200),
            row(Dataset::Random, 1.5, Method::Circumcenter, 20),
            row(Dataset::Random, 1.5, Method::Paper, 10),
            row(Dataset::Random, 1.5, Method::Sampler, 6),
            row(Dataset::Random, 1.5, Method::Moves, 5),
            row(Dataset::Random, 1.5, Method::Quick, 4),
            row(Dataset::Random, 1.5, Method::Thorough, 3),
        ]
    }

    #[test]
    fn thousands_are_grouped() {
        let numbers = [0, 12, 999, 1_000, 12_345, 999_999, 1_000_000];
        assert_eq!(numbers.map(grouped), ["0", "12", "999", "1,000", "12,345", "999,999", "1,000,000"]);
    }

    #[test]
    fn text_has_the_papers_numbers_beside_ours() {
        let rows = rows();
        let line = text_row(&rows[1], &rows);
        assert!(
            line.contains("510 (3,923)") && line.contains("2,500 (37,738?)") && line.contains("500 (2,915)"),
            "{line}"
        );
        let header = text_header();
        assert_eq!(line.trim_end().len(), header.lines().nth(1).unwrap().len());
        let stopped = Row { status: "vertex_limit", ..rows[6].clone() };
        assert!(text_row(&stopped, &rows).ends_with(" vertex_limit\n"));
        assert!(text_footer(&rows).contains("paper            0.014 "), "{}", text_footer(&rows));
    }

    #[test]
    fn markdown_has_one_line_a_data_set_and_bound() {
        let text = markdown(&rows());
        assert!(
            text.contains(
                "| Helix (10) | 8 | 1,234,577 | 8,727 | 6,172,835 | 49,998 | 510 | 3,923 | 2,500 | 37,738 (sic) | 460 | 2,250 | 410 | 2,000 | 310 | 1,500 | 210 | 1,000 | 0 |"
            ),
            "{text}"
        );
        let columns = |line: &str| line.matches('|').count();
        let table: Vec<&str> = text.lines().take_while(|line| line.starts_with('|')).collect();
        assert_eq!(table.len(), 4);
        assert!(table.iter().all(|line| columns(line) == columns(table[0])), "{text}");
        assert!(text.contains("| `paper` | 0.500 | | | 0.000 | 0.014 |"), "{text}");
    }

    #[test]
    fn json_has_rows_and_means() {
        let value = json(&rows());
        assert_eq!(value["rows"][1]["paper"]["misprint"], true);
        assert_eq!(value["rows"][7]["steiner_ratio"]["ours"], 0.5);
        assert_eq!(value["rows"][6]["steiner_ratio"], Value::Null);
        assert_eq!(value["mean_steiner_ratio"]["paper"]["1.5"]["ours"], 0.5);
    }
}
