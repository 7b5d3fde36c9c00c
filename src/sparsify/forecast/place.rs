//! A point put into a filling: its cavity are the tetrahedra whose balls hold it, there and beyond the hole's rim, and its star joins it
//! to the cavity's border.

use glam::DVec3;

use super::four::ratios;
use super::{sphere, Demand, Filling, Forecast, FACE, RIM};
use crate::domain::Boundary;
use crate::triangulation::topology::tet_of;
use crate::triangulation::Triangulation;

/// Nor are cavities that reach over more tetrahedra than this beyond the hole.
const MAX_BEYOND: usize = 64;

/// Where a point may go: anywhere, in a facet's plane, or along a segment.
#[derive(Clone, Copy, Debug)]
pub struct Space {
    /// Orthogonal unit vectors.
    pub axes: [DVec3; 3],
    /// How many of them count.
    pub dimension: usize,
}

impl Space {
    /// Anywhere.
    pub const ALL: Space = Space { axes: [DVec3::X, DVec3::Y, DVec3::Z], dimension: 3 };

    /// The part of a step that is possible.
    pub fn along(&self, step: DVec3) -> DVec3 {
        self.axes[..self.dimension].iter().map(|&axis| axis * axis.dot(step)).fold(DVec3::ZERO, |sum, part| sum + part)
    }
}

impl Forecast {
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
                let there = q + self.origin;
                // Off the element by rounding there would be flat tetrahedra at its facet, so across it nothing is added.
                *p = if space.dimension == 3 { there } else { *p + space.along(there - *p) };
                return true;
            }
            q -= space.along(1.02 * worst.1);
        }
        false
    }

    /// How bad what comes is when `p`, which lies on the facets `on`, is inserted into the filling: the largest R²/(β·l)² among tetrahedra that must
    /// keep the bound, infinite when it can't be inserted. At most 1 is good. Gives up as soon as it is more than `cap`. Unless it is good, `push` is
    /// where the point would have to go to be better.
    pub fn try_point(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        p: DVec3,
        on: &[u32],
        demand: Demand,
        cap: f64,
    ) -> f64 {
        let q = p - self.origin;
        self.hit.clear();
        self.hit.extend(self.filling.iter().map(|tet| q.distance_squared(tet.center) < tet.radius2));
        if let Some(&missed) = self.obstacles.iter().find(|&&i| !self.hit[i as usize]) {
            self.push = (self.filling[missed as usize].center - q).normalize_or_zero();
            return f64::INFINITY;
        }
        self.fetch_rim(t);
        let mut star = Star::new(q, demand, cap);
        self.beyond.clear();
        let fits = self.join_within(t, q, on, &mut star)
            && self.join_beyond(t, boundary, q, on, &mut star)
            && self.join_rim(&mut star)
            && star.finish();
        for &id in &self.beyond {
            self.marks[id as usize] = 0;
        }
        if fits && star.worst <= 1.0 {
            return star.worst;
        }
        self.push = repair(star.worst_face, q);
        if fits {
            star.worst
        } else {
            f64::INFINITY
        }
    }

    /// Asks for what is beyond the rim where the cavity reaches it, if it has not been looked at.
    fn fetch_rim(&self, t: &Triangulation) {
        for (tet, _) in self.filling.iter().zip(&self.hit).filter(|(_, &hit)| hit) {
            for &n in tet.n.iter().filter(|&&n| n & RIM != 0) {
                let rim = &self.rim[(n & !RIM) as usize];
                if !rim.is_wall() && rim.radius2 < 0.0 {
                    t.topology.prefetch(tet_of(rim.beyond));
                }
            }
        }
    }

    /// The cavity of `q` inside the filling: its surface goes to `surface`.
    pub(super) fn join_within(&mut self, t: &Triangulation, q: DVec3, on: &[u32], surface: &mut impl Surface) -> bool {
        for i in 0..self.filling.len() {
            if !self.hit[i] {
                continue;
            }
            let Filling { v, n, .. } = self.filling[i];
            for (slot, &n) in n.iter().enumerate() {
                let mut behind = Behind::Filling(n);
                if n & RIM == 0 {
                    if self.hit[(n >> 2) as usize] {
                        continue;
                    }
                } else {
                    let rim = &mut self.rim[(n & !RIM) as usize];
                    behind = Behind::Outside(rim.beyond);
                    if on.contains(&rim.facet) {
                        continue;
                    }
                    if !rim.is_wall() {
                        let id = tet_of(rim.beyond);
                        if rim.radius2 < 0.0 {
                            (rim.center, rim.radius2) = sphere(t.corners(id).map(|p| p - self.origin));
                        }
                        if q.distance_squared(rim.center) < rim.radius2 {
                            if self.marks[id as usize] == 0 {
                                self.marks[id as usize] = 1;
                                self.beyond.push(id);
                            }
                            continue;
                        }
                    }
                }
                let corners = || FACE[slot].map(|k| self.at(v[k]));
                if !surface.join(corners, || FACE[slot].map(|k| self.vertices[v[k] as usize]), behind) {
                    return false;
                }
            }
        }
        true
    }

    /// The cavity of `q` beyond the rim.
    pub(super) fn join_beyond(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        q: DVec3,
        on: &[u32],
        surface: &mut impl Surface,
    ) -> bool {
        let mut next = 0;
        while next < self.beyond.len() {
            let tet = *t.topology.tet(self.beyond[next]);
            next += 1;
            for (slot, &behind) in tet.n.iter().enumerate() {
                let n = tet_of(behind);
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
                let corners = || FACE[slot].map(|k| t.at(tet.v[k]) - self.origin);
                if !surface.join(corners, || FACE[slot].map(|k| tet.v[k]), Behind::Outside(behind)) {
                    return false;
                }
            }
            if self.beyond.len() > MAX_BEYOND {
                return false;
            }
        }
        true
    }

    /// Faces of the rim that only the cavity beyond has reached.
    pub(super) fn join_rim(&self, surface: &mut impl Surface) -> bool {
        self.beyond.is_empty()
            || self.rim.iter().all(|rim| {
                let (tet, slot) = ((rim.inside >> 2) as usize, (rim.inside & 3) as usize);
                if rim.is_wall() || self.marks[tet_of(rim.beyond) as usize] == 0 || self.hit[tet] {
                    return true;
                }
                let [a, b, c] = FACE[slot].map(|k| self.filling[tet].v[k]);
                let corners = || [a, c, b].map(|v| self.at(v));
                surface.join(corners, || [a, c, b].map(|v| self.vertices[v as usize]), Behind::Filling(rim.inside))
            })
    }
}

/// What lies behind a face of a cavity's surface.
#[derive(Clone, Copy, Debug)]
pub(super) enum Behind {
    /// A face of the filling, `4·position + slot`.
    Filling(u16),
    /// A face handle of the triangulation.
    Outside(u32),
}

/// Where the faces of a cavity's surface go.
pub(super) trait Surface {
    /// A face: where its corners are, relative to the hole's origin and counterclockwise seen from the point, the vertices, and what is behind.
    /// False when no more is wanted.
    fn join(
        &mut self,
        corners: impl FnOnce() -> [DVec3; 3],
        vertices: impl FnOnce() -> [u32; 3],
        behind: Behind,
    ) -> bool;
}

/// The star that a point would get, four faces of its cavity at a time: how bad it is.
struct Star {
    q: DVec3,
    demand: Demand,
    cap: f64,
    worst: f64,
    worst_face: [DVec3; 3],
    /// Faces to be joined, counterclockwise seen from `q`, and how many.
    faces: [[DVec3; 3]; 4],
    count: usize,
}

impl Surface for Star {
    /// Joins a face to the point. False when that is not possible, or too bad.
    #[inline]
    fn join(&mut self, corners: impl FnOnce() -> [DVec3; 3], _: impl FnOnce() -> [u32; 3], _: Behind) -> bool {
        self.faces[self.count] = corners();
        self.count += 1;
        self.count < 4 || self.finish()
    }
}

impl Star {
    fn new(q: DVec3, demand: Demand, cap: f64) -> Star {
        let none = [DVec3::ZERO; 3];
        Star { q, demand, cap, worst: 0.0, worst_face: none, faces: [none; 4], count: 0 }
    }

    /// Joins what waits.
    fn finish(&mut self) -> bool {
        let count = std::mem::take(&mut self.count);
        let ratios = ratios(&self.faces, self.q, self.demand);
        for (&ratio, face) in ratios.iter().zip(&self.faces).take(count) {
            if ratio > self.worst {
                (self.worst, self.worst_face) = (ratio, *face);
            }
        }
        self.worst <= self.cap
    }
}

/// The direction in which a point has to move so that its tetrahedron with a face becomes better: against the gradient of R²/l².
fn repair([a, b, c]: [DVec3; 3], q: DVec3) -> DVec3 {
    let (u, v, w) = (a - q, b - q, c - q);
    let (vw, wu, uv) = (v.cross(w), w.cross(u), u.cross(v));
    let volume = -u.dot(vw);
    let normal = (b - a).cross(c - a);
    if volume <= 0.0 {
        return normal.normalize_or_zero();
    }
    let (uu, vv, ww) = (u.length_squared(), v.length_squared(), w.length_squared());
    // From q to the circumcentre.
    let to_center = (uu * vw + vv * wu + ww * uv) / (-2.0 * volume);
    let radius2 = to_center.length_squared();
    // Heights over the face: of q and of the centre.
    let (height, center_height) = (-normal.dot(u), normal.dot(to_center - u));
    let mut gradient = to_center * (-2.0 * center_height / (height * radius2));
    let shortest2 = uu.min(vv).min(ww);
    if shortest2 <= a.distance_squared(b).min(b.distance_squared(c)).min(c.distance_squared(a)) {
        let near = if shortest2 == uu {
            u
        } else if shortest2 == vv {
            v
        } else {
            w
        };
        gradient += near * (2.0 / shortest2);
    }
    -gradient.normalize_or_zero()
}
