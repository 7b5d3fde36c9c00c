//! Work shared out among threads: each takes the next part when it is done with one. Who does what is up to chance, so
//! the parts must not depend on each other.

use std::sync::{Mutex, PoisonError};
use std::thread;

/// Does `work` on every part, on so many threads at most, this one among them. Threads that the system does not give are done without.
pub(super) fn share_out<I>(threads: usize, parts: I, work: impl Fn(I::Item) + Sync)
where
    I: Iterator + Send,
{
    let queue = Mutex::new(parts);
    // No part is worked on while the queue is locked.
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let run = || {
        while let Some(part) = next() {
            work(part);
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads {
            // A thread begins with the floating-point mode of the one that starts it.
            if thread::Builder::new().spawn_scoped(scope, run).is_err() {
                break;
            }
        }
        run();
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
