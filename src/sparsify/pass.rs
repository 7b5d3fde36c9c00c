//! The pass over Steiner points that stand already: a queue of them is worked off in which each change brings its neighbourhood back, until nothing changes any
//! more.
//!
//! Nearly all of its time goes into looks at vertices, which change nothing, and of seven looks six come to nothing. So the vertices of a *block* are looked
//! at on several threads, with nothing changed meanwhile, and then what was found is made, in the order of the block. Where one of the vertices that go
//! has been touched by an earlier change of the block, the vertex that was looked at waits for another turn instead. Which vertices make a block depends on the
//! mesh alone, and everything that a look says does so too: the result is the same on any number of threads.
//!
//! Neighbours in one block would be in each other's way, and they come to the queue together. So each round of the queue is scattered.

use rustc_hash::FxHashSet;

use super::search::{Found, Partners, Searcher};
use super::{Odds, Scope, Sparsifier};
use crate::domain::Boundary;
use crate::refine::limits::Limits;
use crate::sorting::sort_by;
use crate::threads::share_numbers;
use crate::triangulation::Triangulation;
use crate::{Control, Error, RefineStatus};

/// A block is this part of what waits: where few do, many of a larger one would be neighbours.
const PART: usize = 32;
/// The smallest and the largest block. A look takes tens of microseconds, three to five times that at the highest level.
const BLOCK: [usize; 2] = [16, 128];
/// A thread is worth its start, and the memory of its own that it needs for each tetrahedron and vertex, for so many looks.
const SHARE: usize = 16;

/// Who looks at vertices, and what it has found.
#[derive(Debug)]
struct Worker {
    searcher: Searcher,
    looks: Vec<Look>,
}

/// What became of a look: by position in the block.
#[derive(Debug)]
struct Look {
    position: usize,
    found: Option<Found>,
    /// How the odds have changed.
    odds: Odds,
}

impl Worker {
    fn of(searcher: Searcher) -> Worker {
        Worker { searcher, looks: Vec::new() }
    }
}

impl Sparsifier {
    /// The pass over all Steiner points, or over those [left](Self::waiting) by one that was stopped. Says what stopped it, if it could not finish; the
    /// mesh is valid then too.
    pub fn run(
        &mut self,
        t: &mut Triangulation,
        boundary: &mut Boundary,
        control: &Control,
        limits: &mut Limits,
    ) -> Result<Option<RefineStatus>, Error> {
        let scope = self.searcher.scope;
        let mut workers = vec![Worker::of(std::mem::replace(&mut self.searcher, Searcher::new(scope)))];
        let threads = t.threads().min(BLOCK[1] / SHARE);
        workers.extend((1..threads).map(|_| Worker::of(Searcher::new(scope))));
        let mut work = Work::default();
        let stopped = match self.begin(&scope, &mut work.queue, (t, boundary), control) {
            Ok(()) => {
                let stopped = self.work_off(&mut workers, &mut work, (t, boundary), control, limits);
                self.waiting = Some(work.left());
                stopped
            }
            Err(error) => Err(error),
        };
        self.searcher = workers.swap_remove(0).searcher;
        match stopped {
            Err(Error::Cancelled) => Ok(Some(RefineStatus::Cancelled)),
            other => other,
        }
    }

    /// Queues what the pass begins with.
    fn begin(
        &self,
        scope: &Scope,
        queue: &mut Queue,
        (t, boundary): (&Triangulation, &Boundary),
        control: &Control,
    ) -> Result<(), Error> {
        let turns = control.turns();
        if let Some(left) = &self.waiting {
            for &v in left {
                turns.check()?;
                // Some may have gone since they were queued.
                if scope.may_go(t, boundary, v) {
                    queue.push(v);
                }
            }
            return Ok(());
        }
        for v in scope.first..t.vertex_slots() as u32 {
            turns.check()?;
            if scope.may_go(t, boundary, v) && (scope.effort.all || boundary.kind(v) != 0) {
                queue.push(v);
            }
        }
        Ok(())
    }

    fn work_off(
        &mut self,
        workers: &mut [Worker],
        Work { queue, block }: &mut Work,
        (t, boundary): (&mut Triangulation, &mut Boundary),
        control: &Control,
        limits: &mut Limits,
    ) -> Result<Option<RefineStatus>, Error> {
        let scope = workers[0].searcher.scope;
        boundary.relaxed = true;
        let all = queue.len().max(1);
        let mut fraction = 0.0f64;
        let mut touched = FxHashSet::default();
        loop {
            let size = (queue.len() / PART).clamp(BLOCK[0], BLOCK[1]);
            block.clear();
            while block.len() < size {
                let Some(v) = queue.pop(control)? else { break };
                if scope.may_go(t, boundary, v) {
                    block.push(v);
                }
            }
            if block.is_empty() {
                return Ok(None);
            }
            if let Some(status) = limits.reached(|| t.bytes() + boundary.bytes()) {
                return Ok(Some(status));
            }
            touched.clear();
            for Look { position, found, .. } in look_at(block, workers, (t, boundary), control)? {
                let Some(found) = found else { continue };
                control.check()?;
                if let Some(status) = limits.reached(|| t.bytes() + boundary.bytes()) {
                    return Ok(Some(status));
                }
                if found.remove.iter().any(|v| touched.contains(v)) {
                    queue.push(block[position]);
                    continue;
                }
                if t.lacks_room_ahead() {
                    t.make_room_ahead(control)?;
                    self.hole.grow_for_additions(t, control)?;
                }
                if !self.make(t, boundary, &found, scope.demand(f64::INFINITY))? {
                    continue;
                }
                touched.extend(&found.remove);
                for &tet in &self.hole.created {
                    for w in t.topology.tet(tet).v {
                        touched.insert(w);
                        if scope.may_go(t, boundary, w) {
                            queue.push(w);
                        }
                    }
                }
            }
            block.clear();
            // After the block, so that a call that is cancelled here has done something.
            fraction = fraction.max(1.0 - queue.len() as f64 / all as f64);
            if !control.report("sparsify", fraction, t.vertex_count()) {
                return Err(Error::Cancelled);
            }
        }
    }
}

/// Looks at all vertices of a block; what has come of it is in order.
fn look_at(
    block: &[u32],
    workers: &mut [Worker],
    (t, boundary): (&Triangulation, &Boundary),
    control: &Control,
) -> Result<Vec<Look>, Error> {
    let threads = workers.len().min(block.len().div_ceil(SHARE));
    let workers = &mut workers[..threads];
    for worker in workers.iter_mut() {
        worker.searcher.grow_for(t, control)?;
    }
    let before = workers[0].searcher.pass_odds;
    let look = |worker: &mut Worker, position: usize| {
        let Worker { searcher, looks } = worker;
        let start = Odds { turns: before.turns + position, ..before };
        searcher.pass_odds = start;
        let demand = searcher.scope.demand(f64::INFINITY);
        let found = searcher.search(t, boundary, block[position], Partners::All, demand);
        let odds = searcher.pass_odds.since(start);
        if found.is_some() || odds.turns > 0 {
            looks.push(Look { position, found, odds });
        }
    };
    let all_done = share_numbers(workers, block.len(), look, || control.poll());
    let mut looks: Vec<Look> = workers.iter_mut().flat_map(|worker| worker.looks.drain(..)).collect();
    looks.sort_unstable_by_key(|look| look.position);
    workers[0].searcher.pass_odds = looks.iter().fold(before, |sum, look| sum.and(look.odds));
    if all_done {
        Ok(looks)
    } else {
        Err(Error::Cancelled)
    }
}

/// What a pass has still to do.
#[derive(Debug, Default)]
struct Work {
    queue: Queue,
    /// Those that are being looked at.
    block: Vec<u32>,
}

impl Work {
    /// All that waits.
    fn left(self) -> Vec<u32> {
        let mut left = self.queue.next;
        left.extend(self.queue.round);
        left.extend(self.block);
        left
    }
}

/// Vertices to be tried, each once at a time, in rounds: what comes during one waits for the next.
#[derive(Debug, Default)]
struct Queue {
    /// What is left of this round, the last ones first.
    round: Vec<u32>,
    next: Vec<u32>,
    is_waiting: Vec<bool>,
}

impl Queue {
    fn len(&self) -> usize {
        self.round.len() + self.next.len()
    }

    fn push(&mut self, v: u32) {
        if self.is_waiting.len() <= v as usize {
            self.is_waiting.resize(v as usize + 1, false);
        }
        if !std::mem::replace(&mut self.is_waiting[v as usize], true) {
            self.next.push(v);
        }
    }

    fn pop(&mut self, control: &Control) -> Result<Option<u32>, Error> {
        if self.round.is_empty() {
            // Vertices that are neighbours often have ids near each other: an odd multiple takes these apart, and is another for each.
            let scattered = |v: &u32| v.wrapping_mul(0x9E37_79B1);
            std::mem::swap(&mut self.round, &mut self.next);
            sort_by(&mut self.round, &control.watch(), |a, b| scattered(a).cmp(&scattered(b)))?;
        }
        let Some(v) = self.round.pop() else { return Ok(None) };
        self.is_waiting[v as usize] = false;
        Ok(Some(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_waits_once_and_a_round_is_scattered() {
        let (mut queue, control) = (Queue::default(), Control::new());
        for v in (0..100).chain(50..150) {
            queue.push(v);
        }
        let mut round = Vec::new();
        for _ in 0..150 {
            round.push(queue.pop(&control).unwrap().unwrap());
            // It may come back, but only when the others have had their turn.
            queue.push(7);
        }
        let near = round.windows(2).filter(|pair| pair[0].abs_diff(pair[1]) < 5).count();
        assert!(near < 10, "{near} of {round:?}");
        round.sort_unstable();
        assert!(round.into_iter().eq(0..150));
        assert_eq!([queue.pop(&control), queue.pop(&control)], [Ok(Some(7)), Ok(None)]);
        assert_eq!(queue.len(), 0);
    }
}
