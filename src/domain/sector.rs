//! The part of an edge's link that belongs to one side of the boundary. Subfacets part the tetrahedra around an edge into
//! sectors; to the sampler each is like the open chain of a hull edge, with the subfacets as the walls of its wedge.

use super::boundary::Boundary;
use super::label::OUTSIDE;
use crate::triangulation::topology::tet_of;
use crate::triangulation::Triangulation;

impl Triangulation {
    /// Whether a tetrahedron is neither a ghost nor labelled as outside the domain.
    #[inline]
    pub(crate) fn is_inside(&self, t: u32) -> bool {
        !self.topology.tet(t).is_ghost() && self.topology.region.get(t as usize) != Some(&OUTSIDE)
    }
}

impl Boundary {
    /// The vertices around the edge in slots `i` and `j` of tetrahedron `tet`, in the sector of that tetrahedron. Returns whether they form a
    /// ring, which they do when no subfacet is at the edge.
    pub(crate) fn sector(&self, t: &Triangulation, tet: u32, i: usize, j: usize, link: &mut Vec<u32>) -> bool {
        link.clear();
        let v = t.topology.tet(tet).v;
        let (p, q) = (v[i], v[j]);
        let is_wall = |tet: u32, k: usize, l: usize| {
            let tet = t.topology.tet(tet);
            !t.is_inside(tet_of(tet.n[k])) || self.is_subfacet([p, q, tet.v[l]])
        };
        let mut closed = true;
        for (tet, k, l) in t.topology.around_edge(tet, i, j) {
            link.push(t.topology.tet(tet).v[k]);
            if is_wall(tet, k, l) {
                link.push(t.topology.tet(tet).v[l]);
                closed = false;
                break;
            }
        }
        if closed {
            return true;
        }
        // The other way round from the same tetrahedron, up to the other wall.
        let forward = link.len();
        for (n, (tet, k, l)) in t.topology.around_edge(tet, j, i).enumerate() {
            if n > 0 {
                link.push(t.topology.tet(tet).v[l]);
            }
            if is_wall(tet, k, l) {
                break;
            }
        }
        link[forward..].reverse();
        let backward = link.len() - forward;
        link.rotate_right(backward);
        false
    }
}
