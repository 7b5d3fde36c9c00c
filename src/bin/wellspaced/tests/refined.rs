//! What the options of `wellspaced refine` change, and what its JSON object tells of what could not be mended.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::json;

use super::{folder, json, numbers};

/// A box of 4 x 4 x 4 with two near points in it; each side is two triangles.
const HALVES: &str = "\
10 3
0 0 0 0
1 4 0 0
2 4 4 0
3 0 4 0
4 0 0 4
5 4 0 4
6 4 4 4
7 0 4 4
8 2 2 2
9 2.25 2 2
12 0
1
3 0 1 2
1
3 0 2 3
1
3 4 5 6
1
3 4 6 7
1
3 0 1 5
1
3 0 5 4
1
3 1 2 6
1
3 1 6 5
1
3 2 3 7
1
3 2 7 6
1
3 3 0 4
1
3 3 4 7
0
0
";

/// The rows of one of TetGen's files behind a header of `header` numbers, without their own numbers.
fn rows(folder: &Path, name: &str, header: usize, columns: usize) -> Vec<Vec<f64>> {
    let all = numbers(folder.join(name));
    assert_eq!(all.len(), header + all[0] as usize * (columns + 1), "{name}");
    all[header..].chunks_exact(columns + 1).map(|row| row[1..].to_vec()).collect()
}

/// How many edges and faces lie on the boundary.
fn boundary(folder: &Path) -> (usize, usize) {
    (rows(folder, "m.edge", 2, 3).len(), rows(folder, "m.face", 2, 4).len())
}

#[test]
fn a_kept_boundary_gets_no_points() {
    let folder = folder("a_kept_boundary_gets_no_points");
    fs::write(folder.join("box.poly"), HALVES).unwrap();
    let arguments = ["refine", "box.poly", "--join-coplanar", "0", "-b", "1.2", "-o", "m.edge"];
    let split = json(&folder, &arguments);
    assert_eq!(split["bad"], 0);
    let (edges, faces) = boundary(&folder);
    assert!(edges > 12 && faces > 12, "{edges} edges, {faces} faces");
    let kept = json(&folder, &[&arguments[..], &["--keep-boundary"]].concat());
    assert_eq!(boundary(&folder), (12, 12));
    // What the points on the boundary would have mended is counted.
    assert!(kept["steiner"].as_u64().unwrap() > 0 && kept["bad"].as_u64().unwrap() > 0, "{kept}");
    assert_eq!((&kept["status"], &kept["unrefined"]), (&json!("unrefined"), &json!({"boundary": kept["bad"]})));
}

#[test]
fn no_edge_is_longer_than_asked_for() {
    let folder = folder("no_edge_is_longer_than_asked_for");
    fs::write(folder.join("box.poly"), HALVES).unwrap();
    let mut longest = BTreeMap::new();
    for limit in ["2", "1.2"] {
        let result = json(&folder, &["refine", "box.poly", "-b", "2", "--max-edge", limit, "-o", "m.edge"]);
        assert_eq!((&result["too_large"], &result["status"]), (&json!(0), &json!("done")));
        let points = rows(&folder, "m.node", 4, 3);
        let tetrahedra = rows(&folder, "m.ele", 3, 4);
        let lengths = tetrahedra.iter().flat_map(|t| {
            [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| {
                let [a, b] = [t[i], t[j]].map(|corner| &points[corner as usize]);
                a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
            })
        });
        longest.insert(limit, lengths.fold(0.0, f64::max));
    }
    assert!(longest["1.2"] <= 1.2 && longest["2"] <= 2.0 && longest["2"] > 1.2, "{longest:?}");
}

#[test]
fn halves_are_joined_if_that_is_asked_for_or_they_are_a_surface() {
    let folder = folder("halves_are_joined_if_that_is_asked_for_or_they_are_a_surface");
    fs::write(folder.join("box.poly"), HALVES).unwrap();
    // The same as a surface.
    let lines: Vec<&str> = HALVES.lines().collect();
    let points = lines[1..11].iter().map(|line| line.split_once(' ').unwrap().1);
    let triangles = lines[12..36].iter().copied().skip(1).step_by(2);
    let surface: Vec<&str> = ["OFF", "10 12 0"].into_iter().chain(points).chain(triangles).collect();
    fs::write(folder.join("box.off"), surface.join("\n") + "\n").unwrap();
    for (name, option, joined) in [
        ("box.poly", &[][..], false),
        ("box.poly", &["--join-coplanar", "0"], true),
        ("box.poly", &["--join-coplanar", "off"], false),
        ("box.off", &[], true),
        ("box.off", &["--join-coplanar", "off"], false),
    ] {
        // No tetrahedron is that bad: nothing is split but for diagonals that the points' triangulation does not have.
        let result = json(&folder, &[&["refine", name, "-b", "100", "-o", "m.edge"], option].concat());
        let (edges, faces) = boundary(&folder);
        if joined {
            assert_eq!((edges, faces, &result["steiner"]), (12, 12, &json!(0)), "{name} {option:?}");
        } else {
            assert!(edges >= 18, "{name} {option:?}: {edges}");
        }
    }
}

/// A wedge of 5 degrees at the edge from 0 to 3.
const WEDGE: &str = "\
6 3
0 0 0 0
1 1 0 0
2 0.99619469809 0.08715574275 0
3 0 0 1
4 1 0 1
5 0.99619469809 0.08715574275 1
5 0
1
3 0 1 2
1
3 3 4 5
1
4 0 1 4 3
1
4 1 2 5 4
1
4 2 0 3 5
0
0
";

#[test]
fn what_a_small_angle_leaves_is_counted_by_reason() {
    let folder = folder("what_a_small_angle_leaves_is_counted_by_reason");
    fs::write(folder.join("wedge.poly"), WEDGE).unwrap();
    let result = json(&folder, &["refine", "wedge.poly", "-b", "2"]);
    assert_eq!(result["status"], "unrefined");
    let bad = result["bad"].as_u64().unwrap();
    assert!((1..200).contains(&bad), "{result}");
    // Around the sharp edge it is the angle that leaves them, and a few are left because they would split the boundary there.
    let reasons = result["unrefined"].as_object().unwrap();
    let count = |reason: &str| reasons.get(reason).map_or(0, |count| count.as_u64().unwrap());
    assert!(count("small_angle") > 0 && count("small_angle") + count("boundary") == bad, "{result}");
    assert!(reasons.values().all(|count| *count != 0), "{result}");
    assert!(result["worst_radius_edge"].as_f64().unwrap() > 2.0);
}
