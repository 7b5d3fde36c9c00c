//! Work shared out among threads: each takes the next part when it is done with one. Who does what is up to chance, so
//! the parts must not depend on each other.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Does `work` on every part, on so many threads at most, this one among them. Threads that the system does not give are done without.
pub(crate) fn share_out<I>(threads: usize, parts: I, work: impl Fn(I::Item) + Sync)
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
    side_by_side((1..threads.min(parts.len())).map(|_| run), run);
}

/// Does `work` for every number below `count`, on one thread for each of `states`, this one among them, which asks `go_on` before each of its
/// numbers. False when that has said stop; some numbers may be left out then. Threads that the system does not give are done without.
pub(crate) fn share_numbers<S: Send>(
    states: &mut [S],
    count: usize,
    work: impl Fn(&mut S, usize) + Sync,
    mut go_on: impl FnMut() -> bool,
) -> bool {
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let take = || {
        let number = next.fetch_add(1, Ordering::Relaxed);
        (number < count && !stop.load(Ordering::Relaxed)).then_some(number)
    };
    let Some((own, others)) = states.split_first_mut() else { return count == 0 };
    let helpers = others.iter_mut().map(|state| {
        let (work, take) = (&work, &take);
        move || {
            while let Some(number) = take() {
                work(state, number);
            }
        }
    });
    side_by_side(helpers, || {
        while let Some(number) = take() {
            if !go_on() {
                stop.store(true, Ordering::Relaxed);
                break;
            }
            work(own, number);
        }
    });
    !stop.load(Ordering::Relaxed)
}

/// Runs `own` on this thread and each helper on one of its own, up to the first that the system does not give; returns when all are done.
fn side_by_side(helpers: impl Iterator<Item = impl FnOnce() + Send>, own: impl FnOnce()) {
    thread::scope(|scope| {
        // A thread begins with the floating-point mode of the one that starts it.
        let started = |helper| thread::Builder::new().spawn_scoped(scope, helper).ok();
        let running: Vec<_> = helpers.map_while(started).collect();
        own();
        // The scope would wait for them, too, but by means that checkers of threads don't see.
        for helper in running {
            if let Err(panic) = helper.join() {
                std::panic::resume_unwind(panic);
            }
        }
    });
}

/// How many threads a caller's number stands for: 0 for as many as there are processors.
pub(crate) fn count(threads: usize) -> usize {
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

    #[test]
    fn every_number_is_done_once_until_a_stop() {
        for threads in [1, 2, 5] {
            let mut states = vec![Vec::new(); threads];
            assert!(share_numbers(&mut states, 1000, |state, number| state.push(number), || true));
            let mut all = states.concat();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..1000));
            let (mut states, mut looks) = (vec![0; threads], 0);
            let go_on = || {
                looks += 1;
                looks < 10
            };
            let work = |done: &mut usize, _: usize| {
                *done += 1;
                thread::sleep(std::time::Duration::from_micros(10));
            };
            assert!(!share_numbers(&mut states, usize::MAX, work, go_on));
            assert_eq!(states[0], 9);
        }
        assert!(share_numbers(&mut [0; 2], 0, |_, _| unreachable!(), || unreachable!()));
    }
}
