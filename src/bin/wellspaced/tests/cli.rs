//! The command as a user runs it: files, standard output, standard error and exit statuses.

mod checked;
mod refined;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn wellspaced(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_wellspaced")).args(arguments).current_dir(folder).output().unwrap()
}

/// Standard output of a run that must succeed, quietly: standard error is a pipe here.
fn stdout(folder: &Path, arguments: &[&str]) -> String {
    let output = wellspaced(folder, arguments);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments:?}: {stderr}");
    assert_eq!(stderr, "", "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let text = stdout(folder, &[arguments, &["--json"]].concat());
    assert_eq!(text.lines().count(), 1, "{text}");
    serde_json::from_str(&text).unwrap()
}

/// Exit status and standard error of a run that must fail, saying nothing on standard output.
fn failure(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = wellspaced(folder, arguments);
    assert_eq!(output.stdout, b"", "{arguments:?}");
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// A folder of this test alone, empty at its start.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn write_dataset(folder: &Path, name: &str) -> String {
    let text = stdout(folder, &["dataset", name]);
    fs::write(folder.join(format!("{name}.poly")), &text).unwrap();
    text
}

/// The numbers of a text file, comments left out.
fn numbers(path: PathBuf) -> Vec<f64> {
    fs::read_to_string(path).unwrap().split_whitespace().map(|field| field.parse().unwrap()).collect()
}

#[test]
fn refine_a_domain() {
    let folder = folder("refine_a_domain");
    write_dataset(&folder, "cube1");
    let mut vertices = Vec::new();
    for rule in ["paper", "circumcenter"] {
        let output = format!("{rule}.ele");
        let arguments =
            ["refine", "cube1.poly", "--radius-edge", "8", "--rule", rule, "--output", &output, "--output", "m.vtu"];
        let result = json(&folder, &arguments);
        let keys: Vec<&str> = result.as_object().unwrap().keys().map(String::as_str).collect();
        let mut expected = [
            "input_vertices",
            "vertices",
            "tetrahedra",
            "steiner",
            "bad",
            "unrefined",
            "too_large",
            "on_segments",
            "on_facets",
            "worst_radius_edge",
            "min_dihedral_degrees",
            "rule",
            "radius_edge",
            "status",
            "seconds",
        ];
        expected.sort();
        assert_eq!(keys, expected);
        let seconds = result["seconds"].as_object().unwrap();
        assert!(["read", "delaunay", "refine", "write"].iter().all(|key| seconds[*key].as_f64().unwrap() >= 0.0));
        assert_eq!(seconds.len(), 4);

        let count = |key: &str| result[key].as_u64().unwrap() as usize;
        assert_eq!((count("input_vertices"), count("bad")), (10, 0));
        assert_eq!(count("vertices"), 10 + count("steiner"));
        assert!(count("steiner") > 30, "{result}");
        assert_eq!((&result["rule"], &result["status"]), (&rule.into(), &"done".into()));
        assert_eq!(result["radius_edge"], 8.0);
        let worst = result["worst_radius_edge"].as_f64().unwrap();
        assert!(worst > 1.0 && worst <= 8.0 + 1e-12, "{worst}");
        assert!((0.0..60.0).contains(&result["min_dihedral_degrees"].as_f64().unwrap()));

        // The files hold the mesh that was reported: the input first, the volume the cube's.
        let nodes = numbers(folder.join(format!("{rule}.node")));
        assert_eq!(nodes[..4], [count("vertices") as f64, 3.0, 0.0, 0.0]);
        let point = |i: usize| [nodes[4 + 4 * i + 1], nodes[4 + 4 * i + 2], nodes[4 + 4 * i + 3]];
        assert_eq!((point(0), point(9)), ([-5e4; 3], [0.5, 0.0, 0.0]));
        let tetrahedra = numbers(folder.join(format!("{rule}.ele")));
        assert_eq!(tetrahedra[..3], [count("tetrahedra") as f64, 4.0, 0.0]);
        let volumes = tetrahedra[3..].chunks_exact(5).map(|line| {
            let [a, b, c, d] = [1, 2, 3, 4].map(|corner| point(line[corner] as usize));
            let [u, v, w] = [b, c, d].map(|end| [end[0] - a[0], end[1] - a[1], end[2] - a[2]]);
            let cross = [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];
            (u[0] * cross[0] + u[1] * cross[1] + u[2] * cross[2]) / 6.0
        });
        let volumes: Vec<f64> = volumes.collect();
        assert!(volumes.iter().all(|&volume| volume > 0.0));
        assert!((volumes.iter().sum::<f64>() / 1e15 - 1.0).abs() < 1e-12);
        let vtu = fs::read_to_string(folder.join("m.vtu")).unwrap();
        assert!(vtu.contains(&format!("NumberOfPoints=\"{}\"", count("vertices"))));
        vertices.push(count("vertices"));
    }
    assert!(vertices[0] < vertices[1], "the paper's rule needs fewer points: {vertices:?}");
    let expected = ["circumcenter.ele", "circumcenter.node", "cube1.poly", "m.vtu", "paper.ele", "paper.node"];
    assert_eq!(names(&folder), expected);
}

#[test]
fn a_written_mesh_is_read_back() {
    let folder = folder("a_written_mesh_is_read_back");
    write_dataset(&folder, "cube8");
    let refined = json(&folder, &["refine", "cube8.poly", "--radius-edge", "4", "-o", "m.node"]);
    let again = json(&folder, &["delaunay", "m.node"]);
    for key in ["vertices", "tetrahedra"] {
        assert_eq!(refined[key], again[key], "{key}");
    }
    // These have nine digits: the order of a tetrahedron's vertices shows in the rest.
    for key in ["worst_radius_edge", "min_dihedral_degrees"] {
        let [a, b] = [&refined, &again].map(|mesh| mesh[key].as_f64().unwrap());
        assert!((a - b).abs() < 1e-9 * b.max(1.0), "{key}: {a} {b}");
    }
}

#[test]
fn points_are_refined_in_their_hull() {
    let folder = folder("points_are_refined_in_their_hull");
    let corners = "0 0 0\n9 0 0\n0 9 0\n9 9 0\n0 0 9\n9 0 9\n0 9 9\n9 9 9\n";
    fs::write(folder.join("in.xyz"), format!("{corners}4 4 4 # two near ones\n4.1 4 4\n")).unwrap();
    let result = json(&folder, &["refine", "in.xyz", "-b", "1.5"]);
    assert_eq!((&result["input_vertices"], &result["bad"]), (&10.into(), &0.into()));
    assert!(result["steiner"].as_u64().unwrap() > 10, "{result}");
    // The same from a file of surfaces that has none.
    let vertices: String =
        fs::read_to_string(folder.join("in.xyz")).unwrap().lines().map(|line| format!("v {line}\n")).collect();
    fs::write(folder.join("in.obj"), vertices.replace("# two near ones", "")).unwrap();
    let same = json(&folder, &["refine", "in.obj", "-b", "1.5"]);
    assert_eq!((&same["vertices"], &same["tetrahedra"]), (&result["vertices"], &result["tetrahedra"]));
}

#[test]
fn delaunay_reports_the_same_object() {
    let folder = folder("delaunay_reports_the_same_object");
    fs::write(folder.join("in.xyz"), "0,0,0\n1,0,0\n0,1,0\n0,0,1\n1,0,0\n").unwrap();
    let result = json(&folder, &["delaunay", "in.xyz", "--output", "m.ele"]);
    assert_eq!((&result["vertices"], &result["tetrahedra"], &result["steiner"]), (&4.into(), &1.into(), &0.into()));
    assert!(["bad", "rule", "radius_edge"].iter().all(|key| result.get(key) == Some(&Value::Null)));
    assert_eq!(result["status"], "done");
    assert!((result["worst_radius_edge"].as_f64().unwrap() - 0.75f64.sqrt()).abs() < 1e-15);
    assert_eq!(fs::read_to_string(folder.join("m.node")).unwrap(), "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
    let text = stdout(&folder, &["delaunay", "in.xyz"]);
    assert!(text.contains("vertices             4 (4 input, 0 Steiner)\ntetrahedra           1\n"), "{text}");
}

#[test]
fn a_vertex_limit_ends_the_refinement() {
    let folder = folder("a_vertex_limit_ends_the_refinement");
    write_dataset(&folder, "cube1");
    let result = json(&folder, &["refine", "cube1.poly", "--radius-edge", "1.5", "--max-vertices", "50"]);
    assert_eq!(result["status"], "vertex_limit");
    assert!(result["vertices"].as_u64().unwrap() <= 50 && result["bad"].as_u64().unwrap() > 0, "{result}");
}

#[test]
fn seconds_and_memory_end_the_refinement() {
    let folder = folder("seconds_and_memory_end_the_refinement");
    write_dataset(&folder, "cube1");
    for (limit, status) in [("--max-seconds=0", "time_limit"), ("--max-memory=0", "memory_limit")] {
        let result = json(&folder, &["refine", "cube1.poly", "--radius-edge", "1.5", limit]);
        assert_eq!(result["status"], status);
        assert!(result["bad"].as_u64().unwrap() > 0, "{result}");
    }
    let result =
        json(&folder, &["refine", "cube1.poly", "-b", "1.5", "--max-seconds", "1e9", "--max-memory", "100000"]);
    assert_eq!(result["status"], "done");
    let (status, text) = failure(&folder, &["refine", "cube1.poly", "-b", "1.5", "--max-seconds=-1"]);
    assert_eq!(status, 2);
    assert!(text.contains("max_seconds"), "{text}");
}

#[test]
fn wrong_input_is_one_line_and_status_1() {
    let folder = folder("wrong_input_is_one_line_and_status_1");
    for (name, content, message) in [
        ("a.poly", "4 3\n0 0 0 0\n1 1 0 zero\n", "a.poly:3: point 1: z coordinate is \"zero\", expected a number\n"),
        ("b.node", "2 3\n0 0 0 0\n", "b.node:2: point 2 of 2: missing, the file ends here\n"),
        ("b.obj", "garbage\n", "b.obj: holds no points\n"),
        ("c.xyz", "1 2 3\n4 5\n", "c.xyz:2: point 2: z coordinate is missing\n"),
        (
            "d.xyz",
            "1 2 3\n# far\n1e300 0 0\n",
            "d.xyz:3: point 2: a coordinate is outside the range of the exact predicates \
             (0, or a magnitude from 2^-142 to 2^201)\n",
        ),
    ] {
        fs::write(folder.join(name), content).unwrap();
        for arguments in [vec!["refine", name, "-b", "2", "-o", "m.vtu"], vec!["delaunay", name, "--json"]] {
            assert_eq!(failure(&folder, &arguments), (1, message.to_owned()));
        }
    }
    let (status, message) = failure(&folder, &["delaunay", "none.poly"]);
    assert_eq!((status, message.lines().count()), (1, 1));
    assert!(message.starts_with("none.poly: "), "{message}");
    let (status, message) = failure(&folder, &["delaunay", "c.xyz", "-o", "none/m.vtu"]);
    assert_eq!((status, message.as_str()), (1, "none/m.vtu: there is no folder none\n"));
    assert_eq!(names(&folder), ["a.poly", "b.node", "b.obj", "c.xyz", "d.xyz"], "nothing was written");
}

#[test]
fn a_domain_that_is_no_domain_is_named_by_line() {
    let folder = folder("a_domain_that_is_no_domain_is_named_by_line");
    let text = write_dataset(&folder, "cube1");
    // The third facet's square loses its plane: corner 5 becomes 6.
    let lines: Vec<&str> = text.lines().collect();
    let line = lines.iter().position(|&line| line == "4 0 1 5 4").unwrap();
    fs::write(folder.join("bent.poly"), text.replace("4 0 1 5 4", "4 0 1 6 4")).unwrap();
    let (status, message) = failure(&folder, &["refine", "bent.poly", "-b", "2"]);
    assert_eq!((status, message.lines().count()), (1, 1), "{message}");
    assert!(message.starts_with(&format!("bent.poly:{line}: facet 2: ")), "{message}");
}

#[test]
fn elements_of_joined_facets_are_named_as_the_file_has_them() {
    let folder = folder("elements_of_joined_facets_are_named_as_the_file_has_them");
    // The cube's squares are two triangles each, which are joined; a tetrahedron's corner comes through its top.
    let cube =
        "3 0 3 1\n3 0 2 3\n3 4 5 7\n3 4 7 6\n3 0 1 5\n3 0 5 4\n3 2 7 3\n3 2 6 7\n3 0 4 6\n3 0 6 2\n3 1 3 7\n3 1 7 5\n";
    let corners: String = (0..8).map(|i| format!("{} {} {}\n", 4 * (i & 1), 4 * (i >> 1 & 1), 4 * (i >> 2))).collect();
    let spike = "1 1 2\n1 1 6\n2 1 6\n1 2 6\n";
    let body = format!("{corners}{spike}{cube}3 9 10 11\n3 8 10 9\n3 8 11 10\n3 8 9 11\n");
    fs::write(folder.join("spike.off"), format!("OFF\n12 16 0\n{body}")).unwrap();
    let (status, message) = failure(&folder, &["refine", "spike.off", "-b", "2"]);
    // Facets 13 to 15 are the spike's at the corner inside, 2 is the top's first half; its own number is 1 once the halves are joined.
    assert_eq!((status, message.as_str()), (1, "spike.off:28: facet 13: goes through facet 2 at (1, 1, 4)\n"));
    // Also in a file whose lines are not known.
    let header = "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty double y\nproperty double z\n\
                  element face 16\nproperty list uchar int vertex_indices\nend_header\n";
    fs::write(folder.join("spike.ply"), format!("{header}{body}")).unwrap();
    let (status, message) = failure(&folder, &["refine", "spike.ply", "-b", "2"]);
    assert_eq!((status, message.as_str()), (1, "spike.ply: facet 13: goes through facet 2 at (1, 1, 4)\n"));
}

#[test]
fn usage_errors_are_status_2_before_any_work() {
    let folder = folder("usage_errors_are_status_2_before_any_work");
    fs::write(folder.join("in.xyz"), "not numbers\n").unwrap();
    fs::write(folder.join("in.node"), "0 3\n").unwrap();
    for arguments in [
        vec![],
        vec!["polish"],
        vec!["refine", "in.xyz"],
        vec!["refine", "in.xyz", "--radius-edge", "0.5"],
        vec!["refine", "in.xyz", "--radius-edge", "two"],
        vec!["refine", "in.xyz", "--radius-edge", "2", "--rule", "best"],
        vec!["refine", "in.xyz", "--radius-edge", "2", "--max-vertices", "-1"],
        vec!["refine", "in.xyz", "--radius-edge", "2", "--max-edge=-1"],
        vec!["refine", "in.xyz", "--radius-edge", "2", "--max-edge", "nan"],
        vec!["refine", "in.xyz", "--radius-edge", "2", "--max-edge", "inf"],
        vec!["refine", "in.xyz", "--radius-edge", "2", "--output", "m.stl"],
        vec!["refine", "in.step", "--radius-edge", "2"],
        vec!["delaunay", "in.xyz", "--output", "m"],
        vec!["delaunay", "in.node", "--output", "in.ele"],
        vec!["dataset", "torus"],
        vec!["dataset", "cube1", "--seed", "x"],
        vec!["table1", "--data", "x", "--seed", "2"],
    ] {
        let (status, message) = failure(&folder, &arguments);
        assert_eq!(status, 2, "{arguments:?}: {message}");
        assert!(!message.is_empty());
    }
    assert_eq!(names(&folder), ["in.node", "in.xyz"]);
}

#[test]
fn datasets_are_what_was_asked_for() {
    let folder = folder("datasets_are_what_was_asked_for");
    let cube1 = stdout(&folder, &["dataset", "cube1", "--seed", "7"]);
    assert_eq!(cube1, stdout(&folder, &["dataset", "cube1"]), "nothing in it is random");
    assert!(cube1.starts_with("10 3 0 0\n0 -50000 -50000 -50000\n"), "{cube1}");
    assert!(cube1.ends_with(
        "9 0.5 0 0\n6 0\n1\n4 0 1 3 2\n1\n4 4 5 7 6\n1\n4 0 1 5 4\n1\n4 2 3 7 6\n1\n4 0 2 6 4\n1\n4 1 3 7 5\n0\n0\n"
    ));
    let random = |seed| stdout(&folder, &["dataset", "random", "--seed", seed]);
    assert_eq!(random("1"), stdout(&folder, &["dataset", "random"]));
    assert_ne!(random("1"), random("2"));
}

#[test]
fn the_table_has_all_rows_of_a_data_set() {
    let folder = folder("the_table_has_all_rows_of_a_data_set");
    write_dataset(&folder, "cube8");
    let result: Value = serde_json::from_str(&stdout(&folder, &["table1", "--only", "cube8", "--json"])).unwrap();
    let rows = result["rows"].as_array().unwrap();
    let methods = ["circumcenter", "paper", "sparse, sampler", "sparse, no pass", "sparse", "sparse, thorough"];
    let expected = [1.5, 2.0, 4.0, 8.0].map(|bound| methods.map(|method| (bound, method)));
    let found: Vec<_> =
        rows.iter().map(|row| (row["radius_edge"].as_f64().unwrap(), row["rule"].as_str().unwrap())).collect();
    assert_eq!(found, expected.concat());
    for row in rows {
        let count = |value: &Value| value.as_u64().unwrap();
        assert_eq!((&row["data_set"], &row["bad"], &row["status"]), (&"cube8".into(), &0.into(), &"done".into()));
        assert_eq!(count(&row["vertices"]), 32 + count(&row["steiner"]));
        match row["rule"].as_str() {
            Some(rule) if rule.starts_with("sparse") => assert_eq!(row["paper"], Value::Null),
            _ => assert_eq!(count(&row["paper"]["vertices"]), 32 + count(&row["paper"]["steiner"])),
        }
    }
    let mean = result["mean_steiner_ratio"]["paper"]["all"]["ours"].as_f64().unwrap();
    assert!(mean < 1.0, "the paper's rule is sparser than circumcentres: {mean}");
    let sparse = result["mean_steiner_ratio"]["sparse"]["all"]["ours"].as_f64().unwrap();
    assert!(sparse < mean, "and our own is sparser still: {sparse}");

    // The same from a folder of files, as text.
    let text = stdout(&folder, &["table1", "--only", "cube8", "--data", "."]);
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("Cube8")).collect();
    assert_eq!(lines.len(), 24, "{text}");
    assert!(lines[0].contains("(2,164)") && lines[19].contains("(233)"), "{text}");
    assert!(text.contains(&format!("paper            {mean:.3} (")), "{text}");
    let (status, message) = failure_after_header(&folder, &["table1", "--only", "helix", "--data", "."]);
    assert_eq!(status, 1);
    assert!(message.contains("helix.poly: "), "{message}");
}

fn failure_after_header(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = wellspaced(folder, arguments);
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
#[cfg(unix)]
fn a_reader_that_goes_away_is_no_failure() {
    use std::io::Read;
    use std::process::Stdio;
    let mut child = Command::new(env!("CARGO_BIN_EXE_wellspaced"))
        .args(["dataset", "ellipsoid"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = [0; 5];
    child.stdout.take().unwrap().read_exact(&mut first).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!((&first, output.status.code(), output.stderr), (b"10008", Some(0), vec![]));
}

#[test]
fn threads_change_nothing() {
    let folder = folder("threads");
    let points: String = (0..70_000u64)
        .map(|i| {
            let digits = |k: u64| (i.wrapping_mul(k) >> 7) % 100_003;
            format!("{} {} {}\n", digits(0x9e37_79b9_7f4a), digits(0xbf58_476d_1ce5), digits(0x94d0_49bb_1331))
        })
        .collect();
    fs::write(folder.join("points.xyz"), points).unwrap();
    let mesh = |threads: &str| {
        stdout(&folder, &["delaunay", "points.xyz", "--threads", threads, "--output", "mesh.node"]);
        ["mesh.node", "mesh.ele"].map(|name| fs::read(folder.join(name)).unwrap())
    };
    let one = mesh("1");
    assert!(one == mesh("2") && one == mesh("0"));
    assert_eq!(failure(&folder, &["delaunay", "points.xyz", "--threads", "1025"]).0, 2);
}
