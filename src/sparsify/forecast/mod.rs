//! What a replacement of vertices would create, foreseen in floating point.
//!
//! [`Triangulation::preview`] says it exactly, but takes tens of microseconds, and most of what is tried comes to nothing. So the pass of
//! [`sparsify`](super) asks here first, a few hundred nanoseconds a place:
//! - the hole that some vertices leave is opened ([`open`](Forecast::open)) and filled ([`fill`](Forecast::fill)) by gift wrapping (`wrap`);
//! - where a hole and its filling are known, that of one vertex more follows from them (`more`), and a point's cavity, as long as it is not
//!   inserted, is the filling of the hole that it would leave;
//! - [`try_point`](Forecast::try_point) inserts a point into a filling (`place`), and [`foresee`](Forecast::foresee) says what that would change in full.
//!
//! Nothing rests on the answers: what is found is decided exactly before it is done, and a hole where rounding leaves the wrapping open is
//! passed over. The operations are the same on every machine, whatever their width, so the choices are too.

mod foresee;
mod four;
mod more;
mod place;
mod wrap;

use glam::DVec3;

pub use place::Space;
use wrap::{Corners, OpenFaces};

use crate::domain::{Boundary, Unsplit};
use crate::triangulation::remove::Guess;
use crate::triangulation::topology::{tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::{memory, Control, Error};

/// Larger holes are not looked at.
const MAX_VERTICES: usize = 200;
/// Nor are stars with more tetrahedra looked through to see how much of them is inside.
const MAX_STAR: usize = 16 * MAX_VERTICES;
/// No number, no neighbour.
const NONE: u8 = u8::MAX;

/// A tetrahedron of the filling.
#[derive(Clone, Copy, Debug)]
pub struct Filling {
    /// Numbers of its vertices in the hole.
    pub v: [u8; 4],
    /// Behind the face opposite each: a [`Side`] packed.
    n: [u16; 4],
    /// Circumcentre, relative to the hole's origin.
    pub center: DVec3,
    /// Circumradius squared.
    pub radius2: f64,
    /// The tetrahedron that it is already, or [`ABSENT`].
    id: u32,
}

/// A face between the hole and the rest.
#[derive(Clone, Copy, Debug)]
struct Rim {
    /// Its handle beyond the hole; [`NOTHING`] for a subfacet that is still to come.
    beyond: u32,
    /// The sphere there.
    center: DVec3,
    radius2: f64,
    /// The face of the filling inside, `4·position + slot`.
    inside: u16,
    /// The facet of a subfacet, which no cavity may cross; or [`NOTHING`].
    facet: u32,
}

impl Rim {
    fn new(beyond: u32, facet: Option<u32>) -> Rim {
        Rim { beyond, center: DVec3::ZERO, radius2: -1.0, inside: 0, facet: facet.unwrap_or(NOTHING) }
    }

    fn is_wall(&self) -> bool {
        self.facet != NOTHING
    }
}

/// As many as there are numbers: no look at one has to be checked.
#[derive(Clone, Debug)]
struct Places(Box<[DVec3; 256]>);

impl Default for Places {
    fn default() -> Places {
        Places(Box::new([DVec3::ZERO; 256]))
    }
}

/// A tetrahedron that is still to come.
const ABSENT: u32 = u32::MAX;
/// No handle, no facet.
const NOTHING: u32 = u32::MAX;
/// Marks the place of a rim face among [`Filling::n`].
const RIM: u16 = 1 << 15;
/// The slots of the face opposite each slot, counterclockwise seen from inside.
const FACE: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// The demands on what comes.
#[derive(Clone, Copy, Debug)]
pub struct Demand {
    /// β².
    pub bound2: f64,
    /// Tetrahedra whose shortest edge is longer may be bad: they will be mended yet. Squared.
    pub level2: f64,
}

/// The hole of some vertices and its filling; memory is kept for the next.
#[derive(Clone, Debug, Default)]
pub struct Forecast {
    origin: DVec3,
    /// Where the vertices around the hole are, relative to the origin, by number.
    places: Places,
    /// The vertices around the hole, by number.
    pub vertices: Vec<u32>,
    /// By vertex id: its number.
    number: Vec<u8>,
    /// By tetrahedron: 0 for those that stay.
    marks: Vec<u16>,
    /// Whether the marks are those of another forecast's hole too, or another forecast has its own: see [`fill_more`](Forecast::fill_more).
    borrowed: bool,
    lent: bool,
    going: Vec<u32>,
    /// Tetrahedra at the vertices that go, outside the domain.
    outside: Vec<u32>,
    rim: Vec<Rim>,
    open: OpenFaces,
    corners: Corners,
    /// By position in `going`.
    parts: Vec<u32>,
    /// Scratch of `more`: the tetrahedra at its vertex, as the faces that they were reached through.
    star: Vec<u32>,
    /// Scratch of `more`: by position in the filling that was known, that in the new one. Of `foresee`: that among what comes.
    position: Vec<u16>,
    /// What fills the hole.
    pub filling: Vec<Filling>,
    /// Those of it that must not stay, by position.
    pub obstacles: Vec<u32>,
    hit: Vec<bool>,
    beyond: Vec<u32>,
    /// Where the last point that was tried would have to go to be better, as a unit vector.
    pub push: DVec3,
    /// What would go and what would come with the point that was decided for.
    pub guess: Guess,
    /// Scratch of `foresee`.
    links: foresee::Links,
}

/// Circumcentre and squared circumradius.
fn sphere([a, b, c, d]: [DVec3; 4]) -> (DVec3, f64) {
    let (u, v, w) = (b - a, c - a, d - a);
    let (vw, wu, uv) = (v.cross(w), w.cross(u), u.cross(v));
    let offset = (u.length_squared() * vw + v.length_squared() * wu + w.length_squared() * uv) / (2.0 * u.dot(vw));
    (a + offset, offset.length_squared())
}

impl Forecast {
    /// As long as the triangulation has room for tetrahedra and vertices, in pieces, so that no hole has to do it.
    pub fn grow_for(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        let (tetrahedra, vertices) = t.room();
        memory::lengthen(&mut self.marks, tetrahedra, 0, "marks", control)?;
        memory::lengthen(&mut self.number, vertices, NONE, "vertices", control)
    }

    /// Forgets the last hole and gets ready for one near `origin`.
    fn begin(&mut self, t: &Triangulation, origin: DVec3) {
        for &t in &self.going {
            self.marks[t as usize] = 0;
        }
        (self.borrowed, self.lent) = (false, false);
        if self.marks.len() < t.topology.tets.len() {
            self.marks.resize(t.topology.tets.capacity(), 0);
        }
        self.begin_lists(t, origin);
    }

    /// Forgets all but the marks.
    fn begin_lists(&mut self, t: &Triangulation, origin: DVec3) {
        for &v in &self.vertices {
            self.number[v as usize] = NONE;
        }
        self.vertices.clear();
        self.going.clear();
        self.outside.clear();
        self.star.clear();
        self.rim.clear();
        self.open.clear();
        self.filling.clear();
        self.obstacles.clear();
        self.origin = origin;
        if self.number.len() < t.vertex_slots() {
            self.number.resize(2 * t.vertex_slots(), NONE);
        }
    }

    /// Opens the hole that these vertices leave. False when it is too large.
    pub fn open(&mut self, t: &Triangulation, remove: &[u32]) -> bool {
        self.begin(t, t.at(remove[0]));
        self.find_stars(t, remove)
    }

    /// The tetrahedra that go.
    pub fn going(&self) -> &[u32] {
        &self.going
    }

    /// The stars of the vertices that an open hole is of, outside the domain, too.
    pub fn stars(&self) -> impl Iterator<Item = u32> + Clone + '_ {
        self.going.iter().chain(&self.outside).copied()
    }

    /// Fills the open hole of these vertices. `plan` is what becomes of the boundary. False when it can't be foreseen, or more than `most`
    /// obstacles come.
    pub fn fill(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        remove: &[u32],
        plan: &Unsplit,
        demand: Demand,
        most: usize,
    ) -> bool {
        self.parts.clear();
        if plan.facets.is_empty() {
            return (0..self.going.len()).all(|i| self.open_at(t, boundary, i, remove, &mut Vec::new()))
                && self.wrap(demand, most);
        }
        // Each part of the domain by itself: walls stand between them.
        self.find_parts(t, boundary);
        let count = self.parts.iter().copied().max().map_or(0, |last| last + 1);
        for part in 0..count {
            let mut sides: Vec<(u32, bool)> = Vec::new();
            for i in 0..self.going.len() {
                if self.parts[i] == part && !self.open_at(t, boundary, i, remove, &mut sides) {
                    return false;
                }
            }
            for (facet, forward) in sides {
                let Some((_, change)) = plan.facets.iter().find(|(f, _)| *f == facet) else { return false };
                for &[a, b, c] in &change.created {
                    let face = if forward { [a, b, c] } else { [a, c, b] }.map(|v| self.number_of(t, v));
                    self.open_rim(face, Rim::new(NOTHING, Some(facet)));
                }
            }
            if !self.wrap(demand, most) {
                return false;
            }
        }
        true
    }

    /// Opens the faces of a tetrahedron that goes. Those whose subfacet goes too are only noted in `sides`: the facet, and whether it is seen from
    /// its positive side.
    fn open_at(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        i: usize,
        remove: &[u32],
        sides: &mut Vec<(u32, bool)>,
    ) -> bool {
        let tet = *t.topology.tet(self.going[i]);
        let walls = boundary.possible_walls(tet.v);
        for (slot, &behind) in tet.n.iter().enumerate() {
            let beyond = tet_of(behind);
            let face = FACE[slot].map(|k| tet.v[k]);
            let facet = boundary.wall_among(walls, slot, face);
            if self.marks[beyond as usize] != 0 && facet.is_none() {
                continue;
            }
            match facet {
                // Two sides of one wall don't go into one list.
                Some(_) if self.parts.is_empty() && self.marks[beyond as usize] != 0 => return false,
                Some(facet) if face.iter().any(|v| remove.contains(v)) => {
                    let Some(forward) = boundary.facets()[facet as usize].is_forward(face) else { return false };
                    if !sides.contains(&(facet, forward)) {
                        sides.push((facet, forward));
                    }
                }
                // Nothing but a subfacet parts the domain from what is outside, unless one could not be recovered.
                None if !t.is_inside(beyond) => return false,
                _ => {
                    let face = face.map(|v| self.number_of(t, v));
                    self.open_rim(face, Rim::new(behind, facet));
                }
            }
        }
        self.vertices.len() <= MAX_VERTICES
    }

    fn open_rim(&mut self, face: [u8; 3], rim: Rim) {
        self.open.push(face, RIM | self.rim.len() as u16);
        self.rim.push(rim);
    }

    /// Numbers the parts into which walls part the tetrahedra that go.
    fn find_parts(&mut self, t: &Triangulation, boundary: &Boundary) {
        self.parts.clear();
        self.parts.resize(self.going.len(), u32::MAX);
        let place: rustc_hash::FxHashMap<u32, usize> = self.going.iter().enumerate().map(|(i, &t)| (t, i)).collect();
        let mut part = 0;
        for seed in 0..self.going.len() {
            if self.parts[seed] != u32::MAX {
                continue;
            }
            self.parts[seed] = part;
            let mut stack = vec![seed];
            while let Some(i) = stack.pop() {
                let tet = t.topology.tet(self.going[i]);
                for slot in 0..4 {
                    if let Some(&j) = place.get(&tet_of(tet.n[slot])) {
                        if self.parts[j] == u32::MAX && boundary.wall(tet.face(slot)).is_none() {
                            self.parts[j] = part;
                            stack.push(j);
                        }
                    }
                }
            }
            part += 1;
        }
    }

    /// What of the stars of the vertices lies in the domain; false when it is too large.
    fn find_stars(&mut self, t: &Triangulation, remove: &[u32]) -> bool {
        for &v in remove {
            let first = t.topology.vertex_tet[v as usize];
            if self.marks[first as usize] == 0 {
                self.marks[first as usize] = 1;
                self.going.push(first);
            }
            let mut next = 0;
            while next < self.going.len() {
                let tet = t.topology.tet(self.going[next]);
                next += 1;
                if !tet.v.contains(&v) {
                    continue;
                }
                for (slot, &n) in tet.n.iter().enumerate() {
                    let n = tet_of(n);
                    if tet.v[slot] != v && self.marks[n as usize] == 0 {
                        self.marks[n as usize] = 1;
                        self.going.push(n);
                    }
                }
                if self.going.len() > MAX_STAR {
                    return false;
                }
            }
        }
        let Forecast { marks, outside, .. } = self;
        self.going.retain(|&id| {
            let inside = t.is_inside(id);
            if !inside {
                marks[id as usize] = 0;
                outside.push(id);
            }
            inside
        });
        self.going.len() <= 2 * MAX_VERTICES
    }

    #[inline(always)]
    fn number_of(&mut self, t: &Triangulation, v: u32) -> u8 {
        match self.number[v as usize] {
            NONE => self.new_number(t, v),
            number => number,
        }
    }

    #[inline(never)]
    fn new_number(&mut self, t: &Triangulation, v: u32) -> u8 {
        debug_assert!(v != GHOST);
        let number = self.vertices.len().min(MAX_VERTICES) as u8;
        self.number[v as usize] = number;
        self.vertices.push(v);
        self.places.0[number as usize] = t.at(v) - self.origin;
        number
    }

    /// The number of a vertex, if it is of the hole.
    #[inline]
    pub fn number_in_hole(&self, v: u32) -> Option<u8> {
        self.number.get(v as usize).copied().filter(|&number| number != NONE)
    }

    /// The distance from a vertex to the nearest other one that it has an edge to in the filling.
    pub fn spacing(&self, number: u8) -> f64 {
        let p = self.at(number);
        let at_it = self.filling.iter().filter(|tet| tet.v.contains(&number));
        let others = at_it.flat_map(|tet| tet.v).filter(|&v| v != number);
        others.map(|v| self.at(v).distance_squared(p)).fold(f64::INFINITY, f64::min).sqrt()
    }

    #[inline]
    fn at(&self, v: u8) -> DVec3 {
        self.places.0[v as usize]
    }
}
