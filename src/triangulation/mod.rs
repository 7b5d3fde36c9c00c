//! The incremental Delaunay triangulation.

use glam::DVec3;

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// At this vertex.
    Vertex(u32),
    /// Inside this edge.
    Edge([u32; 2]),
    /// Inside this face.
    Face([u32; 3]),
    /// Inside this tetrahedron.
    Tetrahedron([u32; 4]),
    /// Outside the convex hull (or in a triangulation without tetrahedra and not at a vertex).
    Outside,
}

/// A Delaunay triangulation of points of any dimension.
#[derive(Clone, Debug, Default)]
pub struct Triangulation {}

impl Triangulation {
    /// −1 (no points) to 3.
    pub fn dimension(&self) -> i32 {
        unimplemented!()
    }
    pub fn vertex_count(&self) -> usize {
        unimplemented!()
    }
    pub fn tetrahedron_count(&self) -> usize {
        unimplemented!()
    }
    pub fn point(&self, vertex: u32) -> Option<DVec3> {
        let _ = vertex;
        unimplemented!()
    }
    /// `hint`: a vertex near the point, if one is known.
    pub fn locate(&self, point: DVec3, hint: Option<u32>) -> Location {
        let _ = (point, hint);
        unimplemented!()
    }
    /// The vertices around an edge in order, and whether they form a ring (false: an open chain at the hull).
    pub fn link(&self, edge: [u32; 2]) -> Option<(Vec<u32>, bool)> {
        let _ = edge;
        unimplemented!()
    }
}
