//! The sampler over a host's arrays: rounds of 'batch, insert, repeat'.

use super::batch::wsp_origin;
use super::control::{self, wsp_control};
use super::guard::{call, call_void, Failure};
use super::options::{rule_number, wsp_rule, wsp_sampler_options};
use super::status::*;
use super::steps::wsp_edge;
use super::view::wsp_mesh_view;
use super::{args, sized};
use crate::geometry::check_points;
use crate::geometry::quality::exceeds_radius_edge;
use crate::host::{sample_arrays, ArrayPoint, Arrays};
use crate::{DVec3, Origin};

/// A Steiner point of a round.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct wsp_steiner_point {
    /// Where it goes.
    pub xyz: [f64; 3],
    /// What it splits; the vertices are the host's.
    pub origin: wsp_origin,
    /// The bad short edge whose mending asks for it; two WSP_NONE for splits of what a vertex of the mesh encroaches upon.
    pub edge: wsp_edge,
    /// A tetrahedron of the view whose circumsphere holds the point: to start its location, or the search of its
    /// cavity, from. After other insertions any tetrahedron at one of its vertices does.
    pub tetrahedron: u32,
    /// The rule that the point was made by. Splits of the boundary are those that it asks for.
    pub rule: wsp_rule,
}

/// The Steiner points of one round on a host's arrays. It never changes, so any thread may read it at any time.
pub struct wsp_mesh_batch {
    points: Vec<wsp_steiner_point>,
    bad_edges: Vec<wsp_edge>,
    refused: usize,
}

fn steiner_point(point: &ArrayPoint, rule: wsp_rule) -> wsp_steiner_point {
    wsp_steiner_point {
        xyz: point.position.to_array(),
        origin: Origin::into(point.origin),
        edge: wsp_edge { vertices: point.edge },
        tetrahedron: point.tetrahedron,
        rule,
    }
}

/// One round of refinement on the arrays of any mesher: looks for bad short edges and computes points that may all be
/// inserted together. 'Batch, insert, repeat' ends at a batch of no points, with no bad tetrahedron left after
/// WSP_DONE. That is sure for a `radius_edge` of 2 or more where segments and facets meet at 60 degrees or more; below,
/// nothing but `min_edge` may end it, after very many points. Give a host's loop a limit of rounds there (10 for each
/// doubling of the lengths from the smallest feature to the domain, and 100), or a `min_edge` of about a tenth of the
/// smallest feature: then it ends always, and what is left is counted.
///
/// `view` is a Delaunay mesh of the domain: its points, tetrahedra, and optionally neighbours (NULL: they are found)
/// and `faces`, `facets`. Faces with a tetrahedron on one side only are the domain's boundary, and `faces` is part of
/// it too: no sample encroaches upon them. A face that one would encroach upon, or a vertex does, is split first: the
/// batch then has a point on it, of origin WSP_ORIGIN_SUBFACET or WSP_ORIGIN_SEGMENT; with `keep_boundary` no such
/// point ever comes, what asks for it is left, and samples stay out of the diametral ball of each face and segment that
/// no vertex is in, and take none out. Edges of the boundary are segments where facets meet; what a facet is, `facets`
/// says, and without numbers coplanar neighbours are of one. Nothing is remembered from round to round.
///
/// The points of different edges are independent: their cavities (as the empty-sphere rule and exact arithmetic have
/// them, cospherical tetrahedra included) neither meet nor share a face, so the order of insertion does not matter and
/// none comes near another. The points of one edge stand together; their cavities may overlap, and they keep their
/// distances. Any first part of the list may be inserted and the rest be left out.
///
/// A facet that is not parallel to an axis can't hold points exactly: a split may lie off its plane by rounding, with
/// flat tetrahedra between the two. On the outside they are found, and are no part of the domain: tetrahedra without a
/// face in `faces` that are less high than the least distance (see `min_edge`; its default) are neither judged nor
/// mended, and neighbours of the boundary that are coplanar but for that are of one facet. At inner facets, leave them
/// out of the view, and give faces at the facet its number: a tetrahedron is flat if all its vertices are on one facet,
/// where a split of a subfacet is on its facet and the split of a segment on all facets that both its ends are on.
///
/// `options` and `control` may be NULL. `*out` belongs to the caller: free it with wsp_mesh_batch_free. After an error
/// or WSP_CANCELLED it is NULL. WSP_UNREFINED: the batch has no points, but bad tetrahedra are left, because mending
/// them needs edges below `min_edge`, or, at angles of less than 60 degrees between boundary elements, such as their
/// shortest edge spans or splits that make edges shorter than `radius_edge` / 2 times that; or because of
/// `keep_boundary`.
///
/// Cost: linear in the arrays, about a microsecond a tetrahedron.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE,
/// WSP_ERR_TOO_MANY, WSP_ERR_NOT_VALID (a tetrahedron is flat, negative or not Delaunay, names no vertex, or neighbours
/// are wrong: the text says which).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_sample_mesh(
    view: *const wsp_mesh_view,
    options: *const wsp_sampler_options,
    control: *mut wsp_control,
    out: *mut *mut wsp_mesh_batch,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_sample_mesh", || unsafe {
        args::handle_out(out, "out")?;
        args::reference(view, "view")?;
        let view = sized::read(view, "view")?;
        let options = sized::read(options, "options")?;
        let options = options.for_arrays()?;
        let control = control::core(control)?;
        // NULL for an array that may be left out.
        let optional = |ptr: *const u32, n: usize| if ptr.is_null() { 0 } else { n };
        let tetrahedra = args::slice(view.tetrahedra.cast(), view.tetrahedra_count, "view->tetrahedra")?;
        let neighbours = optional(view.neighbours, view.tetrahedra_count);
        let arrays = Arrays {
            points: args::points(view.points, view.points_count, "view->points")?,
            tetrahedra,
            neighbours: args::slice(view.neighbours.cast(), neighbours, "view->neighbours")?,
            faces: args::slice(view.faces.cast(), view.faces_count, "view->faces")?,
            facets: args::slice(view.facets, optional(view.facets, view.faces_count), "view->facets")?,
        };
        let Some(batch) = sample_arrays(&arrays, &options, &control)? else { return Ok(WSP_CANCELLED) };
        let rule = rule_number(options.rule);
        let made = wsp_mesh_batch {
            points: batch.points.iter().map(|point| steiner_point(point, rule)).collect(),
            bad_edges: batch.bad_edges.iter().map(|&vertices| wsp_edge { vertices }).collect(),
            refused: batch.refused,
        };
        let status = if made.points.is_empty() && made.refused > 0 { WSP_UNREFINED } else { WSP_DONE };
        args::give(made, out);
        Ok(status)
    })
}

/// Frees a batch; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_mesh_batch_free(batch: *mut wsp_mesh_batch) {
    // SAFETY: NULL, or a batch that is not used after this.
    call_void("wsp_mesh_batch_free", || unsafe {
        args::free(batch);
        Ok(())
    });
}

/// The number of Steiner points; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_mesh_batch_count(batch: *const wsp_mesh_batch) -> usize {
    // SAFETY: NULL or live.
    unsafe { batch.as_ref() }.map_or(0, |b| b.points.len())
}

/// The Steiner points, to be read until the batch is freed; NULL for an empty batch and for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_mesh_batch_points(batch: *const wsp_mesh_batch) -> *const wsp_steiner_point {
    // SAFETY: NULL or live.
    match unsafe { batch.as_ref() } {
        Some(b) if !b.points.is_empty() => b.points.as_ptr(),
        _ => std::ptr::null(),
    }
}

/// The bad short edges of the view, shortest first, to be read until the batch is freed; `*count` becomes their number.
/// NULL when there are none, for NULL, and if `count` is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_mesh_batch_bad_edges(batch: *const wsp_mesh_batch, count: *mut usize) -> *const wsp_edge {
    // SAFETY: NULL or live.
    let edges = unsafe { batch.as_ref() }.map_or(&[][..], |b| &b.bad_edges);
    // SAFETY: NULL or writable.
    if unsafe { args::store(count, edges.len(), "count") }.is_err() || edges.is_empty() {
        return std::ptr::null();
    }
    edges.as_ptr()
}

/// How many bad tetrahedra and encroached boundary elements can't be mended (see wsp_sample_mesh); 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_mesh_batch_refused(batch: *const wsp_mesh_batch) -> usize {
    // SAFETY: NULL or live.
    unsafe { batch.as_ref() }.map_or(0, |b| b.refused)
}

/// Which of `n` tetrahedra are bad, in one call: `bad[i]` becomes 1 if the circumradius of tetrahedron i exceeds
/// `radius_edge` times its shortest edge, by exact arithmetic, else 0. `corners_xyz` has four points a tetrahedron, twelve
/// doubles. The two arrays may not overlap.
///
/// Cost: linear in n. May be called from any thread at any time.
/// Errors: WSP_ERR_NULL, WSP_ERR_OPTION (`radius_edge` is not from 0.62 to 1e6), WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_bad_tetrahedra(
    corners_xyz: *const f64,
    n: usize,
    radius_edge: f64,
    bad: *mut u8,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_bad_tetrahedra", || unsafe {
        let radius_edge = args::radius_edge(radius_edge)?;
        let tetrahedra: &[[DVec3; 4]] = args::slice(corners_xyz.cast(), n, "corners_xyz")?;
        check_points(tetrahedra.as_flattened())?;
        if n > 0 {
            args::writable(bad, "bad")?;
        }
        for (i, &corners) in tetrahedra.iter().enumerate() {
            bad.add(i).write(exceeds_radius_edge(corners, radius_edge).into());
        }
        Ok(WSP_DONE)
    })
}

/// # Safety
/// Each is NULL or points to three doubles.
unsafe fn corner(p: *const f64, name: &str) -> Result<DVec3, Failure> {
    // SAFETY: as the caller promises.
    unsafe { args::point(p, name) }
}

/// The exact sign of det[b-a, c-a, d-a]: `*sign` becomes 1 if tetrahedron a b c d is positively oriented, 0 if it is flat, else -1.
///
/// Constant time but for degenerate input. May be called from any thread at any time.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE.
/// cbindgen:ptrs-as-arrays=[[a; 3], [b; 3], [c; 3], [d; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_orientation(
    a: *const f64,
    b: *const f64,
    c: *const f64,
    d: *const f64,
    sign: *mut i32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by what takes it.
    call("wsp_orientation", || unsafe {
        args::writable(sign, "sign")?;
        let [a, b, c, d] = [corner(a, "a")?, corner(b, "b")?, corner(c, "c")?, corner(d, "d")?];
        args::store(sign, number(crate::geometry::predicates::orient3d(a, b, c, d)), "sign")?;
        Ok(WSP_DONE)
    })
}

/// Where `p` is to the circumsphere of the positively oriented tetrahedron a b c d, exactly: `*sign` becomes 1 inside, 0 on
/// it, -1 outside.
///
/// Constant time but for degenerate input. May be called from any thread at any time.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE.
/// cbindgen:ptrs-as-arrays=[[a; 3], [b; 3], [c; 3], [d; 3], [p; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_side_of_sphere(
    a: *const f64,
    b: *const f64,
    c: *const f64,
    d: *const f64,
    p: *const f64,
    sign: *mut i32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by what takes it.
    call("wsp_side_of_sphere", || unsafe {
        args::writable(sign, "sign")?;
        let [a, b, c, d] = [corner(a, "a")?, corner(b, "b")?, corner(c, "c")?, corner(d, "d")?];
        let p = corner(p, "p")?;
        args::store(sign, number(crate::geometry::predicates::insphere(a, b, c, d, p)), "sign")?;
        Ok(WSP_DONE)
    })
}

fn number(sign: crate::geometry::Sign) -> i32 {
    use crate::geometry::Sign;
    match sign {
        Sign::Negative => -1,
        Sign::Zero => 0,
        Sign::Positive => 1,
    }
}
