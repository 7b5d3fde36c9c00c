//! One pass of a bulk insertion over the territories of a [partition](super::partition): each is worked on by one thread, the points in
//! their order, and what reaches beyond the [territory](super::territory) is put off. The result depends on the partition alone: on one
//! thread the territories are done one after the other, with the same outcome in every byte.
//!
//! New tetrahedra need places. Every territory has places of its own: the memory behind the present tetrahedra
//! is dealt out to the territories in turn, in chunks.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use super::cavity::Cavity;
use super::partition::{AnyTerritory, Partition};
use super::search::{search_from, walk_to};
use super::site::Site;
use super::territory::Territory;
use super::topology::{Tetrahedron, MAX_TETRAHEDRA, NONE};
use crate::geometry::Filter;
use crate::{Control, Error};

/// Places a chunk.
const CHUNK: usize = 1024;
/// One start serves so many points.
pub(super) const BLOCK: usize = 4096;
/// How many points are inserted between two looks at the control.
pub(super) const POLL_INTERVAL: usize = 256;
/// How long the caller's thread waits for the others before it looks at the control again.
const WAIT: Duration = Duration::from_millis(5);

/// What all threads need.
pub(super) struct Pass<'a> {
    pub site: Site<'a>,
    pub filter: &'a Filter,
    pub partition: &'a Partition,
    /// For each territory, tetrahedra near every [`BLOCK`]th of its points to start from, or [`NONE`].
    pub starts: &'a [Vec<u32>],
    /// Places below this are in use, or on the free list.
    pub used: usize,
    pub control: &'a Control,
}

/// What became of a territory's points.
#[derive(Debug)]
pub(super) struct Outcome {
    territory: usize,
    /// Points that reach beyond it, each with a tetrahedron near it, or one that was there once, or [`NONE`].
    pub put_off: Vec<(u32, u32)>,
    /// Points that had a vertex already: theirs, and that.
    pub duplicates: Vec<(u32, u32)>,
    /// A live tetrahedron, or [`NONE`].
    pub last: u32,
    /// How many more ghosts there are.
    pub ghosts: isize,
    places: Places,
    stopped: bool,
}

/// The places of one territory.
#[derive(Debug, Default)]
struct Places {
    /// Freed ones.
    free: Vec<u32>,
    /// What is left of the last chunk.
    next: usize,
    end: usize,
    /// How many chunks were taken.
    chunks: usize,
}

/// Tells all others to stop when its thread panics, and wakes the caller's thread in the end.
struct Watch<'a> {
    stop: &'a AtomicBool,
    caller: thread::Thread,
}

impl Drop for Watch<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.stop.store(true, Ordering::Relaxed);
        }
        self.caller.unpark();
    }
}

impl Pass<'_> {
    /// Works on all territories, with a thread for each of `cavities`, the caller's among them. It calls `report` with the number of points done
    /// now and then, which returns `false` to stop. Returns the outcomes in order, or `None` when stopped.
    ///
    /// # Safety
    /// The site's tetrahedra below `used` are a triangulation of vertices that the partition knows, and dead ones; there is nobody else who uses
    /// it. The starts are live, and two of each one's vertices are in the territory. The cavities have room for all.
    pub unsafe fn run(&self, cavities: &mut [Cavity], mut report: impl FnMut(usize) -> bool) -> Option<Vec<Outcome>> {
        let (next, done, stop) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicBool::new(false));
        let work = |cavity: &mut Cavity, go_on: &mut dyn FnMut() -> bool| {
            let mut outcomes = Vec::new();
            loop {
                let territory = next.fetch_add(1, Ordering::Relaxed);
                if territory >= self.starts.len() {
                    return outcomes;
                }
                // SAFETY: the caller's promise; each territory is taken by one thread.
                let outcome = unsafe {
                    match self.partition.territory(territory) {
                        AnyTerritory::Ids(own) => self.insert(territory, own, cavity, &done, go_on),
                        AnyTerritory::Own(own) => self.insert(territory, own, cavity, &done, go_on),
                    }
                };
                let stopped = outcome.stopped;
                outcomes.push(outcome);
                if stopped {
                    stop.store(true, Ordering::Relaxed);
                    return outcomes;
                }
            }
        };
        let goes_on = || !stop.load(Ordering::Relaxed) && self.control.poll();
        let (own, others) = cavities.split_first_mut()?;
        let caller = thread::current();
        let mut outcomes = thread::scope(|scope| {
            let mut helpers = Vec::new();
            for cavity in others {
                let (work, stop, goes_on, caller) = (&work, &stop, &goes_on, caller.clone());
                // A thread begins with the floating-point mode of the one that starts it: that of the predicates.
                let helper = thread::Builder::new().spawn_scoped(scope, move || {
                    let _watch = Watch { stop, caller };
                    work(cavity, &mut || goes_on())
                });
                match helper {
                    Ok(helper) => helpers.push(helper),
                    // The territories are done all the same.
                    Err(_) => break,
                }
            }
            // If the host's callback panics.
            let _watch = Watch { stop: &stop, caller };
            let mut go_on = || goes_on() && report(done.load(Ordering::Relaxed));
            let mut outcomes = work(own, &mut go_on);
            while helpers.iter().any(|helper| !helper.is_finished()) {
                thread::park_timeout(WAIT);
                if !go_on() {
                    stop.store(true, Ordering::Relaxed);
                }
            }
            for helper in helpers {
                match helper.join() {
                    Ok(more) => outcomes.extend(more),
                    Err(panic) => std::panic::resume_unwind(panic),
                }
            }
            outcomes
        });
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        outcomes.sort_unstable_by_key(|outcome| outcome.territory);
        Some(outcomes)
    }

    /// Inserts the points of one territory.
    ///
    /// # Safety
    /// As [`run`](Self::run); no other thread has this territory, which is `own`.
    unsafe fn insert<T: Territory>(
        &self,
        territory: usize,
        own: T,
        cavity: &mut Cavity,
        done: &AtomicUsize,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Outcome {
        let (site, filter) = (self.site, self.filter);
        let pending = self.partition.pending_in(territory);
        let mut outcome = Outcome {
            territory,
            put_off: Vec::new(),
            duplicates: Vec::new(),
            last: NONE,
            ghosts: 0,
            places: Places::default(),
            stopped: false,
        };
        let mut told = 0;
        let mut tell = |turn: usize, put_off: usize| {
            done.fetch_add(turn - put_off - told, Ordering::Relaxed);
            told = turn - put_off;
        };
        for (turn, &vertex) in pending.iter().enumerate() {
            let asks = turn % POLL_INTERVAL == 0;
            if asks {
                tell(turn, outcome.put_off.len());
            }
            // A cancellation from another thread is seen at once.
            if !self.control.poll() || asks && !go_on() {
                outcome.stopped = true;
                return outcome;
            }
            // SAFETY: the starts have two own vertices, so that nobody else replaces them: as long as this thread does not do so they are
            // live, and after it their places are its own. So is the last tetrahedron. The cavity is empty, with room for all. What it holds,
            // and what is around it, belongs to the territory, so no other thread has anything to do with it.
            unsafe {
                let point = *site.point(vertex);
                let mut found = (NONE, false);
                for start in [outcome.last, self.starts[territory][turn / BLOCK]] {
                    if start != NONE && site.is_live(start) {
                        found = walk_to(site, filter, point, start, own);
                        if found.1 {
                            break;
                        }
                    }
                }
                let (t, arrived) = found;
                if !arrived {
                    outcome.put_off.push((vertex, t));
                    continue;
                }
                outcome.last = t;
                if let Some(at) = site.vertex_at(t, point) {
                    outcome.duplicates.push((vertex, at));
                    continue;
                }
                if !search_from(site, filter, point, t, cavity, (own, self.control))
                    || cavity.plan(site, self.control).is_err()
                    || !self.allocate(territory, cavity, &mut outcome)
                {
                    cavity.clear();
                    outcome.put_off.push((vertex, t));
                    continue;
                }
                let Ok(ghosts) = cavity.fill(site, vertex, self.control) else {
                    outcome.stopped = true;
                    return outcome;
                };
                outcome.ghosts += ghosts as isize;
                for &t in cavity.tets.iter().skip(cavity.faces.len()).rev() {
                    site.put(t, Tetrahedron::DEAD);
                    outcome.places.free.push(t);
                }
                outcome.last = cavity.created[cavity.created.len() - 1];
                cavity.clear_lists();
            }
        }
        tell(pending.len(), outcome.put_off.len());
        outcome
    }

    /// Finds places for the star that replaces the cavity; `false` where there are not enough, or the control says stop.
    ///
    /// # Safety
    /// The cavity's tetrahedra are live and belong to the territory.
    #[inline]
    unsafe fn allocate(&self, territory: usize, cavity: &mut Cavity, outcome: &mut Outcome) -> bool {
        let Cavity { tets, faces, created, labels, .. } = cavity;
        let places = &mut outcome.places;
        let more = faces.len().saturating_sub(tets.len());
        while places.end - places.next + places.free.len() < more {
            if !self.control.poll() {
                return false;
            }
            // The rest of the chunk joins the free places, the lowest to be used first.
            for t in (places.next..places.end).rev() {
                // SAFETY: places of this territory.
                unsafe { self.site.put(t as u32, Tetrahedron::DEAD) };
                places.free.push(t as u32);
            }
            (places.next, places.end) = (0, 0);
            let Some(start) = self.chunk(territory, places.chunks) else { return false };
            (places.next, places.end) = (start, start + CHUNK);
            places.chunks += 1;
        }
        created.clear();
        created.extend_from_slice(&tets[..tets.len().min(faces.len())]);
        for _ in 0..more {
            created.push(places.free.pop().unwrap_or_else(|| {
                places.next += 1;
                places.next as u32 - 1
            }));
        }
        if labels.has_ghost() {
            for part in tets.chunks(CHUNK) {
                // SAFETY: the caller's promise.
                let ghosts = part.iter().filter(|&&t| unsafe { self.site.tet(t) }.is_ghost()).count();
                outcome.ghosts -= ghosts as isize;
                if !self.control.poll() {
                    return false;
                }
            }
        }
        true
    }

    /// Where a territory's chunk begins, if there is memory for it.
    fn chunk(&self, territory: usize, number: usize) -> Option<usize> {
        let start = self.used + (number * self.starts.len() + territory) * CHUNK;
        (start + CHUNK <= self.site.room().min(MAX_TETRAHEDRA)).then_some(start)
    }

    /// Settles what is in use now: makes all places up to there dead that nobody took, and returns how many places there are, and the
    /// free ones among them, the lowest last. [`Error::Cancelled`] when the control says so.
    ///
    /// # Safety
    /// The outcomes are those of this pass, which is over.
    pub unsafe fn settle(&self, outcomes: &[Outcome]) -> Result<(usize, Vec<u32>), Error> {
        let mut end = self.used;
        let mut chunks = 0;
        for (territory, Outcome { places, .. }) in outcomes.iter().enumerate() {
            chunks = chunks.max(places.chunks);
            for number in 0..places.chunks {
                let start = self.chunk(territory, number).unwrap_or(0);
                let is_open = number + 1 == places.chunks && places.end != 0;
                end = end.max(if is_open { places.next } else { start + CHUNK });
            }
        }
        let mut free = Vec::new();
        for number in (0..chunks).rev() {
            for (territory, Outcome { places, .. }) in outcomes.iter().enumerate().rev() {
                self.control.check()?;
                let Some(start) = self.chunk(territory, number) else { continue };
                let is_open = number + 1 == places.chunks && places.end != 0;
                let unused = if number >= places.chunks {
                    start
                } else if is_open {
                    places.next
                } else {
                    continue;
                };
                for t in (unused..(start + CHUNK).min(end)).rev() {
                    // SAFETY: there is memory for it, and nobody has it.
                    unsafe { self.site.put(t as u32, Tetrahedron::DEAD) };
                    free.push(t as u32);
                }
            }
        }
        for Outcome { places, .. } in outcomes {
            for part in places.free.chunks(CHUNK) {
                self.control.check()?;
                free.extend_from_slice(part);
            }
        }
        Ok((end, free))
    }
}
