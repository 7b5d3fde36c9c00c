//! What some insertions change, to take them back: each cavity and what is around it as they were, and what the free lists gave. That is faster than the
//! removal of the vertices, and cheaper than a copy of a triangulation that is much larger than what comes to it. Once the notes would be so many that going back by them takes
//! long, a copy of all tetrahedra takes the place of further ones.

use glam::DVec3;

use super::cavity::Cavity;
use super::lower::ByPoint;
use super::topology::{slot_of, tet_of, Tetrahedron, Topology, GHOST};
use super::Triangulation;
use crate::geometry::Filter;
use crate::{memory, Control, Error};

/// So many notes of tetrahedra take less than a millisecond to go back by.
const MANY: usize = if cfg!(test) { 1 << 12 } else { 1 << 17 };

/// The state before, as far as it has changed.
#[derive(Debug)]
pub(super) struct Journal {
    slots: usize,
    tets: usize,
    ghosts: usize,
    last: u32,
    filter: Filter,
    /// Tetrahedra and their labels, in the order in which they were changed.
    changed: Vec<(u32, Tetrahedron, u16)>,
    /// Vertices and their tetrahedra.
    incident: Vec<(u32, u32)>,
    /// Of each cavity: what of the free list stayed, and how much was taken from it.
    free: Vec<(usize, usize)>,
    /// What was taken.
    taken: Vec<u32>,
    /// Points below dimension 3, and whether they have raised it.
    lower: Vec<(DVec3, bool)>,
    /// The other points of a plane, if a volume has been spanned.
    by_point: Option<ByPoint>,
    /// All tetrahedra as they were after what is noted.
    whole: Option<Topology>,
}

impl Journal {
    /// Begins with the present state.
    pub fn new(t: &Triangulation) -> Journal {
        Journal {
            slots: t.points.len(),
            tets: t.topology.tets.len(),
            ghosts: t.topology.ghosts,
            last: t.last,
            filter: t.filter.clone(),
            changed: Vec::new(),
            incident: Vec::new(),
            free: Vec::new(),
            taken: Vec::new(),
            lower: Vec::new(),
            by_point: None,
            whole: None,
        }
    }

    /// Notes what the insertion into a cavity will change.
    pub fn note(&mut self, t: &Triangulation, cavity: &Cavity, control: &Control) -> Result<(), Error> {
        if self.by_point.is_some() || self.whole.is_some() {
            // All tetrahedra will go.
            return Ok(());
        }
        const WHAT: &str = "journal";
        let topology = &t.topology;
        if self.changed.len() + cavity.tets.len() + cavity.faces.len() > MANY {
            self.whole = Some(topology.try_clone(0, control)?);
            return Ok(());
        }
        let more = cavity.faces.len().saturating_sub(cavity.tets.len());
        let stays = topology.free.len() - more.min(topology.free.len());
        let taken = &topology.free[stays..];
        memory::reserve(&mut self.changed, cavity.tets.len() + cavity.faces.len() + taken.len(), WHAT)?;
        memory::reserve(&mut self.incident, 4 * cavity.tets.len(), WHAT)?;
        memory::reserve(&mut self.taken, taken.len(), WHAT)?;
        memory::reserve(&mut self.free, 1, WHAT)?;
        let around = cavity.faces.iter().map(|&face| tet_of(topology.tet(tet_of(face)).n[slot_of(face)]));
        for tet in cavity.tets.iter().copied().chain(around).chain(taken.iter().copied()) {
            let label = topology.region.get(tet as usize).copied().unwrap_or_default();
            self.changed.push((tet, *topology.tet(tet), label));
        }
        let vertices = cavity.tets.iter().flat_map(|&tet| topology.tet(tet).v).filter(|&v| v != GHOST);
        self.incident.extend(vertices.map(|v| (v, topology.vertex_tet[v as usize])));
        self.taken.extend_from_slice(taken);
        self.free.push((stays, topology.free.len() - stays));
        Ok(())
    }

    /// Notes a new vertex below dimension 3.
    pub fn note_lower(&mut self, p: DVec3, is_independent: bool) {
        self.lower.push((p, is_independent));
    }

    /// Notes that a volume has been spanned.
    pub fn note_raise(&mut self, by_point: ByPoint) {
        self.by_point = Some(by_point);
    }

    /// Forgets the notes.
    pub fn end(self, control: &Control) {
        if let Some(whole) = self.whole {
            control.give_back(whole);
        }
    }

    /// Takes all that was noted back.
    pub fn undo(self, t: &mut Triangulation, control: &Control) {
        if let Some(whole) = self.whole {
            control.give_back(std::mem::replace(&mut t.topology, whole));
        }
        if let Some(by_point) = self.by_point {
            t.topology.clear_tetrahedra();
            t.lower.remember_points(by_point);
        }
        let topology = &mut t.topology;
        let mut taken = &self.taken[..];
        for &(stays, count) in self.free.iter().rev() {
            let (rest, last) = taken.split_at(taken.len() - count);
            topology.free.truncate(stays);
            topology.free.extend_from_slice(last);
            taken = rest;
        }
        for &(tet, before, label) in self.changed.iter().rev() {
            topology.tets[tet as usize] = before;
            if let Some(region) = topology.region.get_mut(tet as usize) {
                *region = label;
            }
        }
        for &(v, tet) in self.incident.iter().rev() {
            topology.vertex_tet[v as usize] = tet;
        }
        topology.tets.truncate(self.tets);
        topology.region.truncate(self.tets);
        topology.ghosts = self.ghosts;
        topology.vertex_tet.truncate(self.slots);
        t.points.truncate(self.slots);
        for &(p, is_independent) in self.lower.iter().rev() {
            t.lower.take_back(p, is_independent);
        }
        (t.last, t.filter) = (self.last, self.filter);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangulation::insert::Back;
    use crate::triangulation::topology::NONE;

    fn points(count: usize, seed: u64) -> Vec<DVec3> {
        let coordinate = |i: u64| (super::super::order::splitmix(i) % 23) as f64;
        (0..count as u64)
            .map(|i| 3 * i + seed)
            .map(|i| DVec3::new(coordinate(i), coordinate(i + 1), coordinate(i + 2)))
            .collect()
    }

    /// Everything, storage included.
    fn state(t: &Triangulation) -> impl PartialEq {
        let tets: Vec<_> =
            t.topology.tets.iter().map(|tet| (tet.v, if tet.is_live() { tet.n } else { [NONE; 4] })).collect();
        let topology = (tets, t.topology.vertex_tet.clone(), t.topology.free.clone(), t.topology.ghosts);
        // NaN is not equal to itself.
        let points: Vec<_> = t.points.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
        (topology, points, t.last, t.dimension(), t.bounding_box())
    }

    fn insert(t: &mut Triangulation, list: &[DVec3], journal: &mut Journal) {
        for &p in list {
            t.insert_as((t.points.len() as u32, p), None, Back::Journal(journal), &Control::new()).unwrap();
        }
    }

    #[test]
    fn insertions_are_taken_back_to_the_last_byte() {
        for seed in 0..20 {
            let mut t = Triangulation::new();
            t.insert_many(&points(200, seed), &Control::new()).unwrap();
            // Places and ids to be used again.
            for v in (0..t.points.len() as u32).step_by(3) {
                t.remove(v).unwrap();
            }
            t.topology.region = vec![7; t.topology.tets.len()];
            let before = state(&t);
            let mut journal = Journal::new(&t);
            insert(&mut t, &points(150, seed + 1000), &mut journal);
            t.topology.region.iter_mut().for_each(|label| *label += 1);
            assert!(state(&t) != before);
            journal.undo(&mut t, &Control::new());
            assert!(state(&t) == before);
            assert_eq!(t.topology.region.len(), t.topology.tets.len());
            t.validate(3).unwrap();
        }
    }

    #[test]
    fn dimensions_are_taken_back() {
        let all = points(40, 5);
        let line: Vec<DVec3> = (0..5).map(|i| DVec3::X * f64::from(i)).collect();
        let plane: Vec<DVec3> = all.iter().map(|p| p.with_z(0.0)).collect();
        for first in [&line[..1], &line[..3], &plane[..30]] {
            let mut t = Triangulation::new();
            t.insert_many(first, &Control::new()).unwrap();
            let before = state(&t);
            let mut journal = Journal::new(&t);
            insert(&mut t, &[&line[..], &plane[..], &all[..]].concat(), &mut journal);
            assert_eq!(t.dimension(), 3);
            journal.undo(&mut t, &Control::new());
            assert!(state(&t) == before);
            // What duplicates are found by is as it was.
            let again = t.insert_many(&[first, &plane, &all].concat(), &Control::new()).unwrap().unwrap();
            assert_eq!(again[0], 0);
            t.validate(3).unwrap();
            let mut other = Triangulation::new();
            other.insert_many(&[first, &plane, &all].concat(), &Control::new()).unwrap();
            assert!(t.points() == other.points());
        }
    }
}
