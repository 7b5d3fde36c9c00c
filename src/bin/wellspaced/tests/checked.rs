//! `wellspaced check`: its text, its JSON object and its exit status.

use std::fs;

use serde_json::{json, Value};

use super::{failure, folder, json, stdout, wellspaced};

/// A cube; the last point is not in any facet.
const CUBE: &str = "\
9 3
1 0 0 0
2 4 0 0
3 0 4 0
4 4 4 0
5 0 0 4
6 4 0 4
7 0 4 4
8 4 4 4
9 2 2 2
6 0
1
4 1 2 4 3
1
4 5 6 8 7
1
4 1 2 6 5
1
4 3 4 8 7
1
4 1 3 7 5
1
4 2 4 8 6
0
0
";

/// A box with a roof that is not flat: its corner 6 is raised. The sides there are flat nevertheless.
const BENT: &str = "OFF
8 6 0
0 0 0
4 0 0
4 4 0
0 4 0
0 0 4
4 0 4
4 4 4.5
0 4 4
4 0 3 2 1
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
";

#[test]
fn a_sound_domain_has_no_defects_and_status_0() {
    let folder = folder("a_sound_domain_has_no_defects_and_status_0");
    fs::write(folder.join("cube.poly"), CUBE).unwrap();
    assert_eq!(
        stdout(&folder, &["check", "cube.poly"]),
        "0 errors, 0 warnings\n\
         smallest angle between segments: 90.000000 degrees, facet 1 and facet 1 at (0, 0, 0)\n\
         smallest angle between facets: 90.000000 degrees, facet 1 and facet 3 at (2, 0, 0)\n"
    );
    let found = json(&folder, &["check", "cube.poly"]);
    assert_eq!((&found["errors"], &found["warnings"], &found["defects"]), (&json!(0), &json!(0), &json!([])));
    let angle = &found["facet_angle"];
    assert!((angle["degrees"].as_f64().unwrap() - 90.0).abs() < 1e-9, "{angle}");
    assert_eq!(
        angle["elements"],
        json!([{"kind": "facet", "number": 1, "line": 12}, {"kind": "facet", "number": 3, "line": 16}])
    );
    // Points alone are a domain of points.
    fs::write(folder.join("in.xyz"), "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    assert_eq!(stdout(&folder, &["check", "in.xyz"]), "0 errors, 0 warnings\n");
}

#[test]
fn every_defect_is_told_and_an_error_is_status_1() {
    let folder = folder("every_defect_is_told_and_an_error_is_status_1");
    // A corner of facet 3 is another one, and point 9 comes twice.
    let text =
        CUBE.replace("9 3\n", "10 3\n").replace("9 2 2 2\n", "9 2 2 2\n10 2 2 2\n").replace("4 1 2 6 5", "4 1 2 8 5");
    fs::write(folder.join("cube.poly"), text).unwrap();
    let output = wellspaced(&folder, &["check", "cube.poly"]);
    assert_eq!((output.status.code(), output.stderr), (Some(1), vec![]));
    let told = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = told.lines().collect();
    assert_eq!(
        lines[..3],
        [
            "error: cube.poly:17: facet 3: is not planar: its corner (4, 0, 0) lies 2.82842712474619e0 off the plane of the others",
            "warning: cube.poly:11: point 10: is at the same place as point 9, (2, 2, 2)",
            "warning: cube.poly:13: facet 1: has an edge where no other facet is, at (2, 0, 0)",
        ]
    );
    assert_eq!(lines[6], "1 errors, 5 warnings");
    let output = wellspaced(&folder, &["check", "cube.poly", "--json"]);
    assert_eq!((output.status.code(), output.stderr), (Some(1), vec![]));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&found["errors"], &found["warnings"]), (&json!(1), &json!(5)));
    let defects = found["defects"].as_array().unwrap();
    let kinds: Vec<_> = defects.iter().map(|defect| defect["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["not_planar", "duplicate_point", "open_edge", "open_edge", "open_edge", "open_edge"]);
    let mut first = defects[0].clone();
    let measure = first["measure"].take().as_f64().unwrap();
    assert!((measure - 8f64.sqrt()).abs() < 1e-12, "{measure}");
    let expected = json!({
        "kind": "not_planar",
        "severity": "error",
        "elements": [{"kind": "facet", "number": 3, "line": 17}],
        "place": [4.0, 0.0, 0.0],
        "measure": null,
        "text": lines[0].strip_prefix("error: ").unwrap(),
    });
    assert_eq!(first, expected);
    let points = json!([{"kind": "point", "number": 10, "line": 11}, {"kind": "point", "number": 9, "line": 10}]);
    assert_eq!((&defects[1]["severity"], &defects[1]["elements"]), (&json!("warning"), &points));
}

#[test]
fn polygons_that_are_cut_are_warnings() {
    let folder = folder("polygons_that_are_cut_are_warnings");
    fs::write(folder.join("bent.off"), BENT).unwrap();
    let text = stdout(&folder, &["check", "bent.off"]);
    let lines: Vec<&str> = text.lines().collect();
    let told = "bent.off:12: facet 1: is not planar: its corner (4, 0, 4) lies 4.9613893835683387e-1 off the plane of the others; \
                it is cut into triangles";
    assert_eq!(lines[..2], [&format!("warning: {told}"), "0 errors, 1 warnings"]);
    let found = json(&folder, &["check", "bent.off"]);
    assert_eq!((&found["errors"], &found["warnings"]), (&json!(0), &json!(1)));
    let mut defects = found["defects"].clone();
    let measure = defects[0]["measure"].take().as_f64().unwrap();
    // The plane through corners 4, 6 and 7 has the normal (-1/8, 0, 1).
    assert!((measure - 0.5 / (1.0 + 1.0 / 64.0f64).sqrt()).abs() < 1e-12, "{measure}");
    let expected = json!([{
        "kind": "not_planar",
        "severity": "warning",
        "elements": [{"kind": "facet", "number": 1, "line": 12}],
        "place": [4.0, 0.0, 4.0],
        "measure": null,
        "text": told,
    }]);
    assert_eq!(defects, expected);
    // It can be meshed as it says.
    assert_eq!(json(&folder, &["refine", "bent.off", "-b", "2"])["bad"], 0);
    // With an error beside it, that comes first, and decides on the status.
    fs::write(folder.join("flat.off"), BENT.replace("4 0 3 2 1", "3 0 1 1")).unwrap();
    let output = wellspaced(&folder, &["check", "flat.off"]);
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("error: flat.off:11: facet 0: has no area"), "{text}");
    assert!(lines[1].starts_with("warning: flat.off:12: facet 1: is not planar"), "{text}");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn polygons_of_files_without_lines_keep_their_numbers() {
    let folder = folder("polygons_of_files_without_lines_keep_their_numbers");
    // The roof is the last but one here, behind a side that is cut, too.
    let header = "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n\
                  element face 6\nproperty list uchar int vertex_indices\nend_header\n";
    let body = BENT.split_once("8 6 0\n").unwrap().1.replace("4 4 0\n", "4 3.5 0.5\n");
    let moved: Vec<&str> = body.lines().filter(|line| *line != "4 4 5 6 7").collect();
    let (last, others) = moved.split_last().unwrap();
    fs::write(folder.join("bent.ply"), format!("{header}{}\n4 4 5 6 7\n{last}\n", others.join("\n"))).unwrap();
    let found = json(&folder, &["check", "bent.ply"]);
    let defects = found["defects"].as_array().unwrap();
    let numbers: Vec<_> = defects.iter().map(|defect| defect["elements"][0]["number"].as_u64().unwrap()).collect();
    assert_eq!(numbers, [0, 3, 4], "{found}");
    assert!(defects.iter().all(|defect| defect["elements"][0]["line"].is_null()));
}

#[test]
fn a_domain_without_a_volume_is_an_error() {
    let folder = folder("a_domain_without_a_volume_is_an_error");
    let open = BENT.replace("8 6 0", "8 5 0").replace("4 3 0 4 7\n", "").replace("4 4 4.5", "4 4 4");
    let flat = "OFF\n4 1 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n4 0 1 2 3\n";
    let hole = |seed: &str| CUBE.replace("8 6\n0\n0\n", &format!("8 6\n1\n1 {seed}\n0\n"));
    for (name, content, problem) in [
        ("open.off", open, "its facets enclose no volume"),
        ("flat.off", flat.to_owned(), "its points lie in a plane and enclose no volume"),
        ("hole.poly", hole("1 1 1"), "its holes take all of it"),
        ("sides.poly", hole("1 1 1").replace("6 0\n1\n4 1 2 4 3\n", "5 0\n"), "its facets enclose no volume"),
    ] {
        fs::write(folder.join(name), content).unwrap();
        let line = format!("{name}: domain: {problem}");
        let output = wellspaced(&folder, &["check", name]);
        assert_eq!((output.status.code(), output.stderr), (Some(1), vec![]), "{name}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.starts_with(&format!("error: {line}\n")) && text.contains("\n1 errors, "), "{text}");
        let output = wellspaced(&folder, &["check", name, "--json"]);
        assert_eq!(output.status.code(), Some(1), "{name}");
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let defects = found["defects"].as_array().unwrap();
        let told = json!({
            "kind": "not_meshable",
            "severity": "error",
            "elements": [{"kind": "domain", "number": null, "line": null}],
            "place": null,
            "measure": 0.0,
            "text": line,
        });
        assert_eq!((&found["errors"], &defects[0]), (&json!(1), &told), "{name}");
        assert_eq!(found["warnings"], defects.len() - 1, "{name}");
        assert_eq!(failure(&folder, &["refine", name, "-b", "2"]), (1, format!("{line}\n")));
    }
    // A hole outside takes nothing.
    fs::write(folder.join("outside.poly"), hole("9 9 9")).unwrap();
    assert!(stdout(&folder, &["check", "outside.poly"]).starts_with("0 errors, 0 warnings\n"));
}
