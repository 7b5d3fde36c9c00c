//! The surfaces of CGAL's demos (Debian's package libcgal-demo): each is meshed, conforming and with the volume that it encloses, or it is told
//! why it can't be. Larger ones have a test that only `script/check surfaces` runs.

use std::path::{Path, PathBuf};
use std::process::Command;

use wellspaced::geometry::predicates::orient3d;
use wellspaced::geometry::quality::exceeds_radius_edge;
use wellspaced::geometry::Sign;
use wellspaced::{
    Control, DVec3, DomainElement, Error, Mesh, Plc, PlcDefectKind, PlcFacet, PlcRegion, RefineOptions, RefineStatus,
    Unrefined,
};

const ARCHIVE: &str = "/usr/share/doc/libcgal-demo/data.tar.gz";
/// Bytes of a file that a test without optimization has the time for.
const LARGEST: u64 = 150_000;

/// The surfaces that can't be meshed, because they are open, flat or cross themselves, or a facet has no area.
#[rustfmt::skip]
const REFUSED: [&str; 38] = [
    "ALSTOM_TEST4.off", "blob.off", "blobby_3cc.off", "bones.off", "corner_tris_with_hole.off",
    "corner_with_hole.off", "cube-ouvert.off", "cylinder.off", "degtri_sliding.off", "double-torus-3-holes.off",
    "elk.off", "fold.off", "head.off", "hedra_open.off", "horizons.off", "in.off", "mask_cone.off",
    "mesh_with_border.off", "mesh_with_colors.off", "mushroom.off", "nefertiti.off", "negative.off", "open_cube.off",
    "patch-01.off", "patch-13.off", "patch-20.off", "patch-21.off", "patch-23.off", "patch-30.off", "pig.off",
    "plane.off", "poly2x^2+y^2-0.062500.off", "quad.off", "quads_to_stitch.off", "tetra_intersected_by_triangle.off",
    "three_peaks.off", "triangle.off", "triangular_hole.off",
];

/// Those of the larger ones.
#[rustfmt::skip]
const LARGE_REFUSED: [&str; 16] = [
    "ChineseDragon-10kv.off", "b9_mesh.off", "blade.off", "bull.off", "camel.off", "cow.off",
    "cylinder_locally_refined.off", "diplodocus.off", "elephant-with-holes.off", "holes.off", "lion-head.off",
    "lion.off", "man.off", "mannequin-devil.off", "mech-holes-shark.off", "polygon_mesh.off",
];

/// The archive's surfaces.
fn surfaces(folder: &Path) -> Vec<PathBuf> {
    let unpack = Command::new("tar").args(["-xzf", ARCHIVE, "-C"]).arg(folder).status().expect("tar runs");
    assert!(unpack.success(), "{ARCHIVE} is missing: script/install-packages installs it");
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder.join("data/meshes"))
        .expect("the archive holds data/meshes")
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "off"))
        .collect();
    found.sort();
    assert!(found.len() > 130, "{} surfaces", found.len());
    found
}

/// An .off file's polygons as facets; colours behind them are passed over.
fn read(path: &Path) -> Plc {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split('#').next().unwrap().trim()).filter(|line| !line.is_empty());
    let header = lines.next().unwrap();
    assert!(header.ends_with("OFF"), "{header}");
    let mut numbers = lines.flat_map(|line| line.split_whitespace().chain(["\n"]));
    let count = |word: Option<&str>| word.unwrap().parse::<usize>().unwrap();
    let (vertices, faces) = (count(numbers.next()), count(numbers.next()));
    let end_line = |numbers: &mut dyn Iterator<Item = &str>| while numbers.next().is_some_and(|word| word != "\n") {};
    end_line(&mut numbers);
    let mut plc = Plc::default();
    for _ in 0..vertices {
        let [x, y, z] = [(); 3].map(|()| numbers.find(|word| *word != "\n").unwrap().parse().unwrap());
        plc.points.push(DVec3::new(x, y, z));
        end_line(&mut numbers);
    }
    for _ in 0..faces {
        let n = count(numbers.find(|word| *word != "\n"));
        let polygon = (0..n).map(|_| count(numbers.next()) as u32).collect();
        plc.facets.push(PlcFacet { polygons: vec![polygon], ..PlcFacet::default() });
        end_line(&mut numbers);
    }
    plc
}

/// Whether a surface is closed, in one piece, and oriented alike everywhere.
fn is_simple(plc: &Plc) -> bool {
    let mut sides = std::collections::BTreeSet::new();
    let mut piece: Vec<u32> = (0..plc.points.len() as u32).collect();
    fn root(piece: &mut [u32], mut v: u32) -> u32 {
        while piece[v as usize] != v {
            piece[v as usize] = piece[piece[v as usize] as usize];
            v = piece[v as usize];
        }
        v
    }
    for facet in &plc.facets {
        let polygon = &facet.polygons[0];
        for (i, &a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            if !sides.insert([a, b]) {
                return false;
            }
            let (a, b) = (root(&mut piece, a), root(&mut piece, b));
            piece[a as usize] = b;
        }
    }
    let first = plc.facets.first().map(|facet| root(&mut piece, facet.polygons[0][0]));
    sides.iter().all(|&[a, b]| sides.contains(&[b, a]) && Some(root(&mut piece, a)) == first)
}

/// Whether a surface has a side with an odd number of polygons. Points are one if they are at one place.
fn is_open(plc: &Plc) -> bool {
    let place = |v: u32| plc.points[v as usize].to_array().map(|x| (x + 0.0).to_bits());
    let mut odd = std::collections::BTreeSet::new();
    for facet in &plc.facets {
        let polygon = &facet.polygons[0];
        for (i, &a) in polygon.iter().enumerate() {
            let [a, b] = [a, polygon[(i + 1) % polygon.len()]].map(place);
            let side = [a.min(b), a.max(b)];
            if a != b && !odd.remove(&side) {
                odd.insert(side);
            }
        }
    }
    !odd.is_empty()
}

/// What a closed surface encloses.
fn enclosed(plc: &Plc) -> f64 {
    let at = |v: u32| plc.points[v as usize];
    let fan = |p: &[u32]| (1..p.len() - 1).map(|i| at(p[0]).dot(at(p[i]).cross(at(p[i + 1])))).sum::<f64>();
    plc.facets.iter().map(|facet| fan(&facet.polygons[0])).sum::<f64>().abs() / 6.0
}

fn volume(mesh: &Mesh) -> f64 {
    let view = mesh.view();
    let six = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| view.points[v as usize]);
        (b - a).cross(c - a).dot(d - a)
    };
    view.tetrahedra.iter().map(six).sum::<f64>() / 6.0
}

/// Twice a facet's area as a vector, for polygons of any shape.
fn doubled_area(plc: &Plc, polygon: &[u32]) -> DVec3 {
    let from_first = |v: u32| plc.points[v as usize] - plc.points[polygon[0] as usize];
    (1..polygon.len() - 1).map(|i| from_first(polygon[i]).cross(from_first(polygon[i + 1]))).sum()
}

/// Whether a polygon's corners lie within so much of its plane, relative to its size.
fn is_flat(plc: &Plc, polygon: &[u32], tolerance: f64) -> bool {
    let normal = doubled_area(plc, polygon).normalize_or_zero();
    let corners = || polygon.iter().map(|&v| plc.points[v as usize] - plc.points[polygon[0] as usize]);
    let size = corners().map(DVec3::length).fold(0.0, f64::max);
    corners().all(|corner| corner.dot(normal).abs() <= tolerance * size)
}

/// Each facet, joined of those of `parts` with its number in `group`, is covered by its subfacets once. Returns how many were measured: parts have to be flat.
fn check_areas(name: &str, mesh: &Mesh, parts: &Plc, group: &[u32]) -> usize {
    let boundary = mesh.boundary().unwrap();
    let points = mesh.triangulation().points();
    let mut areas = vec![0.0; boundary.facets().len()];
    for (face, facet) in boundary.subfacets() {
        let [a, b, c] = face.map(|v| points[v as usize]);
        areas[facet as usize] += 0.5 * (b - a).cross(c - a).length();
    }
    let mut expected = vec![Some(0.0); areas.len()];
    for (facet, &joined) in parts.facets.iter().zip(group) {
        let polygon = &facet.polygons[0];
        let sum = &mut expected[joined as usize];
        let area = 0.5 * doubled_area(parts, polygon).length();
        *sum = sum.filter(|_| is_flat(parts, polygon, 1e-9)).map(|sum: f64| sum + area);
    }
    let known =
        areas.iter().zip(&expected).enumerate().filter_map(|(i, (area, expected))| Some((i, area, (*expected)?)));
    for (i, area, expected) in known.clone() {
        assert!((area / expected - 1.0).abs() < 1e-6, "{name}: facet {i} has area {area}, expected {expected}");
    }
    known.count()
}

/// Whether a surface is open, flat or crosses itself as is said, by what can be seen without joining any facets.
fn is_true(surface: &Plc, parts: &Plc, joined: &Plc, problem: &str) -> bool {
    let found = joined.check();
    let Some(error) = found.errors().next() else {
        return match problem {
            "its points lie in a plane and enclose no volume" => lies_in_a_plane(surface),
            "its facets enclose no volume" => is_open(surface),
            _ => false,
        };
    };
    match (error.kind, &error.elements[..]) {
        (PlcDefectKind::NoArea, &[DomainElement::Facet(facet)]) => {
            doubled_area(joined, &joined.facets[facet].polygons[0]).length() == 0.0
        }
        (PlcDefectKind::SegmentThroughFacet | PlcDefectKind::SegmentsCross, _) => crosses(parts, error.place),
        _ => false,
    }
}

/// Whether all points lie in the plane of the largest facet.
fn lies_in_a_plane(plc: &Plc) -> bool {
    let areas = plc.facets.iter().map(|facet| (doubled_area(plc, &facet.polygons[0]), facet.polygons[0][0]));
    let largest = areas.max_by(|(a, _), (b, _)| a.length().total_cmp(&b.length()));
    let (normal, origin) = largest.map(|(area, v)| (area.normalize(), plc.points[v as usize])).unwrap();
    plc.points.iter().all(|&p| (p - origin).dot(normal).abs() <= 1e-9 * p.distance(origin))
}

/// Whether two triangles of a surface cross near a place.
fn crosses(plc: &Plc, place: DVec3) -> bool {
    let at = |v: u32| plc.points[v as usize];
    let size = plc.points.iter().fold(0.0, |size: f64, &p| size.max(p.distance(place)));
    let room = DVec3::splat(1e-6 * size);
    let fans = plc.facets.iter().flat_map(|facet| {
        let polygon = &facet.polygons[0];
        (1..polygon.len() - 1).map(|i| [polygon[0], polygon[i], polygon[i + 1]].map(at))
    });
    let near = |[a, b, c]: &[DVec3; 3]| {
        let (low, high) = (a.min(*b).min(*c) - room, a.max(*b).max(*c) + room);
        low.cmple(place).all() && place.cmple(high).all()
    };
    let near: Vec<[DVec3; 3]> = fans.filter(near).collect();
    let sides = near.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    sides.into_iter().any(|side| near.iter().any(|&triangle| goes_through(side, triangle)))
}

/// Whether a side meets a triangle in one point that is no corner of both.
fn goes_through([a, b]: [DVec3; 2], [x, y, z]: [DVec3; 3]) -> bool {
    if [x, y, z].iter().any(|&corner| corner == a || corner == b) || orient3d(x, y, z, a) == orient3d(x, y, z, b) {
        return false;
    }
    let turns = [orient3d(a, b, x, y), orient3d(a, b, y, z), orient3d(a, b, z, x)];
    !(turns.contains(&Sign::Positive) && turns.contains(&Sign::Negative))
}

/// Meshes all surfaces of a size and refines them; what is meshed is checked against the surface. Returns the names of those that are refused.
fn refused(sizes: impl Fn(u64) -> bool) -> Vec<String> {
    let folder = std::env::temp_dir().join(format!("wellspaced-surfaces-{}-{}", std::process::id(), sizes(LARGEST)));
    std::fs::create_dir_all(&folder).unwrap();
    let mut refused = Vec::new();
    for path in surfaces(&folder) {
        if !sizes(path.metadata().unwrap().len()) {
            continue;
        }
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if let Some(problem) = check_surface(&name, &read(&path)) {
            println!("{name}: {problem}");
            refused.push(name);
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
    refused
}

/// Why a surface is refused, if it is.
fn check_surface(name: &str, surface: &Plc) -> Option<String> {
    let mut parts = surface.clone();
    parts.cut_warped();
    let mut plc = parts.clone();
    let group = plc.join_coplanar(0.01);
    let simple = is_simple(surface);
    let mut mesh = match Mesh::from_plc(&plc, &Control::new()) {
        Ok(mesh) => mesh,
        Err(Error::InvalidDomain { problem, .. }) => {
            assert!(is_true(surface, &parts, &plc, &problem), "{name}: {problem}");
            return Some(problem);
        }
        Err(other) => panic!("{name}: {other}"),
    };
    mesh.validate(3).unwrap_or_else(|defect| panic!("{name}: {defect}"));
    let before = volume(&mesh);
    if simple {
        let expected = enclosed(surface);
        // Joined facets are as uneven as files with five digits make them.
        assert!((before / expected - 1.0).abs() < 1e-5, "{name}: volume {before}, the surface's is {expected}");
    }
    let options = RefineOptions { max_vertices: 1_000_000, ..RefineOptions::default() };
    let report = mesh.refine(&options, &Control::new()).unwrap();
    mesh.validate(3).unwrap_or_else(|defect| panic!("{name}: {defect}"));
    // Coordinates are rounded, and so are the planes of joined facets.
    assert!((volume(&mesh) / before - 1.0).abs() < 1e-5, "{name}");
    assert!(matches!(report.status, RefineStatus::Done | RefineStatus::Unrefined), "{name}: {report:?}");
    let view = mesh.view();
    let shapes = view.tetrahedra.iter().map(|t| t.map(|v| view.points[v as usize]));
    let bad = shapes.filter(|&shape| exceeds_radius_edge(shape, options.radius_edge)).count();
    assert_eq!((report.bad, report.unrefined.iter().sum()), (bad, bad), "{name}");
    assert_eq!(report.unrefined[Unrefined::Limit as usize], 0, "{name}: {report:?}");
    let measured = check_areas(name, &mesh, &parts, &group);
    println!("{name}: {} vertices, {bad} bad, {measured} of {} facets measured", report.vertices, plc.facets.len());
    None
}

#[test]
fn surfaces_are_meshed_or_refused_with_a_reason() {
    assert_eq!(refused(|bytes| bytes <= LARGEST), REFUSED);
}

/// It takes minutes: `script/check surfaces` runs it.
#[test]
#[ignore = "large surfaces are for the release build"]
fn large_surfaces_are_too() {
    assert_eq!(refused(|bytes| bytes > LARGEST), LARGE_REFUSED);
}

const EXAMPLE: &str = "/usr/share/doc/tetgen/examples/example.poly";

/// A .poly file without attributes of points, counted from 1.
fn read_poly(path: &str) -> Plc {
    let text =
        std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{path}: {e}: script/install-packages installs it"));
    let words = text.lines().flat_map(|line| line.split('#').next().unwrap().split_whitespace());
    let mut numbers = words.map(|word| word.parse::<f64>().unwrap());
    let mut next = || numbers.next().unwrap();
    let mut plc = Plc::default();
    let (points, _, attributes, _) = (next() as usize, next(), next(), next());
    assert_eq!(attributes, 0.0);
    for _ in 0..points {
        next();
        plc.points.push(DVec3::new(next(), next(), next()));
        plc.point_markers.push(next() as i32);
    }
    let (facets, _) = (next() as usize, next());
    for _ in 0..facets {
        let (polygons, holes, marker) = (next() as usize, next() as usize, next() as i32);
        let mut facet = PlcFacet { marker, ..PlcFacet::default() };
        for _ in 0..polygons {
            let corners = next() as usize;
            facet.polygons.push((0..corners).map(|_| next() as u32 - 1).collect());
        }
        for _ in 0..holes {
            next();
            facet.holes.push(DVec3::new(next(), next(), next()));
        }
        plc.facets.push(facet);
    }
    for _ in 0..next() as usize {
        next();
        plc.holes.push(DVec3::new(next(), next(), next()));
    }
    for _ in 0..next() as usize {
        next();
        let point = DVec3::new(next(), next(), next());
        plc.regions.push(PlcRegion { point, attribute: next(), max_volume: Some(next()) });
    }
    plc
}

/// A box in two parts with different largest volumes, a cavity, and a niche behind a hole in a facet.
#[test]
fn tetgens_own_example_is_meshed() {
    let plc = read_poly(EXAMPLE);
    assert_eq!((plc.points.len(), plc.facets.len(), plc.holes.len(), plc.regions.len()), (28, 23, 2, 2));
    assert_eq!(plc.check().errors().next(), None);
    let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
    mesh.validate(3).unwrap();
    assert_eq!((report.status, report.bad, report.too_large), (RefineStatus::Done, 0, 0));
    let view = mesh.view();
    let (mut volumes, mut largest) = ([0.0; 3], [0.0_f64; 3]);
    for (tetrahedron, &region) in view.tetrahedra.iter().zip(view.regions) {
        let [a, b, c, d] = tetrahedron.map(|v| view.points[v as usize]);
        let volume = (b - a).cross(c - a).dot(d - a) / 6.0;
        volumes[region as usize] += volume;
        largest[region as usize] = largest[region as usize].max(volume);
    }
    // The lower part less a cavity of 1.5 x 1.25 x 0.5 and a niche of 1.5 x 1.5 x 0.5; the upper part above the slanted facet.
    for (volume, expected) in volumes.into_iter().zip([0.0, 14.0 - 0.9375 - 1.125, 6.0]) {
        assert!((volume - expected).abs() < 1e-9, "{volume}, not {expected}");
    }
    assert!(largest[1] <= 0.001 && largest[2] <= 0.01, "{largest:?}");
    // Each input facet is covered by its subfacets.
    let boundary = mesh.boundary().unwrap();
    for (facet, planar) in plc.facets.iter().zip(boundary.facets()) {
        assert_eq!(facet.marker, planar.marker);
        assert!(facet.polygons.iter().flatten().all(|v| planar.corners.contains(v)));
    }
}
