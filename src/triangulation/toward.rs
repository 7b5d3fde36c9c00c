//! Edges and faces by their vertices: a walk through the tetrahedra at one vertex in the direction of another.
//!
//! It is the visibility walk of [`search`](super::search) to a point as near the vertex as may be: only faces at the vertex are crossed, and the
//! predicates ask on which side of them the other vertex lies. The tetrahedron that it ends in holds the direction, and tetrahedra meet in common
//! faces only, so an edge to the other vertex is an edge of this tetrahedron, or there is none. That takes about as many steps as the root
//! of the star's size, while [`Topology::find_edge`](super::topology::Topology::find_edge), which needs no coordinates, looks through the star.

use super::topology::{tet_of, GHOST, NONE};
use super::Triangulation;
use crate::geometry::Sign;

/// After so many steps of one walk the stars are looked through: one of them is smaller.
const STEPS: usize = 100;

/// What a walk found.
enum Toward {
    /// A tetrahedron with both vertices.
    Reached(u32),
    /// There is none.
    Absent,
    /// It was not the way to find out.
    Unknown,
}

impl Triangulation {
    /// A tetrahedron with both vertices, and their slots in it; `None` when no edge joins them.
    pub(crate) fn find_edge(&self, p: u32, q: u32) -> Option<(u32, usize, usize)> {
        match self.toward(p, q) {
            Toward::Reached(t) => {
                let tet = self.topology.tet(t);
                Some((t, tet.slot(p)?, tet.slot(q)?))
            }
            Toward::Absent => None,
            Toward::Unknown => self.topology.find_edge(p, q),
        }
    }

    /// A handle of the face with these vertices, from one of its two sides; `None` when they span no face.
    pub(crate) fn find_face(&self, face: [u32; 3]) -> Option<u32> {
        let [p, q, r] = face;
        match self.toward(p, q) {
            Toward::Reached(t) => {
                let tet = self.topology.tet(t);
                let mut around = self.topology.around_edge(t, tet.slot(p)?, tet.slot(q)?);
                around.find_map(|(t, k, l)| (self.topology.tet(t).v[k] == r).then_some(4 * t + l as u32))
            }
            Toward::Absent => None,
            Toward::Unknown => self.topology.find_face(face),
        }
    }

    /// Walks around `p` in the direction of `q`.
    fn toward(&self, p: u32, q: u32) -> Toward {
        if self.dimension() < 3 || p == GHOST || q == GHOST || p == q {
            return Toward::Unknown;
        }
        let [first, other] = [p, q].map(|v| self.topology.vertex_tet[v as usize]);
        if first == NONE || other == NONE {
            return Toward::Absent;
        }
        let goal = self.at(q);
        let (mut t, mut from) = (self.finite_at(first), NONE);
        for _ in 0..STEPS {
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
            (t, from) = (tet_of(tet.n[slot]), t);
            debug_assert!(!self.topology.tet(t).is_ghost(), "no vertex is outside the hull");
            if self.topology.tet(t).is_ghost() {
                return Toward::Unknown;
            }
        }
        Toward::Unknown
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
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
