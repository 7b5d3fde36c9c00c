//! Bad short edges and Steiner batches: pure functions over an edge and the ring of its link vertices.
use glam::DVec3;

/// How Steiner points are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rule {
    /// §4 of the paper: a batch of off-centres a component.
    #[default]
    Paper,
    /// The comparison method: the circumcentre of the bad tetrahedron.
    Circumcenter,
}

/// What to do about one edge: the Steiner points of one component of its Voronoi facet less its core disk.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Where the Steiner points go, to be inserted together.
    pub points: Vec<DVec3>,
    /// The span angle γ of the component, in radians, 0 when the facet misses the disk.
    pub span: f64,
    /// The sampling angle θ, in radians.
    pub theta: f64,
}

/// Whether edge `pq` is bad (Definition 3) for the bound `radius_edge`; `link` are the vertices around it in
/// order, `closed` tells a ring from a hull edge's open chain.
pub fn is_bad_edge(p: DVec3, q: DVec3, link: &[DVec3], closed: bool, radius_edge: f64) -> bool {
    let _ = (p, q, link, closed, radius_edge);
    unimplemented!()
}

/// The Steiner points of edge `pq`, or `None` when the edge is not bad.
pub fn sample_edge(p: DVec3, q: DVec3, link: &[DVec3], closed: bool, radius_edge: f64, rule: Rule) -> Option<Samples> {
    let _ = (p, q, link, closed, radius_edge, rule);
    unimplemented!()
}
