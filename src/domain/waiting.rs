//! Which boundary elements wait to be split: those that a split has taken out of the triangulation, and those that something encroaches upon. An
//! entry is looked at again when its turn comes; very many need no split any more by then.

use std::collections::VecDeque;

use super::acute::Carrier;
use super::boundary::{edge_key, face_key, Boundary};
use super::encroached::Encroached;
use super::pending::Demand;
use super::survey::Survey;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::{memory, Control, DVec3, Error};

/// Elements that are encroached before the refinement begins are split down to this part of their shortest side, where they meet others acutely.
const FIRST_SPLITS: f64 = 0.125;

/// How a boundary element stands in the triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    Missing,
    Encroached,
    Clear,
}

impl State {
    pub fn of(encroached: bool) -> State {
        if encroached {
            State::Encroached
        } else {
            State::Clear
        }
    }
}

impl Boundary {
    /// Queues what of these elements still exists and can be split as demanded; some of it, when the control says stop.
    pub(crate) fn enqueue(&mut self, found: &Encroached, demand: Demand, control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        memory::grow_queue(&mut self.pending_segments, found.segments.len(), "boundary", control)?;
        for &s in &found.segments {
            turns.check()?;
            if self.waits_segment(s, demand) {
                self.pending_segments.push_back((s, demand));
            }
        }
        memory::grow_queue(&mut self.pending_facets, found.facets.len(), "boundary", control)?;
        for &f in &found.facets {
            turns.check()?;
            if self.waits_facet(f, demand) {
                self.pending_facets.push_back((f, demand));
            }
        }
        Ok(())
    }

    /// [`enqueue`](Self::enqueue) for what the new vertex `v` of the boundary encroaches upon, small input angles excepted, or has taken out; while
    /// the boundary is refined lazily only the latter.
    /// When the control says stop, half of it is done.
    pub(crate) fn enqueue_for(
        &mut self,
        t: &Triangulation,
        v: u32,
        found: &mut Encroached,
        demand: Demand,
        control: &Control,
    ) -> Result<(), Error> {
        let turns = control.turns();
        debug_assert!(found.taken_segments().all(|[a, b]| t.find_edge(a, b).is_none()));
        debug_assert!(found.taken_facets().all(|face| t.find_face(face).is_none()));
        // Not what has been split: it is none any more.
        let (segments, facets) = (&self.subsegments, &self.subfacets);
        let taken = found.taken_segments().take_while(|_| turns.go_on());
        self.missing_segments.extend(taken.filter(|edge| segments.contains_key(edge)));
        let taken = found.taken_facets().take_while(|_| turns.go_on());
        self.missing_facets.extend(taken.filter(|face| facets.contains_key(face)));
        if !self.lazy {
            found.keep_standing();
            found.segments.retain(|&edge| turns.go_on() && self.vertex_encroaches_segment(t, edge, v));
            found.facets.retain(|&face| turns.go_on() && self.vertex_encroaches_facet(t, face, v));
            turns.end()?;
            self.enqueue(found, demand, control)?;
        }
        turns.end()
    }

    /// Whether a vertex, or the ghost, encroaches upon a subsegment.
    fn vertex_encroaches_segment(&self, t: &Triangulation, edge: [u32; 2], v: u32) -> bool {
        let segment = self.subsegments.get(&edge_key(edge));
        segment.is_some_and(|&segment| self.encroaches_part(t, (segment, edge.map(|v| t.at(v))), v))
    }

    /// Whether a vertex, or the ghost, encroaches upon a subfacet.
    fn vertex_encroaches_facet(&self, t: &Triangulation, face: [u32; 3], v: u32) -> bool {
        let facet = self.subfacets.get(&face_key(face));
        facet.is_some_and(|&facet| self.encroaches_triangle(t, (facet, face.map(|v| t.at(v))), v))
    }

    /// Whether a vertex, or the ghost, encroaches upon a part of a segment.
    pub(super) fn encroaches_part(&self, t: &Triangulation, (segment, ends): (u32, [DVec3; 2]), v: u32) -> bool {
        if self.recovering || v == GHOST || !encroaches_segment(ends, t.at(v)) {
            return false;
        }
        self.may_encroach(t, v, Carrier::Segment(segment), 0.5 * ends[0] + 0.5 * ends[1])
    }

    /// Whether a vertex, or the ghost, encroaches upon a triangle of a facet.
    pub(super) fn encroaches_triangle(&self, t: &Triangulation, (facet, corners): (u32, [DVec3; 3]), v: u32) -> bool {
        if self.recovering || v == GHOST || !encroaches_facet(corners, t.at(v)) {
            return false;
        }
        self.may_encroach(t, v, Carrier::Facet(facet), (corners[0] + corners[1] + corners[2]) / 3.0)
    }

    /// The next subsegment to split.
    pub(crate) fn next_pending_segment(&self) -> Option<[u32; 2]> {
        self.pending_segments
            .iter()
            .copied()
            .find(|&(edge, demand)| self.waits_segment(edge, demand))
            .map(|(edge, _)| edge)
    }

    /// The next subfacet to split.
    pub(crate) fn next_pending_facet(&self) -> Option<[u32; 3]> {
        self.pending_facets.iter().copied().find(|&(face, demand)| self.waits_facet(face, demand)).map(|(face, _)| face)
    }

    /// Takes the next subsegment to split off its queue; [`Error::Cancelled`], and nothing that waits is lost, when it shall not go on.
    pub(crate) fn pop_segment(&mut self, go_on: &dyn Fn() -> bool) -> Result<Option<([u32; 2], Demand)>, Error> {
        self.pop(go_on, |b| &mut b.pending_segments, |b, &(edge, demand)| b.waits_segment(edge, demand))
    }

    /// [`pop_segment`](Self::pop_segment) for the next subfacet to split.
    pub(crate) fn pop_facet(&mut self, go_on: &dyn Fn() -> bool) -> Result<Option<([u32; 3], Demand)>, Error> {
        self.pop(go_on, |b| &mut b.pending_facets, |b, &(face, demand)| b.waits_facet(face, demand))
    }

    /// Takes entries off the front of a queue, up to the first that `waits`. Very many may be stale by their turn.
    fn pop<T>(
        &mut self,
        go_on: &dyn Fn() -> bool,
        queue: impl Fn(&mut Self) -> &mut VecDeque<T>,
        waits: impl Fn(&Self, &T) -> bool,
    ) -> Result<Option<T>, Error> {
        while !queue(self).is_empty() {
            if !go_on() {
                return Err(Error::Cancelled);
            }
            let entry = queue(self).pop_front();
            if entry.as_ref().is_some_and(|entry| waits(self, entry)) {
                return Ok(entry);
            }
        }
        Ok(None)
    }

    /// Takes entries that need no split any more off the front of the queues.
    pub(crate) fn drop_stale(&mut self) {
        // Nobody cancels it.
        if let Ok(Some(entry)) = self.pop_segment(&|| true) {
            self.pending_segments.push_front(entry);
        }
        if let Ok(Some(entry)) = self.pop_facet(&|| true) {
            self.pending_facets.push_front(entry);
        }
    }

    /// Forgets which elements could not be split: the limits that forbade it may be others now. Those that need a split are queued. Nothing has
    /// changed when the control says stop.
    pub(crate) fn unblock(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        let mut segments = self.blocked.segments(control)?;
        let mut facets = self.blocked.facets(control)?;
        let encroached = Ok(State::Encroached);
        let turns = control.turns();
        segments.retain(|e| {
            turns.go_on() && self.subsegments.contains_key(e) && self.state_of_segment(t, *e, control) == encroached
        });
        facets.retain(|f| {
            turns.go_on() && self.subfacets.contains_key(f) && self.state_of_facet(t, *f, control) == encroached
        });
        turns.end()?;
        self.enqueue_first(t, &segments, &facets, control)?;
        self.blocked.clear();
        Ok(())
    }

    /// Forgets what waits to be split and what could not be, for a refinement that goes by samples alone. Another one has to look for it anew.
    pub(crate) fn forget_waiting(&mut self) {
        self.blocked.clear();
        self.pending_segments.clear();
        self.pending_facets.clear();
        self.relaxed = true;
    }

    /// Queues every subsegment and subfacet that a vertex encroaches upon, or that is missing from the triangulation. Nothing has changed when the
    /// control says stop.
    pub(crate) fn enqueue_all(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        let found = self.survey(t, true, control)?;
        self.enqueue_first(t, &found.encroached_segments, &found.encroached_facets, control)?;
        self.miss(&found);
        Ok(())
    }

    /// Queues every subsegment and subfacet that is missing from the triangulation. Nothing has changed when the control says stop.
    pub(crate) fn enqueue_missing(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        let found = self.survey(t, false, control)?;
        self.miss(&found);
        Ok(())
    }

    fn miss(&mut self, found: &Survey) {
        self.missing_segments.extend(&found.missing_segments);
        self.missing_facets.extend(&found.missing_facets);
    }

    /// What is demanded of the split of a subsegment, if a vertex encroaches upon it.
    pub(crate) fn demand_of_segment(&self, t: &Triangulation, edge: [u32; 2]) -> Option<Demand> {
        let state = self.state_of_segment(t, edge, Control::never());
        (state == Ok(State::Encroached)).then(|| first_demand(t, &edge))
    }

    /// What is demanded of the split of a subfacet, if a vertex encroaches upon it.
    pub(crate) fn demand_of_facet(&self, t: &Triangulation, face: [u32; 3]) -> Option<Demand> {
        let state = self.state_of_facet(t, face, Control::never());
        (state == Ok(State::Encroached)).then(|| first_demand(t, &face))
    }

    /// Queues elements that no other split has brought about. Nothing has changed when the control says stop.
    fn enqueue_first(
        &mut self,
        t: &Triangulation,
        segments: &[[u32; 2]],
        facets: &[[u32; 3]],
        control: &Control,
    ) -> Result<(), Error> {
        let (before, turns) = ((self.pending_segments.len(), self.pending_facets.len()), control.turns());
        self.pending_segments.extend(segments.iter().map_while(|&e| turns.go_on().then(|| (e, first_demand(t, &e)))));
        self.pending_facets.extend(facets.iter().map_while(|&f| turns.go_on().then(|| (f, first_demand(t, &f)))));
        turns.end().inspect_err(|_| {
            self.pending_segments.truncate(before.0);
            self.pending_facets.truncate(before.1);
        })
    }

    /// Takes the next subsegment that is missing off its queue, as [`pop_segment`](Self::pop_segment) does. Most that was missing is there again when
    /// something near it has been split.
    pub(crate) fn pop_missing_segment(
        &mut self,
        t: &Triangulation,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<[u32; 2]>, Error> {
        let missing =
            |b: &Self, edge: &[u32; 2]| b.subsegments.contains_key(edge) && t.find_edge(edge[0], edge[1]).is_none();
        self.pop(go_on, |b| &mut b.missing_segments, missing)
    }

    /// [`pop_missing_segment`](Self::pop_missing_segment) for the next subfacet that is missing.
    pub(crate) fn pop_missing_facet(
        &mut self,
        t: &Triangulation,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<[u32; 3]>, Error> {
        let missing = |b: &Self, face: &[u32; 3]| b.subfacets.contains_key(face) && t.find_face(*face).is_none();
        self.pop(go_on, |b| &mut b.missing_facets, missing)
    }

    /// Whether an element may be missing.
    pub(crate) fn misses(&self) -> bool {
        !(self.missing_segments.is_empty() && self.missing_facets.is_empty())
    }

    /// If any vertex lies in the diametral ball of an edge, one of its link does.
    pub(super) fn state_of_segment(
        &self,
        t: &Triangulation,
        [a, b]: [u32; 2],
        control: &Control,
    ) -> Result<State, Error> {
        let Some((tet, i, j)) = t.find_edge_within(a, b, control)? else { return Ok(State::Missing) };
        let turns = control.turns();
        let mut link = t.topology.around_edge(tet, i, j).map(|(around, k, _)| t.topology.tet(around).v[k]);
        let encroached = link.any(|v| !turns.go_on() || self.vertex_encroaches_segment(t, [a, b], v));
        turns.end().map(|()| State::of(encroached))
    }

    /// If any vertex lies in the smallest ball of a face, one of its two apices does.
    pub(super) fn state_of_facet(&self, t: &Triangulation, face: [u32; 3], control: &Control) -> Result<State, Error> {
        let Some(side) = t.find_face_within(face, control)? else { return Ok(State::Missing) };
        let apex = |face: u32| t.topology.tet(tet_of(face)).v[slot_of(face)];
        let other = t.topology.tet(tet_of(side)).n[slot_of(side)];
        let encroached = [side, other].into_iter().any(|side| self.vertex_encroaches_facet(t, face, apex(side)));
        Ok(State::of(encroached))
    }
}

/// What is demanded of the split of an element that a vertex encroaches upon, and that no other split has brought about: to stay within a fraction of it.
fn first_demand(t: &Triangulation, corners: &[u32]) -> Demand {
    let side = |i: usize| t.at(corners[i]).distance(t.at(corners[(i + 1) % corners.len()]));
    let shortest = (0..corners.len()).map(side).fold(f64::INFINITY, f64::min);
    Demand::of(shortest * FIRST_SPLITS).following()
}
