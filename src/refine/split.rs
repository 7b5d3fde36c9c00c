//! Boundary rules 1 and 2: splitting a subsegment or a subfacet.

use std::collections::VecDeque;

use glam::DVec3;

use super::refiner::{Refiner, MANY};
use super::restore::{Element, Labels};
use crate::domain::boundary::{edge_key, face_keys, Boundary};
use crate::domain::facet::FacetChange;
use crate::domain::outlook::{Coming, Outlook};
use crate::domain::pending::Demand;
use crate::domain::protect::FacetSplit;
use crate::geometry::{check_range, flush_tiny};
use crate::sorting::sort_by;
use crate::triangulation::{Unplaced, LARGE};
use crate::{Control, Error};

/// The reach of a split that no demand allows.
pub(super) const NEVER: f64 = -1.0;

/// What became of a boundary element's split.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Split {
    /// A vertex was inserted, or one that was there already serves.
    Done(u32),
    /// One of these subsegments has to be split first.
    After(Vec<[u32; 2]>),
    /// The split would make an edge shorter than the limit, or its point can't be placed. The element stays as it is.
    Blocked,
}

/// Sorts what comes behind the first so many entries of a queue, of which the rest stays where it is.
fn sort_last<K: Copy + Ord + Send + 'static>(
    queue: &mut VecDeque<(K, Demand)>,
    first: usize,
    control: &Control,
) -> Result<(), Error> {
    let mut last: Vec<_> = queue.drain(first..).collect();
    let sorted = sort_by(&mut last, &control.watch(), |(a, _), (b, _)| a.cmp(b));
    queue.extend(last);
    sorted
}

/// So many boundary elements take as long as the change of a large star: each is looked up by its vertices.
const HEAVY: usize = LARGE / 8;

/// Whether some changes of facets remove and create very many triangles.
fn are_heavy(changes: &[(u32, FacetChange)]) -> bool {
    changes.iter().map(|(_, change)| change.removed.len() + change.created.len()).sum::<usize>() >= HEAVY
}

impl Refiner<'_> {
    /// Rule 1: splits a subsegment near its middle. After an error, that of a cancellation perhaps, it is blocked, and will be tried again by the next call.
    pub(super) fn split_segment(&mut self, edge: [u32; 2], demand: Demand) -> Result<Split, Error> {
        let split = self.split_segment_in_middle(edge, demand);
        if split.is_err() {
            self.block_segment(edge, NEVER);
        }
        split
    }

    fn split_segment_in_middle(&mut self, edge: [u32; 2], demand: Demand) -> Result<Split, Error> {
        self.boundary.reserve()?;
        let p = flush_tiny(self.boundary.split_point(self.t, edge));
        let [a, b] = edge.map(|v| self.t.at(v));
        let found = self.t.find_edge_within(edge[0], edge[1], &self.control)?;
        let start = found.map_or(self.t.topology.vertex_tet[edge[0] as usize], |e| e.0);
        if self.boundary.keeps(found.is_some()) {
            return Ok(self.block_segment(edge, NEVER));
        }
        let blocked = p.distance(a).min(p.distance(b)) < self.min_edge;
        match (blocked, self.t.prepare(p, start, &mut self.cavity, &self.control)) {
            // A vertex that stands just there takes the new one's place, unless it is an end: then the segment is too short to split.
            (false, Err(Unplaced::Occupied(existing))) if !edge.contains(&existing) => {
                self.cavity.clear();
                let p = self.t.at(existing);
                let changes = self.boundary.plan_on_segment(self.t, &self.cavity, edge, existing, p, &self.control)?;
                // Rounding may have put it there for another segment, but no subsegment or subfacet can be one of two.
                let shared = edge.iter().any(|&end| self.boundary.is_subsegment([end, existing]));
                if shared || self.boundary.folds(&changes, &self.control)? {
                    return Ok(self.block_segment(edge, NEVER));
                }
                let star = self.t.star_within(existing, &self.control)?;
                let labels = self.labels_of(&star)?;
                let slot = |tet: u32| self.t.topology.tet(tet).slot(existing);
                let faces: Vec<u32> = star.iter().filter_map(|&tet| Some(4 * tet + slot(tet)? as u32)).collect();
                let coming =
                    Coming { vertex: existing, at: p, edge: Some(edge), changes: &changes, faces: &faces, going: &[] };
                let outlook = self.boundary.foresee(self.t, coming, &self.control)?;
                if star.len() >= LARGE || are_heavy(&changes) {
                    // Labels are looked at all around it.
                    self.keep(true)?;
                }
                let control = self.control_amid();
                let before = self.boundary.split_at((existing, p), Some(edge), &changes, &control)?;
                let pending = self.pending();
                self.boundary.take_in(self.t, &outlook, &star, demand.following());
                self.sort_pending(pending)?;
                self.record((existing, false), before, changes, (labels, outlook));
                Ok(Split::Done(existing))
            }
            (_, Err(Unplaced::Ended(error))) => Err(error),
            (false, Ok(())) => {
                self.find_encroached(p)?;
                let room = self.rim_distance(p)?;
                if room < self.min_edge && !self.boundary.recovering {
                    return Ok(self.block_segment(edge, NEVER));
                }
                if let Some(reach) = self.forbidden((p, room), &edge, demand) {
                    return Ok(self.block_segment(edge, reach));
                }
                let next = self.t.next_vertex();
                let changes = self.boundary.plan_on_segment(self.t, &self.cavity, edge, next, p, &self.control)?;
                if self.boundary.folds(&changes, &self.control)? || self.is_doomed(&changes, &edge, demand)? {
                    return Ok(self.block_segment(edge, NEVER));
                }
                let seen = self.foresee((next, p), Some(edge), &changes)?;
                let new = self.insert_prepared(p)?;
                debug_assert_eq!(new, next);
                let before = self.boundary.split_at((new, p), Some(edge), &changes, &self.control_amid())?;
                self.split_done(new, &seen.1, demand.following())?;
                self.segment_splits += 1;
                self.record((new, true), before, changes, seen);
                Ok(Split::Done(new))
            }
            _ => Ok(self.block_segment(edge, NEVER)),
        }
    }

    /// Rule 2: inserts a subfacet's circumcentre, or a better point beside it, unless that encroaches upon a subsegment, which then is queued before it. After
    /// an error it is blocked, as a subsegment is.
    pub(super) fn split_facet(&mut self, face: [u32; 3], demand: Demand) -> Result<Split, Error> {
        let split = self.split_facet_within(face, demand);
        if split.is_err() {
            self.block_facet(face, NEVER);
        }
        split
    }

    fn split_facet_within(&mut self, face: [u32; 3], demand: Demand) -> Result<Split, Error> {
        self.boundary.reserve()?;
        self.ready = None;
        let (p, start_triangle) = match self.boundary.facet_split(self.t, face) {
            // Nothing may be asked about such a point: the predicates don't hold it.
            FacetSplit::At(p, _) if check_range(0, flush_tiny(p)).is_err() => return Ok(self.block_facet(face, NEVER)),
            FacetSplit::At(p, triangle) => (self.facet_off_centre(face, p, demand)?.unwrap_or(flush_tiny(p)), triangle),
            FacetSplit::Segment(edge) => return Ok(self.after(face, vec![edge], demand)),
        };
        let split = self.split_facet_at(face, (p, start_triangle), demand)?;
        if split != Split::Blocked || !self.boundary.recovering {
            return Ok(split);
        }
        self.boundary.blocked.forget_facet(face);
        // What is missing has to be split. Another tetrahedron may stand between the point and what is to be split, because the facet is uneven.
        if let Some(edge) = self.boundary.hides(self.t, start_triangle, p) {
            return Ok(self.after(face, vec![edge], demand));
        }
        let Some((p, spot)) = self.boundary.on_the_spot(self.t, start_triangle, p) else { return Ok(split) };
        self.split_facet_at(face, (flush_tiny(p), spot), demand)
    }

    /// [`split_facet`](Self::split_facet) at `p`, which lies in the circle of `start_triangle` in its facet.
    fn split_facet_at(
        &mut self,
        face: [u32; 3],
        (p, start_triangle): (DVec3, [u32; 3]),
        demand: Demand,
    ) -> Result<Split, Error> {
        // A point beyond a subsegment can't be inserted before that has been split. Its cavity may be huge: better not to look for it.
        let hidden = if self.boundary.recovering { None } else { self.boundary.hides(self.t, start_triangle, p) };
        if let Some(edge) = hidden.filter(|&edge| self.boundary.lazy || !self.can_ask(edge, demand)) {
            return Ok(self.after(face, vec![edge], demand));
        }
        let corners = face.map(|v| self.t.at(v));
        let found = self.t.face_tetrahedron_within(face, &self.control)?;
        let start = found.unwrap_or(self.t.topology.vertex_tet[face[0] as usize]);
        let too_near = corners.iter().any(|c| c.distance(p) < self.min_edge);
        let ready = self.ready.take().filter(|&(at, _)| at == p);
        debug_assert!(ready.is_none() || !self.cavity.tets.is_empty());
        if too_near || self.boundary.keeps(found.is_some()) || ready.is_none() && self.is_refused(p, start)? {
            return Ok(self.block_facet(face, NEVER));
        }
        let room = match ready {
            Some((_, room)) => room,
            None => {
                self.find_encroached(p)?;
                self.rim_distance(p)?
            }
        };
        if room < self.min_edge {
            return Ok(self.block_facet(face, NEVER));
        }
        let segments: Vec<[u32; 2]> =
            self.encroached.segments.iter().chain(&self.encroached.lost_segments).copied().collect();
        if segments.iter().any(|&s| self.can_ask(s, demand)) {
            return Ok(self.after(face, segments, demand));
        }
        // The planar triangulation first: it may refuse the point.
        let new = self.t.next_vertex();
        let planned = self.boundary.plan_on_facet(self.t, &self.cavity, start_triangle, new, p, &self.control)?;
        let Some(change) = planned else {
            return Ok(self.block_facet(face, NEVER));
        };
        let changes = [change];
        if let Some(reach) = self.forbidden((p, room), &face, demand) {
            return Ok(self.block_facet(face, reach));
        }
        if self.boundary.folds(&changes, &self.control)? || self.is_doomed(&changes, &face, demand)? {
            return Ok(self.block_facet(face, NEVER));
        }
        let seen = self.foresee((new, p), None, &changes)?;
        let inserted = self.insert_prepared(p)?;
        debug_assert_eq!(inserted, new);
        let before = self.boundary.split_at((new, p), None, &changes, &self.control_amid())?;
        self.split_done(new, &seen.1, demand.following())?;
        self.facet_splits += 1;
        self.record((new, true), before, changes.into(), seen);
        Ok(Split::Done(new))
    }

    /// What the vertex that the cavity is of takes out, and what it will bring. The last look at all of it that a control can cancel, but for the plan.
    fn foresee(
        &mut self,
        (vertex, at): (u32, DVec3),
        edge: Option<[u32; 2]>,
        changes: &[(u32, FacetChange)],
    ) -> Result<(Labels, Outlook), Error> {
        let going: Vec<[u32; 3]> = self.encroached.taken_facets().collect();
        let coming = Coming { vertex, at, edge, changes, faces: &self.cavity.faces, going: &going };
        let seen = (self.labels_of(&self.cavity.tets)?, self.boundary.foresee(self.t, coming, &self.control)?);
        let is_heavy = are_heavy(changes) || self.encroached.count() >= HEAVY;
        if self.is_large() || is_heavy {
            let own: &[u32] = edge.as_ref().map_or(&[], |edge| edge);
            let follows = seen.1.misses() || seen.1.labels.leak || self.takes_others(changes, own, |_| true)?;
            self.keep(is_heavy || follows)?;
        }
        Ok(seen)
    }

    /// The control where a split can be taken back as a whole, or all is given up; nobody's where half of it would be left.
    fn control_amid(&self) -> Control {
        if self.kept.is_some() || self.boundary.recovering {
            self.control.clone()
        } else {
            Control::never().clone()
        }
    }

    /// What follows when the vertex of a split is there.
    fn split_done(&mut self, new: u32, outlook: &Outlook, demand: Demand) -> Result<(), Error> {
        let pending = self.pending();
        self.boundary.take_in(self.t, outlook, &self.cavity.created, demand);
        let control = self.control_amid();
        self.boundary.enqueue_for(self.t, new, &mut self.encroached, demand, &control)?;
        self.sort_pending(pending)?;
        self.finish(new)
    }

    fn pending(&self) -> [usize; 2] {
        [self.boundary.pending_segments.len(), self.boundary.pending_facets.len()]
    }

    /// What one split has queued, in order of ids instead of storage.
    fn sort_pending(&mut self, [segments, facets]: [usize; 2]) -> Result<(), Error> {
        let control = self.control_amid();
        let Boundary { pending_segments, pending_facets, .. } = &mut *self.boundary;
        if pending_segments.len() > segments + 1 {
            sort_last(pending_segments, segments, &control)?;
        }
        if pending_facets.len() > facets + 1 {
            sort_last(pending_facets, facets, &control)?;
        }
        Ok(())
    }

    /// Whether a split with this demand can have a subsegment split before it.
    pub(super) fn can_ask(&self, edge: [u32; 2], demand: Demand) -> bool {
        Element::Segment(edge).asked(self.t, self.boundary, demand).is_some()
    }

    /// Tells that subsegments must be split before a subfacet, or gives the subfacet up when none of them can be.
    fn after(&mut self, face: [u32; 3], mut segments: Vec<[u32; 2]>, demand: Demand) -> Split {
        segments.retain(|&s| self.can_ask(s, demand));
        if segments.is_empty() {
            return self.block_facet(face, NEVER);
        }
        self.cavity.clear();
        Split::After(segments)
    }

    /// Whether a split of an element at the cavity's point `p`, whose nearest vertex is `reach` away, misses the demand. Then what a demand must come to for it:
    /// the shortest edge that it makes, or [`NEVER`].
    fn forbidden(&self, (p, reach): (DVec3, f64), corners: &[u32], demand: Demand) -> Option<f64> {
        if self.boundary.recovering {
            return None;
        }
        if reach < self.boundary.needle_floor(self.t, self.boundary.carrier_of(corners), p) {
            return Some(NEVER);
        }
        (reach < self.boundary.demanded(demand, corners)).then_some(reach)
    }

    /// Whether the split in hand, which changes facets so, takes out another element whose own split is known to miss the demand. It would have to be
    /// taken back, which costs far more where stars are large.
    fn is_doomed(&self, changes: &[(u32, FacetChange)], corners: &[u32], demand: Demand) -> Result<bool, Error> {
        let after = demand.following();
        if self.boundary.recovering {
            return Ok(false);
        }
        self.takes_others(changes, corners, |other| match other {
            Element::Segment(edge) => !self.boundary.waits_segment(edge, after),
            Element::Facet(face) => !self.boundary.waits_facet(face, after),
        })
    }

    /// Whether the split in hand of the element with these corners, which changes facets so, takes out another element of which that is true.
    fn takes_others(
        &self,
        changes: &[(u32, FacetChange)],
        corners: &[u32],
        is_true: impl Fn(Element) -> bool,
    ) -> Result<bool, Error> {
        let turns = self.control.turns();
        let removed = face_keys(changes.iter().flat_map(|(_, change)| &change.removed), &self.control)?;
        let replaced = |face: [u32; 3]| removed.binary_search(&face).is_ok();
        let mut segments = self.encroached.taken_segments().take_while(|_| turns.go_on());
        let mut facets = self.encroached.taken_facets().take_while(|_| turns.go_on());
        let takes = segments.any(|edge| *corners != edge_key(edge) && is_true(Element::Segment(edge)))
            || facets.any(|face| !replaced(face) && is_true(Element::Facet(face)));
        turns.end().map(|()| takes)
    }

    pub(super) fn block_segment(&mut self, edge: [u32; 2], reach: f64) -> Split {
        self.cavity.clear();
        self.boundary.blocked.block_segment(edge, reach);
        Split::Blocked
    }

    pub(super) fn block_facet(&mut self, face: [u32; 3], reach: f64) -> Split {
        self.cavity.clear();
        self.boundary.blocked.block_facet(face, reach);
        Split::Blocked
    }

    /// The distance from the cavity's point to the nearest vertex. Fills `rim`.
    pub(super) fn rim_distance(&mut self, p: DVec3) -> Result<f64, Error> {
        let Refiner { t, cavity, rim, control, .. } = self;
        let turns = control.turns();
        let mut least = f64::INFINITY;
        rim.clear();
        for v in cavity.rim(&t.topology) {
            turns.check()?;
            let squared = t.at(v).distance_squared(p);
            least = if squared < least { squared } else { least };
            if rim.len() < MANY {
                rim.push((v, squared));
            }
        }
        Ok(least.sqrt())
    }
}
