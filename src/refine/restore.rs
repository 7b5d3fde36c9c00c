//! Recovery: what is missing of the boundary is split until nothing is.
//!
//! That comes before the refinement, which then keeps every subsegment an edge and every subfacet a face, so that no label can leak from one
//! side of a facet to the other. Near small input angles, or where vertices lie in the balls of elements that could not be
//! split, or lazily were not, a split may take other elements out. So each split is a transaction: what it has taken out is recovered at once by
//! further splits, within the same demand, and if that does not succeed in a few of them, all of them are taken back. With the
//! perturbation of the kernel the triangulation of a set of points is unique, so that removing the vertices again leads back to
//! what was there before.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::refiner::Refiner;
use super::split::{Split, NEVER};
use super::watch::watch;
use crate::domain::boundary::{face_keys, Standing};
use crate::domain::facet::FacetChange;
use crate::domain::label::OUTSIDE;
use crate::domain::outlook::{LabelsAhead, Outlook};
use crate::domain::pending::Demand;
use crate::domain::Boundary;
use crate::geometry::predicates::orient3d;
use crate::geometry::{flush_tiny, Sign};
use crate::sorting::sort;
use crate::triangulation::remove::Replacement;
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::{Control, Error, RefineStatus};

/// So many splits may follow from one. Most need none, few more than ten; but where long strips stand around a cylinder, the first one that is cut
/// takes all others out.
const FOLLOWING: usize = 1000;

/// A split, to take it back.
#[derive(Debug)]
pub struct Record {
    vertex: u32,
    /// Whether the vertex was inserted for it.
    inserted: bool,
    before: Standing,
    changes: Vec<(u32, FacetChange)>,
    /// The tetrahedra that went for the vertex, or those at it if it was there, and their labels.
    labels: Labels,
    /// What was seen beforehand of the labels around a vertex that was inserted.
    ahead: LabelsAhead,
}

/// Tetrahedra by their vertices, with their labels, as they were stored: few are ever looked up, after they have been put [in order](labels_in_order).
pub type Labels = Vec<([u32; 4], u16)>;

fn in_order(mut v: [u32; 4]) -> [u32; 4] {
    v.sort_unstable();
    v
}

/// The same with vertices in order, and in order themselves.
fn labels_in_order(labels: &Labels, control: &Control) -> Result<Labels, Error> {
    let mut labels: Labels = labels.iter().map(|&(v, label)| (in_order(v), label)).collect();
    sort(&mut labels, &control.watch())?;
    Ok(labels)
}

/// A boundary element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    Segment([u32; 2]),
    Facet([u32; 3]),
}

impl Element {
    /// With what demand a sample can have it split, if at all: with its own, or, where nothing else splits what a vertex encroaches upon, with that of
    /// such a split.
    pub fn asked(self, t: &Triangulation, boundary: &Boundary, demand: Demand) -> Option<Demand> {
        if self.waits(boundary, demand) {
            return Some(demand);
        }
        if !boundary.lazy {
            return None;
        }
        let encroached = match self {
            Element::Segment(edge) => boundary.demand_of_segment(t, edge),
            Element::Facet(face) => boundary.demand_of_facet(t, face),
        };
        encroached.filter(|&demand| self.waits(boundary, demand))
    }

    /// Whether it exists and its split is not known to miss the demand.
    fn waits(self, boundary: &Boundary, demand: Demand) -> bool {
        match self {
            Element::Segment(edge) => boundary.waits_segment(edge, demand),
            Element::Facet(face) => boundary.waits_facet(face, demand),
        }
    }
}

/// What one step of the recovery did.
enum Step {
    /// Nothing is missing.
    Nothing,
    /// Something was split.
    Split,
    /// Something that is missing can't be split.
    Stuck,
}

impl Refiner<'_> {
    /// Splits until nothing is missing. The status is [`RefineStatus::Done`] unless a limit stopped it; an element that can't be split stays
    /// missing.
    pub fn recover(&mut self, control: &Control) -> Result<RefineStatus, Error> {
        self.boundary.recovering = true;
        self.control = control.clone();
        let (mut turns, mut first) = (0, Vec::new());
        let status = loop {
            if let Some(status) = self.limit(&mut turns, "boundary", control)? {
                break status;
            }
            match self.recovery_step(&mut first, Demand::NONE, &|| control.poll()) {
                Ok(Step::Nothing) => break RefineStatus::Done,
                Ok(Step::Split | Step::Stuck) => {}
                Err(Error::Cancelled) => break RefineStatus::Cancelled,
                Err(error) => return Err(error),
            }
        };
        self.boundary.recovering = false;
        Ok(status)
    }

    /// Splits one element that is missing. `first` are subsegments that must be split before what is missing can be.
    fn recovery_step(
        &mut self,
        first: &mut Vec<[u32; 2]>,
        demand: Demand,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Step, Error> {
        let split = if let Some(edge) = self.boundary.pop_missing_segment(self.t, go_on)? {
            self.split_segment(edge, demand)?
        } else if let Some(edge) = first.pop() {
            if self.boundary.is_subsegment(edge) {
                self.split_segment(edge, demand)?
            } else {
                return Ok(Step::Split);
            }
        } else if let Some(face) = self.boundary.pop_missing_facet(self.t, go_on)? {
            let split = self.split_facet(face, demand)?;
            if let Split::After(segments) = split {
                self.boundary.missing_facets.push_front(face);
                first.extend(segments);
                return Ok(Step::Split);
            }
            split
        } else {
            return Ok(Step::Nothing);
        };
        Ok(if split == Split::Blocked { Step::Stuck } else { Step::Split })
    }

    /// Splits an element; what follows from it is done at once, or all of it is taken back and the element blocked. After an error, that of a cancellation
    /// perhaps, it is taken back, too.
    pub fn transact(&mut self, element: Element, demand: Demand) -> Result<Split, Error> {
        self.forget_records(0);
        let pending = (self.boundary.pending_segments.len(), self.boundary.pending_facets.len());
        let control = self.control.clone();
        let mut split = self.split_whole(element, demand);
        if !matches!(split, Ok(Some(_))) && (self.kept.is_some() || !self.records.is_empty()) {
            // What no copy takes back are small stars.
            self.control = Control::never().clone();
            split = self.take_back().and(split);
            self.boundary.pending_segments.truncate(pending.0);
            self.boundary.pending_facets.truncate(pending.1);
        }
        (self.control, self.waiting_control) = (control, None);
        self.keep_no_more();
        Ok(match (split?, element) {
            (Some(split), _) => split,
            (None, Element::Segment(edge)) => self.block_segment(edge, NEVER),
            (None, Element::Facet(face)) => self.block_facet(face, NEVER),
        })
    }

    /// `None` when all is to be taken back.
    fn split_whole(&mut self, element: Element, demand: Demand) -> Result<Option<Split>, Error> {
        let split = match element {
            Element::Segment(edge) => self.split_segment(edge, demand)?,
            Element::Facet(face) => self.split_facet(face, demand)?,
        };
        if self.kept.is_none() {
            // Half of it would be good for nothing, and what is not kept is done soon.
            self.waiting_control = Some(std::mem::replace(&mut self.control, Control::never().clone()));
        }
        if self.boundary.misses() {
            // What follows may have come to the other side of its facet, as what rounding has put beside one.
            if self.follow(demand.following())? && self.relabel_changed()? {
                return Ok(Some(split));
            }
        } else if !self.leaks()? {
            self.note_labels()?;
            return Ok(Some(split));
        } else if self.relabel_changed()? {
            return Ok(Some(split));
        }
        Ok(None)
    }

    /// The tetrahedra at the vertices of the transaction.
    fn changed_stars(&self) -> Result<Vec<u32>, Error> {
        match &self.records[..] {
            [record] if record.inserted => {
                let created = self.cavity.created.clone();
                debug_assert!(created.iter().all(|&tet| self.t.topology.tet(tet).v.contains(&record.vertex)));
                debug_assert_eq!(created.len(), self.t.topology.star(record.vertex).len());
                Ok(created)
            }
            records => {
                let mut stars = Vec::new();
                for record in records {
                    stars.append(&mut self.t.star_within(record.vertex, &self.control)?);
                }
                Ok(stars)
            }
        }
    }

    /// Finds labels around the vertices of the transaction anew; whether that has mended all.
    fn relabel_changed(&mut self) -> Result<bool, Error> {
        let mut stars = self.changed_stars()?;
        let sound = self.relabel(&mut stars)? && !self.stars_leak(&stars, &self.control)?;
        if sound {
            self.boundary.note_labels(self.t, &stars, &self.control)?;
        }
        Ok(sound)
    }

    /// After a transaction of one split, which leaves nothing missing and no label wrong: notes whether labels show subfacets still.
    fn note_labels(&mut self) -> Result<(), Error> {
        match &self.records[..] {
            [] => {}
            [record] if record.inserted => {
                debug_assert_eq!(record.ahead.parted, self.new_subfacets_part(&self.cavity.created));
                debug_assert!(self.boundary.hides_as_seen(self.t, record.ahead, &self.cavity.created));
                if !record.ahead.parted {
                    self.boundary.note_ahead(record.ahead);
                }
            }
            _ => {
                let stars = self.changed_stars()?;
                self.boundary.note_labels(self.t, &stars, &self.control)?;
            }
        }
        Ok(())
    }

    /// Splits what a split has left missing; whether nothing is missing then.
    fn follow(&mut self, demand: Demand) -> Result<bool, Error> {
        let mut first = Vec::new();
        for _ in 0..FOLLOWING {
            let control = self.control.clone();
            match self.recovery_step(&mut first, demand, &|| control.poll())? {
                Step::Split => {}
                Step::Stuck => return Ok(false),
                Step::Nothing => return Ok(true),
            }
        }
        Ok(false)
    }

    /// Notes a split that was done.
    pub(super) fn record(
        &mut self,
        (vertex, inserted): (u32, bool),
        before: Standing,
        changes: Vec<(u32, FacetChange)>,
        (labels, outlook): (Labels, Outlook),
    ) {
        if !self.boundary.recovering {
            self.records.push(Record { vertex, inserted, before, changes, labels, ahead: outlook.labels });
        }
    }

    /// Forgets the splits of the last transaction, but for the first so many.
    pub(super) fn forget_records(&mut self, first: usize) {
        /// What fewer have taken is given back in no time.
        const MANY: usize = 1 << 16;
        for record in self.records.drain(first..).filter(|record| record.labels.len() > MANY) {
            self.control.give_back(record.labels);
        }
    }

    /// The labels of some tetrahedra, unless the control says stop.
    pub(super) fn labels_of(&self, tets: &[u32]) -> Result<Labels, Error> {
        let topology = &self.t.topology;
        if self.boundary.recovering || topology.region.is_empty() {
            return Ok(Labels::new());
        }
        let (turns, mut labels) = (self.control.turns(), Labels::with_capacity(tets.len()));
        for &tet in tets {
            turns.check()?;
            labels.push((topology.tet(tet).v, topology.region[tet as usize]));
        }
        Ok(labels)
    }

    /// Whether there is a leak after the one split of a transaction, as [`stars_leak`](Self::stars_leak) says.
    fn leaks(&self) -> Result<bool, Error> {
        match &self.records[..] {
            [] => Ok(false),
            [record] if record.inserted => {
                let leaks = record.ahead.leak || self.meant_leak();
                debug_assert_eq!(Ok(leaks), self.stars_leak(&self.cavity.created, Control::never()));
                Ok(leaks)
            }
            _ => self.stars_leak(&self.changed_stars()?, &self.control),
        }
    }

    /// Whether any of these tetrahedra has a neighbour with another label across a face that is no subfacet, or a face that was one until now has.
    fn stars_leak(&self, tets: &[u32], control: &Control) -> Result<bool, Error> {
        let (topology, turns) = (&self.t.topology, control.turns());
        if topology.region.is_empty() {
            return Ok(false);
        }
        let leaks = |&tet: &u32| {
            let differs = |&slot: &usize| topology.labels_differ(tet, slot);
            (0..4).filter(differs).any(|slot| !self.boundary.is_subfacet(topology.tet(tet).face(slot)))
        };
        let leak = tets.iter().take_while(|_| turns.go_on()).any(leaks);
        turns.end().map(|()| leak || self.meant_leak())
    }

    /// Whether faces that were subfacets until now, and may be beside all that has changed, have different labels on their sides.
    fn meant_leak(&self) -> bool {
        let topology = &self.t.topology;
        // The first ones that a split replaces are those that its point was meant for, wherever rounding has put it: they may stay in space, beside the vertex
        // and all that it touches. All others are known to go, or to touch it.
        const MEANT: usize = 2;
        let replaced = self.records.iter().flat_map(|record| &record.changes);
        let mut meant = replaced.flat_map(|(_, change)| change.removed.iter().take(MEANT));
        meant.any(|&face| {
            let parts = |handle: u32| topology.labels_differ(tet_of(handle), slot_of(handle));
            !self.boundary.is_subfacet(face) && self.t.find_face(face).is_some_and(parts)
        })
    }

    /// Whether all new subfacets of a transaction that has inserted one vertex, with this star, have different labels on their sides; where no other face
    /// has.
    fn new_subfacets_part(&self, star: &[u32]) -> bool {
        let [record] = &self.records[..] else { return self.records.is_empty() };
        let topology = &self.t.topology;
        if topology.region.is_empty() || !record.inserted {
            return false;
        }
        let created = record.changes.iter().flat_map(|(_, change)| &change.created);
        let mut created = face_keys(created, Control::never()).unwrap_or_default();
        created.dedup();
        let parting = |&tet: &u32| {
            let v = topology.tet(tet).v;
            (0..4).filter(|&slot| v[slot] != record.vertex && topology.labels_differ(tet, slot)).count()
        };
        // Each is seen from both sides.
        star.iter().map(parting).sum::<usize>() == 2 * created.len()
    }

    /// Takes all splits of the transaction back.
    fn take_back(&mut self) -> Result<(), Error> {
        self.put_back();
        self.boundary.missing_segments.clear();
        self.boundary.missing_facets.clear();
        let mut changed = Vec::new();
        while let Some(record) = self.records.pop() {
            self.boundary.take_back(record.vertex, &record.before, record.changes);
            if !record.inserted {
                let star = self.t.topology.star(record.vertex);
                self.restore_labels(&star, &record.labels)?;
                changed.extend(star);
                continue;
            }
            let boundary = &*self.boundary;
            let is_wall = |face: [u32; 3]| boundary.wall(face).is_some();
            let replacement = Replacement { remove: &[record.vertex], add: None };
            self.t.preview(&replacement, &is_wall, &mut self.hole)?;
            self.t.replace(&mut self.hole)?;
            if record.before.segments.is_empty() {
                self.facet_splits -= 1;
            } else {
                self.segment_splits -= 1;
            }
            // What comes back is what the vertex took out: the triangulation of the others is unique.
            let created = std::mem::take(&mut self.hole.created);
            self.restore_labels(&created, &record.labels)?;
            changed.extend_from_slice(&created);
            self.hole.created = created;
        }
        let t = &*self.t;
        let live = changed.into_iter().filter(|&tet| t.topology.tet(tet).is_live());
        watch(t, &mut self.queue, self.radius_edge, live)
    }

    fn restore_labels(&mut self, tets: &[u32], labels: &Labels) -> Result<(), Error> {
        let labels = labels_in_order(labels, &self.control)?;
        for &tet in tets {
            let v = in_order(self.t.topology.tet(tet).v);
            if let Ok(place) = labels.binary_search_by_key(&v, |known| known.0) {
                self.t.topology.region[tet as usize] = labels[place].1;
            }
        }
        Ok(())
    }

    /// Finds the labels of tetrahedra that have changed anew, and looks at them: while a subfacet was missing, labels may have come from its other
    /// side. All others have the right ones. False, with no label changed, when there is one that can't be found. Each is in the list but once then.
    fn relabel(&mut self, order: &mut Vec<u32>) -> Result<bool, Error> {
        let control = self.control.clone();
        let turns = control.turns();
        let mut changed: FxHashSet<u32> = FxHashSet::default();
        changed.reserve(order.len());
        order.retain(|&tet| turns.go_on() && changed.insert(tet));
        turns.end()?;
        if self.t.topology.region.is_empty() {
            self.watch_changed(order)?;
            return Ok(true);
        }
        let mut labels: FxHashMap<u32, u16> = FxHashMap::default();
        labels.reserve(order.len());
        for &seed in order.iter() {
            turns.check()?;
            if labels.contains_key(&seed) {
                continue;
            }
            // A part that subfacets and tetrahedra that have not changed bound, and the label of one of these.
            let (mut part, mut next, mut label) = (vec![seed], 0, None);
            labels.insert(seed, 0);
            while next < part.len() {
                let tet = *self.t.topology.tet(part[next]);
                next += 1;
                turns.check()?;
                if tet.is_ghost() {
                    label = Some(OUTSIDE);
                }
                let walls = self.boundary.possible_walls(tet.v);
                for slot in 0..4 {
                    let across = tet_of(tet.n[slot]);
                    if labels.contains_key(&across) && changed.contains(&across)
                        || self.boundary.wall_among(walls, slot, tet.face(slot)).is_some()
                    {
                        continue;
                    }
                    if changed.contains(&across) {
                        labels.insert(across, 0);
                        part.push(across);
                    } else {
                        label = label.or(self.t.topology.region.get(across as usize).copied());
                    }
                }
            }
            // None at all, and no ghost: subfacets enclose it, and all of it has changed.
            if label.is_none() {
                label = self.label_before(&part)?;
            }
            let Some(label) = label else { return Ok(false) };
            for tet in part {
                turns.check()?;
                labels.insert(tet, label);
            }
        }
        for tet in order.iter() {
            turns.check()?;
            self.t.topology.region[*tet as usize] = labels[tet];
        }
        self.watch_changed(order)?;
        Ok(true)
    }

    /// The label that there was, before the transaction, where the largest of these tetrahedra is now.
    fn label_before(&self, part: &[u32]) -> Result<Option<u16>, Error> {
        let size = |tet: u32| {
            let [a, b, c, d] = self.t.corners(tet);
            (b - a).cross(c - a).dot(d - a)
        };
        let vertices = |tet: u32| in_order(self.t.topology.tet(tet).v);
        let largest = |&s: &u32, &r: &u32| size(s).total_cmp(&size(r)).then_with(|| vertices(s).cmp(&vertices(r)));
        let Some(tet) = part.iter().copied().max_by(largest) else { return Ok(None) };
        let center = flush_tiny(self.t.corners(tet).into_iter().map(|corner| 0.25 * corner).sum());
        let holds = |v: &[u32; 4]| {
            let corners = v.map(|v| self.t.at(v));
            let side = |[a, b, c, d]: [DVec3; 4]| orient3d(a, b, c, d);
            let inside = side(corners);
            (0..4).all(|i| {
                let mut corners = corners;
                corners[i] = center;
                [inside, Sign::Zero].contains(&side(corners))
            })
        };
        let made_since = |v: &u32| self.records.iter().any(|record| record.inserted && record.vertex == *v);
        let turns = self.control.turns();
        for record in &self.records {
            for (v, label) in labels_in_order(&record.labels, &self.control)? {
                turns.check()?;
                if v[3] != GHOST && !v.iter().any(made_since) && holds(&v) {
                    return Ok(Some(label));
                }
            }
        }
        Ok(None)
    }
}
