//! The boundary itself: every function that can fail runs its body in [`call`]. A panic ends here, the
//! floating-point mode is set and put back, and a failure leaves its status and its text.

use std::cell::RefCell;
use std::panic::{catch_unwind, AssertUnwindSafe, PanicHookInfo};
use std::sync::Once;

use super::float_env::{in_host_mode, Computing};
use super::last_error;
use super::status::*;
use crate::Error;

/// Why a call failed: its status and what `wsp_last_error` says, less the function's name.
#[derive(Debug)]
pub(super) struct Failure {
    pub status: wsp_status,
    pub text: String,
}

impl Failure {
    pub fn new(status: wsp_status, text: impl Into<String>) -> Failure {
        Failure { status, text: text.into() }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Failure {
        let status = match &error {
            Error::NotFinite { .. } => WSP_ERR_NOT_FINITE,
            Error::OutOfRange { .. } => WSP_ERR_OUT_OF_RANGE,
            Error::TooManyVertices { .. } => WSP_ERR_TOO_MANY,
            Error::NoSuchVertex { .. } => WSP_ERR_NO_SUCH_VERTEX,
            Error::NoSuchEdge { .. } => WSP_ERR_NO_SUCH_EDGE,
            Error::Occupied { .. } => WSP_ERR_ARGUMENT,
            Error::InvalidOption { .. } => WSP_ERR_OPTION,
            Error::InvalidDomain { .. } => WSP_ERR_INVALID_DOMAIN,
            Error::Domain { .. } => WSP_ERR_DOMAIN,
            Error::InvalidMesh { .. } => WSP_ERR_NOT_VALID,
            // Calls that can be cancelled answer WSP_CANCELLED themselves.
            Error::Cancelled => WSP_ERR_INTERNAL,
            Error::OutOfMemory { .. } => WSP_ERR_MEMORY,
        };
        Failure::new(status, error.to_string())
    }
}

pub(super) type Answer = Result<wsp_status, Failure>;

/// Runs the body of the C function `name` and gives its status to the host, whatever happens.
pub(super) fn call(name: &'static str, body: impl FnOnce() -> Answer) -> wsp_status {
    let _computing = Computing::enter();
    listen_to_panics();
    let outer = PANIC.try_with(|panic| panic.replace(Listening::Yes(None))).unwrap_or(Listening::No);
    // A handle that a panic leaves half changed is poisoned by its own guard (see `handle`), so nothing broken
    // can be seen afterwards.
    let outcome = catch_unwind(AssertUnwindSafe(body));
    let heard = PANIC.try_with(|panic| panic.replace(outer)).unwrap_or(Listening::No);
    match outcome {
        Ok(Ok(status)) => status,
        Ok(Err(failure)) => {
            last_error::set(&format!("{name}: {}", failure.text));
            failure.status
        }
        Err(payload) => {
            let heard = match heard {
                Listening::Yes(Some(text)) => text,
                _ => message(&*payload).to_owned(),
            };
            // Any other payload may panic when it is dropped, which would get out after all.
            if !payload.is::<&str>() && !payload.is::<String>() {
                std::mem::forget(payload);
            }
            last_error::set(&format!("{name}: internal error, please report it: {heard}"));
            WSP_ERR_INTERNAL
        }
    }
}

/// [`call`] for functions that return nothing: a failure leaves its text only.
pub(super) fn call_void(name: &'static str, body: impl FnOnce() -> Result<(), Failure>) {
    call(name, || body().map(|()| WSP_DONE));
}

/// Runs the host's own code in the middle of a [`call`]: in the host's floating-point mode, and its panics, if it is
/// written in Rust, are told as it likes.
pub(super) fn host_code<T>(callback: impl FnOnce() -> T) -> T {
    struct Back(Listening);
    impl Drop for Back {
        fn drop(&mut self) {
            let heard = std::mem::replace(&mut self.0, Listening::No);
            let _ = PANIC.try_with(|panic| panic.replace(heard));
        }
    }
    let _back = Back(PANIC.try_with(|panic| panic.replace(Listening::No)).unwrap_or(Listening::No));
    in_host_mode(callback)
}

enum Listening {
    No,
    /// Within [`call`], with what the hook heard.
    Yes(Option<String>),
}

thread_local! {
    static PANIC: RefCell<Listening> = const { RefCell::new(Listening::No) };
}

fn message(payload: &(dyn std::any::Any + Send)) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic without a message")
}

/// Within [`call`] a panic is told to `wsp_last_error` with its place in the source, and not printed to the
/// host's standard error. All others go where they went before.
fn listen_to_panics() {
    static ONCE: Once = Once::new();
    if ONCE.is_completed() || std::thread::panicking() {
        return;
    }
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info: &PanicHookInfo<'_>| {
            let heard = PANIC.try_with(|panic| match panic.try_borrow_mut().as_deref_mut() {
                Ok(Listening::Yes(heard)) => {
                    let place = info.location().map(|at| format!(" ({}:{})", at.file(), at.line()));
                    *heard = Some(format!("{}{}", message(info.payload()), place.unwrap_or_default()));
                    true
                }
                _ => false,
            });
            if heard != Ok(true) {
                before(info);
            }
        }));
    });
}
