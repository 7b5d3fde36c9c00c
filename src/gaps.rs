//! How long a call goes without looking at its control: what it takes at most to hear of a cancellation. Samples of cancelled calls miss the longest of
//! these gaps, so that `benches/cancel.rs` asks for all of them.
//!
//! Only in builds with `--cfg wellspaced_gaps`. Looks are those of the thread that asks: measure on one thread.

use std::backtrace::Backtrace;
use std::cell::RefCell;
use std::panic::Location;
use std::time::{Duration, Instant};

/// Time without a look at the control.
#[derive(Clone, Debug)]
pub struct Gap {
    /// How long it was.
    pub length: Duration,
    /// Where the look was that it began with; `None` for the beginning of the call.
    pub from: Option<&'static Location<'static>>,
    /// Functions of this library that were running at its end, the innermost first; none where the call itself ended it.
    pub functions: Vec<String>,
}

/// What is being measured.
struct Measured {
    /// What is shorter is of no interest.
    least: Duration,
    last: Instant,
    at: Option<&'static Location<'static>>,
    gaps: Vec<Gap>,
}

thread_local! {
    static MEASURED: RefCell<Option<Measured>> = const { RefCell::new(None) };
}

/// All gaps of a call that are as long as that, the longest first. Time between the call's beginning and its first look is one, and so is time
/// from the last look to its end.
pub fn gaps(least: Duration, call: impl FnOnce()) -> Vec<Gap> {
    MEASURED.set(Some(Measured { least, last: Instant::now(), at: None, gaps: Vec::new() }));
    call();
    note(None, Vec::new);
    let mut gaps = MEASURED.take().map(|measured| measured.gaps).unwrap_or_default();
    gaps.sort_by_key(|gap| std::cmp::Reverse(gap.length));
    gaps
}

/// A look at a control.
#[track_caller]
pub(crate) fn look() {
    note(Some(Location::caller()), || {
        let all = Backtrace::force_capture().to_string();
        let names = all.lines().filter_map(|line| line.trim_start().split_once(": ").map(|(_, name)| name));
        let ours = names.filter(|name| name.contains("wellspaced::"));
        ours.skip_while(|name| name.contains("gaps::") || name.contains("control::")).map(String::from).collect()
    });
}

fn note(at: Option<&'static Location<'static>>, functions: impl FnOnce() -> Vec<String>) {
    MEASURED.with_borrow_mut(|measured| {
        let Some(measured) = measured else { return };
        let length = measured.last.elapsed();
        if length >= measured.least {
            measured.gaps.push(Gap { length, from: measured.at, functions: functions() });
        }
        (measured.last, measured.at) = (Instant::now(), at);
    });
}
