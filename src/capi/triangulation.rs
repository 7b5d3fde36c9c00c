//! The triangulation handle: a mesh, and the domain that it fills once one is set.

use std::sync::atomic::{AtomicU64, Ordering};

use super::control::{self, wsp_control};
use super::guard::{call, call_void, Answer, Failure};
use super::handle::Handle;
use super::options::wsp_triangulation_options;
use super::plc::wsp_plc;
use super::status::*;
use super::{args, sized};
use crate::triangulation::Defect;
use crate::{Control, Error, Location, Mesh};

/// A Delaunay triangulation of points of any dimension, and the domain that it fills once one is set.
pub struct wsp_triangulation {
    pub(super) handle: Handle<State>,
}

/// What the handle guards.
pub(super) struct State {
    pub mesh: Mesh,
    /// Unique to this state of this mesh (and of clones as long as neither changes): batches remember it.
    pub stamp: u64,
}

impl State {
    pub fn new(mesh: Mesh) -> State {
        State { mesh, stamp: fresh_stamp() }
    }

    /// To be called after every change.
    pub fn changed(&mut self) {
        self.stamp = fresh_stamp();
    }

    /// Makes a change that may stop half-way with an error: whatever has changed then, batches of before are stale.
    pub fn change<T>(&mut self, change: impl FnOnce(&mut Mesh) -> Result<T, Error>) -> Result<T, Error> {
        let look = |mesh: &Mesh| (mesh.triangulation().vertex_count(), mesh.has_domain());
        let before = look(&self.mesh);
        let result = change(&mut self.mesh);
        if result.is_ok() || look(&self.mesh) != before {
            self.changed();
        }
        result
    }
}

fn fresh_stamp() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// # Safety
/// `out` has passed `args::handle_out`.
unsafe fn give(mesh: Mesh, out: *mut *mut wsp_triangulation) {
    // SAFETY: as the caller promises.
    unsafe { args::give(wsp_triangulation { handle: Handle::new(State::new(mesh)) }, out) };
}

/// A point is at a vertex: `vertices[0]`.
pub const WSP_AT_VERTEX: u32 = 0;
/// A point is inside an edge: `vertices[0..2]`.
pub const WSP_IN_EDGE: u32 = 1;
/// A point is inside a triangle: `vertices[0..3]`.
pub const WSP_IN_FACE: u32 = 2;
/// A point is inside a tetrahedron: `vertices[0..4]`.
pub const WSP_IN_TETRAHEDRON: u32 = 3;
/// A point is outside the convex hull, or the triangulation has no tetrahedra and no vertex there.
pub const WSP_OUTSIDE: u32 = 4;

/// Where a point is.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct wsp_location {
    /// WSP_AT_VERTEX, WSP_IN_EDGE, WSP_IN_FACE, WSP_IN_TETRAHEDRON or WSP_OUTSIDE.
    pub kind: u32,
    /// The vertices of what the point is in; WSP_NONE for the rest.
    pub vertices: [u32; 4],
}

impl From<Location> for wsp_location {
    fn from(location: Location) -> Self {
        let (kind, ids): (u32, &[u32]) = match &location {
            Location::Vertex(vertex) => (WSP_AT_VERTEX, std::slice::from_ref(vertex)),
            Location::Edge(edge) => (WSP_IN_EDGE, edge),
            Location::Face(face) => (WSP_IN_FACE, face),
            Location::Tetrahedron(tetrahedron) => (WSP_IN_TETRAHEDRON, tetrahedron),
            Location::Outside => (WSP_OUTSIDE, &[]),
        };
        let mut vertices = [WSP_NONE; 4];
        vertices[..ids.len()].copy_from_slice(ids);
        wsp_location { kind, vertices }
    }
}

/// Makes an empty triangulation without a domain. `options` may be NULL: the defaults.
///
/// `*out` belongs to the caller: free it with wsp_triangulation_free. On an error it is NULL.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_new(
    options: *const wsp_triangulation_options,
    out: *mut *mut wsp_triangulation,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_new", || unsafe {
        args::handle_out(out, "out")?;
        let options = sized::read(options, "options")?;
        options.check()?;
        let mut mesh = Mesh::new();
        mesh.set_threads(options.threads as usize);
        give(mesh, out);
        Ok(WSP_DONE)
    })
}

/// Triangulates a complex's points and makes the complex the domain. The vertex of the complex's point i is the
/// one that wsp_triangulation_insert would give it. Segments and facets are recovered: where they are missing from the
/// Delaunay triangulation they are split, so there may be more vertices than points: those on segments and facets are Steiner points, and
/// wsp_triangulation_boundary tells which they are.
///
/// `plc` is copied: it may be changed or freed afterwards. `options` and `control` may be NULL.
/// `*out` belongs to the caller: free it with wsp_triangulation_free. It is NULL on an error and after
/// WSP_CANCELLED.
///
/// A complex of points alone, without facets and segments, gets its hull as the domain; its regions and holes are ignored then.
///
/// The domain is what the facets enclose, less the volumes around the seeds of holes; it need not be convex. It is checked exactly
/// before anything is made of it, as wsp_plc_check does. Where segments or facets meet at less than 60 degrees, tetrahedra
/// between them may be left bad (WSP_UNREFINED).
///
/// Cost: that of inserting the points and splits.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_INVALID_DOMAIN, WSP_ERR_TOO_MANY,
/// WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_from_plc(
    plc: *const wsp_plc,
    options: *const wsp_triangulation_options,
    control: *mut wsp_control,
    out: *mut *mut wsp_triangulation,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_from_plc", || unsafe {
        args::handle_out(out, "out")?;
        let plc = args::reference(plc, "plc")?.handle.read()?;
        let options = sized::read(options, "options")?;
        options.check()?;
        let control = control::core(control)?;
        let threads = options.threads as usize;
        let made = match options.keep_boundary {
            0 => Mesh::from_plc_on(threads, &plc, &control),
            _ => Mesh::from_plc_kept(threads, &plc, &control),
        };
        match made {
            Ok(mesh) => give(mesh, out),
            Err(Error::Cancelled) => return Ok(WSP_CANCELLED),
            Err(error) => return Err(error.into()),
        }
        Ok(WSP_DONE)
    })
}

/// Makes the convex hull of the present points the domain: its facets are kept, and refinement stays within it.
/// For points whose hull has no volume the domain is empty.
///
/// Cost: linear in the hull.
/// Errors: WSP_ERR_NULL, WSP_ERR_DOMAIN (there is one already), WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_use_hull_as_domain(triangulation: *mut wsp_triangulation) -> wsp_status {
    // SAFETY: NULL or live.
    call("wsp_triangulation_use_hull_as_domain", || unsafe { change(triangulation, Mesh::use_hull_as_domain) })
}

/// wsp_triangulation_use_hull_as_domain that `control`, which may be NULL, cancels: WSP_CANCELLED then, and nothing has changed.
/// Errors: those of wsp_triangulation_use_hull_as_domain.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_use_hull_as_domain_within(
    triangulation: *mut wsp_triangulation,
    control: *mut wsp_control,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_use_hull_as_domain_within", || unsafe {
        let control = control::core(control)?;
        change(triangulation, |mesh| mesh.use_hull_as_domain_within(&control))
    })
}

/// Makes a change that may be cancelled.
///
/// # Safety
/// `triangulation` is NULL or live.
unsafe fn change(triangulation: *mut wsp_triangulation, change: impl FnOnce(&mut Mesh) -> Result<(), Error>) -> Answer {
    // SAFETY: as the caller promises.
    let mut state = unsafe { args::reference(triangulation, "triangulation")? }.handle.write()?;
    match state.change(change) {
        Ok(()) => Ok(WSP_DONE),
        Err(Error::Cancelled) => Ok(WSP_CANCELLED),
        Err(error) => Err(error.into()),
    }
}

/// Makes a copy, domain included, that shares nothing with the original. Batches of the one fit the other as long
/// as neither has changed.
///
/// `*out` belongs to the caller: free it with wsp_triangulation_free. On an error it is NULL.
/// Cost: linear in the triangulation.
/// Errors: WSP_ERR_NULL, WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_clone(
    triangulation: *const wsp_triangulation,
    out: *mut *mut wsp_triangulation,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_clone", || unsafe {
        args::handle_out(out, "out")?;
        clone(triangulation, &Control::new(), out)
    })
}

/// wsp_triangulation_clone that `control`, which may be NULL, cancels: WSP_CANCELLED then, and `*out` is NULL.
/// Errors: those of wsp_triangulation_clone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_clone_within(
    triangulation: *const wsp_triangulation,
    control: *mut wsp_control,
    out: *mut *mut wsp_triangulation,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_clone_within", || unsafe {
        args::handle_out(out, "out")?;
        let control = control::core(control)?;
        clone(triangulation, &control, out)
    })
}

/// # Safety
/// `triangulation` is NULL or live; `out` has passed `args::handle_out`.
unsafe fn clone(
    triangulation: *const wsp_triangulation,
    control: &Control,
    out: *mut *mut wsp_triangulation,
) -> Answer {
    // SAFETY: as the caller promises.
    unsafe {
        let original = args::reference(triangulation, "triangulation")?.handle.read()?;
        let mesh = match original.mesh.try_clone(control) {
            Err(Error::Cancelled) => return Ok(WSP_CANCELLED),
            other => other?,
        };
        let state = State { mesh, stamp: original.stamp };
        args::give(wsp_triangulation { handle: Handle::new(state) }, out);
    }
    Ok(WSP_DONE)
}

/// Frees a triangulation; NULL is ignored. Called while another call uses the handle (from a callback of that call,
/// say) it frees nothing and leaves a text for wsp_last_error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_free(triangulation: *mut wsp_triangulation) {
    // SAFETY: NULL, or a triangulation that is not used after this.
    call_void("wsp_triangulation_free", || unsafe {
        if triangulation.as_ref().is_some_and(|t| t.handle.in_use()) {
            return Err(Failure::new(WSP_ERR_BUSY, "another call is using the handle: not freed"));
        }
        args::free(triangulation);
        Ok(())
    });
}

/// Inserts `n` points, three doubles each. `ids` may be NULL; otherwise it has room for `n`, and `ids[i]` becomes the
/// vertex id of point i. Ids are numbered in the order of insertion and stay; a duplicate has the id of the first
/// point at its place. A new vertex that is inserted alone (`n` is 1) takes the id of the vertex removed last, if there
/// is one; more at once are numbered behind all ids of before. Points are decided exactly, and cospherical ones by a symbolic perturbation, so the result
/// does not depend on the order of insertion.
///
/// All or nothing: after an error or WSP_CANCELLED the triangulation is as it was, and `ids` too.
/// `n` may be 0, `xyz` is then not looked at; nor is it for an `n` that ids can't number (WSP_ERR_TOO_MANY). A coordinate of -0 is stored as 0.
/// `control` may be NULL. `xyz` and `ids` may overlap.
///
/// Cost: many points at once are far cheaper than one by one: they are inserted in a spatial order. Expect n log n,
/// with about a million points a second or two.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY,
/// WSP_ERR_DOMAIN (there is one: from then on only batches and wsp_refine add points).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_insert(
    triangulation: *mut wsp_triangulation,
    xyz: *const f64,
    n: usize,
    ids: *mut u32,
    control: *mut wsp_control,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_triangulation_insert", || unsafe {
        let control = control::core(control)?;
        let mut new_ids = Vec::new();
        {
            args::numbered(n, "xyz")?;
            let points = args::points(xyz, n, "xyz")?;
            if n > 0 && !ids.is_null() {
                args::writable(ids, "ids")?;
            }
            let mut state = args::reference(triangulation, "triangulation")?.handle.write()?;
            if !state.mesh.insert(points, Some(&mut new_ids), &control)? {
                return Ok(WSP_CANCELLED);
            }
            state.changed();
        }
        if !ids.is_null() {
            std::ptr::copy(new_ids.as_ptr(), ids, n.min(new_ids.len()));
        }
        Ok(WSP_DONE)
    })
}

/// Removes a vertex. The triangulation is then that of the other points, exactly as if this one had never been
/// there, and its dimension may have dropped. The other vertices keep their ids; this one names no vertex until an
/// insertion takes it again, and holds NaN in the view's points.
///
/// Cost: that of a triangulation of the vertex's neighbours by themselves, as of some fifteen insertions inside
/// scattered points; linear in all vertices when the others lie in a plane.
/// Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX, WSP_ERR_DOMAIN (there is one: its vertices stay), WSP_ERR_TOO_MANY,
/// WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_remove(triangulation: *mut wsp_triangulation, vertex: u32) -> wsp_status {
    // SAFETY: NULL or live.
    call("wsp_triangulation_remove", || unsafe { change(triangulation, |mesh| mesh.remove(vertex)) })
}

/// wsp_triangulation_remove that `control`, which may be NULL, cancels: WSP_CANCELLED then, and nothing has changed. That is of use for vertices with
/// thousands of neighbours only. Once all is known that takes the place of the vertex's tetrahedra, the change is made without another look at the
/// control; it takes a tenth of the time or less.
/// Errors: those of wsp_triangulation_remove.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_remove_within(
    triangulation: *mut wsp_triangulation,
    vertex: u32,
    control: *mut wsp_control,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_remove_within", || unsafe {
        let control = control::core(control)?;
        change(triangulation, |mesh| mesh.remove_within(vertex, &control))
    })
}

/// Finds the vertex, edge, face or tetrahedron of the hull that `p` is in, exactly. `hint` is a vertex near `p` or
/// WSP_NONE.
///
/// Cost: a walk from the hint; without one it starts anywhere.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_NO_SUCH_VERTEX (the hint), WSP_ERR_BUSY.
/// cbindgen:ptrs-as-arrays=[[p; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_locate(
    triangulation: *const wsp_triangulation,
    p: *const f64,
    hint: u32,
    location: *mut wsp_location,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_locate", || unsafe {
        args::writable(location, "location")?;
        let p = args::point(p, "p")?;
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        let triangulation = state.mesh.triangulation();
        let hint = (hint != WSP_NONE).then_some(hint);
        if let Some(vertex) = hint {
            if triangulation.point(vertex).is_none() {
                return Err(Error::NoSuchVertex { vertex }.into());
            }
        }
        args::store(location, triangulation.locate(p, hint).into(), "location")?;
        Ok(WSP_DONE)
    })
}

/// The triangulation's dimension: -1 without points, 0 one point, 1 collinear, 2 coplanar, 3 otherwise. Only then
/// there are tetrahedra. Constant time.
/// Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_dimension(
    triangulation: *const wsp_triangulation,
    dimension: *mut i32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_dimension", || unsafe {
        args::writable(dimension, "dimension")?;
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        args::store(dimension, state.mesh.triangulation().dimension(), "dimension")?;
        Ok(WSP_DONE)
    })
}

/// The numbers of vertices (duplicates count once, removed ones not) and of tetrahedra within the convex hull. Either
/// pointer may be NULL. Constant time. After removals ids may be above the number of vertices: those of
/// wsp_mesh_view::points_count are not.
/// Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_counts(
    triangulation: *const wsp_triangulation,
    vertices: *mut usize,
    tetrahedra: *mut usize,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_counts", || unsafe {
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        let triangulation = state.mesh.triangulation();
        if !vertices.is_null() {
            args::store(vertices, triangulation.vertex_count(), "vertices")?;
        }
        if !tetrahedra.is_null() {
            args::store(tetrahedra, triangulation.tetrahedron_count(), "tetrahedra")?;
        }
        Ok(WSP_DONE)
    })
}

/// Whether a domain has been set: 1 or 0. Constant time.
/// Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_has_domain(
    triangulation: *const wsp_triangulation,
    has_domain: *mut u32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_has_domain", || unsafe {
        args::writable(has_domain, "has_domain")?;
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        args::store(has_domain, state.mesh.has_domain().into(), "has_domain")?;
        Ok(WSP_DONE)
    })
}

/// Where a vertex is: three doubles. Constant time; for many points use wsp_triangulation_view.
/// Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX, WSP_ERR_BUSY.
/// cbindgen:ptrs-as-arrays=[[xyz; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_point(
    triangulation: *const wsp_triangulation,
    vertex: u32,
    xyz: *mut f64,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_point", || unsafe {
        args::writable(xyz, "xyz")?;
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        let point = state.mesh.triangulation().point(vertex).ok_or(Error::NoSuchVertex { vertex })?;
        args::store(xyz.cast(), point.to_array(), "xyz")?;
        Ok(WSP_DONE)
    })
}

/// Every tetrahedron's neighbours know it, every vertex has a tetrahedron, the surface is closed.
pub const WSP_VALIDATE_TOPOLOGY: u32 = 1;
/// And every tetrahedron is positively oriented.
pub const WSP_VALIDATE_ORIENTATION: u32 = 2;
/// And the triangulation is Delaunay, by exact arithmetic, and all subsegments and subfacets are in it, facets consist of
/// theirs, and regions meet at them only.
pub const WSP_VALIDATE_DELAUNAY: u32 = 3;
/// And no tetrahedron of the domain exceeds the bound on the radius-edge ratio, by exact arithmetic.
pub const WSP_VALIDATE_QUALITY: u32 = 4;

/// Checks a triangulation from the ground up, for tests and bug reports: WSP_DONE if it holds, WSP_ERR_NOT_VALID with a
/// text that names what does not. `level` is a WSP_VALIDATE_ constant; each includes those before it.
/// `radius_edge` is looked at for WSP_VALIDATE_QUALITY only.
///
/// Cost: linear in the triangulation.
/// Errors: WSP_ERR_NOT_VALID, WSP_ERR_NULL, WSP_ERR_ARGUMENT (the level), WSP_ERR_OPTION (the bound), WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_validate(
    triangulation: *const wsp_triangulation,
    level: u32,
    radius_edge: f64,
) -> wsp_status {
    // SAFETY: NULL or live.
    call("wsp_triangulation_validate", || unsafe { validate(triangulation, level, radius_edge, &Control::new()) })
}

/// wsp_triangulation_validate that `control`, which may be NULL, follows and cancels: WSP_CANCELLED then.
/// Errors: those of wsp_triangulation_validate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_validate_within(
    triangulation: *const wsp_triangulation,
    level: u32,
    radius_edge: f64,
    control: *mut wsp_control,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_triangulation_validate_within", || unsafe {
        let control = control::core(control)?;
        validate(triangulation, level, radius_edge, &control)
    })
}

/// # Safety
/// `triangulation` is NULL or live.
unsafe fn validate(triangulation: *const wsp_triangulation, level: u32, radius_edge: f64, control: &Control) -> Answer {
    // SAFETY: as the caller promises.
    let state = unsafe { args::reference(triangulation, "triangulation")? }.handle.read()?;
    if !(WSP_VALIDATE_TOPOLOGY..=WSP_VALIDATE_QUALITY).contains(&level) {
        return Err(Failure::new(WSP_ERR_ARGUMENT, format!("level is {level}, expected 1 to 4")));
    }
    let bound = if level == WSP_VALIDATE_QUALITY { Some(args::radius_edge(radius_edge)?) } else { None };
    let not_valid = |defect: Defect| Failure::new(WSP_ERR_NOT_VALID, defect.to_string());
    if !state.mesh.validate_within(level.min(WSP_VALIDATE_DELAUNAY), control).map_err(not_valid)? {
        return Ok(WSP_CANCELLED);
    }
    let good = match bound {
        Some(bound) => state.mesh.validate_quality_within(bound, control).map_err(not_valid)?,
        None => true,
    };
    Ok(if good { WSP_DONE } else { WSP_CANCELLED })
}
