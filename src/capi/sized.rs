//! Structs that begin with their size, as the caller's compiler saw it. Fields are only ever appended, so a
//! smaller known size is an older version's struct: what it lacks has its default, and what it has no room for is
//! not written. Any other size is an error.

use super::args;
use super::guard::Failure;
use super::status::WSP_ERR_STRUCT_SIZE;

/// # Safety
/// The type is `repr(C)`, begins with `struct_size: u32`, and every bit pattern is a value of it.
pub(super) unsafe trait Sized_: Copy {
    /// The C name, for messages.
    const NAME: &'static str;
    /// The struct's size in each version, oldest first; the last is `size_of::<Self>()`.
    const SIZES: &'static [usize];
    /// The default of every field; `struct_size` does not matter.
    fn defaults() -> Self;
}

fn known<T: Sized_>(size: usize) -> Result<usize, Failure> {
    if T::SIZES.contains(&size) {
        return Ok(size);
    }
    let text = format!(
        "{} of {size} bytes, this library knows {:?}: call {0}_init first, and do not use a newer header than \
         the library",
        T::NAME,
        T::SIZES
    );
    Err(Failure::new(WSP_ERR_STRUCT_SIZE, text))
}

/// # Safety
/// `ptr` is NULL or points to a live struct of the size that its first field says.
unsafe fn size_of_callers<T: Sized_>(ptr: *const T, name: &str) -> Result<usize, Failure> {
    // SAFETY: all versions begin with this field. The alignment of the whole struct is checked by `aligned`.
    let size = unsafe { *args::reference(ptr.cast::<u32>(), name)? };
    aligned(ptr, name)?;
    known::<T>(size as usize)
}

fn aligned<T>(ptr: *const T, name: &str) -> Result<(), Failure> {
    args::writable(ptr.cast_mut(), name)
}

/// # Safety
/// `size` bytes at `to` may be written, and `size` is at most that of `T`.
unsafe fn put<T: Sized_>(value: &T, to: *mut T, size: usize) {
    // SAFETY: plain bytes within both structs; the first field stays the caller's own size.
    unsafe {
        std::ptr::copy_nonoverlapping(std::ptr::from_ref(value).cast::<u8>(), to.cast::<u8>(), size);
        to.cast::<u32>().write(size as u32);
    }
}

/// Fills the caller's struct with defaults: the body of every `_init`.
///
/// # Safety
/// `ptr` is NULL or has `size` writable bytes.
pub(super) unsafe fn init<T: Sized_>(ptr: *mut T, size: usize, name: &str) -> Result<(), Failure> {
    args::writable(ptr, name)?;
    let size = known::<T>(size)?;
    // SAFETY: a known size is at most that of `T`, and the caller has as many bytes.
    unsafe { put(&T::defaults(), ptr, size) };
    Ok(())
}

/// The caller's struct, or the defaults for NULL.
///
/// # Safety
/// `ptr` is NULL or points to a live struct of the size that its first field says.
pub(super) unsafe fn read<T: Sized_>(ptr: *const T, name: &str) -> Result<T, Failure> {
    let mut value = T::defaults();
    if ptr.is_null() {
        return Ok(value);
    }
    // SAFETY: as the caller promises; a known size is at most that of `T`, and any bytes are a `T`.
    unsafe {
        let size = size_of_callers(ptr, name)?;
        std::ptr::copy_nonoverlapping(ptr.cast::<u8>(), std::ptr::from_mut(&mut value).cast::<u8>(), size);
    }
    Ok(value)
}

/// Checks a struct that will be written, before any work is done.
///
/// # Safety
/// `ptr` is NULL or points to a live struct of the size that its first field says.
pub(super) unsafe fn check_out<T: Sized_>(ptr: *mut T, name: &str) -> Result<(), Failure> {
    // SAFETY: as the caller promises.
    unsafe { size_of_callers(ptr.cast_const(), name).map(|_| ()) }
}

/// Writes as much of `value` as the caller's struct has room for.
///
/// # Safety
/// `ptr` is NULL or points to a live, writable struct of the size that its first field says.
pub(super) unsafe fn write<T: Sized_>(value: &T, ptr: *mut T, name: &str) -> Result<(), Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        let size = size_of_callers(ptr.cast_const(), name)?;
        put(value, ptr, size);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A struct that has grown once: 8 bytes in its first version, 16 in its second.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Grown {
        struct_size: u32,
        old: u32,
        new: u64,
    }

    // SAFETY: repr(C), integers only, struct_size first.
    unsafe impl Sized_ for Grown {
        const NAME: &'static str = "grown";
        const SIZES: &'static [usize] = &[8, 16];
        fn defaults() -> Self {
            Grown { struct_size: 0, old: 1, new: 2 }
        }
    }

    const FILLED: Grown = Grown { struct_size: 77, old: 77, new: 77 };

    #[test]
    fn an_older_struct_is_read_with_the_defaults_of_what_it_lacks() {
        let older = Grown { struct_size: 8, old: 5, new: 77 };
        // SAFETY: live structs at least as large as they say.
        unsafe {
            assert_eq!(read(&older, "x").unwrap(), Grown { struct_size: 8, old: 5, new: 2 });
            let newer = Grown { struct_size: 16, ..older };
            assert_eq!(read(&newer, "x").unwrap(), newer);
            assert_eq!(read::<Grown>(std::ptr::null(), "x").unwrap(), Grown::defaults());
        }
    }

    #[test]
    fn nothing_is_written_beyond_an_older_struct() {
        let mut older = FILLED;
        // SAFETY: as above.
        unsafe {
            init(&mut older, 8, "x").unwrap();
            assert_eq!(older, Grown { struct_size: 8, old: 1, new: 77 });
            write(&Grown { struct_size: 0, old: 3, new: 4 }, &mut older, "x").unwrap();
            assert_eq!(older, Grown { struct_size: 8, old: 3, new: 77 });
            let mut newer = FILLED;
            init(&mut newer, 16, "x").unwrap();
            assert_eq!(newer, Grown { struct_size: 16, old: 1, new: 2 });
        }
    }

    #[test]
    fn other_sizes_are_refused_and_written_nothing() {
        for size in [0, 4, 12, 24] {
            let mut it = FILLED;
            // SAFETY: as above; a size that is not known is not used.
            unsafe {
                assert_eq!(init(&mut it, size, "x").unwrap_err().status, WSP_ERR_STRUCT_SIZE);
                it.struct_size = size as u32;
                assert_eq!(read(&it, "x").unwrap_err().status, WSP_ERR_STRUCT_SIZE);
                assert_eq!(write(&Grown::defaults(), &mut it, "x").unwrap_err().status, WSP_ERR_STRUCT_SIZE);
                assert_eq!(check_out(&mut it, "x").unwrap_err().status, WSP_ERR_STRUCT_SIZE);
            }
            assert_eq!(it, Grown { struct_size: size as u32, ..FILLED });
        }
    }
}
