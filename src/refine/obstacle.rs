//! What stood in the way of a sample last: a boundary element that it would have taken out of the triangulation, and that must not be split.
//!
//! Near such an element tetrahedra stay bad, and each change nearby makes new ones with the same short edges, whose samples fail on the
//! same element. Their cavities are large, where many vertices lie nearly on one sphere. So the element is remembered by the vertices of
//! the tetrahedron in hand, and the next sample there is tried on it first: a face goes if both tetrahedra at it are in conflict with the
//! sample, an edge if all around it are, which takes a few in-sphere tests instead of a search for the cavity. Failing that, the part of the cavity
//! around the tetrahedron is looked through. The answer is the same as the whole cavity's, and found before
//! [`near_side`](super::near_side) looks for what could be split before it: with that first, surfaces of parts get 2 to 6 % more tetrahedra, and
//! as many are left bad.

use rustc_hash::FxHashMap;

use super::restore::Element;
use crate::domain::pending::Demand;
use crate::domain::Boundary;
use crate::geometry::quality::EDGES;
use crate::geometry::Filter;
use crate::triangulation::topology::{tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::DVec3;

/// The last obstacles, each with a tetrahedron where it was found.
#[derive(Debug, Default)]
pub struct Obstacles {
    /// By short edge.
    of_edge: FxHashMap<[u32; 2], (Element, u32)>,
    /// By vertex.
    at: FxHashMap<u32, (Element, u32)>,
    /// Scratch: which tetrahedra near a sample are in conflict with it.
    known: FxHashMap<u32, bool>,
    /// None is remembered, for a test.
    #[cfg(test)]
    forgetful: bool,
}

impl Obstacles {
    /// Notes what a sample for an edge, and a tetrahedron with these vertices, has failed on.
    pub fn note(&mut self, t: &Triangulation, edge: [u32; 2], v: [u32; 4], element: Element) {
        let near = match element {
            Element::Segment([a, b]) => t.find_edge(a, b).map(|(tet, _, _)| tet),
            Element::Facet(face) => t.find_face(face).map(tet_of),
        };
        #[cfg(test)]
        let near = near.filter(|_| !self.forgetful);
        if let Some(near) = near {
            self.of_edge.insert(edge, (element, near));
            self.at.extend(v.into_iter().map(|v| (v, (element, near))));
        }
    }

    /// Whether a known obstacle of this edge or of the vertices `v` of tetrahedron `start` stands in the way of a sample at `p`, too, or one is found near
    /// that. What can be split as demanded does not; without a demand nothing is to be split. Where no sample has ever failed, nothing is looked for.
    pub fn stop(
        &mut self,
        (t, boundary): (&Triangulation, &Boundary),
        edge: [u32; 2],
        (start, v): (u32, [u32; 4]),
        p: DVec3,
        demand: Option<Demand>,
    ) -> bool {
        if self.at.is_empty() {
            return false;
        }
        let mut filter = t.filter.clone();
        filter.extend(p);
        let mut known = [None; 5];
        known[0] = self.of_edge.get(&edge).copied();
        for (known, v) in known[1..].iter_mut().zip(v) {
            *known = self.at.get(&v).copied();
        }
        for i in 0..5 {
            let Some((element, near)) = known[i] else { continue };
            let exists = match element {
                Element::Segment(edge) => boundary.is_subsegment(edge),
                Element::Facet(face) => boundary.is_subfacet(face),
            };
            if !exists
                || known[..i].contains(&known[i])
                || demand.is_some_and(|demand| element.asked(t, boundary, demand).is_some())
            {
                continue;
            }
            if goes(t, &filter, element, near, p) == Some(true) {
                return true;
            }
        }
        let obstacle = look_around((t, boundary), &filter, (start, &mut self.known), p, demand);
        if let Some(obstacle) = obstacle {
            self.note(t, edge, v, obstacle);
        }
        obstacle.is_some()
    }
}

/// So many tetrahedra in conflict with a sample are looked through for an obstacle before its whole cavity is searched for.
const NEAR: usize = 24;

/// A look at the part of a sample's cavity around tetrahedron `start`: an element in it that would go and must not be split.
fn look_around(
    (t, boundary): (&Triangulation, &Boundary),
    filter: &Filter,
    (start, known): (u32, &mut FxHashMap<u32, bool>),
    p: DVec3,
    demand: Option<Demand>,
) -> Option<Element> {
    // Where very many tetrahedra stand around an edge, it has grown, and to clear it would take long.
    if known.capacity() > 64 * NEAR {
        *known = FxHashMap::default();
    }
    known.clear();
    let mut conflicts = |tet: u32| *known.entry(tet).or_insert_with(|| t.conflicts(filter, tet, p));
    if !conflicts(start) {
        return None;
    }
    let stays = |element: Element| demand.is_none_or(|demand| element.asked(t, boundary, demand).is_none());
    let mut found = vec![start];
    let mut next = 0;
    while next < found.len().min(NEAR) {
        let tet = found[next];
        next += 1;
        for slot in 0..4 {
            let across = tet_of(t.topology.tet(tet).n[slot]);
            if !conflicts(across) {
                continue;
            }
            if let Some(face) = boundary.subfacet_at(t, tet, slot).map(Element::Facet).filter(|&face| stays(face)) {
                return Some(face);
            }
            if !found.contains(&across) {
                found.push(across);
            }
        }
        for [i, j] in EDGES {
            let Some(edge) = boundary.subsegment_at(t, tet, [i, j]).map(Element::Segment) else { continue };
            if stays(edge) && t.topology.around_edge(tet, i, j).all(|(around, _, _)| conflicts(around)) {
                return Some(edge);
            }
        }
    }
    None
}

/// Whether an element would go from the triangulation if `p` were inserted. `None` when it is not at tetrahedron `near`.
fn goes(t: &Triangulation, filter: &Filter, element: Element, near: u32, p: DVec3) -> Option<bool> {
    let tet = t.topology.tets.get(near as usize).filter(|tet| tet.is_live())?;
    match element {
        Element::Segment([a, b]) => {
            let (i, j) = (tet.slot(a)?, tet.slot(b)?);
            Some(t.topology.around_edge(near, i, j).all(|(around, _, _)| t.conflicts(filter, around, p)))
        }
        Element::Facet(face) => {
            let slot = (0..4).find(|&slot| !face.contains(&tet.v[slot]))?;
            if !tet.face(slot).iter().all(|v| *v != GHOST && face.contains(v)) {
                return None;
            }
            Some(t.conflicts(filter, near, p) && t.conflicts(filter, tet_of(tet.n[slot]), p))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refine::refiner::Refiner;
    use crate::{Control, Mesh, Plc, PlcFacet, RefineOptions};

    /// The end of a tube of long and thin triangles, closed by two polygons.
    fn tube(count: u32) -> Plc {
        let mut plc = Plc::default();
        for z in [0.0, 3.0] {
            for k in 0..count {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
                plc.points.push(DVec3::new(cos, sin, z + 0.25 * cos));
            }
        }
        let facet = |polygon: Vec<u32>| PlcFacet { polygons: vec![polygon], ..PlcFacet::default() };
        for k in 0..count {
            let next = (k + 1) % count;
            plc.facets.push(facet(vec![k, next, count + k]));
            plc.facets.push(facet(vec![next, count + next, count + k]));
        }
        plc.facets.push(facet((0..count).collect()));
        plc.facets.push(facet((count..2 * count).collect()));
        plc
    }

    #[test]
    fn what_is_remembered_changes_nothing() {
        let plc = tube(60);
        let refined = |forgetful: bool| {
            let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
            let (t, boundary) = mesh.parts();
            let mut refiner = Refiner::new(t, boundary.unwrap(), &RefineOptions::default());
            refiner.obstacles.forgetful = forgetful;
            refiner.refine(&Control::new()).unwrap();
            let (known, counts) = (refiner.obstacles.at.len(), [refiner.samples, refiner.segment_splits]);
            mesh.validate(3).unwrap();
            (known > 0, counts, mesh.view().points.to_vec())
        };
        let (with, without) = (refined(false), refined(true));
        assert!(with.0 && !without.0);
        assert_eq!((with.1, with.2), (without.1, without.2));
    }
}
