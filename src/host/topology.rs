//! A host's arrays as a mesh: checked once, then walked through like a triangulation of our own, but without ghosts.

use glam::DVec3;

use rustc_hash::FxHashSet;

use super::Arrays;
use crate::distinct::Distinct;
use crate::geometry::predicates::orient3d;
use crate::geometry::{check_range, Filter, Sign};
use crate::sorting::sort;
use crate::triangulation::topology::{slot_of, tet_of, EVEN_REST, MAX_TETRAHEDRA};
use crate::{memory, Control, Error};

/// No tetrahedron.
pub const NONE: u32 = u32::MAX;

/// The slots of the face opposite each slot.
const FACE: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

/// A checked mesh.
pub struct Mesh<'a> {
    pub points: &'a [DVec3],
    pub tets: &'a [[u32; 4]],
    /// The face handle across each face, [`NONE`] on the outside.
    across: Vec<[u32; 4]>,
    /// By tetrahedron: whether it is no part of the domain, as [`leave_out_flat`](Self::leave_out_flat) finds. Empty if all are.
    left_out: Vec<bool>,
    /// No edge is made shorter than this, and what differs by less is one and the same.
    pub min_edge: f64,
    pub filter: Filter,
}

/// Where a walk has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Walk {
    /// The point is in this tetrahedron, or on its border.
    In(u32),
    /// The point lies beyond this face of the mesh's outside, a handle.
    Beyond(u32),
}

/// What inserting a point would remove.
#[derive(Clone, Debug, Default)]
pub struct Cavity {
    /// Tetrahedra whose circumspheres hold the point or pass through it.
    pub tets: Vec<u32>,
    /// Those on the other sides of its faces.
    pub around: Vec<u32>,
    /// All of these.
    seen: Distinct<u32>,
}

fn invalid(problem: String) -> Error {
    Error::InvalidMesh { problem }
}

/// The vertices of a face in order.
pub fn face_key(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

impl<'a> Mesh<'a> {
    /// Checks the arrays: vertices exist and are usable, tetrahedra are positively oriented, no face has three sides, and, locally and
    /// so everywhere, the mesh is Delaunay.
    pub fn new(arrays: &Arrays<'a>, control: &Control) -> Result<Mesh<'a>, Error> {
        let (points, tets) = (arrays.points, arrays.tetrahedra);
        if tets.len() > MAX_TETRAHEDRA {
            return Err(Error::TooManyVertices { requested: tets.len(), limit: MAX_TETRAHEDRA });
        }
        let mut used = memory::filled(points.len(), false, "vertices", control)?;
        let turns = control.turns();
        for (t, tet) in tets.iter().enumerate() {
            turns.check()?;
            for &v in tet {
                let Some(used) = used.get_mut(v as usize) else {
                    let problem = format!("tetrahedron {t} names vertex {v}, but there are only {}", points.len());
                    return Err(invalid(problem));
                };
                *used = true;
            }
        }
        let mut filter = Filter::default();
        for (v, &p) in points.iter().enumerate().filter(|&(v, _)| used[v]) {
            turns.check()?;
            check_range(v, p)?;
            filter.extend(p);
        }
        let mut across = memory::room_in_pieces(0, "neighbours", control)?;
        if arrays.neighbours.is_empty() {
            *across = find_neighbours(points.len(), tets, control)?;
        }
        let (low, high) = filter.bounding_box();
        let min_edge = crate::triangulation::least_edge(low, high);
        let mut mesh = Mesh { points, tets, across: Vec::new(), left_out: Vec::new(), min_edge, filter };
        for t in 0..tets.len() as u32 {
            turns.check()?;
            let [a, b, c, d] = mesh.corners(t);
            if mesh.filter.orient3d(a, b, c, d) != Sign::Positive {
                let tet = tets[t as usize];
                return Err(invalid(format!("tetrahedron {t} {tet:?} is flat or not positively oriented")));
            }
        }
        if !arrays.neighbours.is_empty() {
            *across = mesh.handles(arrays.neighbours, control)?;
        }
        mesh.across = across.keep();
        match mesh.check_delaunay(control).and_then(|()| mesh.leave_out_flat(arrays.faces, control)) {
            Ok(()) => Ok(mesh),
            Err(error) => {
                mesh.give_back_to(control);
                Err(error)
            }
        }
    }

    /// Gives its memory back.
    pub fn give_back_to(&mut self, control: &Control) {
        control.give_back(std::mem::take(&mut self.across));
        control.give_back(std::mem::take(&mut self.left_out));
    }

    /// Takes flat tetrahedra on the outside for no part of the domain, unless they have a face that the host names. Points on a slanted
    /// facet lie off its plane by rounding, and then such tetrahedra lie between them: they can't be mended, and with them the facet would be torn into pieces.
    fn leave_out_flat(&mut self, faces: &[[u32; 3]], control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        let mut named = FxHashSet::default();
        for &face in faces {
            turns.check()?;
            named.insert(face_key(face));
        }
        let mut left_out = memory::room_in_pieces(0, "tetrahedra", control)?;
        let mut next = Vec::new();
        for t in 0..self.tets.len() as u32 {
            turns.check()?;
            next.extend(self.across[t as usize].contains(&NONE).then_some(t));
            // Layers of them are followed inwards.
            while let Some(t) = next.pop() {
                turns.check()?;
                let is_named = |slot: u32| named.contains(&face_key(self.face(4 * t + slot)));
                if left_out.get(t as usize).is_some_and(|&out| out) || !self.is_flat(t) || (0..4).any(is_named) {
                    continue;
                }
                if left_out.is_empty() {
                    *left_out = memory::filled(self.tets.len(), false, "tetrahedra", control)?.keep();
                }
                left_out[t as usize] = true;
                next.extend(self.across[t as usize].iter().filter(|&&face| face != NONE).map(|&face| tet_of(face)));
            }
        }
        self.left_out = left_out.keep();
        Ok(())
    }

    /// Whether a tetrahedron's extent across a plane, or a line, is nothing but rounding.
    fn is_flat(&self, t: u32) -> bool {
        self.are_coplanar(self.corners(t))
    }

    /// Whether four points are on one plane but for rounding.
    pub fn are_coplanar(&self, [a, b, c, d]: [DVec3; 4]) -> bool {
        let longest = |all: &[DVec3]| all.iter().map(|v| v.length()).fold(0.0, f64::max);
        let (b, c, d) = (b - a, c - a, d - a);
        let area = longest(&[b.cross(c), c.cross(d), d.cross(b), (c - b).cross(d - b)]);
        // Of points on one line the volume and the areas say nothing.
        let width = area / longest(&[b, c, d, c - b, d - c, b - d]);
        b.cross(c).dot(d).abs() < area * self.min_edge || width < self.min_edge
    }

    /// Whether a tetrahedron is no part of the domain.
    pub fn is_left_out(&self, t: u32) -> bool {
        self.left_out.get(t as usize).is_some_and(|&out| out)
    }

    /// The host's neighbours as face handles.
    fn handles(&self, neighbours: &[[u32; 4]], control: &Control) -> Result<Vec<[u32; 4]>, Error> {
        if neighbours.len() != self.tets.len() {
            let (n, m) = (neighbours.len(), self.tets.len());
            return Err(invalid(format!("there are neighbours of {n} tetrahedra, but {m} tetrahedra")));
        }
        let back = |t: usize, slot: usize| {
            let other = neighbours[t][slot];
            if other == NONE {
                return Some(NONE);
            }
            let key = face_key(self.face(4 * t as u32 + slot as u32));
            let theirs = neighbours.get(other as usize)?;
            (0..4)
                .find(|&s| theirs[s] == t as u32 && face_key(self.face(4 * other + s as u32)) == key)
                .map(|s| 4 * other + s as u32)
        };
        let one = |t: usize| -> Result<[u32; 4], Error> {
            let mut handles = [NONE; 4];
            for (slot, handle) in handles.iter_mut().enumerate() {
                let mismatch = || {
                    let other = neighbours[t][slot];
                    invalid(format!("tetrahedra {t} and {other} are neighbours in the array, but share no face"))
                };
                *handle = back(t, slot).ok_or_else(mismatch)?;
            }
            Ok(handles)
        };
        let mut all = memory::room_in_pieces(self.tets.len(), "neighbours", control)?;
        let turns = control.turns();
        for t in 0..self.tets.len() {
            turns.check()?;
            all.push(one(t)?);
        }
        Ok(all.keep())
    }

    /// Whether an outward face's vertices are in an order that an even number of swaps sorts.
    fn is_even(&self, face: u32) -> bool {
        const OUTWARD: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        let tet = &self.tets[tet_of(face) as usize];
        let [a, b, c] = OUTWARD[slot_of(face)].map(|slot| tet[slot]);
        !((a > b) ^ (a > c) ^ (b > c))
    }

    /// Tetrahedra are on different sides of the face that they share, so that walks around edges come back; and no vertex across a face lies
    /// inside a tetrahedron's circumsphere.
    fn check_delaunay(&self, control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        for t in 0..self.tets.len() as u32 {
            turns.check()?;
            for slot in 0..4 {
                let across = self.across[t as usize][slot as usize];
                // Each face once.
                if across == NONE || across < 4 * t + slot {
                    continue;
                }
                if self.is_even(4 * t + slot) == self.is_even(across) {
                    let other = tet_of(across);
                    return Err(invalid(format!(
                        "tetrahedra {t} and {other} are on the same side of the face that they share"
                    )));
                }
                let v = self.tets[tet_of(across) as usize][slot_of(across)];
                let [a, b, c, d] = self.corners(t);
                if self.filter.insphere(a, b, c, d, self.at(v)) == Sign::Positive {
                    return Err(invalid(format!(
                        "it is not Delaunay: vertex {v} of tetrahedron {} lies inside the circumsphere of tetrahedron {t}",
                        tet_of(across)
                    )));
                }
            }
        }
        Ok(())
    }

    #[inline]
    pub fn at(&self, v: u32) -> DVec3 {
        self.points[v as usize]
    }

    #[inline]
    pub fn corners(&self, t: u32) -> [DVec3; 4] {
        self.tets[t as usize].map(|v| self.at(v))
    }

    /// The face on the other side of a face, [`NONE`] on the outside of the domain.
    #[inline]
    pub fn across(&self, face: u32) -> u32 {
        let across = self.behind(face);
        if across != NONE && self.is_left_out(tet_of(across)) {
            NONE
        } else {
            across
        }
    }

    /// The face on the other side of a face in the host's mesh, be it in the domain or not.
    #[inline]
    pub fn behind(&self, face: u32) -> u32 {
        self.across[tet_of(face) as usize][slot_of(face)]
    }

    /// The vertices of a face.
    #[inline]
    pub fn face(&self, face: u32) -> [u32; 3] {
        FACE[slot_of(face)].map(|slot| self.tets[tet_of(face) as usize][slot])
    }

    /// The vertex opposite a face.
    #[inline]
    pub fn apex(&self, face: u32) -> u32 {
        self.tets[tet_of(face) as usize][slot_of(face)]
    }

    /// Walks from a tetrahedron towards a point. On a mesh that is not Delaunay it may go in circles: then it ends as if the point were beyond.
    pub fn walk(&self, p: DVec3, start: u32, control: &Control) -> Result<Walk, Error> {
        let (mut t, mut entry) = (start, NONE);
        let turns = control.turns();
        for _ in 0..4 * self.tets.len() {
            turns.check()?;
            let corners = self.corners(t);
            let leaves = |slot: usize| {
                let mut with_p = corners;
                with_p[slot] = p;
                let [a, b, c, d] = with_p;
                4 * t + slot as u32 != entry && orient3d(a, b, c, d) == Sign::Negative
            };
            // An inner face rather than one of the outside: around a corner of a domain that is not convex there may be a way.
            let mut exits = (0..4).filter(|&slot| leaves(slot)).map(|slot| 4 * t + slot as u32).peekable();
            let Some(&first) = exits.peek() else { return Ok(Walk::In(t)) };
            match exits.find(|&face| self.across(face) != NONE) {
                Some(face) => {
                    entry = self.across(face);
                    t = tet_of(entry);
                }
                None => return Ok(Walk::Beyond(first)),
            }
        }
        Ok(Walk::Beyond(4 * t))
    }

    /// Whether a tetrahedron's circumsphere holds the point or passes through it. Cospherical points count, so that the cavity is no smaller
    /// than the host's, whatever its rule for them is.
    fn conflicts(&self, filter: &Filter, t: u32, p: DVec3) -> bool {
        let [a, b, c, d] = self.corners(t);
        filter.insphere(a, b, c, d, p) != Sign::Negative
    }

    /// The cavity of a point in or at tetrahedron `start`. False if that is not in conflict.
    pub fn cavity(&self, p: DVec3, start: u32, cavity: &mut Cavity, control: &Control) -> Result<bool, Error> {
        let Cavity { tets, around, seen } = cavity;
        tets.clear();
        around.clear();
        seen.clear();
        let mut filter = self.filter.clone();
        filter.extend(p);
        if !self.conflicts(&filter, start, p) {
            return Ok(false);
        }
        seen.insert(start);
        tets.push(start);
        let (mut next, turns) = (0, control.turns());
        while next < tets.len() {
            turns.check()?;
            for slot in 0..4 {
                // Flat tetrahedra go with it too, and two cavities may have such a one in common.
                let across = self.behind(4 * tets[next] + slot);
                let t = tet_of(across);
                if across == NONE || !seen.insert(t) {
                    continue;
                }
                if self.conflicts(&filter, t, p) {
                    tets.push(t);
                } else {
                    around.push(t);
                }
            }
            next += 1;
        }
        Ok(true)
    }

    /// The tetrahedra around the edge in slots `i` and `j` of tetrahedron `t`, from `t` on, as (tetrahedron, k, l): the next lies across the face
    /// opposite slot `k`. Ends where `wall` holds for that face, and after a full turn; calls `each` for every one. Returns whether it came
    /// around.
    pub fn turn(
        &self,
        t: u32,
        i: usize,
        j: usize,
        wall: impl Fn(u32) -> bool,
        mut each: impl FnMut(u32, usize, usize),
    ) -> bool {
        let (p, q) = (self.tets[t as usize][i], self.tets[t as usize][j]);
        let [mut k, mut l] = EVEN_REST[i][j];
        let mut at = t;
        loop {
            each(at, k, l);
            let face = 4 * at + k as u32;
            let across = self.across(face);
            if across == NONE || wall(face) {
                return false;
            }
            at = tet_of(across);
            if at == t {
                return true;
            }
            let v = self.tets[at as usize];
            let find = |x: u32| v.iter().position(|&y| y == x);
            let (Some(i), Some(j)) = (find(p), find(q)) else { return false };
            [k, l] = EVEN_REST[i][j];
        }
    }

    /// The vertices around the edge in slots `i` and `j` of `t`, between the walls around `t`; whether they form a ring.
    pub fn sector(&self, t: u32, i: usize, j: usize, wall: impl Fn(u32) -> bool + Copy, link: &mut Vec<u32>) -> bool {
        link.clear();
        let mut last = NONE;
        let closed = self.turn(t, i, j, wall, |t, k, l| {
            link.push(self.tets[t as usize][k]);
            last = self.tets[t as usize][l];
        });
        if closed {
            return true;
        }
        link.push(last);
        let forward = link.len();
        let mut first = true;
        self.turn(t, j, i, wall, |t, _, l| {
            // The first is `t` itself, whose other vertex is the first of the link already.
            if !std::mem::take(&mut first) {
                link.push(self.tets[t as usize][l]);
            }
        });
        link[forward..].reverse();
        let backward = link.len() - forward;
        link.rotate_right(backward);
        false
    }
}

/// The neighbours as face handles, by sorting the faces at each vertex.
fn find_neighbours(points: usize, tets: &[[u32; 4]], control: &Control) -> Result<Vec<[u32; 4]>, Error> {
    const WHAT: &str = "neighbours";
    let turns = control.turns();
    let key = |t: usize, slot: usize| face_key(FACE[slot].map(|s| tets[t][s]));
    let mut starts = memory::zeroed::<usize>(points + 1, WHAT, control)?;
    for t in 0..tets.len() {
        turns.check()?;
        for slot in 0..4 {
            starts[key(t, slot)[0] as usize + 1] += 1;
        }
    }
    for v in 0..points {
        turns.check()?;
        starts[v + 1] += starts[v];
    }
    let mut faces = memory::zeroed::<([u32; 2], u32)>(4 * tets.len(), WHAT, control)?;
    let mut fill = memory::copied(&starts, WHAT, control)?;
    for t in 0..tets.len() {
        turns.check()?;
        for slot in 0..4 {
            let [a, b, c] = key(t, slot);
            faces[fill[a as usize]] = ([b, c], 4 * t as u32 + slot as u32);
            fill[a as usize] += 1;
        }
    }
    let mut across = memory::filled(tets.len(), [NONE; 4], WHAT, control)?;
    for (v, range) in starts.windows(2).enumerate() {
        turns.check()?;
        let faces = &mut faces[range[0]..range[1]];
        sort(faces, &control.watch())?;
        for same in faces.chunk_by(|f, g| f.0 == g.0) {
            match *same {
                [(_, f), (_, g)] => {
                    across[tet_of(f) as usize][slot_of(f)] = g;
                    across[tet_of(g) as usize][slot_of(g)] = f;
                }
                [([b, c], f), _, (_, g), ..] => {
                    return Err(invalid(format!(
                        "face {:?} is one of more than two tetrahedra, {} and {} among them",
                        [v as u32, b, c],
                        tet_of(f),
                        tet_of(g)
                    )));
                }
                _ => {}
            }
        }
    }
    Ok(across.keep())
}
