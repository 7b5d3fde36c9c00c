//! The batch handle: the Steiner points of one step.

use glam::DVec3;

use super::guard::{call, call_void, Failure};
use super::options::{rule, rule_number, wsp_rule, wsp_sampler_options};
use super::status::*;
use super::steps::{ends, wsp_edge};
use super::triangulation::wsp_triangulation;
use super::{args, sized};
use crate::{Batch, Origin, StepOptions};

/// The Steiner points of one step. It never changes, so any thread may read it at any time.
pub struct wsp_batch {
    batch: Batch,
    /// The state of the triangulation that it was made for.
    stamp: u64,
    rule: wsp_rule,
    /// What the accessors show.
    points: Vec<DVec3>,
    origins: Vec<wsp_origin>,
}

/// The point is a sample of the rule, in the interior.
pub const WSP_ORIGIN_SAMPLE: u32 = 0;
/// The point splits the boundary's subsegment `vertices[0..2]`.
pub const WSP_ORIGIN_SEGMENT: u32 = 1;
/// The point splits the boundary's subfacet `vertices[0..3]`.
pub const WSP_ORIGIN_SUBFACET: u32 = 2;

/// Where a Steiner point comes from.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct wsp_origin {
    /// WSP_ORIGIN_SAMPLE, WSP_ORIGIN_SEGMENT or WSP_ORIGIN_SUBFACET.
    pub kind: u32,
    /// The vertices of what the point splits; WSP_NONE for the rest.
    pub vertices: [u32; 3],
}

impl From<Origin> for wsp_origin {
    fn from(origin: Origin) -> Self {
        let (kind, ids): (u32, &[u32]) = match &origin {
            Origin::Sample => (WSP_ORIGIN_SAMPLE, &[]),
            Origin::Segment(segment) => (WSP_ORIGIN_SEGMENT, segment),
            Origin::Subfacet(facet) => (WSP_ORIGIN_SUBFACET, facet),
        };
        let mut vertices = [WSP_NONE; 3];
        vertices[..ids.len()].copy_from_slice(ids);
        wsp_origin { kind, vertices }
    }
}

/// Computes what the refinement would insert next for an edge. The boundary comes first: as long as one of its
/// subsegments or subfacets waits to be split, or would be encroached upon by the edge's samples, the batch is of
/// such splits. Otherwise it is the samples of the component of the edge's Voronoi facet outside the core disk that
/// has the largest span. It is empty if the edge is not bad, or can't be mended. Nothing is inserted. `options` may
/// be NULL: the defaults.
///
/// Without a domain nothing bounds the samples: they may lie outside the hull. See
/// wsp_triangulation_use_hull_as_domain.
///
/// `*out` belongs to the caller: free it with wsp_batch_free. On an error it is NULL. It refers to no other handle.
/// Cost: that of the edge's neighbourhood.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_NO_SUCH_VERTEX, WSP_ERR_NO_SUCH_EDGE,
/// WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_steiner_batch(
    triangulation: *const wsp_triangulation,
    edge: wsp_edge,
    options: *const wsp_sampler_options,
    out: *mut *mut wsp_batch,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_steiner_batch", || unsafe {
        args::handle_out(out, "out")?;
        let options = sized::read(options, "options")?;
        let step = StepOptions { radius_edge: args::radius_edge(options.radius_edge)?, rule: rule(options.rule)? };
        let state = args::reference(triangulation, "triangulation")?.handle.read()?;
        let edge = ends(state.mesh.triangulation(), edge)?;
        let batch = state.mesh.steiner_batch(edge, &step)?;
        let points = batch.points.iter().map(|point| point.position).collect();
        let origins = batch.points.iter().map(|point| point.origin.into()).collect();
        args::give(wsp_batch { batch, stamp: state.stamp, rule: rule_number(step.rule), points, origins }, out);
        Ok(WSP_DONE)
    })
}

/// Inserts a batch. It must be of the triangulation's present state: once anything has been inserted since it was
/// computed, another batch too, its distances and its boundary rules hold no longer, and it is refused. The batch
/// stays the caller's. `ids` is NULL or has room for wsp_batch_count: `ids[i]` becomes the vertex of point i, or
/// WSP_NONE if it was not inserted, because the points before it have made it encroach upon the boundary: the batches
/// to come split that first. If none of a batch's points is inserted and the next batch is the same, the edge can't
/// be mended: that would need edges below 2^-40 of the bounding box.
///
/// After WSP_ERR_TOO_MANY and WSP_ERR_MEMORY the first points may have been inserted; the triangulation is valid.
///
/// Cost: that of the insertions.
/// Errors: WSP_ERR_NULL, WSP_ERR_STALE, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_insert_batch(
    triangulation: *mut wsp_triangulation,
    batch: *const wsp_batch,
    ids: *mut u32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_triangulation_insert_batch", || unsafe {
        let batch = args::reference(batch, "batch")?;
        let mut state = args::reference(triangulation, "triangulation")?.handle.write()?;
        if !ids.is_null() {
            args::writable(ids, "ids")?;
        }
        if state.stamp != batch.stamp {
            let text = "the batch was computed for another triangulation or before its last change";
            return Err(Failure::new(WSP_ERR_STALE, text));
        }
        if batch.points.is_empty() {
            return Ok(WSP_DONE);
        }
        let new_ids = state.change(|mesh| mesh.insert_batch(&batch.batch))?;
        if !ids.is_null() {
            let all: Vec<u32> = new_ids.into_iter().map(|id| id.unwrap_or(WSP_NONE)).collect();
            std::ptr::copy(all.as_ptr(), ids, all.len());
        }
        Ok(WSP_DONE)
    })
}

/// Frees a batch; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_batch_free(batch: *mut wsp_batch) {
    // SAFETY: NULL, or a batch that is not used after this.
    call_void("wsp_batch_free", || unsafe {
        args::free(batch);
        Ok(())
    });
}

/// The edge that the batch was computed for; two WSP_NONE for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_batch_edge(batch: *const wsp_batch) -> wsp_edge {
    // SAFETY: NULL or live.
    let vertices = unsafe { batch.as_ref() }.map_or([WSP_NONE; 2], |b| b.batch.edge);
    wsp_edge { vertices }
}

/// The number of Steiner points; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_batch_count(batch: *const wsp_batch) -> usize {
    // SAFETY: NULL or live.
    unsafe { batch.as_ref() }.map_or(0, |b| b.points.len())
}

/// The Steiner points, three doubles each, to be read until the batch is freed; NULL for an empty batch and for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_batch_points(batch: *const wsp_batch) -> *const f64 {
    // SAFETY: NULL or live.
    match unsafe { batch.as_ref() } {
        Some(b) if !b.points.is_empty() => b.points.as_ptr().cast(),
        _ => std::ptr::null(),
    }
}

/// Where each Steiner point comes from, to be read until the batch is freed; NULL for an empty batch and for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_batch_origins(batch: *const wsp_batch) -> *const wsp_origin {
    // SAFETY: NULL or live.
    match unsafe { batch.as_ref() } {
        Some(b) if !b.origins.is_empty() => b.origins.as_ptr(),
        _ => std::ptr::null(),
    }
}

/// The rule that the batch was computed by; 0 for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_batch_rule(batch: *const wsp_batch) -> wsp_rule {
    // SAFETY: NULL or live.
    unsafe { batch.as_ref() }.map_or(0, |b| b.rule)
}

/// The span angle of the component that was sampled, in radians; 0 for boundary splits, circumcentres and NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_batch_span(batch: *const wsp_batch) -> f64 {
    // SAFETY: NULL or live.
    unsafe { batch.as_ref() }.map_or(0.0, |b| b.batch.span)
}

/// The sampling angle, in radians: the span over the number of samples; 0 where the span is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_batch_theta(batch: *const wsp_batch) -> f64 {
    // SAFETY: NULL or live.
    unsafe { batch.as_ref() }.map_or(0.0, |b| b.batch.theta)
}
