//! Point location: a [walk](super::search), then the face of the tetrahedron that the point is in.

use glam::DVec3;

use super::Triangulation;
use crate::geometry::Sign;

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
    /// Outside the convex hull, or in a triangulation without tetrahedra and at no vertex.
    Outside,
}

impl Triangulation {
    /// Where `point` lies. `hint` is a vertex near it, if one is known. Not finite points are outside.
    ///
    /// Cost: the number of tetrahedra between the hint and the point; about n^⅓ without a good hint.
    pub fn locate(&self, point: DVec3, hint: Option<u32>) -> Location {
        if self.dimension() < 3 {
            return self.lower.find(point).map_or(Location::Outside, Location::Vertex);
        }
        let (low, high) = self.bounding_box();
        // False for NaN too.
        if !(point.cmpge(low).all() && point.cmple(high).all()) {
            return Location::Outside;
        }
        // A coordinate too small for the predicates lies on the same side as 0 of all that are not.
        let point = crate::geometry::flush_tiny(point);
        let mut filter = self.filter.clone();
        filter.extend(point);
        let t = self.walk_with(&filter, point, self.start(hint));
        let tet = self.topology.tet(t);
        if tet.is_ghost() {
            return Location::Outside;
        }
        let corners = self.corners(t);
        let mut support = [0; 4];
        let mut count = 0;
        for slot in 0..4 {
            let mut replaced = corners;
            replaced[slot] = point;
            let [a, b, c, d] = replaced;
            if filter.orient3d(a, b, c, d) != Sign::Zero {
                support[count] = tet.v[slot];
                count += 1;
            }
        }
        let [a, b, c, d] = support;
        match count {
            1 => Location::Vertex(a),
            2 => Location::Edge([a, b]),
            3 => Location::Face([a, b, c]),
            _ => Location::Tetrahedron([a, b, c, d]),
        }
    }
}
