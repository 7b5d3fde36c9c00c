//! Sequences of operations on a triangulation, beside a plain list of what its vertices should be.
//!
//! The symbolic perturbation makes the triangulation unique, so what a sequence leaves must be, tetrahedron by tetrahedron, what its points
//! alone, inserted in another order, give.

use std::collections::BTreeMap;

use wellspaced::triangulation::Location;
use wellspaced::{Control, DVec3, Error, Triangulation};

use crate::bytes::{Bytes, Grid};

/// A sequence has no more operations than this, and no more vertices.
const OPERATIONS: usize = 80;
const VERTICES: usize = 150;

struct Pair {
    t: Triangulation,
    /// What each vertex should be.
    model: BTreeMap<u32, DVec3>,
}

impl Pair {
    fn vertex(&self, bytes: &mut Bytes) -> Option<(u32, DVec3)> {
        if self.model.is_empty() {
            return None;
        }
        let place = bytes.below(self.model.len());
        self.model.iter().nth(place).map(|(&v, &p)| (v, p))
    }

    fn id_of(&self, p: DVec3) -> Option<u32> {
        self.model.iter().find(|(_, &q)| p == q).map(|(&v, _)| v)
    }

    fn insert(&mut self, p: DVec3, hint: Option<u32>) {
        let before = self.id_of(p);
        let inserted = self.t.insert(p, hint).expect("points in range");
        assert_eq!((before.unwrap_or(inserted.vertex), before.is_none()), (inserted.vertex, inserted.is_new), "{p}");
        self.model.insert(inserted.vertex, p);
    }

    fn insert_many(&mut self, points: &[DVec3]) {
        let slots = self.t.vertex_slots() as u32;
        let ids = self.t.insert_many(points, &Control::new()).expect("points in range").expect("never cancelled");
        assert_eq!(ids.len(), points.len());
        for (&p, &v) in points.iter().zip(&ids) {
            match self.id_of(p) {
                Some(before) => assert_eq!(before, v, "{p}"),
                None => {
                    assert!(v >= slots || points.len() == 1, "{v} was below {slots}");
                    assert!(self.model.insert(v, p).is_none(), "{v} was taken");
                }
            }
        }
    }

    /// The whole of what can be said about it.
    fn check(&self) {
        self.t.validate(3).unwrap_or_else(|defect| panic!("{defect}: {:?}", self.model));
        assert_eq!(self.t.vertex_count(), self.model.len());
        for (&v, &p) in &self.model {
            assert_eq!(self.t.point(v), Some(p));
        }
        assert_eq!(self.t.vertices().collect::<Vec<_>>(), self.model.keys().copied().collect::<Vec<_>>());
        assert_eq!(self.t.tetrahedra().count(), self.t.tetrahedron_count());
    }

    /// What its points give in another order.
    fn check_against_anew(&self) {
        let mut anew = Triangulation::new();
        let mut old_id = Vec::new();
        for (&v, &p) in self.model.iter().rev() {
            assert!(anew.insert(p, None).expect("points in range").is_new);
            old_id.push(v);
        }
        assert_eq!(self.t.dimension(), anew.dimension(), "{:?}", self.model);
        let sorted = |mut all: Vec<[u32; 4]>| {
            all.iter_mut().for_each(|v| v.sort_unstable());
            all.sort_unstable();
            all
        };
        let here = sorted(self.t.tetrahedra().collect());
        let there = sorted(anew.tetrahedra().map(|v| v.map(|v| old_id[v as usize])).collect());
        assert_eq!(here, there, "{:?}", self.model);
    }

    fn locate(&self, p: DVec3, hint: Option<u32>) {
        let found = self.t.locate(p, hint);
        match (found, self.id_of(p)) {
            (found, Some(v)) => assert_eq!(found, Location::Vertex(v), "{p}"),
            (Location::Vertex(v), None) => panic!("{p} is not at {v}"),
            (Location::Outside, None) => {}
            (Location::Edge(v), None) => assert!(self.t.link(v).is_some(), "{v:?} is no edge"),
            (Location::Face(v), None) => assert!(self.has_all(&v), "{v:?} is no face"),
            (Location::Tetrahedron(v), None) => assert!(self.has_all(&v), "{v:?} is no tetrahedron"),
        }
        if self.t.dimension() == 3 {
            // Where it is does not depend on where the walk begins, but for the order of the vertices.
            let again = self.t.locate(p, None);
            assert_eq!(kind(&found), kind(&again), "{p}: {found:?} and {again:?}");
        }
    }

    fn has_all(&self, v: &[u32]) -> bool {
        self.t.tetrahedra().any(|tet| v.iter().all(|v| tet.contains(v)))
    }
}

fn kind(location: &Location) -> u8 {
    match location {
        Location::Vertex(_) => 0,
        Location::Edge(_) => 1,
        Location::Face(_) => 2,
        Location::Tetrahedron(_) => 3,
        Location::Outside => 4,
    }
}

pub fn run(data: &[u8]) {
    let mut bytes = Bytes(data);
    let mut pair = Pair { t: Triangulation::new(), model: BTreeMap::new() };
    let grid = Grid::of(&mut bytes);
    pair.t.set_threads(bytes.below(4));
    let mut bulk = false;
    for turn in 0..OPERATIONS {
        if bytes.is_empty() {
            break;
        }
        let full = pair.model.len() >= VERTICES;
        match bytes.byte() % 16 {
            0..=3 if !full => {
                let p = grid.point(&mut bytes);
                pair.insert(p, None);
            }
            4 if !full => {
                let hint = pair.vertex(&mut bytes).map(|(v, _)| v);
                let p = grid.point(&mut bytes);
                pair.insert(p, hint);
            }
            5 => {
                if let Some((_, p)) = pair.vertex(&mut bytes) {
                    pair.insert(p, None);
                }
            }
            6 if !full => {
                let count = bytes.below(24);
                let points: Vec<DVec3> = (0..count).map(|_| grid.point(&mut bytes)).collect();
                pair.insert_many(&points);
            }
            7..=9 => {
                if let Some((v, _)) = pair.vertex(&mut bytes) {
                    pair.t.remove(v).expect("a vertex");
                    pair.model.remove(&v);
                }
            }
            10 => {
                let v = bytes.word();
                if !pair.model.contains_key(&v) {
                    assert_eq!(pair.t.remove(v), Err(Error::NoSuchVertex { vertex: v }));
                }
            }
            11 => {
                let p = grid.point(&mut bytes);
                let hint = pair.vertex(&mut bytes).map(|(v, _)| v);
                pair.locate(p, hint);
            }
            12 => {
                let new_id = pair.t.compact();
                pair.model =
                    std::mem::take(&mut pair.model).into_iter().map(|(v, p)| (new_id[v as usize], p)).collect();
                assert_eq!(pair.t.vertex_slots(), pair.model.len());
            }
            13 => pair.t = pair.t.clone(),
            14 => {
                let p = DVec3::new(bytes.any_real(), bytes.any_real(), bytes.any_real());
                if wellspaced::geometry::check_range(0, p).is_err() {
                    let before = format!("{:?}", pair.t.tetrahedra().collect::<Vec<_>>());
                    assert!(pair.t.insert(p, None).is_err());
                    assert!(pair.t.insert_many(&[DVec3::ONE, p], &Control::new()).is_err());
                    assert_eq!(before, format!("{:?}", pair.t.tetrahedra().collect::<Vec<_>>()));
                }
                // Any point may be looked for.
                let _ = pair.t.locate(p, None);
            }
            15 if !bulk => {
                // More than a thousand at once take another way, and can go back half-way.
                bulk = true;
                let (step, cancel) = (f64::from(bytes.byte() % 4) * 0.25 + 0.25, bytes.byte() % 3 == 0);
                let points: Vec<DVec3> = (0..1100)
                    .map(|i| DVec3::new((i % 11) as f64, (i / 11 % 10) as f64, (i / 110) as f64) * step)
                    .collect();
                let control = Control::with_progress(move |progress| !cancel || progress.fraction < 0.3);
                let mut t = pair.t.clone();
                let done = t.insert_many(&points, &control).expect("points in range");
                t.validate(3).unwrap_or_else(|defect| panic!("{defect}"));
                if done.is_none() {
                    assert_eq!(t.tetrahedra().collect::<Vec<_>>(), pair.t.tetrahedra().collect::<Vec<_>>());
                }
            }
            _ => {
                if let (Some((a, _)), Some((b, _))) = (pair.vertex(&mut bytes), pair.vertex(&mut bytes)) {
                    let joined = pair.has_all(&[a, b]) && a != b;
                    assert_eq!(pair.t.link([a, b]).is_some(), joined, "{a} {b}");
                }
            }
        }
        if turn % 4 == 3 {
            pair.check();
        }
    }
    pair.check();
    pair.check_against_anew();
}
