//! The sampler without a handle: for edges of any host's triangulation.

use glam::DVec3;

use super::guard::{call, Answer, Failure};
use super::options::{rule, wsp_sampler_options};
use super::status::*;
use super::{args, sized};
use crate::geometry::check_points;
use crate::sampler::{self, Rule};

/// An edge of a foreign triangulation.
struct Star<'a> {
    p: DVec3,
    q: DVec3,
    link: &'a [DVec3],
    closed: bool,
}

/// Reads and checks an edge and its link.
///
/// # Safety
/// Each pointer is NULL or live, `link_xyz` with `3 * n` doubles that nobody writes while the answer lives.
unsafe fn star<'a>(
    p: *const f64,
    q: *const f64,
    link_xyz: *const f64,
    n: usize,
    closed: u32,
) -> Result<Star<'a>, Failure> {
    // SAFETY: as the caller promises. The output, which may overlap the link, is written when all is computed.
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
    Ok(Star { p, q, link, closed })
}

/// What the calls that sample have in common: reads the options, and gives the points that `sample` makes by them to the caller.
///
/// # Safety
/// Each pointer is NULL or live, `out_xyz` with room for `capacity` points.
unsafe fn answer(
    options: *const wsp_sampler_options,
    out_xyz: *mut f64,
    capacity: usize,
    count: *mut usize,
    sample: impl FnOnce(f64, Rule) -> Result<Vec<DVec3>, Failure>,
) -> Answer {
    args::list_out(out_xyz, capacity, "out_xyz", count)?;
    // SAFETY: as the caller promises.
    let options = unsafe { sized::read(options, "options")? };
    let points = sample(args::radius_edge(options.radius_edge)?, rule(options.rule)?)?;
    // SAFETY: as the caller promises.
    unsafe { args::fill(&points, out_xyz.cast::<DVec3>(), capacity, count) }
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
        answer(options, out_xyz, capacity, count, |radius_edge, rule| {
            let star = star(p, q, link_xyz, n, closed)?;
            let samples = sampler::sample_edge(star.p, star.q, star.link, star.closed, radius_edge, rule);
            Ok(samples.map(|samples| samples.points).unwrap_or_default())
        })
    })
}

/// The Steiner batch for a bad tetrahedron of any Delaunay triangulation, as the refinement makes it: wsp_sample_edge for hosts that
/// know which tetrahedron they mend.
///
/// `corners_xyz` are its four corners, twelve doubles, the first two the ends of its shortest edge. `link_xyz`, `n` and `closed` are that
/// edge's link as for wsp_sample_edge, or the part of it on this tetrahedron's side of the domain's boundary, as a chain; with
/// WSP_RULE_CIRCUMCENTER they are not looked at, and NULL and 0 will do. The tetrahedron is not judged: one that is not bad
/// may have points too. Where the rule has no points for the edge, the batch is the circumcentre. The order of the first two corners and
/// that of the last two decide about the last digits: the refinement takes lower ids first. Output as for wsp_sample_edge.
///
/// Cost: linear in n, less than wsp_sample_edge. May be called from any thread at any time.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE,
/// WSP_ERR_ARGUMENT (the first two corners are the same, too few link vertices, `closed` neither 0 nor 1).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_sample_tetrahedron(
    corners_xyz: *const f64,
    link_xyz: *const f64,
    n: usize,
    closed: u32,
    options: *const wsp_sampler_options,
    out_xyz: *mut f64,
    capacity: usize,
    count: *mut usize,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_sample_tetrahedron", || unsafe {
        answer(options, out_xyz, capacity, count, |radius_edge, rule| {
            let corners: [DVec3; 4] = *args::reference(corners_xyz.cast(), "corners_xyz")?;
            check_points(&corners)?;
            if rule == Rule::Circumcenter {
                return Ok(sampler::sample_circumcenter(corners).points);
            }
            let star = star(corners_xyz, corners_xyz.add(3), link_xyz, n, closed)?;
            Ok(sampler::sample_tetrahedron(corners, star.link, star.closed, radius_edge, rule).points)
        })
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
        let answer = sampler::is_bad_edge(star.p, star.q, star.link, star.closed, radius_edge);
        args::store(bad, answer.into(), "bad")?;
        Ok(WSP_DONE)
    })
}
