//! Algorithm 2: while a tetrahedron is bad, the boundary rules first, then a Steiner batch for the shortest edge of the bad tetrahedron whose
//! shortest edge is shortest.
//!
//! Deviations: the paper leaves open what happens to a batch of which one sample meets the boundary. Here the samples before it stay,
//! the boundary element is split, and the tetrahedron, if it still exists, comes again.
//!
//! By rules 1 and 2 a subsegment or subfacet is split as soon as a vertex encroaches upon it. What that is good for is that no sample lies outside
//! the domain, and none takes a boundary element out. But a sample that does either has, in its cavity, a boundary element that would go: between the
//! bad tetrahedron, which is in conflict with it, and the place where it lies there is one. So with the sparse rule and a sparsifier what is
//! encroached stays as it is until it is found so, or until a sample encroaches upon it too. Thin parts, where much is encroached and no
//! tetrahedron bad, then need no vertices: surfaces of mechanical parts get a half to three quarters of the tetrahedra.

use glam::DVec3;

use super::kept::Kept;
use super::limits::Limits;
use super::near_side::NearSide;
use super::obstacle::Obstacles;
use super::queue::{shortest_edge, Queue};
use super::restore::{Element, Record};
use super::sizing::Sizes;
use super::split::Split;
use super::watch::watch;
use super::{RefineOptions, RefineStatus, Unrefined};
use crate::domain::boundary::{edge_key, face_key, Boundary, Encroached};
use crate::domain::pending::Demand;
use crate::geometry::circumsphere::circumcenter;
use crate::geometry::flush_tiny;
use crate::geometry::quality::{exceeds_radius_edge, four_exceed_radius_edge, in_fours};
use crate::parted::PartedMap;
use crate::sampler::facet::{Arc, VoronoiFacet};
use crate::sampler::{sample_circumcenter, sample_component, sample_first, Rule, Samples};
use crate::sparsify::{Sample, Sparsifier};
use crate::triangulation::cavity::Cavity;
use crate::triangulation::remove::Hole;
use crate::triangulation::topology::{EVEN_REST, GHOST};
use crate::triangulation::{Triangulation, Unplaced};
use crate::{Control, Error};

/// What became of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placed {
    /// It is a vertex now.
    Inserted(u32),
    /// A vertex has been moved instead.
    Spared,
    /// It would encroach upon boundary elements, which have been queued.
    Encroaches,
    /// It was not inserted, for this reason.
    Refused(Unrefined),
}

/// One refinement under way.
pub struct Refiner<'a> {
    pub(crate) t: &'a mut Triangulation,
    pub(crate) boundary: &'a mut Boundary,
    pub(super) radius_edge: f64,
    rule: Rule,
    max_vertices: usize,
    pub limits: Limits,
    pub min_edge: f64,
    /// Tries to do with fewer samples, if that is wanted.
    pub sparsifier: Option<Sparsifier>,
    /// The length of the edge being mended, which the sparsifier wants to know.
    edge: f64,
    /// That edge, for the obstacles.
    pub(super) mended: [u32; 2],
    pub(super) created: Vec<u32>,
    pub(super) cavity: Cavity,
    /// The vertices around it and their squared distances from its point, but for those of a very large one.
    pub(super) rim: Vec<(u32, f64)>,
    /// The call's, while it runs.
    pub(super) control: Control,
    pub(super) encroached: Encroached,
    pub(super) queue: Queue,
    facet: VoronoiFacet,
    arcs: Vec<Arc>,
    link: Vec<u32>,
    /// Whether bad tetrahedra are looked for yet: not while the boundary is being recovered.
    pub(super) watching: bool,
    /// A cancellation has left out a part of what was to be queued: the call must end, whatever the control says later.
    pub(super) is_cut_short: bool,
    /// Why tetrahedra were left as they are; some of them may have gone since.
    pub reasons: PartedMap<[u32; 4], Unrefined>,
    /// These are left from the beginning, because a call that was stopped has tried them.
    pub goes_on: bool,
    /// What is demanded of the splits that the tetrahedron in hand asks for.
    pub demand: Demand,
    /// As reported last: what is left to do may grow, but progress never falls.
    progress: f64,
    /// The splits of the transaction under way.
    pub(super) records: Vec<Record>,
    /// What a large transaction goes back to.
    pub(super) kept: Option<Box<Kept>>,
    /// The call's control, while a transaction goes on that none can cancel.
    pub(super) waiting_control: Option<Control>,
    /// Scratch: what opens when one is taken back.
    pub(super) hole: Hole,
    /// Scratch: what has been seen of a sample's own side of the boundary.
    pub(super) near_side: NearSide,
    /// What samples have failed on.
    pub(super) obstacles: Obstacles,
    /// What is asked for of the size of tetrahedra.
    pub sizes: Option<Sizes<'a>>,
    /// Samples may be in the balls of boundary elements, but split none.
    spare_boundary: bool,
    /// The sample that a boundary element is to be split for at once, and its distance from the nearest vertex, if places beside the element's centre
    /// are to be tried.
    pub(super) given_way: Option<(DVec3, f64)>,
    /// The point whose cavity that is and what it encroaches upon, and its distance from the nearest vertex, if a place to split a subfacet at has just been looked
    /// at.
    pub(super) ready: Option<(DVec3, f64)>,
    pub samples: usize,
    pub segment_splits: usize,
    pub facet_splits: usize,
}

/// So many vertices around a sample are looked through for partners: of a larger star nothing could be made.
pub(super) const MANY: usize = 1024;
/// Turns of the loop between two progress reports.
const REPORT_INTERVAL: usize = 256;

impl<'a> Refiner<'a> {
    pub fn new(t: &'a mut Triangulation, boundary: &'a mut Boundary, options: &RefineOptions) -> Refiner<'a> {
        let default = t.least_edge();
        Refiner {
            t,
            boundary,
            radius_edge: options.radius_edge,
            rule: options.rule,
            max_vertices: options.max_vertices,
            limits: Limits::new(options),
            min_edge: if options.min_edge > 0.0 { options.min_edge } else { default },
            sparsifier: None,
            edge: 0.0,
            mended: [GHOST; 2],
            created: Vec::new(),
            cavity: Cavity::default(),
            rim: Vec::new(),
            control: Control::never().clone(),
            encroached: Encroached::default(),
            queue: Queue::default(),
            facet: VoronoiFacet::default(),
            arcs: Vec::new(),
            link: Vec::new(),
            watching: false,
            is_cut_short: false,
            reasons: PartedMap::default(),
            goes_on: false,
            demand: Demand::NONE,
            progress: 0.0,
            records: Vec::new(),
            kept: None,
            waiting_control: None,
            hole: Hole::default(),
            near_side: NearSide::default(),
            obstacles: Obstacles::default(),
            sizes: None,
            spare_boundary: false,
            given_way: None,
            ready: None,
            samples: 0,
            segment_splits: 0,
            facet_splits: 0,
        }
    }

    /// The whole loop.
    pub fn refine(&mut self, control: &Control) -> Result<RefineStatus, Error> {
        self.boundary.lazy = self.rule == Rule::Sparse && self.sparsifier.is_some();
        let status = self.refine_all(control);
        self.boundary.lazy = false;
        status
    }

    fn refine_all(&mut self, control: &Control) -> Result<RefineStatus, Error> {
        self.watching = true;
        self.control = control.clone();
        match self.begin(control) {
            Err(Error::Cancelled) => return Ok(RefineStatus::Cancelled),
            other => other?,
        }
        let mut turns = 0usize;
        loop {
            if let Some(status) = self.limit(&mut turns, "refine", control)? {
                return Ok(status);
            }
            match self.turn(control) {
                Ok(true) => {}
                Ok(false) => break,
                Err(Error::Cancelled) => return Ok(RefineStatus::Cancelled),
                Err(error) => return Err(error),
            }
        }
        Ok(if self.reasons.is_empty() { RefineStatus::Done } else { RefineStatus::Unrefined })
    }

    /// Splits a boundary element or, when none waits, mends a tetrahedron. False when there is nothing to do.
    fn turn(&mut self, control: &Control) -> Result<bool, Error> {
        if self.boundary_step(control)? {
            return Ok(true);
        }
        while let Some(t) = self.next_bad(control)? {
            if !self.goes_on || !self.reasons.contains_key(&self.t.topology.tet(t).v) {
                self.mend(t)?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Whether something stops the loop before its next turn. Makes room for that turn.
    pub(super) fn limit(
        &mut self,
        turns: &mut usize,
        stage: &'static str,
        control: &Control,
    ) -> Result<Option<RefineStatus>, Error> {
        let vertices = self.t.vertex_count();
        let boundary = &*self.boundary;
        let waiting = boundary.pending_segments.len() + boundary.pending_facets.len();
        let missing = boundary.missing_segments.len() + boundary.missing_facets.len();
        let open = self.queue.len() + waiting + missing;
        let go_on = if *turns % REPORT_INTERVAL == 0 {
            self.progress = self.progress.max(vertices as f64 / (vertices + open) as f64);
            control.report(stage, self.progress, vertices)
        } else {
            control.poll()
        };
        *turns += 1;
        if !go_on || self.is_cut_short {
            return Ok(Some(RefineStatus::Cancelled));
        }
        if open == 0 {
            return Ok(None);
        }
        if vertices >= self.max_vertices {
            return Ok(Some(RefineStatus::VertexLimit));
        }
        let Refiner { limits, t, boundary, queue, cavity, sizes, .. } = self;
        let of_sizes = || sizes.as_ref().map_or(0, Sizes::bytes);
        let reached = limits.reached(|| t.bytes() + queue.bytes() + boundary.bytes() + cavity.bytes() + of_sizes());
        if reached.is_none() && self.t.lacks_room_ahead() {
            match self.make_room_ahead(control) {
                Err(Error::Cancelled) => return Ok(Some(RefineStatus::Cancelled)),
                other => other?,
            }
        }
        Ok(reached)
    }

    /// Room for some turns, in pieces.
    fn make_room_ahead(&mut self, control: &Control) -> Result<(), Error> {
        self.t.make_room_ahead(control)?;
        self.cavity.grow_for(self.t, control)?;
        if !self.boundary.is_empty() {
            self.boundary.grow_for(self.t, control)?;
        }
        self.hole.grow_for(self.t, control)?;
        self.sparsifier.as_mut().map_or(Ok(()), |sparsifier| sparsifier.grow_for(self.t, control))
    }

    /// Queues all that there is to do.
    fn begin(&mut self, control: &Control) -> Result<(), Error> {
        /// Places that are looked at between two looks at the control, which may take exact arithmetic.
        const PART: usize = 1 << 8;
        /// Places whose tetrahedra's sizes are asked for at once.
        const BLOCK: usize = 1 << 12;
        self.cavity.reserve(self.t.topology.tets.capacity(), self.t.vertex_slots() + 1, control)?;
        self.hole.grow_for(self.t, control)?;
        if let Some(sparsifier) = &mut self.sparsifier {
            sparsifier.grow_for(self.t, control)?;
        }
        if self.boundary.lazy {
            self.boundary.forget_waiting();
        } else {
            self.boundary.unblock(self.t, control)?;
            if self.boundary.relaxed {
                self.boundary.enqueue_all(self.t, control)?;
                self.boundary.relaxed = false;
            }
        }
        let end = self.t.topology.tets.len();
        for first in (0..end).step_by(PART) {
            control.check()?;
            let t = &*self.t;
            let finite = |&tet: &u32| t.topology.tet(tet).is_live() && !t.topology.tet(tet).is_ghost();
            watch(t, &mut self.queue, self.radius_edge, (first as u32..end.min(first + PART) as u32).filter(finite))?;
        }
        if self.sizes.is_none() {
            return Ok(());
        }
        let mut some = Vec::with_capacity(BLOCK);
        for first in (0..end).step_by(BLOCK) {
            control.check()?;
            let t = &*self.t;
            let finite = |&tet: &u32| t.topology.tet(tet).is_live() && !t.topology.tet(tet).is_ghost();
            some.clear();
            some.extend((first as u32..end.min(first + BLOCK) as u32).filter(finite));
            self.watch_size(&some)?;
        }
        Ok(())
    }

    /// Gives its memory back.
    pub fn give_back_to(&mut self, control: &Control) {
        self.forget_records(0);
        control.give_back(std::mem::take(&mut self.queue));
        control.give_back(std::mem::take(&mut self.cavity));
        control.give_back(std::mem::take(&mut self.hole));
    }

    /// Splits one boundary element if any waits. Returns false when none does.
    fn boundary_step(&mut self, control: &Control) -> Result<bool, Error> {
        let go_on = || control.poll();
        if let Some((edge, demand)) = self.boundary.pop_segment(&go_on)? {
            let split = self.transact(Element::Segment(edge), demand)?;
            self.merge_split(split, &edge.map(|v| self.t.at(v)))?;
            return Ok(true);
        }
        let Some((face, demand)) = self.boundary.pop_facet(&go_on)? else { return Ok(false) };
        let split = self.split_facet_in_turn(face, demand)?;
        self.merge_split(split, &face.map(|v| self.t.at(v)))?;
        Ok(true)
    }

    /// Splits a subfacet, or queues what must be split before it.
    pub fn split_facet_in_turn(&mut self, face: [u32; 3], demand: Demand) -> Result<Split, Error> {
        let split = self.transact(Element::Facet(face), demand)?;
        if let Split::After(segments) = &split {
            for &edge in segments {
                let asked = Element::Segment(edge).asked(self.t, self.boundary, demand);
                self.boundary.pending_segments.extend(asked.map(|demand| (edge, demand)));
            }
            self.boundary.pending_facets.push_front((face_key(face), demand));
        }
        Ok(split)
    }

    /// The tetrahedron to be mended next.
    fn next_bad(&mut self, control: &Control) -> Result<Option<u32>, Error> {
        let Refiner { t, queue, sizes, radius_edge, .. } = self;
        let t = &**t;
        queue.pop(t, control, |places, out| {
            let live = |&tet: &u32| t.topology.tet(tet).is_live() && t.is_inside(tet);
            let mut fine = Vec::new();
            for (four, count) in in_fours(places.iter().copied().filter(live)) {
                let (bad, shortest) = four_exceed_radius_edge(&four.map(|tet| t.corner_refs(tet)), *radius_edge);
                for i in 0..count {
                    if bad >> i & 1 != 0 {
                        out.push((four[i], shortest[i]));
                    } else if sizes.is_some() {
                        fine.push(four[i]);
                    }
                }
            }
            if let Some(sizes) = sizes {
                out.extend(sizes.too_large(t, &fine).into_iter().map(|tet| (tet, shortest_edge(t, tet).1)));
            }
        })
    }

    /// One step for a bad tetrahedron: samples its shortest edge.
    fn mend(&mut self, tet: u32) -> Result<(), Error> {
        let v = self.t.topology.tet(tet).v;
        let ([i, j], length2) = shortest_edge(self.t, tet);
        let bad = self.sizes.is_none() || exceeds_radius_edge(self.t.corners(tet), self.radius_edge);
        // Splits of the boundary would lead to such an edge again, only smaller.
        let seditious = bad && self.boundary.is_seditious(self.t, [v[i], v[j]]);
        self.spare_boundary = seditious;
        // What a split can keep to where input angles are not small, less a little for rounding.
        self.demand = Demand::of(0.499 * self.radius_edge * length2.sqrt());
        if !bad {
            let corners = self.t.corners(tet);
            let [a, b, c, d] = corners;
            self.demand = Demand::of(0.125 * circumcenter(a, b, c, d).distance(a));
        }
        self.given_way = None;
        let samples = if bad { self.sample(tet, [i, j]) } else { sample_circumcenter(self.t.corners(tet)) };
        let mut placed_any = false;
        self.edge = length2.sqrt();
        self.mended = edge_key([v[i], v[j]]);
        let mut reason = Unrefined::Rounding;
        for &p in &samples.points {
            if self.t.vertex_count() >= self.max_vertices {
                break;
            }
            match self.place(p, tet)? {
                Placed::Inserted(v) => {
                    self.samples += 1;
                    placed_any = true;
                    if self.has_partner_on_boundary(v) {
                        self.merge(v, None)?;
                    }
                }
                Placed::Spared => {
                    self.samples += 1;
                    placed_any = true;
                }
                Placed::Encroaches => {
                    placed_any = true;
                    break;
                }
                Placed::Refused(why) => reason = why,
            }
        }
        if self.t.topology.tet(tet).v == v {
            if placed_any || self.t.vertex_count() >= self.max_vertices {
                self.queue.push(self.t, tet, length2)?;
            } else {
                self.refuse(v, if seditious { Unrefined::SmallAngle } else { reason });
            }
        }
        Ok(())
    }

    /// Tries to move a vertex instead of inserting the sample that the cavity is of.
    fn spare(&mut self, p: DVec3, clearance: f64) -> Result<bool, Error> {
        let Some(sparsifier) = &mut self.sparsifier else { return Ok(false) };
        self.created.clear();
        let sample = Sample { p, cavity: &self.cavity, rim: &self.rim, clearance };
        if !sparsifier.instead_of(self.t, self.boundary, sample, self.edge, &mut self.created)? {
            return Ok(false);
        }
        self.cavity.clear();
        self.watch_created()?;
        Ok(true)
    }

    /// Whether there are partners on the boundary for the vertex that the last insertion has brought.
    fn has_partner_on_boundary(&self, v: u32) -> bool {
        let (Some(sparsifier), boundary) = (&self.sparsifier, &*self.boundary) else { return false };
        let may_merge = |w: u32| boundary.kind(w) != 0 && sparsifier.may_merge(self.t, boundary, [v, w], self.edge);
        self.rim.len() < MANY && self.rim.iter().any(|&(w, _)| may_merge(w))
    }

    /// Tries to make one vertex of that which a split of an element with these corners has brought, and a neighbour.
    fn merge_split(&mut self, split: Split, corners: &[DVec3]) -> Result<(), Error> {
        match split {
            Split::Done(v) => self.merge(v, Some(corners)),
            Split::After(_) | Split::Blocked => Ok(()),
        }
    }

    /// Tries to make one vertex of a new one and a neighbour, on the boundary one of them or both.
    fn merge(&mut self, v: u32, split: Option<&[DVec3]>) -> Result<(), Error> {
        let Some(sparsifier) = &mut self.sparsifier else { return Ok(()) };
        self.created.clear();
        if self.boundary.lazy && sparsifier.merge(self.t, self.boundary, (v, split), self.edge, &mut self.created)? {
            self.watch_created()?;
        }
        Ok(())
    }

    /// Leaves a tetrahedron as it is.
    fn refuse(&mut self, v: [u32; 4], reason: Unrefined) {
        self.reasons.insert(v, reason);
    }

    /// The samples for a bad tetrahedron.
    pub(super) fn sample(&mut self, tet: u32, [i, j]: [usize; 2]) -> Samples {
        // Rounding must not depend on how a tetrahedron is stored: lower vertices first.
        let v = self.t.topology.tet(tet).v;
        let edge = edge_key([v[i], v[j]]);
        if self.rule != Rule::Circumcenter {
            let closed = self.boundary.sector(self.t, tet, i, j, &mut self.link);
            let t = &*self.t;
            let [p, q] = edge.map(|v| t.at(v));
            self.facet.set(p, q, self.link.iter().map(|&r| t.at(r)), closed);
            let samples = if self.rule == Rule::Sparse && self.sparsifier.is_some() {
                sample_first(&self.facet, &mut self.arcs, self.radius_edge)
            } else {
                sample_component(&self.facet, &mut self.arcs, self.radius_edge, self.rule)
            };
            if let Some(samples) = samples {
                return samples;
            }
        }
        let [k, l] = EVEN_REST[i][j];
        let rest = edge_key([v[k], v[l]]);
        sample_circumcenter([edge[0], edge[1], rest[0], rest[1]].map(|v| self.t.at(v)))
    }

    /// Rule 3: inserts a sample unless it would encroach upon the boundary. `near` is a tetrahedron to look for it from.
    pub fn place(&mut self, p: DVec3, near: u32) -> Result<Placed, Error> {
        let p = flush_tiny(p);
        let start = if self.t.topology.tet(near).is_live() { near } else { self.t.recent() };
        if crate::geometry::check_range(0, p).is_err() {
            return Ok(Placed::Refused(Unrefined::Rounding));
        }
        // What can be split as demanded is not in the way.
        let demand = (!(self.boundary.kept || self.spare_boundary)).then_some(self.demand);
        let corners = self.t.topology.tet(start).v;
        if self.obstacles.stop((self.t, self.boundary), self.mended, (start, corners), p, demand) {
            return Ok(Placed::Refused(Unrefined::Boundary));
        }
        if let Some(demand) = demand.filter(|_| self.boundary.lazy) {
            if let Some(placed) = self.meets_wall(p, start, demand) {
                return Ok(placed);
            }
        }
        if self.is_refused(p, start)? {
            return Ok(Placed::Refused(Unrefined::Rounding));
        }
        self.find_encroached(p)?;
        let clearance = self.rim_distance(p)?;
        if !self.encroached.is_empty() {
            let stays =
                |element: &Element| demand.is_none_or(|demand| element.asked(self.t, self.boundary, demand).is_none());
            let segments = self.encroached.taken_segments().map(Element::Segment);
            let obstacle = segments.chain(self.encroached.taken_facets().map(Element::Facet)).find(stays);
            // Whatever else were split, the sample could not be inserted.
            if let Some(obstacle) = obstacle {
                self.obstacles.note(self.t, self.mended, corners, obstacle);
                self.cavity.clear();
                return Ok(Placed::Refused(Unrefined::Boundary));
            }
            if let Some(demand) = demand {
                // What is taken out can be split, or it would have been an obstacle.
                let Encroached { segments, facets, lost_segments, lost_facets, .. } = &mut self.encroached;
                segments.append(lost_segments);
                facets.append(lost_facets);
                if self.give_way(p, clearance, demand)? {
                    self.cavity.clear();
                    return Ok(Placed::Encroaches);
                }
            }
            // None of them can be split, none is taken out. The boundary is no worse for a point in the balls of its elements.
        }
        // A point outside would take the boundary out, or encroach upon it, unless that can't be split any more.
        // No subfacet goes with the cavity, so it lies on one side of the boundary.
        let leaves = !self.boundary.is_empty() && self.cavity.tets.first().is_some_and(|&t| !self.t.is_inside(t));
        if leaves || clearance < self.min_edge.max(self.demand.length) {
            self.cavity.clear();
            return Ok(Placed::Refused(if leaves { Unrefined::Boundary } else { Unrefined::MinEdge }));
        }
        if self.spare(p, clearance)? {
            return Ok(Placed::Spared);
        }
        let new = self.insert_prepared(p)?;
        self.finish(new)?;
        Ok(Placed::Inserted(new))
    }

    /// Queues of what the sample `p` encroaches upon that which can be split as demanded, subsegments before subfacets and with the sparse rule only the
    /// nearest. False when nothing can be. `room` is the sample's distance from its nearest vertex.
    pub(super) fn give_way(&mut self, p: DVec3, room: f64, demand: Demand) -> Result<bool, Error> {
        let Refiner { t, boundary, encroached, control, .. } = self;
        let asked = |element: Element| element.asked(t, boundary, demand).is_some();
        encroached.segments.retain(|&s| asked(Element::Segment(s)));
        if encroached.segments.is_empty() {
            boundary.judge_standing(t, p, encroached, control)?;
            encroached.facets.retain(|&f| asked(Element::Facet(f)));
        } else {
            encroached.facets.clear();
        }
        if self.rule == Rule::Sparse {
            boundary.keep_nearest(t, p, encroached);
        }
        if encroached.segments.is_empty() && encroached.facets.is_empty() {
            return Ok(false);
        }
        if self.rule == Rule::Sparse && self.sparsifier.is_some() {
            self.given_way = Some((p, room));
        }
        self.ask(demand);
        Ok(true)
    }

    /// Queues what a sample with this demand encroaches upon.
    fn ask(&mut self, demand: Demand) {
        let (t, boundary, found) = (&*self.t, &mut *self.boundary, &self.encroached);
        for &s in &found.segments {
            let asked = Element::Segment(s).asked(t, boundary, demand);
            boundary.pending_segments.extend(asked.map(|demand| (s, demand)));
        }
        for &f in &found.facets {
            let asked = Element::Facet(f).asked(t, boundary, demand);
            boundary.pending_facets.extend(asked.map(|demand| (f, demand)));
        }
    }

    /// Finds the cavity of `p`; whether `p` can't be inserted.
    pub(super) fn is_refused(&mut self, p: DVec3, start: u32) -> Result<bool, Error> {
        let prepared = self.t.prepare(p, start, &mut self.cavity, &self.control);
        if prepared.is_err() {
            self.cavity.clear();
        }
        match prepared {
            Err(Unplaced::Ended(error)) => Err(error),
            refused => Ok(refused.is_err()),
        }
    }

    /// Finds what the point that the cavity was found for encroaches upon; of subfacets only those that would go, where the others are not split for it
    /// or [come later](Self::give_way).
    pub(super) fn find_encroached(&mut self, p: DVec3) -> Result<(), Error> {
        let Refiner { t, boundary, cavity, encroached, control, .. } = self;
        if boundary.lazy {
            boundary.taken_by(t, p, cavity, encroached, control)
        } else {
            boundary.encroached_by(t, p, cavity, encroached, control)
        }
    }

    /// Inserts the point that the cavity was found for: the last step that a control can cancel.
    pub(super) fn insert_prepared(&mut self, p: DVec3) -> Result<u32, Error> {
        let new = self.t.insert_into(p, &mut self.cavity, &self.control)?;
        // The id may have been that of a vertex on the boundary, now removed.
        self.boundary.unmark(new);
        Ok(new)
    }
}
