//! Bad short edges and their Steiner batches: pure functions over an edge and the vertices around it (its link), so that they serve any
//! host's triangulation as well as ours.
//!
//! Source: R. Jampani, A. Üngör, "Construction of Sparse Well-spaced Point Sets for Quality Tetrahedralizations", IMR 2007, §3 and §4.
//!
//! | module | idea |
//! |---|---|
//! | [`facet`] | the Voronoi facet as an intersection of half-planes, and the arcs of the core disk's rim in it |
//! | [`paper`] | the batch of §4 for one arc |
//! | [`sparse`] | our own batch for one arc, of fewer samples |
//!
//! Link vertices are given in order around the edge, either way. `closed` says whether they form a ring; on the hull they form an open chain
//! from one hull facet's third corner to the other's.

pub mod facet;
pub mod paper;
pub mod sparse;

use glam::DVec3;

use crate::geometry::circumsphere::circumcenter;
use crate::geometry::quality::{exceeds_radius_edge, EDGES};
use facet::{Arc, VoronoiFacet};

/// How Steiner points are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rule {
    /// A batch of off-centres for the component of the largest span, with fewer and wider pieces than the paper's: the sparsest.
    /// At levels of [`Sparsify`](crate::Sparsify) above `Off` a boundary element is not split because a vertex encroaches upon it, but when a sample does
    /// so, too, or would take it out; not in hosts' steps, nor where tetrahedra's sizes are limited.
    #[default]
    Sparse,
    /// §4 of the paper: a batch of off-centres for the component of the largest span.
    Paper,
    /// The comparison method: the circumcentre of the bad tetrahedron.
    Circumcenter,
}

/// The Steiner points for one component of an edge's Voronoi facet less its core disk.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Where they go, to be inserted together.
    pub points: Vec<DVec3>,
    /// The component's span angle γ in radians; 0 for a circumcentre.
    pub span: f64,
    /// The sampling angle θ in radians; 0 for a circumcentre.
    pub theta: f64,
}

/// The tetrahedra around edge `pq`: one between each two successive link vertices.
fn around<'a>(p: DVec3, q: DVec3, link: &'a [DVec3], closed: bool) -> impl Iterator<Item = [DVec3; 4]> + 'a {
    let n = link.len();
    let count = if closed { n } else { n.saturating_sub(1) };
    (0..count).map(move |i| [p, q, link[i], link[(i + 1) % n]])
}

/// Whether edge `pq` is bad (Definition 3): a corner of its Voronoi facet lies outside the core disk, that is, a tetrahedron around it
/// has a circumradius of more than `radius_edge·|pq|`.
pub fn is_bad_edge(p: DVec3, q: DVec3, link: &[DVec3], closed: bool, radius_edge: f64) -> bool {
    worst_tetrahedron(p, q, link, closed, radius_edge).is_some()
}

/// Whether edge `pq` is short (Definition 2): the shortest edge of a tetrahedron around it.
pub fn is_short_edge(p: DVec3, q: DVec3, link: &[DVec3], closed: bool) -> bool {
    around(p, q, link, closed).any(is_shortest)
}

/// Whether the first two corners span a shortest edge of the tetrahedron.
fn is_shortest(tet: [DVec3; 4]) -> bool {
    let length = tet[0].distance_squared(tet[1]);
    EDGES.iter().all(|&[i, j]| tet[i].distance_squared(tet[j]) >= length)
}

/// Whether edge `pq` is a bad short edge: the shortest edge of a tetrahedron around it that is over the bound. A triangulation without one
/// has no bad tetrahedron (Theorem 2).
pub fn is_bad_short_edge(p: DVec3, q: DVec3, link: &[DVec3], closed: bool, radius_edge: f64) -> bool {
    around(p, q, link, closed).any(|tet| is_shortest(tet) && exceeds_radius_edge(tet, radius_edge))
}

/// The tetrahedron around `pq` with the largest circumradius, if one is outside the core disk. Exact but for the choice
/// among several.
fn worst_tetrahedron(p: DVec3, q: DVec3, link: &[DVec3], closed: bool, radius_edge: f64) -> Option<[DVec3; 4]> {
    let length = p.distance_squared(q);
    let radius = |tet: [DVec3; 4]| {
        let r = crate::geometry::quality::radius_and_edge_squared(tet).0;
        if r.is_nan() {
            f64::INFINITY
        } else {
            r
        }
    };
    let mut worst: Option<([DVec3; 4], f64)> = None;
    for tet in around(p, q, link, closed) {
        // The tetrahedron's own shortest edge may be shorter than pq: the bound is for pq here.
        let exceeds = if is_shortest(tet) {
            exceeds_radius_edge(tet, radius_edge)
        } else {
            radius(tet) > radius_edge * radius_edge * length
        };
        if exceeds && worst.is_none_or(|(_, r)| radius(tet) > r) {
            worst = Some((tet, radius(tet)));
        }
    }
    worst.map(|(tet, _)| tet)
}

/// The Steiner points of edge `pq` under a rule, `None` when the edge is not bad.
///
/// [`Rule::Circumcenter`], and any rule where the facet misses the core disk, gives the circumcentre of the worst tetrahedron around the
/// edge. `radius_edge` is β, finite and at least ½ (the paper needs 2 for its guarantee).
pub fn sample_edge(p: DVec3, q: DVec3, link: &[DVec3], closed: bool, radius_edge: f64, rule: Rule) -> Option<Samples> {
    let worst = worst_tetrahedron(p, q, link, closed, radius_edge)?;
    if rule != Rule::Circumcenter {
        let facet = VoronoiFacet::new(p, q, link, closed);
        let mut arcs = Vec::new();
        if let Some(samples) = sample_component(&facet, &mut arcs, radius_edge, rule) {
            return Some(samples);
        }
    }
    Some(sample_circumcenter(worst))
}

/// The arc of the component of the largest span; the first among equals, whatever rounding makes of their spans' last digits elsewhere.
fn largest_arc(facet: &VoronoiFacet, arcs: &mut Vec<Arc>, radius_edge: f64) -> Option<Arc> {
    facet.rim_arcs(facet.core_radius(radius_edge), arcs);
    arcs.iter().copied().reduce(|a, b| if b.span > a.span { b } else { a })
}

/// The first sample of [`Rule::Sparse`] for the component of the largest span, of pieces for samples that will be tried at once with their neighbours.
pub(crate) fn sample_first(facet: &VoronoiFacet, arcs: &mut Vec<Arc>, radius_edge: f64) -> Option<Samples> {
    let arc = largest_arc(facet, arcs, radius_edge)?;
    Some(sparse::sample_first(facet, arc, radius_edge)).filter(|samples| samples.points.iter().all(|s| s.is_finite()))
}

/// The batch for the component of the largest span; `None` when no arc of the rim lies in the facet, or the rule has no batches.
/// `arcs` is scratch memory.
pub fn sample_component(facet: &VoronoiFacet, arcs: &mut Vec<Arc>, radius_edge: f64, rule: Rule) -> Option<Samples> {
    let arc = largest_arc(facet, arcs, radius_edge)?;
    let samples = match rule {
        Rule::Sparse => sparse::sample_arc(facet, arc, radius_edge),
        Rule::Paper => paper::sample_arc(facet, arc, radius_edge),
        Rule::Circumcenter => return None,
    };
    samples.points.iter().all(|s| s.is_finite()).then_some(samples)
}

/// The Steiner points for a tetrahedron over the bound, as the refinement takes them: the batch of its first two corners' edge, whose link (or
/// the part of it on this side of the boundary) that is; where the rule has none, the circumcentre.
pub fn sample_tetrahedron(corners: [DVec3; 4], link: &[DVec3], closed: bool, radius_edge: f64, rule: Rule) -> Samples {
    if rule != Rule::Circumcenter {
        let facet = VoronoiFacet::new(corners[0], corners[1], link, closed);
        if let Some(samples) = sample_component(&facet, &mut Vec::new(), radius_edge, rule) {
            return samples;
        }
    }
    sample_circumcenter(corners)
}

/// The circumcentre of a tetrahedron as a batch of one; empty when it is flat to rounding.
pub fn sample_circumcenter([a, b, c, d]: [DVec3; 4]) -> Samples {
    let center = circumcenter(a, b, c, d);
    Samples { points: if center.is_finite() { vec![center] } else { Vec::new() }, span: 0.0, theta: 0.0 }
}

#[cfg(test)]
mod tests;
