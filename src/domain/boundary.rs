//! The boundary of a domain as the refinement sees it: subsegments and subfacets, which change as they are split, and the queues of those that
//! have to be (which `waiting` goes through).

use std::collections::VecDeque;

use super::acute::Carrier;
use super::blocked::Blocked;
use super::elements::{Subfacets, Subsegments};
pub use super::encroached::Encroached;
use super::facet::FacetTriangulation;
use super::pending::Demand;
use crate::leavings::{give_elements_back, InPieces, Leavings};
use crate::parted::PartedMap;
use crate::sorting::sort;
use crate::triangulation::topology::GHOST;
use crate::triangulation::Triangulation;
use crate::{memory, Control, Error};

/// An edge's key: lower vertex first.
pub fn edge_key([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// A face's key: vertices in order.
pub fn face_key(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// The keys of some faces, in order, unless the control says stop.
pub(crate) fn face_keys<'a>(
    faces: impl IntoIterator<Item = &'a [u32; 3]>,
    control: &Control,
) -> Result<Vec<[u32; 3]>, Error> {
    let mut keys: Vec<[u32; 3]> = faces.into_iter().map(|&face| face_key(face)).collect();
    sort(&mut keys, &control.watch())?;
    Ok(keys)
}

/// The places of a word's bits.
#[inline]
pub(crate) fn places(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        place
    })
}

/// A vertex lies on a segment.
pub(super) const ON_SEGMENT: u8 = 1;
/// A vertex lies on a facet.
pub(super) const ON_FACET: u8 = 2;
/// A vertex is an end of two segments that meet at less than 60°.
pub(super) const ACUTE: u8 = 4;
/// A vertex lies on a segment where two facets meet at less than 60°.
pub(super) const SHARP: u8 = 8;

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

/// What is known of a vertex before a split, to take the split back.
#[derive(Clone, Debug)]
pub(crate) struct Standing {
    pub kind: u8,
    pub carrier: Carrier,
    /// The subsegment that is split, if it is one, and its parts, each with its segment. Parts may be there already.
    pub segments: Vec<([u32; 2], Option<u32>)>,
    /// The subfacets that go and come, likewise: near small angles one may come in two facets.
    pub facets: Vec<([u32; 3], Option<u32>)>,
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
    pub(super) subsegments: Subsegments,
    /// The facet of each subfacet.
    pub(super) subfacets: Subfacets,
    /// Elements that a split has taken out of the triangulation; those that are there again by their turn are passed over.
    pub(crate) missing_segments: VecDeque<[u32; 2]>,
    pub(crate) missing_facets: VecDeque<[u32; 3]>,
    /// Encroached subsegments, to be split; those that are gone by their turn are passed over.
    pub(crate) pending_segments: VecDeque<([u32; 2], Demand)>,
    pub(crate) pending_facets: VecDeque<([u32; 3], Demand)>,
    /// Elements whose split was refused.
    pub(crate) blocked: Blocked,
    /// While the boundary is being recovered only what is missing is split, not what is encroached.
    pub(crate) recovering: bool,
    /// Each subfacet lies between tetrahedra with different labels.
    pub(super) parts_labels: bool,
    /// Nothing that is there may be split.
    pub(crate) kept: bool,
    /// Whether facets meet at less than 60° along each segment.
    pub(super) sharp_segments: Vec<bool>,
    /// The length of the shortest segment at each acute vertex.
    pub(super) shortest_at: PartedMap<u32, f64>,
    /// The distance of the nearest vertex to each acute vertex, when the boundary had been recovered.
    pub(super) room_at: PartedMap<u32, f64>,
    /// The largest cosine between two segments at each acute vertex.
    pub(super) sharpness: PartedMap<u32, f64>,
    /// Some element may be encroached that nothing has queued: vertices have been taken away, or it was refined [lazily](Self::lazy).
    pub(crate) relaxed: bool,
    /// While the boundary is being refined so, nothing is split because a vertex encroaches upon it: only when a sample does.
    pub(crate) lazy: bool,
}

impl Boundary {
    /// What a vertex is to the boundary: 0 for one that is not on it, and for the ghost.
    pub(crate) fn kind(&self, v: u32) -> u8 {
        self.kinds.get(v as usize).copied().unwrap_or(0)
    }

    /// The input element that a vertex lies on.
    pub fn carrier(&self, v: u32) -> Carrier {
        self.carriers.get(v as usize).copied().unwrap_or_default()
    }

    pub(super) fn sharpness(&self, v: u32) -> f64 {
        self.sharpness.get(&v).copied().unwrap_or(0.0)
    }

    /// Forgets what is known of a vertex: its id has another one now.
    pub(crate) fn unmark(&mut self, v: u32) {
        if self.kind(v) != 0 {
            self.blocked.leave(v);
        }
        self.forget(v);
    }

    /// Forgets what a vertex lies on.
    pub(super) fn forget(&mut self, v: u32) {
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

    /// All subsegments as they are stored, lower vertex first; with the position of their segment.
    pub(crate) fn each_subsegment(&self) -> impl Iterator<Item = ([u32; 2], u32)> + '_ {
        self.subsegments.iter().map(|(&edge, &segment)| (edge, segment))
    }

    /// All subfacets as they are stored, vertices in order; with the position of their facet.
    pub(crate) fn each_subfacet(&self) -> impl Iterator<Item = ([u32; 3], u32)> + '_ {
        self.subfacets.iter().map(|(&face, &facet)| (face, facet))
    }

    /// All subsegments, lower vertex first, in order; with the position of their segment.
    pub fn subsegments(&self) -> Vec<([u32; 2], u32)> {
        let mut all: Vec<_> = self.each_subsegment().collect();
        all.sort_unstable();
        all
    }

    /// All subfacets, vertices in order; with the position of their facet.
    pub fn subfacets(&self) -> Vec<([u32; 3], u32)> {
        let mut all: Vec<_> = self.each_subfacet().collect();
        all.sort_unstable();
        all
    }

    /// The position of the first facet that a subsegment borders or lies in.
    pub(crate) fn facet_beside(&self, edge: [u32; 2]) -> Option<usize> {
        let segment = self.subsegments.get(&edge_key(edge))?;
        self.segments[*segment as usize].facets.first().map(|&facet| facet as usize)
    }

    /// How many subsegments and subfacets there are.
    pub(crate) fn element_count(&self) -> usize {
        self.subsegments.len() + self.subfacets.len()
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
        self.wall(face).is_some()
    }

    /// The facet of a face that is a subfacet.
    #[inline(always)]
    pub(crate) fn wall(&self, face: [u32; 3]) -> Option<u32> {
        let on_facet = |v: u32| v != GHOST && self.kind(v) & ON_FACET != 0;
        if !face.into_iter().all(on_facet) {
            return None;
        }
        self.subfacets.find(face)
    }

    /// Which faces of a tetrahedron with these vertices may be subfacets: a bit for each slot. Few others are among them.
    #[inline]
    pub(crate) fn possible_walls(&self, v: [u32; 4]) -> u32 {
        self.subfacets.possible_faces(v)
    }

    /// The facet of a face of a tetrahedron, opposite a slot, of which these are the [possible walls](Self::possible_walls).
    #[inline(always)]
    pub(crate) fn wall_among(&self, walls: u32, slot: usize, face: [u32; 3]) -> Option<u32> {
        if walls >> slot & 1 != 0 {
            self.wall(face)
        } else {
            None
        }
    }

    /// Whether two of these vertices are on the boundary, so that a subsegment or a subfacet may join them. Far from the boundary few tetrahedra have such.
    #[inline]
    pub(crate) fn may_have_edge(&self, v: impl IntoIterator<Item = u32>) -> bool {
        v.into_iter().filter(|&v| self.kind(v) != 0).nth(1).is_some()
    }

    /// Whether nothing but subfacets parts the domain from what is outside it.
    pub(crate) fn closes(&self, t: &Triangulation) -> bool {
        !(self.is_empty() || self.misses() || t.topology.region.is_empty())
    }

    /// Room for what comes when the triangulation has that of so many vertices, made in pieces.
    pub(crate) fn grow_for(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        const WHAT: &str = "boundary";
        let (_, vertices) = t.room();
        let more = |len: usize| vertices.saturating_sub(len);
        let (kinds, carriers) = (more(self.kinds.len()), more(self.carriers.len()));
        memory::grow(&mut self.kinds, kinds, WHAT, control)?;
        memory::grow(&mut self.carriers, carriers, WHAT, control)?;
        self.subsegments.grow(vertices, control)?;
        self.subfacets.grow(vertices, control)
    }

    /// Makes the lists that have an entry for each vertex as long as they will be, in pieces.
    pub(super) fn lengthen_for(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        const WHAT: &str = "boundary";
        let vertices = t.vertex_slots();
        memory::lengthen(&mut self.kinds, vertices, 0, WHAT, control)?;
        memory::lengthen(&mut self.carriers, vertices, Carrier::Free, WHAT, control)?;
        self.subsegments.lengthen(vertices, control)?;
        self.subfacets.lengthen(vertices, control)
    }

    /// Memory for what one split adds, mostly.
    pub(crate) fn reserve(&mut self) -> Result<(), Error> {
        const MORE: usize = 64;
        let Boundary { kinds, carriers, subsegments, subfacets, pending_segments, pending_facets, .. } = self;
        let reserved = kinds.try_reserve(MORE).and_then(|()| carriers.try_reserve(MORE)).is_ok()
            && subsegments.try_reserve(MORE).is_ok()
            && subfacets.try_reserve(MORE).is_ok()
            && pending_segments.try_reserve(MORE).is_ok()
            && pending_facets.try_reserve(MORE).is_ok();
        if reserved {
            Ok(())
        } else {
            Err(Error::OutOfMemory { what: "boundary" })
        }
    }

    /// The bytes of its lists, about.
    pub(crate) fn bytes(&self) -> usize {
        self.subsegments.bytes()
            + self.subfacets.bytes()
            + self.pending_segments.capacity() * size_of::<([u32; 2], Demand)>()
            + self.pending_facets.capacity() * size_of::<([u32; 3], Demand)>()
            + self.carriers.capacity() * size_of::<Carrier>()
            + self.kinds.capacity()
    }

    /// A copy, unless memory is lacking or the control says stop.
    pub(crate) fn try_clone(&self, control: &Control) -> Result<Boundary, Error> {
        const WHAT: &str = "boundary";
        let mut copy = InPieces::new(Boundary::default(), control);
        copy.kinds = memory::copied(&self.kinds, WHAT, control)?;
        copy.carriers = memory::copied(&self.carriers, WHAT, control)?;
        memory::reserve_exact(&mut copy.segments, self.segments.len(), WHAT)?;
        for part in self.segments.chunks(PART) {
            control.check()?;
            copy.segments.extend_from_slice(part);
        }
        copy.facets = memory::with_room(self.facets.len(), WHAT)?;
        for facet in &self.facets {
            control.check()?;
            copy.facets.push(facet.try_clone(control)?);
        }
        copy.subsegments = self.subsegments.try_clone(control)?;
        copy.subfacets = self.subfacets.try_clone(control)?;
        copy.missing_segments = memory::copied_queue(&self.missing_segments, WHAT, control)?;
        copy.missing_facets = memory::copied_queue(&self.missing_facets, WHAT, control)?;
        copy.pending_segments = memory::copied_queue(&self.pending_segments, WHAT, control)?;
        copy.pending_facets = memory::copied_queue(&self.pending_facets, WHAT, control)?;
        copy.blocked = self.blocked.try_clone(control)?;
        copy.sharp_segments = memory::copied(&self.sharp_segments, WHAT, control)?;
        copy.shortest_at = self.shortest_at.try_clone(control)?;
        copy.room_at = self.room_at.try_clone(control)?;
        copy.sharpness = self.sharpness.try_clone(control)?;
        let Boundary { recovering, parts_labels, kept, relaxed, .. } = *self;
        Ok(Boundary { recovering, parts_labels, kept, relaxed, ..copy.keep() })
    }
}

/// Segments or facets copied or given back at once.
const PART: usize = 1 << 8;

impl Leavings for Boundary {
    fn give_back(&mut self) -> bool {
        let Boundary { kinds, carriers, segments, facets, subsegments, subfacets, .. } = self;
        if kinds.give_back() || carriers.give_back() || subsegments.give_back() || subfacets.give_back() {
            return true;
        }
        let Boundary { missing_segments, missing_facets, pending_segments, pending_facets, .. } = self;
        if missing_segments.give_back() || missing_facets.give_back() {
            return true;
        }
        if pending_segments.give_back() || pending_facets.give_back() {
            return true;
        }
        let Boundary { blocked, shortest_at, room_at, sharpness, .. } = self;
        if blocked.give_back() || shortest_at.give_back() || room_at.give_back() || sharpness.give_back() {
            return true;
        }
        // A facet may have very many triangles.
        facets.last_mut().is_some_and(FacetTriangulation::give_back)
            || give_elements_back(segments, PART)
            || give_elements_back(facets, PART)
    }
}
