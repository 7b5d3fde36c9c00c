//! The tetrahedra at a vertex, one after the other, breadth first: a walk that can be left at any time and gone on with.

use super::topology::{tet_of, Topology, GHOST, NONE};
use super::Triangulation;
use crate::distinct::Distinct;
use crate::{Control, Error};

/// A walk through the tetrahedra at a vertex, ghosts included. The triangulation must stay as it is meanwhile.
pub struct StarWalk {
    vertex: u32,
    /// Those found; those before `next` have been handed out.
    star: Distinct<u32>,
    next: usize,
}

/// Room for most stars.
const FEW: usize = 48;

impl StarWalk {
    /// Starts at the vertex's own tetrahedron, if it has one.
    pub fn new(topology: &Topology, vertex: u32) -> StarWalk {
        let first = topology.vertex_tet[vertex as usize];
        let mut star = Distinct::default();
        if first != NONE {
            star.insert(first);
        }
        StarWalk { vertex, star, next: 0 }
    }

    /// The next one.
    pub fn next(&mut self, topology: &Topology) -> Option<u32> {
        let &t = self.star.list.get(self.next)?;
        self.next += 1;
        let tet = topology.tet(t);
        for slot in 0..4 {
            if tet.v[slot] != self.vertex {
                self.star.insert(tet_of(tet.n[slot]));
            }
        }
        Some(t)
    }

    /// All of them.
    pub fn all(mut self, topology: &Topology) -> Vec<u32> {
        self.star.list.reserve(FEW);
        while self.next(topology).is_some() {}
        self.star.list
    }
}

impl Triangulation {
    /// The tetrahedra at a vertex as [`Topology::star`] has them, unless the control says stop.
    pub(crate) fn star_within(&self, vertex: u32, control: &Control) -> Result<Vec<u32>, Error> {
        let (turns, mut walk) = (control.turns(), StarWalk::new(&self.topology, vertex));
        while walk.next(&self.topology).is_some() {
            turns.check()?;
        }
        Ok(walk.star.list)
    }
}

/// A search for a tetrahedron by its vertices, through the stars of all of them in turn: linear in the smallest one. It needs no coordinates, and it can
/// be left as the walks can.
pub struct Search<const N: usize> {
    vertices: [u32; N],
    walks: [Option<StarWalk>; N],
    turns: usize,
}

impl<const N: usize> Search<N> {
    /// For a tetrahedron with all of these vertices.
    pub fn new(topology: &Topology, vertices: [u32; N]) -> Search<N> {
        /// So many tetrahedra of one star are looked through before others are tried: most stars are smaller.
        const FIRST: usize = 16;
        let walks = vertices.map(|v| (v != GHOST).then(|| StarWalk::new(topology, v)));
        Search { vertices, walks, turns: FIRST }
    }

    /// Looks at so many tetrahedra of each star, and some more perhaps: what it has found, if it knows.
    pub fn look(&mut self, topology: &Topology, most: usize) -> Option<Option<u32>> {
        let Search { vertices, walks, turns } = self;
        if walks.iter().all(Option::is_none) {
            return Some(None);
        }
        let mut looked = 0;
        while looked < most {
            let now = (*turns).min(most);
            for walk in walks.iter_mut().flatten() {
                for _ in 0..now {
                    // The whole star of one of them is enough.
                    let Some(t) = walk.next(topology) else { return Some(None) };
                    let v = topology.tet(t).v;
                    if vertices.iter().all(|x| v.contains(x)) {
                        return Some(Some(t));
                    }
                }
            }
            looked += now;
            *turns = turns.saturating_mul(2);
        }
        None
    }

    /// Looks on until it knows, unless the control says stop.
    pub fn finish(mut self, topology: &Topology, control: &Control) -> Result<Option<u32>, Error> {
        /// Tetrahedra between two looks at the control.
        const PART: usize = 1 << 10;
        loop {
            if let Some(found) = self.look(topology, PART) {
                return Ok(found);
            }
            control.check()?;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Control, DVec3, Mesh};

    /// A vertex whose star holds nearly everything, and others with small ones.
    #[test]
    fn edges_and_faces_are_found_from_whichever_star_is_small() {
        let mut points = vec![DVec3::ZERO, DVec3::new(0.0, 0.0, 50.0)];
        for k in 0..300 {
            let (sin, cos) = (f64::from(k) * 2.4).sin_cos();
            let z = f64::from(k) / 150.0 - 1.0;
            points.push(DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z));
        }
        let mut mesh = Mesh::new();
        mesh.insert(&points, None, &Control::new()).unwrap();
        let topology = &mesh.triangulation().topology;
        assert!(topology.star(0).len() > 400);
        let vertices: Vec<[u32; 4]> = topology.tets.iter().filter(|tet| tet.is_live()).map(|tet| tet.v).collect();
        let is_there = |some: &[u32]| vertices.iter().any(|v| some.iter().all(|x| v.contains(x)));
        for a in (0..302).step_by(7) {
            for b in (0..302).filter(|&b| b != a) {
                let found = topology.find_edge(a, b);
                assert_eq!(found.is_some(), is_there(&[a, b]), "{a} {b}");
                assert!(found.is_none_or(|(t, i, j)| topology.tet(t).v[i] == a && topology.tet(t).v[j] == b));
                let c = (a + b) % 302;
                if c != a && c != b {
                    let found = topology.find_face([a, b, c]);
                    assert_eq!(found.is_some(), is_there(&[a, b, c]), "{a} {b} {c}");
                }
            }
        }
        for v in &vertices[..200] {
            let face = topology.find_face([v[0], v[1], v[2]]);
            assert!(face.is_some() || v[..3].contains(&super::super::topology::GHOST));
        }
    }
}
