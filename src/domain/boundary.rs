//! The boundary of a domain as the refinement sees it: subsegments and subfacets, which change as they are split, and the queues of those that
//! have to be.

use std::collections::VecDeque;

use super::acute::Carrier;
use super::blocked::Blocked;
use super::elements::{bit, Subfacets, Subsegments};
pub use super::encroached::Encroached;
use super::facet::FacetTriangulation;
use super::pending::Demand;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::leavings::{give_elements_back, InPieces, Leavings};
use crate::parted::PartedMap;
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::{memory, Control, Error};

/// An edge's key: lower vertex first.
pub fn edge_key([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// A face's key: vertices in order.
pub fn face_key(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// The keys of some faces, in order.
pub(crate) fn face_keys<'a>(faces: impl IntoIterator<Item = &'a [u32; 3]>) -> Vec<[u32; 3]> {
    let mut keys: Vec<[u32; 3]> = faces.into_iter().map(|&face| face_key(face)).collect();
    keys.sort_unstable();
    keys
}

/// The places of a word's bits.
#[inline]
pub(crate) fn places(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        place
    })
}

/// A vertex lies on a segment.
pub(super) const ON_SEGMENT: u8 = 1;
/// A vertex lies on a facet.
pub(super) const ON_FACET: u8 = 2;
/// A vertex is an end of two segments that meet at less than 60°.
pub(super) const ACUTE: u8 = 4;
/// A vertex lies on a segment where two facets meet at less than 60°.
pub(super) const SHARP: u8 = 8;

/// Elements that are encroached before the refinement begins are split down to this part of their shortest side, where they meet others acutely.
const FIRST_SPLITS: f64 = 0.125;

/// An input segment.
#[derive(Clone, Debug)]
pub struct Segment {
    /// The caller's own number for it.
    pub marker: i32,
    /// The vertices at its ends.
    pub ends: [u32; 2],
    /// The facets that it borders or lies in.
    pub facets: Vec<u32>,
}

/// What is known of a vertex before a split, to take the split back.
#[derive(Clone, Debug)]
pub(crate) struct Standing {
    pub kind: u8,
    pub carrier: Carrier,
    /// The subsegment that is split, if it is one, and its parts, each with its segment. Parts may be there already.
    pub segments: Vec<([u32; 2], Option<u32>)>,
    /// The subfacets that go and come, likewise: near small angles one may come in two facets.
    pub facets: Vec<([u32; 3], Option<u32>)>,
}

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

/// The boundary of a domain within a triangulation.
#[derive(Clone, Debug, Default)]
pub struct Boundary {
    /// [`ON_SEGMENT`] and others, by vertex; vertices beyond its end are free.
    pub(super) kinds: Vec<u8>,
    pub(super) carriers: Vec<Carrier>,
    pub(super) segments: Vec<Segment>,
    pub(super) facets: Vec<FacetTriangulation>,
    /// The segment of each subsegment.
    pub(super) subsegments: Subsegments,
    /// The facet of each subfacet.
    pub(super) subfacets: Subfacets,
    /// Elements that a split has taken out of the triangulation; those that are there again by their turn are passed over.
    pub(crate) missing_segments: VecDeque<[u32; 2]>,
    pub(crate) missing_facets: VecDeque<[u32; 3]>,
    /// Encroached subsegments, to be split; those that are gone by their turn are passed over.
    pub(crate) pending_segments: VecDeque<([u32; 2], Demand)>,
    pub(crate) pending_facets: VecDeque<([u32; 3], Demand)>,
    /// Elements whose split was refused.
    pub(crate) blocked: Blocked,
    /// While the boundary is being recovered only what is missing is split, not what is encroached.
    pub(crate) recovering: bool,
    /// Each subfacet lies between tetrahedra with different labels.
    pub(super) parts_labels: bool,
    /// Nothing that is there may be split.
    pub(crate) kept: bool,
    /// Whether facets meet at less than 60° along each segment.
    pub(super) sharp_segments: Vec<bool>,
    /// The length of the shortest segment at each acute vertex.
    pub(super) shortest_at: PartedMap<u32, f64>,
    /// The distance of the nearest vertex to each acute vertex, when the boundary had been recovered.
    pub(super) room_at: PartedMap<u32, f64>,
    /// The largest cosine between two segments at each acute vertex.
    pub(super) sharpness: PartedMap<u32, f64>,
    /// Some element may be encroached that nothing has queued: vertices have been taken away, or it was refined [lazily](Self::lazy).
    pub(crate) relaxed: bool,
    /// While the boundary is being refined so, nothing is split because a vertex encroaches upon it: only when a sample does.
    pub(crate) lazy: bool,
}

impl Boundary {
    /// What a vertex is to the boundary: 0 for one that is not on it, and for the ghost.
    pub(crate) fn kind(&self, v: u32) -> u8 {
        self.kinds.get(v as usize).copied().unwrap_or(0)
    }

    /// The input element that a vertex lies on.
    pub fn carrier(&self, v: u32) -> Carrier {
        self.carriers.get(v as usize).copied().unwrap_or_default()
    }

    pub(super) fn sharpness(&self, v: u32) -> f64 {
        self.sharpness.get(&v).copied().unwrap_or(0.0)
    }

    /// Forgets what is known of a vertex: its id has another one now.
    pub(crate) fn unmark(&mut self, v: u32) {
        if self.kind(v) != 0 {
            self.blocked.leave(v);
        }
        self.forget(v);
    }

    /// Forgets what a vertex lies on.
    pub(super) fn forget(&mut self, v: u32) {
        if let Some(kind) = self.kinds.get_mut(v as usize) {
            *kind = 0;
        }
        if let Some(carrier) = self.carriers.get_mut(v as usize) {
            *carrier = Carrier::default();
        }
    }

    pub(super) fn mark(&mut self, v: u32, kind: u8) {
        if self.kinds.len() <= v as usize {
            self.kinds.resize(v as usize + 1, 0);
        }
        self.kinds[v as usize] |= kind;
    }

    /// Notes the input element that a vertex lies on, unless a lower one is known.
    pub(super) fn carry(&mut self, v: u32, carrier: Carrier) {
        if self.carriers.len() <= v as usize {
            self.carriers.resize(v as usize + 1, Carrier::Free);
        }
        let rank = |carrier| match carrier {
            Carrier::Vertex(_) => 0,
            Carrier::Segment(_) => 1,
            Carrier::Facet(_) => 2,
            Carrier::Free => 3,
        };
        let known = &mut self.carriers[v as usize];
        if rank(carrier) < rank(*known) {
            *known = carrier;
        }
    }

    /// All subsegments, lower vertex first, in order; with the position of their segment.
    pub fn subsegments(&self) -> Vec<([u32; 2], u32)> {
        let mut all: Vec<_> = self.subsegments.iter().map(|(&k, &s)| (k, s)).collect();
        all.sort_unstable();
        all
    }

    /// All subfacets, vertices in order; with the position of their facet.
    pub fn subfacets(&self) -> Vec<([u32; 3], u32)> {
        let mut all: Vec<_> = self.subfacets.iter().map(|(&k, &f)| (k, f)).collect();
        all.sort_unstable();
        all
    }

    /// How many subsegments and subfacets there are.
    pub(crate) fn element_count(&self) -> usize {
        self.subsegments.len() + self.subfacets.len()
    }

    /// Whether it bounds nothing.
    pub fn is_empty(&self) -> bool {
        self.subsegments.is_empty() && self.subfacets.is_empty()
    }

    /// The input segments.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The planar triangulations of the input facets.
    pub fn facets(&self) -> &[FacetTriangulation] {
        &self.facets
    }

    /// The position of a subfacet's facet.
    pub(crate) fn facet_of(&self, face: [u32; 3]) -> Option<usize> {
        self.subfacets.get(&face_key(face)).map(|&facet| facet as usize)
    }

    /// Whether the edge is a subsegment.
    pub fn is_subsegment(&self, edge: [u32; 2]) -> bool {
        self.subsegments.contains_key(&edge_key(edge))
    }

    /// Whether the face is a subfacet.
    #[inline]
    pub fn is_subfacet(&self, face: [u32; 3]) -> bool {
        self.wall(face).is_some()
    }

    /// The facet of a face that is a subfacet.
    #[inline(always)]
    pub(crate) fn wall(&self, face: [u32; 3]) -> Option<u32> {
        let on_facet = |v: u32| v != GHOST && self.kind(v) & ON_FACET != 0;
        if !face.into_iter().all(on_facet) {
            return None;
        }
        self.subfacets.find(face)
    }

    /// Which faces of a tetrahedron with these vertices may be subfacets: a bit for each slot. Few others are among them.
    #[inline]
    pub(crate) fn possible_walls(&self, v: [u32; 4]) -> u32 {
        self.subfacets.possible_faces(v)
    }

    /// Whether two of these vertices are on the boundary, so that a subsegment or a subfacet may join them. Far from the boundary few tetrahedra have such.
    #[inline]
    pub(crate) fn may_have_edge(&self, v: impl IntoIterator<Item = u32>) -> bool {
        v.into_iter().filter(|&v| self.kind(v) != 0).nth(1).is_some()
    }

    /// Whether nothing but subfacets parts the domain from what is outside it.
    pub(crate) fn closes(&self, t: &Triangulation) -> bool {
        !(self.is_empty() || self.misses() || t.topology.region.is_empty())
    }

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

    /// Room for what comes when the triangulation has that of so many vertices, made in pieces.
    pub(crate) fn grow_for(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        const WHAT: &str = "boundary";
        let (_, vertices) = t.room();
        let more = |len: usize| vertices.saturating_sub(len);
        let (kinds, carriers) = (more(self.kinds.len()), more(self.carriers.len()));
        memory::grow(&mut self.kinds, kinds, WHAT, control)?;
        memory::grow(&mut self.carriers, carriers, WHAT, control)?;
        self.subsegments.grow(vertices, control)?;
        self.subfacets.grow(vertices, control)
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
        let corners = facets.iter().flatten().fold(0, |corners, &v| corners | bit(v));
        for &tet in if found.is_empty() { &[] } else { star } {
            let v = t.topology.tet(tet).v;
            let at = v.iter().position(|&v| v == new).unwrap_or(0);
            let [a, b, c] = [v[at ^ 1], v[at ^ 2], v[at ^ 3]];
            for ([p, q], apex) in [([a, b], c), ([b, c], a), ([c, a], b)] {
                if corners & bit(p) == 0 || corners & bit(q) == 0 {
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

    /// Memory for what one split adds, mostly.
    pub(crate) fn reserve(&mut self) -> Result<(), Error> {
        const MORE: usize = 64;
        let Boundary { kinds, carriers, subsegments, subfacets, pending_segments, pending_facets, .. } = self;
        let reserved = kinds.try_reserve(MORE).and_then(|()| carriers.try_reserve(MORE)).is_ok()
            && subsegments.try_reserve(MORE).is_ok()
            && subfacets.try_reserve(MORE).is_ok()
            && pending_segments.try_reserve(MORE).is_ok()
            && pending_facets.try_reserve(MORE).is_ok();
        if reserved {
            Ok(())
        } else {
            Err(Error::OutOfMemory { what: "boundary" })
        }
    }

    /// The bytes of its lists, about.
    pub(crate) fn bytes(&self) -> usize {
        self.subsegments.bytes()
            + self.subfacets.bytes()
            + self.pending_segments.capacity() * size_of::<([u32; 2], Demand)>()
            + self.pending_facets.capacity() * size_of::<([u32; 3], Demand)>()
            + self.carriers.capacity() * size_of::<Carrier>()
            + self.kinds.capacity()
    }

    /// A copy, unless memory is lacking or the control says stop.
    pub(crate) fn try_clone(&self, control: &Control) -> Result<Boundary, Error> {
        const WHAT: &str = "boundary";
        // A first attempt, because the copy of maps ends the process when it fails.
        drop(memory::with_room::<u8>(self.bytes(), WHAT)?);
        let mut copy = InPieces::new(Boundary::default(), control);
        copy.kinds = memory::copied(&self.kinds, WHAT, control)?;
        copy.carriers = memory::copied(&self.carriers, WHAT, control)?;
        for part in self.segments.chunks(PART) {
            control.check()?;
            copy.segments.extend_from_slice(part);
        }
        copy.facets = memory::with_room(self.facets.len(), WHAT)?;
        for facet in &self.facets {
            control.check()?;
            copy.facets.push(facet.try_clone(control)?);
        }
        copy.subsegments = self.subsegments.try_clone(control)?;
        copy.subfacets = self.subfacets.try_clone(control)?;
        copy.missing_segments = memory::copied_queue(&self.missing_segments, WHAT, control)?;
        copy.missing_facets = memory::copied_queue(&self.missing_facets, WHAT, control)?;
        copy.pending_segments = memory::copied_queue(&self.pending_segments, WHAT, control)?;
        copy.pending_facets = memory::copied_queue(&self.pending_facets, WHAT, control)?;
        copy.blocked = self.blocked.try_clone(control)?;
        copy.sharp_segments = memory::copied(&self.sharp_segments, WHAT, control)?;
        copy.shortest_at = self.shortest_at.try_clone(control)?;
        copy.room_at = self.room_at.try_clone(control)?;
        copy.sharpness = self.sharpness.try_clone(control)?;
        let Boundary { recovering, parts_labels, kept, relaxed, .. } = *self;
        Ok(Boundary { recovering, parts_labels, kept, relaxed, ..copy.keep() })
    }
}

/// What is demanded of the split of an element that a vertex encroaches upon, and that no other split has brought about: to stay within a fraction of it.
fn first_demand(t: &Triangulation, corners: &[u32]) -> Demand {
    let side = |i: usize| t.at(corners[i]).distance(t.at(corners[(i + 1) % corners.len()]));
    let shortest = (0..corners.len()).map(side).fold(f64::INFINITY, f64::min);
    Demand::of(shortest * FIRST_SPLITS).following()
}

/// Segments or facets copied or given back at once.
const PART: usize = 1 << 8;

impl Leavings for Boundary {
    fn give_back(&mut self) -> bool {
        let Boundary { kinds, carriers, segments, facets, subsegments, subfacets, .. } = self;
        if kinds.give_back() || carriers.give_back() || subsegments.give_back() || subfacets.give_back() {
            return true;
        }
        let Boundary { missing_segments, missing_facets, pending_segments, pending_facets, .. } = self;
        if missing_segments.give_back() || missing_facets.give_back() {
            return true;
        }
        if pending_segments.give_back() || pending_facets.give_back() {
            return true;
        }
        let Boundary { blocked, shortest_at, room_at, sharpness, .. } = self;
        if blocked.give_back() || shortest_at.give_back() || room_at.give_back() || sharpness.give_back() {
            return true;
        }
        // A facet may have very many triangles.
        facets.last_mut().is_some_and(FacetTriangulation::give_back)
            || give_elements_back(segments, PART)
            || give_elements_back(facets, PART)
    }
}

impl Triangulation {
    /// The vertices opposite a face, the ghost among them; none when it is no face.
    fn face_apices(&self, face: [u32; 3]) -> impl Iterator<Item = u32> + '_ {
        let apex = |face: u32| self.topology.tet(tet_of(face)).v[slot_of(face)];
        let side = self.find_face(face);
        side.into_iter().flat_map(move |face| [apex(face), apex(self.topology.tet(tet_of(face)).n[slot_of(face)])])
    }
}
