//! What a sample meets on the near side of the boundary: a look at its cavity as far as subfacets let see from the bad tetrahedron.
//!
//! Where the boundary is coarse, samples often lie beyond it, or take a piece of it out. Then it is split, and of the cavity only the part on this side
//! tells where. The other part may be far larger: outside a domain tetrahedra are long, and many are cospherical. Beyond a side of a box a sample is in conflict
//! with every ghost there.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::refiner::{Placed, Refiner};
use super::restore::Element;
use super::Unrefined;
use crate::domain::pending::Demand;
use crate::domain::Boundary;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::quality::EDGES;
use crate::geometry::{Filter, Sign};
use crate::triangulation::topology::{tet_of, GHOST, NONE};
use crate::triangulation::Triangulation;

/// Parts with more tetrahedra are left to the search for the whole cavity.
const LARGE: usize = 256;

/// The part of a cavity on one side of the boundary.
#[derive(Debug, Default)]
pub struct NearSide {
    /// Whether tetrahedra are in conflict with the sample.
    known: FxHashMap<u32, bool>,
    /// Those that are.
    tets: Vec<u32>,
}

impl Refiner<'_> {
    /// What becomes of a sample at `p` beyond a subfacet that can be seen from tetrahedron `start`: what it takes out or encroaches upon on the near side is queued,
    /// the nearest of it, or the sample is refused. `None` when there is no such subfacet, or that can't be told so.
    pub(super) fn meets_wall(&mut self, p: DVec3, start: u32, demand: Demand) -> Option<Placed> {
        let Refiner { t, boundary, encroached, near_side, .. } = self;
        let (t, boundary) = (&**t, &**boundary);
        let corners = t.topology.tet(start).v;
        let mut filter = t.filter.clone();
        filter.extend(p);
        // Away from the boundary few samples are beyond it, and the quick walk, which knows no walls, shows most of the others.
        if corners.iter().all(|&v| boundary.kind(v) == 0) {
            let end = t.walk_within(&filter, p, start, &self.control).ok()?;
            if !t.topology.tet(end).is_ghost() && t.topology.same_label(start, end) {
                return None;
            }
        }
        if !is_beyond((t, boundary), &filter, start, p) {
            return None;
        }
        let NearSide { known, tets } = near_side;
        known.clear();
        tets.clear();
        encroached.clear();
        let mut conflicts = |tet: u32| *known.entry(tet).or_insert_with(|| t.conflicts(&filter, tet, p));
        tets.push(at_edge(t, self.mended, start, &mut conflicts)?);
        let (mut next, mut takes, mut obstacle) = (0, false, None);
        // Whether an element is an obstacle: the sample would take it out, and it can't be split.
        let mut stays = |element: Element, goes: bool| {
            takes |= goes;
            goes && element.asked(t, boundary, demand).is_none()
        };
        'search: while next < tets.len() {
            if tets.len() > LARGE {
                return None;
            }
            let tet = tets[next];
            next += 1;
            let v = t.topology.tet(tet).v;
            for slot in 0..4 {
                let across = tet_of(t.topology.tet(tet).n[slot]);
                let Some(face) = boundary.subfacet_at(t, tet, slot) else {
                    if conflicts(across) && !tets.contains(&across) {
                        tets.push(across);
                    }
                    continue;
                };
                let goes = conflicts(across);
                if stays(Element::Facet(face), goes) {
                    obstacle = Some(Element::Facet(face));
                    break 'search;
                }
                if goes || encroaches_facet(face.map(|v| t.at(v)), p) {
                    encroached.facets.push(face);
                }
            }
            if !boundary.may_have_edge(v) {
                continue;
            }
            for [i, j] in EDGES {
                let Some(edge) = boundary.subsegment_at(t, tet, [i, j]) else { continue };
                if encroached.segments.contains(&edge) {
                    continue;
                }
                let goes = t.topology.around_edge(tet, i, j).all(|(around, _, _)| conflicts(around));
                if stays(Element::Segment(edge), goes) {
                    obstacle = Some(Element::Segment(edge));
                    break 'search;
                }
                if goes || encroaches_segment(edge.map(|v| t.at(v)), p) {
                    encroached.segments.push(edge);
                }
            }
        }
        if let Some(obstacle) = obstacle {
            self.obstacles.note(t, self.mended, corners, obstacle);
            return Some(Placed::Refused(Unrefined::Boundary));
        }
        if !takes {
            return None;
        }
        let room = tets.iter().flat_map(|&tet| t.topology.tet(tet).v).filter(|&v| v != GHOST);
        let room = room.map(|v| t.at(v).distance_squared(p)).fold(f64::INFINITY, f64::min).sqrt();
        // Not in the order of storage.
        encroached.segments.sort_unstable();
        encroached.facets.sort_unstable();
        encroached.facets.dedup();
        // What a cancellation has left out is left to the search.
        matches!(self.give_way(p, room, demand), Ok(true)).then_some(Placed::Encroaches)
    }
}

/// A tetrahedron in conflict with a sample for an edge: the bad one, or else one beside it at that edge, for the sample mends the edge's widest component.
fn at_edge(t: &Triangulation, edge: [u32; 2], start: u32, mut conflicts: impl FnMut(u32) -> bool) -> Option<u32> {
    if conflicts(start) {
        return Some(start);
    }
    let tet = t.topology.tet(start);
    let [i, j] = [tet.slot(edge[0])?, tet.slot(edge[1])?];
    let around = t.topology.around_edge(start, i, j).map(|(around, _, _)| around).take(LARGE);
    // Not in another region: the sample is meant for this side.
    around.into_iter().find(|&around| t.topology.same_label(start, around) && conflicts(around))
}

/// Whether a walk from a tetrahedron to `p` ends at a subfacet: there is no face but subfacets beyond which `p` lies.
fn is_beyond((t, boundary): (&Triangulation, &Boundary), filter: &Filter, start: u32, p: DVec3) -> bool {
    /// Near samples are some steps away.
    const STEPS: usize = 64;
    let (mut tet, mut from) = (start, NONE);
    for _ in 0..STEPS {
        if t.topology.tet(tet).is_ghost() {
            return false;
        }
        let corners = t.corners(tet);
        let (mut wall, mut next) = (false, None);
        for slot in 0..4 {
            let across = tet_of(t.topology.tet(tet).n[slot]);
            let mut moved = corners;
            moved[slot] = p;
            let [a, b, c, d] = moved;
            if across == from || filter.orient3d(a, b, c, d) != Sign::Negative {
                continue;
            }
            if boundary.subfacet_at(t, tet, slot).is_some() {
                wall = true;
            } else {
                // The way must not depend on how tetrahedra are stored.
                let passed = t.topology.tet(tet).v[slot];
                next = Some(next.map_or((passed, across), |best: (u32, u32)| best.min((passed, across))));
            }
        }
        match next {
            Some((_, across)) => (tet, from) = (across, tet),
            None => return wall,
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::boundary::Encroached;
    use crate::geometry::flush_tiny;
    use crate::geometry::quality::exceeds_radius_edge;
    use crate::refine::queue::shortest_edge;
    use crate::samples::random_points;
    use crate::triangulation::cavity::Cavity;
    use crate::{Control, Mesh, Plc, RefineOptions};

    /// Points up to the sides of a box, which are two triangles each: nearly all samples near a side lie beyond it.
    #[test]
    fn what_is_met_from_anywhere_is_what_the_whole_cavity_meets() {
        let points = random_points(400, 5);
        let mut mesh = Mesh::from_plc(&Plc::boxed(DVec3::NEG_ONE, DVec3::ONE, points), &Control::new()).unwrap();
        let (t, boundary) = mesh.parts();
        let mut refiner = Refiner::new(t, boundary.unwrap(), &RefineOptions::default());
        refiner.boundary.lazy = true;
        refiner.boundary.forget_waiting();
        let all: Vec<u32> = refiner.t.topology.live().filter(|&tet| refiner.t.is_inside(tet)).collect();
        let (mut cavity, mut found) = (Cavity::default(), Encroached::default());
        let (mut met, mut away, mut beside) = (0, 0, 0);
        for tet in all {
            if !exceeds_radius_edge(refiner.t.corners(tet), 1.5) {
                continue;
            }
            let v = refiner.t.topology.tet(tet).v;
            let [i, j] = shortest_edge(refiner.t, tet).0;
            let p = flush_tiny(refiner.sample(tet, [i, j]).points[0]);
            refiner.mended = [v[i], v[j]];
            let filter = {
                let mut filter = refiner.t.filter.clone();
                filter.extend(p);
                filter
            };
            if refiner.meets_wall(p, tet, Demand::NONE).is_none() {
                continue;
            }
            met += 1;
            away += usize::from(v.iter().all(|&v| refiner.boundary.kind(v) == 0));
            beside += usize::from(!refiner.t.conflicts(&filter, tet, p));
            refiner.t.prepare(p, tet, &mut cavity, Control::never()).unwrap();
            refiner.boundary.encroached_by(refiner.t, p, &cavity, &mut found, Control::never()).unwrap();
            for (edge, _) in refiner.boundary.pending_segments.drain(..) {
                assert!(found.segments.contains(&edge) || found.lost_segments.contains(&edge));
            }
            for (face, _) in refiner.boundary.pending_facets.drain(..) {
                assert!(found.facets.contains(&face) || found.lost_facets.contains(&face));
            }
        }
        assert!(met > 20 && away > 0 && beside > 0, "{met} {away} {beside}");
    }
}
