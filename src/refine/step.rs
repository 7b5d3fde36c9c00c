//! The refinement one batch at a time: a host asks for the bad short edges, for the batch of one, inserts it, and asks again.

use glam::DVec3;

use super::refiner::{Placed, Refiner};
use super::restore::Element;
use super::split::Split;
use super::{check_radius_edge, RefineOptions};
use crate::domain::boundary::{edge_key, Encroached};
use crate::domain::pending::Demand;
use crate::domain::Boundary;
use crate::geometry::circumsphere::triangle_circumcenter;
use crate::geometry::quality::exceeds_radius_edge;
use crate::geometry::{check_range, flush_tiny};
use crate::sampler::{sample_edge, Rule};
use crate::sorting::sort_unique;
use crate::triangulation::cavity::Cavity;
use crate::{memory, Control, Error, Mesh};

/// Where a Steiner point comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Origin {
    /// The sampling rule.
    Sample,
    /// Rule 1: the split of this subsegment, missing or encroached.
    Segment([u32; 2]),
    /// Rule 2: the split of this subfacet, missing or encroached.
    Subfacet([u32; 3]),
}

/// One Steiner point to insert.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteinerPoint {
    /// Where it goes.
    pub position: DVec3,
    /// What asks for it.
    pub origin: Origin,
}

/// The points that one step of the refinement inserts together.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The edge that they were asked for.
    pub edge: [u32; 2],
    /// The points, in the order of insertion.
    pub points: Vec<SteinerPoint>,
    /// Span angle γ of the component in radians; 0 for boundary splits and circumcentres.
    pub span: f64,
    /// Sampling angle θ in radians; 0 likewise.
    pub theta: f64,
}

/// What a step needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepOptions {
    /// The bound β.
    pub radius_edge: f64,
    /// How Steiner points are chosen.
    pub rule: Rule,
}

impl Default for StepOptions {
    fn default() -> Self {
        let RefineOptions { radius_edge, rule, .. } = RefineOptions::default();
        StepOptions { radius_edge, rule }
    }
}

impl Mesh {
    /// All bad short edges of the domain, shortest first (among equals by vertex ids), lower vertex first. Exact and linear in the size
    /// of the mesh. No tetrahedron is bad when there is none.
    pub fn bad_short_edges(&self, radius_edge: f64) -> Result<Vec<[u32; 2]>, Error> {
        self.bad_short_edges_within(radius_edge, Control::never())
    }

    /// [`bad_short_edges`](Self::bad_short_edges) that a control can cancel: [`Error::Cancelled`].
    pub fn bad_short_edges_within(&self, radius_edge: f64, control: &Control) -> Result<Vec<[u32; 2]>, Error> {
        check_radius_edge(radius_edge)?;
        let mut edges = memory::room_in_pieces::<(u64, [u32; 2])>(0, "bad short edges", control)?;
        let turns = control.turns();
        for t in self.inside() {
            turns.check()?;
            if !exceeds_radius_edge(self.t.corners(t), radius_edge) {
                continue;
            }
            memory::grow_long(&mut edges, 1, "bad short edges", control)?;
            let ([i, j], shortest) = super::queue::shortest_edge(&self.t, t);
            let v = self.t.topology.tet(t).v;
            edges.push((shortest.to_bits(), edge_key([v[i], v[j]])));
        }
        sort_unique(&mut edges, &control.watch())?;
        let mut all = memory::room_in_pieces(edges.len(), "bad short edges", control)?;
        for (_, edge) in edges.iter() {
            turns.check()?;
            all.push(*edge);
        }
        Ok(all.keep())
    }

    /// What the refinement would insert next for an edge. Boundary rules come first: if a subsegment or subfacet waits to be split, or a
    /// sample of the edge would encroach upon some, the batch is their splits. Empty when the edge is not bad, and when nothing can mend it.
    ///
    /// Without a domain nothing bounds the samples, and one may lie outside the hull:
    /// [`use_hull_as_domain`](Self::use_hull_as_domain) prevents that.
    pub fn steiner_batch(&self, edge: [u32; 2], options: &StepOptions) -> Result<Batch, Error> {
        check_radius_edge(options.radius_edge)?;
        if edge[0] == edge[1] || edge.iter().any(|&v| !self.t.is_vertex(v)) {
            return Err(Error::NoSuchEdge { edge });
        }
        let (tet, i, j) = self.t.find_edge(edge[0], edge[1]).ok_or(Error::NoSuchEdge { edge })?;
        let mut batch = Batch { edge: edge_key(edge), points: Vec::new(), span: 0.0, theta: 0.0 };
        if let Some(boundary) = self.boundary() {
            batch.points = self.pending_split(boundary).into_iter().collect();
            if !batch.points.is_empty() {
                return Ok(batch);
            }
        }
        if self.boundary().is_some_and(|boundary| boundary.is_seditious(&self.t, edge)) {
            return Ok(batch);
        }
        let [p, q] = edge.map(|v| self.t.at(v));
        // Each sector of the domain around the edge by itself: the first with something to mend.
        let samples =
            self.t.topology.around_edge(tet, i, j).filter(|&(t, _, _)| self.t.is_inside(t)).find_map(|(t, _, _)| {
                let tet = self.t.topology.tet(t);
                let (i, j) = (tet.slot(edge[0])?, tet.slot(edge[1])?);
                let mut link = Vec::new();
                let closed = match self.boundary() {
                    Some(boundary) => boundary.sector(&self.t, t, i, j, &mut link),
                    None => self.t.link_of(t, i, j, &mut link),
                };
                let link: Vec<DVec3> = link.into_iter().map(|v| self.t.at(v)).collect();
                sample_edge(p, q, &link, closed, options.radius_edge, options.rule)
            });
        let Some(samples) = samples else { return Ok(batch) };
        if let Some(boundary) = self.boundary() {
            batch.points = self.splits_before(boundary, edge, &samples.points);
            if !batch.points.is_empty() {
                return Ok(batch);
            }
        }
        batch.points = samples
            .points
            .into_iter()
            .map(flush_tiny)
            .filter(|&position| check_range(0, position).is_ok())
            .map(|position| SteinerPoint { position, origin: Origin::Sample })
            .collect();
        (batch.span, batch.theta) = (samples.span, samples.theta);
        Ok(batch)
    }

    fn segment_split(&self, boundary: &Boundary, edge: [u32; 2]) -> SteinerPoint {
        SteinerPoint { position: flush_tiny(boundary.split_point(&self.t, edge)), origin: Origin::Segment(edge) }
    }

    fn facet_split(&self, face: [u32; 3]) -> SteinerPoint {
        let [a, b, c] = face.map(|v| self.t.at(v));
        SteinerPoint { position: flush_tiny(triangle_circumcenter(a, b, c)), origin: Origin::Subfacet(face) }
    }

    /// The split of the first boundary element that waits for one.
    fn pending_split(&self, boundary: &Boundary) -> Option<SteinerPoint> {
        let segment = boundary.next_pending_segment().map(|edge| self.segment_split(boundary, edge));
        segment.or_else(|| boundary.next_pending_facet().map(|face| self.facet_split(face)))
    }

    /// The splits of what samples of an edge would encroach upon: subsegments, else subfacets.
    fn splits_before(&self, boundary: &Boundary, edge: [u32; 2], samples: &[DVec3]) -> Vec<SteinerPoint> {
        let start = self.t.topology.vertex_tet[edge[0] as usize];
        let (mut cavity, mut found, mut all) = (Cavity::default(), Encroached::default(), Encroached::default());
        for &p in samples {
            let p = flush_tiny(p);
            let control = Control::never();
            if self.t.prepare(p, start, &mut cavity, control).is_ok()
                && boundary.encroached_by(&self.t, p, &cavity, &mut found, control).is_ok()
            {
                all.segments.append(&mut found.segments);
                all.facets.append(&mut found.facets);
                all.segments.append(&mut found.lost_segments);
                all.facets.append(&mut found.lost_facets);
            }
        }
        boundary.drop_blocked(&mut all, Demand::NONE);
        if all.segments.is_empty() {
            all.facets.sort_unstable();
            all.facets.dedup();
            all.facets.into_iter().map(|face| self.facet_split(face)).collect()
        } else {
            all.segments.sort_unstable();
            all.segments.dedup();
            all.segments.into_iter().map(|edge| self.segment_split(boundary, edge)).collect()
        }
    }

    /// Inserts a batch that [`steiner_batch`](Self::steiner_batch) made for this mesh as it is. Returns the new vertex of each point,
    /// `None` for points that were not inserted.
    ///
    /// A sample that has come to encroach upon the boundary, or a subfacet's split that would encroach upon a subsegment, is not
    /// inserted; what it encroaches upon is split by the next batches. No new vertex and no other next batch means that the edge can't be
    /// mended: its mending would need an edge below 2⁻⁴⁰ of the bounding box.
    pub fn insert_batch(&mut self, batch: &Batch) -> Result<Vec<Option<u32>>, Error> {
        // The place of a split is computed anew; only samples are taken as they are.
        for (index, point) in batch.points.iter().enumerate().filter(|(_, point)| point.origin == Origin::Sample) {
            check_range(index, point.position)?;
        }
        if self.t.dimension() < 3 {
            return Err(Error::NoSuchEdge { edge: batch.edge });
        }
        self.forget_view();
        let mut free = Boundary::default();
        if self.domain.is_none() {
            // An id of an input vertex stays one.
            self.t.retire_free_ids();
        }
        let (t, boundary) = self.parts();
        let mut refiner = Refiner::new(t, boundary.unwrap_or(&mut free), &RefineOptions::default());
        let mut new = Vec::new();
        for point in &batch.points {
            let before = refiner.t.vertex_count();
            let vertex = match point.origin {
                Origin::Sample => match refiner.place(point.position, refiner.t.recent())? {
                    Placed::Inserted(v) => Some(v),
                    Placed::Spared | Placed::Encroaches | Placed::Refused(_) => None,
                },
                Origin::Segment(edge) if refiner.boundary.is_subsegment(edge) => {
                    done(refiner.transact(Element::Segment(edge), Demand::NONE)?)
                }
                Origin::Subfacet(face) if refiner.boundary.is_subfacet(face) => {
                    done(refiner.split_facet_in_turn(face, Demand::NONE)?)
                }
                _ => None,
            };
            // A split may end at a vertex that was there already.
            new.push(vertex.filter(|_| refiner.t.vertex_count() > before));
        }
        refiner.boundary.drop_stale();
        Ok(new)
    }
}

fn done(split: Split) -> Option<u32> {
    match split {
        Split::Done(v) => Some(v),
        Split::After(_) | Split::Blocked => None,
    }
}
