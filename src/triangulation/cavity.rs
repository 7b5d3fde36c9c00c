//! Insertion of a point as two steps: find its *cavity* (the tetrahedra whose circumspheres hold it;
//! A. Bowyer, D. F. Watson, both The Computer Journal 24, 1981), then replace the cavity by the
//! star of the point. Between the two a caller can look at what would go and what would come, and drop it.
//!
//! The marks of visited tetrahedra live in the [`Cavity`], so that finding one does not change the triangulation.

use glam::DVec3;

use super::topology::{slot_of, tet_of, Topology, GHOST, NONE};
use super::Triangulation;
use crate::geometry::perturbation::in_conflict;
use crate::geometry::{Filter, Sign};

/// The cavity of one point, and scratch memory to find the next one in.
#[derive(Clone, Debug, Default)]
pub struct Cavity {
    /// One byte a tetrahedron: whether it is in the cavity.
    marks: Vec<u8>,
    /// The tetrahedra that go.
    pub tets: Vec<u32>,
    /// The faces between the cavity and the rest: each becomes a tetrahedron with the new point.
    pub faces: Vec<CavityFace>,
    /// What the last insertion created, in the order of `faces`.
    pub created: Vec<u32>,
    edges: EdgeTable,
}

/// A face of a cavity.
#[derive(Clone, Copy, Debug)]
pub struct CavityFace {
    /// The vertices of the tetrahedron in the cavity at this face. With the new point in `slot` they are those of the
    /// tetrahedron that comes.
    pub v: [u32; 4],
    /// The slot of the vertex opposite the face.
    pub slot: u32,
    /// The face's handle outside the cavity.
    pub outside: u32,
    /// The face's handle inside it.
    pub inside: u32,
}

impl CavityFace {
    /// The face's three vertices; the ghost may be one.
    pub fn vertices(&self) -> [u32; 3] {
        let mut rest = [0; 3];
        let mut count = 0;
        for (slot, &v) in self.v.iter().enumerate() {
            if slot != self.slot as usize {
                rest[count] = v;
                count += 1;
            }
        }
        rest
    }
}

impl Cavity {
    /// Whether a tetrahedron belongs to the cavity.
    #[inline]
    pub fn contains(&self, t: u32) -> bool {
        self.marks.get(t as usize).is_some_and(|&mark| mark != 0)
    }

    /// Forgets the cavity; its memory stays for the next one.
    pub fn clear(&mut self) {
        for &t in &self.tets {
            self.marks[t as usize] = 0;
        }
        self.tets.clear();
        self.faces.clear();
    }

    /// The finite vertices around the cavity, each once or more often.
    pub fn rim(&self) -> impl Iterator<Item = u32> + '_ {
        self.faces.iter().flat_map(|face| face.vertices()).filter(|&v| v != GHOST)
    }
}

impl Triangulation {
    /// Whether `p` lies inside the circumsphere of tetrahedron `t`, after perturbation; for a ghost, whether it lies beyond the
    /// hull facet, or on its plane and inside its circle.
    #[inline]
    pub(crate) fn conflicts(&self, filter: &Filter, t: u32, p: DVec3) -> bool {
        let tet = self.topology.tet(t);
        let [a, b, c] = [tet.v[0], tet.v[1], tet.v[2]].map(|v| self.points[v as usize]);
        if tet.is_ghost() {
            return match filter.orient3d(a, b, c, p) {
                Sign::Positive => true,
                Sign::Negative => false,
                // On the facet's plane the circle decides, and every sphere through it has the same answer there, perturbed or not:
                // the coefficient of a fourth corner is the orientation of the facet and p, which is 0.
                Sign::Zero => {
                    let inner = self.topology.tet(tet_of(tet.n[3]));
                    in_conflict(filter, inner.v.map(|v| self.points[v as usize]), p)
                }
            };
        }
        in_conflict(filter, [a, b, c, self.points[tet.v[3] as usize]], p)
    }

    /// Finds the cavity of `p`, starting from a tetrahedron in conflict with it. `p` must not be a vertex; the
    /// filter covers the triangulation and `p`.
    pub(crate) fn find_cavity(&self, filter: &Filter, p: DVec3, start: u32, cavity: &mut Cavity) {
        cavity.clear();
        if cavity.marks.len() < self.topology.tets.len() {
            cavity.marks.resize(self.topology.tets.capacity().max(64), 0);
        }
        debug_assert!(self.conflicts(filter, start, p));
        cavity.marks[start as usize] = 1;
        cavity.tets.push(start);
        let mut next = 0;
        while next < cavity.tets.len() {
            let t = cavity.tets[next];
            next += 1;
            let tet = *self.topology.tet(t);
            for slot in 0..4 {
                let outside = tet.n[slot];
                let neighbour = tet_of(outside);
                if cavity.marks[neighbour as usize] != 0 {
                    continue;
                }
                if self.conflicts(filter, neighbour, p) {
                    cavity.marks[neighbour as usize] = 1;
                    cavity.tets.push(neighbour);
                } else {
                    cavity.faces.push(CavityFace { v: tet.v, slot: slot as u32, outside, inside: 4 * t + slot as u32 });
                }
            }
        }
    }

    /// Replaces the cavity by the star of vertex `new`, whose point is in place. `cavity.created` names the new tetrahedra.
    pub(crate) fn fill_cavity(&mut self, new: u32, cavity: &mut Cavity) {
        let topology = &mut self.topology;
        let labelled = !topology.region.is_empty();
        cavity.created.clear();
        if labelled {
            // Slots are reused at once: read the labels before they are overwritten.
            cavity.edges.labels.clear();
            cavity.edges.labels.extend(cavity.faces.iter().map(|f| topology.region[tet_of(f.inside) as usize]));
        }
        for &t in &cavity.tets {
            cavity.marks[t as usize] = 0;
        }
        // Last destroyed is first reused: go backwards, so that the free list is taken in the order of the cavity.
        for &t in cavity.tets.iter().rev() {
            topology.destroy(t);
        }
        for face in &cavity.faces {
            let mut v = face.v;
            v[face.slot as usize] = new;
            let t = topology.create(v);
            cavity.created.push(t);
            topology.join(4 * t + face.slot, face.outside);
        }
        if labelled {
            for (&t, &label) in cavity.created.iter().zip(&cavity.edges.labels) {
                topology.region[t as usize] = label;
            }
        }
        cavity.edges.join_star(topology, &cavity.faces, &cavity.created);
        topology.vertex_tet[new as usize] = cavity.created[0];
        cavity.tets.clear();
        cavity.faces.clear();
    }
}

/// Finds the pairs of new tetrahedra that share an edge of the cavity's surface.
///
/// Vertices get small labels, stored for the time being where their incident tetrahedron stands (it changes
/// anyway), and a square table holds the face that each directed edge belongs to. Each edge of the surface occurs once in
/// either direction, so that the table is written in one pass and read in a second, without clearing or branches.
#[derive(Clone, Debug, Default)]
struct EdgeTable {
    table: Vec<u32>,
    /// The labels of each face's slots.
    local: Vec<[u16; 4]>,
    sorted: Vec<(u64, u32)>,
    labels: Vec<u16>,
}

/// Marks a label among incident tetrahedra.
const LABEL: u32 = 1 << 31;
/// Table sizes: most cavities have fewer than 32 vertices. The ghost's label is 0.
const SMALL: usize = 32;
const LARGE: usize = 256;

/// For each slot of the new vertex and each other slot `j`, the surface edge (its two slots) of the face opposite `j`, directed as
/// in the face's boundary.
const SURFACE_EDGES: [[(usize, usize, usize); 3]; 4] = {
    let mut result = [[(0, 0, 0); 3]; 4];
    let mut i = 0;
    while i < 4 {
        let (mut j, mut n) = (0, 0);
        while j < 4 {
            if j != i {
                let [k, l] = super::topology::EVEN_REST[i][j];
                result[i][n] = (j, k, l);
                n += 1;
            }
            j += 1;
        }
        i += 1;
    }
    result
};

impl EdgeTable {
    fn join_star(&mut self, topology: &mut Topology, faces: &[CavityFace], created: &[u32]) {
        let mut count = 1u32;
        self.local.clear();
        for face in faces {
            let mut local = [0; 4];
            for (slot, &v) in face.v.iter().enumerate() {
                if slot == face.slot as usize || v == GHOST {
                    continue;
                }
                let entry = &mut topology.vertex_tet[v as usize];
                if *entry & LABEL == 0 || *entry == NONE {
                    *entry = LABEL | count;
                    count += 1;
                }
                local[slot] = *entry as u16;
            }
            self.local.push(local);
        }
        match count as usize {
            n if n <= SMALL => self.join_by_table::<SMALL>(topology, faces, created),
            n if n <= LARGE => self.join_by_table::<LARGE>(topology, faces, created),
            _ => self.join_by_sorting(topology, faces, created),
        }
        for (face, &t) in faces.iter().zip(created) {
            for (slot, &v) in face.v.iter().enumerate() {
                if slot != face.slot as usize && v != GHOST {
                    topology.vertex_tet[v as usize] = t;
                }
            }
        }
    }

    fn join_by_table<const SIZE: usize>(&mut self, topology: &mut Topology, faces: &[CavityFace], created: &[u32]) {
        if self.table.len() < SIZE * SIZE {
            self.table.resize(SIZE * SIZE, NONE);
        }
        let table = &mut self.table[..SIZE * SIZE];
        let at = |k: u16, l: u16| k as usize % SIZE * SIZE + l as usize % SIZE;
        for ((face, local), &t) in faces.iter().zip(&self.local).zip(created) {
            for (j, k, l) in SURFACE_EDGES[face.slot as usize] {
                table[at(local[k], local[l])] = 4 * t + j as u32;
            }
        }
        for ((face, local), &t) in faces.iter().zip(&self.local).zip(created) {
            for (j, k, l) in SURFACE_EDGES[face.slot as usize] {
                topology.tets[t as usize].n[j] = table[at(local[l], local[k])];
            }
        }
    }

    /// For cavities of any size: the two faces of an edge become neighbours in sorted order.
    fn join_by_sorting(&mut self, topology: &mut Topology, faces: &[CavityFace], created: &[u32]) {
        self.sorted.clear();
        for (face, &t) in faces.iter().zip(created) {
            for (j, k, l) in SURFACE_EDGES[face.slot as usize] {
                let (k, l) = (face.v[k].min(face.v[l]), face.v[k].max(face.v[l]));
                self.sorted.push((u64::from(k) << 32 | u64::from(l), 4 * t + j as u32));
            }
        }
        self.sorted.sort_unstable();
        for pair in self.sorted.chunks_exact(2) {
            debug_assert_eq!(pair[0].0, pair[1].0);
            topology.join(pair[0].1, pair[1].1);
        }
        debug_assert!(created.iter().all(|&t| (0..4).all(|slot| slot_of(topology.tet(t).n[slot]) < 4)));
    }
}
