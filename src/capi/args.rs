//! The caller's pointers and sizes: turned into references and slices, or into an error that names the
//! argument.

use glam::DVec3;

use super::guard::{Answer, Failure};
use super::status::*;
use crate::triangulation::topology::MAX_VERTICES;

// Points of the ABI are `double[3]`, read in place.
const _: () = assert!(size_of::<DVec3>() == 3 * size_of::<f64>() && align_of::<DVec3>() == align_of::<f64>());

fn null(name: &str) -> Failure {
    Failure::new(WSP_ERR_NULL, format!("{name} is NULL"))
}

fn checked<T>(ptr: *const T, name: &str) -> Result<(), Failure> {
    if ptr.is_null() {
        return Err(null(name));
    }
    if !ptr.is_aligned() {
        return Err(Failure::new(WSP_ERR_ARGUMENT, format!("{name} is not aligned as its type demands")));
    }
    Ok(())
}

/// # Safety
/// `ptr` is NULL or points to a live `T` that nobody writes while the reference lives.
pub(super) unsafe fn reference<'a, T>(ptr: *const T, name: &str) -> Result<&'a T, Failure> {
    checked(ptr, name)?;
    // SAFETY: not null, aligned, and live as the caller promises.
    Ok(unsafe { &*ptr })
}

/// # Safety
/// `ptr` is NULL or points to `n` elements that nobody writes while the slice lives.
pub(super) unsafe fn slice<'a, T>(ptr: *const T, n: usize, name: &str) -> Result<&'a [T], Failure> {
    if n == 0 {
        return Ok(&[]);
    }
    checked(ptr, name)?;
    if n.checked_mul(size_of::<T>()).is_none_or(|bytes| bytes > isize::MAX as usize) {
        return Err(Failure::new(WSP_ERR_TOO_MANY, format!("{name}: {n} elements are more than memory can hold")));
    }
    // SAFETY: not null, aligned, of a legal size, and live as the caller promises.
    Ok(unsafe { std::slice::from_raw_parts(ptr, n) })
}

/// Refuses, before a look at any of them, more elements than ids can number.
pub(super) fn numbered(n: usize, name: &str) -> Result<(), Failure> {
    if n <= MAX_VERTICES {
        return Ok(());
    }
    Err(Failure::new(WSP_ERR_TOO_MANY, format!("{name}: {n} elements, but ids number {MAX_VERTICES} at most")))
}

/// # Safety
/// `xyz` is NULL or points to `3 * n` doubles that nobody writes while the slice lives.
pub(super) unsafe fn points<'a>(xyz: *const f64, n: usize, name: &str) -> Result<&'a [DVec3], Failure> {
    // SAFETY: a `DVec3` is three doubles (asserted above).
    unsafe { slice(xyz.cast::<DVec3>(), n, name) }
}

/// # Safety
/// `p` is NULL or points to three doubles.
pub(super) unsafe fn point(p: *const f64, name: &str) -> Result<DVec3, Failure> {
    // SAFETY: as above.
    let point = unsafe { *reference(p.cast::<DVec3>(), name)? };
    crate::geometry::check_points(&[point]).map_err(|error| {
        let Failure { status, text } = error.into();
        // "point 0" would say less than the argument's name.
        Failure::new(status, text.replacen("point 0", name, 1))
    })?;
    Ok(point)
}

/// # Safety
/// `ptr` is NULL or may be written.
pub(super) unsafe fn store<T>(ptr: *mut T, value: T, name: &str) -> Result<(), Failure> {
    checked(ptr, name)?;
    // SAFETY: not null, aligned, writable as the caller promises.
    unsafe { ptr.write(value) };
    Ok(())
}

/// Checks an out parameter before any work is done for it.
pub(super) fn writable<T>(ptr: *mut T, name: &str) -> Result<(), Failure> {
    checked(ptr, name)
}

/// An out parameter for a new handle: NULL is an error, and it reads NULL until the call has succeeded.
///
/// # Safety
/// `out` is NULL or may be written.
pub(super) unsafe fn handle_out<T>(out: *mut *mut T, name: &str) -> Result<(), Failure> {
    // SAFETY: as the caller promises.
    unsafe { store(out, std::ptr::null_mut(), name) }
}

/// The second half of a two-call list: as many elements as fit, and the count of all.
///
/// # Safety
/// `out` is NULL or has room for `capacity` elements, `count` may be written.
pub(super) unsafe fn fill<T: Copy>(items: &[T], out: *mut T, capacity: usize, count: *mut usize) -> Answer {
    let fits = items.len().min(capacity);
    if fits > 0 {
        // SAFETY: `list_out` has checked both; `copy` allows that `out` overlaps what was read.
        unsafe { std::ptr::copy(items.as_ptr(), out, fits) };
    }
    // SAFETY: as the caller promises.
    unsafe { store(count, items.len(), "count")? };
    Ok(if fits == items.len() || capacity == 0 { WSP_DONE } else { WSP_INCOMPLETE })
}

/// The first half: checks the arguments before any work is done.
pub(super) fn list_out<T>(out: *mut T, capacity: usize, name: &str, count: *mut usize) -> Result<(), Failure> {
    writable(count, "count")?;
    if capacity > 0 {
        writable(out, name)?;
    }
    Ok(())
}

/// An on-off argument.
pub(super) fn flag(value: u32, name: &str) -> Result<bool, Failure> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(Failure::new(WSP_ERR_ARGUMENT, format!("{name} is {value}, expected 0 or 1"))),
    }
}

/// The value of a bound on the radius-edge ratio.
pub(super) fn radius_edge(value: f64) -> Result<f64, Failure> {
    crate::refine::check_radius_edge(value)?;
    Ok(value)
}

/// Frees a handle, `NULL` included.
///
/// # Safety
/// `ptr` is NULL or came from [`give`] and has not been freed.
pub(super) unsafe fn free<T>(ptr: *mut T) {
    if !ptr.is_null() {
        // SAFETY: as the caller promises.
        drop(unsafe { Box::from_raw(ptr) });
    }
}

/// Hands a new object to the caller.
///
/// # Safety
/// `out` has passed [`handle_out`].
pub(super) unsafe fn give<T>(value: T, out: *mut *mut T) {
    // SAFETY: as the caller promises.
    unsafe { out.write(Box::into_raw(Box::new(value))) };
}
