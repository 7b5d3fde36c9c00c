//! Point location by the visibility walk (O. Devillers, S. Pion, M. Teillaud, "Walking in a triangulation", IJFCS 13, 2002): from
//! tetrahedron to tetrahedron across any face that separates from the goal. In a Delaunay
//! triangulation it never turns in a circle, and the predicates are exact, so it ends.

use glam::DVec3;

use super::topology::{slot_of, tet_of};
use super::Triangulation;
use crate::geometry::{Filter, Sign};

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

    /// The tetrahedron that holds `p`, its faces included, or a ghost whose hull facet has `p` strictly outside. `p` must be
    /// covered by the triangulation's filter.
    #[inline]
    pub(crate) fn walk(&self, p: DVec3, start: u32) -> u32 {
        self.walk_with(&self.filter, p, start)
    }

    pub(crate) fn walk_with(&self, filter: &Filter, p: DVec3, start: u32) -> u32 {
        let mut t = start;
        let mut entered = usize::MAX;
        if self.topology.tet(t).is_ghost() {
            let face = self.topology.tet(t).n[3];
            // Nothing is known yet of p and that face.
            t = tet_of(face);
        }
        'walk: loop {
            let tet = self.topology.tet(t);
            let corners = self.corners(t);
            for slot in 0..4 {
                if slot == entered {
                    continue;
                }
                let mut replaced = corners;
                replaced[slot] = p;
                let [a, b, c, d] = replaced;
                if filter.orient3d(a, b, c, d) == Sign::Negative {
                    let face = tet.n[slot];
                    t = tet_of(face);
                    entered = slot_of(face);
                    if self.topology.tet(t).is_ghost() {
                        return t;
                    }
                    continue 'walk;
                }
            }
            return t;
        }
    }
}
