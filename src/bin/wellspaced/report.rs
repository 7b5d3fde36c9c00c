//! What a command says when it is done: one JSON object, or a few lines for people.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Instant;

use serde::Serialize;
use wellspaced::RefineStatus;

/// The result of `refine` or `delaunay`. Of the latter `bad`, `rule` and `radius_edge` are null.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    pub input_vertices: usize,
    pub vertices: usize,
    pub tetrahedra: usize,
    pub steiner: usize,
    pub bad: Option<usize>,
    /// How many of the bad tetrahedra were left for each reason.
    pub unrefined: Option<BTreeMap<&'static str, usize>>,
    /// How many are larger than was asked for.
    pub too_large: Option<usize>,
    /// Steiner points on segments, those of the domain's recovery too, and on facets but on no segment.
    pub on_segments: Option<usize>,
    pub on_facets: Option<usize>,
    /// Null when a flat tetrahedron makes it infinite.
    pub worst_radius_edge: f64,
    pub min_dihedral_degrees: f64,
    pub rule: Option<&'static str>,
    pub radius_edge: Option<f64>,
    pub status: &'static str,
    pub seconds: Seconds,
}

/// Where the time went.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    pub read: f64,
    pub delaunay: f64,
    pub refine: f64,
    pub write: f64,
}

/// Runs `work`, adding its wall-clock time to `seconds`.
pub fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds += start.elapsed().as_secs_f64();
    result
}

/// A status's name in JSON.
pub fn status_name(status: RefineStatus) -> &'static str {
    match status {
        RefineStatus::Done => "done",
        RefineStatus::Cancelled => "cancelled",
        RefineStatus::VertexLimit => "vertex_limit",
        RefineStatus::TimeLimit => "time_limit",
        RefineStatus::MemoryLimit => "memory_limit",
        RefineStatus::Unrefined => "unrefined",
        _ => "unknown",
    }
}

impl Report {
    /// The JSON object in one line.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// The same for people.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<20} {value}");
        };
        line("vertices", format!("{} ({} input, {} Steiner)", self.vertices, self.input_vertices, self.steiner));
        if let (Some(segments @ 1..), Some(facets)) | (Some(segments), Some(facets @ 1..)) =
            (self.on_segments, self.on_facets)
        {
            line("", format!("{segments} on segments, {facets} on facets"));
        }
        line("tetrahedra", self.tetrahedra.to_string());
        if let (Some(bad), Some(bound), Some(rule)) = (self.bad, self.radius_edge, self.rule) {
            line("bad", format!("{bad} above radius-edge {bound}, rule {rule}"));
            for (reason, count) in self.unrefined.iter().flatten() {
                line("", format!("{count} {reason}"));
            }
        }
        line("worst radius-edge", format!("{:.4}", self.worst_radius_edge));
        line("smallest dihedral", format!("{:.3}°", self.min_dihedral_degrees));
        line("status", self.status.to_owned());
        let Seconds { read, delaunay, refine, write } = self.seconds;
        line("seconds", format!("read {read:.3}, delaunay {delaunay:.3}, refine {refine:.3}, write {write:.3}"));
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_and_their_order_are_fixed() {
        let report = Report {
            input_vertices: 10,
            vertices: 30,
            tetrahedra: 99,
            steiner: 20,
            bad: Some(0),
            unrefined: Some(BTreeMap::from([("boundary", 2)])),
            too_large: Some(0),
            on_segments: Some(3),
            on_facets: Some(4),
            worst_radius_edge: 1.5,
            min_dihedral_degrees: 0.25,
            rule: Some("paper"),
            radius_edge: Some(2.0),
            status: "done",
            seconds: Seconds::default(),
        };
        let json = r#"{"input_vertices":10,"vertices":30,"tetrahedra":99,"steiner":20,"bad":0,"unrefined":{"boundary":2},"too_large":0,"on_segments":3,"on_facets":4,"worst_radius_edge":1.5,"min_dihedral_degrees":0.25,"rule":"paper","radius_edge":2.0,"status":"done","seconds":{"read":0.0,"delaunay":0.0,"refine":0.0,"write":0.0}}"#;
        assert_eq!(report.json(), json);
        let delaunay = Report {
            bad: None,
            unrefined: None,
            too_large: None,
            on_segments: None,
            on_facets: None,
            rule: None,
            radius_edge: None,
            worst_radius_edge: f64::INFINITY,
            ..report
        };
        assert!(delaunay.json().contains(r#""bad":null,"unrefined":null,"too_large":null,"on_segments":null,"on_facets":null,"worst_radius_edge":null,"#));
        assert!(!delaunay.text().contains("bad"));
    }
}
