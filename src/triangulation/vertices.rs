//! Vertex ids: which are in use, which can be had again.
//!
//! A vertex keeps its id for life. A removed one leaves a gap, whose point is NaN, and the id goes to a free list: the insertion of
//! a single point takes the id freed last, a bulk insertion numbers its points behind all others. [`compact`](Triangulation::compact)
//! closes the gaps.

use glam::DVec3;

use super::topology::{Tetrahedron, NONE};
use super::Triangulation;
use crate::geometry::Filter;
use crate::{memory, Error};

/// The ids of removed vertices.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaps {
    /// How many ids there are without a vertex.
    count: usize,
    /// Those of them that may be used again, the next one last.
    free: Vec<u32>,
}

impl Triangulation {
    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.points.len() - self.gaps.count
    }

    /// All vertex ids are below this: the length of arrays that are indexed by them. More than the vertices after removals.
    pub fn vertex_slots(&self) -> usize {
        self.points.len()
    }

    /// Whether the id is a vertex: given to one and not removed since.
    #[inline]
    pub fn is_vertex(&self, vertex: u32) -> bool {
        self.points.get(vertex as usize).is_some_and(|p| !p.is_nan())
    }

    /// The ids of all vertices, in order.
    pub fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.points.len() as u32).filter(|&v| self.is_vertex(v))
    }

    /// The points, by vertex id; NaN where a vertex was removed.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// The point of a vertex.
    pub fn point(&self, vertex: u32) -> Option<DVec3> {
        self.points.get(vertex as usize).copied().filter(|p| !p.is_nan())
    }

    /// The id that a single new vertex will have: the one freed last, or else a new one.
    pub(crate) fn next_vertex(&self) -> u32 {
        self.gaps.free.last().copied().unwrap_or(self.points.len() as u32)
    }

    /// Memory for one more vertex.
    #[inline]
    pub(super) fn reserve_vertex(&mut self) -> Result<(), Error> {
        if self.points.len() < self.points.capacity() {
            return Ok(());
        }
        memory::reserve(&mut self.points, 1, "points")?;
        memory::reserve(&mut self.topology.vertex_tet, 1, "vertices")
    }

    /// Stores a point at [`next_vertex`](Self::next_vertex), or behind all others. No tetrahedron knows of it yet.
    #[inline]
    pub(super) fn store(&mut self, vertex: u32, point: DVec3) {
        if vertex as usize == self.points.len() {
            self.points.push(point);
            self.topology.vertex_tet.push(NONE);
        } else {
            let freed = self.gaps.free.pop();
            debug_assert_eq!(freed, Some(vertex));
            self.gaps.count -= 1;
            self.points[vertex as usize] = point;
        }
    }

    /// Takes back [`store`](Self::store); `slots` is the number of slots before it.
    pub(super) fn unstore(&mut self, vertex: u32, slots: usize) {
        if vertex as usize >= slots {
            self.points.truncate(slots);
            self.topology.vertex_tet.truncate(slots);
        } else {
            self.free_vertex(vertex);
        }
    }

    /// Frees the id of a vertex that no tetrahedron has any more.
    pub(super) fn free_vertex(&mut self, vertex: u32) {
        self.points[vertex as usize] = DVec3::NAN;
        self.topology.vertex_tet[vertex as usize] = NONE;
        self.gaps.free.push(vertex);
        self.gaps.count += 1;
    }

    /// Leaves the present gaps for good: vertices from now on have ids above all present ones.
    pub(crate) fn retire_free_ids(&mut self) {
        self.gaps.free = Vec::new();
    }

    /// Calls `f` with the point of id `vertex` in place, which need not be a vertex yet.
    pub(crate) fn with_point<R>(&mut self, vertex: u32, point: DVec3, f: impl FnOnce(&Triangulation) -> R) -> R {
        if vertex as usize == self.points.len() {
            self.points.push(point);
            let result = f(self);
            self.points.pop();
            return result;
        }
        let before = std::mem::replace(&mut self.points[vertex as usize], point);
        let result = f(self);
        self.points[vertex as usize] = before;
        result
    }

    /// Closes the gaps that removed vertices and tetrahedra have left, and gives their memory back. Vertices keep their order. Returns the
    /// new id of each old one, `u32::MAX` for those removed. The bounding box becomes that of the present points.
    ///
    /// Cost: linear.
    pub fn compact(&mut self) -> Vec<u32> {
        self.compact_from(0)
    }

    /// Whether there is memory to [`compact_from`](Self::compact_from), which would end the process without.
    pub(crate) fn reserve_compact(&self) -> Result<(), Error> {
        // Two numbers a vertex and one a tetrahedron, and the shrunken lists.
        let (vertices, tets) = (self.points.len(), self.topology.tets.len());
        drop(memory::with_room::<[u32; 2]>(vertices + tets, "ids")?);
        drop(memory::with_room::<Tetrahedron>(tets, "tetrahedra")?);
        Ok(())
    }

    /// [`compact`](Self::compact) that leaves the ids below `first`, and the gaps among them, as they are.
    pub(crate) fn compact_from(&mut self, first: u32) -> Vec<u32> {
        let mut new_id = vec![NONE; self.points.len()];
        let mut next = 0;
        let mut count = 0;
        for (v, p) in self.points.iter().enumerate() {
            if v < first as usize {
                next = v as u32 + 1;
                count += usize::from(p.is_nan());
            }
            if !p.is_nan() {
                new_id[v] = if v < first as usize { v as u32 } else { next };
                next = new_id[v] + 1;
            }
        }
        let mut v = 0;
        self.points.retain(|p| {
            v += 1;
            v <= first || !p.is_nan()
        });
        self.points.shrink_to_fit();
        self.gaps.free.retain(|&v| v < first);
        self.gaps.count = count;
        self.last = self.topology.compact(&new_id, self.points.len(), self.last);
        if self.dimension() < 3 {
            self.rebuild_lower();
        } else {
            self.filter = Filter::for_points(&self.points);
        }
        new_id
    }
}
