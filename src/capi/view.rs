//! Arrays of a mesh for reading in place.

use super::args;
use super::control::{self, wsp_control};
use super::guard::{call, Answer};
use super::sized::{self, Sized_};
use super::status::*;
use super::triangulation::wsp_triangulation;
use crate::{Control, Error};

/// The arrays of a mesh. Fill it with wsp_mesh_view_init before it is given to a function.
///
/// Vertices are numbered by id, tetrahedra by their place in the array. An array without elements may be NULL.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_mesh_view {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// 0.
    pub flags: u32,
    /// Three coordinates a vertex id, `3 * points_count` doubles. Ids without a vertex hold NaN.
    pub points: *const f64,
    /// Vertex ids run from 0 to one below this.
    pub points_count: usize,
    /// Four vertex ids a tetrahedron a b c d, positively oriented: det[b-a, c-a, d-a] > 0.
    pub tetrahedra: *const u32,
    /// The number of tetrahedra: those of the domain, or without a domain those of the hull.
    pub tetrahedra_count: usize,
    /// Four tetrahedra a tetrahedron: the one across the face opposite each vertex, WSP_NONE where there is none.
    pub neighbours: *const u32,
    /// The region of each tetrahedron: 1 + the position of the wsp_plc_add_region that labels it, 0 for none.
    pub regions: *const u32,
    /// For wsp_sample_mesh, three vertex ids a face: inner faces that bound a part of the domain, and any face of its boundary that
    /// is to have a number. wsp_triangulation_view gives none.
    pub faces: *const u32,
    /// The number of `faces`.
    pub faces_count: usize,
    /// The number of each face's facet, for all of `faces` or NULL.
    pub facets: *const u32,
}

// SAFETY: repr(C), numbers and raw pointers only, struct_size first.
unsafe impl Sized_ for wsp_mesh_view {
    const NAME: &'static str = "wsp_mesh_view";
    const SIZES: &'static [usize] = &[std::mem::offset_of!(wsp_mesh_view, faces), size_of::<Self>()];

    fn defaults() -> Self {
        wsp_mesh_view {
            struct_size: 0,
            flags: 0,
            points: std::ptr::null(),
            points_count: 0,
            tetrahedra: std::ptr::null(),
            tetrahedra_count: 0,
            neighbours: std::ptr::null(),
            regions: std::ptr::null(),
            faces: std::ptr::null(),
            faces_count: 0,
            facets: std::ptr::null(),
        }
    }
}

/// Makes `view` an empty mesh. `size` is `sizeof *view`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_mesh_view_init(view: *mut wsp_mesh_view, size: usize) -> wsp_status {
    call("wsp_mesh_view_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(view, size, "view")? };
        Ok(WSP_DONE)
    })
}

pub(super) fn pointer<T, U>(items: &[T]) -> *const U {
    if items.is_empty() {
        std::ptr::null()
    } else {
        items.as_ptr().cast()
    }
}

/// Shows the mesh's arrays in place: nothing is copied for the caller, and nothing is to be freed. The arrays are
/// valid until the next call that changes or frees `triangulation`. Use of ids: see wsp_triangulation_insert.
///
/// Cost: the arrays are made at the first call after a change, in linear time; further calls cost nothing.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_MEMORY, WSP_ERR_BUSY; `view` is left as it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_view(
    triangulation: *const wsp_triangulation,
    view: *mut wsp_mesh_view,
) -> wsp_status {
    // SAFETY: both are NULL or live.
    call("wsp_triangulation_view", || unsafe { show(triangulation, view, &Control::new()) })
}

/// wsp_triangulation_view that `control`, which may be NULL, follows and cancels: WSP_CANCELLED then, and `view` is left as it was.
/// Errors: those of wsp_triangulation_view.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_view_within(
    triangulation: *const wsp_triangulation,
    view: *mut wsp_mesh_view,
    control: *mut wsp_control,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_view_within", || unsafe {
        let control = control::core(control)?;
        show(triangulation, view, &control)
    })
}

/// # Safety
/// Both are NULL or live.
unsafe fn show(triangulation: *const wsp_triangulation, view: *mut wsp_mesh_view, control: &Control) -> Answer {
    // SAFETY: as the caller promises; the size is checked before anything is written.
    unsafe {
        sized::check_out(view, "view")?;
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        // A view that is there already needs no look at the control.
        if !control.poll() {
            return Ok(WSP_CANCELLED);
        }
        let mesh = match state.mesh.try_view(control) {
            Ok(mesh) => mesh,
            Err(Error::Cancelled) => return Ok(WSP_CANCELLED),
            Err(error) => return Err(error.into()),
        };
        let arrays = wsp_mesh_view {
            points: pointer(mesh.points),
            points_count: mesh.points.len(),
            tetrahedra: pointer(mesh.tetrahedra),
            tetrahedra_count: mesh.tetrahedra.len(),
            neighbours: pointer(mesh.neighbours),
            regions: pointer(mesh.regions),
            ..wsp_mesh_view::defaults()
        };
        sized::write(&arrays, view, "view")?;
        Ok(WSP_DONE)
    }
}
