//! The boundary of a domain as arrays: the faces on its facets and the edges on its segments, with the caller's markers, and what each vertex lies on.

use super::Mesh;
use crate::domain::{Boundary, Carrier};
use crate::leavings::{InPieces, Leavings};
use crate::sorting::sort;
use crate::triangulation::remove::oriented_face;
use crate::triangulation::topology::{slot_of, tet_of};
use crate::{memory, Control, Error};

/// What a vertex lies on, in [`BoundaryView::vertex_kinds`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
#[non_exhaustive]
pub enum On {
    /// No segment and no facet.
    #[default]
    Nothing = 0,
    /// It is a vertex of the input on the boundary: an end of a segment, a corner of a facet, or a point of the input that lies in one.
    Vertex = 1,
    /// It lies inside a segment.
    Segment = 2,
    /// It lies inside a facet.
    Facet = 3,
}

/// The boundary's arrays; they are empty without a domain. Vertices are numbered by id.
#[derive(Clone, Copy, Debug)]
pub struct BoundaryView<'a> {
    /// Three vertex ids a face, in the order of facets. Counterclockwise seen from outside the tetrahedron on the face's first side.
    pub faces: &'a [[u32; 3]],
    /// The facet of each face: its position in [`Plc::facets`](crate::Plc::facets), or, where the hull is the domain, some number of its own.
    pub face_facets: &'a [u32],
    /// The marker of each face's facet.
    pub face_markers: &'a [i32],
    /// On the two sides of each face the tetrahedra, as [`MeshView`](super::MeshView) numbers them; `u32::MAX` for none there. If there is but one, it is the first; of
    /// two it is the lower.
    pub face_tetrahedra: &'a [[u32; 2]],
    /// Two vertex ids an edge, in the order of segments.
    pub edges: &'a [[u32; 2]],
    /// A number of each edge's segment: all edges of one have it, and no others.
    pub edge_segments: &'a [u32],
    /// The marker of each edge's segment. A facet's side that is no segment of the complex has the marker of its first facet.
    pub edge_markers: &'a [i32],
    /// One entry a vertex id.
    pub vertex_kinds: &'a [On],
    /// The segment or facet that a vertex lies inside of, by the numbers of `edge_segments` and `face_facets`; `u32::MAX` for vertices that lie in none.
    pub vertex_elements: &'a [u32],
}

/// What a [`BoundaryView`] shows.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    faces: Vec<[u32; 3]>,
    face_facets: Vec<u32>,
    face_markers: Vec<i32>,
    face_tetrahedra: Vec<[u32; 2]>,
    edges: Vec<[u32; 2]>,
    edge_segments: Vec<u32>,
    edge_markers: Vec<i32>,
    vertex_kinds: Vec<On>,
    vertex_elements: Vec<u32>,
}

const NONE: u32 = u32::MAX;
const WHAT: &str = "boundary";

impl Mesh {
    /// The domain's boundary as arrays. They are made at the first call after a change; the cost is that of finding each face in the triangulation.
    pub fn boundary_view(&self) -> BoundaryView<'_> {
        match self.try_boundary_view(Control::never()) {
            Ok(view) => view,
            // As other lists of Rust do that find no memory.
            Err(_) => std::alloc::handle_alloc_error(std::alloc::Layout::new::<Outline>()),
        }
    }

    /// [`boundary_view`](Self::boundary_view), unless memory is lacking; [`Error::Cancelled`] when the control says stop.
    pub fn try_boundary_view(&self, control: &Control) -> Result<BoundaryView<'_>, Error> {
        let outline = match self.outline.get() {
            Some(outline) => outline,
            None => {
                let outline = self.make_outline(control)?;
                self.outline.get_or_init(|| outline)
            }
        };
        Ok(BoundaryView {
            faces: &outline.faces,
            face_facets: &outline.face_facets,
            face_markers: &outline.face_markers,
            face_tetrahedra: &outline.face_tetrahedra,
            edges: &outline.edges,
            edge_segments: &outline.edge_segments,
            edge_markers: &outline.edge_markers,
            vertex_kinds: &outline.vertex_kinds,
            vertex_elements: &outline.vertex_elements,
        })
    }

    fn make_outline(&self, control: &Control) -> Result<Outline, Error> {
        let mut outline = InPieces::new(Outline::default(), control);
        if let Some(boundary) = self.boundary() {
            self.show_faces(boundary, &mut outline, control)?;
            show_edges(boundary, &mut outline, control)?;
            self.show_vertices(boundary, &mut outline, control)?;
        }
        Ok(outline.keep())
    }

    fn show_faces(&self, boundary: &Boundary, outline: &mut Outline, control: &Control) -> Result<(), Error> {
        let (number, _) = self.number_inside(control)?;
        let all = in_order(boundary.each_subfacet(), boundary, control)?;
        let turns = control.turns();
        memory::reserve_exact(&mut outline.faces, all.len(), WHAT)?;
        memory::reserve_exact(&mut outline.face_facets, all.len(), WHAT)?;
        memory::reserve_exact(&mut outline.face_markers, all.len(), WHAT)?;
        memory::reserve_exact(&mut outline.face_tetrahedra, all.len(), WHAT)?;
        for &(facet, face) in all.iter() {
            turns.check()?;
            // One that is missing, where a refinement was cancelled amid a change, is no face of the mesh.
            let Some(side) = self.t.find_face_within(face, control)? else { continue };
            let other = self.t.topology.tet(tet_of(side)).n[slot_of(side)];
            let [here, there] = [side, other].map(|side| number[tet_of(side) as usize]);
            let (first, tetrahedra) = if here <= there { (side, [here, there]) } else { (other, [there, here]) };
            outline.faces.push(oriented_face(&self.t.topology.tet(tet_of(first)).v, slot_of(first)));
            outline.face_facets.push(facet);
            outline.face_markers.push(boundary.facets()[facet as usize].marker);
            outline.face_tetrahedra.push(tetrahedra);
        }
        Ok(())
    }

    fn show_vertices(&self, boundary: &Boundary, outline: &mut Outline, control: &Control) -> Result<(), Error> {
        let count = self.t.vertex_slots();
        memory::lengthen(&mut outline.vertex_kinds, count, On::Nothing, WHAT, control)?;
        memory::lengthen(&mut outline.vertex_elements, count, NONE, WHAT, control)?;
        outline.vertex_kinds.truncate(count);
        outline.vertex_elements.truncate(count);
        let turns = control.turns();
        for v in self.t.vertices() {
            turns.check()?;
            let (kind, element) = match boundary.carrier(v) {
                Carrier::Free => continue,
                Carrier::Vertex(_) => (On::Vertex, NONE),
                Carrier::Segment(segment) => (On::Segment, segment),
                Carrier::Facet(facet) => (On::Facet, facet),
            };
            outline.vertex_kinds[v as usize] = kind;
            outline.vertex_elements[v as usize] = element;
        }
        Ok(())
    }

    /// How many Steiner points lie on segments, and how many on facets but on no segment.
    pub(super) fn steiner_on_boundary(&self, control: &Control) -> Result<[usize; 2], Error> {
        let (mut counts, turns) = ([0; 2], control.turns());
        let Some(boundary) = self.boundary() else { return Ok(counts) };
        for v in self.input_vertex_slots() as u32..self.t.vertex_slots() as u32 {
            turns.check()?;
            match boundary.carrier(v) {
                Carrier::Segment(_) => counts[0] += usize::from(self.t.is_vertex(v)),
                Carrier::Facet(_) => counts[1] += usize::from(self.t.is_vertex(v)),
                Carrier::Free | Carrier::Vertex(_) => {}
            }
        }
        Ok(counts)
    }
}

/// The boundary's edges, or its faces, in the order of what they are parts of.
fn in_order<'a, K: Copy + Ord + Send + 'static>(
    elements: impl Iterator<Item = (K, u32)>,
    boundary: &Boundary,
    control: &'a Control,
) -> Result<InPieces<'a, Vec<(u32, K)>>, Error> {
    let mut all = memory::room_in_pieces(boundary.element_count(), WHAT, control)?;
    let turns = control.turns();
    for (element, of) in elements {
        turns.check()?;
        all.push((of, element));
    }
    sort(&mut all, &control.watch())?;
    Ok(all)
}

fn show_edges(boundary: &Boundary, outline: &mut Outline, control: &Control) -> Result<(), Error> {
    let all = in_order(boundary.each_subsegment(), boundary, control)?;
    let turns = control.turns();
    memory::reserve_exact(&mut outline.edges, all.len(), WHAT)?;
    memory::reserve_exact(&mut outline.edge_segments, all.len(), WHAT)?;
    memory::reserve_exact(&mut outline.edge_markers, all.len(), WHAT)?;
    for &(segment, edge) in all.iter() {
        turns.check()?;
        outline.edges.push(edge);
        outline.edge_segments.push(segment);
        outline.edge_markers.push(boundary.segments()[segment as usize].marker);
    }
    Ok(())
}

impl Leavings for Outline {
    fn give_back(&mut self) -> bool {
        self.faces.give_back()
            || self.face_facets.give_back()
            || self.face_markers.give_back()
            || self.face_tetrahedra.give_back()
            || self.edges.give_back()
            || self.edge_segments.give_back()
            || self.edge_markers.give_back()
            || self.vertex_kinds.give_back()
            || self.vertex_elements.give_back()
    }
}

#[cfg(test)]
mod tests;
