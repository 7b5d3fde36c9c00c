//! The same bytes from the same input, on every machine and in every build: hashes of a dozen outputs are checked in, in tests/determinism.txt.
//! cpp_tests/determinism.c does the same through the C API, compiled by any compiler. `WSP_BLESS=1 cargo test --test determinism` writes the file
//! anew, after a change that is meant to change results.

use std::fmt::Write;
use std::path::Path;

use wellspaced::{Control, DVec3, Mesh, Plc, RefineOptions, Rule, Sparsify};

/// The same generator as in the C program: nothing but exact arithmetic.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 * (1.0 / 9007199254740992.0)
    }

    fn points(&mut self, count: usize) -> Vec<DVec3> {
        (0..count)
            .map(|_| {
                let x = self.next();
                let y = self.next();
                DVec3::new(x, y, self.next())
            })
            .collect()
    }
}

fn grid(n: usize, step: f64) -> Vec<DVec3> {
    (0..n * n * n).map(|i| DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64) * step).collect()
}

/// FNV-1a over the bytes of the view's arrays.
fn hash(mesh: &Mesh) -> u64 {
    let view = mesh.view();
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    let mut take = |bytes: &[u8]| {
        for &byte in bytes {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    };
    view.points.iter().for_each(|p| p.to_array().iter().for_each(|x| take(&x.to_bits().to_le_bytes())));
    for array in [view.tetrahedra, view.neighbours] {
        array.as_flattened().iter().for_each(|x| take(&x.to_le_bytes()));
    }
    view.regions.iter().for_each(|x| take(&x.to_le_bytes()));
    hash
}

fn delaunay(points: &[DVec3], threads: usize) -> Mesh {
    let mut mesh = Mesh::new();
    mesh.set_threads(threads);
    mesh.insert(points, None, &Control::new()).unwrap();
    mesh
}

fn refined(points: &[DVec3], threads: usize, radius_edge: f64, rule: Rule, sparsify: Sparsify) -> Mesh {
    refined_in([DVec3::splat(-1.0), DVec3::splat(2.0)], points, threads, radius_edge, rule, sparsify)
}

fn refined_in(
    [low, high]: [DVec3; 2],
    points: &[DVec3],
    threads: usize,
    radius_edge: f64,
    rule: Rule,
    sparsify: Sparsify,
) -> Mesh {
    let plc = Plc::boxed(low, high, points.iter().copied());
    let mut mesh = Mesh::from_plc_on(threads, &plc, &Control::new()).unwrap();
    let options = RefineOptions { radius_edge, rule, sparsify: Some(sparsify), ..RefineOptions::default() };
    mesh.refine(&options, &Control::new()).unwrap();
    mesh
}

fn mesh(name: &str, threads: usize) -> Mesh {
    let scattered = |count| Numbers(7).points(count);
    match name {
        "scattered" => delaunay(&scattered(20_000), threads),
        // So many are divided among threads.
        "many" => delaunay(&scattered(150_000), threads),
        "grid" => delaunay(&grid(20, 1.0), threads),
        "tenths" => delaunay(&grid(14, 0.1), threads),
        "duplicates" => {
            let some = scattered(500);
            delaunay(&[&some[..], &some, &some, &some].concat(), threads)
        }
        "sphere" => {
            let on = |p: DVec3| {
                let p = p * 2.0 - 1.0;
                p / (p.x * p.x + p.y * p.y + p.z * p.z).sqrt()
            };
            delaunay(&scattered(5000).into_iter().map(on).collect::<Vec<_>>(), threads)
        }
        "flat" => {
            let mut points: Vec<DVec3> = scattered(3000).into_iter().map(|p| p.with_z(0.25)).collect();
            points.push(DVec3::ONE);
            delaunay(&points, threads)
        }
        "removed" => {
            let mut mesh = delaunay(&scattered(2000), threads);
            (0..2000).step_by(3).for_each(|v| mesh.remove(v).unwrap());
            mesh
        }
        "sparse" => refined(&scattered(1000), threads, 2.0, Rule::Sparse, Sparsify::Quick),
        // Points up to the sides of their box: most Steiner points are on the boundary.
        "full" => {
            let unit = [DVec3::ZERO, DVec3::ONE];
            refined_in(unit, &scattered(1000), threads, 1.5, Rule::Sparse, Sparsify::Moves)
        }
        "thorough" => refined(&scattered(300), threads, 1.5, Rule::Sparse, Sparsify::Thorough),
        "paper" => refined(&scattered(1000), threads, 2.0, Rule::Paper, Sparsify::Off),
        "circumcenter" => refined(&scattered(1000), threads, 1.5, Rule::Circumcenter, Sparsify::Off),
        _ => panic!("{name}"),
    }
}

#[rustfmt::skip]
const NAMES: [&str; 13] = [
    "scattered", "many", "grid", "tenths", "duplicates", "sphere", "flat", "removed", "sparse", "full", "thorough", "paper",
    "circumcenter",
];

#[test]
fn outputs_are_those_that_are_checked_in() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/determinism.txt");
    let mut lines = String::new();
    for name in NAMES {
        let [one, two, five] = [1, 2, 5].map(|threads| hash(&mesh(name, threads)));
        assert_eq!((one, one), (two, five), "{name}: other bytes on other numbers of threads");
        writeln!(lines, "{name} {one:016x}").unwrap();
    }
    if std::env::var_os("WSP_BLESS").is_some() {
        std::fs::write(&path, &lines).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap();
    assert_eq!(lines, expected, "results have changed; if they are meant to, write the file anew with WSP_BLESS=1");
}
