//! Statuses, versions, and the text of the last error.

use std::ffi::{c_char, CStr};

use super::last_error;

/// What a call came to: 0 done; above 0 usable but not complete; below 0 an error, and nothing was changed.
/// Numbers are never reused. A later version may return new ones: test the sign first.
pub type wsp_status = i32;

/// Done.
pub const WSP_DONE: i32 = 0;
/// The control was cancelled. Handles are valid and usable; what had been reached is said by the function.
pub const WSP_CANCELLED: i32 = 1;
/// The vertex limit was reached. The mesh is valid, but some tetrahedra may exceed the bound.
pub const WSP_VERTEX_LIMIT: i32 = 2;
/// Some tetrahedra are left that exceed the bound: because of small input angles or a boundary that is kept, because mending them needs an edge
/// below the minimum length, or because rounding leaves no place. wsp_report counts them by reason. Or all keep the bound (`bad` is 0), but some are
/// larger than was asked for and could not be made smaller for such a reason: `too_large` counts them. The mesh is valid.
pub const WSP_UNREFINED: i32 = 3;
/// The list has more elements than the buffer has room for. The buffer is full, the count is that of all.
pub const WSP_INCOMPLETE: i32 = 4;
/// The seconds were over. The mesh is valid, but some tetrahedra may exceed the bound.
pub const WSP_TIME_LIMIT: i32 = 5;
/// More memory would have been needed than allowed. The mesh is valid, but some tetrahedra may exceed the bound.
pub const WSP_MEMORY_LIMIT: i32 = 6;

/// A fault of the library, caught. The handle that was being used answers nothing but its `_free` from now on.
pub const WSP_ERR_INTERNAL: i32 = -1;
/// A pointer is NULL that must not be.
pub const WSP_ERR_NULL: i32 = -2;
/// `struct_size` is none that this library knows: the `_init` was not called, or the header is newer.
pub const WSP_ERR_STRUCT_SIZE: i32 = -3;
/// A field of an option struct has a value that it can't have.
pub const WSP_ERR_OPTION: i32 = -4;
/// An argument has a value that it can't have, or a pointer is not aligned for its type.
pub const WSP_ERR_ARGUMENT: i32 = -5;
/// A coordinate is NaN or infinite.
pub const WSP_ERR_NOT_FINITE: i32 = -6;
/// A coordinate other than 0 is smaller than 2^-142 or larger than 2^201 in magnitude.
pub const WSP_ERR_OUT_OF_RANGE: i32 = -7;
/// More elements than 32-bit ids can name or memory can hold.
pub const WSP_ERR_TOO_MANY: i32 = -8;
/// There is no vertex of this id.
pub const WSP_ERR_NO_SUCH_VERTEX: i32 = -9;
/// The two vertices are not joined by an edge.
pub const WSP_ERR_NO_SUCH_EDGE: i32 = -10;
/// The domain can't be used; the text names the element.
pub const WSP_ERR_INVALID_DOMAIN: i32 = -11;
/// The call needs a domain and there is none, or there is one already.
pub const WSP_ERR_DOMAIN: i32 = -12;
/// Memory could not be had.
pub const WSP_ERR_MEMORY: i32 = -13;
/// Another call is using the handle: on another thread, or the one whose callback this is.
pub const WSP_ERR_BUSY: i32 = -14;
/// The batch is not of the triangulation's present state.
pub const WSP_ERR_STALE: i32 = -15;
/// `wsp_triangulation_validate` has found the triangulation wanting, or a host's arrays are no Delaunay mesh; the text says where.
pub const WSP_ERR_NOT_VALID: i32 = -16;

/// No vertex, no tetrahedron: the id that is never given out.
pub const WSP_NONE: u32 = u32::MAX;

/// The library version that this header belongs to.
pub const WSP_VERSION_MAJOR: u32 = 0;
/// See WSP_VERSION_MAJOR.
pub const WSP_VERSION_MINOR: u32 = 1;
/// See WSP_VERSION_MAJOR.
pub const WSP_VERSION_PATCH: u32 = 0;
/// The version of the binary interface, also the number in the library's SONAME: libraries of one number serve
/// programs compiled with any older header of the same number.
pub const WSP_ABI_VERSION: u32 = 0;

/// The version of the library that is loaded, as "major.minor.patch". The string is static: never free it.
/// Never fails.
#[unsafe(no_mangle)]
pub extern "C" fn wsp_version() -> *const c_char {
    const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => panic!(),
    };
    VERSION.as_ptr()
}

/// The WSP_ABI_VERSION of the library that is loaded; compare it with the header's. Never fails.
#[unsafe(no_mangle)]
pub extern "C" fn wsp_abi_version() -> u32 {
    WSP_ABI_VERSION
}

/// A few words for a status, such as "done"; "unknown status" for a number that has no meaning. The string is
/// static: never free it. Never fails.
#[unsafe(no_mangle)]
pub extern "C" fn wsp_status_string(status: wsp_status) -> *const c_char {
    let text = match status {
        WSP_DONE => c"done",
        WSP_CANCELLED => c"cancelled",
        WSP_VERTEX_LIMIT => c"vertex limit reached",
        WSP_UNREFINED => c"some tetrahedra left unrefined",
        WSP_INCOMPLETE => c"more elements than the buffer holds",
        WSP_TIME_LIMIT => c"time limit reached",
        WSP_MEMORY_LIMIT => c"memory limit reached",
        WSP_ERR_INTERNAL => c"internal error",
        WSP_ERR_NULL => c"null pointer",
        WSP_ERR_STRUCT_SIZE => c"unknown struct size",
        WSP_ERR_OPTION => c"invalid option",
        WSP_ERR_ARGUMENT => c"invalid argument",
        WSP_ERR_NOT_FINITE => c"coordinate not finite",
        WSP_ERR_OUT_OF_RANGE => c"coordinate out of range",
        WSP_ERR_TOO_MANY => c"too many elements",
        WSP_ERR_NO_SUCH_VERTEX => c"no such vertex",
        WSP_ERR_NO_SUCH_EDGE => c"no such edge",
        WSP_ERR_INVALID_DOMAIN => c"invalid domain",
        WSP_ERR_DOMAIN => c"domain missing or present",
        WSP_ERR_MEMORY => c"out of memory",
        WSP_ERR_BUSY => c"handle in use",
        WSP_ERR_STALE => c"batch out of date",
        WSP_ERR_NOT_VALID => c"triangulation not valid",
        _ => c"unknown status",
    };
    text.as_ptr()
}

/// What the calling thread's last failure was about: the function, the reason, and the offending point or element
/// ("" before the first failure). Calls that succeed leave it as it is. The string belongs to the library and is
/// valid until the next call that fails on the same thread. Never fails.
#[unsafe(no_mangle)]
pub extern "C" fn wsp_last_error() -> *const c_char {
    last_error::get()
}
