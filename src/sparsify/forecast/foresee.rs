//! What the insertion of a point into a filling would change, in full: the tetrahedra that go and those that come, with their neighbours. It is a
//! [`Guess`], to be certified. Around the point the new tetrahedra find each other as in a cavity (`triangulation::star`): through a square table of the
//! directed edges of its surface.

use super::place::{Behind, Surface};
use super::{Forecast, ABSENT, MAX_VERTICES, RIM};
use crate::domain::Boundary;
use crate::triangulation::remove::{Linked, ADDED};
use crate::triangulation::topology::NONE;
use crate::triangulation::Triangulation;
use crate::DVec3;

/// Scratch of [`Forecast::foresee`].
#[derive(Clone, Debug, Default)]
pub(super) struct Links {
    /// The surface of the point's cavity.
    surface: Faces,
    /// By face of the filling, `4·position + slot`: the face of the star before it, or [`NONE`].
    star: Vec<u32>,
    /// By directed edge of the surface, between the vertices' numbers: the face of the star there. What it says of other edges is left from before.
    edges: Vec<u32>,
}

/// The faces of a surface: their vertices and what is behind them.
#[derive(Clone, Debug, Default)]
struct Faces(Vec<([u32; 3], Behind)>);

impl Surface for Faces {
    #[inline]
    fn join(&mut self, _: impl FnOnce() -> [DVec3; 3], vertices: impl FnOnce() -> [u32; 3], behind: Behind) -> bool {
        self.0.push((vertices(), behind));
        true
    }
}

impl Forecast {
    /// Says in full what the insertion of `p`, on no facet, into the filling of a hole without new subfacets would change: the `guess`. False when it can't be done.
    pub fn foresee(&mut self, t: &Triangulation, boundary: &Boundary, p: DVec3) -> bool {
        let q = p - self.origin;
        self.hit.clear();
        self.hit.extend(self.filling.iter().map(|tet| q.distance_squared(tet.center) < tet.radius2));
        let mut links = std::mem::take(&mut self.links);
        let surface = &mut links.surface;
        surface.0.clear();
        self.beyond.clear();
        let fits = self.join_within(t, q, &[], surface)
            && self.join_beyond(t, boundary, q, &[], surface)
            && self.join_rim(surface)
            && self.link_coming(t, &mut links);
        self.links = links;
        self.find_going();
        for &id in &self.beyond {
            self.marks[id as usize] = 0;
        }
        fits
    }

    /// What goes: all of the hole and the cavity but what is there already and stays, which loses its mark.
    fn find_going(&mut self) {
        for (tet, _) in self.filling.iter().zip(&self.hit).filter(|(_, &hit)| !hit) {
            if tet.id != ABSENT {
                self.marks[tet.id as usize] = 0;
            }
        }
        let going = &mut self.guess.going;
        going.clear();
        going.extend(self.going.iter().filter(|&&id| self.marks[id as usize] != 0).chain(&self.beyond));
    }

    /// What comes: the star, and of the filling what the point's cavity leaves. False when there are too many vertices.
    fn link_coming(&mut self, t: &Triangulation, links: &mut Links) -> bool {
        let Links { surface: Faces(surface), star, edges } = links;
        self.find_positions(surface.len());
        star.clear();
        star.resize(4 * self.filling.len(), NONE);
        // As many as may be met: those of the hole, and of the cavity beyond it.
        for &(face, _) in surface.iter() {
            face.iter().for_each(|&v| _ = self.number_of(t, v));
        }
        if self.vertices.len() > MAX_VERTICES {
            return false;
        }
        let size = self.vertices.len().next_power_of_two();
        if edges.len() < size * size {
            edges.resize(size * size, NONE);
        }
        let edge = |a: u8, b: u8| a as usize * size + b as usize;
        for (&(face, behind), i) in surface.iter().zip(0..) {
            let [a, b, c] = face.map(|v| self.number[v as usize]);
            for ((a, b), slot) in [(b, c), (c, a), (a, b)].into_iter().zip(0..) {
                edges[edge(a, b)] = 4 * i + slot;
            }
            if let Behind::Filling(behind) = behind {
                star[behind as usize] = 4 * i + 3;
            }
        }
        let mut coming = std::mem::take(&mut self.guess.coming);
        coming.clear();
        for &(face, behind) in surface.iter() {
            let [a, b, c] = face.map(|v| self.number[v as usize]);
            let (behind, rim) = match behind {
                Behind::Filling(behind) => self.link_to_filling(behind),
                Behind::Outside(handle) => (handle, true),
            };
            let n = [edges[edge(c, b)], edges[edge(a, c)], edges[edge(b, a)], behind];
            coming.push(Linked { v: [face[0], face[1], face[2], ADDED], n, rim: u8::from(rim) << 3 });
        }
        for (i, tet) in self.filling.iter().enumerate().filter(|&(i, tet)| !self.hit[i] && tet.id == ABSENT) {
            let mut linked = Linked { v: tet.v.map(|v| self.vertices[v as usize]), n: [NONE; 4], rim: 0 };
            for (slot, &behind) in tet.n.iter().enumerate() {
                let joined = star[4 * i + slot];
                let (n, rim) = if joined != NONE {
                    (joined, false)
                } else if behind & RIM != 0 {
                    (self.rim[(behind & !RIM) as usize].beyond, true)
                } else {
                    self.link_to_filling(behind)
                };
                linked.n[slot] = n;
                linked.rim |= u8::from(rim) << slot;
            }
            coming.push(linked);
        }
        self.guess.coming = coming;
        true
    }

    /// Numbers what of the filling comes, after the star.
    fn find_positions(&mut self, star: usize) {
        let mut next = star as u16;
        self.position.clear();
        for (tet, &hit) in self.filling.iter().zip(&self.hit) {
            self.position.push(next);
            next += u16::from(!hit && tet.id == ABSENT);
        }
    }

    /// A face of what the cavity leaves of the filling, as a neighbour: among what comes, or, where its tetrahedron stays, outside.
    fn link_to_filling(&self, face: u16) -> (u32, bool) {
        let (tet, slot) = ((face >> 2) as usize, u32::from(face & 3));
        match self.filling[tet].id {
            ABSENT => (4 * u32::from(self.position[tet]) + slot, false),
            id => (4 * id + slot, true),
        }
    }
}
