//! Holes that follow from what is known: a point's cavity is the filling of the hole that the point would leave, and the filling of the
//! hole of two vertices is that of the one, but for the star of the other in it, which is wrapped anew.

use glam::DVec3;

use super::{sphere, Demand, Filling, Forecast, Rim, FACE, MAX_VERTICES, NONE, RIM, WALL};
use crate::domain::Boundary;
use crate::geometry::quality::EDGES;
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{slot_of, tet_of};
use crate::triangulation::Triangulation;

/// Marks of the tetrahedra that go with the known hole, and those at the vertex.
const KNOWN: u16 = 1;
const STAR: u16 = 2;
/// A tetrahedron of the known filling that has the vertex.
const GONE: u16 = u16::MAX;

impl Forecast {
    /// Takes the cavity of a point that is not inserted as what would fill its hole. False when it is too large, or not free of walls.
    pub fn take_cavity(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        p: DVec3,
        cavity: &Cavity,
        demand: Demand,
    ) -> bool {
        self.begin(t, p);
        if cavity.tets.len() > 2 * MAX_VERTICES {
            return false;
        }
        self.going.extend_from_slice(&cavity.tets);
        for (&id, mark) in cavity.tets.iter().zip(1..) {
            self.marks[id as usize] = mark;
        }
        for (i, &id) in cavity.tets.iter().enumerate() {
            if !t.is_inside(id) {
                return false;
            }
            let tet = t.topology.tet(id);
            let v = tet.v.map(|v| self.number_of(t, v));
            let mut n = [0; 4];
            for (slot, &behind) in tet.n.iter().enumerate() {
                let facet = boundary.wall(FACE[slot].map(|k| tet.v[k]));
                let beyond = tet_of(behind);
                let position = self.marks[beyond as usize];
                n[slot] = if position != 0 {
                    if facet.is_some() {
                        return false;
                    }
                    4 * (position - 1) + slot_of(behind) as u16
                } else {
                    if facet.is_none() && !t.is_inside(beyond) {
                        return false;
                    }
                    let rim = facet.map_or(Rim::new(behind), |facet| Rim { facet, ..Rim::new(WALL) });
                    self.rim.push(Rim { inside: 4 * i as u16 + slot as u16, ..rim });
                    RIM | (self.rim.len() - 1) as u16
                };
            }
            let corners = v.map(|v| self.at(v));
            let (center, radius2) = sphere(corners);
            let length2 = |[i, j]: [usize; 2]| corners[i].distance_squared(corners[j]);
            let shortest2 = EDGES.into_iter().map(length2).fold(f64::INFINITY, f64::min);
            if radius2 > demand.bound2 * shortest2 && shortest2 <= demand.level2 {
                self.obstacles.push(i as u32);
            }
            self.filling.push(Filling { v, n, center, radius2, id });
        }
        self.vertices.len() <= MAX_VERTICES
    }

    /// Opens and fills the hole that the vertex `w`, which lies on no segment or facet, leaves together with the `known` one. False when it can't be
    /// foreseen, when `w` has a neighbour nearer than `spacing`, or when more than `most` obstacles come.
    pub fn fill_more(
        &mut self,
        known: &Forecast,
        t: &Triangulation,
        boundary: &Boundary,
        (w, spacing): (u32, f64),
        demand: Demand,
        most: usize,
    ) -> bool {
        let number = known.number.get(w as usize).copied().unwrap_or(NONE);
        if number == NONE {
            return false;
        }
        self.begin(t, known.origin);
        self.vertices.extend_from_slice(&known.vertices);
        for (&v, number) in known.vertices.iter().zip(0..) {
            self.number[v as usize] = number;
        }
        let count = known.vertices.len();
        for (list, other) in [(&mut self.x, &known.x), (&mut self.y, &known.y), (&mut self.z, &known.z)] {
            list.extend_from_slice(&other[..count]);
            // It is nobody's apex.
            list[number as usize] = f64::NAN;
        }
        self.going.extend_from_slice(&known.going);
        for &id in &known.going {
            self.marks[id as usize] = KNOWN;
        }
        self.find_star(t, w, spacing * spacing)
            && self.keep(known, number)
            && self.obstacles.len() <= most
            && self.open_star(t, boundary, w)
            && self.wrap(demand, most)
    }

    /// The tetrahedra at a vertex; false when some lie outside, or a squared edge there is shorter than `least`.
    fn find_star(&mut self, t: &Triangulation, w: u32, least: f64) -> bool {
        let Forecast { star, marks, going, .. } = self;
        star.clear();
        let (first, p) = (t.topology.vertex_tet[w as usize], t.at(w));
        let mut take = |id: u32, star: &mut Vec<u32>| {
            let mark = &mut marks[id as usize];
            if *mark & STAR == 0 {
                if *mark == 0 {
                    going.push(id);
                }
                *mark |= STAR;
                star.push(id);
            }
        };
        take(first, star);
        let mut next = 0;
        while next < star.len() {
            if !t.is_inside(star[next]) {
                return false;
            }
            let tet = t.topology.tet(star[next]);
            next += 1;
            for (slot, &behind) in tet.n.iter().enumerate() {
                if tet.v[slot] != w {
                    if t.at(tet.v[slot]).distance_squared(p) < least {
                        return false;
                    }
                    take(tet_of(behind), star);
                }
            }
        }
        going.len() <= 2 * MAX_VERTICES
    }

    /// Keeps what is known but for the tetrahedra at vertex `number`. Faces that the others share with the hole are opened.
    fn keep(&mut self, known: &Forecast, number: u8) -> bool {
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
                        if rim.beyond == WALL || self.marks[tet_of(rim.beyond) as usize] & STAR == 0 {
                            n[slot] = RIM | self.rim.len() as u16;
                            self.rim.push(Rim { inside: handle, ..rim });
                            continue;
                        }
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
    fn open_star(&mut self, t: &Triangulation, boundary: &Boundary, w: u32) -> bool {
        for i in 0..self.star.len() {
            let id = self.star[i];
            if self.marks[id as usize] & KNOWN != 0 {
                continue;
            }
            let tet = *t.topology.tet(id);
            let Some(slot) = tet.slot(w) else { return false };
            let face = FACE[slot].map(|k| tet.v[k]);
            let facet = boundary.wall(face);
            let beyond = tet_of(tet.n[slot]);
            if facet.is_none() {
                // What is known there has been kept, and opened from its side.
                if self.marks[beyond as usize] & KNOWN != 0 {
                    continue;
                }
                if !t.is_inside(beyond) {
                    return false;
                }
            }
            let face = face.map(|v| self.number_of(t, v));
            let rim = facet.map_or(Rim::new(tet.n[slot]), |facet| Rim { facet, ..Rim::new(WALL) });
            self.open_rim(face, rim);
        }
        self.vertices.len() <= MAX_VERTICES
    }
}
