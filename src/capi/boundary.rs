//! Arrays of a domain's boundary for reading in place.

use super::args;
use super::control::{self, wsp_control};
use super::guard::{call, Answer};
use super::sized::{self, Sized_};
use super::status::*;
use super::triangulation::wsp_triangulation;
use super::view::pointer;
use crate::{Control, Error};

/// The vertex lies on no segment and no facet.
pub const WSP_ON_NOTHING: u8 = 0;
/// The vertex is one of the input on the boundary: an end of a segment, a corner of a facet, or a point of the input that lies in one.
pub const WSP_ON_VERTEX: u8 = 1;
/// The vertex lies inside a segment.
pub const WSP_ON_SEGMENT: u8 = 2;
/// The vertex lies inside a facet.
pub const WSP_ON_FACET: u8 = 3;

/// The arrays of a domain's boundary. Fill it with wsp_boundary_view_init before it is given to a function.
///
/// Vertices are numbered by id, tetrahedra as in wsp_mesh_view. An array without elements may be NULL.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_boundary_view {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// 0.
    pub flags: u32,
    /// Three vertex ids a face, in the order of facets; counterclockwise seen from outside the first of its tetrahedra.
    pub faces: *const u32,
    /// The number of faces.
    pub faces_count: usize,
    /// The facet of each face: its number as wsp_plc_add_facets gave it, or a number of its own where the hull is the domain.
    pub face_facets: *const u32,
    /// The marker of each face's facet.
    pub face_markers: *const i32,
    /// Two tetrahedra a face, those on its sides: WSP_NONE for none. If there is but one, it is the first; of two it is the lower.
    pub face_tetrahedra: *const u32,
    /// Two vertex ids an edge, in the order of segments.
    pub edges: *const u32,
    /// The number of edges.
    pub edges_count: usize,
    /// A number of each edge's segment: all edges of one have it, and no others. Facets' sides are segments too.
    pub edge_segments: *const u32,
    /// The marker of each edge's segment: that of wsp_plc_add_segments, or for a facet's side that is no segment the marker of its first facet.
    pub edge_markers: *const i32,
    /// For each vertex id WSP_ON_NOTHING, WSP_ON_VERTEX, WSP_ON_SEGMENT or WSP_ON_FACET.
    pub vertex_kinds: *const u8,
    /// For each vertex id the segment or facet that it lies inside of, by the numbers of `edge_segments` and `face_facets`; else WSP_NONE.
    pub vertex_elements: *const u32,
    /// Vertex ids run from 0 to one below this.
    pub vertices_count: usize,
}

// SAFETY: repr(C), numbers and raw pointers only, struct_size first.
unsafe impl Sized_ for wsp_boundary_view {
    const NAME: &'static str = "wsp_boundary_view";
    const SIZES: &'static [usize] = &[size_of::<Self>()];

    fn defaults() -> Self {
        wsp_boundary_view {
            struct_size: 0,
            flags: 0,
            faces: std::ptr::null(),
            faces_count: 0,
            face_facets: std::ptr::null(),
            face_markers: std::ptr::null(),
            face_tetrahedra: std::ptr::null(),
            edges: std::ptr::null(),
            edges_count: 0,
            edge_segments: std::ptr::null(),
            edge_markers: std::ptr::null(),
            vertex_kinds: std::ptr::null(),
            vertex_elements: std::ptr::null(),
            vertices_count: 0,
        }
    }
}

/// Makes `view` an empty boundary. `size` is `sizeof *view`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_boundary_view_init(view: *mut wsp_boundary_view, size: usize) -> wsp_status {
    call("wsp_boundary_view_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(view, size, "view")? };
        Ok(WSP_DONE)
    })
}

/// Shows the boundary of the domain in place: its faces and edges as the mesh has them now, with the markers of facets and segments, and for each
/// vertex what it lies on, Steiner points too. Without a domain all arrays are empty. Nothing is copied for the caller, and nothing is to be freed: the
/// arrays are valid until the next call that changes or frees `triangulation`. `control`, which may be NULL, cancels: WSP_CANCELLED then.
///
/// Cost: the arrays are made at the first call after a change, in time linear in the mesh; further calls cost nothing.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_MEMORY, WSP_ERR_BUSY. After these and WSP_CANCELLED `view` is left as it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_boundary(
    triangulation: *const wsp_triangulation,
    control: *mut wsp_control,
    view: *mut wsp_boundary_view,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_boundary", || unsafe {
        sized::check_out(view, "view")?;
        let control = control::core(control)?;
        show(triangulation, view, &control)
    })
}

/// # Safety
/// `triangulation` is NULL or live, `view` a live struct whose size has been checked.
unsafe fn show(triangulation: *const wsp_triangulation, view: *mut wsp_boundary_view, control: &Control) -> Answer {
    // SAFETY: as the caller promises.
    unsafe {
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        // Arrays that are there already need no look at the control.
        if !control.poll() {
            return Ok(WSP_CANCELLED);
        }
        let shown = match state.mesh.try_boundary_view(control) {
            Ok(shown) => shown,
            Err(Error::Cancelled) => return Ok(WSP_CANCELLED),
            Err(error) => return Err(error.into()),
        };
        let arrays = wsp_boundary_view {
            faces: pointer(shown.faces),
            faces_count: shown.faces.len(),
            face_facets: pointer(shown.face_facets),
            face_markers: pointer(shown.face_markers),
            face_tetrahedra: pointer(shown.face_tetrahedra),
            edges: pointer(shown.edges),
            edges_count: shown.edges.len(),
            edge_segments: pointer(shown.edge_segments),
            edge_markers: pointer(shown.edge_markers),
            vertex_kinds: pointer(shown.vertex_kinds),
            vertex_elements: pointer(shown.vertex_elements),
            vertices_count: shown.vertex_kinds.len(),
            ..wsp_boundary_view::defaults()
        };
        sized::write(&arrays, view, "view")?;
        Ok(WSP_DONE)
    }
}
