//! Looking at a triangulation step by step: its bad short edges, and what is around an edge.

use super::args;
use super::control::{self, wsp_control};
use super::guard::{call, Answer};
use super::status::*;
use super::triangulation::wsp_triangulation;
use crate::{Control, Error, Triangulation};

/// An edge: the ids of its two vertices, in any order where one is asked for, the lower first where one is given.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct wsp_edge {
    /// The ends.
    pub vertices: [u32; 2],
}

/// The edge's ends, which are vertices (whether they are joined is another question).
pub(super) fn ends(triangulation: &Triangulation, edge: wsp_edge) -> Result<[u32; 2], Error> {
    match edge.vertices.into_iter().find(|&vertex| triangulation.point(vertex).is_none()) {
        Some(vertex) => Err(Error::NoSuchVertex { vertex }),
        None => Ok(edge.vertices),
    }
}

/// Lists the bad short edges of the domain (of the hull without one) for the bound `radius_edge`, shortest first,
/// ties by ids: no tetrahedron is bad if and only if there are none. Two-call list: `out` has room for `capacity` (0
/// and NULL to ask for the count only) and gets the first of them, `*count` becomes the number of all; WSP_INCOMPLETE
/// if they are more than a capacity above 0.
///
/// Cost: linear in the triangulation, plus sorting, at each call.
/// Errors: WSP_ERR_NULL, WSP_ERR_OPTION (`radius_edge` is not from 0.62 to 1e6), WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_bad_short_edges(
    triangulation: *const wsp_triangulation,
    radius_edge: f64,
    out: *mut wsp_edge,
    capacity: usize,
    count: *mut usize,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_bad_short_edges", || unsafe {
        bad_short_edges(triangulation, radius_edge, (out, capacity, count), &Control::new())
    })
}

/// wsp_bad_short_edges that `control`, which may be NULL, cancels: WSP_CANCELLED then, and nothing is written.
/// Errors: those of wsp_bad_short_edges.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_bad_short_edges_within(
    triangulation: *const wsp_triangulation,
    radius_edge: f64,
    control: *mut wsp_control,
    out: *mut wsp_edge,
    capacity: usize,
    count: *mut usize,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_bad_short_edges_within", || unsafe {
        let control = control::core(control)?;
        bad_short_edges(triangulation, radius_edge, (out, capacity, count), &control)
    })
}

/// # Safety
/// Each pointer is NULL or live with the room that its count says.
unsafe fn bad_short_edges(
    triangulation: *const wsp_triangulation,
    radius_edge: f64,
    (out, capacity, count): (*mut wsp_edge, usize, *mut usize),
    control: &Control,
) -> Answer {
    // SAFETY: as the caller promises.
    unsafe {
        args::list_out(out, capacity, "out", count)?;
        let radius_edge = args::radius_edge(radius_edge)?;
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        // A small mesh is done before the first look at the control.
        if !control.poll() {
            return Ok(WSP_CANCELLED);
        }
        let edges = match state.mesh.bad_short_edges_within(radius_edge, control) {
            Err(Error::Cancelled) => return Ok(WSP_CANCELLED),
            other => other?,
        };
        // In place: the two are laid out alike.
        let edges: Vec<wsp_edge> = edges.into_iter().map(|vertices| wsp_edge { vertices }).collect();
        let answer = args::fill(&edges, out, capacity, count);
        control.give_back(edges);
        answer
    }
}

/// Lists the vertices around an edge in order. `*closed` becomes 1 if they form a ring, 0 for a chain: then the edge
/// is on the hull, and the first and the last are on the hull's two facets at it. NULL if that does not matter.
/// Two-call list as for wsp_bad_short_edges.
///
/// Cost: that of the edge's neighbourhood.
/// Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX, WSP_ERR_NO_SUCH_EDGE, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_edge_link(
    triangulation: *const wsp_triangulation,
    edge: wsp_edge,
    out: *mut u32,
    capacity: usize,
    count: *mut usize,
    closed: *mut u32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_edge_link", || unsafe {
        args::list_out(out, capacity, "out", count)?;
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        let triangulation = state.mesh.triangulation();
        let edge = ends(triangulation, edge)?;
        let (link, ring) = triangulation.link(edge).ok_or(Error::NoSuchEdge { edge })?;
        if !closed.is_null() {
            args::store(closed, ring.into(), "closed")?;
        }
        args::fill(&link, out, capacity, count)
    })
}
