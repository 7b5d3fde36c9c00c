//! Algorithm 2: while a tetrahedron is bad, the boundary rules first, then a Steiner batch for the shortest edge of the bad tetrahedron whose
//! shortest edge is shortest.
//!
//! Deviation: the paper leaves open what happens to a batch of which one sample meets the boundary. Here the samples before it stay,
//! the boundary element is split, and the tetrahedron, if it still exists, comes again.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::queue::{shortest_edge, Queue};
use super::sizing::Sizes;
use super::split::Split;
use super::{RefineOptions, RefineStatus, Unrefined};
use crate::domain::boundary::{Boundary, Encroached};
use crate::domain::pending::Demand;
use crate::domain::plc::PlcRegion;
use crate::geometry::circumsphere::circumcenter;
use crate::geometry::flush_tiny;
use crate::geometry::quality::exceeds_radius_edge;
use crate::sampler::facet::{Arc, VoronoiFacet};
use crate::sampler::{sample_circumcenter, sample_component, Rule, Samples};
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::GHOST;
use crate::triangulation::Triangulation;
use crate::{Control, Error};

/// What became of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placed {
    /// It is a vertex now.
    Inserted(u32),
    /// It would encroach upon boundary elements, which have been queued.
    Encroaches,
    /// It was not inserted, for this reason.
    Refused(Unrefined),
}

/// One refinement under way.
pub struct Refiner<'a> {
    pub(crate) t: &'a mut Triangulation,
    pub(crate) boundary: &'a mut Boundary,
    radius_edge: f64,
    rule: Rule,
    max_vertices: usize,
    pub(super) min_edge: f64,
    pub(super) cavity: Cavity,
    pub(super) encroached: Encroached,
    queue: Queue,
    facet: VoronoiFacet,
    arcs: Vec<Arc>,
    link: Vec<u32>,
    /// Whether bad tetrahedra are looked for yet: not while the boundary is being recovered.
    watching: bool,
    /// Why tetrahedra were left as they are; some of them may have gone since.
    pub reasons: FxHashMap<[u32; 4], Unrefined>,
    /// What is demanded of the splits that the tetrahedron in hand asks for.
    pub demand: Demand,
    /// As reported last: what is left to do may grow, but progress never falls.
    progress: f64,
    /// More elements than this may not go missing.
    recovery_limit: usize,
    /// They did, or could not be recovered.
    pub runs_away: bool,
    /// What is asked for of the size of tetrahedra.
    pub sizes: Option<Sizes<'a>>,
    pub samples: usize,
    pub segment_splits: usize,
    pub facet_splits: usize,
}

/// Turns of the loop between two progress reports.
const REPORT_INTERVAL: usize = 256;

impl<'a> Refiner<'a> {
    pub fn new(t: &'a mut Triangulation, boundary: &'a mut Boundary, options: &RefineOptions) -> Refiner<'a> {
        let (low, high) = t.bounding_box();
        let default = (high - low).length() * (1.0 / (1u64 << 40) as f64);
        boundary.recoveries = 0;
        let recovery_limit = 200 + boundary.subfacet_count() / 16;
        Refiner {
            t,
            boundary,
            radius_edge: options.radius_edge,
            rule: options.rule,
            max_vertices: options.max_vertices,
            min_edge: if options.min_edge > 0.0 { options.min_edge } else { default },
            cavity: Cavity::default(),
            encroached: Encroached::default(),
            queue: Queue::default(),
            facet: VoronoiFacet::default(),
            arcs: Vec::new(),
            link: Vec::new(),
            watching: false,
            reasons: FxHashMap::default(),
            demand: Demand::NONE,
            progress: 0.0,
            recovery_limit,
            runs_away: false,
            sizes: None,
            samples: 0,
            segment_splits: 0,
            facet_splits: 0,
        }
    }

    /// Rules 1 and 2 until nothing is missing or encroached. The status is [`RefineStatus::Done`] unless a limit stopped it.
    pub fn recover(&mut self, control: &Control) -> Result<RefineStatus, Error> {
        let mut turns = 0usize;
        loop {
            if let Some(status) = self.limit(&mut turns, "boundary", control) {
                return Ok(status);
            }
            if !self.boundary_step()? {
                return Ok(RefineStatus::Done);
            }
        }
    }

    /// Recovers what has gone missing after all, and finds the labels of all tetrahedra anew. Returns whether any has changed.
    pub fn restore(&mut self, holes: &[DVec3], regions: &[PlcRegion], control: &Control) -> Result<bool, Error> {
        let (watching, kept) = (self.watching, self.boundary.kept);
        self.boundary.recovering = true;
        self.boundary.kept = false;
        self.boundary.enqueue_all(self.t);
        let limit = std::mem::replace(&mut self.max_vertices, 200 + self.t.vertex_count() * 17 / 16);
        let result = self.recover(control);
        self.max_vertices = limit;
        self.boundary.recovering = false;
        self.boundary.kept = kept;
        self.watching = watching;
        if result? == RefineStatus::VertexLimit {
            self.runs_away = true;
            return Ok(false);
        }
        let before = self.t.topology.region.clone();
        self.boundary.label(self.t, holes, regions);
        let live = self.t.topology.finite();
        Ok(live.into_iter().any(|t| before.get(t as usize) != self.t.topology.region.get(t as usize)))
    }

    /// The whole loop. `again` goes on from an end that came before some tetrahedra were known to be in the domain.
    pub fn refine(&mut self, again: bool, control: &Control) -> Result<RefineStatus, Error> {
        self.watching = true;
        if !again {
            self.boundary.unblock(self.t);
        }
        let all: Vec<u32> = self.t.topology.finite().collect();
        for &t in &all {
            self.watch(t);
        }
        for some in all.chunks(4096) {
            self.watch_size(some);
        }
        let mut turns = 0usize;
        loop {
            if let Some(status) = self.limit(&mut turns, "refine", control) {
                return Ok(status);
            }
            if self.boundary_step()? {
                continue;
            }
            let Some(t) = self.queue.pop(self.t) else { break };
            self.mend(t)?;
        }
        Ok(if self.reasons.is_empty() { RefineStatus::Done } else { RefineStatus::Unrefined })
    }

    fn limit(&mut self, turns: &mut usize, stage: &'static str, control: &Control) -> Option<RefineStatus> {
        let vertices = self.t.vertex_count();
        let open = self.queue.len() + self.boundary.pending_segments.len() + self.boundary.pending_facets.len();
        let go_on = if *turns % REPORT_INTERVAL == 0 {
            self.progress = self.progress.max(vertices as f64 / (vertices + open) as f64);
            control.report(stage, self.progress, vertices)
        } else {
            control.poll()
        };
        *turns += 1;
        if !go_on {
            return Some(RefineStatus::Cancelled);
        }
        if self.boundary.recoveries > self.recovery_limit {
            self.runs_away = true;
            return Some(RefineStatus::Unrefined);
        }
        let work_left = open > 0;
        (vertices >= self.max_vertices && work_left).then_some(RefineStatus::VertexLimit)
    }

    /// Splits one boundary element if any waits. Returns false when none does.
    pub fn boundary_step(&mut self) -> Result<bool, Error> {
        if let Some((edge, demand)) = self.boundary.pop_segment() {
            self.split_segment(edge, demand)?;
            return Ok(true);
        }
        if let Some((face, demand)) = self.boundary.pop_facet() {
            let split = self.split_facet(face, demand)?;
            debug_assert!(split != Split::Deferred || !self.boundary.pending_segments.is_empty());
            return Ok(true);
        }
        Ok(false)
    }

    /// One step for a bad tetrahedron: samples its shortest edge.
    fn mend(&mut self, tet: u32) -> Result<(), Error> {
        let v = self.t.topology.tet(tet).v;
        let ([i, j], shortest) = shortest_edge(self.t, tet);
        let bad = self.sizes.is_none() || exceeds_radius_edge(self.t.corners(tet), self.radius_edge);
        if bad && self.boundary.is_seditious(self.t, [v[i], v[j]]) {
            self.refuse(v, Unrefined::SmallAngle);
            return Ok(());
        }
        // What a split can keep to where input angles are not small, less a little for rounding.
        self.demand = Demand::of(0.499 * self.radius_edge * shortest.sqrt());
        if !bad {
            let corners = self.t.corners(tet);
            let [a, b, c, d] = corners;
            self.demand = Demand::of(0.125 * circumcenter(a, b, c, d).distance(a));
        }
        let samples = if bad { self.sample(tet, [i, j]) } else { sample_circumcenter(self.t.corners(tet)) };
        let mut placed_any = false;
        let mut reason = Unrefined::Rounding;
        for &p in &samples.points {
            if self.t.vertex_count() >= self.max_vertices {
                break;
            }
            match self.place(p, tet)? {
                Placed::Inserted(_) => {
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
                self.queue.push(self.t, tet);
            } else {
                self.refuse(v, reason);
            }
        }
        Ok(())
    }

    /// Leaves a tetrahedron as it is.
    fn refuse(&mut self, v: [u32; 4], reason: Unrefined) {
        self.reasons.insert(v, reason);
    }

    /// The samples for a bad tetrahedron.
    fn sample(&mut self, tet: u32, [i, j]: [usize; 2]) -> Samples {
        if self.rule != Rule::Circumcenter {
            let closed = self.boundary.sector(self.t, tet, i, j, &mut self.link);
            let v = self.t.topology.tet(tet).v;
            let (p, q) = (self.t.at(v[i]), self.t.at(v[j]));
            let t = &*self.t;
            self.facet.set(p, q, self.link.iter().map(|&r| t.at(r)), closed);
            if let Some(samples) = sample_component(&self.facet, &mut self.arcs, self.radius_edge, self.rule) {
                return samples;
            }
        }
        sample_circumcenter(self.t.corners(tet))
    }

    /// Rule 3: inserts a sample unless it would encroach upon the boundary. `near` is a tetrahedron to look for it from.
    pub fn place(&mut self, p: DVec3, near: u32) -> Result<Placed, Error> {
        let p = flush_tiny(p);
        let start = if self.t.topology.tet(near).is_live() { near } else { self.t.recent() };
        if crate::geometry::check_range(0, p).is_err() || self.t.prepare(p, start, &mut self.cavity).is_err() {
            self.cavity.clear();
            return Ok(Placed::Refused(Unrefined::Rounding));
        }
        self.boundary.encroached_by(self.t, p, &self.cavity, &mut self.encroached);
        // A boundary that is kept is no worse for points in the balls of its elements, as long as these stay.
        let harmless = self.boundary.kept && !self.boundary.loses(self.t, &self.cavity, &self.encroached);
        if !self.encroached.is_empty() && !harmless {
            self.cavity.clear();
            if self.boundary.kept {
                return Ok(Placed::Refused(Unrefined::Boundary));
            }
            let demand = self.demand;
            self.boundary.drop_blocked(&mut self.encroached, demand);
            if !self.encroached.segments.is_empty() {
                self.encroached.facets.clear();
            }
            if self.rule == Rule::Sparse {
                self.boundary.keep_nearest(self.t, p, &mut self.encroached);
            }
            self.boundary.enqueue(&self.encroached, demand);
            let waits = !(self.encroached.segments.is_empty() && self.encroached.facets.is_empty());
            return Ok(if waits { Placed::Encroaches } else { Placed::Refused(Unrefined::Boundary) });
        }
        // A point outside encroaches upon the boundary unless that can't be split any more.
        let leaves = !self.boundary.is_empty() && self.cavity.tets.iter().any(|&t| !self.t.is_inside(t));
        if leaves || self.rim_distance(p) < self.min_edge.max(self.demand.length) {
            self.cavity.clear();
            return Ok(Placed::Refused(if leaves { Unrefined::Boundary } else { Unrefined::MinEdge }));
        }
        let new = self.insert_prepared(p)?;
        self.finish();
        Ok(Placed::Inserted(new))
    }

    pub(super) fn insert_prepared(&mut self, p: DVec3) -> Result<u32, Error> {
        let new = self.t.insert_into(p, &mut self.cavity)?;
        // The id may have been that of a vertex on the boundary, now removed.
        self.boundary.unmark(new);
        Ok(new)
    }

    /// Looks at the tetrahedra that the last insertion created.
    pub(super) fn finish(&mut self) {
        if let (Some(sizes), Some(&first)) = (&mut self.sizes, self.cavity.created.first()) {
            // The vertex that all of them have is the one just inserted.
            let of = |c: u32| self.t.topology.tet(c).v;
            let all = |v: &u32| self.cavity.created.iter().all(|&c| of(c).contains(v));
            let Some(new) = of(first).into_iter().find(|v| *v != GHOST && all(v)) else { return };
            let around: Vec<u32> = self.cavity.created.iter().flat_map(|&c| self.t.topology.tet(c).v).collect();
            sizes.add_vertex(self.t, new, around.into_iter().filter(|&v| v != new && v != GHOST));
            if self.watching {
                let created = std::mem::take(&mut self.cavity.created);
                self.watch_size(&created);
                self.cavity.created = created;
            }
        }
        if self.watching {
            for i in 0..self.cavity.created.len() {
                self.watch(self.cavity.created[i]);
            }
        }
    }

    /// Queues those of some tetrahedra that are in the domain and too large.
    fn watch_size(&mut self, some: &[u32]) {
        let Some(sizes) = &mut self.sizes else { return };
        let inside: Vec<u32> = some.iter().copied().filter(|&t| self.t.is_inside(t)).collect();
        for t in sizes.too_large(self.t, &inside) {
            // A bad one is queued as such.
            if !exceeds_radius_edge(self.t.corners(t), self.radius_edge) {
                self.queue.push(self.t, t);
            }
        }
    }

    /// Queues a tetrahedron that is in the domain and bad.
    fn watch(&mut self, t: u32) {
        if self.t.is_inside(t) && exceeds_radius_edge(self.t.corners(t), self.radius_edge) {
            self.queue.push(self.t, t);
        }
    }
}
