use proptest::prelude::*;

use super::*;
use crate::samples::on_a_sphere;

fn mixed_point() -> impl Strategy<Value = DVec3> {
    let small = |n: i32| (0..n, 0..n, 0..n).prop_map(|(x, y, z)| DVec3::new(x as f64, y as f64, z as f64));
    prop_oneof![
        4 => small(4),
        1 => small(100),
        1 => small(2).prop_map(|p| p * 1e-7),
        2 => (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z): (f64, f64, f64)| DVec3::new(x, y, z)),
    ]
}

fn sorted_tets(t: &Triangulation) -> Vec<[u32; 4]> {
    let mut tets: Vec<[u32; 4]> = t
        .tetrahedra()
        .map(|mut v| {
            v.sort_unstable();
            v
        })
        .collect();
    tets.sort_unstable();
    tets
}

proptest! {
    #[test]
    fn every_insertion_keeps_the_invariants(points in prop::collection::vec(mixed_point(), 0..60)) {
        let mut t = Triangulation::new();
        for &p in &points {
            let before = t.vertex_count();
            let inserted = t.insert(p, None).unwrap();
            prop_assert_eq!(inserted.is_new, t.vertex_count() == before + 1);
            prop_assert_eq!(t.point(inserted.vertex), Some(p));
            prop_assert_eq!(t.validate(3), Ok(()));
        }
    }

    #[test]
    fn the_order_of_insertion_does_not_matter(points in prop::collection::vec(mixed_point(), 0..60)) {
        let mut one = Triangulation::new();
        for &p in &points {
            one.insert(p, None).unwrap();
        }
        let mut two = Triangulation::new();
        for &p in points.iter().rev() {
            two.insert(p, None).unwrap();
        }
        // Translate ids by coordinates.
        let to_one = |v: u32| (0..one.vertex_count() as u32).find(|&w| one.point(w) == two.point(v)).unwrap();
        let mut tets: Vec<[u32; 4]> = sorted_tets(&two).into_iter().map(|v| { let mut v = v.map(to_one); v.sort_unstable(); v }).collect();
        tets.sort_unstable();
        prop_assert_eq!(tets, sorted_tets(&one));
        prop_assert_eq!(one.dimension(), two.dimension());
    }
}

/// Enough points for the sorted path, duplicates among them.
fn many() -> Vec<DVec3> {
    let mut state = 7u64;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f64 / (1 << 24) as f64
    };
    let mut points: Vec<DVec3> = (0..3000).map(|_| DVec3::new(next(), next(), next())).collect();
    points.extend((0..10).flat_map(|x| {
        (0..10).flat_map(move |y| (0..10).map(move |z| DVec3::new(x as f64, y as f64, z as f64) * 0.125))
    }));
    points.extend_from_within(500..900);
    points
}

#[test]
fn bulk_insertion_numbers_points_by_first_occurrence() {
    let points = many();
    let mut bulk = Triangulation::new();
    let ids = bulk.insert_many(&points, &Control::new()).unwrap().unwrap();
    bulk.validate(3).unwrap();
    let mut single = Triangulation::new();
    let expected: Vec<u32> = points.iter().map(|&p| single.insert(p, None).unwrap().vertex).collect();
    assert_eq!(ids, expected);
    assert_eq!(bulk.points(), single.points());
    assert_eq!(sorted_tets(&bulk), sorted_tets(&single));
    // And on top of what is there.
    let mut twice = Triangulation::new();
    twice.insert_many(&points[..100], &Control::new()).unwrap().unwrap();
    let ids = twice.insert_many(&points, &Control::new()).unwrap().unwrap();
    assert_eq!(ids, expected);
    assert_eq!(sorted_tets(&twice), sorted_tets(&single));
}

#[test]
fn cancelling_leaves_everything_as_it_was() {
    let points = many();
    let mut t = Triangulation::new();
    t.insert_many(&points[..2000], &Control::new()).unwrap().unwrap();
    let before = sorted_tets(&t);
    let control = Control::with_progress(|progress| progress.fraction < 0.5);
    assert_eq!(t.insert_many(&points[2000..], &control), Ok(None));
    assert_eq!(t.vertex_count(), 2000);
    assert_eq!(sorted_tets(&t), before);
    assert_eq!(t.insert_many(&points[..1], &control), Ok(None), "a cancelled control stays cancelled");
    control.reset();
    assert_eq!(t.insert_many(&points[..1], &control), Ok(Some(vec![0])));
}

#[test]
fn bad_points_are_named_and_change_nothing() {
    let mut t = Triangulation::new();
    let points = [DVec3::ZERO, DVec3::ONE, DVec3::new(0.0, f64::NAN, 0.0)];
    assert!(matches!(t.insert_many(&points, &Control::new()), Err(Error::NotFinite { index: 2, .. })));
    assert_eq!((t.vertex_count(), t.dimension()), (0, -1));
    let far = DVec3::splat(1e80);
    assert!(matches!(t.insert(far, None), Err(Error::OutOfRange { index: 0, .. })));
}

#[test]
fn dimension_grows_with_the_points() {
    let mut t = Triangulation::new();
    assert_eq!(t.dimension(), -1);
    let steps = [([0, 0, 0], 0), ([1, 1, 1], 1), ([2, 2, 2], 1), ([0, 1, 0], 2), ([2, 3, 2], 2), ([0, 0, 5], 3)];
    for ([x, y, z], dimension) in steps {
        t.insert(DVec3::new(x as f64, y as f64, z as f64), None).unwrap();
        assert_eq!(t.dimension(), dimension);
        assert_eq!(t.tetrahedron_count() > 0, dimension == 3);
        t.validate(3).unwrap();
    }
    assert_eq!(t.insert(DVec3::new(-0.0, 0.0, 0.0), None).unwrap(), Inserted { vertex: 0, is_new: false });
}

#[test]
fn large_cavities_are_joined_by_sorting() {
    let mut points = on_a_sphere(600);
    points.push(DVec3::splat(1e-3));
    let mut t = Triangulation::new();
    for &p in &points {
        t.insert(p, None).unwrap();
    }
    t.validate(3).unwrap();
    assert!(t.topology.star(600).len() > 1000);
}

#[test]
fn an_insertion_with_a_large_cavity_can_be_cancelled_at_every_look() {
    let points = on_a_sphere(3000);
    let mut t = Triangulation::new();
    t.insert_many(&points, &Control::new()).unwrap().unwrap();
    let before = sorted_tets(&t);
    let (control, mut inserted) = (Control::new(), t.clone());
    let looks =
        control.looks(None, || assert_eq!(inserted.insert_many(&[DVec3::ZERO], &control), Ok(Some(vec![3000]))));
    assert!(looks > 30, "{looks}");
    // Lists grow in the first of two tries only. In the last looks the copy is given back, and nothing more is to be cancelled.
    let mut last = 0;
    loop {
        last += 1;
        let mut t = t.clone();
        let mut done = None;
        let made = control.looks(Some(last), || done = t.insert_many(&[DVec3::ZERO], &control).unwrap());
        if done.is_some() {
            break;
        }
        // A few of them see that nothing is to be given back now.
        assert!(made <= last + 8, "{made} of {last}");
        assert_eq!((t.vertex_count(), sorted_tets(&t)), (3000, before.clone()));
        t.validate(2).unwrap();
        assert_eq!(t.insert_many(&[DVec3::ZERO], &control), Ok(Some(vec![3000])));
        assert_eq!(sorted_tets(&t), sorted_tets(&inserted));
    }
    assert!(last + 5 > looks && last <= looks, "{last} of {looks}");
    inserted.validate(3).unwrap();
}

/// Some of them one by one, with a journal, more in bulk, on one thread and on two.
#[test]
fn insertions_with_a_large_cavity_among_them_can_be_cancelled() {
    let points = on_a_sphere(3000);
    let mut t = Triangulation::new();
    t.insert_many(&points, &Control::new()).unwrap().unwrap();
    let before = sorted_tets(&t);
    let near = |count: usize| on_a_sphere(count).into_iter().map(|p| p * 0.9).collect::<Vec<_>>();
    for (more, threads) in [(near(20), 1), (near(1100), 1), (near(1100), 2)] {
        let more = [&more[..5], &[DVec3::ZERO], &more[5..], &[DVec3::splat(0.01)]].concat();
        t.set_threads(threads);
        let control = Control::new();
        let mut inserted = t.clone();
        let looks = control.looks(None, || assert!(inserted.insert_many(&more, &control).unwrap().is_some()));
        inserted.validate(3).unwrap();
        for last in (1..looks).step_by(looks / 60 + 1) {
            let mut t = t.clone();
            let mut done = None;
            control.looks(Some(last), || done = t.insert_many(&more, &control).unwrap());
            if done.is_some() {
                // All was there, and what was kept is given back.
                assert!(last + 20 > looks, "{last} of {looks}");
                continue;
            }
            assert_eq!((t.vertex_count(), sorted_tets(&t)), (3000, before.clone()), "look {last} of {looks}");
            t.validate(2).unwrap();
            assert!(t.insert_many(&more, &control).unwrap().is_some());
            assert_eq!(sorted_tets(&t), sorted_tets(&inserted));
        }
    }
}

/// Points in line that two others make tetrahedra of, one beside the other: from one end to the other it is as many steps.
#[test]
fn an_insertion_can_be_cancelled_on_a_long_walk() {
    let mut points: Vec<DVec3> = (0..70_000).map(|i| DVec3::new(f64::from(i), 0.0, 0.0)).collect();
    points.extend([DVec3::new(35_000.0, 1e5, 0.0), DVec3::new(35_000.0, 0.0, 1e5)]);
    let mut t = Triangulation::new();
    t.insert_many(&points, &Control::new()).unwrap().unwrap();
    let end = DVec3::new(69_998.5, 0.125, 0.125);
    let start = t.finite_at(t.topology.vertex_tet[0]);
    let control = Control::new();
    // With memory of its own, or with what a search before it has left.
    let mut cavity = Cavity::default();
    for is_new in [true, false] {
        let fresh = |cavity: &mut Cavity| {
            if is_new {
                *cavity = Cavity::default();
            }
        };
        t.prepare(end, start, &mut cavity, &control).unwrap();
        fresh(&mut cavity);
        let looks = control.looks(None, || t.prepare(end, start, &mut cavity, &control).unwrap());
        assert!(looks >= 4, "{looks}");
        for last in 1..=looks {
            fresh(&mut cavity);
            let made = control.looks(Some(last), || {
                let ended = Err(Unplaced::Ended(Error::Cancelled));
                assert_eq!(t.prepare(end, start, &mut cavity, &control), ended, "look {last}");
            });
            // What memory was made is given back, with more looks.
            assert!(made == last || is_new && made > last, "{made}, {last}");
        }
    }
    t.prepare(end, start, &mut cavity, &control).unwrap();
    let vertex = t.insert_into(end, &mut cavity, &Control::new()).unwrap();
    assert_eq!(t.locate(end, Some(0)), crate::Location::Vertex(vertex));
}

#[test]
fn locations() {
    use crate::Location;
    let mut t = Triangulation::new();
    for i in 0..8 {
        t.insert(DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64) * 2.0, None).unwrap();
    }
    assert_eq!(t.locate(DVec3::new(2.0, 0.0, 2.0), None), Location::Vertex(5));
    assert!(matches!(t.locate(DVec3::new(1.0, 0.0, 0.0), None), Location::Edge(e) if e.contains(&0) && e.contains(&1)));
    assert!(matches!(t.locate(DVec3::new(0.5, 0.75, 0.0), Some(7)), Location::Face(_)));
    assert!(matches!(t.locate(DVec3::new(0.1, 0.2, 0.35), None), Location::Tetrahedron(_)));
    assert_eq!(t.locate(DVec3::splat(3.0), None), Location::Outside);
    assert_eq!(t.locate(DVec3::splat(f64::NAN), None), Location::Outside);
    assert_eq!(t.locate(DVec3::splat(1e300), None), Location::Outside);
}
