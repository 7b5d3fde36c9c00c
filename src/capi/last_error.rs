//! The text of a thread's last failure. Each thread has its own, so nothing is locked and no other thread's
//! failure is reported.

use std::cell::RefCell;
use std::ffi::{c_char, CString};

thread_local! {
    static TEXT: RefCell<Option<CString>> = const { RefCell::new(None) };
}

/// Replaces the thread's text. A NUL in it (possible in a panic's message only) ends it.
pub(super) fn set(text: &str) {
    let bytes: Vec<u8> = text.bytes().take_while(|&b| b != 0).collect();
    let text = CString::new(bytes).unwrap_or_default();
    // While the thread ends its locals may be gone already; the status still tells the failure then.
    let _ = TEXT.try_with(|slot| {
        if let Ok(mut slot) = slot.try_borrow_mut() {
            *slot = Some(text);
        }
    });
}

/// The thread's text as a C string, valid until its next [`set`]; "" if nothing has failed.
pub(super) fn get() -> *const c_char {
    let held = TEXT.try_with(|slot| slot.try_borrow().ok().and_then(|slot| slot.as_ref().map(|text| text.as_ptr())));
    held.ok().flatten().unwrap_or(c"".as_ptr())
}
