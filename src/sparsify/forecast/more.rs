//! Holes that follow from what is known: a point's cavity is the filling of the hole that the point would leave, and the filling of the
//! hole of two vertices is that of the one, but for the star of the other in it, which is wrapped anew.

use glam::DVec3;

use super::four::spheres;
use super::{Demand, Filling, Forecast, Rim, FACE, MAX_VERTICES, RIM};
use crate::domain::Boundary;
use crate::geometry::quality::in_fours;
use crate::memory;
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;

/// Marks: those of the known hole, the tetrahedra at the vertex, and of them those that a face which is kept leads to.
const KNOWN: u16 = MET - 1;
const MET: u16 = 1 << 14;
const STAR: u16 = 1 << 15;
/// A tetrahedron of the known filling that has the vertex.
const GONE: u16 = u16::MAX;

/// A small set of tetrahedra that never denies one it has.
#[derive(Clone, Copy, Debug, Default)]
struct Few([u64; 4]);

impl Few {
    fn place(id: u32) -> (usize, u64) {
        let hash = id.wrapping_mul(0x9e37_79b1) >> 24;
        ((hash >> 6) as usize, 1 << (hash & 63))
    }

    fn add(&mut self, id: u32) {
        let (word, bit) = Few::place(id);
        self.0[word] |= bit;
    }

    fn may_have(&self, id: u32) -> bool {
        let (word, bit) = Few::place(id);
        self.0[word] & bit != 0
    }
}

impl Forecast {
    /// Whether a cavity has more tetrahedra than are looked at.
    pub fn is_too_large(cavity: &Cavity) -> bool {
        cavity.tets.len() > 2 * MAX_VERTICES
    }

    /// Takes the cavity of a point that is not inserted, and not [too large](Self::is_too_large), as what would fill its hole. False when it is not free
    /// of walls, and when it has no obstacles, or more than `most`.
    pub fn take_cavity(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        (p, cavity): (DVec3, &Cavity),
        demand: Demand,
        most: usize,
    ) -> bool {
        debug_assert!(!Forecast::is_too_large(cavity));
        self.begin(t, p);
        let closed = boundary.closes(t);
        // Of a cavity that no wall parts all is inside, or nothing.
        let decisive = if closed { 1 } else { cavity.tets.len() };
        if !cavity.tets.iter().take(decisive).all(|&id| t.is_inside(id)) {
            return false;
        }
        for (ids, count) in in_fours(cavity.tets.iter().copied()) {
            let four = spheres(&ids.map(|id| t.corner_refs(id)), p);
            for (lane, &id) in ids.iter().enumerate().take(count) {
                let (radius2, shortest2) = (four.radius2[lane], four.shortest2[lane]);
                if radius2 > demand.bound2 * shortest2 && shortest2 <= demand.level2 {
                    if self.obstacles.len() == most {
                        return false;
                    }
                    self.obstacles.push(self.filling.len() as u32);
                }
                let center = DVec3::from(four.center.map(|x| x[lane]));
                self.filling.push(Filling { v: [0; 4], n: [0; 4], center, radius2, id });
            }
        }
        // Nothing to mend: whatever the point is for, it shall come.
        !self.obstacles.is_empty() && self.link_cavity(t, boundary, cavity, closed)
    }

    /// The vertices and the neighbours of what fills the hole. False when it is too large, or not free of walls.
    fn link_cavity(&mut self, t: &Triangulation, boundary: &Boundary, cavity: &Cavity, closed: bool) -> bool {
        self.going.extend_from_slice(&cavity.tets);
        for (&id, mark) in cavity.tets.iter().zip(1..) {
            self.marks[id as usize] = mark;
        }
        for (i, &id) in cavity.tets.iter().enumerate() {
            let tet = t.topology.tet(id);
            let walls = boundary.possible_walls(tet.v);
            let v = tet.v.map(|v| self.number_of(t, v));
            let mut n = [0; 4];
            for (slot, &behind) in tet.n.iter().enumerate() {
                let facet = boundary.wall_among(walls, slot, FACE[slot].map(|k| tet.v[k]));
                let beyond = tet_of(behind);
                n[slot] = if cavity.contains(beyond) {
                    if facet.is_some() {
                        return false;
                    }
                    4 * (self.marks[beyond as usize] - 1) + slot_of(behind) as u16
                } else {
                    if facet.is_none() && !closed && !t.is_inside(beyond) {
                        return false;
                    }
                    self.rim.push(Rim { inside: 4 * i as u16 + slot as u16, ..Rim::new(behind, facet) });
                    RIM | (self.rim.len() - 1) as u16
                };
            }
            let filling = &mut self.filling[i];
            (filling.v, filling.n) = (v, n);
        }
        self.vertices.len() <= MAX_VERTICES
    }

    /// Opens and fills the hole that the vertex `w`, which lies on no segment or facet, leaves together with the `known` one. False when it can't be
    /// foreseen, when `w` has a neighbour nearer than `spacing`, or when more than `most` obstacles come.
    ///
    /// What is looked at here is seldom in the cache, and each look at what isn't takes longer than all that is computed from it. So the marks of the known hole
    /// are taken over as they are, until it begins anew.
    pub fn fill_more(
        &mut self,
        known: &mut Forecast,
        t: &Triangulation,
        boundary: &Boundary,
        (w, spacing): (u32, f64),
        demand: Demand,
        most: usize,
    ) -> bool {
        let Some(number) = known.number_in_hole(w) else { return false };
        if known.lent && self.borrowed {
            for &face in &self.star {
                self.marks[tet_of(face) as usize] &= KNOWN;
            }
            self.begin_lists(t, known.origin);
        } else {
            self.begin(t, known.origin);
            if known.lent {
                // Another hole has been looked at since.
                known.going.iter().for_each(|&id| self.marks[id as usize] = 1);
            } else {
                std::mem::swap(&mut self.marks, &mut known.marks);
                known.lent = true;
            }
            self.borrowed = true;
        }
        self.vertices.extend_from_slice(&known.vertices);
        for (&v, number) in known.vertices.iter().zip(0..) {
            self.number[v as usize] = number;
        }
        let count = known.vertices.len().min(MAX_VERTICES + 1);
        self.places.0[..count].copy_from_slice(&known.places.0[..count]);
        self.going.extend_from_slice(&known.going);
        debug_assert!(self.going.iter().all(|&id| self.marks[id as usize] & KNOWN != 0));
        let closed = boundary.closes(t);
        self.find_star(t, w, spacing * spacing, closed)
            && self.keep(known, number)
            && self.obstacles.len() <= most
            && self.open_star(t, boundary, w, closed)
            && self.wrap(demand, most)
    }

    /// The tetrahedra at a vertex; false when some lie outside, or a squared edge there is shorter than `least`.
    fn find_star(&mut self, t: &Triangulation, w: u32, least: f64, closed: bool) -> bool {
        let Forecast { star, marks, going, .. } = self;
        let (first, p) = (t.topology.vertex_tet[w as usize], t.at(w));
        let is_near = |v: u32| v != w && t.at(v).distance_squared(p) < least;
        if t.topology.tet(first).v.into_iter().filter(|&v| v != GHOST).any(is_near) {
            return false;
        }
        let fetch_mark = {
            let first = marks.as_ptr();
            move |n: u32| memory::prefetch(first.wrapping_add(tet_of(n) as usize))
        };
        let mut take = |face: u32, star: &mut Vec<u32>| {
            let id = tet_of(face);
            let mark = &mut marks[id as usize];
            if *mark & STAR == 0 {
                if *mark == 0 {
                    going.push(id);
                    t.topology.prefetch(id);
                }
                *mark |= STAR;
                star.push(face);
            }
        };
        take(4 * first, star);
        let mut next = 0;
        while next < star.len() {
            let (id, entered) = (tet_of(star[next]), slot_of(star[next]));
            // A free vertex is inside with all around it.
            if !closed && !t.is_inside(id) {
                return false;
            }
            let tet = t.topology.tet(id);
            // The vertices of the face that it was reached through have been looked at.
            if is_near(tet.v[entered]) {
                return false;
            }
            next += 1;
            if let Some(&later) = star.get(next) {
                t.topology.tet(tet_of(later)).n.into_iter().for_each(fetch_mark);
            }
            for (slot, &behind) in tet.n.iter().enumerate() {
                if tet.v[slot] != w {
                    take(behind, star);
                }
            }
        }
        going.len() <= 2 * MAX_VERTICES
    }

    /// Keeps what is known but for the tetrahedra at vertex `number`. Faces that the others share with the hole are opened.
    fn keep(&mut self, known: &Forecast, number: u8) -> bool {
        let mut new = Few::default();
        for id in self.star.iter().map(|&face| tet_of(face)).filter(|&id| self.marks[id as usize] & KNOWN == 0) {
            new.add(id);
        }
        self.position.clear();
        let mut kept = 0;
        for tet in &known.filling {
            let goes = tet.v.contains(&number);
            self.position.push(if goes { GONE } else { kept });
            kept += u16::from(!goes);
        }
        for tet in &known.filling {
            let Some(apex) = tet.v.iter().position(|&v| v == number) else {
                let this = 4 * self.filling.len() as u16;
                let mut n = [0; 4];
                for (slot, &behind) in tet.n.iter().enumerate() {
                    let handle = this + slot as u16;
                    if behind & RIM == 0 {
                        let position = self.position[(behind >> 2) as usize];
                        if position != GONE {
                            n[slot] = 4 * position + (behind & 3);
                            continue;
                        }
                    } else {
                        let rim = known.rim[(behind & !RIM) as usize];
                        let beyond = tet_of(rim.beyond);
                        if rim.is_wall() || !new.may_have(beyond) || self.marks[beyond as usize] & STAR == 0 {
                            n[slot] = RIM | self.rim.len() as u16;
                            self.rim.push(Rim { inside: handle, ..rim });
                            continue;
                        }
                        self.marks[beyond as usize] |= MET;
                    }
                    // From the other side, where the hole is.
                    let [a, b, c] = FACE[slot].map(|k| tet.v[k]);
                    self.open.push([a, c, b], handle);
                }
                self.filling.push(Filling { n, ..*tet });
                continue;
            };
            let behind = tet.n[apex];
            if behind & RIM != 0 {
                self.open_rim(FACE[apex].map(|k| tet.v[k]), known.rim[(behind & !RIM) as usize]);
            }
        }
        let position = &self.position;
        let kept = known.obstacles.iter().map(|&i| position[i as usize]).filter(|&i| i != GONE);
        self.obstacles.extend(kept.map(u32::from));
        true
    }

    /// Opens the faces opposite `w` of the tetrahedra at it that were not known to go.
    fn open_star(&mut self, t: &Triangulation, boundary: &Boundary, w: u32, closed: bool) -> bool {
        for i in 0..self.star.len() {
            let id = tet_of(self.star[i]);
            // What is known beyond the face has been kept, and the face opened from there.
            if self.marks[id as usize] & (KNOWN | MET) != 0 {
                continue;
            }
            let tet = *t.topology.tet(id);
            let Some(slot) = tet.slot(w) else { return false };
            let face = FACE[slot].map(|k| tet.v[k]);
            let facet = boundary.wall(face);
            if facet.is_none() && !closed && !t.is_inside(tet_of(tet.n[slot])) {
                return false;
            }
            let face = face.map(|v| self.number_of(t, v));
            self.open_rim(face, Rim::new(tet.n[slot], facet));
        }
        self.vertices.len() <= MAX_VERTICES
    }
}
