//! Edges and faces by their vertices: a walk through the tetrahedra at one vertex in the direction of another.
//!
//! It is the visibility walk of [`search`](super::search) to a point as near the vertex as may be: only faces at the vertex are crossed, and the
//! predicates ask on which side of them the other vertex lies. The tetrahedron that it ends in holds the direction, and tetrahedra meet in common
//! faces only, so an edge to the other vertex is an edge of this tetrahedron, or there is none. That takes about as many steps as the root
//! of the star's size, while a [search](super::incident::Search), which needs no coordinates, looks through the star. Where the walk is long, both take
//! turns: one of the stars may be small, and a walk around an edge goes through most of a large one.

use super::incident::Search;
use super::topology::{tet_of, GHOST, NONE};
use super::Triangulation;
use crate::geometry::Sign;
use crate::{Control, Error};

/// Steps of a walk before the stars are looked through: one of them is smaller mostly.
const STEPS: usize = if cfg!(test) { 8 } else { 100 };

/// What a walk found.
enum Toward {
    /// A tetrahedron with both vertices.
    Reached(u32),
    /// There is none.
    Absent,
    /// It has not come there yet.
    Unknown,
    /// It was not the way to find out.
    Lost,
}

/// A walk under way: where it is, and where it came from.
struct Walk {
    t: u32,
    from: u32,
}

impl Triangulation {
    /// A tetrahedron with both vertices, and their slots in it; `None` when no edge joins them.
    pub(crate) fn find_edge(&self, p: u32, q: u32) -> Option<(u32, usize, usize)> {
        self.find_edge_within(p, q, Control::never()).unwrap_or_default()
    }

    /// [`find_edge`](Self::find_edge), unless the control says stop.
    pub(crate) fn find_edge_within(
        &self,
        p: u32,
        q: u32,
        control: &Control,
    ) -> Result<Option<(u32, usize, usize)>, Error> {
        let found = self.find_tet([p, q], control)?;
        Ok(found.and_then(|t| {
            let tet = self.topology.tet(t);
            Some((t, tet.slot(p)?, tet.slot(q)?))
        }))
    }

    /// A handle of the face with these vertices, from one of its two sides; `None` when they span no face.
    pub(crate) fn find_face(&self, face: [u32; 3]) -> Option<u32> {
        self.find_face_within(face, Control::never()).unwrap_or_default()
    }

    /// [`find_face`](Self::find_face), unless the control says stop.
    pub(crate) fn find_face_within(&self, face: [u32; 3], control: &Control) -> Result<Option<u32>, Error> {
        let [p, q, r] = face;
        // The edge first: a walk finds that.
        let Some((t, i, j)) = self.find_edge_within(p, q, control)? else { return Ok(None) };
        let mut search = None;
        for (step, (t, k, l)) in self.topology.around_edge(t, i, j).enumerate() {
            if self.topology.tet(t).v[k] == r {
                return Ok(Some(4 * t + l as u32));
            }
            // As with walks: the third vertex may be that of a small star.
            if (step + 1) % STEPS == 0 {
                control.check()?;
                let search = search.get_or_insert_with(|| Search::new(&self.topology, face));
                if let Some(found) = search.look(&self.topology, STEPS) {
                    let opposite = |t: u32| self.topology.tet(t).v.iter().position(|v| !face.contains(v));
                    return Ok(found.and_then(|t| Some(4 * t + opposite(t)? as u32)));
                }
            }
        }
        Ok(None)
    }

    fn find_tet(&self, [p, q]: [u32; 2], control: &Control) -> Result<Option<u32>, Error> {
        let mut walk = self.walk_around(p, q);
        let found = walk.as_mut().map_or(Toward::Lost, |walk| self.toward(walk, [p, q], STEPS));
        match found {
            Toward::Reached(t) => return Ok(Some(t)),
            Toward::Absent => return Ok(None),
            Toward::Unknown => {}
            Toward::Lost => walk = None,
        }
        let (mut search, mut steps) = (Search::new(&self.topology, [p, q]), STEPS);
        loop {
            control.check()?;
            if let Some(found) = search.look(&self.topology, steps) {
                return Ok(found);
            }
            match walk.as_mut().map_or(Toward::Unknown, |walk| self.toward(walk, [p, q], steps)) {
                Toward::Reached(t) => return Ok(Some(t)),
                Toward::Absent => return Ok(None),
                Toward::Unknown => {}
                Toward::Lost => walk = None,
            }
            // As many as take some tenths of a millisecond.
            steps = (2 * steps).min(10 * STEPS);
        }
    }

    /// The start of a walk around `p` in the direction of `q`; `None` where there is no such walk.
    fn walk_around(&self, p: u32, q: u32) -> Option<Walk> {
        if self.dimension() < 3 || p == GHOST || q == GHOST || p == q {
            return None;
        }
        let [first, other] = [p, q].map(|v| self.topology.vertex_tet[v as usize]);
        (first != NONE && other != NONE).then(|| Walk { t: self.finite_at(first), from: NONE })
    }

    /// Walks on around `p` in the direction of `q`.
    fn toward(&self, walk: &mut Walk, [p, q]: [u32; 2], steps: usize) -> Toward {
        let goal = self.at(q);
        for _ in 0..steps {
            let Walk { t, from } = *walk;
            let tet = self.topology.tet(t);
            if tet.v.contains(&q) {
                return Toward::Reached(t);
            }
            let corners = self.corners(t);
            let is_beyond = |&slot: &usize| {
                let mut there = corners;
                there[slot] = goal;
                let [a, b, c, d] = there;
                tet.v[slot] != p && tet_of(tet.n[slot]) != from && self.filter.orient3d(a, b, c, d) == Sign::Negative
            };
            let Some(slot) = (0..4).find(is_beyond) else { return Toward::Absent };
            *walk = Walk { t: tet_of(tet.n[slot]), from: t };
            debug_assert!(!self.topology.tet(walk.t).is_ghost(), "no vertex is outside the hull");
            if self.topology.tet(walk.t).is_ghost() {
                return Toward::Lost;
            }
        }
        Toward::Unknown
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::samples::on_a_sphere;
    use crate::triangulation::topology::slot_of;
    use crate::{Control, DVec3};

    fn points() -> impl Strategy<Value = Vec<DVec3>> {
        let real = (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z): (f64, f64, f64)| DVec3::new(x, y, z));
        let grid = (0..4, 0..4, 0..4).prop_map(|(x, y, z): (i32, i32, i32)| DVec3::new(x.into(), y.into(), z.into()));
        let flat = (0..9, 0..9, 0..2).prop_map(|(x, y, z): (i32, i32, i32)| DVec3::new(x.into(), y.into(), z.into()));
        let many = 4..60;
        prop_oneof![
            prop::collection::vec(real, many.clone()),
            prop::collection::vec(grid, many.clone()),
            prop::collection::vec(flat, many)
        ]
    }

    /// All points of a sphere are joined to its centre, and many to each of four outside.
    #[test]
    fn edges_between_large_stars_are_found_by_few_steps() {
        let count = 20_000;
        let mut points = on_a_sphere(count);
        points.extend(
            [[0.0, 0.0, 0.0], [3.0, 0.1, 0.2], [-3.0, 0.3, 0.1], [0.2, 3.0, -0.1], [0.1, -0.2, 3.0]].map(DVec3::from),
        );
        let mut t = Triangulation::new();
        t.insert_many(&points, &Control::new()).unwrap();
        let first = count as u32;
        let mut joined = 0;
        for p in first..first + 5 {
            assert!(t.topology.star(p).len() > 3000);
            for q in (first..first + 5).filter(|&q| q != p) {
                let (control, mut found) = (Control::new(), None);
                let looks = control.looks(None, || found = t.find_edge_within(p, q, &control).unwrap());
                // A look through one of the stars would take a hundred.
                assert!(looks < 20, "{looks}");
                assert_eq!(found.is_some(), t.topology.find_edge(p, q).is_some());
                joined += usize::from(found.is_some());
                if looks > 0 {
                    control.looks(Some(looks), || {
                        assert_eq!(t.find_edge_within(p, q, &control), Err(Error::Cancelled));
                    });
                }
            }
        }
        assert!(joined > 4, "{joined}");
    }

    proptest! {
        #[test]
        fn walks_find_what_a_look_through_the_stars_finds(points in points()) {
            let mut t = Triangulation::new();
            t.insert_many(&points, &Control::new()).unwrap();
            let vertices: Vec<u32> = t.vertices().collect();
            for (&p, &q) in vertices.iter().flat_map(|p| vertices.iter().map(move |q| (p, q))).filter(|(p, q)| p != q) {
                let found = t.find_edge(p, q);
                prop_assert_eq!(found.is_some(), t.topology.find_edge(p, q).is_some(), "{} {}", p, q);
                prop_assert!(found.is_none_or(|(at, i, j)| t.topology.tet(at).v[i] == p && t.topology.tet(at).v[j] == q));
                for &r in vertices.iter().step_by(5).filter(|&&r| r != p && r != q) {
                    let found = t.find_face([p, q, r]);
                    prop_assert_eq!(found.is_some(), t.topology.find_face([p, q, r]).is_some(), "{} {} {}", p, q, r);
                    let has_all = |face: u32| {
                        let face = t.topology.tet(tet_of(face)).face(slot_of(face));
                        [p, q, r].iter().all(|v| face.contains(v))
                    };
                    prop_assert!(found.is_none_or(has_all));
                }
            }
        }
    }
}
