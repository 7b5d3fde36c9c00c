//! The pieces of the kernel, one by one: predicates, insertion, location, removal (by degree too), and bulk insertion of several sizes.
//!
//! `cargo bench --bench kernel [-- NAME]`. For the whole beside its peers there is `script/bench`.

use std::hint::black_box;

use criterion::{criterion_group, criterion_main, BatchSize, BenchmarkId, Criterion, Throughput};
use wellspaced::geometry::{predicates, Filter};
use wellspaced::{Control, DVec3, Triangulation};

/// Numbers from 0 to 1, the same ones each time.
fn random() -> impl FnMut() -> f64 {
    let mut state = 9u64;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn uniform(n: usize) -> Vec<DVec3> {
    let mut next = random();
    (0..n).map(|_| DVec3::new(next(), next(), next())).collect()
}

fn grid(side: usize, unit: f64) -> Vec<DVec3> {
    (0..side * side * side)
        .map(|i| DVec3::new((i % side) as f64, (i / side % side) as f64, (i / side / side) as f64) * unit)
        .collect()
}

fn triangulated(points: &[DVec3]) -> Triangulation {
    let mut t = Triangulation::new();
    t.insert_many(points, &Control::new()).expect("points in range");
    t
}

fn predicates_of(c: &mut Criterion) {
    let mut group = c.benchmark_group("predicates");
    // The corners of a box are cospherical: what no filter decides.
    let corners = |unit: f64| {
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
            .map(|p| DVec3::from_array(p.map(|x| f64::from(x + 3) * unit)))
    };
    let scattered = uniform(5);
    let [a, b, c_, d, p] = [0, 1, 2, 3, 4].map(|i| scattered[i]);
    let wide = uniform(1000);
    for (name, [a, b, c, d, p], points) in [
        ("scattered", [a, b, c_, d, p], &wide),
        ("integers", corners(1.0), &grid(10, 1.0)),
        ("tenths", corners(0.1), &grid(100, 0.1)),
    ] {
        let filter = Filter::for_points(points);
        group.bench_function(BenchmarkId::new("orient3d", name), |bench| {
            bench.iter(|| filter.orient3d(black_box(a), b, c, d));
        });
        group.bench_function(BenchmarkId::new("insphere", name), |bench| {
            bench.iter(|| filter.insphere(black_box(a), b, c, d, p));
        });
    }
    let [a, b, c, d, p] = corners(0.1);
    group.bench_function("insphere/adaptive", |bench| bench.iter(|| predicates::insphere(black_box(a), b, c, d, p)));
    group.finish();
}

fn single_operations(c: &mut Criterion) {
    let points = uniform(101_000);
    let (first, rest) = points.split_at(100_000);
    let triangulation = triangulated(first);
    let mut group = c.benchmark_group("single");
    group.throughput(Throughput::Elements(rest.len() as u64)).sample_size(20);
    // Points anywhere: the walk is long without a hint.
    group.bench_function("locate", |bench| {
        bench.iter(|| rest.iter().filter(|&&p| triangulation.locate(p, None) == wellspaced::Location::Outside).count());
    });
    group.bench_function("insert", |bench| {
        bench.iter_batched_ref(
            || triangulation.clone(),
            |t| rest.iter().all(|&p| t.insert(p, None).expect("in range").is_new),
            BatchSize::LargeInput,
        );
    });
    group.bench_function("remove", |bench| {
        bench.iter_batched_ref(
            || triangulation.clone(),
            |t| (0..rest.len() as u32).for_each(|v| t.remove(v * 97).expect("a vertex")),
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

/// Points all around the origin, the same ones each time. Their distances from it differ by so little that all are its neighbours, and by so much that
/// filters decide nearly all tests.
fn all_around(n: usize) -> Vec<DVec3> {
    let mut next = random();
    let mut any = || (DVec3::new(next(), next(), next()) * 2.0 - 1.0, next());
    let inside = std::iter::repeat_with(&mut any).filter(|(p, _)| (0.1..=1.0).contains(&p.length()));
    inside.map(|(p, jitter)| p.normalize() * (1.0 + 1e-6 * jitter)).take(n).collect()
}

/// Removal of a vertex of a given degree: the centre of points all around, all of which are its neighbours, and whose own tetrahedra
/// take its star's place. Its insertion beside it, which makes the same star.
fn removal_by_degree(c: &mut Criterion) {
    let mut group = c.benchmark_group("degree");
    group.sample_size(10);
    for degree in [16, 64, 256, 1_024, 4_096, 16_384] {
        let around = triangulated(&all_around(degree));
        let mut with_centre = around.clone();
        let centre = with_centre.insert(DVec3::ZERO, None).expect("in range").vertex;
        group.throughput(Throughput::Elements(degree as u64));
        group.bench_function(BenchmarkId::new("remove", degree), |bench| {
            bench.iter_batched_ref(
                || with_centre.clone(),
                |t| t.remove(centre).expect("a vertex"),
                BatchSize::LargeInput,
            );
        });
        group.bench_function(BenchmarkId::new("insert", degree), |bench| {
            bench.iter_batched_ref(
                || around.clone(),
                |t| t.insert(DVec3::ZERO, None).expect("in range").is_new,
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

fn bulk(c: &mut Criterion) {
    let mut group = c.benchmark_group("bulk");
    group.sample_size(10);
    let sets = [
        ("uniform", uniform(1_000)),
        ("uniform", uniform(10_000)),
        ("uniform", uniform(100_000)),
        ("grid", grid(40, 1.0)),
        ("tenths", grid(40, 0.1)),
    ];
    for (name, points) in sets {
        group.throughput(Throughput::Elements(points.len() as u64));
        group.bench_with_input(BenchmarkId::new(name, points.len()), &points, |bench, points| {
            bench.iter(|| triangulated(points).tetrahedron_count());
        });
    }
    group.finish();
}

criterion_group!(kernel, predicates_of, single_operations, removal_by_degree, bulk);
criterion_main!(kernel);
