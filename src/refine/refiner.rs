//! Algorithm 2: while a tetrahedron is bad, the boundary rules first, then a Steiner batch for the shortest edge of the bad tetrahedron whose
//! shortest edge is shortest.
//!
//! Deviation: the paper leaves open what happens to a batch of which one sample meets the boundary. Here the samples before it stay,
//! the boundary element is split, and the tetrahedron, if it still exists, comes again.

use glam::DVec3;

use super::queue::{shortest_edge, Queue};
use super::split::Split;
use super::{RefineOptions, RefineStatus};
use crate::domain::boundary::{Boundary, Encroached};
use crate::geometry::flush_tiny;
use crate::geometry::quality::four_exceed_radius_edge;
use crate::sampler::facet::{Arc, VoronoiFacet};
use crate::sampler::{sample_circumcenter, sample_component, sample_first, Rule, Samples};
use crate::sparsify::Sparsifier;
use crate::triangulation::cavity::Cavity;
use crate::triangulation::Triangulation;
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
    /// It would make an edge shorter than the limit, or encroaches upon elements that can't be split.
    Refused,
}

/// One refinement under way.
pub struct Refiner<'a> {
    pub(super) t: &'a mut Triangulation,
    pub(super) boundary: &'a mut Boundary,
    radius_edge: f64,
    rule: Rule,
    max_vertices: usize,
    pub min_edge: f64,
    /// Tries to do with fewer samples, if that is wanted.
    pub sparsifier: Option<Sparsifier>,
    /// The length of the edge being mended, which the sparsifier wants to know.
    edge: f64,
    created: Vec<u32>,
    pub(super) cavity: Cavity,
    pub(super) encroached: Encroached,
    queue: Queue,
    facet: VoronoiFacet,
    arcs: Vec<Arc>,
    link: Vec<u32>,
    /// Whether bad tetrahedra are looked for yet: not while the boundary is being recovered.
    watching: bool,
    refused: bool,
    /// As reported last: what is left to do may grow, but progress never falls.
    progress: f64,
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
        Refiner {
            t,
            boundary,
            radius_edge: options.radius_edge,
            rule: options.rule,
            max_vertices: options.max_vertices,
            min_edge: if options.min_edge > 0.0 { options.min_edge } else { default },
            sparsifier: None,
            edge: 0.0,
            created: Vec::new(),
            cavity: Cavity::default(),
            encroached: Encroached::default(),
            queue: Queue::default(),
            facet: VoronoiFacet::default(),
            arcs: Vec::new(),
            link: Vec::new(),
            watching: false,
            refused: false,
            progress: 0.0,
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

    /// The whole loop.
    pub fn refine(&mut self, control: &Control) -> Result<RefineStatus, Error> {
        self.watching = true;
        self.boundary.unblock(self.t);
        if self.rule == Rule::Sparse {
            self.boundary.be_tolerant(self.t);
        } else if std::mem::take(&mut self.boundary.relaxed) {
            self.boundary.enqueue_all(self.t);
        }
        let result = self.work(control);
        if self.boundary.tolerant {
            (self.boundary.tolerant, self.boundary.relaxed) = (false, true);
        }
        result
    }

    /// The loop of [`refine`](Self::refine).
    fn work(&mut self, control: &Control) -> Result<RefineStatus, Error> {
        watch(self.t, &mut self.queue, self.radius_edge, self.t.topology.finite());
        let mut turns = 0usize;
        loop {
            if let Some(status) = self.limit(&mut turns, "refine", control) {
                return Ok(status);
            }
            if self.boundary_step()? {
                continue;
            }
            if let Some(t) = self.queue.pop(self.t) {
                self.mend(t)?;
            } else if self.refused && self.boundary.tolerant {
                // What is left may be within reach of the classical rules.
                self.refused = false;
                self.boundary.unblock(self.t);
                self.boundary.be_strict(self.t);
                watch(self.t, &mut self.queue, self.radius_edge, self.t.topology.finite());
            } else {
                break;
            }
        }
        Ok(if self.refused { RefineStatus::Unrefined } else { RefineStatus::Done })
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
        let work_left = open > 0;
        (vertices >= self.max_vertices && work_left).then_some(RefineStatus::VertexLimit)
    }

    /// Splits one boundary element if any waits. Returns false when none does.
    pub fn boundary_step(&mut self) -> Result<bool, Error> {
        if let Some(edge) = self.boundary.pop_segment() {
            self.split_segment(edge)?;
            return Ok(true);
        }
        if let Some(face) = self.boundary.pop_facet() {
            let split = self.split_facet(face)?;
            debug_assert!(split != Split::Deferred || !self.boundary.pending_segments.is_empty());
            return Ok(true);
        }
        Ok(false)
    }

    /// One step for a bad tetrahedron: samples its shortest edge.
    fn mend(&mut self, tet: u32) -> Result<(), Error> {
        let v = self.t.topology.tet(tet).v;
        let ([i, j], length2) = shortest_edge(self.t, tet);
        if self.boundary.is_seditious(self.t, [v[i], v[j]]) {
            self.refused = true;
            return Ok(());
        }
        let samples = self.sample(tet, [i, j]);
        let mut placed_any = false;
        self.edge = length2.sqrt();
        let corners = self.t.corners(tet);
        for &p in &samples.points {
            if self.t.vertex_count() >= self.max_vertices {
                break;
            }
            match self.place(p, tet, corners.iter().map(|c| c.distance(p)).reduce(f64::min))? {
                Placed::Inserted(_) | Placed::Spared => {
                    self.samples += 1;
                    placed_any = true;
                }
                Placed::Encroaches => {
                    placed_any = true;
                    break;
                }
                Placed::Refused => {}
            }
        }
        if self.t.topology.tet(tet).v == v {
            if placed_any || self.t.vertex_count() >= self.max_vertices {
                self.queue.push(self.t, tet, length2);
            } else {
                self.refused = true;
            }
        }
        Ok(())
    }

    /// Tries to move a vertex instead of inserting the sample that the cavity is of.
    fn spare(&mut self, p: DVec3, clearance: f64) -> Result<bool, Error> {
        let Some(sparsifier) = &mut self.sparsifier else { return Ok(false) };
        self.created.clear();
        let sample = (p, &self.cavity);
        if !sparsifier.instead_of(self.t, self.boundary, sample, clearance, self.edge, &mut self.created)? {
            return Ok(false);
        }
        self.cavity.clear();
        let t = &*self.t;
        let live = self.created.iter().copied().filter(|&tet| t.topology.tet(tet).is_live());
        watch(t, &mut self.queue, self.radius_edge, live);
        Ok(true)
    }

    /// The samples for a bad tetrahedron.
    fn sample(&mut self, tet: u32, [i, j]: [usize; 2]) -> Samples {
        if self.rule != Rule::Circumcenter {
            let closed = self.boundary.sector(self.t, tet, i, j, &mut self.link);
            let v = self.t.topology.tet(tet).v;
            let (p, q) = (self.t.at(v[i]), self.t.at(v[j]));
            let t = &*self.t;
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
        sample_circumcenter(self.t.corners(tet))
    }

    /// Rule 3: inserts a sample unless it would encroach upon the boundary. `near` is a tetrahedron to look for it from, `clearance` the distance
    /// to the nearest vertex: where the sample lies in the Voronoi facet of an edge, that of its ends.
    pub fn place(&mut self, p: DVec3, near: u32, clearance: Option<f64>) -> Result<Placed, Error> {
        let p = flush_tiny(p);
        let start = if self.t.topology.tet(near).is_live() { near } else { self.t.recent() };
        if crate::geometry::check_range(0, p).is_err() || self.t.prepare(p, start, &mut self.cavity).is_err() {
            self.cavity.clear();
            return Ok(Placed::Refused);
        }
        let clearance = clearance.unwrap_or_else(|| self.rim_distance(p));
        if self.boundary.tolerant {
            let cavity = &self.cavity;
            let tets = cavity.tets.iter().copied();
            self.boundary.in_the_way(self.t, (p, clearance), tets, |t| cavity.contains(t), &mut self.encroached);
        } else {
            self.boundary.encroached_by(self.t, p, &self.cavity, &mut self.encroached);
        }
        if !self.encroached.is_empty() {
            self.cavity.clear();
            self.boundary.drop_blocked(&mut self.encroached);
            if !self.encroached.segments.is_empty() {
                self.encroached.facets.clear();
            }
            if self.rule == Rule::Sparse {
                self.boundary.keep_nearest(self.t, p, &mut self.encroached);
            }
            self.boundary.enqueue(&self.encroached);
            return Ok(if self.encroached.is_empty() { Placed::Refused } else { Placed::Encroaches });
        }
        // A point outside encroaches upon the boundary unless that can't be split any more.
        let leaves = !self.boundary.is_empty() && self.cavity.tets.iter().any(|&t| !self.t.is_inside(t));
        if leaves || clearance < self.min_edge {
            self.cavity.clear();
            return Ok(Placed::Refused);
        }
        if self.spare(p, clearance)? {
            return Ok(Placed::Spared);
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
        if self.watching {
            watch(self.t, &mut self.queue, self.radius_edge, self.cavity.created.iter().copied());
        }
    }
}

/// Queues those tetrahedra that are in the domain and bad.
fn watch(t: &Triangulation, queue: &mut Queue, radius_edge: f64, tets: impl Iterator<Item = u32>) {
    let mut inside = tets.filter(|&tet| t.is_inside(tet));
    loop {
        let (mut four, mut count) = ([0; 4], 0);
        for (place, tet) in four.iter_mut().zip(&mut inside) {
            *place = tet;
            count += 1;
        }
        if count == 0 {
            return;
        }
        let last = four[count - 1];
        four[count..].fill(last);
        let corners = four.map(|tet| t.corner_refs(tet));
        let (bad, shortest) = four_exceed_radius_edge(&corners, radius_edge);
        for i in (0..count).filter(|i| bad >> i & 1 != 0) {
            queue.push(t, four[i], shortest[i]);
        }
    }
}
