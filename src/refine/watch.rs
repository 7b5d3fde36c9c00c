//! A look at the tetrahedra that an insertion has created: those to be mended are queued.
//!
//! With a very large star that takes long, and the vertex is there already: it can't be cancelled as a search can. But a refinement begins with a look at
//! all tetrahedra. So a call that is cancelled leaves the rest out and ends.

use super::queue::{shortest_edge, Queue};
use super::refiner::Refiner;
use crate::geometry::quality::{exceeds_radius_edge, four_exceed_radius_edge, in_fours};
use crate::triangulation::topology::GHOST;
use crate::triangulation::Triangulation;
use crate::Error;

/// Tetrahedra between two looks at the control: each may take tens of microseconds of exact arithmetic.
const PART: usize = 1 << 6;

impl Refiner<'_> {
    /// As a refinement with this control does.
    #[cfg(test)]
    pub(super) fn watch_with(&mut self, control: &crate::Control) {
        (self.watching, self.control) = (true, control.clone());
    }

    /// Looks at the tetrahedra that the last insertion created, that of the vertex `new`.
    pub(super) fn finish(&mut self, new: u32) -> Result<(), Error> {
        if let Some(sizes) = &mut self.sizes {
            let mut around = self.cavity.created.iter().flat_map(|&tet| self.t.topology.tet(tet).v);
            sizes.add_vertex(self.t, new, around.find(|&v| v != new && v != GHOST));
        }
        if !self.watching {
            return Ok(());
        }
        let created = std::mem::take(&mut self.cavity.created);
        let watched =
            self.in_parts(&created, Self::watch_size).and_then(|()| self.in_parts(&created, Self::watch_some));
        self.cavity.created = created;
        watched
    }

    /// Looks at some tetrahedra in parts, until a control says stop.
    fn in_parts(
        &mut self,
        some: &[u32],
        mut look: impl FnMut(&mut Self, &[u32]) -> Result<(), Error>,
    ) -> Result<(), Error> {
        for (i, part) in some.chunks(PART).enumerate() {
            self.is_cut_short |= (i > 0 || some.len() > PART) && !self.control.poll();
            if self.is_cut_short {
                break;
            }
            look(self, part)?;
        }
        Ok(())
    }

    /// Looks at tetrahedra that have changed.
    pub(super) fn watch_changed(&mut self, some: &[u32]) -> Result<(), Error> {
        self.in_parts(some, Self::watch_some)
    }

    fn watch_some(&mut self, some: &[u32]) -> Result<(), Error> {
        watch(self.t, &mut self.queue, self.radius_edge, some.iter().copied())
    }

    /// Looks at what the sparsifier has created.
    pub(super) fn watch_created(&mut self) -> Result<(), Error> {
        let t = &*self.t;
        let live = self.created.iter().copied().filter(|&tet| t.topology.tet(tet).is_live());
        watch(t, &mut self.queue, self.radius_edge, live)
    }

    /// Queues those of some tetrahedra that are in the domain and too large.
    pub(super) fn watch_size(&mut self, some: &[u32]) -> Result<(), Error> {
        let Some(sizes) = &mut self.sizes else { return Ok(()) };
        let inside: Vec<u32> = some.iter().copied().filter(|&t| self.t.is_inside(t)).collect();
        for t in sizes.too_large(self.t, &inside) {
            // A bad one is queued as such.
            if !exceeds_radius_edge(self.t.corners(t), self.radius_edge) {
                self.queue.push(self.t, t, shortest_edge(self.t, t).1)?;
            }
        }
        Ok(())
    }
}

/// Queues those tetrahedra that are in the domain and bad.
pub(super) fn watch(
    t: &Triangulation,
    queue: &mut Queue,
    radius_edge: f64,
    tets: impl Iterator<Item = u32>,
) -> Result<(), Error> {
    for (four, count) in in_fours(tets.filter(|&tet| t.is_inside(tet))) {
        let (bad, shortest) = four_exceed_radius_edge(&four.map(|tet| t.corner_refs(tet)), radius_edge);
        for i in (0..count).filter(|i| bad >> i & 1 != 0) {
            queue.push(t, four[i], shortest[i])?;
        }
    }
    Ok(())
}
