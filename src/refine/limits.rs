//! When a refinement stops before it is done: seconds and bytes. Vertices and edge lengths are looked at where points are placed.

use std::time::{Duration, Instant};

use super::{RefineOptions, RefineStatus};

/// Looks at the clock are this many turns apart; a turn takes some tens of microseconds.
const INTERVAL: u32 = 8;

/// What is left of the limits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Limits {
    end: Option<Instant>,
    bytes: Option<usize>,
    turn: u32,
}

impl Limits {
    /// The limits of a call that begins now.
    pub fn new(options: &RefineOptions) -> Limits {
        // What is too long for a clock is as good as no limit; what is too short for it is over at once.
        let seconds = Duration::try_from_secs_f64(options.max_seconds).ok().filter(|_| options.max_seconds > 0.0);
        Limits {
            end: seconds.and_then(|seconds| Instant::now().checked_add(seconds)),
            bytes: Some(options.max_memory).filter(|&bytes| bytes > 0),
            turn: 0,
        }
    }

    /// Whether one has been reached; `bytes` says how many there are or will soon be.
    #[inline]
    pub fn reached(&mut self, bytes: impl FnOnce() -> usize) -> Option<RefineStatus> {
        if self.end.is_none() && self.bytes.is_none() {
            return None;
        }
        self.turn = self.turn.wrapping_add(1);
        if self.turn % INTERVAL == 1 && self.end.is_some_and(|end| Instant::now() >= end) {
            return Some(RefineStatus::TimeLimit);
        }
        self.bytes.is_some_and(|limit| bytes() > limit).then_some(RefineStatus::MemoryLimit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reached(max_seconds: f64, max_memory: usize, bytes: usize) -> Option<RefineStatus> {
        Limits::new(&RefineOptions { max_seconds, max_memory, ..RefineOptions::default() }).reached(|| bytes)
    }

    #[test]
    fn zero_and_the_unreachable_are_no_limits() {
        assert_eq!(reached(0.0, 0, usize::MAX), None);
        assert_eq!(reached(1e300, usize::MAX, usize::MAX), None);
        assert_eq!(reached(f64::INFINITY, 100, 100), None);
        assert_eq!(reached(1e6, 100, 101), Some(RefineStatus::MemoryLimit));
        assert_eq!(reached(1e-300, 0, 0), Some(RefineStatus::TimeLimit));
    }
}
