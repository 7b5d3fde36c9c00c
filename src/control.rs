//! Progress, cancellation and log of long calls: one handle that a host shares with the call.
//!
//! The core polls [`Control::poll`] between insertions; the cost of a poll is one relaxed atomic
//! load, and the progress callback runs only every few hundred insertions. Where nothing is inserted, it looks at the control
//! about every millisecond.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

/// What a long call is doing now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The stage: `"delaunay"`, `"boundary"`, `"refine"`, `"sparsify"`, `"validate"` or `"view"`.
    pub stage: &'static str,
    /// From 0 to 1, never falling within a stage. Refinement can't know its end and
    /// approaches 1 by what is left in its queues.
    pub fraction: f64,
    /// Vertices of the triangulation now.
    pub vertices: usize,
}

/// The callback's type: it returns `false` to cancel.
pub type ProgressCallback = dyn Fn(Progress) -> bool + Send + Sync;

/// How much a line of the log matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum LogLevel {
    /// What a call is doing, some lines a call.
    Info,
    /// A call has ended before it was done: a limit was reached, or something could not be mended.
    Warning,
}

/// The log's type.
pub type LogCallback = dyn Fn(LogLevel, &str) + Send + Sync;

/// A handle through which a host follows and cancels a long call.
///
/// Clones share the cancel flag and the callback. `Control::default()` never cancels.
#[derive(Clone, Default)]
pub struct Control {
    cancel: Arc<AtomicBool>,
    progress: Option<Arc<ProgressCallback>>,
    log: Option<Arc<LogCallback>>,
}

impl Control {
    /// A control without a callback.
    pub fn new() -> Self {
        Self::default()
    }

    /// A control that reports progress to `callback`, which returns `false` to cancel.
    pub fn with_progress(callback: impl Fn(Progress) -> bool + Send + Sync + 'static) -> Self {
        Control { progress: Some(Arc::new(callback)), ..Control::default() }
    }

    /// The same control with a log: `callback` is called on the thread of the call, in order.
    pub fn with_log(mut self, callback: impl Fn(LogLevel, &str) + Send + Sync + 'static) -> Self {
        self.log = Some(Arc::new(callback));
        self
    }

    /// The same control without a log.
    pub fn without_log(mut self) -> Self {
        self.log = None;
        self
    }

    /// Asks the running call, and every later one with this control, to stop. Any thread may call it.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Takes a cancellation back, so that the control can be used again.
    pub fn reset(&self) {
        self.cancel.store(false, Ordering::Relaxed);
    }

    /// Whether [`cancel`](Self::cancel) was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Reports progress. Returns `false` when the call shall stop.
    pub(crate) fn report(&self, stage: &'static str, fraction: f64, vertices: usize) -> bool {
        if let Some(callback) = &self.progress {
            if !callback(Progress { stage, fraction, vertices }) {
                self.cancel();
            }
        }
        !self.is_cancelled()
    }

    /// Writes a line to the log; the text is made only if there is one.
    pub(crate) fn log(&self, level: LogLevel, text: impl FnOnce() -> String) {
        if let Some(log) = &self.log {
            log(level, &text());
        }
    }

    /// [`poll`](Self::poll) as a result.
    pub(crate) fn check(&self) -> Result<(), crate::Error> {
        if self.poll() {
            Ok(())
        } else {
            Err(crate::Error::Cancelled)
        }
    }

    /// The cheap question of a loop's every turn.
    pub(crate) fn poll(&self) -> bool {
        !self.is_cancelled()
    }
}

impl std::fmt::Debug for Control {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control")
            .field("cancelled", &self.is_cancelled())
            .field("progress", &self.progress.is_some())
            .field("log", &self.log.is_some())
            .finish()
    }
}
