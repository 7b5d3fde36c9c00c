//! The sampler without a handle: for edges of any host's triangulation.

use glam::DVec3;

use super::guard::{call, Failure};
use super::options::{rule, wsp_sampler_options};
use super::status::*;
use super::{args, sized};
use crate::geometry::check_points;
use crate::sampler;

/// An edge of a foreign triangulation.
struct Star {
    p: DVec3,
    q: DVec3,
    link: Vec<DVec3>,
    closed: bool,
}

/// Reads and checks an edge and its link.
///
/// # Safety
/// Each pointer is NULL or live, `link_xyz` with `3 * n` doubles.
unsafe fn star(p: *const f64, q: *const f64, link_xyz: *const f64, n: usize, closed: u32) -> Result<Star, Failure> {
    // SAFETY: as the caller promises. The link is copied, so that the output may overlap it.
    let (p, q, link) = unsafe { (args::point(p, "p")?, args::point(q, "q")?, args::points(link_xyz, n, "link_xyz")?) };
    check_points(link).map_err(|error| {
        let Failure { status, text } = error.into();
        Failure::new(status, format!("link {text}"))
    })?;
    let closed = args::flag(closed, "closed")?;
    if p == q {
        return Err(Failure::new(WSP_ERR_ARGUMENT, format!("p and q are the same point {p}")));
    }
    let least = if closed { 3 } else { 2 };
    if n < least {
        let shape = if closed { "ring" } else { "chain" };
        return Err(Failure::new(WSP_ERR_ARGUMENT, format!("n is {n}, a {shape} has at least {least} vertices")));
    }
    Ok(Star { p, q, link: link.to_vec(), closed })
}

/// The Steiner batch of edge p q of any Delaunay triangulation, without a handle: as wsp_steiner_batch computes it, but
/// knowing no domain.
///
/// `link_xyz` are the `n` vertices around the edge in order (either sense), three doubles each. `closed` is 1 if they
/// form a ring; 0 for an edge on the hull, where they are a chain from one of the hull's facets to the other.
/// `options` may be NULL: the defaults. Two-call list: `out_xyz` has room for `capacity` points (0 and NULL to ask
/// for the count only) and gets the first of them, three doubles each, `*count` becomes the number of all;
/// WSP_INCOMPLETE if they are more than a capacity above 0. An edge that is not bad has no points. `out_xyz` may
/// overlap the inputs.
///
/// Cost: linear in n. May be called from any thread at any time.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE,
/// WSP_ERR_ARGUMENT (p = q, too few link vertices, `closed` neither 0 nor 1).
/// cbindgen:ptrs-as-arrays=[[p; 3], [q; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_sample_edge(
    p: *const f64,
    q: *const f64,
    link_xyz: *const f64,
    n: usize,
    closed: u32,
    options: *const wsp_sampler_options,
    out_xyz: *mut f64,
    capacity: usize,
    count: *mut usize,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_sample_edge", || unsafe {
        args::list_out(out_xyz, capacity, "out_xyz", count)?;
        let options = sized::read(options, "options")?;
        let (radius_edge, rule) = (args::radius_edge(options.radius_edge)?, rule(options.rule)?);
        let star = star(p, q, link_xyz, n, closed)?;
        let samples = sampler::sample_edge(star.p, star.q, &star.link, star.closed, radius_edge, rule);
        let points = samples.map(|samples| samples.points).unwrap_or_default();
        args::fill(&points, out_xyz.cast::<DVec3>(), capacity, count)
    })
}

/// Whether edge p q of any Delaunay triangulation is bad: `*bad` becomes 1 if its Voronoi facet is not within its core
/// disk, else 0. Arguments as for wsp_sample_edge; `radius_edge` is the bound.
///
/// Cost: linear in n. May be called from any thread at any time.
/// Errors: WSP_ERR_NULL, WSP_ERR_OPTION (`radius_edge` is not from 0.62 to 1e6), WSP_ERR_NOT_FINITE,
/// WSP_ERR_OUT_OF_RANGE, WSP_ERR_ARGUMENT.
/// cbindgen:ptrs-as-arrays=[[p; 3], [q; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_is_bad_edge(
    p: *const f64,
    q: *const f64,
    link_xyz: *const f64,
    n: usize,
    closed: u32,
    radius_edge: f64,
    bad: *mut u32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_is_bad_edge", || unsafe {
        args::writable(bad, "bad")?;
        let radius_edge = args::radius_edge(radius_edge)?;
        let star = star(p, q, link_xyz, n, closed)?;
        let answer = sampler::is_bad_edge(star.p, star.q, &star.link, star.closed, radius_edge);
        args::store(bad, answer.into(), "bad")?;
        Ok(WSP_DONE)
    })
}
