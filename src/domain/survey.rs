//! How all elements of the boundary stand in the triangulation, by one walk through its tetrahedra. A search for each of them, through the tetrahedra at its
//! vertices, took a third of the time of making a domain of a scanned surface.

use super::boundary::{edge_key, face_key, places, Boundary};
use super::waiting::State;
use crate::geometry::quality::EDGES;
use crate::leavings::{InPieces, Leavings};
use crate::sorting::sort_unique;
use crate::triangulation::topology::{slot_of, tet_of, Tetrahedron, GHOST};
use crate::triangulation::Triangulation;
use crate::{memory, Control, Error};

/// Elements that don't stand as they should, each list in order.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Survey {
    /// What is not in the triangulation.
    pub missing_segments: Vec<[u32; 2]>,
    pub missing_facets: Vec<[u32; 3]>,
    /// What is, but a vertex encroaches upon it.
    pub encroached_segments: Vec<[u32; 2]>,
    pub encroached_facets: Vec<[u32; 3]>,
}

impl Leavings for Survey {
    fn give_back(&mut self) -> bool {
        self.missing_segments.give_back()
            || self.missing_facets.give_back()
            || self.encroached_segments.give_back()
            || self.encroached_facets.give_back()
    }
}

/// Edges that have been looked up last, and what segment they are of: each comes from all tetrahedra around it, most of which are not far from each other.
struct Recent(Vec<([u32; 2], Option<u32>)>);

impl Recent {
    const BITS: u32 = 12;

    fn new() -> Recent {
        Recent(vec![([GHOST; 2], None); 1 << Recent::BITS])
    }

    /// The segment of an edge, and whether the edge is not known to have come before.
    fn find(&mut self, boundary: &Boundary, edge: [u32; 2]) -> (Option<u32>, bool) {
        let [a, b] = edge;
        let place = (a.wrapping_mul(0x9e37_79b1) ^ b.wrapping_mul(0x85eb_ca77)) >> (u32::BITS - Recent::BITS);
        let entry = &mut self.0[place as usize];
        let is_new = entry.0 != edge;
        if is_new {
            *entry = (edge, boundary.subsegments.get(&edge).copied());
        }
        (entry.1, is_new)
    }
}

impl Boundary {
    /// How all elements stand; with `judge`, also whether they are encroached. Where few stand among very many tetrahedra, as the sides of a box full of points,
    /// each is searched for.
    pub(super) fn survey<'a>(
        &self,
        t: &Triangulation,
        judge: bool,
        control: &'a Control,
    ) -> Result<InPieces<'a, Survey>, Error> {
        /// A search takes as long as a look at so many tetrahedra.
        const SEARCH: usize = 128;
        if SEARCH * self.element_count() < t.topology.live_count() {
            self.survey_by_searches(t, control)
        } else {
            self.survey_by_walk(t, judge, control)
        }
    }

    /// What is encroached is always found.
    fn survey_by_searches<'a>(&self, t: &Triangulation, control: &'a Control) -> Result<InPieces<'a, Survey>, Error> {
        let mut found = InPieces::new(Survey::default(), control);
        let Survey { missing_segments, missing_facets, encroached_segments, encroached_facets } = &mut *found;
        let edges = self.subsegments.sorted_keys(control)?;
        let state_of = |edge| self.state_of_segment(t, edge, control);
        part_by_state(&edges, state_of, (missing_segments, encroached_segments), control)?;
        let faces = self.subfacets.sorted_keys(control)?;
        let state_of = |face| self.state_of_facet(t, face, control);
        part_by_state(&faces, state_of, (missing_facets, encroached_facets), control)?;
        Ok(found)
    }

    fn survey_by_walk<'a>(
        &self,
        t: &Triangulation,
        judge: bool,
        control: &'a Control,
    ) -> Result<InPieces<'a, Survey>, Error> {
        const WHAT: &str = "boundary";
        let mut found = InPieces::new(Survey::default(), control);
        let mut edges = memory::room_in_pieces::<[u32; 2]>(self.subsegments.len(), WHAT, control)?;
        let mut faces = memory::room_in_pieces::<[u32; 3]>(self.subfacets.len(), WHAT, control)?;
        let (mut recent, turns) = (Recent::new(), control.turns());
        // Each edge and each face is one of a finite tetrahedron.
        for tet in t.topology.live().filter(|&tet| !t.topology.tet(tet).is_ghost()) {
            turns.check()?;
            let Tetrahedron { v, n } = *t.topology.tet(tet);
            if !self.may_have_edge(v) {
                continue;
            }
            for (place, [i, j]) in places(self.subsegments.possible_edges(v)).map(|n| (n, EDGES[n])) {
                let edge = edge_key([v[i], v[j]]);
                let (Some(segment), is_new) = recent.find(self, edge) else { continue };
                if is_new {
                    memory::grow_long(&mut edges, 1, WHAT, control)?;
                    edges.push(edge);
                }
                if !judge {
                    continue;
                }
                // If any vertex lies in the diametral ball of an edge, one of its link does.
                let ends = edge.map(|v| t.at(v));
                let [k, l] = EDGES[EDGES.len() - 1 - place];
                if self.encroaches_part(t, (segment, ends), v[k]) || self.encroaches_part(t, (segment, ends), v[l]) {
                    memory::grow_long(&mut found.encroached_segments, 1, WHAT, control)?;
                    found.encroached_segments.push(edge);
                }
            }
            for slot in places(self.possible_walls(v)) {
                let across = tet_of(n[slot]);
                let apex = t.topology.tet(across).v[slot_of(n[slot])];
                // Once each.
                if apex != GHOST && across < tet {
                    continue;
                }
                let face = face_key(t.topology.tet(tet).face(slot));
                let Some(facet) = self.facet_of(face) else { continue };
                faces.push(face);
                if !judge {
                    continue;
                }
                // If any vertex lies in the smallest ball of a face, one of its two apices does.
                let triangle = (facet as u32, face.map(|v| t.at(v)));
                if self.encroaches_triangle(t, triangle, v[slot]) || self.encroaches_triangle(t, triangle, apex) {
                    memory::grow_long(&mut found.encroached_facets, 1, WHAT, control)?;
                    found.encroached_facets.push(face);
                }
            }
        }
        let watch = control.watch();
        sort_unique(&mut edges, &watch)?;
        sort_unique(&mut found.encroached_segments, &watch)?;
        sort_unique(&mut found.encroached_facets, &watch)?;
        if edges.len() < self.subsegments.len() {
            found.missing_segments = without(self.subsegments.sorted_keys(control)?, &edges, control)?;
        }
        if faces.len() < self.subfacets.len() {
            sort_unique(&mut faces, &watch)?;
            found.missing_facets = without(self.subfacets.sorted_keys(control)?, &faces, control)?;
        }
        Ok(found)
    }
}

/// Puts the keys of elements that are missing, and of those that are encroached, behind two lists.
fn part_by_state<K: Copy>(
    keys: &[K],
    state_of: impl Fn(K) -> Result<State, Error>,
    (missing, encroached): (&mut Vec<K>, &mut Vec<K>),
    control: &Control,
) -> Result<(), Error> {
    for &key in keys {
        control.check()?;
        match state_of(key)? {
            State::Missing => missing.push(key),
            State::Encroached => encroached.push(key),
            State::Clear => {}
        }
    }
    Ok(())
}

/// Those of some keys that are not among others; both are in order.
fn without<K: Copy + Ord + Send + 'static>(
    mut all: InPieces<'_, Vec<K>>,
    others: &[K],
    control: &Control,
) -> Result<Vec<K>, Error> {
    let (mut others, turns) = (others.iter().copied().peekable(), control.turns());
    all.retain(|&key| {
        turns.go_on() && {
            while others.next_if(|&other| other < key).is_some() {}
            others.peek() != Some(&key)
        }
    });
    turns.end()?;
    Ok(all.keep())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{prism, random_points, thin_plate};
    use crate::{DVec3, Mesh, Plc, RefineOptions};

    #[test]
    fn one_walk_finds_what_a_search_for_each_element_does() {
        let control = Control::new();
        let wedge = prism(&[[0.0, 0.0], [8.0, 0.0], [8.0, 0.5]], 3.0);
        let star = prism(&[[0.0, 0.0], [4.0, 1.0], [1.0, 1.2], [5.0, 5.0], [0.5, 2.0], [-1.0, 0.2]], 0.7);
        let filled = Plc::boxed(DVec3::ZERO, DVec3::ONE, random_points(300, 3));
        let (mut missing, mut encroached) = ([0; 2], [0; 2]);
        for plc in [wedge, star, thin_plate(), filled] {
            let parts = plc.arrange(&control).unwrap();
            let mut t = Triangulation::new();
            let ids = t.insert_many(&plc.points, &control).unwrap().unwrap();
            let boundary = Boundary::from_plc(&t, &plc, (&parts, &ids), &control).unwrap();
            let mut mesh = Mesh::from_plc(&plc, &control).unwrap();
            let options = RefineOptions { max_vertices: mesh.t.vertex_slots() + 20, ..RefineOptions::default() };
            mesh.refine(&options, &control).unwrap();
            for (boundary, t) in [(&boundary, &t), (mesh.boundary().unwrap(), &mesh.t)] {
                let found = boundary.survey_by_walk(t, true, &control).unwrap();
                assert_eq!(*found, *boundary.survey_by_searches(t, &control).unwrap());
                assert_eq!(*found, *boundary.survey(t, true, &control).unwrap());
                missing[0] += found.missing_segments.len();
                missing[1] += found.missing_facets.len();
                encroached[0] += found.encroached_segments.len();
                encroached[1] += found.encroached_facets.len();
                let present = boundary.survey_by_walk(t, false, &control).unwrap();
                assert_eq!(present.missing_segments, found.missing_segments);
                assert_eq!(present.missing_facets, found.missing_facets);
            }
        }
        assert!(missing.into_iter().chain(encroached).all(|count| count > 2), "{missing:?} {encroached:?}");
    }
}
