//! Which boundary elements wait to be split: those that a split has taken out of the triangulation, and those that something encroaches upon. An
//! entry is looked at again when its turn comes; very many need no split any more by then.

use std::collections::VecDeque;

use super::acute::Carrier;
use super::boundary::{edge_key, face_key, Boundary};
use super::elements::Corners;
use super::encroached::Encroached;
use super::pending::Demand;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::leavings::InPieces;
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::{Control, Error};

/// Elements that are encroached before the refinement begins are split down to this part of their shortest side, where they meet others acutely.
const FIRST_SPLITS: f64 = 0.125;

/// How a boundary element stands in the triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Missing,
    Encroached,
    Clear,
}

impl State {
    fn of(encroached: bool) -> State {
        if encroached {
            State::Encroached
        } else {
            State::Clear
        }
    }
}

impl Boundary {
    /// Queues what of these elements still exists and can be split as demanded.
    pub(crate) fn enqueue(&mut self, found: &Encroached, demand: Demand) {
        for &s in &found.segments {
            if self.waits_segment(s, demand) {
                self.pending_segments.push_back((s, demand));
            }
        }
        for &f in &found.facets {
            if self.waits_facet(f, demand) {
                self.pending_facets.push_back((f, demand));
            }
        }
    }

    /// [`enqueue`](Self::enqueue) for what the new vertex `v` of the boundary encroaches upon, small input angles excepted, or has taken out; while
    /// the boundary is refined lazily only the latter.
    pub(crate) fn enqueue_for(&mut self, t: &Triangulation, v: u32, found: &mut Encroached, demand: Demand) {
        debug_assert!(found.taken_segments().all(|[a, b]| t.find_edge(a, b).is_none()));
        debug_assert!(found.taken_facets().all(|face| t.find_face(face).is_none()));
        // Not what has been split: it is none any more.
        let (segments, facets) = (&self.subsegments, &self.subfacets);
        self.missing_segments.extend(found.taken_segments().filter(|edge| segments.contains_key(edge)));
        self.missing_facets.extend(found.taken_facets().filter(|face| facets.contains_key(face)));
        if self.lazy {
            return;
        }
        found.keep_standing();
        found.segments.retain(|&edge| self.vertex_encroaches_segment(t, edge, v));
        found.facets.retain(|&face| self.vertex_encroaches_facet(t, face, v));
        self.enqueue(found, demand);
    }

    /// Whether a vertex, or the ghost, encroaches upon a subsegment.
    fn vertex_encroaches_segment(&self, t: &Triangulation, edge: [u32; 2], v: u32) -> bool {
        if self.recovering || v == GHOST || !encroaches_segment(edge.map(|v| t.at(v)), t.at(v)) {
            return false;
        }
        let Some(&segment) = self.subsegments.get(&edge_key(edge)) else { return false };
        self.may_encroach(t, v, Carrier::Segment(segment), 0.5 * t.at(edge[0]) + 0.5 * t.at(edge[1]))
    }

    /// Whether a vertex, or the ghost, encroaches upon a subfacet.
    fn vertex_encroaches_facet(&self, t: &Triangulation, face: [u32; 3], v: u32) -> bool {
        let corners = face.map(|v| t.at(v));
        if self.recovering || v == GHOST || !encroaches_facet(corners, t.at(v)) {
            return false;
        }
        let Some(&facet) = self.subfacets.get(&face_key(face)) else { return false };
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
        let encroached = State::Encroached;
        let turns = control.turns();
        segments.retain(|e| {
            turns.go_on() && self.subsegments.contains_key(e) && self.state_of_segment(t, *e) == encroached
        });
        facets.retain(|f| turns.go_on() && self.subfacets.contains_key(f) && self.state_of_facet(t, *f) == encroached);
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
        let (mut segments, mut facets) = (InPieces::new(Vec::new(), control), InPieces::new(Vec::new(), control));
        let mut missing_segments = InPieces::new(Vec::new(), control);
        let mut missing_facets = InPieces::new(Vec::new(), control);
        for &edge in &*self.subsegments.sorted_keys(control)? {
            // A look each time: an edge or a face of large stars takes its time.
            control.check()?;
            match self.state_of_segment(t, edge) {
                State::Missing => missing_segments.push(edge),
                State::Encroached => segments.push(edge),
                State::Clear => {}
            }
        }
        for &face in &*self.subfacets.sorted_keys(control)? {
            control.check()?;
            match self.state_of_facet(t, face) {
                State::Missing => missing_facets.push(face),
                State::Encroached => facets.push(face),
                State::Clear => {}
            }
        }
        self.enqueue_first(t, &segments, &facets, control)?;
        self.missing_segments.extend(&*missing_segments);
        self.missing_facets.extend(&*missing_facets);
        Ok(())
    }

    /// What is demanded of the split of a subsegment, if a vertex encroaches upon it.
    pub(crate) fn demand_of_segment(&self, t: &Triangulation, edge: [u32; 2]) -> Option<Demand> {
        (self.state_of_segment(t, edge) == State::Encroached).then(|| first_demand(t, &edge))
    }

    /// What is demanded of the split of a subfacet, if a vertex encroaches upon it.
    pub(crate) fn demand_of_facet(&self, t: &Triangulation, face: [u32; 3]) -> Option<Demand> {
        (self.state_of_facet(t, face) == State::Encroached).then(|| first_demand(t, &face))
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
    fn state_of_segment(&self, t: &Triangulation, [a, b]: [u32; 2]) -> State {
        let Some((tet, i, j)) = t.find_edge(a, b) else { return State::Missing };
        let mut link = t.topology.around_edge(tet, i, j).map(|(around, k, _)| t.topology.tet(around).v[k]);
        State::of(link.any(|v| self.vertex_encroaches_segment(t, [a, b], v)))
    }

    /// If any vertex lies in the smallest ball of a face, one of its two apices does.
    fn state_of_facet(&self, t: &Triangulation, face: [u32; 3]) -> State {
        let mut apices = t.face_apices(face).peekable();
        if apices.peek().is_none() {
            return State::Missing;
        }
        State::of(apices.any(|v| self.vertex_encroaches_facet(t, face, v)))
    }

    /// Queues those of the elements at vertex `new` that are missing or encroached; `star` are the tetrahedra at it.
    pub(super) fn enqueue_new(
        &mut self,
        t: &Triangulation,
        new: u32,
        star: &[u32],
        segments: &[[u32; 2]],
        facets: &[[u32; 3]],
        demand: Demand,
    ) {
        // What encroaches upon an element at `new`, or that it is missing, shows in the star. A segment has two parts at most, but a facet's split may bring
        // as many triangles as there are vertices.
        for &edge in segments {
            debug_assert!(edge.contains(&new));
            let all = star.iter().map(|&tet| t.topology.tet(tet).v);
            let mut around = all.filter(|v| edge.iter().all(|end| v.contains(end))).peekable();
            if around.peek().is_none() {
                self.missing_segments.push_back(edge_key(edge));
            } else if !self.lazy
                && around.flatten().any(|v| !edge.contains(&v) && self.vertex_encroaches_segment(t, edge, v))
            {
                self.pending_segments.push_back((edge_key(edge), demand));
            }
        }
        let side = |a: u32, b: u32| u64::from(a.min(b)) << 32 | u64::from(a.max(b));
        let across = |face: [u32; 3]| {
            debug_assert!(face.contains(&new));
            let at = face.iter().position(|&v| v == new).unwrap_or(0);
            side(face[(at + 1) % 3], face[(at + 2) % 3])
        };
        let mut found: Vec<_> = facets.iter().map(|&face| (across(face), face, State::Missing)).collect();
        found.sort_unstable_by_key(|&(side, ..)| side);
        // Few sides of the star are such: most miss a vertex of them.
        let corners = Corners::of(facets);
        for &tet in if found.is_empty() { &[] } else { star } {
            let v = t.topology.tet(tet).v;
            let at = v.iter().position(|&v| v == new).unwrap_or(0);
            let [a, b, c] = [v[at ^ 1], v[at ^ 2], v[at ^ 3]];
            for ([p, q], apex) in [([a, b], c), ([b, c], a), ([c, a], b)] {
                if !corners.may_have(p) || !corners.may_have(q) {
                    continue;
                }
                let side = side(p, q);
                let Ok(at) = found.binary_search_by_key(&side, |&(side, ..)| side) else { continue };
                let (_, face, state) = &mut found[at];
                if *state != State::Encroached {
                    *state = State::of(!self.lazy && self.vertex_encroaches_facet(t, *face, apex));
                }
            }
        }
        for &face in facets {
            let at = found.binary_search_by_key(&across(face), |&(side, ..)| side);
            match at.map_or(State::Missing, |at| found[at].2) {
                State::Missing => self.missing_facets.push_back(face_key(face)),
                State::Encroached => self.pending_facets.push_back((face_key(face), demand)),
                State::Clear => {}
            }
        }
    }
}

/// What is demanded of the split of an element that a vertex encroaches upon, and that no other split has brought about: to stay within a fraction of it.
fn first_demand(t: &Triangulation, corners: &[u32]) -> Demand {
    let side = |i: usize| t.at(corners[i]).distance(t.at(corners[(i + 1) % corners.len()]));
    let shortest = (0..corners.len()).map(side).fold(f64::INFINITY, f64::min);
    Demand::of(shortest * FIRST_SPLITS).following()
}

impl Triangulation {
    /// The vertices opposite a face, the ghost among them; none when it is no face.
    fn face_apices(&self, face: [u32; 3]) -> impl Iterator<Item = u32> + '_ {
        let apex = |face: u32| self.topology.tet(tet_of(face)).v[slot_of(face)];
        let side = self.find_face(face);
        side.into_iter().flat_map(move |face| [apex(face), apex(self.topology.tet(tet_of(face)).n[slot_of(face)])])
    }
}
