//! How long calls go on after they have been cancelled from another thread: `cargo bench --bench cancel -- [POINTS...] [NAME...]`. A name is a part of what a line
//! begins with, and leaves all others out. For each call the longest of some moments, spread over its time, by the clock and in processor time of the whole process: the latter is what counts on a machine that does other things
//! meanwhile.
//!
//! With `RUSTFLAGS="--cfg wellspaced_gaps"` each call is made once instead, and all times of two milliseconds and more between two looks at the control
//! are measured, by the clock; for the longest of those above six, where they begin and the functions at the end.

use std::time::{Duration, Instant};

use wellspaced::host::{sample_arrays, ArrayOptions, Arrays};
use wellspaced::{Control, DVec3, Mesh, Plc, PlcFacet, PlcSegment, RefineOptions, Sparsify};

fn scattered(count: usize) -> Vec<DVec3> {
    let mut state = 7u64;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| DVec3::new(next(), next(), next())).collect()
}

/// The process's processor time.
fn processor() -> Duration {
    #[repr(C)]
    struct Timespec {
        seconds: i64,
        nanoseconds: i64,
    }
    extern "C" {
        fn clock_gettime(clock: i32, time: *mut Timespec) -> i32;
    }
    const CLOCK_PROCESS_CPUTIME_ID: i32 = 2;
    let mut time = Timespec { seconds: 0, nanoseconds: 0 };
    // SAFETY: a struct that the call fills.
    unsafe { clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    Duration::new(time.seconds as u64, time.nanoseconds as u32)
}

/// Cancels `call` after `wait`; how long it went on then, in processor time and by the clock, or `None` if it was done before.
fn latency<R>(wait: Duration, call: impl FnOnce(&Control) -> R) -> Option<(Duration, Duration)> {
    let control = Control::new();
    let remote = control.clone();
    let (sender, receiver) = std::sync::mpsc::channel();
    let canceller = std::thread::spawn(move || {
        std::thread::sleep(wait);
        let at = (processor(), Instant::now());
        remote.cancel();
        let _ = sender.send(at);
    });
    let result = call(&control);
    let end = (processor(), Instant::now());
    let cancelled = receiver.try_recv().ok();
    drop(result);
    canceller.join().unwrap();
    cancelled.map(|at| (end.0.saturating_sub(at.0), end.1.saturating_duration_since(at.1)))
}

/// Whether a case of this name is asked for.
fn is_wanted(name: &str) -> bool {
    let mut names =
        std::env::args().skip(1).filter(|name| !name.starts_with('-') && name.parse::<usize>().is_err()).peekable();
    names.peek().is_none() || names.any(|part| name.contains(&part))
}

/// What a call does between two looks at the control.
#[cfg(wellspaced_gaps)]
fn gaps<R>(name: &str, call: impl FnOnce() -> R) {
    const LONG: Duration = Duration::from_millis(6);
    let start = Instant::now();
    let mut result = None;
    let gaps = wellspaced::gaps::gaps(LONG / 3, || result = Some(call()));
    let whole = start.elapsed();
    drop(result);
    let longest = gaps.first().map_or(LONG / 3, |gap| gap.length);
    let long = gaps.iter().filter(|gap| gap.length >= LONG);
    println!("{name:<44} {whole:>8.1?} in all, longest {longest:>8.1?}, {} above {LONG:?}", long.clone().count());
    for gap in long.take(4) {
        let functions = gap.functions.iter().take(5);
        let short = functions.map(|name| name.split("::h").next().unwrap_or(name).replace("wellspaced::", ""));
        let from = gap.from.map_or(String::from("the beginning"), ToString::to_string);
        println!("    {:>8.1?} from {from} to {}", gap.length, short.collect::<Vec<_>>().join(" < "));
    }
}

#[cfg(not(wellspaced_gaps))]
fn gaps<R>(_: &str, _: impl FnOnce() -> R) {}

/// Measures at `moments` moments of a call that takes `whole`.
/// What the call returns is not its own to give back.
fn measure<T, R>(name: &str, moments: u32, fresh: impl Fn() -> T, call: impl Fn(&mut T, &Control) -> R) {
    if !is_wanted(name) {
        return;
    }
    let mut subject = fresh();
    if cfg!(wellspaced_gaps) {
        return gaps(name, || call(&mut subject, &Control::new()));
    }
    let start = Instant::now();
    let result = call(&mut subject, &Control::new());
    let whole = start.elapsed();
    drop((result, subject));
    let (mut worst, mut clock) = ((Duration::ZERO, Duration::ZERO), Duration::ZERO);
    let mut all = Vec::new();
    for moment in 0..moments {
        let wait = whole * (2 * moment + 1) / (2 * moments);
        let mut subject = fresh();
        if let Some((late, by_clock)) = latency(wait, |control| call(&mut subject, control)) {
            worst = worst.max((late, wait));
            clock = clock.max(by_clock);
            all.push(late);
        }
    }
    all.sort();
    let median = all.get(all.len() / 2).copied().unwrap_or_default();
    let moments = all.len();
    println!(
        "{name:<44} {whole:>8.1?} in all, {moments:>2} moments: median {median:>8.1?}, longest {:>8.1?} at {:.1?}; clock {clock:.1?}",
        worst.0, worst.1
    );
}

/// What has large stars, large facets, or nearly is flat.
fn adverse() {
    // A vertex with all others around it.
    for count in [100_000, 1_000_000] {
        let on_sphere = |p: DVec3| (p * 2.0 - 1.0).normalize();
        let around: Vec<DVec3> = scattered(count).into_iter().map(on_sphere).collect();
        let mut hollow = Mesh::new();
        hollow.insert(&around, None, &Control::new()).unwrap();
        let fresh = || hollow.try_clone(&Control::new()).unwrap();
        measure(&format!("insert the centre of {count}"), 24, fresh, |mesh, control| {
            mesh.insert(&[DVec3::ZERO], None, control).unwrap();
        });
        let mut sphere = hollow.try_clone(&Control::new()).unwrap();
        sphere.insert(&[DVec3::ZERO], None, &Control::new()).unwrap();
        drop(hollow);
        let fresh = || sphere.try_clone(&Control::new()).unwrap();
        measure(&format!("remove the centre of {count}"), 24, fresh, |mesh, control| {
            let _ = mesh.remove_within(count as u32, control);
        });
        let limits = RefineOptions { max_vertices: count + 100, ..RefineOptions::default() };
        measure(&format!("refine around the centre of {count}"), 24, fresh, |mesh, control| {
            mesh.refine(&limits, control).unwrap();
        });
    }
    // A surface of a million triangles, a torus with bumps.
    let side = 707u32;
    let turn = |i: u32| f64::from(i) / f64::from(side) * std::f64::consts::TAU;
    let bumpy = |i: u32| {
        let ((sin, cos), (sin_small, cos_small)) = (turn(i / side).sin_cos(), turn(i % side).sin_cos());
        let radius = 1.0 + 0.05 * (7.0 * turn(i / side)).sin() * (5.0 * turn(i % side)).cos();
        let out = 3.0 + radius * cos_small;
        DVec3::new(out * cos, out * sin, radius * sin_small)
    };
    let at = |i: u32, j: u32| (i % side) * side + j % side;
    let facet = |polygon: [u32; 3]| PlcFacet { polygons: vec![polygon.to_vec()], ..PlcFacet::default() };
    let facets = (0..side * side).flat_map(|k| {
        let (i, j) = (k / side, k % side);
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        [[a, b, c], [a, c, d]].map(facet)
    });
    let torus = Plc { points: (0..side * side).map(bumpy).collect(), facets: facets.collect(), ..Plc::default() };
    let nothing = || ();
    measure("a torus of 999698 triangles", 6, nothing, |(), control| Mesh::from_plc(&torus, control));
    let mesh = Mesh::from_plc(&torus, &Control::new()).unwrap();
    let fresh = || mesh.try_clone(&Control::new()).unwrap();
    let limits = RefineOptions { max_vertices: mesh.view().points.len() + 20_000, ..RefineOptions::default() };
    measure("refine the torus, begun", 12, fresh, |mesh, control| {
        mesh.refine(&limits, control).unwrap();
    });
    measure("clone the torus", 12, nothing, |(), control| mesh.try_clone(control));
    drop(mesh);
    // A plane grid and one vertex that sees all of it.
    let grid = (0..1_000_000).map(|i| DVec3::new((i % 1000) as f64, (i / 1000) as f64, 0.0));
    let grid: Vec<DVec3> = grid.chain([DVec3::new(500.3, 500.7, 1e6)]).collect();
    measure("insert a grid of 1000000 and an apex", 24, Mesh::new, |mesh, control| {
        mesh.insert(&grid, None, control).unwrap();
    });
}

/// Boundaries that are beside a vertex with all others around it, or that have very many vertices.
fn boundaries(count: usize) {
    let (low, high) = (DVec3::splat(-2.0), DVec3::splat(2.0));
    let centre = count as u32;
    // What is near the centre is encroached upon by one point more.
    let at_centre = |case: &str, elements: &dyn Fn(&mut Plc)| {
        let names = ["make", "split", "refine"].map(|call| format!("{call} {case} at the centre of {count}"));
        if !names.iter().any(|name| is_wanted(name)) {
            return;
        }
        let around = scattered(count).into_iter().map(|p| (p * 2.0 - 1.0).normalize());
        let mut plc = Plc::boxed(low, high, []);
        let corners = plc.points.len() as u32;
        plc.facets.iter_mut().flat_map(|facet| &mut facet.polygons).flatten().for_each(|v| *v += centre + 1);
        plc.points.splice(0..0, around.chain([DVec3::ZERO]));
        assert_eq!(plc.points.len() as u32, centre + 1 + corners);
        elements(&mut plc);
        measure(&names[0], 12, || (), |(), control| Mesh::from_plc(&plc, control));
        let mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let fresh = || mesh.try_clone(&Control::new()).unwrap();
        for (name, sparsify, more) in [(&names[1], Some(Sparsify::Off), 4), (&names[2], None, 100)] {
            let limits =
                RefineOptions { max_vertices: mesh.view().points.len() + more, sparsify, ..RefineOptions::default() };
            measure(name, 48, fresh, |mesh, control| {
                mesh.refine(&limits, control).unwrap();
            });
        }
    };
    at_centre("a segment", &|plc| {
        let end = plc.points.len() as u32;
        plc.points.extend([DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.25, 0.1, 0.01)]);
        plc.segments.push(PlcSegment { ends: [centre, end], ..PlcSegment::default() });
    });
    at_centre("a triangle", &|plc| {
        let end = plc.points.len() as u32;
        plc.points.extend([DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.1, 0.4, 0.0), DVec3::new(0.2, 0.15, 0.01)]);
        plc.facets.push(PlcFacet { polygons: vec![vec![centre, end, end + 1]], ..PlcFacet::default() });
    });
    // One just above the other: a split of one takes out some of the other.
    at_centre("two fans", &|plc| {
        for height in [0.0, 0.01] {
            let hub = if height > 0.0 { plc.points.len() as u32 } else { centre };
            plc.points.extend((height > 0.0).then_some(DVec3::Z * height));
            let first = plc.points.len() as u32;
            let angles = (0..6).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_3 + height);
            plc.points.extend(angles.map(|angle| DVec3::new(0.5 * angle.cos(), 0.5 * angle.sin(), height)));
            let triangle =
                |i| PlcFacet { polygons: vec![vec![hub, first + i, first + (i + 1) % 6]], ..PlcFacet::default() };
            plc.facets.extend((0..6).map(triangle));
        }
    });
    // A facet all of whose triangles are in one circle.
    let sides = count as u32 / 10;
    let names = ["make", "split"].map(|call| format!("{call} a cylinder with {sides} sides"));
    if names.iter().any(|name| is_wanted(name)) {
        let corner = |k: u32| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k % sides) / f64::from(sides)).sin_cos();
            DVec3::new(cos, sin, if k < sides { 0.0 } else { 2.0 })
        };
        let quads = (0..sides).map(|k| vec![k, (k + 1) % sides, sides + (k + 1) % sides, sides + k]);
        let polygons = quads.chain([(0..sides).collect(), (sides..2 * sides).collect()]);
        let facets = polygons.map(|polygon| PlcFacet { polygons: vec![polygon], ..PlcFacet::default() }).collect();
        let plc = Plc { points: (0..2 * sides).map(corner).collect(), facets, ..Plc::default() };
        measure(&names[0], 12, || (), |(), control| Mesh::from_plc(&plc, control));
        let mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let fresh = || mesh.try_clone(&Control::new()).unwrap();
        let max_vertices = mesh.view().points.len() + 4;
        let limits = RefineOptions { max_vertices, sparsify: Some(Sparsify::Off), ..RefineOptions::default() };
        measure(&names[1], 48, fresh, |mesh, control| {
            mesh.refine(&limits, control).unwrap();
        });
    }
    // A box with half of them on one of its sides.
    let names = ["make", "refine", "split"].map(|call| format!("{call} a side with {}", count / 2));
    if names.iter().any(|name| is_wanted(name)) {
        let on_side = |p: DVec3| (4.0 * p - 2.0).with_z(-2.0);
        let plc = Plc::boxed(low, high, scattered(count / 2).into_iter().map(on_side));
        measure(&names[0], 24, || (), |(), control| Mesh::from_plc(&plc, control));
        let mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let fresh = || mesh.try_clone(&Control::new()).unwrap();
        for (name, sparsify) in [(&names[1], None), (&names[2], Some(Sparsify::Off))] {
            let limits =
                RefineOptions { max_vertices: mesh.view().points.len() + 4_000, sparsify, ..RefineOptions::default() };
            measure(name, 24, fresh, |mesh, control| {
                mesh.refine(&limits, control).unwrap();
            });
        }
    }
}

fn main() {
    let counts: Vec<usize> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let counts = if counts.is_empty() { vec![1_000_000, 3_000_000] } else { counts };
    for count in counts {
        let points = scattered(count);
        // Looks of threads other than this one are not seen.
        for threads in 1..if cfg!(wellspaced_gaps) { 2 } else { 3 } {
            let fresh = || {
                let mut mesh = Mesh::new();
                mesh.set_threads(threads);
                mesh
            };
            measure(&format!("insert {count}, {threads} threads"), 12, fresh, |mesh, control| {
                mesh.insert(&points, None, control).unwrap();
            });
        }
        let mut mesh = Mesh::new();
        mesh.insert(&points, None, &Control::new()).unwrap();
        measure(
            &format!("validate {count}"),
            6,
            || (),
            |(), control| {
                mesh.validate_within(3, control).unwrap();
            },
        );
        measure(
            &format!("view {count}"),
            6,
            || mesh.try_clone(&Control::new()).unwrap(),
            |mesh, control| mesh.try_view(control).is_ok(),
        );
        measure(
            &format!("boundary {count}"),
            6,
            || mesh.try_clone(&Control::new()).unwrap(),
            |mesh, control| {
                mesh.use_hull_as_domain().unwrap();
                mesh.try_boundary_view(control).is_ok()
            },
        );
        measure(&format!("clone {count}"), 6, || (), |(), control| mesh.try_clone(control));
        let more = scattered(10_000);
        measure(
            &format!("insert 10000 more into {count}"),
            6,
            || mesh.try_clone(&Control::new()).unwrap(),
            |mesh, control| {
                mesh.insert(&more, None, control).unwrap();
            },
        );
        let few = &more[..1000];
        measure(
            &format!("insert 1000 more into {count}"),
            6,
            || mesh.try_clone(&Control::new()).unwrap(),
            |mesh, control| {
                mesh.insert(few, None, control).unwrap();
            },
        );
        measure(
            &format!("hull of {count} as domain"),
            6,
            || mesh.try_clone(&Control::new()).unwrap(),
            |mesh, control| mesh.use_hull_as_domain_within(control),
        );
        measure(
            &format!("bad short edges of {count}"),
            6,
            || (),
            |(), control| mesh.bad_short_edges_within(2.0, control),
        );
        let view = mesh.view();
        let (points, tetrahedra, neighbours) = (view.points, view.tetrahedra, view.neighbours);
        for neighbours in [neighbours, &[]] {
            let arrays = Arrays { points, tetrahedra, neighbours, ..Arrays::default() };
            measure(
                &format!("a round on arrays of {count}, {} neighbours", neighbours.len()),
                8,
                || (),
                |(), control| sample_arrays(&arrays, &ArrayOptions::default(), control),
            );
        }
        let limits = RefineOptions { max_vertices: count + count / 20, ..RefineOptions::default() };
        measure(
            &format!("refine {count}, begun"),
            24,
            || mesh.try_clone(&Control::new()).unwrap(),
            |mesh, control| {
                mesh.refine(&limits, control).unwrap();
            },
        );
        drop(mesh);
        boundaries(count);
    }
    adverse();
    let flat = |p: DVec3| p.with_z(0.0);
    let points: Vec<DVec3> = scattered(1_000_000).into_iter().map(flat).collect();
    measure("insert 1000000 in a plane", 8, Mesh::new, |mesh, control| {
        mesh.insert(&points, None, control).unwrap();
    });
    let on_ellipsoid = |p: DVec3| (p * 2.0 - 1.0).normalize() * DVec3::new(0.8, 0.5, 0.35);
    let plc = Plc::boxed(DVec3::splat(-1.0), DVec3::splat(1.0), scattered(10_000).into_iter().map(on_ellipsoid));
    let fresh = || Mesh::from_plc(&plc, &Control::new()).unwrap();
    let options = RefineOptions { radius_edge: 1.1, max_vertices: 150_000, ..RefineOptions::default() };
    measure("refine an ellipsoid, bound 1.1", 24, fresh, |mesh, control| {
        mesh.refine(&options, control).unwrap();
    });
    let mut refined = fresh();
    refined.refine(&RefineOptions { sparsify: Some(Sparsify::Off), ..options }, &Control::new()).unwrap();
    let fresh = || refined.try_clone(&Control::new()).unwrap();
    measure("sparsify it, bound 2", 24, fresh, |mesh, control| {
        mesh.sparsify(2.0, Sparsify::Quick, control).unwrap();
    });
    let points = scattered(1_000_000);
    let box_of = Plc::boxed(DVec3::splat(-1.0), DVec3::splat(2.0), points);
    measure("a box with 1000000 points", 16, || (), |(), control| Mesh::from_plc(&box_of, control));
}
