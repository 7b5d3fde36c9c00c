use super::*;
use crate::samples::numbers;
use crate::Mesh;

fn uniform(n: usize) -> Vec<DVec3> {
    let mut next = numbers(5);
    (0..n).map(|_| DVec3::new(next(), next(), next())).collect()
}

fn sphere(n: usize) -> Vec<DVec3> {
    let mut next = numbers(6);
    let mut points = Vec::new();
    while points.len() < n {
        let p = DVec3::new(next(), next(), next()) * 2.0 - 1.0;
        if p.length() > 0.1 && p.length() < 1.0 {
            points.push(p.normalize() * (0.999 + 0.002 * next()));
        }
    }
    points
}

/// A flat and long grid with a unit of its own.
fn grid([x, y, z]: [usize; 3], unit: f64) -> Vec<DVec3> {
    (0..x * y * z).map(|i| DVec3::new((i % x) as f64, (i / x % y) as f64, (i / x / y) as f64) * unit).collect()
}

/// Half of the points in tight clusters.
fn clustered(n: usize) -> Vec<DVec3> {
    let mut next = numbers(7);
    let mut points = uniform(n / 2);
    for i in 0..n - n / 2 {
        let centre = DVec3::new((i % 3) as f64, (i % 2) as f64, 0.25);
        points.push(centre + DVec3::new(next(), next(), next()) * 1e-6);
    }
    points
}

/// Every point more than once, in an order that mixes them.
fn duplicated(n: usize) -> Vec<DVec3> {
    let mut points = uniform(n / 3);
    points.extend_from_within(..);
    points.extend(grid([20, 30, 10], 0.04));
    points.extend_from_within(..n / 4);
    points
}

/// All that can be told of a triangulation, ids included.
#[derive(PartialEq)]
struct Everything {
    ids: Vec<u32>,
    points: Vec<[u64; 3]>,
    tets: Vec<[u32; 8]>,
    vertex_tet: Vec<u32>,
    free: Vec<u32>,
    last: u32,
}

fn everything(ids: Vec<u32>, t: &Triangulation) -> Everything {
    let tets = t.topology.tets.iter().map(|tet| {
        let mut all = [0; 8];
        all[..4].copy_from_slice(&tet.v);
        if tet.is_live() {
            all[4..].copy_from_slice(&tet.n);
        }
        all
    });
    Everything {
        ids,
        points: t.points.iter().map(|p| p.to_array().map(f64::to_bits)).collect(),
        tets: tets.collect(),
        vertex_tet: t.topology.vertex_tet.clone(),
        free: t.topology.free.clone(),
        last: t.last,
    }
}

#[test]
fn any_number_of_threads_makes_the_same_bytes() {
    let sets = [
        ("uniform", uniform(100_000)),
        ("sphere", sphere(100_000)),
        ("grid", grid([40, 50, 50], 1.0)),
        ("tenths", grid([400, 50, 5], 0.1)),
        ("clustered", clustered(100_000)),
        ("duplicated", duplicated(120_000)),
        ("one plane and a point", {
            let mut points = grid([400, 300, 1], 1.0);
            points.push(DVec3::new(7.5, 3.25, 2.0));
            points
        }),
    ];
    for (name, points) in sets {
        let run = |threads| {
            let mut t = Triangulation::new();
            t.set_threads(threads);
            let ids = t.insert_many(&points, &Control::new()).unwrap().unwrap();
            (ids, t)
        };
        let (ids, t) = run(1);
        assert_eq!(t.validate(3), Ok(()), "{name}");
        let free = t.topology.tets.len() - t.topology.live_count();
        assert!(free < t.topology.tets.len() / 4, "{name}: {free} of {} places are free", t.topology.tets.len());
        let one = everything(ids, &t);
        for threads in [2, 3, 8] {
            let (ids, t) = run(threads);
            assert!(everything(ids, &t) == one, "{name} on {threads} threads");
        }
    }
}

#[test]
fn threads_help_with_what_is_there_already() {
    let points = uniform(190_000);
    let run = |threads| {
        let mut t = Triangulation::new();
        t.set_threads(threads);
        t.insert_many(&points[..90_000], &Control::new()).unwrap().unwrap();
        for v in (0..500).map(|i| i * 7) {
            t.remove(v).unwrap();
        }
        let ids = t.insert_many(&points[80_000..], &Control::new()).unwrap().unwrap();
        (ids, t)
    };
    let (ids, t) = run(1);
    assert_eq!(t.validate(3), Ok(()));
    assert_eq!(ids[..10_000], (80_000..90_000).collect::<Vec<u32>>());
    let one = everything(ids, &t);
    let (ids, t) = run(3);
    assert!(everything(ids, &t) == one);
}

#[test]
fn a_mesh_has_threads_too() {
    let points = uniform(90_000);
    let views = [1, 0, 4].map(|threads| {
        let mut mesh = Mesh::new();
        mesh.set_threads(threads);
        mesh.insert(&points, None, &Control::new()).unwrap();
        mesh
    });
    let one = views[0].view();
    for mesh in &views[1..] {
        let view = mesh.view();
        assert!(view.tetrahedra == one.tetrahedra && view.neighbours == one.neighbours && view.points == one.points);
    }
}

#[test]
fn a_cancelled_insertion_leaves_what_was_there() {
    let points = uniform(150_000);
    for threads in [1, 3] {
        for end in [0.1, 0.6, 0.95] {
            let mut t = Triangulation::new();
            t.set_threads(threads);
            let ids = t.insert_many(&points[..1500], &Control::new()).unwrap().unwrap();
            let before = everything(ids.clone(), &t);
            let control = Control::with_progress(move |progress| progress.fraction < end);
            assert_eq!(t.insert_many(&points, &control), Ok(None), "{threads} {end}");
            assert!(everything(ids, &t) == before);
            // Cancelled by another thread.
            let control = Control::new();
            let other = control.clone();
            let canceller = std::thread::spawn(move || {
                std::thread::sleep(std::time::Duration::from_millis(30));
                other.cancel();
            });
            let result = t.insert_many(&points, &control).unwrap();
            canceller.join().unwrap();
            assert_eq!(t.vertex_count(), if result.is_some() { 150_000 } else { 1500 });
        }
    }
}

#[test]
fn progress_is_told_by_the_callers_thread_and_never_falls() {
    use std::sync::{Arc, Mutex};
    let points = duplicated(150_000);
    let caller = std::thread::current().id();
    let told = Arc::new(Mutex::new(Vec::new()));
    let record = Arc::clone(&told);
    let control = Control::with_progress(move |progress| {
        assert_eq!(std::thread::current().id(), caller);
        assert!(progress.vertices <= 150_000);
        record.lock().unwrap().push(progress.fraction);
        true
    });
    let mut t = Triangulation::new();
    t.set_threads(3);
    t.insert_many(&points, &control).unwrap().unwrap();
    let told = told.lock().unwrap();
    assert!(told.len() > 50 && told.is_sorted() && told[told.len() - 1] == 1.0);
}

#[test]
fn a_callback_that_panics_leaves_no_half_made_tetrahedra() {
    let points = uniform(150_000);
    let mut t = Triangulation::new();
    t.set_threads(2);
    let control = Control::with_progress(|progress| {
        assert!(progress.fraction < 0.6, "enough");
        true
    });
    let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| t.insert_many(&points, &control)));
    assert!(result.is_err());
    assert_eq!(t.topology.tets.len(), 0);
}
