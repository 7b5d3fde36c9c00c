//! The boundary of a host's mesh, found in its arrays: every face without a second tetrahedron and every face that the host names is a
//! subfacet, and edges at which they don't just go on within one facet are subsegments.
//!
//! What the refinement of our own remembers of the input is seen from the faces' facet numbers here: a vertex of three facets or more is a
//! corner, one of two lies on a segment. Small input angles are treated as there (see `domain::acute`).

use rustc_hash::FxHashMap;

use super::topology::{face_key, Cavity, Mesh, NONE};
use super::Arrays;
use crate::distinct::Distinct;
use crate::domain::acute::{is_acute, Carrier};
use crate::domain::boundary::{edge_key, Encroached};
use crate::geometry::circumsphere::triangle_circumcenter;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::predicates::orient3d;
use crate::geometry::quality::EDGES;
use crate::geometry::Sign;
use crate::sorting::sort;
use crate::triangulation::topology::{tet_of, EVEN_REST};
use crate::{Control, DVec3, Error};

const ON_SEGMENT: u8 = 1;
const ON_FACET: u8 = 2;
const ACUTE: u8 = 4;

/// A subfacet.
#[derive(Clone, Copy, Debug)]
struct Subfacet {
    facet: u32,
    /// A side of it.
    handle: u32,
}

/// A subsegment: its segment, and a tetrahedron at it.
#[derive(Clone, Copy, Debug)]
struct Subsegment {
    segment: u32,
    tet: u32,
}

/// Subfacets and subsegments of a mesh.
#[derive(Debug, Default)]
pub struct Boundary {
    kinds: Vec<u8>,
    subfacets: FxHashMap<[u32; 3], Subfacet>,
    subsegments: FxHashMap<[u32; 2], Subsegment>,
    /// What the vertices on the boundary lie on.
    carriers: FxHashMap<u32, Carrier>,
    /// The ends of each segment, and its facets.
    segments: Vec<([u32; 2], Vec<u32>)>,
    /// The corners of each facet.
    corners: Vec<Vec<u32>>,
}

fn find(parent: &mut [u32], mut x: u32) -> u32 {
    while parent[x as usize] != x {
        parent[x as usize] = parent[parent[x as usize] as usize];
        x = parent[x as usize];
    }
    x
}

fn unite(parent: &mut [u32], x: u32, y: u32) {
    let (x, y) = (find(parent, x), find(parent, y));
    // The lower one stays, so that numbers don't depend on the order.
    parent[x.max(y) as usize] = x.min(y);
}

/// The sides of a face as edges in order, each with the vertex opposite.
fn sides([a, b, c]: [u32; 3]) -> [([u32; 2], u32); 3] {
    [(edge_key([a, b]), c), (edge_key([b, c]), a), (edge_key([c, a]), b)]
}

impl Boundary {
    /// Finds the boundary. An error names a face of the host's that the mesh has not.
    pub(super) fn new(mesh: &Mesh<'_>, arrays: &Arrays<'_>, control: &Control) -> Result<Boundary, Error> {
        let mut boundary = Boundary { kinds: vec![0; mesh.points.len()], ..Boundary::default() };
        let (faces, numbers) = boundary.collect(mesh, arrays, control)?;
        if faces.is_empty() {
            return Ok(boundary);
        }
        let keys: Vec<[u32; 3]> = faces.iter().map(|&f| face_key(mesh.face(f))).collect();
        // All sides, those of one edge together.
        let mut edges: Vec<([u32; 2], u32)> =
            keys.iter().enumerate().flat_map(|(i, &key)| sides(key).map(|(edge, _)| (edge, i as u32))).collect();
        sort(&mut edges, &control.watch())?;
        let facets = group(mesh, &keys, &numbers, &edges);
        let turns = control.turns();
        for (i, &key) in keys.iter().enumerate() {
            turns.check()?;
            boundary.subfacets.insert(key, Subfacet { facet: facets[i], handle: faces[i] });
            for v in key {
                boundary.kinds[v as usize] |= ON_FACET;
            }
        }
        boundary.find_segments(mesh, &faces, &facets, &edges);
        control.check()?;
        Ok(boundary)
    }

    /// One handle for each boundary face, with the host's number for its facet if it has one.
    fn collect(
        &mut self,
        mesh: &Mesh<'_>,
        arrays: &Arrays<'_>,
        control: &Control,
    ) -> Result<(Vec<u32>, Vec<Option<u32>>), Error> {
        let turns = control.turns();
        if !arrays.facets.is_empty() && arrays.facets.len() != arrays.faces.len() {
            let (n, m) = (arrays.facets.len(), arrays.faces.len());
            return Err(Error::InvalidMesh { problem: format!("there are {n} facet numbers for {m} faces") });
        }
        let mut given: FxHashMap<[u32; 3], (u32, Option<u32>)> = FxHashMap::default();
        let mut listed = vec![false; mesh.points.len()];
        for (i, &face) in arrays.faces.iter().enumerate() {
            turns.check()?;
            if let Some(v) = face.into_iter().find(|&v| v as usize >= listed.len()) {
                let problem = format!("face {i} names vertex {v}, but there are only {}", listed.len());
                return Err(Error::InvalidMesh { problem });
            }
            face.iter().for_each(|&v| listed[v as usize] = true);
            given.insert(face_key(face), (NONE, arrays.facets.get(i).copied()));
        }
        let mut faces = Vec::new();
        let mut numbers = Vec::new();
        for face in 0..4 * mesh.tets.len() as u32 {
            turns.check()?;
            if mesh.is_left_out(tet_of(face)) {
                continue;
            }
            let across = mesh.across(face);
            let vertices = mesh.face(face);
            let entry = match vertices.iter().all(|&v| listed[v as usize]) {
                true => given.get_mut(&face_key(vertices)),
                false => None,
            };
            // Inner faces once, from the lower side.
            if across != NONE && (across < face || entry.is_none()) {
                continue;
            }
            faces.push(face);
            numbers.push(entry.and_then(|entry| {
                entry.0 = face;
                entry.1
            }));
        }
        if let Some(i) = arrays.faces.iter().position(|&face| given[&face_key(face)].0 == NONE) {
            let problem = format!("face {i} {:?} is no face of a tetrahedron", arrays.faces[i]);
            return Err(Error::InvalidMesh { problem });
        }
        Ok((faces, numbers))
    }

    /// Segments: chains of edges between facets.
    fn find_segments(&mut self, mesh: &Mesh<'_>, faces: &[u32], facets: &[u32], edges: &[([u32; 2], u32)]) {
        // Subsegments with the facets at them.
        let mut parts: Vec<([u32; 2], Vec<u32>, u32)> = Vec::new();
        for at_edge in edges.chunk_by(|e, f| e.0 == f.0) {
            let mut around: Vec<u32> = at_edge.iter().map(|&(_, i)| facets[i as usize]).collect();
            if let [f, g] = around[..] {
                if f == g {
                    continue;
                }
            }
            around.sort_unstable();
            around.dedup();
            parts.push((at_edge[0].0, around, tet_of(faces[at_edge[0].1 as usize])));
        }
        let mut at_vertex: Vec<(u32, u32)> =
            parts.iter().enumerate().flat_map(|(i, (edge, ..))| edge.map(|v| (v, i as u32))).collect();
        at_vertex.sort_unstable();
        let mut parent: Vec<u32> = (0..parts.len() as u32).collect();
        let mut ends = Vec::new();
        for group in at_vertex.chunk_by(|a, b| a.0 == b.0) {
            let v = group[0].0;
            self.kinds[v as usize] |= ON_SEGMENT;
            let direction = |&(_, i): &(u32, u32)| {
                let [a, b] = parts[i as usize].0;
                (mesh.at(if a == v { b } else { a }) - mesh.at(v)).normalize_or_zero()
            };
            let directions: Vec<DVec3> = group.iter().map(direction).collect();
            let acute = |(i, u): (usize, &DVec3)| directions[..i].iter().any(|w| u.dot(*w) > 0.5 + 1e-9);
            if directions.iter().enumerate().any(acute) {
                self.kinds[v as usize] |= ACUTE;
            }
            match *group {
                [(_, i), (_, j)]
                    if parts[i as usize].1 == parts[j as usize].1 && directions[0].dot(directions[1]) < -1.0 + 1e-9 =>
                {
                    unite(&mut parent, i, j);
                }
                _ => ends.push(v),
            }
        }
        let mut number = vec![NONE; parts.len()];
        for (i, (edge, around, tet)) in parts.iter().enumerate() {
            let root = find(&mut parent, i as u32) as usize;
            if number[root] == NONE {
                number[root] = self.segments.len() as u32;
                self.segments.push(([NONE; 2], around.clone()));
            }
            let segment = number[root];
            self.subsegments.insert(*edge, Subsegment { segment, tet: *tet });
            for v in *edge {
                if ends.binary_search(&v).is_ok() {
                    self.carriers.insert(v, Carrier::Vertex(v));
                    let ends = &mut self.segments[segment as usize].0;
                    let free = usize::from(ends[0] != NONE);
                    ends[free] = v;
                } else {
                    self.carriers.insert(v, Carrier::Segment(segment));
                }
            }
        }
        self.corners = vec![Vec::new(); facets.iter().max().map_or(0, |&f| f as usize + 1)];
        for (&face, &facet) in faces.iter().zip(facets) {
            for v in mesh.face(face) {
                match self.carriers.entry(v).or_insert(Carrier::Facet(facet)) {
                    Carrier::Vertex(_) if !self.corners[facet as usize].contains(&v) => {
                        self.corners[facet as usize].push(v);
                    }
                    _ => {}
                }
            }
        }
        self.corners.iter_mut().for_each(|corners| corners.sort_unstable());
    }

    fn kind(&self, v: u32) -> u8 {
        self.kinds[v as usize]
    }

    /// Whether a face of the mesh is a subfacet or has no other side.
    pub(super) fn is_wall(&self, mesh: &Mesh<'_>, face: u32) -> bool {
        mesh.across(face) == NONE || self.facet(mesh.face(face)).is_some()
    }

    /// The facet that a face is of.
    pub(super) fn facet(&self, face: [u32; 3]) -> Option<u32> {
        let on_facet = face.iter().all(|&v| self.kind(v) & ON_FACET != 0);
        on_facet.then(|| self.subfacets.get(&face_key(face)).map(|s| s.facet)).flatten()
    }

    /// A tetrahedron at a subsegment.
    pub(super) fn at_segment(&self, edge: [u32; 2]) -> Option<u32> {
        self.subsegments.get(&edge).map(|s| s.tet)
    }

    /// A side of a subfacet.
    pub(super) fn at_facet(&self, face: [u32; 3]) -> Option<u32> {
        self.subfacets.get(&face).map(|s| s.handle)
    }

    /// What a point encroaches upon around its cavity.
    pub(super) fn encroached_by(
        &self,
        mesh: &Mesh<'_>,
        p: DVec3,
        cavity: &Cavity,
        control: &Control,
    ) -> Result<Encroached, Error> {
        let (mut segments, mut facets) = (Distinct::default(), Distinct::default());
        let turns = control.turns();
        for &t in &cavity.tets {
            turns.check()?;
            let v = mesh.tets[t as usize];
            let kinds = v.map(|v| self.kind(v));
            for [i, j] in EDGES {
                let key = edge_key([v[i], v[j]]);
                if kinds[i] & kinds[j] & ON_SEGMENT != 0
                    && self.subsegments.contains_key(&key)
                    && !segments.contains(key)
                    && encroaches_segment(key.map(|v| mesh.at(v)), p)
                {
                    segments.insert(key);
                }
            }
            for slot in 0..4 {
                let face = mesh.face(4 * t + slot);
                if self.facet(face).is_none() {
                    continue;
                }
                let key = face_key(face);
                if !facets.contains(key) && encroaches_facet(key.map(|v| mesh.at(v)), p) {
                    facets.insert(key);
                }
            }
        }
        let mut found = Encroached::default();
        (found.segments, found.facets) = (segments.list, facets.list);
        Ok(found)
    }

    /// The first subsegment on the way through the facet from a subfacet to a point in its plane: there the facet ends.
    pub(super) fn hides(
        &self,
        mesh: &Mesh<'_>,
        face: [u32; 3],
        p: DVec3,
        control: &Control,
    ) -> Result<Option<[u32; 2]>, Error> {
        let Some(mut handle) = self.at_facet(face) else { return Ok(None) };
        let mut entry = [NONE; 2];
        let turns = control.turns();
        // No way is longer, and rounding may lead it in a circle.
        for _ in 0..self.subfacets.len() {
            turns.check()?;
            let beyond = |&(edge, opposite): &([u32; 2], u32)| {
                let [a, b] = edge.map(|v| mesh.at(v));
                let along = (b - a).normalize_or_zero();
                let side = |q: DVec3| (q - a).reject_from_normalized(along);
                edge != entry && side(p).dot(side(mesh.at(opposite))) < 0.0
            };
            let Some((edge, opposite)) = sides(face_key(mesh.face(handle))).into_iter().find(beyond) else { break };
            if self.subsegments.contains_key(&edge) {
                return Ok(Some(edge));
            }
            let (t, apex) = (tet_of(handle), mesh.apex(handle));
            let v = mesh.tets[t as usize];
            let slot = |x: u32| v.iter().position(|&y| y == x);
            let (Some(i), Some(j)) = (slot(edge[0]), slot(edge[1])) else { break };
            // Around the edge away from the subfacet, to the next one.
            let away = v[EVEN_REST[i][j][0]] == opposite;
            debug_assert!(away || v[EVEN_REST[i][j][0]] == apex);
            let [i, j] = if away { [i, j] } else { [j, i] };
            let mut next = NONE;
            mesh.turn(t, i, j, |face| self.is_wall(mesh, face), |t, k, _| next = 4 * t + k as u32);
            (handle, entry) = (next, edge);
        }
        Ok(None)
    }

    /// Whether a point's cavity goes through the boundary, so that inserting it would take a subfacet out; or the point lies outside or on
    /// a subfacet. Where no vertex encroaches upon the boundary such a point encroaches upon it, too.
    pub(super) fn is_crossed(
        &self,
        mesh: &Mesh<'_>,
        p: DVec3,
        cavity: &Cavity,
        control: &Control,
    ) -> Result<bool, Error> {
        let turns = control.turns();
        for &t in &cavity.tets {
            turns.check()?;
            for slot in 0..4 {
                if mesh.is_left_out(t) || !self.is_wall(mesh, 4 * t + slot) {
                    continue;
                }
                let mut corners = mesh.corners(t);
                corners[slot as usize] = p;
                let [a, b, c, d] = corners;
                // With tetrahedra on both sides in the cavity, one of them has the point on the wrong side.
                if orient3d(a, b, c, d) != Sign::Positive {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Subsegments and subfacets that a vertex of the mesh encroaches upon, in order.
    pub(super) fn encroached_by_vertices(&self, mesh: &Mesh<'_>, control: &Control) -> Result<Encroached, Error> {
        let mut found = Encroached::default();
        let turns = control.turns();
        for (&edge, &Subsegment { segment, tet }) in &self.subsegments {
            turns.check()?;
            let ends = edge.map(|v| mesh.at(v));
            let middle = 0.5 * ends[0] + 0.5 * ends[1];
            let mut encroached = false;
            let mut look = |t: u32, k: usize, l: usize| {
                for slot in [k, l] {
                    let v = mesh.tets[t as usize][slot];
                    encroached |= encroaches_segment(ends, mesh.at(v))
                        && self.may_encroach(mesh, v, Carrier::Segment(segment), middle);
                }
            };
            let v = mesh.tets[tet as usize];
            let slot = |x: u32| v.iter().position(|&y| y == x);
            if let (Some(i), Some(j)) = (slot(edge[0]), slot(edge[1])) {
                if !mesh.turn(tet, i, j, |_| false, &mut look) {
                    mesh.turn(tet, j, i, |_| false, &mut look);
                }
            }
            if encroached {
                found.segments.push(edge);
            }
        }
        for (&face, &Subfacet { facet, handle }) in &self.subfacets {
            turns.check()?;
            let corners = face.map(|v| mesh.at(v));
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let sides = [handle, mesh.across(handle)];
            if sides.into_iter().filter(|&side| side != NONE).any(|side| {
                let v = mesh.apex(side);
                encroaches_facet(corners, mesh.at(v)) && self.may_encroach(mesh, v, Carrier::Facet(facet), middle)
            }) {
                found.facets.push(face);
            }
        }
        found.segments.sort_unstable();
        found.facets.sort_unstable();
        Ok(found)
    }

    /// Keeps the one subsegment, or else subfacet, whose centre is nearest to `p`: see `domain::boundary`.
    pub(super) fn keep_nearest(&self, mesh: &Mesh<'_>, p: DVec3, found: &mut Encroached) {
        let segment = |&[a, b]: &[u32; 2]| p.distance_squared(0.5 * mesh.at(a) + 0.5 * mesh.at(b));
        let facet =
            |&[a, b, c]: &[u32; 3]| p.distance_squared(triangle_circumcenter(mesh.at(a), mesh.at(b), mesh.at(c)));
        found.segments =
            found.segments.iter().copied().min_by(|s, r| segment(s).total_cmp(&segment(r))).into_iter().collect();
        found.facets = found.facets.iter().copied().min_by(|f, g| facet(f).total_cmp(&facet(g))).into_iter().collect();
    }

    /// Where to split a subsegment: see `domain::split`.
    pub(super) fn split_point(&self, mesh: &Mesh<'_>, [a, b]: [u32; 2]) -> DVec3 {
        let acute = |v: u32| self.kind(v) & ACUTE != 0;
        crate::domain::acute::split_point([mesh.at(a), mesh.at(b)], [acute(a), acute(b)])
    }

    /// Whether segments meet at less than 60° at one of these vertices.
    pub(super) fn has_acute(&self, corners: &[u32]) -> bool {
        corners.iter().any(|&v| self.kind(v) & ACUTE != 0)
    }

    fn carrier(&self, v: u32) -> Carrier {
        self.carriers.get(&v).copied().unwrap_or_default()
    }

    fn corners_of<'a>(&'a self, carrier: &'a Carrier) -> &'a [u32] {
        match carrier {
            Carrier::Free => &[],
            Carrier::Vertex(v) => std::slice::from_ref(v),
            Carrier::Segment(s) => &self.segments[*s as usize].0,
            Carrier::Facet(f) => &self.corners[*f as usize],
        }
    }

    fn meet_acutely(&self, mesh: &Mesh<'_>, (a, p): (Carrier, DVec3), (b, q): (Carrier, DVec3)) -> bool {
        if a == b {
            return false;
        }
        if let (Carrier::Segment(s), Carrier::Facet(f)) | (Carrier::Facet(f), Carrier::Segment(s)) = (a, b) {
            if self.segments[s as usize].1.contains(&f) {
                return false;
            }
        }
        let (corners, others) = (self.corners_of(&a), self.corners_of(&b));
        if corners.len() < 2 || others.len() < 2 {
            return false;
        }
        let mut shared = corners.iter().copied().filter(|v| *v != NONE && others.contains(v)).map(|v| mesh.at(v));
        match (shared.next(), shared.next()) {
            (Some(x), None) => is_acute(p - x, q - x),
            (Some(x), Some(y)) => {
                let along = (y - x).normalize_or_zero();
                is_acute((p - x).reject_from_normalized(along), (q - x).reject_from_normalized(along))
            }
            _ => false,
        }
    }

    /// Whether an edge's length is given by an acute input angle.
    pub(super) fn is_seditious(&self, mesh: &Mesh<'_>, [v, w]: [u32; 2]) -> bool {
        self.kind(v) != 0
            && self.kind(w) != 0
            && self.meet_acutely(mesh, (self.carrier(v), mesh.at(v)), (self.carrier(w), mesh.at(w)))
    }

    fn may_encroach(&self, mesh: &Mesh<'_>, v: u32, element: Carrier, middle: DVec3) -> bool {
        self.kind(v) == 0 || !self.meet_acutely(mesh, (self.carrier(v), mesh.at(v)), (element, middle))
    }
}

/// Whether `c` and `d`, in a plane with `a` and `b`, are on different sides of the line through these.
fn apart(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> bool {
    let along = (b - a).normalize_or_zero();
    (c - a).reject_from_normalized(along).dot((d - a).reject_from_normalized(along)) < 0.0
}

/// The facet of each face, numbered from 0: the host's numbers first, then one for each set of exactly coplanar neighbours.
fn group(mesh: &Mesh<'_>, keys: &[[u32; 3]], numbers: &[Option<u32>], edges: &[([u32; 2], u32)]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..keys.len() as u32).collect();
    let opposite = |i: u32, edge: [u32; 2]| keys[i as usize].into_iter().find(|v| !edge.contains(v)).unwrap_or(NONE);
    for at_edge in edges.chunk_by(|e, f| e.0 == f.0) {
        let edge = at_edge[0].0;
        for (n, &(_, i)) in at_edge.iter().enumerate() {
            for &(_, j) in &at_edge[n + 1..] {
                if numbers[i as usize].is_some() || numbers[j as usize].is_some() {
                    continue;
                }
                let [a, b] = edge.map(|v| mesh.at(v));
                let [c, d] = [i, j].map(|face| mesh.at(opposite(face, edge)));
                // On the plane but for rounding, and on the two sides of the edge.
                if orient3d(a, b, c, d) == Sign::Zero || mesh.are_coplanar([a, b, c, d]) && apart(a, b, c, d) {
                    unite(&mut parent, i, j);
                }
            }
        }
    }
    let mut number_of = FxHashMap::default();
    let mut of = |key: (bool, u32)| {
        let next = number_of.len() as u32;
        *number_of.entry(key).or_insert(next)
    };
    (0..keys.len())
        .map(|i| match numbers[i] {
            Some(number) => of((true, number)),
            None => of((false, find(&mut parent, i as u32))),
        })
        .collect()
}
