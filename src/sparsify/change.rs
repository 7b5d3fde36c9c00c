//! A replacement looked at exactly before it is made: it must leave every tetrahedron within the bound, and the boundary conforming.

use super::search::Found;
use super::{Demand, Sparsifier};
use crate::domain::boundary::{edge_key, face_key};
use crate::domain::label::OUTSIDE;
use crate::domain::{Boundary, Carrier};
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::flush_tiny;
use crate::geometry::quality::{four_exceed_radius_edge, in_fours, EDGES};
use crate::triangulation::remove::{Coming, Hole, Replacement, ADDED};
use crate::triangulation::topology::{Tetrahedron, GHOST};
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
        let Hole { coming, .. } = &self.hole;
        let counts = |coming: &Coming| coming.v[3] != GHOST && coming.label != Some(OUTSIDE);
        let added = self.hole.point().unwrap_or(DVec3::NAN);
        let at = |v: u32| if v == ADDED { &added } else { &t.points()[v as usize] };
        let near = |coming: &Coming| {
            coming.v.contains(&ADDED) && coming.v.iter().any(|&v| v != ADDED && at(v).distance(added) < self.min_edge)
        };
        let mut all = in_fours((0..coming.len() as u32).filter(|&i| counts(&coming[i as usize])));
        all.all(|(four, count)| {
            let tets = four.map(|i| &coming[i as usize]);
            let (exceed, shortest) = four_exceed_radius_edge(&tets.map(|tet| tet.v.map(at)), self.radius_edge);
            (0..count).all(|i| {
                let may_stay = || {
                    let length2 = |[i, j]: [usize; 2], v: [u32; 4]| at(v[i]).distance_squared(*at(v[j]));
                    let is_shortest = |&&pair: &&[usize; 2]| length2(pair, tets[i].v) == shortest[i];
                    let Some(pair) = EDGES.iter().find(is_shortest) else { return false };
                    let edge = pair.map(|slot| tets[i].v[slot]);
                    shortest[i] > demand.level2 && (edge.contains(&ADDED) || !boundary.is_seditious(t, edge))
                };
                !near(tets[i]) && (exceed >> i & 1 == 0 || may_stay())
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

/// The tetrahedra that go which have an edge between vertices on the boundary, by their vertices: few.
fn at_boundary<'a>(
    t: &'a Triangulation,
    boundary: &'a Boundary,
    hole: &'a Hole,
) -> impl Iterator<Item = Tetrahedron> + 'a {
    let on = |&v: &u32| v != GHOST && boundary.kind(v) != 0;
    let tets = hole.going.iter().map(|going| *t.topology.tet(going.t));
    tets.filter(move |tet| tet.v.into_iter().filter(on).nth(1).is_some())
}

/// The subfacets of a tetrahedron.
fn walls(boundary: &Boundary, tet: Tetrahedron) -> impl Iterator<Item = [u32; 3]> + '_ {
    let slots = if boundary.may_have_wall(tet.v) { 0..4 } else { 0..0 };
    slots.map(move |slot| tet.face(slot)).filter(|&face| boundary.wall(face).is_some())
}

/// And its subsegments.
fn subsegments(boundary: &Boundary, tet: Tetrahedron) -> impl Iterator<Item = [u32; 2]> + '_ {
    let on = |v: u32| v != GHOST && boundary.kind(v) != 0;
    let edges = EDGES.iter().map(move |&[i, j]| [tet.v[i], tet.v[j]]);
    edges.filter(move |&[a, b]| on(a) && on(b) && boundary.is_subsegment(edge_key([a, b])))
}

/// Whether what is left of the boundary in the hole is there when it is filled.
fn keeps_boundary(t: &Triangulation, boundary: &Boundary, hole: &Hole, named: impl Fn(u32) -> u32 + Copy) -> bool {
    at_boundary(t, boundary, hole).all(|tet| {
        walls(boundary, tet).all(|face| is_face(hole, face_key(face), named))
            && subsegments(boundary, tet).all(|edge| is_edge(hole, edge, named))
    })
}

/// Whether a free point that comes encroaches upon nothing.
fn is_clear(t: &Triangulation, boundary: &Boundary, hole: &Hole) -> bool {
    let Some(p) = hole.point() else { return true };
    let at = |v: u32| -> DVec3 { t.at(v) };
    at_boundary(t, boundary, hole).all(|tet| {
        walls(boundary, tet).all(|face| !encroaches_facet(face.map(at), p))
            && subsegments(boundary, tet).all(|edge| !encroaches_segment(edge.map(at), p))
    })
}
