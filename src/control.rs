//! Progress, cancellation and log of long calls: one handle that a host shares with the call.
//!
//! The core polls [`Control::poll`] between insertions; the cost of a poll is one relaxed atomic
//! load, and the progress callback runs only every few hundred insertions. Where nothing is inserted, it looks at the control
//! about every millisecond.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use crate::leavings::Leavings;

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
///
/// A cancelled call returns within some milliseconds. It does not wait for the system to take back large memory: that stays with the control until
/// it is [reset](Self::reset) or dropped.
///
/// That holds for stars of millions of tetrahedra and for splits of facets with as many triangles, too: before so much is changed at once, what there is is
/// copied, to be taken back as a whole.
#[derive(Clone, Default)]
pub struct Control {
    shared: Arc<Shared>,
    progress: Option<Arc<ProgressCallback>>,
    log: Option<Arc<LogCallback>>,
}

/// What clones have in common.
#[derive(Default)]
struct Shared {
    cancel: AtomicBool,
    /// What cancelled calls had no time to give back.
    leavings: Mutex<Vec<Box<dyn Leavings>>>,
    #[cfg(test)]
    looks: Looks,
}

/// Looks at the control, counted for tests: what a call does between two of them is how late it hears of a cancellation, on any machine.
#[cfg(test)]
#[derive(Default)]
struct Looks {
    count: std::sync::atomic::AtomicUsize,
    /// The one that cancels, from 1 on; 0 for none.
    last: std::sync::atomic::AtomicUsize,
}

impl Control {
    /// A control without a callback.
    pub fn new() -> Self {
        Self::default()
    }

    /// The one of calls that nobody cancels.
    #[inline]
    pub(crate) fn never() -> &'static Control {
        static NEVER: LazyLock<Control> = LazyLock::new(Control::new);
        &NEVER
    }

    /// Whether it is [that one](Self::never), or a clone of it.
    #[inline]
    pub(crate) fn is_never(&self) -> bool {
        Arc::ptr_eq(&self.shared, &Control::never().shared)
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
        // An exchange, not a store, because checkers of threads take plain stores beside reads for races.
        self.shared.cancel.swap(true, Ordering::Relaxed);
    }

    /// Takes a cancellation back, so that the control can be used again, and gives back the memory that cancelled calls have left.
    pub fn reset(&self) {
        self.shared.cancel.store(false, Ordering::Relaxed);
        let left = std::mem::take(&mut *self.left());
        drop(left);
    }

    fn left(&self) -> std::sync::MutexGuard<'_, Vec<Box<dyn Leavings>>> {
        self.shared.leavings.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Gives memory back in pieces; what is left of it after a cancellation stays here.
    pub(crate) fn give_back(&self, mut leavings: impl Leavings + 'static) {
        while self.poll() {
            if !leavings.give_back() {
                return;
            }
        }
        self.left().push(Box::new(leavings));
    }

    /// How many things cancelled calls have left here.
    #[cfg(test)]
    pub(crate) fn leavings(&self) -> usize {
        self.left().len()
    }

    /// How often `work` looks at the control. Look number `last` cancels it, counted from 1. The control is as new afterwards.
    #[cfg(test)]
    pub(crate) fn looks(&self, last: Option<usize>, work: impl FnOnce()) -> usize {
        let Looks { count, last: stored } = &self.shared.looks;
        count.store(0, Ordering::Relaxed);
        stored.store(last.unwrap_or(0), Ordering::Relaxed);
        work();
        stored.store(0, Ordering::Relaxed);
        self.reset();
        count.load(Ordering::Relaxed)
    }

    /// Whether [`cancel`](Self::cancel) was called.
    pub fn is_cancelled(&self) -> bool {
        self.shared.cancel.load(Ordering::Relaxed)
    }

    /// Reports progress. Returns `false` when the call shall stop.
    #[cfg_attr(wellspaced_gaps, track_caller)]
    pub(crate) fn report(&self, stage: &'static str, fraction: f64, vertices: usize) -> bool {
        #[cfg(wellspaced_gaps)]
        crate::gaps::look();
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
    #[cfg_attr(wellspaced_gaps, track_caller)]
    pub(crate) fn check(&self) -> Result<(), crate::Error> {
        if self.poll() {
            Ok(())
        } else {
            Err(crate::Error::Cancelled)
        }
    }

    /// For a loop of small turns: looks at the control in some of them.
    pub(crate) fn turns(&self) -> Turns<'_> {
        Turns { control: self, turn: Cell::new(0), stopped: Cell::new(false) }
    }

    /// For a loop whose turns may take tens of microseconds: exact arithmetic, most often.
    pub(crate) fn slow_turns(&self) -> Turns<'_, 8> {
        Turns { control: self, turn: Cell::new(0), stopped: Cell::new(false) }
    }

    /// For work that is shared out among threads.
    pub(crate) fn watch(&self) -> Watch<'_> {
        Watch { control: self, stopped: AtomicBool::new(false) }
    }

    /// The cheap question of a loop's every turn.
    #[cfg_attr(wellspaced_gaps, track_caller)]
    pub(crate) fn poll(&self) -> bool {
        #[cfg(wellspaced_gaps)]
        crate::gaps::look();
        #[cfg(test)]
        {
            let Looks { count, last } = &self.shared.looks;
            if count.fetch_add(1, Ordering::Relaxed) + 1 == last.load(Ordering::Relaxed) {
                self.cancel();
            }
        }
        !self.is_cancelled()
    }
}

/// Looks at a control in one of `EVERY` turns of a loop. Who has once been told to stop is told so ever after: a cancellation may be taken back meanwhile, but
/// what was left out is still to be done.
pub(crate) struct Turns<'a, const EVERY: u32 = 256> {
    control: &'a Control,
    turn: Cell<u32>,
    stopped: Cell<bool>,
}

impl<const EVERY: u32> Turns<'_, EVERY> {
    /// Whether to go on.
    #[inline]
    #[cfg_attr(wellspaced_gaps, track_caller)]
    pub fn go_on(&self) -> bool {
        self.turn.set(self.turn.get().wrapping_add(1));
        if self.turn.get() % EVERY == 0 && !self.control.poll() {
            self.stopped.set(true);
        }
        !self.stopped.get()
    }

    /// [`go_on`](Self::go_on) as a result.
    #[inline]
    #[cfg_attr(wellspaced_gaps, track_caller)]
    pub fn check(&self) -> Result<(), crate::Error> {
        if self.go_on() {
            Ok(())
        } else {
            Err(crate::Error::Cancelled)
        }
    }

    /// An error if any turn was told to stop.
    pub fn end(&self) -> Result<(), crate::Error> {
        if self.stopped.get() {
            Err(crate::Error::Cancelled)
        } else {
            Ok(())
        }
    }
}

/// The same for several threads, and at once.
pub(crate) struct Watch<'a> {
    control: &'a Control,
    stopped: AtomicBool,
}

impl<'a> Watch<'a> {
    pub fn control(&self) -> &'a Control {
        self.control
    }

    /// Whether to go on.
    #[cfg_attr(wellspaced_gaps, track_caller)]
    pub fn poll(&self) -> bool {
        if !self.control.poll() {
            self.stopped.store(true, Ordering::Relaxed);
        }
        !self.stopped.load(Ordering::Relaxed)
    }

    /// [`poll`](Self::poll) as a result.
    #[cfg_attr(wellspaced_gaps, track_caller)]
    pub fn check(&self) -> Result<(), crate::Error> {
        self.poll();
        self.end()
    }

    /// An error if any thread was told to stop. To be asked when they are done.
    pub fn end(&self) -> Result<(), crate::Error> {
        if self.stopped.load(Ordering::Relaxed) {
            Err(crate::Error::Cancelled)
        } else {
            Ok(())
        }
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
