//! A replacement looked at exactly before it is made: it must leave every tetrahedron within the bound, and the boundary conforming.

use super::search::Found;
use super::{Demand, Sparsifier};
use crate::domain::boundary::{edge_key, face_key, Encroached};
use crate::domain::label::OUTSIDE;
use crate::domain::{Boundary, Carrier};
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::flush_tiny;
use crate::geometry::quality::{exceeds_radius_edge, EDGES};
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
        let guess = (&self.pair.guess.going[..], &self.pair.guess.coming[..]);
        let seen = if found.guess && t.certify(&replacement, guess, &is_wall, &mut self.hole) {
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
        let is_free = add.is_none_or(|(_, _, carrier)| carrier == Carrier::Free);
        let keeps = seen.is_ok()
            && keeps_labels(t, &self.hole)
            && self.keeps_bound(t, boundary, demand)
            && keeps_boundary(t, boundary, &self.hole, named)
            && journal.created().all(|face| is_face(&self.hole, face, named))
            && journal.joined().iter().all(|&edge| is_edge(&self.hole, edge, named))
            && (!demand.level2.is_finite() || is_free && is_clear(t, boundary, &self.hole));
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
        self.hole.coming.iter().all(|coming| {
            let Some(corners) = t.coming_corners(&self.hole, coming) else { return true };
            if coming.label == Some(OUTSIDE) {
                return true;
            }
            let near = |slot: usize| (0..4).any(|i| i != slot && corners[i].distance(corners[slot]) < self.min_edge);
            if coming.v.iter().position(|&v| v == ADDED).is_some_and(near) {
                return false;
            }
            if !exceeds_radius_edge(corners, self.radius_edge) {
                return true;
            }
            let length = |&[i, j]: &[usize; 2]| corners[i].distance_squared(corners[j]);
            let Some(shortest) = EDGES.iter().min_by(|a, b| length(a).total_cmp(&length(b))) else { return false };
            let edge = shortest.map(|slot| coming.v[slot]);
            length(shortest) > demand.level2 && (edge.contains(&ADDED) || !boundary.is_seditious(t, edge))
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

/// Whether what is left of the boundary in the hole is there when it is filled.
fn keeps_boundary(t: &Triangulation, boundary: &Boundary, hole: &Hole, named: impl Fn(u32) -> u32 + Copy) -> bool {
    hole.going.iter().all(|going| {
        let tet = t.topology.tet(going.t);
        let faces = (0..4).map(|slot| tet.face(slot)).filter(|&face| boundary.wall(face).is_some());
        let both = |&[i, j]: &[usize; 2]| {
            let on = |v: u32| v != GHOST && boundary.kind(v) != 0;
            on(tet.v[i]) && on(tet.v[j]) && boundary.is_subsegment(edge_key([tet.v[i], tet.v[j]]))
        };
        faces.into_iter().all(|face| is_face(hole, face_key(face), named))
            && EDGES.iter().filter(|pair| both(pair)).all(|&[i, j]| is_edge(hole, [tet.v[i], tet.v[j]], named))
    })
}

/// Whether a free point that comes encroaches upon nothing, or nothing has to give way to it.
fn is_clear(t: &Triangulation, boundary: &Boundary, hole: &Hole) -> bool {
    let Some(p) = hole.point() else { return true };
    if boundary.tolerant {
        let mut found = Encroached::default();
        let rim = hole.coming.iter().filter(|coming| coming.v.contains(&ADDED)).flat_map(|coming| coming.v);
        let distances = rim.filter(|&v| v != ADDED && v != GHOST).map(|v| t.at(v).distance_squared(p));
        let clearance = distances.fold(f64::INFINITY, f64::min).sqrt();
        let going = hole.going.iter().map(|going| going.t);
        // That what is left of the boundary stays has been seen already.
        boundary.in_the_way(t, (p, clearance), going, |_| false, &mut found);
        return found.is_empty();
    }
    let at = |v: u32| -> DVec3 { t.at(v) };
    hole.going.iter().all(|going| {
        let tet = t.topology.tet(going.t);
        let faces = (0..4).map(|slot| tet.face(slot)).filter(|&face| boundary.wall(face).is_some());
        faces.into_iter().all(|face| !encroaches_facet(face.map(at), p))
            && EDGES.iter().all(|&[i, j]| {
                let edge = [tet.v[i], tet.v[j]];
                let on = |v: u32| v != GHOST && boundary.kind(v) != 0;
                !(edge.into_iter().all(on)
                    && boundary.is_subsegment(edge_key(edge))
                    && encroaches_segment(edge.map(at), p))
            })
    })
}
