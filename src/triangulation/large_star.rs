//! The stars of large cavities, in parts. A vertex in the middle of a million others on a sphere gets two million tetrahedra. How they are linked is
//! planned before anything changes, then they are written, and a control can cancel both. In the middle of writing they are no triangulation: who may be
//! cancelled there has [a copy to go back to](super::kept), or gives all of it up.
//!
//! The three edges of each of the cavity's faces are sorted, by the [labels](super::labels) of their vertices and in linear time, so that the two faces
//! at an edge come one after the other.

use super::cavity::Cavity;
use super::labels::Labels;
use super::site::Site;
use super::star::REST;
use super::topology::{slot_of, tet_of, Tetrahedron, EVEN_REST, GHOST};
use super::Triangulation;
use crate::leavings::Leavings;
use crate::{memory, Control, Error};

/// Faces, edges or tetrahedra between two looks at the control.
const PART: usize = 1 << 12;

/// An edge of one of the cavity's faces.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    /// The labels of its vertices, counted from 0, the lower one first.
    ends: [u32; 2],
    /// The new tetrahedron's face at it: four times the position in the plan, and the slot.
    face: u32,
}

/// The star to come, and scratch memory to plan the next one in.
#[derive(Clone, Debug, Default)]
pub(super) struct LargeStar {
    /// In the order of the cavity's faces. The new vertex's slot has the old one still, and the neighbour outside the cavity; the other
    /// neighbours are faces in the plan.
    planned: Vec<Tetrahedron>,
    ghosts: usize,
    sides: Vec<Side>,
    sorted: Vec<Side>,
    /// By label: where the next side with it goes.
    places: Vec<u32>,
}

impl LargeStar {
    /// Plans the star that replaces a cavity with these faces. After an error there is no plan.
    ///
    /// # Safety
    /// The faces are those of a cavity of `site` as it is, and the labels are its.
    #[cold]
    pub unsafe fn plan(&mut self, site: Site, faces: &[u32], labels: &Labels, control: &Control) -> Result<(), Error> {
        self.ghosts = 0;
        memory::reserve_anew(&mut self.planned, faces.len(), "star", control)?;
        memory::reserve_anew(&mut self.sides, 3 * faces.len(), "star", control)?;
        for part in faces.chunks(PART) {
            control.check()?;
            for &face in part {
                // SAFETY: a tetrahedron of the cavity.
                let (mut tet, slot) = (*unsafe { site.tet(tet_of(face)) }, slot_of(face));
                let position = self.planned.len() as u32;
                for j in REST.map(|other| slot ^ other) {
                    let [k, l] = EVEN_REST[slot][j].map(|i| labels.number(tet.v[i]) as u32);
                    self.sides.push(Side { ends: [k.min(l), k.max(l)], face: 4 * position + j as u32 });
                }
                self.ghosts += usize::from(tet.face(slot).contains(&GHOST));
                tet.n = [tet.n[slot]; 4];
                self.planned.push(tet);
            }
        }
        self.sort(1, labels.count(), control)?;
        self.sort(0, labels.count(), control)?;
        for part in self.sides.chunks(PART) {
            control.check()?;
            for pair in part.chunks_exact(2) {
                debug_assert_eq!(pair[0].ends, pair[1].ends);
                for (from, to) in [(pair[0].face, pair[1].face), (pair[1].face, pair[0].face)] {
                    self.planned[tet_of(from) as usize].n[slot_of(from)] = to;
                }
            }
        }
        Ok(())
    }

    /// Sorts the sides by one of their ends; those that agree in it stay in their order.
    fn sort(&mut self, end: usize, labels: usize, control: &Control) -> Result<(), Error> {
        let LargeStar { sides, sorted, places, .. } = self;
        places.clear();
        memory::lengthen(places, labels + 1, 0, "star", control)?;
        memory::reserve_anew(sorted, sides.len(), "star", control)?;
        for part in sides.chunks(PART) {
            control.check()?;
            part.iter().for_each(|side| places[side.ends[end] as usize + 1] += 1);
            // Its memory is touched for the first time in parts as well.
            sorted.resize((sorted.len() + PART).min(sides.len()), Side::default());
        }
        let mut before = 0;
        for part in places.chunks_mut(PART) {
            control.check()?;
            for place in part {
                before += *place;
                *place = before;
            }
        }
        for part in sides.chunks(PART) {
            control.check()?;
            for &side in part {
                let place = &mut places[side.ends[end] as usize];
                sorted[*place as usize] = side;
                *place += 1;
            }
        }
        std::mem::swap(sides, sorted);
        Ok(())
    }

    /// Writes the planned star of vertex `new` to the places in `created`. Returns how many ghosts it has. When the control says stop, some of it is
    /// written and the rest is not.
    ///
    /// # Safety
    /// The faces are those that it was planned for, and nothing has changed since. Their tetrahedra, those beyond them, and what is at the places are
    /// nobody else's.
    #[cold]
    pub unsafe fn write(
        &self,
        site: Site,
        new: u32,
        faces: &[u32],
        created: &[u32],
        control: &Control,
    ) -> Result<usize, Error> {
        debug_assert!(self.planned.len() == faces.len() && created.len() == faces.len());
        for (i, ((planned, &t), &face)) in self.planned.iter().zip(created).zip(faces).enumerate() {
            if i % PART == 0 {
                control.check()?;
            }
            let slot = slot_of(face);
            let mut tet = *planned;
            tet.v[slot] = new;
            for j in REST.map(|other| slot ^ other) {
                tet.n[j] = 4 * created[tet_of(tet.n[j]) as usize] + slot_of(tet.n[j]) as u32;
            }
            // SAFETY: a place of the star, and a neighbour of the cavity.
            unsafe {
                site.put(t, tet);
                site.link(tet.n[slot], 4 * t + slot as u32);
            }
        }
        Ok(self.ghosts)
    }
}

impl Triangulation {
    /// [`fill_cavity`](Self::fill_cavity) for a planned one. After an error, a cancellation or a lack of memory for lists, tetrahedra and cavity are good
    /// for nothing any more but to be cleared.
    #[cold]
    #[inline(never)]
    pub(super) fn fill_large(
        &mut self,
        new: u32,
        cavity: &mut Cavity,
        incidence: bool,
        control: &Control,
    ) -> Result<(), Error> {
        let topology = &mut self.topology;
        let count = cavity.faces.len();
        for part in cavity.tets.chunks(PART) {
            control.check()?;
            topology.ghosts -= part.iter().filter(|&&t| topology.tets[t as usize].is_ghost()).count();
        }
        topology.allocate_within(&cavity.tets, count, &mut cavity.created, control)?;
        if !topology.region.is_empty() {
            // Places are used again at once: read the labels before they are written over.
            let regions = &mut cavity.star.regions;
            regions.clear();
            memory::reserve(regions, count, "regions")?;
            for part in cavity.faces.chunks(PART) {
                control.check()?;
                regions.extend(part.iter().map(|&face| topology.region[tet_of(face) as usize]));
            }
            for (created, regions) in cavity.created.chunks(PART).zip(regions.chunks(PART)) {
                control.check()?;
                created.iter().zip(regions).for_each(|(&t, &region)| topology.region[t as usize] = region);
            }
        }
        // SAFETY: the cavity is one of this triangulation, which has not changed since, and this is its only user.
        topology.ghosts += unsafe { cavity.fill(Site::new(&mut topology.tets, &self.points), new, control) }?;
        let unused = &cavity.tets[count.min(cavity.tets.len())..];
        for part in unused.rchunks(PART) {
            control.check()?;
            topology.release(part, 0);
        }
        if incidence {
            for part in cavity.created.chunks(PART) {
                control.check()?;
                topology.name_incident(part);
            }
            topology.vertex_tet[new as usize] = cavity.created[0];
        }
        cavity.clear_lists();
        Ok(())
    }
}

impl Leavings for LargeStar {
    fn give_back(&mut self) -> bool {
        self.planned.give_back() || self.sides.give_back() || self.sorted.give_back()
    }
}
