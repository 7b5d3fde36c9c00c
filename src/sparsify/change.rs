//! A replacement looked at exactly before it is made: it must leave every tetrahedron within the bound, and the boundary conforming.

use super::search::Found;
use super::{Demand, Sparsifier};
use crate::domain::boundary::{face_key, places};
use crate::domain::label::OUTSIDE;
use crate::domain::Boundary;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::flush_tiny;
use crate::geometry::quality::{four_exceed_radius_edge, in_fours, EDGES};
use crate::triangulation::remove::{Hole, Replacement, ADDED};
use crate::triangulation::topology::GHOST;
use crate::triangulation::Triangulation;
use crate::{DVec3, Error};

impl Sparsifier {
    /// Makes a change if it keeps what it must. Returns whether it did; what it created is in `hole`.
    pub(super) fn make(
        &mut self,
        t: &mut Triangulation,
        boundary: &mut Boundary,
        found: &Found,
        demand: Demand,
    ) -> Result<bool, Error> {
        let new = t.next_vertex();
        let add = found.add.map(|(p, carrier)| (new, flush_tiny(p), carrier));
        // The boundary first: what it would be like decides whether the triangulation may change.
        let Some(journal) = boundary.unsplit(t, &found.plan, add) else { return Ok(false) };
        let replacement = Replacement { remove: &found.remove, add: add.map(|(_, p, _)| p) };
        let named = |v: u32| if v == ADDED { new } else { v };
        let is_wall = |face: [u32; 3]| boundary.wall(face.map(named)).is_some();
        let certified = |guess| t.certify(&replacement, guess, &is_wall, &mut self.hole);
        let seen = if found.guess.as_ref().is_some_and(certified) {
            Ok(())
        } else {
            t.preview(&replacement, &is_wall, &mut self.hole)
        };
        match seen {
            Ok(()) | Err(Error::Occupied { .. } | Error::OutOfRange { .. }) => {}
            Err(error) => {
                boundary.undo(journal);
                return Err(error);
            }
        }
        let keeps = seen.is_ok()
            && keeps_labels(t, &self.hole)
            && self.keeps_bound(t, boundary, demand)
            && keeps_boundary(t, boundary, &self.hole, named)
            && journal.created().all(|face| is_face(&self.hole, face, named))
            && journal.joined().iter().all(|&edge| is_edge(&self.hole, edge, named))
            && (!demand.level2.is_finite() || is_clear(t, boundary, &self.hole));
        if !keeps {
            self.hole.clear();
            boundary.undo(journal);
            return Ok(false);
        }
        let replaced = match t.replace(&mut self.hole) {
            Ok(replaced) => replaced,
            Err(error) => {
                boundary.undo(journal);
                return Err(error);
            }
        };
        debug_assert!(replaced.is_none_or(|v| v == new));
        for &v in &found.remove {
            boundary.unmark(v);
        }
        match replaced {
            Some(v) => {
                self.newest = v;
                self.replaced += 1;
            }
            None => self.removed += 1,
        }
        Ok(true)
    }

    /// Whether what comes keeps the bound, but for what `demand` leaves for later, and has no edge that is too short.
    fn keeps_bound(&self, t: &Triangulation, boundary: &Boundary, demand: Demand) -> bool {
        let Hole { coming, .. } = &self.hole;
        let counts = |&i: &u32| coming[i as usize].v[3] != GHOST && coming[i as usize].label != Some(OUTSIDE);
        let at = |v: u32| t.coming_point(&self.hole, v);
        let is_short = |&v: &u32| v != ADDED && at(v).distance(*at(ADDED)) < self.min_edge;
        // Outside, too: sheets of the boundary may be near to each other.
        let at_new = coming.iter().map(|coming| coming.v).filter(|v| v.contains(&ADDED) && v[3] != GHOST);
        if at_new.flatten().any(|v| is_short(&v)) {
            return false;
        }
        in_fours((0..coming.len() as u32).filter(counts)).all(|(four, count)| {
            let tets = four.map(|i| coming[i as usize].v);
            let (exceed, shortest) = four_exceed_radius_edge(&tets.map(|v| v.map(at)), self.searcher.scope.radius_edge);
            tets.into_iter().enumerate().take(count).all(|(i, v)| {
                if exceed >> i & 1 == 0 {
                    return true;
                }
                let is_shortest = |[a, b]: &[u32; 2]| at(*a).distance_squared(*at(*b)) == shortest[i];
                let mut edges = EDGES.iter().map(|pair| pair.map(|slot| v[slot]));
                let Some(edge) = edges.find(is_shortest) else { return false };
                shortest[i] > demand.level2 && (edge.contains(&ADDED) || !boundary.is_seditious(t, edge))
            })
        })
    }
}

/// Whether each tetrahedron that comes belongs to one region for sure.
fn keeps_labels(t: &Triangulation, hole: &Hole) -> bool {
    t.topology.region.is_empty() || hole.coming.iter().all(|coming| coming.label.is_some())
}

fn is_face(hole: &Hole, face: [u32; 3], named: impl Fn(u32) -> u32) -> bool {
    hole.coming.iter().any(|coming| {
        let v = coming.v.map(&named);
        face.iter().all(|x| v.contains(x))
    })
}

fn is_edge(hole: &Hole, edge: [u32; 2], named: impl Fn(u32) -> u32) -> bool {
    hole.coming.iter().any(|coming| {
        let v = coming.v.map(&named);
        edge.iter().all(|x| v.contains(x))
    })
}

/// The tetrahedra that go which have an edge between vertices on the boundary: few.
fn at_boundary<'a>(t: &'a Triangulation, boundary: &'a Boundary, hole: &'a Hole) -> impl Iterator<Item = u32> + 'a {
    hole.going.iter().map(|going| going.t).filter(|&tet| boundary.may_have_edge(t.topology.tet(tet).v))
}

/// The subfacets of a tetrahedron.
fn walls<'a>(t: &'a Triangulation, boundary: &'a Boundary, tet: u32) -> impl Iterator<Item = [u32; 3]> + 'a {
    let tet = t.topology.tet(tet);
    places(boundary.possible_walls(tet.v)).map(|slot| tet.face(slot)).filter(|&face| boundary.wall(face).is_some())
}

/// And its subsegments.
fn subsegments<'a>(t: &'a Triangulation, boundary: &'a Boundary, tet: u32) -> impl Iterator<Item = [u32; 2]> + 'a {
    EDGES.iter().filter_map(move |&pair| boundary.subsegment_at(t, tet, pair))
}

/// Whether what is left of the boundary in the hole is there when it is filled.
fn keeps_boundary(t: &Triangulation, boundary: &Boundary, hole: &Hole, named: impl Fn(u32) -> u32 + Copy) -> bool {
    at_boundary(t, boundary, hole).all(|tet| {
        walls(t, boundary, tet).all(|face| is_face(hole, face_key(face), named))
            && subsegments(t, boundary, tet).all(|edge| is_edge(hole, edge, named))
    })
}

/// Whether the point that comes encroaches upon nothing of the boundary that stays.
fn is_clear(t: &Triangulation, boundary: &Boundary, hole: &Hole) -> bool {
    let Some(p) = hole.point() else { return true };
    let at = |v: u32| -> DVec3 { t.at(v) };
    at_boundary(t, boundary, hole).all(|tet| {
        walls(t, boundary, tet).all(|face| !encroaches_facet(face.map(at), p))
            && subsegments(t, boundary, tet).all(|edge| !encroaches_segment(edge.map(at), p))
    })
}
