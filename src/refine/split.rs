//! Boundary rules 1 and 2: splitting a subsegment or a subfacet.

use glam::DVec3;

use super::refiner::Refiner;
use crate::domain::boundary::{edge_key, face_key};
use crate::geometry::circumsphere::triangle_circumcenter;
use crate::geometry::flush_tiny;
use crate::Error;

/// What became of a boundary element's split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// A vertex was inserted, or one that was there already serves.
    Done(u32),
    /// Another element has to be split first; it has been queued.
    Deferred,
    /// The split would make an edge shorter than the limit, or its point can't be placed. The element stays as it is.
    Blocked,
}

impl Refiner<'_> {
    /// Rule 1: splits a subsegment near its middle.
    pub(super) fn split_segment(&mut self, edge: [u32; 2]) -> Result<Split, Error> {
        let p = flush_tiny(self.boundary.split_point(self.t, edge));
        let [a, b] = edge.map(|v| self.t.at(v));
        let start =
            self.t.topology.find_edge(edge[0], edge[1]).map_or(self.t.topology.vertex_tet[edge[0] as usize], |e| e.0);
        let blocked = p.distance(a).min(p.distance(b)) < self.min_edge;
        match (blocked, self.t.prepare(p, start, &mut self.cavity)) {
            // A vertex that stands just there takes the new one's place, unless it is an end: then the segment is too short to split.
            (false, Err(existing)) if !edge.contains(&existing) => {
                self.cavity.clear();
                let p = self.t.at(existing);
                let changes = self.boundary.insert_on_segment(self.t, &self.cavity, edge, existing, p);
                let star = self.t.topology.star(existing);
                self.boundary.segment_changed(self.t, edge, existing, &changes, &star);
                Ok(Split::Done(existing))
            }
            (false, Ok(())) => {
                self.boundary.encroached_by(self.t, p, &self.cavity, &mut self.encroached);
                self.boundary.add_removed(self.t, p, &self.cavity, &mut self.encroached);
                let next = self.t.next_vertex();
                let changes = self.boundary.insert_on_segment(self.t, &self.cavity, edge, next, p);
                let new = self.insert_prepared(p)?;
                self.boundary.segment_changed(self.t, edge, new, &changes, &self.cavity.created);
                self.boundary.enqueue_for(self.t, new, std::mem::take(&mut self.encroached));
                self.finish();
                self.segment_splits += 1;
                Ok(Split::Done(new))
            }
            _ => {
                self.cavity.clear();
                self.boundary.blocked_segments.insert(edge_key(edge));
                Ok(Split::Blocked)
            }
        }
    }

    /// Rule 2: inserts a subfacet's circumcentre, unless that encroaches upon a subsegment, which then is queued before it.
    pub(super) fn split_facet(&mut self, face: [u32; 3]) -> Result<Split, Error> {
        let corners = face.map(|v| self.t.at(v));
        let p = flush_tiny(triangle_circumcenter(corners[0], corners[1], corners[2]));
        let start = self.t.face_tetrahedron(face).unwrap_or(self.t.topology.vertex_tet[face[0] as usize]);
        let too_near = !p.is_finite() || corners.iter().any(|c| c.distance(p) < self.min_edge);
        if too_near || self.t.prepare(p, start, &mut self.cavity).is_err() {
            return Ok(self.block_facet(face));
        }
        self.boundary.encroached_by(self.t, p, &self.cavity, &mut self.encroached);
        self.boundary.add_removed(self.t, p, &self.cavity, &mut self.encroached);
        if self.rim_distance(p) < self.min_edge {
            return Ok(self.block_facet(face));
        }
        let blocked = &self.boundary.blocked_segments;
        if self.encroached.segments.iter().any(|s| !blocked.contains(s)) {
            self.encroached.facets.clear();
            self.boundary.enqueue(&self.encroached);
            self.boundary.pending_facets.push_front(face_key(face));
            self.cavity.clear();
            return Ok(Split::Deferred);
        }
        // The planar triangulation first: it may refuse the point.
        let new = self.t.next_vertex();
        let Some((facet, change)) = self.boundary.insert_on_facet(self.t, &self.cavity, face, new, p) else {
            return Ok(self.block_facet(face));
        };
        let inserted = self.insert_prepared(p)?;
        debug_assert_eq!(inserted, new);
        self.boundary.facet_changed(self.t, new, facet, &change, &self.cavity.created);
        self.boundary.enqueue_for(self.t, new, std::mem::take(&mut self.encroached));
        self.finish();
        self.facet_splits += 1;
        Ok(Split::Done(new))
    }

    fn block_facet(&mut self, face: [u32; 3]) -> Split {
        self.cavity.clear();
        self.boundary.blocked_facets.insert(face_key(face));
        Split::Blocked
    }

    /// The distance from the cavity's point to the nearest vertex.
    pub(super) fn rim_distance(&self, p: DVec3) -> f64 {
        self.cavity.rim(&self.t.topology).map(|v| self.t.at(v).distance_squared(p)).fold(f64::INFINITY, f64::min).sqrt()
    }
}
