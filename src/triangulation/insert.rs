//! Insertion of one point, and of many: one by one, or in [bulk](super::bulk).

use glam::DVec3;

use super::cavity::Cavity;
use super::journal::Journal;
use super::order::spatial_order;
use super::pass::POLL_INTERVAL;
use super::site::Site;
use super::topology::{tet_of, GHOST, MAX_VERTICES};
use super::Triangulation;
use crate::geometry::{check_range, Sign};
use crate::{memory, Control, Error};

/// What to go back to when many points can't be inserted.
enum Before {
    Nothing,
    Same,
    Journal(Box<Journal>),
    Copy(Box<Triangulation>),
}

/// Where a cancelled insertion goes back to.
pub(super) enum Back<'a> {
    /// Nowhere: the caller gives up all tetrahedra.
    Nowhere,
    /// To what was before it, by its own means.
    Before,
    /// To what was before many of them, by the caller's.
    Journal(&'a mut Journal),
}

impl Back<'_> {
    /// The same once more.
    fn again(&mut self) -> Back<'_> {
        match self {
            Back::Nowhere => Back::Nowhere,
            Back::Before => Back::Before,
            Back::Journal(journal) => Back::Journal(journal),
        }
    }
}

/// What became of an inserted point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inserted {
    /// The point's vertex.
    pub vertex: u32,
    /// Whether the vertex is new, not one that was at the same place before.
    pub is_new: bool,
}

/// Why a constructed point can't be inserted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Unplaced {
    /// This vertex is at the same place.
    Occupied(u32),
    /// The search for its cavity has ended early: a control has cancelled it, or memory is lacking.
    Ended(Error),
    /// A coordinate is one that the [predicates can't hold](crate::geometry::check_range), as the circumcentre's of corners that nearly are in line.
    OutOfRange,
}

/// Fewer points than these are inserted one by one, with a [journal](super::journal) to go back by; for more there is a copy.
const FEW: usize = 1024;
/// How many tetrahedra a point brings, and a little more.
const TETRAHEDRA_A_POINT: usize = 8;
/// Points that are checked between two looks at the control.
const PART: usize = 1 << 16;

impl Triangulation {
    /// Inserts one point. `hint` is a vertex near it, if one is known. A new vertex takes the id of the vertex removed last, if there is one.
    ///
    /// Cost: the walk from the hint, then linear in the number of tetrahedra that change.
    pub fn insert(&mut self, point: DVec3, hint: Option<u32>) -> Result<Inserted, Error> {
        self.insert_as((self.next_vertex(), point), hint, Back::Before, Control::never())
    }

    pub(super) fn insert_as(
        &mut self,
        (vertex, point): (u32, DVec3),
        hint: Option<u32>,
        back: Back,
        control: &Control,
    ) -> Result<Inserted, Error> {
        check_range(0, point)?;
        self.check_room(1)?;
        self.reserve_vertex()?;
        let point = point + DVec3::ZERO;
        self.filter.extend(point);
        let start = self.start(hint);
        let slots = self.points.len();
        let found = self.insert_new(vertex, point, start, back, control);
        if !matches!(found, Ok(inserted) if inserted.is_new) {
            self.unstore(vertex, slots);
        }
        found
    }

    /// Inserts points in a spatial order, numbers them in theirs behind all ids of before (a single point as [`insert`](Self::insert) does).
    /// Returns the vertex of each point; `None` when `control` cancelled the call. Then, as after an error, the triangulation is as it was before.
    ///
    /// Many points are inserted by [several threads](Self::set_threads) if there may be more than one; the result is the same in every byte.
    ///
    /// Cost: near-linear for points without adverse structure; a copy of the triangulation is kept for going back when it has
    /// vertices already and more than a thousand points come at once.
    pub fn insert_many(&mut self, points: &[DVec3], control: &Control) -> Result<Option<Vec<u32>>, Error> {
        // Before a look at any of them: no memory holds too many.
        self.check_room(points.len())?;
        for (i, part) in points.chunks(PART).enumerate() {
            if !control.poll() {
                return Ok(None);
            }
            part.iter().enumerate().try_for_each(|(j, &point)| check_range(i * PART + j, point))?;
        }
        if !control.poll() {
            return Ok(None);
        }
        // To go back to nothing no copy is needed, and the memory stays for another try.
        let before = if self.points.is_empty() {
            Before::Nothing
        } else if points.len() == 1 {
            // That changes nothing when it fails.
            Before::Same
        } else if points.len() < FEW {
            Before::Journal(Box::new(Journal::new(self)))
        } else {
            // The work is done on the copy, which has the room for it.
            match self.try_clone_with_room(TETRAHEDRA_A_POINT * points.len(), control) {
                Ok(copy) => Before::Copy(Box::new(std::mem::replace(self, copy))),
                Err(Error::Cancelled) => return Ok(None),
                Err(error) => return Err(error),
            }
        };
        let mut before = before;
        let back = match &mut before {
            Before::Journal(journal) => Back::Journal(journal),
            Before::Same => Back::Before,
            Before::Nothing | Before::Copy(_) => Back::Nowhere,
        };
        let inserted = match self.insert_all(points, back, control) {
            Err(Error::Cancelled) => Ok(None),
            other => other,
        };
        let done = matches!(inserted, Ok(Some(_)));
        match before {
            Before::Copy(copy) if done => control.give_back(*copy),
            Before::Journal(journal) if done => journal.end(control),
            _ if done => {}
            Before::Nothing => self.clear(control),
            Before::Same => {}
            Before::Journal(journal) => journal.undo(self, control),
            Before::Copy(copy) => control.give_back(std::mem::replace(self, *copy)),
        }
        inserted
    }

    fn check_room(&self, more: usize) -> Result<(), Error> {
        let requested = self.points.len().saturating_add(more);
        if requested > MAX_VERTICES || !self.topology.has_room(more) {
            return Err(Error::TooManyVertices { requested, limit: MAX_VERTICES });
        }
        Ok(())
    }

    fn insert_all(&mut self, points: &[DVec3], mut back: Back, control: &Control) -> Result<Option<Vec<u32>>, Error> {
        let mut ids = memory::with_room(points.len(), "ids")?;
        // Until a volume is spanned, and when they are few: one after the other.
        let mut rest = points;
        while let Some((&point, others)) = rest.split_first() {
            if self.dimension() == 3 && points.len() >= FEW {
                break;
            }
            let goes_on = if ids.len() % POLL_INTERVAL == 0 && points.len() >= FEW {
                let fraction = ids.len() as f64 / points.len() as f64;
                control.report("delaunay", fraction, self.vertex_count())
            } else {
                control.poll()
            };
            if !goes_on {
                return Ok(None);
            }
            self.room_ahead(control)?;
            let vertex = if points.len() == 1 { self.next_vertex() } else { self.points.len() as u32 };
            ids.push(self.insert_as((vertex, point), None, back.again(), control)?.vertex);
            rest = others;
        }
        if rest.is_empty() {
            return Ok(Some(ids));
        }
        Ok(self.insert_sorted(rest, control)?.map(|more| {
            ids.extend(more);
            ids
        }))
    }

    /// Stores `point` as that vertex and inserts it. When it is not new or fails, the caller takes it off again.
    #[inline]
    fn insert_new(
        &mut self,
        vertex: u32,
        point: DVec3,
        start: u32,
        back: Back,
        control: &Control,
    ) -> Result<Inserted, Error> {
        self.store(vertex, point);
        if self.dimension() < 3 {
            return self.insert_lower(vertex, point, back, control);
        }
        self.insert_or_back(vertex, start, back, control)
    }

    fn insert_lower(&mut self, vertex: u32, point: DVec3, back: Back, control: &Control) -> Result<Inserted, Error> {
        if let Some(vertex) = self.lower.find(point) {
            return Ok(Inserted { vertex, is_new: false });
        }
        let dimension = self.lower.dimension();
        if let Some(basis) = self.lower.add(vertex, point, &self.points) {
            if let Err(error) = self.raise(basis, control) {
                self.topology.clear_tetrahedra();
                self.lower.take_back(point, true);
                return Err(error);
            }
            let by_point = self.lower.forget_points(point);
            match back {
                Back::Journal(journal) => journal.note_raise(by_point),
                Back::Nowhere | Back::Before => control.give_back(by_point),
            }
        } else if let Back::Journal(journal) = back {
            journal.note_lower(point, self.lower.dimension() > dimension);
        }
        Ok(Inserted { vertex, is_new: true })
    }

    /// Triangulates all vertices, of which four span a volume since the last one came.
    fn raise(&mut self, basis: [u32; 4], control: &Control) -> Result<(), Error> {
        let mut vertices = memory::room_in_pieces::<u32>(self.vertex_count(), "vertices", control)?;
        vertices.extend(self.vertices());
        let mut points = memory::room_in_pieces::<DVec3>(vertices.len(), "points", control)?;
        for part in vertices.chunks(PART) {
            control.check()?;
            points.extend(part.iter().map(|&v| self.at(v)));
        }
        let order = spatial_order(&points, control)?.into_iter().map(|i| vertices[i as usize]);
        self.start_from(basis);
        for (turn, v) in order.filter(|v| !basis.contains(v)).enumerate() {
            let goes_on = if turn % POLL_INTERVAL == 0 {
                control.report("delaunay", turn as f64 / vertices.len() as f64, vertices.len())
            } else {
                control.poll()
            };
            if !goes_on {
                return Err(Error::Cancelled);
            }
            self.room_ahead(control)?;
            self.insert_stored(v, self.last, control)?;
        }
        Ok(())
    }

    /// The triangulation of one tetrahedron and its four ghosts.
    pub(super) fn start_from(&mut self, [a, b, c, d]: [u32; 4]) {
        let (a, b) = match self.filter.orient3d(self.at(a), self.at(b), self.at(c), self.at(d)) {
            Sign::Positive => (a, b),
            _ => (b, a),
        };
        let topology = &mut self.topology;
        let inner = topology.create([a, b, c, d]);
        // Each ghost sees its facet from outside: two corners swapped.
        let ghosts = [[b, d, c], [a, c, d], [a, d, b], [a, b, c]].map(|[p, q, r]| topology.create([q, p, r, GHOST]));
        for (slot, &ghost) in ghosts.iter().enumerate() {
            topology.join(4 * inner + slot as u32, 4 * ghost + 3);
        }
        for (i, &g) in ghosts.iter().enumerate() {
            for &h in &ghosts[i + 1..] {
                let (s, t) = (topology.tet(g), topology.tet(h));
                let slot = (0..3).find(|&k| !t.v.contains(&s.v[k]));
                let other = (0..3).find(|&k| !s.v.contains(&t.v[k]));
                if let (Some(slot), Some(other)) = (slot, other) {
                    topology.join(4 * g + slot as u32, 4 * h + other as u32);
                }
            }
        }
        for v in [a, b, c, d] {
            topology.vertex_tet[v as usize] = inner;
        }
        self.last = inner;
    }

    /// Inserts a vertex whose point is stored, in dimension 3. When it is cancelled, the tetrahedra are good for nothing but to be cleared.
    #[inline]
    pub(super) fn insert_stored(&mut self, vertex: u32, start: u32, control: &Control) -> Result<Inserted, Error> {
        self.insert_or_back(vertex, start, Back::Nowhere, control)
    }

    /// Inserts a vertex whose point is stored, in dimension 3.
    #[inline]
    fn insert_or_back(&mut self, vertex: u32, start: u32, back: Back, control: &Control) -> Result<Inserted, Error> {
        let point = self.at(vertex);
        let t = self.walk_within(&self.filter, point, start, control)?;
        if let Some(at) = self.vertex_at(t, point) {
            self.last = t;
            return Ok(Inserted { vertex: at, is_new: false });
        }
        let mut cavity = std::mem::take(&mut self.scratch);
        let found = self.find_cavity(&self.filter, point, t, &mut cavity, control);
        let result = found.and_then(|()| match back {
            Back::Nowhere => self.commit(vertex, &mut cavity, true, control),
            Back::Before => self.commit_or_not(vertex, &mut cavity, control),
            Back::Journal(journal) => {
                journal.note(self, &cavity, control)?;
                self.commit(vertex, &mut cavity, true, control)
            }
        });
        if result.is_err() {
            cavity.clear();
        }
        self.scratch = cavity;
        result.map(|()| Inserted { vertex, is_new: true })
    }

    /// [`commit`](Self::commit) after which all is as it was when it is cancelled.
    #[inline]
    fn commit_or_not(&mut self, vertex: u32, cavity: &mut Cavity, control: &Control) -> Result<(), Error> {
        let count = cavity.tets.len() + cavity.faces.len();
        self.change(count, control, |this, control| this.commit(vertex, cavity, true, control))
    }

    /// Inserts the point of `vertex` into its cavity. Without `incidence`, `vertex_tet` is left for later. After a cancellation, the tetrahedra are good for
    /// nothing but to be cleared.
    #[inline]
    pub(super) fn commit(
        &mut self,
        vertex: u32,
        cavity: &mut Cavity,
        incidence: bool,
        control: &Control,
    ) -> Result<(), Error> {
        if !self.topology.has_room(cavity.faces.len()) {
            return Err(Error::TooManyVertices { requested: self.points.len(), limit: MAX_VERTICES });
        }
        // SAFETY: the cavity is one of this triangulation, which has not changed since.
        unsafe { cavity.plan(Site::of(self), control) }?;
        self.reserve_for(cavity, control)?;
        self.fill_cavity(vertex, cavity, incidence, control)?;
        self.last = cavity.created[cavity.created.len() - 1];
        Ok(())
    }

    /// Memory for the star that replaces a cavity, and for the marks of the search after it.
    #[inline]
    fn reserve_for(&mut self, cavity: &mut Cavity, control: &Control) -> Result<(), Error> {
        let before = self.topology.tets.capacity();
        // The cavity's own places are used again.
        let more = cavity.faces.len().saturating_sub(cavity.tets.len());
        if cavity.planned {
            self.make_tetrahedra(more, control)?;
        }
        self.topology.reserve(more)?;
        let now = self.topology.tets.capacity();
        if now == before {
            return Ok(());
        }
        cavity.reserve_marks(now)?;
        // A vertex has some six tetrahedra.
        cavity.labels.reserve_room(now / 6)
    }

    /// The corner of tetrahedron `t` that lies at `point`.
    #[inline]
    pub(crate) fn vertex_at(&self, t: u32, point: DVec3) -> Option<u32> {
        debug_assert!(self.topology.tet(t).is_live());
        assert!((t as usize) < self.topology.tets.len());
        // SAFETY: it exists, and nothing changes the triangulation meanwhile.
        unsafe { Site::of(self).vertex_at(t, point) }
    }

    /// Finds the cavity of a point that is to be inserted perhaps: [`insert_into`](Self::insert_into) does it, dropping the cavity does
    /// not. Dimension 3 only; `start` is a tetrahedron near the point, and one in conflict with it saves the walk.
    pub(crate) fn prepare(
        &self,
        point: DVec3,
        start: u32,
        cavity: &mut Cavity,
        control: &Control,
    ) -> Result<(), Unplaced> {
        if check_range(0, point).is_err() {
            return Err(Unplaced::OutOfRange);
        }
        // The triangulation's own filter, and with it the bounding box, grows only when the point is inserted.
        let mut filter = self.filter.clone();
        filter.extend(point);
        let in_conflict = self.vertex_at(start, point).is_none() && self.conflicts(&filter, start, point);
        let arrived = if in_conflict { Ok(start) } else { self.walk_within(&filter, point, start, control) };
        let t = arrived.map_err(Unplaced::Ended)?;
        if let Some(at) = self.vertex_at(t, point) {
            return Err(Unplaced::Occupied(at));
        }
        self.find_cavity(&filter, point, t, cavity, control).map_err(Unplaced::Ended)
    }

    /// Inserts the point that `cavity` was found for. After an error, that of a cancellation perhaps, all is as it was, but that the cavity is empty.
    pub(crate) fn insert_into(&mut self, point: DVec3, cavity: &mut Cavity, control: &Control) -> Result<u32, Error> {
        let (vertex, slots) = (self.next_vertex(), self.points.len());
        if vertex as usize >= MAX_VERTICES {
            cavity.clear();
            return Err(Error::TooManyVertices { requested: vertex as usize + 1, limit: MAX_VERTICES });
        }
        if let Err(error) = self.reserve_vertex() {
            cavity.clear();
            return Err(error);
        }
        self.filter.extend(point);
        self.store(vertex, point);
        let result = self.commit_or_not(vertex, cavity, control);
        if result.is_err() {
            cavity.clear();
            self.unstore(vertex, slots);
        }
        result.map(|()| vertex)
    }

    /// A tetrahedron of the last insertion.
    pub(crate) fn recent(&self) -> u32 {
        self.last
    }

    /// A finite tetrahedron at `t`: itself, or the one inside a ghost's facet.
    pub(crate) fn finite_at(&self, t: u32) -> u32 {
        let tet = self.topology.tet(t);
        if tet.is_ghost() {
            tet_of(tet.n[3])
        } else {
            t
        }
    }
}

#[cfg(test)]
mod tests;
