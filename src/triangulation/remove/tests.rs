use proptest::prelude::*;
use rustc_hash::FxHashMap;

use super::*;
use crate::samples::on_a_sphere;
use crate::triangulation::topology::slot_of;
use crate::Control;

type Cells = Vec<[[u64; 3]; 4]>;

/// The tetrahedra by their corners' coordinates, which don't depend on numbers.
fn shape(t: &Triangulation) -> Cells {
    let key = |v: u32| (t.at(v) + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut cells: Cells = t
        .tetrahedra()
        .map(|v| {
            let mut corners = v.map(key);
            corners.sort_unstable();
            corners
        })
        .collect();
    cells.sort_unstable();
    cells
}

/// Whether a triangulation is what its points alone would give.
fn check(t: &Triangulation) -> Result<(), TestCaseError> {
    prop_assert_eq!(t.validate(3), Ok(()));
    let points: Vec<DVec3> = t.vertices().map(|v| t.at(v)).collect();
    prop_assert_eq!(points.len(), t.vertex_count());
    prop_assert_eq!(t.points().len(), t.vertex_slots());
    let mut fresh = Triangulation::new();
    fresh.insert_many(&points, &Control::new()).unwrap().unwrap();
    prop_assert_eq!(fresh.vertex_count(), points.len());
    prop_assert_eq!(fresh.dimension(), t.dimension());
    prop_assert_eq!(fresh.hull().count(), t.hull().count());
    prop_assert_eq!(shape(&fresh), shape(t));
    Ok(())
}

fn grid(n: i32) -> impl Strategy<Value = DVec3> {
    (0..n, 0..n, 0..n).prop_map(|(x, y, z)| DVec3::new(x as f64, y as f64, z as f64))
}

fn uniform() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z): (f64, f64, f64)| DVec3::new(x, y, z))
}

/// Permutations and signs of (2, 3, 6) and (0, 0, 7): 54 points on the sphere of radius 7.
fn cospherical() -> impl Strategy<Value = DVec3> {
    (0..9usize, 0..8u32).prop_map(|(i, signs)| {
        let base =
            [[2, 3, 6], [2, 6, 3], [3, 2, 6], [3, 6, 2], [6, 2, 3], [6, 3, 2], [0, 0, 7], [0, 7, 0], [7, 0, 0]][i];
        let sign = |axis: usize| if signs >> axis & 1 == 1 { -1.0 } else { 1.0 };
        DVec3::new(base[0] as f64 * sign(0), base[1] as f64 * sign(1), base[2] as f64 * sign(2))
    })
}

/// A plane, and now and then a point off it.
fn nearly_flat() -> impl Strategy<Value = DVec3> {
    prop_oneof![9 => (0..5, 0..5).prop_map(|(x, y)| DVec3::new(x as f64, y as f64, 1.0)), 1 => grid(3)]
}

fn collinear_mostly() -> impl Strategy<Value = DVec3> {
    prop_oneof![9 => (0..9).prop_map(|x| DVec3::splat(x as f64)), 2 => grid(2)]
}

#[derive(Clone, Debug)]
enum Step {
    Insert(DVec3),
    Bulk(Vec<DVec3>),
    Remove(prop::sample::Index),
    Replace(Vec<prop::sample::Index>, Option<DVec3>),
    Compact,
}

fn steps(point: impl Strategy<Value = DVec3> + 'static, most: usize) -> impl Strategy<Value = Vec<Step>> {
    let point = point.boxed();
    let index = any::<prop::sample::Index>;
    let step = prop_oneof![
        6 => point.clone().prop_map(Step::Insert),
        1 => prop::collection::vec(point.clone(), 2..12).prop_map(Step::Bulk),
        6 => index().prop_map(Step::Remove),
        3 => (prop::collection::vec(index(), 0..4), prop::option::of(point)).prop_map(|(r, a)| Step::Replace(r, a)),
        1 => Just(Step::Compact),
    ];
    prop::collection::vec(step, 0..most)
}

fn run(steps: &[Step]) -> Result<(), TestCaseError> {
    let mut t = Triangulation::new();
    let mut hole = Hole::default();
    // What each id should be.
    let mut known: FxHashMap<u32, DVec3> = FxHashMap::default();
    for step in steps {
        let slots = t.vertex_slots();
        let mut ids: Vec<u32> = known.keys().copied().collect();
        ids.sort_unstable();
        match step {
            Step::Insert(p) => {
                let free = t.next_vertex();
                let inserted = t.insert(*p, None).unwrap();
                prop_assert_eq!(inserted.is_new, known.insert(inserted.vertex, *p).is_none());
                prop_assert!(!inserted.is_new || inserted.vertex == free);
            }
            Step::Bulk(points) => {
                let new = t.insert_many(points, &Control::new()).unwrap().unwrap();
                for (&v, &p) in new.iter().zip(points) {
                    prop_assert!(known.insert(v, p).is_none_or(|before| before == p));
                    prop_assert!(ids.contains(&v) || v as usize >= slots);
                }
            }
            Step::Remove(index) => {
                if ids.is_empty() {
                    prop_assert_eq!(t.remove(3), Err(Error::NoSuchVertex { vertex: 3 }));
                    continue;
                }
                let v = *index.get(&ids);
                t.remove(v).unwrap();
                known.remove(&v);
                prop_assert_eq!(t.point(v), None);
                prop_assert_eq!(t.remove(v), Err(Error::NoSuchVertex { vertex: v }));
            }
            Step::Replace(remove, add) => {
                let remove: Vec<u32> = remove.iter().filter(|_| !ids.is_empty()).map(|i| *i.get(&ids)).collect();
                let before = (shape(&t), t.tetrahedron_count() as i64);
                let result = t.preview(&Replacement { remove: &remove, add: *add }, &|_| false, &mut hole);
                prop_assert_eq!(&before.0, &shape(&t), "a preview changes nothing");
                let taken = known.iter().find(|&(v, p)| Some(*p) == *add && !remove.contains(v));
                if let Some((&vertex, _)) = taken {
                    prop_assert_eq!(result, Err(Error::Occupied { vertex }));
                    continue;
                }
                prop_assert_eq!(result, Ok(()));
                let finite = |v: &[u32; 4]| i64::from(v[3] != GHOST);
                let was_space = t.dimension() == 3;
                let change = hole.coming.iter().map(|c| finite(&c.v)).sum::<i64>()
                    - hole.going.iter().map(|g| finite(&g.v)).sum::<i64>();
                for coming in &hole.coming {
                    let corners = t.coming_corners(&hole, coming);
                    prop_assert_eq!(corners.is_some(), coming.v[3] != GHOST);
                    prop_assert!(corners.is_none_or(|[a, b, c, d]| orient3d(a, b, c, d) == Sign::Positive));
                }
                let comes: Vec<[u32; 4]> = hole.coming.iter().map(|c| c.v).collect();
                let new = t.replace(&mut hole).unwrap();
                prop_assert_eq!(new.is_some(), add.is_some());
                for v in &remove {
                    known.remove(v);
                }
                if let (Some(v), Some(p)) = (new, add) {
                    prop_assert_eq!(known.insert(v, *p), None);
                }
                if was_space {
                    prop_assert_eq!(t.tetrahedron_count() as i64, before.1 + change);
                    for (mut v, &created) in comes.into_iter().zip(&hole.created) {
                        v.iter_mut().filter(|v| **v == ADDED).for_each(|v| *v = new.unwrap());
                        prop_assert_eq!(t.topology.tet(created).v, v);
                    }
                }
            }
            Step::Compact => {
                let map = t.compact();
                prop_assert_eq!(map.len(), slots);
                prop_assert_eq!(t.vertex_slots(), t.vertex_count());
                prop_assert!((0..slots as u32).all(|v| (map[v as usize] == NONE) != known.contains_key(&v)));
                known = known.into_iter().map(|(v, p)| (map[v as usize], p)).collect();
                let mut order: Vec<u32> = map.into_iter().filter(|&v| v != NONE).collect();
                prop_assert!(order.is_sorted());
                order.dedup();
                prop_assert_eq!(order.len(), known.len());
            }
        }
        prop_assert_eq!(t.vertex_count(), known.len());
        for (&v, &p) in &known {
            prop_assert_eq!(t.point(v), Some(p));
        }
        check(&t)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn uniform_points(steps in steps(uniform(), 60)) { run(&steps)?; }

    #[test]
    fn grid_of_two(steps in steps(grid(2), 60)) { run(&steps)?; }

    #[test]
    fn grid_of_three(steps in steps(grid(3), 80)) { run(&steps)?; }

    #[test]
    fn points_on_a_sphere(steps in steps(cospherical(), 80)) { run(&steps)?; }

    #[test]
    fn points_in_a_plane_and_one(steps in steps(nearly_flat(), 60)) { run(&steps)?; }

    #[test]
    fn points_on_a_line_and_some(steps in steps(collinear_mostly(), 50)) { run(&steps)?; }
}

fn whole_grid(n: usize) -> Triangulation {
    let points: Vec<DVec3> =
        (0..n * n * n).map(|i| DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64)).collect();
    let mut t = Triangulation::new();
    t.insert_many(&points, &Control::new()).unwrap().unwrap();
    t
}

/// Empties it in an order, with a full check now and then.
fn empty(mut t: Triangulation, order: impl Iterator<Item = u32>, every: usize) {
    for (i, v) in order.enumerate() {
        t.remove(v).unwrap();
        if i % every == 0 || t.vertex_count() < 40 {
            check(&t).unwrap();
        }
    }
    assert_eq!((t.vertex_count(), t.dimension(), t.tetrahedron_count()), (0, -1, 0));
}

#[test]
fn grids_emptied_one_by_one() {
    for n in 2..=4 {
        let count = (n * n * n) as u32;
        empty(whole_grid(n), 0..count, 1);
        empty(whole_grid(n), (0..count).rev(), 1);
    }
    // A step prime to the number: all over the place.
    empty(whole_grid(12), (0..1728).map(|i| i * 605 % 1728), 150);
    empty(whole_grid(12), 0..1728, 150);
}

#[test]
fn a_hub_of_high_degree() {
    // More neighbours than are inserted in their own order.
    let mut t = Triangulation::new();
    for p in on_a_sphere(1000) {
        t.insert(p, None).unwrap();
    }
    let hub = t.insert(DVec3::splat(1e-3), None).unwrap().vertex;
    t.remove(hub).unwrap();
    check(&t).unwrap();
}

#[test]
fn the_removal_of_a_hub_can_be_cancelled() {
    let mut t = Triangulation::new();
    t.insert_many(&on_a_sphere(3000), &Control::new()).unwrap().unwrap();
    let hub = t.insert(DVec3::splat(1e-3), None).unwrap().vertex;
    t.topology.region = vec![3; t.topology.tets.len()];
    let before = (shape(&t), t.topology.region.clone());
    let (control, mut removed) = (Control::new(), t.clone());
    let looks = control.looks(None, || removed.remove_within(hub, &control).unwrap());
    check(&removed).unwrap();
    assert!(looks > 3000, "{looks}");
    // Every step on the way, and each look of the end, where tetrahedra come and go.
    for last in (1..looks).filter(|last| last % 211 == 0 || last + 80 > looks) {
        let mut t = t.clone();
        let mut done = Ok(());
        let made = control.looks(Some(last), || done = t.remove_within(hub, &control));
        if done.is_ok() {
            // The copy is given back.
            assert!(last + 5 > looks, "{last} of {looks}");
            continue;
        }
        assert_eq!(done, Err(Error::Cancelled));
        assert!(made <= last + 3, "{made} of {last}");
        assert_eq!((shape(&t), &t.topology.region), (before.0.clone(), &before.1), "look {last} of {looks}");
        t.validate(2).unwrap();
        t.remove(hub).unwrap();
        assert!(shape(&t) == shape(&removed));
    }
}

#[test]
fn slots_are_used_again() {
    let mut t = whole_grid(5);
    let tets = t.topology.tets.len();
    for round in 0..20 {
        let v = 31 + round;
        let p = t.point(v).unwrap();
        t.remove(v).unwrap();
        assert_eq!((t.vertex_count(), t.vertex_slots()), (124, 125));
        assert!(t.points()[v as usize].is_nan());
        assert_eq!(t.insert(p, None).unwrap().vertex, v);
    }
    assert_eq!(t.vertex_slots(), 125);
    // Some more than before while both old and new stand side by side, no more with every round.
    assert!(t.topology.tets.len() < tets + 60);
    check(&t).unwrap();
}

#[test]
fn labels_spread_from_the_hole() {
    // Two regions on both sides of a plane; the other layers are far from it, so that no edge comes to cross it.
    let mut t = Triangulation::new();
    for i in 0..125 {
        t.insert(DVec3::new((i % 5 * 3) as f64, (i / 5 % 5) as f64, (i / 25) as f64), None).unwrap();
    }
    let side = |t: &Triangulation, v: [u32; 4]| {
        if v[3] == GHOST {
            OUTSIDE
        } else if v.iter().all(|&v| t.at(v).x <= 6.0) {
            7
        } else {
            9
        }
    };
    t.topology.region = t.topology.tets.iter().map(|tet| side(&t, tet.v)).collect();
    let on_plane = |t: &Triangulation, face: [u32; 3]| face.iter().all(|&v| t.at(v).x == 6.0);
    let id = |x: u32, y: u32, z: u32| x + 5 * y + 25 * z;
    let mut hole = Hole::default();
    // Inside the one, at the hull, and inside the plane.
    for v in [id(1, 2, 2), id(4, 4, 4), id(0, 2, 3), id(3, 3, 3), id(2, 2, 2), id(2, 3, 1)] {
        // The hull parts two labels as well.
        let on_hull = |face: [u32; 3]| {
            t.topology.find_face(face).is_some_and(|f| {
                let beside = tet_of(t.topology.tet(tet_of(f)).n[slot_of(f)]);
                [tet_of(f), beside].into_iter().any(|tet| t.topology.tet(tet).is_ghost())
            })
        };
        let wall = |face: [u32; 3]| on_plane(&t, face) || on_hull(face);
        t.preview(&Replacement { remove: &[v], add: None }, &wall, &mut hole).unwrap();
        for coming in &hole.coming {
            assert_eq!(coming.label, Some(side(&t, coming.v)), "{:?}", coming.v);
        }
        t.replace(&mut hole).unwrap();
        for tet in t.topology.live() {
            assert_eq!(t.topology.region[tet as usize], side(&t, t.topology.tet(tet).v));
        }
        check(&t).unwrap();
    }
    // Labels and tetrahedra move together.
    let mut packed = t.clone();
    packed.compact();
    assert_eq!(packed.topology.tets.len(), packed.topology.live_count());
    assert_eq!(packed.topology.region.len(), packed.topology.live_count());
    for tet in packed.topology.live() {
        assert_eq!(packed.topology.region[tet as usize], side(&packed, packed.topology.tet(tet).v));
    }
    check(&packed).unwrap();
    // Without walls nothing can be told there.
    t.preview(&Replacement { remove: &[id(2, 1, 3)], add: None }, &|_| false, &mut hole).unwrap();
    assert!(hole.coming.iter().any(|coming| coming.label.is_none()));
    // Dropped: the triangulation is as before, and the hole fit for another.
    hole.clear();
    t.remove(id(1, 1, 1)).unwrap();
    check(&t).unwrap();
}

#[test]
#[should_panic(expected = "changed since the preview")]
fn a_stale_hole_is_refused() {
    let mut t = whole_grid(3);
    let mut hole = Hole::default();
    t.preview(&Replacement { remove: &[13], add: None }, &|_| false, &mut hole).unwrap();
    t.remove(14).unwrap();
    let _ = t.replace(&mut hole);
}

#[test]
fn replacements_name_what_they_can_not_do() {
    let mut t = whole_grid(3);
    let mut hole = Hole::default();
    let mut preview = |remove: &[u32], add| t.preview(&Replacement { remove, add }, &|_| false, &mut hole);
    assert_eq!(preview(&[3, 27], None), Err(Error::NoSuchVertex { vertex: 27 }));
    assert_eq!(preview(&[3], Some(DVec3::ONE)), Err(Error::Occupied { vertex: 13 }));
    assert!(matches!(preview(&[3], Some(DVec3::NAN)), Err(Error::NotFinite { .. })));
    assert!(matches!(preview(&[3], Some(DVec3::splat(1e300))), Err(Error::OutOfRange { .. })));
    // A vertex may be replaced where it stands.
    assert_eq!(preview(&[13, 13], Some(DVec3::ONE)), Ok(()));
    assert_eq!(t.replace(&mut hole), Ok(Some(27)));
    assert_eq!(t.vertex_count(), 27);
    check(&t).unwrap();
}
