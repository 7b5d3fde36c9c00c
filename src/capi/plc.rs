//! The piecewise linear complex that describes a domain.

use super::args;
use super::guard::{call, call_void, Failure};
use super::handle::Handle;
use super::status::*;
use crate::geometry::check_points;
use crate::{DVec3, Error, Plc, PlcFacet, PlcRegion, PlcSegment};

/// A piecewise linear complex: points, segments, polygonal facets, seeds of holes and of regions.
///
/// Points are named by their position in it, from 0 in the order in which they were added. Facets are planar sets of
/// polygons. Adding only checks what can be checked at once; wsp_triangulation_from_plc judges the whole.
///
/// Coordinates on a slanted plane are rounded, so a facet need not be exactly planar: its points may lie off its plane by 1e-5 of the diagonal of the bounding
/// box of all points, but by no more than 1e-4 of the facet's size. Its points are kept where they are; new ones lie near its plane, so that
/// refinement may change the volume by as little. Triangles are always planar.
pub struct wsp_plc {
    pub(super) handle: Handle<Plc>,
}

/// Makes an empty complex.
///
/// `*out` belongs to the caller: free it with wsp_plc_free. On an error it is NULL.
/// Errors: WSP_ERR_NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_new(out: *mut *mut wsp_plc) -> wsp_status {
    // SAFETY: `out` is NULL or writable.
    call("wsp_plc_new", || unsafe {
        args::handle_out(out, "out")?;
        args::give(wsp_plc { handle: Handle::new(Plc::default()) }, out);
        Ok(WSP_DONE)
    })
}

/// Frees a complex; NULL is ignored. Called while another call uses the handle it frees nothing and leaves a text for
/// wsp_last_error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_free(plc: *mut wsp_plc) {
    // SAFETY: NULL, or a complex that is not used after this.
    call_void("wsp_plc_free", || unsafe {
        if plc.as_ref().is_some_and(|p| p.handle.in_use()) {
            return Err(Failure::new(WSP_ERR_BUSY, "another call is using the handle: not freed"));
        }
        args::free(plc);
        Ok(())
    });
}

/// Adds points and their markers, which may be none at all.
fn append_points(plc: &mut Plc, points: &[DVec3], markers: &[i32]) -> Result<u32, Failure> {
    let first = plc.points.len();
    if points.len() >= WSP_NONE as usize - first {
        let limit = WSP_NONE as usize - 1;
        return Err(Error::TooManyVertices { requested: first.saturating_add(points.len()), limit }.into());
    }
    plc.points.extend_from_slice(points);
    if !markers.is_empty() || !plc.point_markers.is_empty() {
        // Points that came without a marker have 0.
        plc.point_markers.resize(first, 0);
        plc.point_markers.extend_from_slice(markers);
        plc.point_markers.resize(first + points.len(), 0);
    }
    Ok(first as u32)
}

/// Adds `n` points, three doubles each. `markers` is NULL or has the caller's own number for each (otherwise 0).
/// `first` is NULL or becomes the position of the first of them; the others follow.
///
/// All or nothing. The arrays are copied. Cost: linear.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_TOO_MANY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_add_points(
    plc: *mut wsp_plc,
    xyz: *const f64,
    n: usize,
    markers: *const i32,
    first: *mut u32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_plc_add_points", || unsafe {
        let mut plc = args::reference(plc, "plc")?.handle.write()?;
        args::numbered(n, "xyz")?;
        let points = args::points(xyz, n, "xyz")?;
        check_points(points)?;
        let markers = if markers.is_null() { &[] } else { args::slice(markers, n, "markers")? };
        let position = append_points(&mut plc, points, markers)?;
        if !first.is_null() {
            args::store(first, position, "first")?;
        }
        Ok(WSP_DONE)
    })
}

/// Adds the axis-parallel box from `low` to `high`: eight points and six facets. Point i of the eight is at `high` in
/// x, y, z where bit 0, 1, 2 of i is set. The facets are at x low, x high, y low, y high, z low, z high, with the
/// markers `marker` to `marker + 5`. `first` is NULL or becomes the position of the first of the points.
///
/// All or nothing. Constant time.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_ARGUMENT (`low` is not below `high`, or
/// `marker + 5` is too large), WSP_ERR_TOO_MANY, WSP_ERR_BUSY.
/// cbindgen:ptrs-as-arrays=[[low; 3], [high; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_add_box(
    plc: *mut wsp_plc,
    low: *const f64,
    high: *const f64,
    marker: i32,
    first: *mut u32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_add_box", || unsafe {
        let mut plc = args::reference(plc, "plc")?.handle.write()?;
        let (low, high) = (args::point(low, "low")?, args::point(high, "high")?);
        if !low.cmplt(high).all() {
            return Err(Failure::new(
                WSP_ERR_ARGUMENT,
                format!("low {low} is not below high {high} in all of x, y, z"),
            ));
        }
        let Some(last_marker) = marker.checked_add(5) else {
            return Err(Failure::new(WSP_ERR_ARGUMENT, format!("marker {marker} leaves no room for six")));
        };
        let corners: [DVec3; 8] =
            std::array::from_fn(|i| DVec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), high, low));
        let sides = [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];
        let position = append_points(&mut plc, &corners, &[])?;
        plc.facets.extend(sides.iter().zip(marker..=last_marker).map(|(side, marker)| PlcFacet {
            polygons: vec![side.iter().map(|corner| position + corner).collect()],
            marker,
            ..PlcFacet::default()
        }));
        if !first.is_null() {
            args::store(first, position, "first")?;
        }
        Ok(WSP_DONE)
    })
}

fn check_positions(plc: &Plc, positions: &[u32]) -> Result<(), Failure> {
    match positions.iter().find(|&&p| p as usize >= plc.points.len()) {
        Some(&vertex) => {
            let text = format!("there is no point {vertex}: the complex has {} points", plc.points.len());
            Err(Failure::new(WSP_ERR_NO_SUCH_VERTEX, text))
        }
        None => Ok(()),
    }
}

/// Adds `n` segments, two positions of points each (a facet's sides need not be added). `markers` is NULL or has the
/// caller's own number for each (otherwise 0).
///
/// All or nothing. The arrays are copied. Cost: linear.
/// Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX (the points come first), WSP_ERR_ARGUMENT (two equal ends),
/// WSP_ERR_TOO_MANY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_add_segments(
    plc: *mut wsp_plc,
    ends: *const u32,
    n: usize,
    markers: *const i32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_plc_add_segments", || unsafe {
        let mut plc = args::reference(plc, "plc")?.handle.write()?;
        args::numbered(n, "ends")?;
        let ends: &[[u32; 2]] = args::slice(ends.cast(), n, "ends")?;
        let markers = if markers.is_null() { &[] } else { args::slice(markers, n, "markers")? };
        check_positions(&plc, ends.as_flattened())?;
        if let Some(i) = ends.iter().position(|[a, b]| a == b) {
            return Err(Failure::new(WSP_ERR_ARGUMENT, format!("segment {i} has point {} at both ends", ends[i][0])));
        }
        let marker = |i: usize| markers.get(i).copied().unwrap_or(0);
        plc.segments.extend(ends.iter().enumerate().map(|(i, &ends)| PlcSegment { ends, marker: marker(i) }));
        Ok(WSP_DONE)
    })
}

/// Adds planar facets as two lists of lists. Polygon i is the ring of the points
/// `vertices[polygon_starts[i]]` to `vertices[polygon_starts[i + 1] - 1]`; facet j consists of the polygons
/// `facet_starts[j]` to `facet_starts[j + 1] - 1`. So `polygon_starts` has `polygons + 1` entries and `facet_starts`
/// `facets + 1`, both begin with 0, do not fall, and end with the number of all. `facet_starts` may be NULL: then each
/// polygon is a facet, and `facets` must equal `polygons`.
///
/// The region of a facet is bounded by all its polygons; a polygon within another is an inner boundary, whose inside
/// is taken out by wsp_plc_add_facet_hole. A polygon of two points is a segment within the facet, one of a
/// single point a vertex within it. `markers` is NULL or has the caller's own number for each facet (otherwise 0).
/// `first` is NULL or becomes the position of the first of the facets.
///
/// All or nothing. The arrays are copied. Cost: linear.
/// Errors: WSP_ERR_NULL, WSP_ERR_NO_SUCH_VERTEX (the points come first), WSP_ERR_ARGUMENT (starts that are not as
/// above, empty polygons or facets), WSP_ERR_TOO_MANY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_add_facets(
    plc: *mut wsp_plc,
    vertices: *const u32,
    polygon_starts: *const usize,
    polygons: usize,
    facet_starts: *const usize,
    facets: usize,
    markers: *const i32,
    first: *mut u32,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live with the room that its count says, and checked by what takes it.
    call("wsp_plc_add_facets", || unsafe {
        let mut plc = args::reference(plc, "plc")?.handle.write()?;
        let position = plc.facets.len();
        if facets >= WSP_NONE as usize - position {
            return Err(Failure::new(WSP_ERR_TOO_MANY, format!("{facets} facets are more than 32 bits can number")));
        }
        let polygon_starts = starts(args_starts(polygon_starts, polygons, "polygon_starts")?, None, "polygon_starts")?;
        let vertices = args::slice(vertices, polygon_starts.last().copied().unwrap_or(0), "vertices")?;
        check_positions(&plc, vertices)?;
        let each: Vec<usize>;
        let facet_starts = if facet_starts.is_null() {
            if facets != polygons {
                let text =
                    format!("facets is {facets} and polygons {polygons}: without facet_starts they are the same");
                return Err(Failure::new(WSP_ERR_ARGUMENT, text));
            }
            each = (0..=polygons).collect();
            &each[..]
        } else {
            starts(args_starts(facet_starts, facets, "facet_starts")?, Some(polygons), "facet_starts")?
        };
        let markers = if markers.is_null() { &[] } else { args::slice(markers, facets, "markers")? };
        let polygon = |i: usize| vertices[polygon_starts[i]..polygon_starts[i + 1]].to_vec();
        plc.facets.extend(facet_starts.windows(2).enumerate().map(|(j, range)| PlcFacet {
            polygons: (range[0]..range[1]).map(polygon).collect(),
            holes: Vec::new(),
            marker: markers.get(j).copied().unwrap_or(0),
        }));
        if !first.is_null() {
            args::store(first, position as u32, "first")?;
        }
        Ok(WSP_DONE)
    })
}

/// `n + 1` starts; none of them is needed for no lists.
///
/// # Safety
/// `ptr` is NULL or points to as many live elements.
unsafe fn args_starts<'a>(ptr: *const usize, n: usize, name: &str) -> Result<&'a [usize], Failure> {
    if n == 0 {
        return Ok(&[0]);
    }
    // SAFETY: as the caller promises; n + 1 can't overflow for lists that fit in memory.
    unsafe { args::slice(ptr, n.saturating_add(1), name) }
}

/// Checks that starts begin with 0, rise, and end with `end`, if that is known.
fn starts<'a>(starts: &'a [usize], end: Option<usize>, name: &str) -> Result<&'a [usize], Failure> {
    let fail = |text: String| Err(Failure::new(WSP_ERR_ARGUMENT, text));
    if starts[0] != 0 {
        return fail(format!("{name}[0] is {}, expected 0", starts[0]));
    }
    if let Some(i) = starts.windows(2).position(|w| w[0] >= w[1]) {
        let (a, b) = (starts[i], starts[i + 1]);
        return fail(format!("{name}[{}] is {b} after {a}: each list needs at least one element", i + 1));
    }
    let last = starts[starts.len() - 1];
    match end {
        Some(end) if last != end => fail(format!("{name} ends with {last}, expected {end}")),
        _ => Ok(starts),
    }
}

/// Takes the part of a facet around `p` out of it: the part bounded by the facet's inner polygons. `p` is in the
/// facet's plane; `facet` is its position.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_ARGUMENT (no such facet), WSP_ERR_BUSY.
/// cbindgen:ptrs-as-arrays=[[p; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_add_facet_hole(plc: *mut wsp_plc, facet: u32, p: *const f64) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_add_facet_hole", || unsafe {
        let mut plc = args::reference(plc, "plc")?.handle.write()?;
        let p = args::point(p, "p")?;
        let count = plc.facets.len();
        let Some(facet) = plc.facets.get_mut(facet as usize) else {
            let text = format!("there is no facet {facet}: the complex has {count} facets");
            return Err(Failure::new(WSP_ERR_ARGUMENT, text));
        };
        facet.holes.push(p);
        Ok(WSP_DONE)
    })
}

/// Takes the volume around `p`, up to the facets that bound it, out of the domain. Holes come before regions: a region's seed in the same volume
/// labels nothing. A seed on a facet counts for one side of it only; inside one volume all places are alike.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_BUSY.
/// cbindgen:ptrs-as-arrays=[[p; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_add_hole(plc: *mut wsp_plc, p: *const f64) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_add_hole", || unsafe {
        let mut plc = args::reference(plc, "plc")?.handle.write()?;
        plc.holes.push(args::point(p, "p")?);
        Ok(WSP_DONE)
    })
}

/// Labels the volume around `p`, up to the facets that bound it, with `attribute`. `max_volume` asks for tetrahedra of
/// at most that volume there; 0 asks for nothing. Of several seeds in one volume the first one counts, and those of holes come before
/// all. A seed on a facet counts for one side of it only.
/// Errors: WSP_ERR_NULL, WSP_ERR_NOT_FINITE, WSP_ERR_OUT_OF_RANGE, WSP_ERR_ARGUMENT (`max_volume` is negative or not
/// finite, `attribute` is NaN), WSP_ERR_BUSY.
/// cbindgen:ptrs-as-arrays=[[p; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_add_region(
    plc: *mut wsp_plc,
    p: *const f64,
    attribute: f64,
    max_volume: f64,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_add_region", || unsafe {
        let mut plc = args::reference(plc, "plc")?.handle.write()?;
        let point = args::point(p, "p")?;
        if attribute.is_nan() {
            return Err(Failure::new(WSP_ERR_ARGUMENT, "attribute is NaN"));
        }
        if !(max_volume.is_finite() && max_volume >= 0.0) {
            let text = format!("max_volume is {max_volume}, expected 0 or a positive number");
            return Err(Failure::new(WSP_ERR_ARGUMENT, text));
        }
        let max_volume = (max_volume > 0.0).then_some(max_volume);
        plc.regions.push(PlcRegion { point, attribute, max_volume });
        Ok(WSP_DONE)
    })
}

/// How many points, segments and facets the complex has. Each pointer but the first may be NULL. Constant time.
/// Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_counts(
    plc: *const wsp_plc,
    points: *mut usize,
    segments: *mut usize,
    facets: *mut usize,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_counts", || unsafe {
        let plc = args::reference(plc, "plc")?.handle.read()?;
        let counts = [(points, plc.points.len()), (segments, plc.segments.len()), (facets, plc.facets.len())];
        for (to, count) in counts {
            if !to.is_null() {
                args::store(to, count, "a count")?;
            }
        }
        Ok(WSP_DONE)
    })
}
