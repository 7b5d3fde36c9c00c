//! Every defect of a complex.

use std::ffi::{c_char, CString};

use super::args;
use super::control::{self, wsp_control};
use super::guard::{call, call_void, Failure};
use super::plc::wsp_plc;
use super::sized::{self, Sized_};
use super::status::*;
use crate::{DomainElement, Error, PlcCheck, PlcDefect, PlcDefectKind, Severity};

/// What wsp_plc_check has found. It never changes, so any thread may read it at any time.
pub struct wsp_check {
    check: PlcCheck,
    texts: Vec<CString>,
}

/// A kind of element of a complex: one of the WSP_ELEMENT_ constants.
pub type wsp_element_kind = u32;
/// The complex as a whole.
pub const WSP_ELEMENT_DOMAIN: u32 = 0;
/// A point.
pub const WSP_ELEMENT_POINT: u32 = 1;
/// A segment of the list of segments.
pub const WSP_ELEMENT_SEGMENT: u32 = 2;
/// A facet.
pub const WSP_ELEMENT_FACET: u32 = 3;
/// A seed of a hole.
pub const WSP_ELEMENT_HOLE: u32 = 4;
/// A seed of a region.
pub const WSP_ELEMENT_REGION: u32 = 5;

/// A kind of defect: one of the WSP_DEFECT_ constants. From WSP_DEFECT_DUPLICATE_POINT on they are warnings: the
/// complex can be meshed. The others are errors.
pub type wsp_defect_kind = u32;
/// A coordinate of a point or seed is NaN or infinite.
pub const WSP_DEFECT_NOT_FINITE: u32 = 1;
/// A coordinate other than 0 is smaller than 2^-142 or larger than 2^201 in magnitude.
pub const WSP_DEFECT_OUT_OF_RANGE: u32 = 2;
/// A segment or facet names a point that does not exist; the measure is its position.
pub const WSP_DEFECT_NO_SUCH_POINT: u32 = 3;
/// A facet has no polygon, or a polygon no point.
pub const WSP_DEFECT_EMPTY: u32 = 4;
/// There are more regions than can be told apart; the measure is how many can.
pub const WSP_DEFECT_TOO_MANY_REGIONS: u32 = 5;
/// A segment's ends are at one place.
pub const WSP_DEFECT_NO_LENGTH: u32 = 6;
/// A facet's points lie on a line.
pub const WSP_DEFECT_NO_AREA: u32 = 7;
/// A facet's points don't lie in a plane; the measure is how far the worst is off.
pub const WSP_DEFECT_NOT_PLANAR: u32 = 8;
/// Sides of one facet cross, or two corners lie upon each other in its plane.
pub const WSP_DEFECT_CROSSING_SIDES: u32 = 9;
/// Two segments or sides cross.
pub const WSP_DEFECT_SEGMENTS_CROSS: u32 = 10;
/// A segment, or the side of a facet, goes through a facet.
pub const WSP_DEFECT_SEGMENT_THROUGH_FACET: u32 = 11;
/// Two facets have the same corners.
pub const WSP_DEFECT_DUPLICATE_FACET: u32 = 12;
/// Two facets in one plane overlap.
pub const WSP_DEFECT_FACETS_OVERLAP: u32 = 13;
/// Two points are at one place; they become one vertex.
pub const WSP_DEFECT_DUPLICATE_POINT: u32 = 1001;
/// Two segments are the same.
pub const WSP_DEFECT_DUPLICATE_SEGMENT: u32 = 1002;
/// A point lies on a segment or side, which is cut there.
pub const WSP_DEFECT_POINT_ON_SEGMENT: u32 = 1003;
/// A point lies in a facet, of which it becomes a vertex.
pub const WSP_DEFECT_POINT_ON_FACET: u32 = 1004;
/// An edge has one facet at it: the surface is open there.
pub const WSP_DEFECT_OPEN_EDGE: u32 = 1005;
/// An edge has more than two facets at it; the measure is how many.
pub const WSP_DEFECT_NON_MANIFOLD_EDGE: u32 = 1006;

fn kind_number(kind: PlcDefectKind) -> wsp_defect_kind {
    match kind {
        PlcDefectKind::NotFinite => WSP_DEFECT_NOT_FINITE,
        PlcDefectKind::OutOfRange => WSP_DEFECT_OUT_OF_RANGE,
        PlcDefectKind::NoSuchPoint => WSP_DEFECT_NO_SUCH_POINT,
        PlcDefectKind::Empty => WSP_DEFECT_EMPTY,
        PlcDefectKind::TooManyRegions => WSP_DEFECT_TOO_MANY_REGIONS,
        PlcDefectKind::NoLength => WSP_DEFECT_NO_LENGTH,
        PlcDefectKind::NoArea => WSP_DEFECT_NO_AREA,
        PlcDefectKind::NotPlanar => WSP_DEFECT_NOT_PLANAR,
        PlcDefectKind::CrossingSides => WSP_DEFECT_CROSSING_SIDES,
        PlcDefectKind::SegmentsCross => WSP_DEFECT_SEGMENTS_CROSS,
        PlcDefectKind::SegmentThroughFacet => WSP_DEFECT_SEGMENT_THROUGH_FACET,
        PlcDefectKind::DuplicateFacet => WSP_DEFECT_DUPLICATE_FACET,
        PlcDefectKind::FacetsOverlap => WSP_DEFECT_FACETS_OVERLAP,
        PlcDefectKind::DuplicatePoint => WSP_DEFECT_DUPLICATE_POINT,
        PlcDefectKind::DuplicateSegment => WSP_DEFECT_DUPLICATE_SEGMENT,
        PlcDefectKind::PointOnSegment => WSP_DEFECT_POINT_ON_SEGMENT,
        PlcDefectKind::PointOnFacet => WSP_DEFECT_POINT_ON_FACET,
        PlcDefectKind::OpenEdge => WSP_DEFECT_OPEN_EDGE,
        PlcDefectKind::NonManifoldEdge => WSP_DEFECT_NON_MANIFOLD_EDGE,
    }
}

/// An element of a complex by its position in its list.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct wsp_element {
    /// A WSP_ELEMENT_ constant.
    pub kind: wsp_element_kind,
    /// The position; 0 for the domain.
    pub index: u32,
}

impl From<DomainElement> for wsp_element {
    fn from(element: DomainElement) -> Self {
        let (kind, index) = match element {
            DomainElement::Whole => (WSP_ELEMENT_DOMAIN, 0),
            DomainElement::Point(i) => (WSP_ELEMENT_POINT, i),
            DomainElement::Segment(i) => (WSP_ELEMENT_SEGMENT, i),
            DomainElement::Facet(i) => (WSP_ELEMENT_FACET, i),
            DomainElement::Hole(i) => (WSP_ELEMENT_HOLE, i),
            DomainElement::Region(i) => (WSP_ELEMENT_REGION, i),
        };
        wsp_element { kind, index: index as u32 }
    }
}

/// A defect of a complex, or an angle of it. Fill it with wsp_defect_init before it is given to wsp_check_defect or
/// wsp_check_angle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_defect {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// A WSP_DEFECT_ constant; 0 for an angle.
    pub kind: wsp_defect_kind,
    /// 1 for an error, 0 for a warning and for an angle.
    pub is_error: u32,
    /// How many of `elements` count: one or two.
    pub element_count: u32,
    /// The elements concerned. A facet's side that is no segment of the list is named by the facet.
    pub elements: [wsp_element; 2],
    /// A point where it is wrong; NaN where that means nothing.
    pub place: [f64; 3],
    /// A number that goes with the kind, else 0; of an angle its degrees.
    pub measure: f64,
}

// SAFETY: repr(C), numbers only without padding, struct_size first.
unsafe impl Sized_ for wsp_defect {
    const NAME: &'static str = "wsp_defect";
    const SIZES: &'static [usize] = &[size_of::<Self>()];

    fn defaults() -> Self {
        let none = wsp_element { kind: WSP_ELEMENT_DOMAIN, index: 0 };
        wsp_defect {
            struct_size: 0,
            kind: 0,
            is_error: 0,
            element_count: 0,
            elements: [none; 2],
            place: [f64::NAN; 3],
            measure: 0.0,
        }
    }
}

impl From<&PlcDefect> for wsp_defect {
    fn from(defect: &PlcDefect) -> Self {
        let mut elements = wsp_defect::defaults().elements;
        for (to, &element) in elements.iter_mut().zip(&defect.elements) {
            *to = element.into();
        }
        wsp_defect {
            kind: kind_number(defect.kind),
            is_error: u32::from(defect.kind.severity() == Severity::Error),
            element_count: defect.elements.len().min(2) as u32,
            elements,
            place: defect.place.to_array(),
            measure: defect.measure,
            ..wsp_defect::defaults()
        }
    }
}

/// Makes `defect` one of no kind. `size` is `sizeof *defect`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_defect_init(defect: *mut wsp_defect, size: usize) -> wsp_status {
    call("wsp_defect_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(defect, size, "defect")? };
        Ok(WSP_DONE)
    })
}

/// Finds every defect of a complex, not only the first: what makes it unusable (wsp_triangulation_from_plc refuses it with
/// the first of these), and what can be meshed but may not be meant. Whether elements meet is decided exactly. The
/// complex is not changed.
///
/// `*out` belongs to the caller: free it with wsp_check_free. On an error it is NULL. It does not refer to the complex.
/// Cost: n log n in the size of the complex, and linear in the pairs of elements whose bounding boxes meet.
/// Errors: WSP_ERR_NULL, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_check(plc: *const wsp_plc, out: *mut *mut wsp_check) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_check", || unsafe {
        args::handle_out(out, "out")?;
        let plc = args::reference(plc, "plc")?.handle.read()?;
        give(plc.check(), out);
        Ok(WSP_DONE)
    })
}

/// wsp_plc_check that `control`, which may be NULL, cancels: WSP_CANCELLED then, and `*out` is NULL.
/// Errors: those of wsp_plc_check.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_check_within(
    plc: *const wsp_plc,
    control: *mut wsp_control,
    out: *mut *mut wsp_check,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_check_within", || unsafe {
        args::handle_out(out, "out")?;
        let control = control::core(control)?;
        let plc = args::reference(plc, "plc")?.handle.read()?;
        match plc.check_within(&control) {
            Err(Error::Cancelled) => return Ok(WSP_CANCELLED),
            other => give(other?, out),
        }
        Ok(WSP_DONE)
    })
}

/// # Safety
/// `out` has passed `args::handle_out`.
unsafe fn give(check: PlcCheck, out: *mut *mut wsp_check) {
    let texts = check.defects.iter().map(|d| CString::new(d.to_string()).unwrap_or_default()).collect();
    // SAFETY: as the caller promises.
    unsafe { args::give(wsp_check { check, texts }, out) };
}

/// Frees the result of a check; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_check_free(check: *mut wsp_check) {
    // SAFETY: NULL, or a result that is not used after this.
    call_void("wsp_check_free", || unsafe {
        args::free(check);
        Ok(())
    });
}

/// The number of defects, errors first; 0 for NULL. `errors` is NULL or becomes the number of those that are errors.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_check_count(check: *const wsp_check, errors: *mut usize) -> usize {
    // SAFETY: each pointer is NULL or live.
    unsafe {
        if let Some(errors) = errors.as_mut() {
            *errors = check.as_ref().map_or(0, |c| c.check.errors().count());
        }
        check.as_ref().map_or(0, |c| c.check.defects.len())
    }
}

/// Fills in defect `index`, from 0. Constant time.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_ARGUMENT (there is no such defect).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_check_defect(
    check: *const wsp_check,
    index: usize,
    defect: *mut wsp_defect,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_check_defect", || unsafe {
        let check = args::reference(check, "check")?;
        sized::check_out(defect, "defect")?;
        let Some(found) = check.check.defects.get(index) else {
            let text = format!("there is no defect {index}: there are {}", check.check.defects.len());
            return Err(Failure::new(WSP_ERR_ARGUMENT, text));
        };
        sized::write(&wsp_defect::from(found), defect, "defect")?;
        Ok(WSP_DONE)
    })
}

/// Defect `index` in words, to be read until the check is freed; NULL when there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_check_text(check: *const wsp_check, index: usize) -> *const c_char {
    // SAFETY: NULL or live.
    let text = unsafe { check.as_ref() }.and_then(|c| c.texts.get(index));
    text.map_or(std::ptr::null(), |text| text.as_ptr())
}

/// Fills in the smallest angle at which two segments meet (`between_facets` 0) or two facets (1): its degrees as the
/// measure, the two elements, and a point where they meet. With no such angle the degrees are NaN and there are no elements.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_ARGUMENT (`between_facets` is neither).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_check_angle(
    check: *const wsp_check,
    between_facets: u32,
    angle: *mut wsp_defect,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_check_angle", || unsafe {
        let check = &args::reference(check, "check")?.check;
        sized::check_out(angle, "angle")?;
        let found =
            if args::flag(between_facets, "between_facets")? { &check.facet_angle } else { &check.segment_angle };
        let mut value = wsp_defect { measure: f64::NAN, ..wsp_defect::defaults() };
        if let Some(found) = found {
            value.measure = found.degrees;
            value.element_count = 2;
            value.elements = found.elements.map(wsp_element::from);
            value.place = found.place.to_array();
        }
        sized::write(&value, angle, "angle")?;
        Ok(WSP_DONE)
    })
}

/// Joins facets of one marker that share a side with no third facet at it, whose normals differ by at most `degrees`, as long
/// as all their points stay in one plane as facets must. Only facets of a single polygon without holes take part, and no
/// side that is a segment of the list is given up. Facets get new positions. `facets` is NULL or becomes how many there are.
///
/// Cost: n log n in the number of sides.
/// Errors: WSP_ERR_NULL, WSP_ERR_ARGUMENT (`degrees` is not from 0 to 90), WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_join_coplanar(plc: *mut wsp_plc, degrees: f64, facets: *mut usize) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_join_coplanar", || unsafe { join_coplanar(plc, degrees, std::ptr::null_mut(), None, facets) })
}

/// wsp_plc_join_coplanar that `control`, which may be NULL, cancels: WSP_CANCELLED then, and the complex is as it was. The control is not looked at
/// while one joined facet is put together.
/// Errors: those of wsp_plc_join_coplanar.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_join_coplanar_within(
    plc: *mut wsp_plc,
    degrees: f64,
    control: *mut wsp_control,
    facets: *mut usize,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_join_coplanar_within", || unsafe { join_coplanar(plc, degrees, control, None, facets) })
}

/// wsp_plc_join_coplanar_within that tells for each facet that there was the number of the one that it is a part of now, in `joined`, which has room for
/// `capacity` of them. Facets that are given to wsp_triangulation_from_plc after that come back by the new numbers (wsp_triangulation_boundary).
/// Errors: those of wsp_plc_join_coplanar, and WSP_ERR_ARGUMENT, with nothing changed, where `capacity` is less than the number of facets.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_plc_join_coplanar_groups(
    plc: *mut wsp_plc,
    degrees: f64,
    control: *mut wsp_control,
    joined: *mut u32,
    capacity: usize,
    facets: *mut usize,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_plc_join_coplanar_groups", || unsafe {
        join_coplanar(plc, degrees, control, Some((joined, capacity)), facets)
    })
}

/// # Safety
/// Each pointer is NULL or live, and that of `joined` has room for as many as it says.
unsafe fn join_coplanar(
    plc: *mut wsp_plc,
    degrees: f64,
    control: *mut wsp_control,
    joined: Option<(*mut u32, usize)>,
    facets: *mut usize,
) -> Result<wsp_status, Failure> {
    // SAFETY: as the caller promises, and checked by the function that takes it.
    unsafe {
        let control = control::core(control)?;
        let mut plc = args::reference(plc, "plc")?.handle.write()?;
        if !(0.0..=90.0).contains(&degrees) {
            return Err(Failure::new(WSP_ERR_ARGUMENT, format!("degrees is {degrees}, expected 0 to 90")));
        }
        if let Some((list, capacity)) = joined {
            let count = plc.facets.len();
            if capacity < count {
                let text = format!("capacity is {capacity}, the complex has {count} facets");
                return Err(Failure::new(WSP_ERR_ARGUMENT, text));
            }
            if count > 0 {
                args::writable(list, "joined")?;
            }
        }
        let groups = match plc.join_coplanar_within(degrees, &control) {
            Err(Error::Cancelled) => return Ok(WSP_CANCELLED),
            other => other?,
        };
        if let Some((list, _)) = joined {
            std::ptr::copy(groups.as_ptr(), list, groups.len());
        }
        if !facets.is_null() {
            args::store(facets, plc.facets.len(), "facets")?;
        }
        Ok(WSP_DONE)
    }
}
