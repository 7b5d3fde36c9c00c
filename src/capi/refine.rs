//! The refinement as one call, and its report.

use super::args;
use super::control::{self, wsp_control};
use super::guard::call;
use super::options::{rule, sparsify, wsp_refine_options, wsp_sparsify};
use super::sized::{self, Sized_};
use super::status::*;
use super::triangulation::wsp_triangulation;
use crate::{RefineOptions, RefineReport, RefineStatus};

/// What a refinement did, and the mesh's quality now. After WSP_CANCELLED the tetrahedra have not been looked at, for that takes a while:
/// `tetrahedra` and `bad` are 0 then, and the ratio and the angle NaN. Fill it with wsp_report_init before it is given to wsp_refine.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_report {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// What wsp_refine returned.
    pub status: wsp_status,
    /// Vertices that are no Steiner points.
    pub input_vertices: usize,
    /// Vertices now.
    pub vertices: usize,
    /// Tetrahedra of the domain now.
    pub tetrahedra: usize,
    /// Vertices that are Steiner points: those of earlier calls and of the domain's recovery too.
    pub steiner: usize,
    /// Vertices that this call has added by the sampling rule.
    pub samples: usize,
    /// Vertices that this call has added to split segments.
    pub segment_splits: usize,
    /// Vertices that this call has added to split subfacets.
    pub facet_splits: usize,
    /// Tetrahedra of the domain that exceed the bound; 0 after WSP_DONE.
    pub bad: usize,
    /// The largest circumradius over shortest edge in the domain; 0 without tetrahedra.
    pub worst_radius_edge: f64,
    /// The smallest dihedral angle in the domain, in degrees; 180 without tetrahedra.
    pub min_dihedral_degrees: f64,
    /// Steiner points that this call has taken away again without putting another in their place.
    pub removed: usize,
    /// Steiner points that this call has put in the place of two each.
    pub replaced: usize,
}

// SAFETY: repr(C), numbers only, struct_size first.
unsafe impl Sized_ for wsp_report {
    const NAME: &'static str = "wsp_report";
    const SIZES: &'static [usize] = &[size_of::<Self>()];

    fn defaults() -> Self {
        wsp_report {
            struct_size: 0,
            status: WSP_DONE,
            input_vertices: 0,
            vertices: 0,
            tetrahedra: 0,
            steiner: 0,
            samples: 0,
            segment_splits: 0,
            facet_splits: 0,
            bad: 0,
            worst_radius_edge: 0.0,
            min_dihedral_degrees: 180.0,
            removed: 0,
            replaced: 0,
        }
    }
}

fn status(status: RefineStatus) -> wsp_status {
    match status {
        RefineStatus::Done => WSP_DONE,
        RefineStatus::Cancelled => WSP_CANCELLED,
        RefineStatus::VertexLimit => WSP_VERTEX_LIMIT,
        RefineStatus::Unrefined => WSP_UNREFINED,
        RefineStatus::TimeLimit => WSP_TIME_LIMIT,
        RefineStatus::MemoryLimit => WSP_MEMORY_LIMIT,
    }
}

impl From<&RefineReport> for wsp_report {
    fn from(report: &RefineReport) -> Self {
        wsp_report {
            struct_size: 0,
            status: status(report.status),
            input_vertices: report.input_vertices,
            vertices: report.vertices,
            tetrahedra: report.tetrahedra,
            steiner: report.steiner,
            samples: report.samples,
            segment_splits: report.segment_splits,
            facet_splits: report.facet_splits,
            bad: report.bad,
            worst_radius_edge: report.worst_radius_edge,
            min_dihedral_degrees: report.min_dihedral_degrees,
            removed: report.removed,
            replaced: report.replaced,
        }
    }
}

/// Makes `report` that of an empty mesh. `size` is `sizeof *report`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_report_init(report: *mut wsp_report, size: usize) -> wsp_status {
    call("wsp_report_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(report, size, "report")? };
        Ok(WSP_DONE)
    })
}

/// Adds Steiner points until no tetrahedron of the domain exceeds the bound on circumradius over shortest edge.
/// Without a domain the convex hull becomes the domain first (see wsp_triangulation_use_hull_as_domain). Input vertices
/// keep their ids, Steiner points are numbered behind them. With `sparsify` on, as it is by default, Steiner points of earlier calls
/// may be taken away too, and those that remain get new ids without gaps; with WSP_SPARSIFY_OFF all keep their ids.
///
/// Always ends: after WSP_CANCELLED, WSP_VERTEX_LIMIT, WSP_TIME_LIMIT, WSP_MEMORY_LIMIT and WSP_UNREFINED the mesh is valid, Delaunay and
/// usable, and the call may be repeated to go on. A cancellation is answered within some milliseconds; ids of Steiner points may have
/// gaps then, until a later call closes them. `options` and `control` may be NULL. `report` may be NULL; it is
/// written for all statuses of 0 and above, and left as it was after an error.
///
/// After WSP_ERR_TOO_MANY and WSP_ERR_MEMORY it is valid too, with what had been added.
///
/// Cost: about linear in the mesh that comes out.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_refine(
    triangulation: *mut wsp_triangulation,
    options: *const wsp_refine_options,
    control: *mut wsp_control,
    report: *mut wsp_report,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_refine", || unsafe {
        if !report.is_null() {
            sized::check_out(report, "report")?;
        }
        let options = sized::read(options, "options")?;
        let options = RefineOptions {
            radius_edge: options.radius_edge,
            rule: rule(options.rule)?,
            max_vertices: options.max_vertices,
            min_edge: options.min_edge,
            sparsify: sparsify(options.sparsify)?,
            max_seconds: options.max_seconds,
            max_memory: options.max_memory,
        };
        let control = control::core(control)?;
        let mut state = args::reference(triangulation, "triangulation")?.handle.write()?;
        let done = state.change(|mesh| mesh.refine(&options, &control))?;
        if !report.is_null() {
            sized::write(&wsp_report::from(&done), report, "report")?;
        }
        Ok(status(done.status))
    })
}

/// Takes Steiner points away, or puts one in the place of two neighbours, wherever every tetrahedron that comes keeps the bound
/// `radius_edge` (0.62 to 1e6). Works on any triangulation: its Steiner points are the vertices added since it has a domain. Without a domain
/// the convex hull becomes the domain first, and there are none. Input vertices keep their places and ids; segments and facets stay
/// covered by edges and faces; nothing becomes bad. The Steiner points that remain get new ids without gaps, in their order.
///
/// `level` is a WSP_SPARSIFY_ constant; WSP_SPARSIFY_DEFAULT stands for WSP_SPARSIFY_QUICK. wsp_refine with its option `sparsify` leaves
/// fewer points than this call afterwards. WSP_UNREFINED tells that tetrahedra exceed the bound, as they did before.
/// `control` and `report` may be NULL; `report` is written for all statuses of 0 and above, and left as it was after an error.
///
/// Cost: some tens of microseconds a Steiner point.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_sparsify_mesh(
    triangulation: *mut wsp_triangulation,
    radius_edge: f64,
    level: wsp_sparsify,
    control: *mut wsp_control,
    report: *mut wsp_report,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_sparsify_mesh", || unsafe {
        if !report.is_null() {
            sized::check_out(report, "report")?;
        }
        let level = sparsify(level)?.unwrap_or_default();
        let control = control::core(control)?;
        let mut state = args::reference(triangulation, "triangulation")?.handle.write()?;
        let done = state.change(|mesh| mesh.sparsify(radius_edge, level, &control))?;
        if !report.is_null() {
            sized::write(&wsp_report::from(&done), report, "report")?;
        }
        Ok(status(done.status))
    })
}
