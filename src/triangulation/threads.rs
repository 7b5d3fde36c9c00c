//! Work shared out among threads: each takes the next part when it is done with one. Who does what is up to chance, so
//! the parts must not depend on each other.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Does `work` on every part, on so many threads at most, this one among them. Threads that the system does not give are done without.
pub(super) fn share_out<I>(threads: usize, parts: I, work: impl Fn(I::Item) + Sync)
where
    I: Iterator,
    I::Item: Send,
{
    // Each part has a lock of its own that nobody else waits for: who has its number takes it.
    let parts: Vec<_> = parts.map(|part| Mutex::new(Some(part))).collect();
    let taken = AtomicUsize::new(0);
    let run = || {
        while let Some(part) = parts.get(taken.fetch_add(1, Ordering::Relaxed)) {
            let part = part.lock().unwrap_or_else(PoisonError::into_inner).take();
            part.into_iter().for_each(&work);
        }
    };
    thread::scope(|scope| {
        let mut helpers = Vec::new();
        for _ in 1..threads.min(parts.len()) {
            // A thread begins with the floating-point mode of the one that starts it.
            match thread::Builder::new().spawn_scoped(scope, run) {
                Ok(helper) => helpers.push(helper),
                Err(_) => break,
            }
        }
        run();
        // The scope would wait for them, too, but by means that checkers of threads don't see.
        for helper in helpers {
            if let Err(panic) = helper.join() {
                std::panic::resume_unwind(panic);
            }
        }
    });
}

/// How many threads a caller's number stands for: 0 for as many as there are processors.
pub(super) fn count(threads: usize) -> usize {
    match threads {
        0 => thread::available_parallelism().map_or(1, usize::from),
        n => n,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_done_once() {
        for threads in [1, 2, 5] {
            let mut values = vec![0u32; 1000];
            share_out(threads, values.chunks_mut(7).enumerate(), |(i, chunk)| {
                chunk.iter_mut().for_each(|x| *x += i as u32 + 1);
            });
            assert!(values.iter().enumerate().all(|(i, &x)| x as usize == i / 7 + 1));
        }
        assert_eq!(count(3), 3);
        assert!(count(0) >= 1);
    }
}
