//! Progress, cancellation and log.

use std::ffi::{c_char, c_void, CString};
use std::sync::{PoisonError, RwLock};

use super::args;
use super::guard::{call, call_void, host_code, Failure};
use super::status::*;
use crate::{Control, LogLevel, Progress};

/// A handle through which long calls are followed and cancelled.
///
/// Give it to as many calls as you like, one after the other or at once. Everything but its `_free` may be called
/// from any thread at any time.
pub struct wsp_control {
    /// Behind a lock only because a log may be set later; what is inside is shared by all clones.
    control: RwLock<Control>,
}

impl wsp_control {
    fn core(&self) -> Control {
        // Nothing can panic while the lock is held.
        self.control.read().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// How far a call has come. Valid during the callback only; fields may be appended in later versions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_progress {
    /// The size of the struct that the library fills.
    pub struct_size: u32,
    /// 0.
    pub flags: u32,
    /// What is being done now: "delaunay", "boundary", "refine", "sparsify", "validate", "view".
    pub stage: *const c_char,
    /// From 0 to 1 within the stage. An estimate: refinement can't know its end.
    pub fraction: f64,
    /// Vertices of the triangulation now.
    pub vertices: usize,
}

/// Told now and then how far a call has come; returns 0 to go on and anything else to cancel.
///
/// It runs on the thread that made the call, in the floating-point mode in which that thread called. It must
/// return: no exception and no longjmp may leave it (the C++ face sees to that). It must not use the handle of the
/// call that it runs in (WSP_ERR_BUSY); others are free.
pub type wsp_progress_callback = Option<unsafe extern "C" fn(user: *mut c_void, progress: *const wsp_progress) -> i32>;

/// A line for information: what a call is doing, some lines a call.
pub const WSP_LOG_INFO: u32 = 1;
/// A warning: a call has ended at a limit, or with something that can't be mended.
pub const WSP_LOG_WARNING: u32 = 2;

/// Told what calls do, line by line: `level` is a WSP_LOG_ constant (later versions may have more), `text` is UTF-8 without a line's end, valid
/// during the callback only. It runs as a wsp_progress_callback does, and the same is forbidden to it.
pub type wsp_log_callback = Option<unsafe extern "C" fn(user: *mut c_void, level: u32, text: *const c_char)>;

struct Log {
    function: unsafe extern "C" fn(*mut c_void, u32, *const c_char),
    user: *mut c_void,
}

// SAFETY: as for `Callback` below.
unsafe impl Send for Log {}
// SAFETY: as above.
unsafe impl Sync for Log {}

impl Log {
    fn write(&self, level: LogLevel, text: &str) {
        let text = CString::new(text).unwrap_or_default();
        let level = match level {
            LogLevel::Info => WSP_LOG_INFO,
            LogLevel::Warning => WSP_LOG_WARNING,
        };
        // SAFETY: the host's own function with the host's own pointer, as it asked for.
        host_code(|| unsafe { (self.function)(self.user, level, text.as_ptr()) });
    }
}

struct Callback {
    function: unsafe extern "C" fn(*mut c_void, *const wsp_progress) -> i32,
    user: *mut c_void,
}

// SAFETY: `user` is only ever handed to the host's own function, on a thread that the host has chosen by
// calling with this control; the header demands that both can stand it.
unsafe impl Send for Callback {}
// SAFETY: as above.
unsafe impl Sync for Callback {}

impl Callback {
    fn goes_on(&self, progress: Progress) -> bool {
        let stage = CString::new(progress.stage).unwrap_or_default();
        let told = wsp_progress {
            struct_size: size_of::<wsp_progress>() as u32,
            flags: 0,
            stage: stage.as_ptr(),
            fraction: progress.fraction,
            vertices: progress.vertices,
        };
        // SAFETY: the host's own function with the host's own pointer, as it asked for.
        host_code(|| unsafe { (self.function)(self.user, &told) }) == 0
    }
}

/// Makes a control. `callback` may be NULL: the control then only cancels. `user` is handed to the callback as it
/// is and may be NULL; what it points to must live as long as the control is in use, and stand the threads that
/// the control's calls run on.
///
/// `*out` belongs to the caller: free it with wsp_control_free. On an error it is NULL.
/// Errors: WSP_ERR_NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_control_new(
    callback: wsp_progress_callback,
    user: *mut c_void,
    out: *mut *mut wsp_control,
) -> wsp_status {
    call("wsp_control_new", || {
        // SAFETY: `out` is writable or NULL.
        unsafe { args::handle_out(out, "out")? };
        let control = match callback {
            Some(function) => {
                let callback = Callback { function, user };
                Control::with_progress(move |progress| callback.goes_on(progress))
            }
            None => Control::new(),
        };
        // SAFETY: checked above.
        unsafe { args::give(wsp_control { control: RwLock::new(control) }, out) };
        Ok(WSP_DONE)
    })
}

/// Gives calls that begin with `control` from now on a log; NULL for `callback` takes it away. `user` is handed to the callback as it is: what it
/// points to must live until those calls have ended. Any thread. Constant time.
/// Errors: WSP_ERR_NULL (`control`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_control_set_log(
    control: *mut wsp_control,
    callback: wsp_log_callback,
    user: *mut c_void,
) -> wsp_status {
    call("wsp_control_set_log", || {
        // SAFETY: NULL or a live control; only shared references to it are ever made.
        let control = unsafe { args::reference(control, "control")? };
        let mut control = control.control.write().unwrap_or_else(PoisonError::into_inner);
        let next = match callback {
            Some(function) => {
                let log = Log { function, user };
                control.clone().with_log(move |level, text| log.write(level, text))
            }
            None => control.clone().without_log(),
        };
        *control = next;
        Ok(WSP_DONE)
    })
}

/// Frees a control, and what memory cancelled calls have left it; NULL is ignored. Calls that are running with it keep what they need of it, the callback and
/// its `user` included.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_control_free(control: *mut wsp_control) {
    // SAFETY: NULL, or a control that is not used after this.
    call_void("wsp_control_free", || unsafe {
        args::free(control);
        Ok(())
    });
}

/// Asks every call that runs with `control`, and every later one, to stop soon, until wsp_control_reset. They return
/// WSP_CANCELLED, within some milliseconds: large memory that they have no more use for they leave to the control, which gives it back when it is
/// reset or freed. Any thread may call this, a callback too. Constant time.
///
/// That holds for stars of millions of tetrahedra and for splits of facets with as many triangles, too: before so much is changed at once, what there is is
/// copied, to be taken back as a whole.
/// Errors: WSP_ERR_NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_control_cancel(control: *mut wsp_control) -> wsp_status {
    call("wsp_control_cancel", || {
        // SAFETY: NULL or a live control; only shared references to it are ever made.
        unsafe { args::reference(control, "control")? }.core().cancel();
        Ok(WSP_DONE)
    })
}

/// Takes a cancellation back, the callback's too, so that the control can be used again, and gives back the memory that cancelled calls have left:
/// some 30 ms for what a million points take, otherwise constant time. Any thread.
/// Errors: WSP_ERR_NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_control_reset(control: *mut wsp_control) -> wsp_status {
    call("wsp_control_reset", || {
        // SAFETY: as above.
        unsafe { args::reference(control, "control")? }.core().reset();
        Ok(WSP_DONE)
    })
}

/// The core's control behind the handle, kept alive by the clone; for NULL one that never cancels.
///
/// # Safety
/// `control` is NULL or live.
pub(super) unsafe fn core(control: *const wsp_control) -> Result<Control, Failure> {
    if control.is_null() {
        return Ok(Control::new());
    }
    // SAFETY: as the caller promises.
    Ok(unsafe { args::reference(control, "control")? }.core())
}
