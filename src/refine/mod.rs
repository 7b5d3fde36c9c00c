//! The refinement loop.

use crate::sampler::Rule;

/// What [`Mesh::refine`](crate::Mesh::refine) shall reach, and when it shall stop.
#[derive(Clone, Debug, PartialEq)]
pub struct RefineOptions {
    /// The bound β: no tetrahedron's circumradius is longer than β times its shortest edge. At least 1.
    pub radius_edge: f64,
    /// How Steiner points are chosen.
    pub rule: Rule,
    /// No vertex is added beyond this many, input included.
    pub max_vertices: usize,
    /// No Steiner point is added nearer than this to a vertex; 0 chooses 2⁻⁴⁰ of the bounding box's diagonal.
    pub min_edge: f64,
}

impl Default for RefineOptions {
    fn default() -> Self {
        RefineOptions { radius_edge: 2.0, rule: Rule::default(), max_vertices: 100_000_000, min_edge: 0.0 }
    }
}

/// How a refinement ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RefineStatus {
    /// Every tetrahedron keeps the bound.
    Done,
    /// The control was cancelled; the mesh is valid.
    Cancelled,
    /// The vertex limit was reached; the mesh is valid.
    VertexLimit,
    /// Some tetrahedra are left bad because mending them would need an edge below the minimum length.
    MinEdge,
}

/// What a refinement did, and the mesh's quality now.
#[derive(Clone, Debug, PartialEq)]
pub struct RefineReport {
    pub status: RefineStatus,
    pub input_vertices: usize,
    pub vertices: usize,
    pub tetrahedra: usize,
    /// vertices − input_vertices.
    pub steiner: usize,
    /// Steiner points that the sampling rule made, that split segments, that split subfacets.
    pub samples: usize,
    pub segment_splits: usize,
    pub facet_splits: usize,
    /// Tetrahedra of the domain over the bound (exact).
    pub bad: usize,
    /// The largest R/l in the domain, 0 without tetrahedra.
    pub worst_radius_edge: f64,
    /// The smallest dihedral angle in the domain, 180 without tetrahedra.
    pub min_dihedral_degrees: f64,
}
