//! Off-centres on facets: where a subfacet is split that gives way to a sample of the sparse rule.
//!
//! Rule 2 takes the circumcentre, which is far from the subfacet's corners but may be near to something beside it. Any point of the facet inside the circle splits
//! the subfacet. Here those between the circumcentre and the foot of the sample are tried, which would be in its place on the facet, and the one wins
//! whose nearest vertex is farthest. Where the circumcentre would have a subsegment split first and another does not, that one must keep 1/√2 of
//! the sample's distance from its nearest vertex, which is what a circumcentre keeps of it. So nothing comes nearer than by the
//! classical rules. (Taking the foot wherever it keeps that distance gains on facets with many vertices near them and loses elsewhere. On
//! segments the middle always wins.)
//!
//! Hosts get samples one batch at a time and split at circumcentres; there the sparsifier is off, and so are these.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;

use super::refiner::Refiner;
use crate::domain::pending::Demand;
use crate::geometry::{check_range, flush_tiny};
use crate::Error;

/// How far from the circumcentre to the foot the points are that are tried.
const SHARES: [f64; 2] = [0.5, 1.0];

impl Refiner<'_> {
    /// A better point than the circumcentre `center` to split a subfacet at, if the sample that has just asked for the split leads to one.
    pub(super) fn facet_off_centre(
        &mut self,
        face: [u32; 3],
        center: DVec3,
        demand: Demand,
    ) -> Result<Option<DVec3>, Error> {
        let Some((sample, clearance)) = self.given_way.take() else { return Ok(None) };
        let Some(start) = self.t.face_tetrahedron_within(face, &self.control)? else { return Ok(None) };
        let corners = face.map(|v| self.t.at(v));
        let [a, b, c] = self.boundary.in_plane(self.t, face);
        // Made of the sides, so that on a plane of constant x, y or z it lies exactly.
        let (u, v, w) = (b - a, c - a, sample - a);
        let normal = u.cross(v);
        let along = |n: DVec3| n.dot(normal) / normal.length_squared();
        let foot = a + u * along(w.cross(v)) + v * along(u.cross(w));
        let mut widest =
            self.room_on_facet(flush_tiny(center), (face, start), demand)?.unwrap_or(FRAC_1_SQRT_2 * clearance);
        let mut best = None;
        for share in SHARES {
            let p = flush_tiny(center + (foot - center) * share);
            // No place has more room than to a corner.
            let corner = corners.map(|corner| corner.distance_squared(p)).into_iter().fold(f64::INFINITY, f64::min);
            if p.distance_squared(center) >= a.distance_squared(center) || corner.sqrt() <= widest {
                continue;
            }
            if let Some(room) = self.room_on_facet(p, (face, start), demand)?.filter(|&room| room > widest) {
                (widest, best) = (room, Some(p));
            }
        }
        Ok(best)
    }

    /// How far the nearest vertex of a point in the facet of `face` is; `None` where it can't be inserted, or subsegments would have to be split before.
    fn room_on_facet(
        &mut self,
        p: DVec3,
        (face, start): ([u32; 3], u32),
        demand: Demand,
    ) -> Result<Option<f64>, Error> {
        if check_range(0, p).is_err() || self.boundary.hides(self.t, face, p).is_some() {
            return Ok(None);
        }
        self.ready = None;
        if self.is_refused(p, start)? {
            return Ok(None);
        }
        let room = self.rim_distance(p)?;
        self.find_encroached(p)?;
        self.ready = Some((p, room));
        let waits = self.encroached.segments.iter().any(|&s| self.can_ask(s, demand));
        Ok((!waits).then_some(room))
    }
}
