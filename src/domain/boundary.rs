//! The boundary of a domain as the refinement sees it: subsegments and subfacets, which change as they are split, and the question of
//! which of them a point encroaches upon.
//!
//! Only elements at the cavity of a point have to be asked. A subsegment `ab` that nothing encroaches has its midpoint in its own Voronoi
//! facet; a point in its diametral ball is nearer to the midpoint, so it cuts the facet, so it conflicts with a
//! tetrahedron around `ab`. The same holds for subfacets, their circumcentres and dual edges.

use std::collections::VecDeque;

use rustc_hash::{FxHashMap, FxHashSet};

use super::acute::Carrier;
use super::facet::FacetTriangulation;
use crate::geometry::circumsphere::triangle_circumcenter;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::DVec3;

/// An edge's key: lower vertex first.
pub fn edge_key([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// A face's key: vertices in order.
pub fn face_key(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// A vertex lies on a segment.
pub(super) const ON_SEGMENT: u8 = 1;
/// A vertex lies on a facet.
pub(super) const ON_FACET: u8 = 2;
/// A vertex is an end of two segments that meet at less than 60°.
pub(super) const ACUTE: u8 = 4;

/// An input segment.
#[derive(Clone, Debug)]
pub struct Segment {
    /// The caller's own number for it.
    pub marker: i32,
    /// The vertices at its ends.
    pub ends: [u32; 2],
    /// The facets that it borders or lies in.
    pub facets: Vec<u32>,
}

/// Boundary elements that a point encroaches upon.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Encroached {
    /// Subsegments, lower vertex first.
    pub segments: Vec<[u32; 2]>,
    /// Subfacets, vertices in order.
    pub facets: Vec<[u32; 3]>,
}

impl Encroached {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty() && self.facets.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        self.segments.clear();
        self.facets.clear();
    }
}

/// The boundary of a domain within a triangulation.
#[derive(Clone, Debug, Default)]
pub struct Boundary {
    /// [`ON_SEGMENT`] and others, by vertex; vertices beyond its end are free.
    pub(super) kinds: Vec<u8>,
    pub(super) carriers: Vec<Carrier>,
    pub(super) segments: Vec<Segment>,
    pub(super) facets: Vec<FacetTriangulation>,
    /// The segment of each subsegment.
    pub(super) subsegments: FxHashMap<[u32; 2], u32>,
    /// The facet of each subfacet.
    pub(super) subfacets: FxHashMap<[u32; 3], u32>,
    /// Encroached or missing subsegments, to be split; those that are gone by their turn are passed over.
    pub(crate) pending_segments: VecDeque<[u32; 2]>,
    pub(crate) pending_facets: VecDeque<[u32; 3]>,
    /// Elements that can't be split any more.
    pub(crate) blocked_segments: FxHashSet<[u32; 2]>,
    pub(crate) blocked_facets: FxHashSet<[u32; 3]>,
    /// Some element may be encroached that nothing has queued: vertices have been taken away, or it was left so.
    pub(crate) relaxed: bool,
    /// Elements are not split for the vertices in their balls: see `clearance`.
    pub(crate) tolerant: bool,
}

impl Boundary {
    pub(crate) fn kind(&self, v: u32) -> u8 {
        self.kinds.get(v as usize).copied().unwrap_or(0)
    }

    /// The input element that a vertex lies on.
    pub(crate) fn carrier(&self, v: u32) -> Carrier {
        self.carriers.get(v as usize).copied().unwrap_or_default()
    }

    /// Forgets what is known of a vertex: its id has another one now.
    pub(crate) fn unmark(&mut self, v: u32) {
        if let Some(kind) = self.kinds.get_mut(v as usize) {
            *kind = 0;
        }
        if let Some(carrier) = self.carriers.get_mut(v as usize) {
            *carrier = Carrier::default();
        }
    }

    pub(super) fn mark(&mut self, v: u32, kind: u8) {
        if self.kinds.len() <= v as usize {
            self.kinds.resize(v as usize + 1, 0);
        }
        self.kinds[v as usize] |= kind;
    }

    /// Notes the input element that a vertex lies on, unless a lower one is known.
    pub(super) fn carry(&mut self, v: u32, carrier: Carrier) {
        if self.carriers.len() <= v as usize {
            self.carriers.resize(v as usize + 1, Carrier::Free);
        }
        let rank = |carrier| match carrier {
            Carrier::Vertex(_) => 0,
            Carrier::Segment(_) => 1,
            Carrier::Facet(_) => 2,
            Carrier::Free => 3,
        };
        let known = &mut self.carriers[v as usize];
        if rank(carrier) < rank(*known) {
            *known = carrier;
        }
    }

    /// All subsegments, lower vertex first, in order; with the position of their segment.
    pub fn subsegments(&self) -> Vec<([u32; 2], u32)> {
        let mut all: Vec<_> = self.subsegments.iter().map(|(&k, &s)| (k, s)).collect();
        all.sort_unstable();
        all
    }

    /// All subfacets, vertices in order; with the position of their facet.
    pub fn subfacets(&self) -> Vec<([u32; 3], u32)> {
        let mut all: Vec<_> = self.subfacets.iter().map(|(&k, &f)| (k, f)).collect();
        all.sort_unstable();
        all
    }

    /// Whether it bounds nothing.
    pub fn is_empty(&self) -> bool {
        self.subsegments.is_empty() && self.subfacets.is_empty()
    }

    /// The input segments.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The planar triangulations of the input facets.
    pub fn facets(&self) -> &[FacetTriangulation] {
        &self.facets
    }

    /// The position of a subfacet's facet.
    pub(crate) fn facet_of(&self, face: [u32; 3]) -> Option<usize> {
        self.subfacets.get(&face_key(face)).map(|&facet| facet as usize)
    }

    /// Whether the edge is a subsegment.
    pub fn is_subsegment(&self, edge: [u32; 2]) -> bool {
        self.subsegments.contains_key(&edge_key(edge))
    }

    /// Whether the face is a subfacet.
    #[inline]
    pub fn is_subfacet(&self, face: [u32; 3]) -> bool {
        let on_facet = |v: u32| v != GHOST && self.kind(v) & ON_FACET != 0;
        face.into_iter().all(on_facet) && self.subfacets.contains_key(&face_key(face))
    }

    /// The facet of a face that is a subfacet.
    #[inline]
    pub(crate) fn wall(&self, face: [u32; 3]) -> Option<u32> {
        let on_facet = |v: u32| v != GHOST && self.kind(v) & ON_FACET != 0;
        if !face.into_iter().all(on_facet) {
            return None;
        }
        self.subfacets.get(&face_key(face)).copied()
    }

    /// The subsegments and subfacets around a cavity that its point `p` encroaches upon. `found` is filled, in a fixed order.
    pub(crate) fn encroached_by(&self, t: &Triangulation, p: DVec3, cavity: &Cavity, found: &mut Encroached) {
        found.clear();
        for &tet in &cavity.tets {
            let v = t.topology.tet(tet).v;
            let kinds = v.map(|v| if v == GHOST { 0 } else { self.kind(v) });
            let count = |bit: u8| kinds.iter().filter(|&&kind| kind & bit != 0).count();
            if count(ON_SEGMENT) >= 2 {
                for [i, j] in crate::geometry::quality::EDGES {
                    if kinds[i] & kinds[j] & ON_SEGMENT == 0 {
                        continue;
                    }
                    let key = edge_key([v[i], v[j]]);
                    if self.subsegments.contains_key(&key)
                        && !found.segments.contains(&key)
                        && encroaches_segment(key.map(|v| t.at(v)), p)
                    {
                        found.segments.push(key);
                    }
                }
            }
            if count(ON_FACET) >= 3 {
                for slot in 0..4 {
                    let face = t.topology.tet(tet).face(slot);
                    if !self.is_subfacet(face) {
                        continue;
                    }
                    let key = face_key(face);
                    if !found.facets.contains(&key) && encroaches_facet(key.map(|v| t.at(v)), p) {
                        found.facets.push(key);
                    }
                }
            }
        }
    }

    /// Queues what of these elements still exists and can be split.
    pub(crate) fn enqueue(&mut self, found: &Encroached) {
        for &s in &found.segments {
            if self.waits_segment(s) {
                self.pending_segments.push_back(s);
            }
        }
        for &f in &found.facets {
            if self.waits_facet(f) {
                self.pending_facets.push_back(f);
            }
        }
    }

    /// [`enqueue`](Self::enqueue) for what the new vertex `v` of the boundary encroaches upon, small input angles excepted.
    pub(crate) fn enqueue_for(&mut self, t: &Triangulation, v: u32, mut found: Encroached) {
        // What the vertex has removed from the triangulation is split at any angle.
        let is_edge = |[a, b]: [u32; 2]| t.topology.find_edge(a, b).is_some();
        let is_face = |face: [u32; 3]| t.topology.find_face(face).is_some();
        found.segments.retain(|&edge| self.vertex_encroaches_segment(t, edge, v) || !is_edge(edge));
        found.facets.retain(|&face| self.vertex_encroaches_facet(t, face, v) || !is_face(face));
        self.enqueue(&found);
    }

    /// Whether a vertex, or the ghost, encroaches upon a subsegment.
    fn vertex_encroaches_segment(&self, t: &Triangulation, edge: [u32; 2], v: u32) -> bool {
        if self.tolerant || v == GHOST || !encroaches_segment(edge.map(|v| t.at(v)), t.at(v)) {
            return false;
        }
        let Some(&segment) = self.subsegments.get(&edge_key(edge)) else { return false };
        self.may_encroach(t, v, Carrier::Segment(segment), 0.5 * t.at(edge[0]) + 0.5 * t.at(edge[1]))
    }

    /// Whether a vertex, or the ghost, encroaches upon a subfacet.
    fn vertex_encroaches_facet(&self, t: &Triangulation, face: [u32; 3], v: u32) -> bool {
        let corners = face.map(|v| t.at(v));
        if self.tolerant || v == GHOST || !encroaches_facet(corners, t.at(v)) {
            return false;
        }
        let Some(&facet) = self.subfacets.get(&face_key(face)) else { return false };
        self.may_encroach(t, v, Carrier::Facet(facet), (corners[0] + corners[1] + corners[2]) / 3.0)
    }

    fn waits_segment(&self, edge: [u32; 2]) -> bool {
        self.subsegments.contains_key(&edge) && !self.blocked_segments.contains(&edge)
    }

    fn waits_facet(&self, face: [u32; 3]) -> bool {
        self.subfacets.contains_key(&face) && !self.blocked_facets.contains(&face)
    }

    /// The next subsegment to split.
    pub(crate) fn next_pending_segment(&self) -> Option<[u32; 2]> {
        self.pending_segments.iter().copied().find(|&edge| self.waits_segment(edge))
    }

    /// The next subfacet to split.
    pub(crate) fn next_pending_facet(&self) -> Option<[u32; 3]> {
        self.pending_facets.iter().copied().find(|&face| self.waits_facet(face))
    }

    /// Takes the next subsegment to split off its queue.
    pub(crate) fn pop_segment(&mut self) -> Option<[u32; 2]> {
        while let Some(edge) = self.pending_segments.pop_front() {
            if self.waits_segment(edge) {
                return Some(edge);
            }
        }
        None
    }

    /// Takes the next subfacet to split off its queue.
    pub(crate) fn pop_facet(&mut self) -> Option<[u32; 3]> {
        while let Some(face) = self.pending_facets.pop_front() {
            if self.waits_facet(face) {
                return Some(face);
            }
        }
        None
    }

    /// Takes entries that need no split any more off the front of the queues.
    pub(crate) fn drop_stale(&mut self) {
        if let Some(edge) = self.pop_segment() {
            self.pending_segments.push_front(edge);
        }
        if let Some(face) = self.pop_facet() {
            self.pending_facets.push_front(face);
        }
    }

    /// Keeps one subsegment and one subfacet, those that `p` encroaches upon most: whose centre is nearest to it, measured by the radius of their balls.
    /// What else it encroaches upon often needs no split any more when it comes again.
    pub(crate) fn keep_nearest(&self, t: &Triangulation, p: DVec3, found: &mut Encroached) {
        let depth = |center: DVec3, corner: u32| p.distance_squared(center) / t.at(corner).distance_squared(center);
        let segment = |&[a, b]: &[u32; 2]| depth(0.5 * t.at(a) + 0.5 * t.at(b), a);
        let facet = |&[a, b, c]: &[u32; 3]| depth(triangle_circumcenter(t.at(a), t.at(b), t.at(c)), a);
        found.segments =
            found.segments.iter().copied().min_by(|s, r| segment(s).total_cmp(&segment(r))).into_iter().collect();
        found.facets = found.facets.iter().copied().min_by(|f, g| facet(f).total_cmp(&facet(g))).into_iter().collect();
    }

    /// Forgets which elements could not be split: the limits that forbade it may be others now. Those that need a split are queued.
    pub(crate) fn unblock(&mut self, t: &Triangulation) {
        let mut segments: Vec<[u32; 2]> = self.blocked_segments.drain().collect();
        let mut facets: Vec<[u32; 3]> = self.blocked_facets.drain().collect();
        segments.sort_unstable();
        facets.sort_unstable();
        segments.retain(|&edge| self.waits_segment(edge) && self.needs_split_segment(t, edge));
        facets.retain(|&face| self.waits_facet(face) && self.needs_split_facet(t, face));
        self.pending_segments.extend(segments);
        self.pending_facets.extend(facets);
    }

    /// Takes out what can't be split any more.
    pub(crate) fn drop_blocked(&self, found: &mut Encroached) {
        found.segments.retain(|s| !self.blocked_segments.contains(s));
        found.facets.retain(|f| !self.blocked_facets.contains(f));
    }

    /// Queues every subsegment and subfacet that is missing from the triangulation or encroached by a vertex.
    pub(crate) fn enqueue_all(&mut self, t: &Triangulation) {
        for (edge, _) in self.subsegments() {
            if self.needs_split_segment(t, edge) {
                self.pending_segments.push_back(edge);
            }
        }
        for (face, _) in self.subfacets() {
            if self.needs_split_facet(t, face) {
                self.pending_facets.push_back(face);
            }
        }
    }

    /// Whether a subsegment is missing or encroached. If any vertex lies in the diametral ball of an edge, one of its link does.
    fn needs_split_segment(&self, t: &Triangulation, [a, b]: [u32; 2]) -> bool {
        match t.topology.find_edge(a, b) {
            None => true,
            Some(_) if self.tolerant => is_crowded(t, &[[a, b]]),
            Some((tet, i, j)) => t
                .topology
                .around_edge(tet, i, j)
                .any(|(around, k, _)| self.vertex_encroaches_segment(t, [a, b], t.topology.tet(around).v[k])),
        }
    }

    /// Whether a subfacet is missing or encroached. If any vertex lies in its smallest ball, one of its two apices does.
    fn needs_split_facet(&self, t: &Triangulation, face: [u32; 3]) -> bool {
        let mut apices = t.face_apices(face).peekable();
        if self.tolerant && apices.peek().is_some() {
            return is_crowded(t, &[[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]]);
        }
        apices.peek().is_none() || apices.any(|v| self.vertex_encroaches_facet(t, face, v))
    }

    /// Queues those of the elements at vertex `new` that are missing or encroached; `star` are the tetrahedra at it.
    pub(super) fn enqueue_new(
        &mut self,
        t: &Triangulation,
        new: u32,
        star: &[u32],
        segments: &[[u32; 2]],
        facets: &[[u32; 3]],
    ) {
        // What encroaches upon an element at `new`, or that it is missing, shows in the star.
        let other = |vertices: &[u32], tet: u32| {
            let v = t.topology.tet(tet).v;
            vertices
                .iter()
                .all(|x| v.contains(x))
                .then(|| v.into_iter().filter(|v| !vertices.contains(v)).collect::<Vec<_>>())
        };
        for &edge in segments {
            debug_assert!(edge.contains(&new));
            let around: Vec<u32> = star.iter().filter_map(|&tet| other(&edge, tet)).flatten().collect();
            let crowded = || self.tolerant && is_crowded(t, &[edge]);
            if around.is_empty() || around.iter().any(|&v| self.vertex_encroaches_segment(t, edge, v)) || crowded() {
                self.pending_segments.push_back(edge_key(edge));
            }
        }
        for &face in facets {
            let around: Vec<u32> = star.iter().filter_map(|&tet| other(&face, tet)).flatten().collect();
            let [a, b, c] = face;
            let crowded = || self.tolerant && is_crowded(t, &[[a, b], [b, c], [c, a]]);
            if around.is_empty() || around.iter().any(|&v| self.vertex_encroaches_facet(t, face, v)) || crowded() {
                self.pending_facets.push_back(face_key(face));
            }
        }
    }

    /// The first missing element: every subsegment is an edge and every subfacet a face of the triangulation when there is none.
    pub fn first_missing(&self, t: &Triangulation) -> Option<crate::triangulation::Defect> {
        use crate::triangulation::Defect;
        let segment = self.subsegments().into_iter().find(|&([a, b], _)| t.topology.find_edge(a, b).is_none());
        if let Some((edge, _)) = segment {
            return Some(Defect::MissingSubsegment { edge });
        }
        let facet = self.subfacets().into_iter().find(|&(face, _)| t.topology.find_face(face).is_none());
        facet.map(|(face, _)| Defect::MissingSubfacet { face })
    }
}

/// More tetrahedra around one edge than this make every cavity there a large one.
const CROWD: usize = 1000;

/// Whether one of these edges has so many tetrahedra around it that elements there are split however few points that saves.
fn is_crowded(t: &Triangulation, edges: &[[u32; 2]]) -> bool {
    edges.iter().any(|&[a, b]| {
        let found = t.topology.find_edge(a, b);
        found.is_some_and(|(tet, i, j)| t.topology.around_edge(tet, i, j).nth(CROWD).is_some())
    })
}

impl Triangulation {
    /// The vertices opposite a face, the ghost among them; none when it is no face.
    fn face_apices(&self, face: [u32; 3]) -> impl Iterator<Item = u32> + '_ {
        let apex = |face: u32| self.topology.tet(tet_of(face)).v[slot_of(face)];
        let side = self.topology.find_face(face);
        side.into_iter().flat_map(move |face| [apex(face), apex(self.topology.tet(tet_of(face)).n[slot_of(face)])])
    }
}
