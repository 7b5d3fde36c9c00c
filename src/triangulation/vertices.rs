//! Vertex ids: which are in use, which can be had again.
//!
//! A vertex keeps its id for life. A removed one leaves a gap, whose point is NaN, and the id goes to a free list: the insertion of
//! a single point takes the id freed last, a bulk insertion numbers its points behind all others. [`compact`](Triangulation::compact)
//! closes the gaps, and where they are few the last vertices can [fill](Triangulation::fill_gaps) them.

use glam::DVec3;

use super::incident::StarWalk;
use super::topology::{Tetrahedron, NONE};
use super::Triangulation;
use crate::leavings::{InPieces, Leavings};
use crate::{memory, Control, Error};

/// The ids of removed vertices.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaps {
    /// How many ids there are without a vertex.
    count: usize,
    /// Those of them that may be used again, the next one last.
    free: Vec<u32>,
}

impl Gaps {
    /// A copy, unless memory is lacking or the control says stop.
    pub fn try_clone(&self, control: &Control) -> Result<Gaps, Error> {
        Ok(Gaps { count: self.count, free: memory::copied(&self.free, "ids", control)? })
    }
}

impl Leavings for Gaps {
    fn give_back(&mut self) -> bool {
        self.free.give_back()
    }
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

    /// Gives the last vertices the ids from `first` on that have none. Returns who has moved, from where to where. `None`, and nothing has changed, when there are more
    /// than a few such ids, or one of these vertices has very many neighbours or not what it takes to move.
    pub(crate) fn fill_gaps(&mut self, first: u32, may_move: impl Fn(u32) -> bool) -> Option<Vec<(u32, u32)>> {
        const FEW: usize = 16;
        const MANY: usize = 1 << 12;
        let mut gaps: Vec<u32> =
            (first..self.points.len() as u32).filter(|&v| !self.is_vertex(v)).take(FEW + 1).collect();
        let all_free = gaps.iter().all(|gap| self.gaps.free.contains(gap));
        if self.dimension() < 3 || gaps.len() > FEW || !all_free {
            return None;
        }
        let mut moves = Vec::new();
        let mut end = self.points.len() as u32;
        while let Some(&gap) = gaps.first() {
            end -= 1;
            if gaps.last() == Some(&end) {
                gaps.pop();
                continue;
            }
            if !may_move(end) {
                return None;
            }
            let (mut walk, mut star) = (StarWalk::new(&self.topology, end), Vec::new());
            while let Some(t) = walk.next(&self.topology) {
                if star.len() == MANY {
                    return None;
                }
                star.push(t);
            }
            gaps.remove(0);
            moves.push((end, gap, star));
        }
        for (from, to, star) in &moves {
            for &t in star {
                let v = &mut self.topology.tets[t as usize].v;
                v.iter_mut().filter(|v| **v == *from).for_each(|v| *v = *to);
            }
            self.points[*to as usize] = self.points[*from as usize];
            self.topology.vertex_tet[*to as usize] = self.topology.vertex_tet[*from as usize];
        }
        let before = self.points.len();
        self.points.truncate(end as usize);
        self.topology.vertex_tet.truncate(end as usize);
        self.gaps.free.retain(|&v| v < first);
        self.gaps.count -= before - end as usize;
        Some(moves.into_iter().map(|(from, to, _)| (from, to)).collect())
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
        match self.compacted(0, Control::never()) {
            Ok((compact, new_id)) => {
                *self = compact;
                new_id
            }
            // As other lists of Rust do that find no memory.
            Err(_) => std::alloc::handle_alloc_error(std::alloc::Layout::new::<Tetrahedron>()),
        }
    }

    /// What [`compact`](Self::compact) makes of it, but that the ids below `first`, and the gaps among them, stay as they are; and the new ids.
    /// Nothing has changed where memory is lacking or the control says stop.
    pub(crate) fn compacted(&self, first: u32, control: &Control) -> Result<(Triangulation, Vec<u32>), Error> {
        const PART: usize = 1 << 14;
        let mut new_id = memory::room_in_pieces::<u32>(self.points.len(), "ids", control)?;
        let mut compact = InPieces::new(Triangulation { threads: self.threads, ..Triangulation::default() }, control);
        memory::reserve_exact(&mut compact.points, self.points.len(), "points")?;
        for part in self.points.chunks(PART) {
            control.check()?;
            let start = compact.points.len();
            for &p in part {
                let stays = new_id.len() < first as usize;
                compact.gaps.count += usize::from(stays && p.is_nan());
                new_id.push(if p.is_nan() { NONE } else { compact.points.len() as u32 });
                if stays || !p.is_nan() {
                    compact.points.push(p);
                }
            }
            let Triangulation { points, filter, .. } = &mut *compact;
            filter.extend_all(&points[start..]);
        }
        compact.points.shrink_to_fit();
        compact.gaps.free.extend(self.gaps.free.iter().filter(|&&v| v < first));
        let count = compact.points.len();
        (compact.topology, compact.last) = self.topology.compacted(&new_id, count, self.last, control)?;
        compact.lower = if self.dimension() < 3 {
            compact.lower_without(&[], control)?.0
        } else {
            self.lower.try_clone(control)?
        };
        Ok((compact.keep(), new_id.keep()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::random_points;

    #[test]
    fn the_last_vertices_fill_gaps() {
        let points = random_points(300, 7);
        // Of the first ones the gaps stay; of the last ones nobody has to move.
        for (removed, first, moved) in [
            (vec![], 0, vec![]),
            (vec![20], 10, vec![(299, 20)]),
            (vec![5, 299, 298], 10, vec![]),
            (vec![30, 299, 12, 5, 297], 10, vec![(298, 12), (296, 30)]),
        ] {
            let mut t = Triangulation::new();
            t.insert_many(&points, &Control::new()).unwrap();
            removed.iter().for_each(|&v| t.remove(v).unwrap());
            let count = t.vertex_count();
            assert_eq!(t.fill_gaps(first, |v| v > 290), Some(moved.clone()), "{removed:?}");
            assert_eq!((t.validate(3), t.vertex_count()), (Ok(()), count));
            let gaps = removed.iter().filter(|&&v| v < first).count();
            assert_eq!(t.points().len(), count + gaps);
            let mut expected = points[..t.points().len()].to_vec();
            removed.iter().filter(|&&v| v < first).for_each(|&v| expected[v as usize] = DVec3::NAN);
            moved.iter().for_each(|&(from, to)| expected[to as usize] = points[from as usize]);
            assert!(t.points().iter().zip(&expected).all(|(p, q)| p == q || p.is_nan() && q.is_nan()));
            // The next one is new, or takes an id that was left.
            let next = t.insert(DVec3::splat(0.123), None).unwrap().vertex;
            assert_eq!(next, removed.iter().rfind(|&&v| v < first).copied().unwrap_or(count as u32));
            assert_eq!(t.validate(3), Ok(()));
        }
    }

    #[test]
    fn gaps_are_not_filled_by_those_who_may_not_move_nor_where_there_are_many() {
        let mut t = Triangulation::new();
        t.insert_many(&random_points(300, 7), &Control::new()).unwrap();
        t.remove(50).unwrap();
        let points = t.points().to_vec();
        assert_eq!(t.fill_gaps(0, |v| v != 299), None);
        (60..90).for_each(|v| t.remove(v).unwrap());
        assert_eq!(t.fill_gaps(0, |_| true), None);
        assert!(t.points()[..60].iter().zip(&points).all(|(p, q)| p == q || p.is_nan() && q.is_nan()));
        assert_eq!(t.validate(3), Ok(()));
    }
}
