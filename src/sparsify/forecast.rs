//! What a replacement of vertices would create, foreseen in floating point.
//!
//! [`Triangulation::preview`] says it exactly, but takes tens of microseconds, and most of what is tried comes to nothing. So the pass of
//! [`sparsify`](super::sparsify) asks here first, a few hundred nanoseconds a place:
//! - [`open`](Forecast::open) opens the hole that some vertices leave and fills it by gift wrapping (a face's apex is the vertex whose sphere through the
//!   face reaches least far inside);
//! - [`try_point`](Forecast::try_point) inserts a point into that filling: its cavity are the tetrahedra whose balls hold it, there and
//!   beyond the hole's rim, and its star joins it to the cavity's border.
//!
//! Nothing rests on the answers: what is found is decided exactly before it is done, and a hole where rounding leaves the wrapping open is
//! passed over. The operations are the same on every machine, whatever their width, so the choices are too.

use glam::DVec3;

use crate::domain::{Boundary, Unsplit};
use crate::triangulation::topology::{tet_of, GHOST};
use crate::triangulation::Triangulation;

/// Larger holes are not looked at.
const MAX_VERTICES: usize = 200;
/// Nor are cavities that reach over more tetrahedra than this beyond the hole.
const MAX_BEYOND: usize = 64;
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
    /// Shortest edge squared.
    pub shortest2: f64,
}

/// A face between the hole and the rest.
#[derive(Clone, Copy, Debug)]
struct Rim {
    /// Its handle beyond the hole, [`WALL`] when no cavity may cross it.
    beyond: u32,
    /// The sphere there.
    center: DVec3,
    radius2: f64,
    /// The face of the filling inside, `4·position + slot`.
    inside: u16,
    /// The facet of a subfacet.
    facet: u32,
}

/// Beyond a wall: a subfacet, or the hull.
const WALL: u32 = u32::MAX;
/// Marks the place of a rim face among [`Filling::n`].
const RIM: u16 = 1 << 15;

/// The slots of the face opposite each slot, counterclockwise seen from inside.
const FACE: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// A face still to be wrapped.
#[derive(Clone, Copy, Debug)]
struct Open {
    /// Its vertices, counterclockwise seen from where its tetrahedron will be.
    v: [u8; 3],
    /// What lies behind it, as in [`Filling::n`].
    behind: u16,
}

/// A face's vertices, sorted and packed.
#[inline]
fn packed(v: [u8; 3]) -> u32 {
    let [a, b, c] = v.map(u32::from);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    low << 16 | (a + b + c - low - high) << 8 | high
}

/// The faces still to be wrapped, with their keys apart: looking for one is most of what is done with them.
#[derive(Clone, Debug, Default)]
struct OpenFaces {
    keys: Vec<u32>,
    faces: Vec<Open>,
}

impl OpenFaces {
    #[inline]
    fn push(&mut self, v: [u8; 3], behind: u16) {
        self.keys.push(packed(v));
        self.faces.push(Open { v, behind });
    }

    fn pop(&mut self) -> Option<Open> {
        self.keys.pop();
        self.faces.pop()
    }

    /// Takes the face with these vertices out. Returns what lies behind it.
    #[inline]
    fn take(&mut self, v: [u8; 3]) -> Option<u16> {
        let key = packed(v);
        const LANES: usize = 8;
        let chunks = self.keys.chunks_exact(LANES);
        let rest = chunks.remainder();
        let mut place = None;
        for (i, chunk) in chunks.enumerate() {
            let mut found = 0u32;
            for (lane, &k) in chunk.iter().enumerate() {
                found |= u32::from(k == key) << lane;
            }
            if found != 0 {
                place = Some(i * LANES + found.trailing_zeros() as usize);
                break;
            }
        }
        let start = self.keys.len() - rest.len();
        let place = place.or_else(|| rest.iter().position(|&k| k == key).map(|i| start + i))?;
        self.keys.swap_remove(place);
        Some(self.faces.swap_remove(place).behind)
    }

    fn clear(&mut self) {
        self.keys.clear();
        self.faces.clear();
    }

    fn len(&self) -> usize {
        self.faces.len()
    }
}

/// What a point would do to the filling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The largest R²/(β·l)² among tetrahedra that must keep the bound; at most 1 when all do.
    pub worst: f64,
    /// What the others lack: the sum of 1 − (β·l)²/R² over the bad ones.
    pub lack: f64,
}

impl Outcome {
    /// It can't be done.
    pub const NO: Outcome = Outcome { worst: f64::INFINITY, lack: f64::INFINITY };

    /// Whether everything that must keep the bound keeps it.
    pub fn is_good(&self) -> bool {
        self.worst <= 1.0
    }

    /// Whether this is the better one.
    pub fn beats(&self, other: &Outcome) -> bool {
        if self.is_good() && other.is_good() {
            return self.lack < other.lack;
        }
        self.worst < other.worst
    }
}

/// The demands on what comes.
#[derive(Clone, Copy, Debug)]
pub struct Demand {
    /// β².
    pub bound2: f64,
    /// Tetrahedra whose shortest edge is longer may be bad: they will be mended yet. Squared.
    pub level2: f64,
}

/// Where a point may go: anywhere, in a facet's plane, or along a segment.
#[derive(Clone, Copy, Debug)]
pub struct Space {
    /// Orthogonal unit vectors.
    pub axes: [DVec3; 3],
    /// How many of them count.
    pub dimension: usize,
}

impl Space {
    /// The part of a step that is possible.
    pub fn along(&self, step: DVec3) -> DVec3 {
        self.axes[..self.dimension].iter().map(|&axis| axis * axis.dot(step)).fold(DVec3::ZERO, |sum, part| sum + part)
    }
}

/// The hole of some vertices and its filling; memory is kept for the next.
#[derive(Clone, Debug, Default)]
pub struct Forecast {
    origin: DVec3,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    /// The vertices around the hole, by number.
    pub vertices: Vec<u32>,
    /// By vertex id: its number.
    number: Vec<u8>,
    /// By tetrahedron: whether it goes.
    marks: Vec<u8>,
    going: Vec<u32>,
    rim: Vec<Rim>,
    open: OpenFaces,
    /// By position in `going`.
    parts: Vec<u32>,
    /// What fills the hole.
    pub filling: Vec<Filling>,
    /// Those of it that must not stay, by position.
    pub obstacles: Vec<u32>,
    hit: Vec<bool>,
    beyond: Vec<u32>,
}

/// Circumcentre and squared circumradius.
fn sphere([a, b, c, d]: [DVec3; 4]) -> (DVec3, f64) {
    let (u, v, w) = (b - a, c - a, d - a);
    let (vw, wu, uv) = (v.cross(w), w.cross(u), u.cross(v));
    let offset = (u.length_squared() * vw + v.length_squared() * wu + w.length_squared() * uv) / (2.0 * u.dot(vw));
    (a + offset, offset.length_squared())
}

impl Forecast {
    fn clear(&mut self) {
        for &v in &self.vertices {
            self.number[v as usize] = NONE;
        }
        for &t in &self.going {
            self.marks[t as usize] = 0;
        }
        self.vertices.clear();
        self.going.clear();
        self.rim.clear();
        self.open.clear();
        self.filling.clear();
        self.obstacles.clear();
        self.x.clear();
        self.y.clear();
        self.z.clear();
    }

    /// Opens the hole that these vertices leave. False when it is too large.
    pub fn open(&mut self, t: &Triangulation, remove: &[u32]) -> bool {
        self.clear();
        self.origin = t.at(remove[0]);
        if self.number.len() < t.vertex_slots() {
            self.number.resize(2 * t.vertex_slots(), NONE);
        }
        if self.marks.len() < t.topology.tets.len() {
            self.marks.resize(t.topology.tets.capacity(), 0);
        }
        self.find_stars(t, remove)
    }

    /// The tetrahedra that go.
    pub fn going(&self) -> &[u32] {
        &self.going
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
                    self.open_wall(face, facet);
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
        for (slot, &behind) in tet.n.iter().enumerate() {
            let beyond = tet_of(behind);
            let face = FACE[slot].map(|k| tet.v[k]);
            let facet = boundary.wall(face);
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
                Some(facet) => {
                    let face = face.map(|v| self.number_of(t, v));
                    self.open_wall(face, facet);
                }
                None => {
                    let face = face.map(|v| self.number_of(t, v));
                    // Nothing but a subfacet parts the domain from what is outside, unless one could not be recovered.
                    if !t.is_inside(beyond) {
                        return false;
                    }
                    self.open.push(face, RIM | self.rim.len() as u16);
                    self.rim.push(Rim { beyond: behind, center: DVec3::ZERO, radius2: -1.0, inside: 0, facet: WALL });
                }
            }
        }
        self.vertices.len() <= MAX_VERTICES
    }

    /// Gets ready for [`try_point`](Self::try_point).
    pub fn aim(&mut self, t: &Triangulation) {
        for rim in self.rim.iter_mut().filter(|rim| rim.beyond != WALL) {
            (rim.center, rim.radius2) = sphere(t.corners(tet_of(rim.beyond)).map(|p| p - self.origin));
        }
    }

    fn open_wall(&mut self, face: [u8; 3], facet: u32) {
        self.open.push(face, RIM | self.rim.len() as u16);
        self.rim.push(Rim { beyond: WALL, center: DVec3::ZERO, radius2: -1.0, inside: 0, facet });
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
            }
        }
        let marks = &mut self.marks;
        self.going.retain(|&id| {
            let inside = t.is_inside(id);
            if !inside {
                marks[id as usize] = 0;
            }
            inside
        });
        self.going.len() <= 2 * MAX_VERTICES
    }

    fn number_of(&mut self, t: &Triangulation, v: u32) -> u8 {
        debug_assert!(v != GHOST);
        let number = &mut self.number[v as usize];
        if *number == NONE {
            let count = self.vertices.len();
            *number = count.min(MAX_VERTICES) as u8;
            self.vertices.push(v);
            let p = t.at(v) - self.origin;
            for (list, x) in [(&mut self.x, p.x), (&mut self.y, p.y), (&mut self.z, p.z)] {
                list.truncate(count);
                list.push(x);
            }
        }
        *number
    }

    #[inline]
    fn at(&self, v: u8) -> DVec3 {
        DVec3::new(self.x[v as usize], self.y[v as usize], self.z[v as usize])
    }

    /// Fills the hole inside the open faces. False when they don't close.
    fn wrap(&mut self, demand: Demand, most: usize) -> bool {
        let limit = 4 * self.open.len() + 40;
        // A place at NaN lies beyond no face.
        for list in [&mut self.x, &mut self.y, &mut self.z] {
            list.resize(self.vertices.len().next_multiple_of(4), f64::NAN);
        }
        while let Some(face) = self.open.pop() {
            if self.filling.len() >= limit {
                return false;
            }
            let [a, b, c] = face.v.map(|v| self.at(v));
            let (u, w) = (b - a, c - a);
            let n = u.cross(w);
            let nn = n.length_squared();
            let offset = (w.length_squared() * n.cross(u) + u.length_squared() * w.cross(n)) / (2.0 * nn);
            let Some((apex, tau)) = self.apex(a, n, 2.0 * offset, 1e-18 * nn) else { return false };
            let d = self.at(apex);
            let shortest2 = u
                .length_squared()
                .min(w.length_squared())
                .min(b.distance_squared(c))
                .min(a.distance_squared(d))
                .min(b.distance_squared(d))
                .min(c.distance_squared(d));
            let [i, j, k] = face.v;
            let this = self.filling.len() as u16;
            let mut tet = Filling {
                v: [i, j, k, apex],
                n: [0, 0, 0, face.behind],
                center: a + offset + tau * n,
                radius2: offset.length_squared() + tau * tau * nn,
                shortest2,
            };
            self.link(face.behind, 4 * this + 3);
            // The other faces, seen from beyond.
            for (slot, v) in [[j, k, apex], [k, i, apex], [i, j, apex]].into_iter().enumerate() {
                let other = 4 * this + slot as u16;
                match self.open.take(v) {
                    Some(behind) => {
                        tet.n[slot] = behind;
                        self.link(behind, other);
                    }
                    None => self.open.push(v, other),
                }
            }
            if tet.radius2 > demand.bound2 * shortest2 && shortest2 <= demand.level2 {
                if self.obstacles.len() == most {
                    return false;
                }
                self.obstacles.push(u32::from(this));
            }
            self.filling.push(tet);
        }
        true
    }

    /// Notes at one side of a face what the other is.
    #[inline]
    fn link(&mut self, side: u16, other: u16) {
        if side & RIM == 0 {
            self.filling[(side >> 2) as usize].n[(side & 3) as usize] = other;
        } else {
            self.rim[(side & !RIM) as usize].inside = other;
        }
    }

    /// The vertex beyond a face (through `a`, with normal `n`, `twice` the offset of its circumcentre) whose sphere reaches least far,
    /// with the height of that sphere's centre in normals.
    #[inline]
    fn apex(&mut self, a: DVec3, n: DVec3, twice: DVec3, flat: f64) -> Option<(u8, f64)> {
        #[cfg(target_arch = "x86_64")]
        if crate::geometry::lanes::Avx2::available() {
            // SAFETY: the processor has what the function is compiled for.
            return unsafe { lowest_avx2(&self.x, &self.y, &self.z, a, n, twice, flat) };
        }
        lowest(&self.x, &self.y, &self.z, a, n, twice, flat)
    }

    /// Moves a point into the balls of all obstacles that `wanted` asks for: it has to be there to do away with them. False when that fails.
    pub fn move_into_obstacles(&self, p: &mut DVec3, space: &Space, wanted: impl Fn(&Filling) -> bool) -> bool {
        let mut q = *p - self.origin;
        for _ in 0..12 {
            let mut worst = (0.0, DVec3::ZERO);
            for &i in &self.obstacles {
                let ball = &self.filling[i as usize];
                if !wanted(ball) {
                    continue;
                }
                let d = q - ball.center;
                let distance = d.length();
                let over = distance - 0.98 * ball.radius2.sqrt();
                if over > worst.0 {
                    worst = (over, d * (over / distance));
                }
            }
            if worst.0 == 0.0 {
                *p = q + self.origin;
                return true;
            }
            q -= space.along(1.02 * worst.1);
        }
        false
    }

    /// What comes when `p`, which lies on the facets `on`, is inserted into the filling. Gives up as soon as it is worse than `cap`.
    pub fn try_point(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        p: DVec3,
        on: &[u32],
        demand: Demand,
        cap: f64,
    ) -> Outcome {
        let q = p - self.origin;
        self.hit.clear();
        self.hit.extend(self.filling.iter().map(|tet| q.distance_squared(tet.center) < tet.radius2));
        if self.obstacles.iter().any(|&i| !self.hit[i as usize]) {
            return Outcome::NO;
        }
        self.beyond.clear();
        let mut outcome = Outcome { worst: 0.0, lack: 0.0 };
        let mut possible = true;
        for (tet, &hit) in self.filling.iter().zip(&self.hit) {
            if !hit {
                if tet.radius2 > demand.bound2 * tet.shortest2 {
                    outcome.lack += 1.0 - demand.bound2 * tet.shortest2 / tet.radius2;
                }
                continue;
            }
            for (slot, &n) in tet.n.iter().enumerate() {
                if n & RIM == 0 {
                    if self.hit[(n >> 2) as usize] {
                        continue;
                    }
                } else {
                    let rim = &self.rim[(n & !RIM) as usize];
                    if on.contains(&rim.facet) {
                        continue;
                    }
                    if rim.radius2 > q.distance_squared(rim.center) {
                        let id = tet_of(rim.beyond);
                        if self.marks[id as usize] == 0 {
                            self.marks[id as usize] = 1;
                            self.beyond.push(id);
                        }
                        continue;
                    }
                }
                let corners = FACE[slot].map(|k| self.at(tet.v[k]));
                possible &= join(corners, q, demand, &mut outcome) && outcome.worst <= cap;
                if !possible {
                    break;
                }
            }
            if !possible {
                break;
            }
        }
        // The cavity beyond the rim.
        let mut next = 0;
        while possible && next < self.beyond.len() {
            let tet = *t.topology.tet(self.beyond[next]);
            next += 1;
            for (slot, &n) in tet.n.iter().enumerate() {
                let n = tet_of(n);
                match boundary.wall(tet.face(slot)) {
                    Some(facet) if on.contains(&facet) => continue,
                    Some(_) => {}
                    // Of the hole, or of the cavity already.
                    None if self.marks[n as usize] != 0 => continue,
                    None if !t.is_inside(n) => {}
                    None => {
                        let (center, radius2) = sphere(t.corners(n).map(|p| p - self.origin));
                        if q.distance_squared(center) < radius2 {
                            self.marks[n as usize] = 1;
                            self.beyond.push(n);
                            continue;
                        }
                    }
                }
                let corners = FACE[slot].map(|k| t.at(tet.v[k]) - self.origin);
                possible &= join(corners, q, demand, &mut outcome) && outcome.worst <= cap;
            }
            possible &= self.beyond.len() <= MAX_BEYOND;
        }
        if possible && !self.beyond.is_empty() {
            // Faces of the rim that only the cavity beyond has reached.
            for rim in &self.rim {
                let (tet, slot) = (&self.filling[(rim.inside >> 2) as usize], (rim.inside & 3) as usize);
                if rim.beyond != WALL
                    && self.marks[tet_of(rim.beyond) as usize] != 0
                    && !self.hit[(rim.inside >> 2) as usize]
                {
                    let [a, b, c] = FACE[slot].map(|k| self.at(tet.v[k]));
                    possible &= join([a, c, b], q, demand, &mut outcome) && outcome.worst <= cap;
                }
            }
        }
        for &id in &self.beyond {
            self.marks[id as usize] = 0;
        }
        if possible {
            outcome
        } else {
            Outcome::NO
        }
    }
}

/// Joins a face, counterclockwise seen from `q`, to it. False when `q` is not there.
#[inline]
fn join([a, b, c]: [DVec3; 3], q: DVec3, demand: Demand, outcome: &mut Outcome) -> bool {
    let (u, v, w) = (a - q, b - q, c - q);
    let (vw, wu, uv) = (v.cross(w), w.cross(u), u.cross(v));
    let volume = -u.dot(vw);
    let (uu, vv, ww) = (u.length_squared(), v.length_squared(), w.length_squared());
    let numerator = (uu * vw + vv * wu + ww * uv).length_squared();
    let shortest2 = uu.min(vv).min(ww).min(a.distance_squared(b)).min(b.distance_squared(c)).min(c.distance_squared(a));
    // R² over (β·l)².
    let ratio = numerator / (4.0 * volume * volume * demand.bound2 * shortest2);
    if ratio > 1.0 - 1e-9 {
        if shortest2 > demand.level2 {
            outcome.lack += (1.0 - 1.0 / ratio).max(0.0);
        } else {
            outcome.worst = outcome.worst.max(ratio.max(1.0 + 1e-9));
        }
    }
    volume > 0.0 && !ratio.is_nan()
}

/// The vertex whose sphere has the lowest centre over a face, among those beyond it.
#[inline(always)]
fn lowest(x: &[f64], y: &[f64], z: &[f64], a: DVec3, n: DVec3, twice: DVec3, flat: f64) -> Option<(u8, f64)> {
    const LANES: usize = 4;
    let (mut best, mut place) = ([f64::INFINITY; LANES], [0u64; LANES]);
    let all = x.chunks_exact(LANES).zip(y.chunks_exact(LANES)).zip(z.chunks_exact(LANES));
    for (i, ((x, y), z)) in all.enumerate() {
        for lane in 0..LANES {
            let (dx, dy, dz) = (x[lane] - a.x, y[lane] - a.y, z[lane] - a.z);
            let h = n.x * dx + n.y * dy + n.z * dz;
            let dd = dx * dx + dy * dy + dz * dz;
            let power = dd - (dx * twice.x + dy * twice.y + dz * twice.z);
            let tau = power / (2.0 * h);
            let better = (h > 0.0) & (h * h > flat * dd) & (tau < best[lane]);
            best[lane] = if better { tau } else { best[lane] };
            place[lane] = if better { i as u64 } else { place[lane] };
        }
    }
    let mut lane = 0;
    for other in 1..LANES {
        if best[other] < best[lane] {
            lane = other;
        }
    }
    (best[lane] < f64::INFINITY).then(|| (place[lane] as u8 * LANES as u8 + lane as u8, best[lane]))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn lowest_avx2(
    x: &[f64],
    y: &[f64],
    z: &[f64],
    a: DVec3,
    n: DVec3,
    twice: DVec3,
    flat: f64,
) -> Option<(u8, f64)> {
    lowest(x, y, z, a, n, twice, flat)
}
