//! Which vertices to replace by which point: found by forecasts alone.
//!
//! With `v` gone, some tetrahedra of what fills its star are bad: the *obstacles*. A point that shall stand in for `v` has to lie in the
//! circumballs of all of them. So have those that stand for `v` and a neighbour `w` together, in the balls of the obstacles that
//! don't end at `w`: few of those, and near `w`, make a promising pair. For such a pair the place is looked for from a
//! point in all balls of its own obstacles, by a pattern search (R. Hooke, T. A. Jeeves, J. ACM 8, 1961).
//!
//! A vertex on a segment stands in for one on a facet beside it or a free one, a vertex on a facet for a free one; the place then is on
//! that segment or facet.

use super::forecast::{Outcome, Space};
use super::{Demand, Effort, Sparsifier};
use crate::domain::{Boundary, Carrier, Unsplit};
use crate::triangulation::Triangulation;
use crate::DVec3;

/// How far a partner may be, in β times the length of the edge being mended.
const REACH: f64 = 1.75;

/// A replacement that looks good.
#[derive(Clone, Debug)]
pub struct Found {
    /// The vertices that go.
    pub remove: Vec<u32>,
    /// Where one comes, and what it lies on.
    pub add: Option<(DVec3, Carrier)>,
    /// What becomes of the boundary without the vertices.
    pub plan: Unsplit,
}

impl Sparsifier {
    /// Looks for something to do at `v`.
    pub(super) fn search(&mut self, t: &Triangulation, boundary: &Boundary, v: u32, demand: Demand) -> Option<Found> {
        let while_refining = demand.level2.is_finite();
        if !self.is_steiner(t, v) || while_refining && boundary.kind(v) != 0 {
            return None;
        }
        let Effort { neighbours, remaining, obstacles, cap, places, .. } = self.effort;
        let Sparsifier { alone, pair, near, .. } = self;
        if !alone.open(t, &[v]) {
            return None;
        }
        let p = t.at(v);
        near.clear();
        // Of a new sample nothing is gained by taking it away again: it needs a partner.
        let reach = REACH * self.radius_edge;
        let limit =
            if while_refining { reach * demand.level2.sqrt() } else { 2.0 * reach * spacing(t, alone.going(), v) };
        for &id in alone.going() {
            for w in t.topology.tet(id).v {
                if w == v || w < self.first || while_refining && boundary.kind(w) != 0 || near.iter().any(|n| n.1 == w)
                {
                    continue;
                }
                let distance = t.at(w).distance(p);
                if distance <= limit {
                    near.push((distance, w));
                }
            }
        }
        if near.is_empty() && while_refining {
            return None;
        }
        let plan = boundary.without(t, &[v])?;
        if !alone.fill(t, boundary, &[v], &plan, demand, usize::MAX) {
            return None;
        }
        if alone.obstacles.is_empty() {
            return Some(Found { remove: vec![v], add: None, plan });
        }
        near.retain(|&(_, w)| {
            let Some(number) = alone.vertices.iter().position(|&x| x == w) else { return false };
            let misses = |&&i: &&u32| !alone.filling[i as usize].v.contains(&(number as u8));
            alone.obstacles.iter().filter(misses).count() <= remaining
        });
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(neighbours);
        for &(distance, w) in near.iter() {
            let Some((lower, space)) = shared_space(t, boundary, v, w) else { continue };
            let carrier = boundary.carrier(lower);
            let q = t.at(w);
            let number = alone.vertices.iter().position(|&x| x == w)? as u8;
            let base = t.at(lower);
            let mut place = base + space.along(0.5 * p + 0.5 * q - base);
            if !alone.move_into_obstacles(&mut place, &space, |tet| !tet.v.contains(&number)) {
                continue;
            }
            let Some(plan) = boundary.without(t, &[v, w]) else { continue };
            if !pair.open(t, &[v, w])
                || !pair.fill(t, boundary, &[v, w], &plan, demand, obstacles)
                || !pair.move_into_obstacles(&mut place, &space, |_| true)
            {
                continue;
            }
            pair.aim(t);
            let on = boundary.facets_at(&carrier);
            let mut best = pair.try_point(t, boundary, place, on, demand, cap);
            if best == Outcome::NO {
                continue;
            }
            let (mut step, mut tries) = (0.25 * distance, 1);
            while tries < places {
                let before = best;
                for axis in &space.axes[..space.dimension] {
                    for direction in [step, -step] {
                        let there = place + *axis * direction;
                        let outcome = pair.try_point(t, boundary, there, on, demand, best.worst.max(1.0));
                        tries += 1;
                        if outcome.beats(&best) {
                            best = outcome;
                            place = there;
                        }
                    }
                }
                if best == before {
                    step *= 0.5;
                }
            }
            if best.is_good() {
                return Some(Found { remove: vec![v, w], add: Some((place, carrier)), plan });
            }
        }
        None
    }
}

/// The distance from a vertex to the nearest of its neighbours.
fn spacing(t: &Triangulation, star: &[u32], v: u32) -> f64 {
    let others = star.iter().flat_map(|&id| t.topology.tet(id).v).filter(|&w| w != v);
    others.map(|w| t.at(w).distance_squared(t.at(v))).fold(f64::INFINITY, f64::min).sqrt()
}

/// Of two vertices the one on the lower boundary element, and where a point may go that stands for both. `None` when neither element holds the
/// other.
fn shared_space(t: &Triangulation, boundary: &Boundary, v: u32, w: u32) -> Option<(u32, Space)> {
    let carriers = [boundary.carrier(v), boundary.carrier(w)];
    let holds = |outer: Carrier, inner: Carrier| match (outer, inner) {
        (Carrier::Free, _) => true,
        (Carrier::Facet(f), Carrier::Segment(s)) => boundary.segments()[s as usize].facets.contains(&f),
        _ => outer == inner,
    };
    let lower = if holds(carriers[0], carriers[1]) {
        w
    } else if holds(carriers[1], carriers[0]) {
        v
    } else {
        return None;
    };
    let space = match boundary.carrier(lower) {
        Carrier::Free => Space { axes: [DVec3::X, DVec3::Y, DVec3::Z], dimension: 3 },
        Carrier::Segment(s) => {
            let [a, b] = boundary.segments()[s as usize].ends.map(|v| t.at(v));
            Space { axes: [(b - a).normalize_or_zero(), DVec3::ZERO, DVec3::ZERO], dimension: 1 }
        }
        Carrier::Facet(f) => {
            let normal = boundary.facets()[f as usize].normal();
            // Along the axes the point stays exactly in the plane.
            let (e, f) = normal.any_orthonormal_pair();
            Space { axes: [e, f, DVec3::ZERO], dimension: 2 }
        }
        Carrier::Vertex(_) => return None,
    };
    Some((lower, space))
}
