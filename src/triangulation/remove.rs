//! Removal of vertices, or replacement of some by one new point, as two steps like [insertion](super::cavity): find the *hole* that
//! opens and what would fill it, then do it. Between the two a caller can look at what would go and what would come, and drop it.
//!
//! After O. Devillers and M. Teillaud, "Perturbations and vertex removal in a 3D Delaunay triangulation", SODA 2003: with their
//! perturbation the Delaunay triangulation of any points is unique, so that what fills the hole is part of the triangulation of the
//! hole's own vertices. That small one is made, and its tetrahedra inside the hole are found by a flood from the hole's faces. Ghosts are
//! tetrahedra like all others, so that vertices of the hull need nothing of their own; only where the hole's vertices lie in
//! one plane (a corner of the hull is cut off, say) one vertex from beyond the hole joins them.
//!
//! The hole of a replacement is the union of the stars of the vertices that go and of the new point's
//! [cavity](super::cavity::Cavity): all other tetrahedra stay Delaunay.

mod certify;
mod faces;
mod replace;

use glam::DVec3;

pub use certify::{Guess, Linked};
pub(crate) use faces::oriented_face;
use faces::{rotated, FaceTable};

use super::cavity::Cavity;
use super::order::spatial_order;
use super::topology::{slot_of, tet_of, GHOST, NONE};
use super::Triangulation;
use crate::domain::label::OUTSIDE;
use crate::geometry::predicates::{collinear, orient3d};
use crate::geometry::{check_range, Filter, Sign};
use crate::leavings::Leavings;
use crate::{memory, Control, Error};

/// Vertices that go, and a point that comes in their place.
#[derive(Clone, Copy, Debug, Default)]
pub struct Replacement<'a> {
    /// The vertices to remove; they need not be neighbours.
    pub remove: &'a [u32],
    /// The point to insert. It may lie anywhere but at a vertex that stays.
    pub add: Option<DVec3>,
}

/// The new point's vertex in a [`Hole`]: it gets its id when it is inserted.
pub const ADDED: u32 = u32::MAX - 2;

/// A tetrahedron that a replacement removes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Going {
    /// Its place.
    pub t: u32,
    /// Its vertices, the ghost among them perhaps.
    pub v: [u32; 4],
}

/// A tetrahedron that a replacement creates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coming {
    /// Vertices, positively oriented. [`ADDED`] stands for the new point, [`GHOST`] in the last slot for none.
    pub v: [u32; 4],
    /// The label that the tetrahedra it replaces had, where they agree; `None` when there are no labels. May be set before the replacement is
    /// made; `None` then stands for the label of any of them.
    pub label: Option<u16>,
    /// Its place in the small triangulation.
    small: u32,
    /// Per slot a face of the hole (its position), or the other side's `4·position + slot` among the coming.
    n: [u32; 4],
    /// Bit by slot: whether the face is one of the hole.
    rim: u8,
}

/// A face between the hole and the rest.
#[derive(Clone, Copy, Debug)]
struct HoleFace {
    /// Its handle outside the hole.
    outside: u32,
    /// The label inside.
    label: u16,
}

/// What a replacement would change, and scratch memory to find the next one in.
#[derive(Clone, Debug, Default)]
pub struct Hole {
    /// The tetrahedra that go.
    pub going: Vec<Going>,
    /// The tetrahedra that come.
    pub coming: Vec<Coming>,
    /// The places of what the last [`Triangulation::replace`] created, in the order of `coming`.
    pub created: Vec<u32>,
    remove: Vec<u32>,
    add: Option<DVec3>,
    /// Nothing of a volume is left, or there was none.
    flat: bool,
    faces: Vec<HoleFace>,
    by_vertices: FaceTable,
    /// One byte a tetrahedron: whether it goes; `certify` notes there which of its faces have been found.
    marks: Vec<u8>,
    /// By vertex id: its number in the small triangulation.
    local: Vec<u32>,
    /// By number in the small triangulation: the vertex.
    vertices: Vec<u32>,
    small: Triangulation,
    cavity: Cavity,
    number: Vec<u32>,
    part: Vec<u32>,
}

/// Memory of [`Triangulation::remove`]; a copy starts without.
#[derive(Debug, Default)]
pub(super) struct Scratch(Option<Box<Hole>>);

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Scratch(None)
    }
}

/// A vertex to remove, among the numbers in the small triangulation.
const REMOVED: u32 = u32::MAX - 1;
/// From this size on, a hole's vertices are inserted in a spatial order.
const SORTED: usize = 256;
/// Tetrahedra between two looks at the control, where each takes little time.
const POLL_INTERVAL: usize = 1 << 12;

impl Hole {
    /// Whether a tetrahedron goes.
    #[inline]
    pub fn contains(&self, t: u32) -> bool {
        self.marks.get(t as usize).is_some_and(|&mark| mark != 0)
    }

    /// Forgets what was found; its memory stays for the next time.
    pub fn clear(&mut self) {
        memory::reset_at(&mut self.marks, 0, self.going.iter().map(|going| going.t));
        self.going.clear();
        self.coming.clear();
        self.remove.clear();
        self.add = None;
        self.flat = false;
        self.faces.clear();
    }

    /// The point that would come.
    pub fn point(&self) -> Option<DVec3> {
        self.add
    }

    /// Numbers those of a tetrahedron's vertices that stay and have no number yet.
    #[inline(always)]
    fn number(&mut self, v: [u32; 4]) {
        for v in v {
            if v != GHOST && self.local[v as usize] == NONE {
                self.local[v as usize] = self.vertices.len() as u32;
                self.vertices.push(v);
            }
        }
    }

    /// Forgets the numbers in the small triangulation.
    fn forget_numbers(&mut self) {
        for list in [&self.remove, &self.vertices] {
            memory::reset_at(&mut self.local, NONE, list.iter().copied());
        }
        self.vertices.clear();
    }

    /// As long as the triangulation has room for tetrahedra and vertices, in pieces, so that no replacement has to do it.
    pub(crate) fn grow_for(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        let (tetrahedra, vertices) = t.room();
        memory::lengthen(&mut self.marks, tetrahedra, 0, "marks", control)?;
        memory::lengthen(&mut self.local, vertices, NONE, "vertices", control)
    }

    /// [`grow_for`](Self::grow_for), for replacements that add a vertex, too.
    pub(crate) fn grow_for_additions(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        self.cavity.grow_for(t, control)?;
        self.grow_for(t, control)
    }

    fn take(&mut self, t: u32, v: [u32; 4]) {
        self.marks[t as usize] = 1;
        self.going.push(Going { t, v });
    }
}

impl Triangulation {
    /// Removes a vertex; the others keep their ids. The id is free then for an [`insert`](Self::insert), and its point is NaN.
    ///
    /// Cost: that of a triangulation of the neighbours by themselves; linear in all vertices when the rest lies in a plane, or did before.
    pub fn remove(&mut self, vertex: u32) -> Result<(), Error> {
        self.remove_within(vertex, Control::never())
    }

    /// [`remove`](Self::remove) that a control can cancel: [`Error::Cancelled`], and nothing has changed.
    pub fn remove_within(&mut self, vertex: u32, control: &Control) -> Result<(), Error> {
        control.check()?;
        let mut hole = self.hole.0.take().unwrap_or_default();
        let result = hole
            .grow_for(self, control)
            .and_then(|()| {
                self.preview_within(&Replacement { remove: &[vertex], add: None }, &|_| false, &mut hole, control)
            })
            .and_then(|()| self.replace_within(&mut hole, control).map(|_| ()));
        self.hole.0 = Some(hole);
        result
    }

    /// Finds what a replacement would remove and create, without doing it: [`replace`](Self::replace) does it, dropping the hole, or
    /// using it for another preview, does not. Nothing comes and nothing goes below dimension 3; when a replacement falls down to it,
    /// everything goes.
    ///
    /// `is_wall` tells of faces between two of the coming tetrahedra whether they separate regions, as the subfacets of a domain do. Labels
    /// don't spread across walls. The faces' vertices come in any order, [`ADDED`] among them perhaps.
    ///
    /// [`Error::NoSuchVertex`] for one to remove, [`Error::Occupied`] when a vertex that stays is at the new point.
    pub fn preview(
        &self,
        replacement: &Replacement,
        is_wall: &dyn Fn([u32; 3]) -> bool,
        hole: &mut Hole,
    ) -> Result<(), Error> {
        self.preview_within(replacement, is_wall, hole, Control::never())
    }

    /// [`preview`](Self::preview) that a control can cancel: [`Error::Cancelled`].
    fn preview_within(
        &self,
        replacement: &Replacement,
        is_wall: &dyn Fn([u32; 3]) -> bool,
        hole: &mut Hole,
        control: &Control,
    ) -> Result<(), Error> {
        self.begin_hole(replacement, hole)?;
        let result = self.fill(is_wall, hole, control);
        hole.forget_numbers();
        if result.is_err() {
            hole.clear();
        }
        result
    }

    /// Notes what a replacement is, and marks the vertices that go.
    fn begin_hole(&self, replacement: &Replacement, hole: &mut Hole) -> Result<(), Error> {
        hole.clear();
        for &v in replacement.remove {
            if !self.is_vertex(v) {
                return Err(Error::NoSuchVertex { vertex: v });
            }
        }
        if let Some(p) = replacement.add {
            check_range(0, p)?;
        }
        hole.remove.extend_from_slice(replacement.remove);
        hole.add = replacement.add.map(|p| p + DVec3::ZERO);
        if hole.local.len() < self.points.len() {
            hole.local.resize(self.points.capacity(), NONE);
        }
        if hole.marks.len() < self.topology.tets.len() {
            hole.marks.resize(self.topology.tets.capacity(), 0);
        }
        // A vertex that is named twice is removed once.
        let local = &mut hole.local;
        hole.remove.retain(|&v| std::mem::replace(&mut local[v as usize], REMOVED) != REMOVED);
        Ok(())
    }

    fn fill(&self, is_wall: &dyn Fn([u32; 3]) -> bool, hole: &mut Hole, control: &Control) -> Result<(), Error> {
        if self.dimension() < 3 {
            hole.flat = true;
            return match hole.add.and_then(|p| self.lower.find(p)) {
                Some(vertex) if !hole.remove.contains(&vertex) => Err(Error::Occupied { vertex }),
                _ => Ok(()),
            };
        }
        self.find_stars(hole, control)?;
        if let Some(p) = hole.add {
            self.find_new_cavity(p, hole, control)?;
        }
        if hole.going.is_empty() {
            return Ok(());
        }
        self.find_faces(hole, control)?;
        if self.triangulate_vertices(hole, control)? {
            self.flood(hole, control)?;
            self.label_coming(is_wall, hole, control)?;
        } else {
            hole.flat = true;
            for (turn, t) in self.topology.live().enumerate() {
                look(turn, control)?;
                if !hole.contains(t) {
                    hole.take(t, self.topology.tet(t).v);
                }
            }
        }
        Ok(())
    }

    /// The stars of the vertices that go.
    fn find_stars(&self, hole: &mut Hole, control: &Control) -> Result<(), Error> {
        for i in 0..hole.remove.len() {
            let t = self.topology.vertex_tet[hole.remove[i] as usize];
            if hole.contains(t) {
                continue;
            }
            let mut next = hole.going.len();
            hole.take(t, self.topology.tet(t).v);
            while next < hole.going.len() {
                let tet = self.topology.tet(hole.going[next].t);
                next += 1;
                look(next, control)?;
                if next % POLL_INTERVAL == 0 {
                    memory::grow_long(&mut hole.going, 4 * POLL_INTERVAL, "hole", control)?;
                }
                for face in tet.n {
                    let t = tet_of(face);
                    let v = self.topology.tet(t).v;
                    let goes = |&v: &u32| v != GHOST && hole.local[v as usize] == REMOVED;
                    if !hole.contains(t) && v.iter().any(goes) {
                        hole.take(t, v);
                    }
                }
            }
        }
        Ok(())
    }

    /// The tetrahedra in conflict with the new point, to those that go already.
    fn find_new_cavity(&self, p: DVec3, hole: &mut Hole, control: &Control) -> Result<(), Error> {
        let mut filter = self.filter.clone();
        filter.extend(p);
        let start = hole.going.first().map_or(self.last, |going| going.t);
        let t = self.walk_within(&filter, p, start, control)?;
        match self.vertex_at(t, p) {
            // Then no tetrahedron but its own is in conflict.
            Some(vertex) if hole.local[vertex as usize] == REMOVED => return Ok(()),
            Some(vertex) => return Err(Error::Occupied { vertex }),
            None => {}
        }
        let mut cavity = std::mem::take(&mut hole.cavity);
        self.find_cavity(&filter, p, t, &mut cavity, control)?;
        for (turn, &t) in cavity.tets.iter().enumerate() {
            look(turn, control)?;
            if !hole.contains(t) {
                hole.take(t, self.topology.tet(t).v);
            }
        }
        cavity.clear();
        hole.cavity = cavity;
        Ok(())
    }

    /// Numbers the hole's vertices, and finds its faces.
    fn find_faces(&self, hole: &mut Hole, control: &Control) -> Result<(), Error> {
        if hole.add.is_some() {
            hole.vertices.push(ADDED);
        }
        hole.by_vertices.clear();
        for i in 0..hole.going.len() {
            let Going { t, v } = hole.going[i];
            look(i + 1, control)?;
            if i % POLL_INTERVAL == 0 {
                memory::grow_long(&mut hole.faces, 4 * POLL_INTERVAL, "hole", control)?;
                memory::grow_long(&mut hole.by_vertices.keys, 4 * POLL_INTERVAL, "hole", control)?;
                memory::grow_long(&mut hole.vertices, 4 * POLL_INTERVAL, "hole", control)?;
            }
            hole.number(v);
            for (slot, &outside) in self.topology.tet(t).n.iter().enumerate() {
                if hole.contains(tet_of(outside)) {
                    continue;
                }
                // Vertices to remove have no number, but all tetrahedra at them go.
                let number = |v: u32| if v == GHOST { GHOST } else { hole.local[v as usize] };
                hole.by_vertices.keys.push(rotated(oriented_face(&v, slot).map(number)));
                hole.faces.push(self.hole_face(t, outside));
            }
        }
        hole.by_vertices.index(control)
    }

    /// The face between a tetrahedron that goes and one outside.
    #[inline]
    fn hole_face(&self, going: u32, outside: u32) -> HoleFace {
        let label = self.topology.region.get(going as usize).copied().unwrap_or(OUTSIDE);
        HoleFace { outside, label }
    }

    /// Makes the triangulation of the hole's vertices. False when all that is left lies in one plane.
    fn triangulate_vertices(&self, hole: &mut Hole, control: &Control) -> Result<bool, Error> {
        let small = &mut hole.small;
        small.topology.clear_tetrahedra();
        small.topology.vertex_tet.clear();
        small.points.clear();
        small.filter = Filter::default();
        for part in hole.vertices.chunks(POLL_INTERVAL) {
            control.check()?;
            let start = small.points.len();
            small.points.extend(part.iter().map(|&v| match hole.add {
                Some(p) if v == ADDED => p,
                _ => self.at(v),
            }));
            small.filter.extend_all(&small.points[start..]);
        }
        let mut basis = independent(&small.points, control)?;
        if basis.is_none() {
            // In one plane. If all the rest lies in it too, no finite tetrahedron is left, so none is beside the hole.
            let beyond = |face: &HoleFace| {
                let tet = self.topology.tet(tet_of(face.outside));
                (!tet.is_ghost()).then(|| tet.v[slot_of(face.outside)])
            };
            let Some(v) = hole.faces.iter().find_map(beyond) else { return Ok(false) };
            hole.vertices.push(v);
            small.points.push(self.at(v));
            small.filter.extend(self.at(v));
            basis = independent(&small.points, control)?;
        }
        let Some(basis) = basis else { return Ok(false) };
        memory::lengthen(&mut small.topology.vertex_tet, small.points.len(), NONE, "vertices", control)?;
        small.start_from(basis);
        let order = if small.points.len() < SORTED { Vec::new() } else { spatial_order(&small.points, control)? };
        for i in 0..small.points.len() {
            let v = order.get(i).copied().unwrap_or(i as u32);
            control.check()?;
            if !basis.contains(&v) {
                small.room_ahead(control)?;
                small.insert_stored(v, small.last, control)?;
            }
        }
        Ok(true)
    }

    /// Finds the small triangulation's tetrahedra inside the hole.
    fn flood(&self, hole: &mut Hole, control: &Control) -> Result<(), Error> {
        let Hole { small, faces, by_vertices, coming, vertices, number, .. } = hole;
        let small = &small.topology;
        let global = |v: u32| if v == GHOST { GHOST } else { vertices[v as usize] };
        let bare = |t: u32| Coming { v: small.tet(t).v.map(global), label: None, small: t, n: [NONE; 4], rim: 0 };
        let face_at = |t: u32, slot: usize| by_vertices.find(rotated(oriented_face(&small.tet(t).v, slot)));
        // By small tetrahedron: its position among the coming.
        number.clear();
        memory::lengthen(number, small.tets.len(), NONE, "hole", control)?;
        // All of them at most: a list that grows is moved.
        memory::reserve_anew(coming, small.live_count(), "hole", control)?;
        // Without faces the hole is everything.
        let everything = faces.is_empty();
        let (mut found, mut next) = (0, 0);
        let turns = control.turns();
        for seed in small.live() {
            turns.check()?;
            if found == faces.len() && !everything {
                break;
            }
            if number[seed as usize] != NONE || !(everything || (0..4).any(|slot| face_at(seed, slot).is_some())) {
                continue;
            }
            number[seed as usize] = coming.len() as u32;
            coming.push(bare(seed));
            while next < coming.len() {
                turns.check()?;
                let t = coming[next].small;
                for slot in 0..4 {
                    if let Some(face) = face_at(t, slot) {
                        coming[next].n[slot] = face;
                        coming[next].rim |= 1 << slot;
                        found += 1;
                        continue;
                    }
                    let across = small.tet(t).n[slot];
                    let position = &mut number[tet_of(across) as usize];
                    if *position == NONE {
                        *position = coming.len() as u32;
                        coming.push(bare(tet_of(across)));
                    }
                    coming[next].n[slot] = 4 * *position + slot_of(across) as u32;
                }
                next += 1;
            }
        }
        assert_eq!(found, faces.len(), "a face of the hole is missing from the triangulation of its vertices");
        Ok(())
    }

    /// Spreads the labels from the hole's faces among what comes.
    fn label_coming(
        &self,
        is_wall: &dyn Fn([u32; 3]) -> bool,
        hole: &mut Hole,
        control: &Control,
    ) -> Result<(), Error> {
        if self.topology.region.is_empty() {
            return Ok(());
        }
        let turns = control.turns();
        let Hole { faces, coming, number, part, .. } = hole;
        number.clear();
        memory::lengthen(number, coming.len(), 0, "hole", control)?;
        for seed in 0..coming.len() {
            turns.check()?;
            if number[seed] != 0 {
                continue;
            }
            number[seed] = 1;
            if coming[seed].v[3] == GHOST {
                coming[seed].label = Some(OUTSIDE);
                continue;
            }
            part.clear();
            part.push(seed as u32);
            let (mut label, mut agree) = (None, true);
            let mut next = 0;
            while next < part.len() {
                let tet = coming[part[next] as usize];
                next += 1;
                turns.check()?;
                for slot in 0..4 {
                    let n = tet.n[slot];
                    if tet.rim >> slot & 1 != 0 {
                        let HoleFace { outside, label: inside } = faces[n as usize];
                        let beyond = self.topology.region[tet_of(outside) as usize];
                        // What was a wall may be none any more: facets with points beside their planes make way by flat tetrahedra.
                        let gone = inside != beyond && !is_wall(oriented_face(&tet.v, slot));
                        let known = if gone { beyond } else { inside };
                        agree &= *label.get_or_insert(known) == known;
                    } else if coming[tet_of(n) as usize].v[3] != GHOST
                        && number[tet_of(n) as usize] == 0
                        && !is_wall(oriented_face(&tet.v, slot))
                    {
                        number[tet_of(n) as usize] = 1;
                        part.push(tet_of(n));
                    }
                }
            }
            for &i in part.iter() {
                turns.check()?;
                coming[i as usize].label = label.filter(|_| agree);
            }
        }
        Ok(())
    }

    /// The corners of a tetrahedron that would come; none of a ghost.
    pub fn coming_corners(&self, hole: &Hole, coming: &Coming) -> Option<[DVec3; 4]> {
        (coming.v[3] != GHOST).then(|| coming.v.map(|v| *self.coming_point(hole, v)))
    }

    /// Where a vertex of what would come is, [`ADDED`] too.
    #[inline]
    pub(crate) fn coming_point<'a>(&'a self, hole: &'a Hole, v: u32) -> &'a DVec3 {
        match &hole.add {
            Some(p) if v == ADDED => p,
            _ => &self.points[v as usize],
        }
    }
}

/// [`Error::Cancelled`] when it is a turn to ask whether to go on, and the answer is no.
#[inline]
fn look(turn: usize, control: &Control) -> Result<(), Error> {
    if turn % POLL_INTERVAL == POLL_INTERVAL - 1 {
        return control.check();
    }
    Ok(())
}

impl Leavings for Scratch {
    fn give_back(&mut self) -> bool {
        self.0.as_deref_mut().is_some_and(Leavings::give_back)
    }
}

impl Leavings for Hole {
    fn give_back(&mut self) -> bool {
        let Hole { going, coming, created, faces, marks, local, small, cavity, .. } = self;
        going.give_back()
            || coming.give_back()
            || created.give_back()
            || faces.give_back()
            || marks.give_back()
            || local.give_back()
            || small.give_back()
            || cavity.give_back()
    }
}

/// Four points that span a volume, if there are such.
fn independent(points: &[DVec3], control: &Control) -> Result<Option<[u32; 4]>, Error> {
    let [a, b, ..] = *points else { return Ok(None) };
    let turns = control.turns();
    let goes_on = |_: &usize| turns.go_on();
    let c = (2..points.len()).take_while(goes_on).find(|&c| !collinear(a, b, points[c]));
    let beyond = |c: usize, d: usize| orient3d(a, b, points[c], points[d]) != Sign::Zero;
    let d = c.and_then(|c| (c + 1..points.len()).take_while(goes_on).find(|&d| beyond(c, d)));
    turns.end()?;
    Ok(c.zip(d).map(|(c, d)| [0, 1, c as u32, d as u32]))
}

#[cfg(test)]
mod tests;
