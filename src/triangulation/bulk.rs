//! Insertion of many points in a [spatial order](super::order): the first rounds by one thread, then in
//! [territories](super::partition) on as many threads as the caller allows.

use glam::DVec3;

use super::cavity::Cavity;
use super::order::{Round, SpatialOrder};
use super::partition::{sample, AnyTerritory, Division, Partition, Planes, MAX_DEPTH};
use super::pass::{Pass, BLOCK, POLL_INTERVAL};
use super::site::Site;
use super::territory::Territory;
use super::topology::NONE;
use super::Triangulation;
use crate::geometry::lanes::Portable;
use crate::leavings::{Each, InPieces};
use crate::threads::share_out;
use crate::{memory, Control, Error, LogLevel};

/// Vertices of before are nobody's if they are not more than one in so many.
const FEW_OTHERS: usize = 64;
/// Zones are divided no further than by this depth.
const ZONE_DEPTH: u32 = 2;
/// So many points are put in order at once.
const PART: usize = 1 << 15;
/// How many points of a block are tried as a start.
const STARTS: usize = 8;

/// Threads, and memory for each.
struct Helpers<'a> {
    threads: usize,
    cavities: InPieces<'a, Each<Cavity>>,
}

/// How far a bulk insertion has come.
struct Progress<'a> {
    control: &'a Control,
    /// Points to insert.
    total: usize,
    /// Points done.
    done: usize,
    /// Vertices before.
    present: usize,
    /// Vertices that are not needed, and those that were there before.
    duplicates: Vec<(u32, u32)>,
}

impl Progress<'_> {
    /// Reports, with so many more points done; `false` to stop.
    fn report(&self, more: usize) -> bool {
        let done = self.done + more;
        let vertices = self.present + done.saturating_sub(self.duplicates.len());
        self.control.report("delaunay", done as f64 / self.total as f64, vertices)
    }
}

impl Triangulation {
    /// The bulk insertion, in dimension 3. The points are stored in the order of insertion, which keeps neighbours close in memory, and are
    /// renumbered in the end.
    pub(super) fn insert_sorted(&mut self, points: &[DVec3], control: &Control) -> Result<Option<Vec<u32>>, Error> {
        let threads = self.threads().min(1 << MAX_DEPTH);
        let (base, present) = (self.points.len(), self.vertex_count());
        control.log(LogLevel::Info, || format!("delaunay: {} points, {threads} threads", points.len()));
        if !control.report("delaunay", 0.0, present) {
            return Ok(None);
        }
        let SpatialOrder { order, rounds, ends } = SpatialOrder::new(points, threads, control)?;
        let (order, mut rounds) = (InPieces::new(order, control), InPieces::new(Each(rounds), control));
        memory::grow(&mut self.points, points.len(), "points", control)?;
        // Seven for each point, and what divided places leave unused.
        memory::grow(&mut self.topology.tets, points.len() / 2 * 15, "tetrahedra", control)?;
        debug_assert_eq!(order.len(), points.len());
        for part in points.chunks(PART) {
            control.check()?;
            self.filter.extend_all(part);
        }
        let room = &mut self.points.spare_capacity_mut()[..points.len()];
        let watch = control.watch();
        share_out(threads, room.chunks_mut(PART).zip(order.chunks(PART)), |(room, order)| {
            if !watch.poll() {
                return;
            }
            for (place, &i) in room.iter_mut().zip(order) {
                place.write(points[i as usize] + DVec3::ZERO);
            }
        });
        watch.end()?;
        // SAFETY: so many have been written: there is one place in the order for each point.
        unsafe { self.points.set_len(base + points.len()) };
        let mut progress = Progress { control, total: points.len(), done: 0, present, duplicates: Vec::new() };
        let mut helpers = Helpers { threads, cavities: InPieces::new(Each::default(), control) };
        for round in &mut rounds.0 {
            round.zone.iter_mut().chain(&mut round.rest).for_each(|v| *v += base as u32);
        }
        for i in 0..rounds.0.len() {
            let (before, round) = (&rounds.0[..i], &rounds.0[i]);
            // Labels of regions would have to be shared, too; there is no bulk insertion once there are some.
            let goes_on = if round.depth == 0 || !self.topology.region.is_empty() {
                self.insert_all_of(round.vertices().map(|v| (v, NONE)), &mut progress)?
            } else {
                let ends = ends.chunks(ends.len() >> round.depth).filter_map(|ends| ends.last());
                let firsts = [0].iter().chain(ends).map(|&i| (base + i) as u32).collect();
                self.insert_divided(base, (before, round), firsts, &mut helpers, &mut progress)?
            };
            if !goes_on {
                return Ok(None);
            }
        }
        drop((rounds, helpers));
        // Vertices to positions in the order.
        let duplicates: Vec<(usize, u32)> =
            progress.duplicates.iter().map(|&(v, at)| (v as usize - base, at)).collect();
        let ids = self.number_in_input_order(base, points, &order, (&duplicates, threads), control)?;
        control.report("delaunay", 1.0, self.vertex_count());
        Ok(Some(ids))
    }

    /// Inserts vertices whose points are stored, one after the other, each with a tetrahedron near it, or one that was there once, or [`NONE`];
    /// `false` when cancelled.
    fn insert_all_of(
        &mut self,
        vertices: impl Iterator<Item = (u32, u32)>,
        progress: &mut Progress,
    ) -> Result<bool, Error> {
        let mut cavity = std::mem::take(&mut self.scratch);
        let result = self.insert_each(vertices, &mut cavity, progress);
        self.scratch = cavity;
        result
    }

    fn insert_each(
        &mut self,
        vertices: impl Iterator<Item = (u32, u32)>,
        cavity: &mut Cavity,
        progress: &mut Progress,
    ) -> Result<bool, Error> {
        cavity.reserve(self.topology.tets.capacity(), self.points.len(), progress.control)?;
        for (turn, (vertex, hint)) in vertices.enumerate() {
            // A cancellation from another thread is seen at once.
            let goes_on = if turn % POLL_INTERVAL == 0 { progress.report(0) } else { progress.control.poll() };
            if !goes_on {
                return Ok(false);
            }
            self.tetrahedra_ahead(cavity, progress.control)?;
            progress.done += 1;
            let point = self.at(vertex);
            let start = if self.is_live(hint) { hint } else { self.last };
            let t = self.walk_within(&self.filter, point, start, progress.control)?;
            if let Some(at) = self.vertex_at(t, point) {
                self.last = t;
                progress.duplicates.push((vertex, at));
                continue;
            }
            self.find_cavity(&self.filter, point, t, cavity, progress.control)?;
            self.commit(vertex, cavity, false, progress.control)?;
        }
        Ok(true)
    }

    /// Inserts the vertices of a round: those in its zone first, which is divided another way, then all others; in the end
    /// those that reached beyond their territories, one by one. `firsts` are the territories' first ids. `false` when cancelled.
    fn insert_divided(
        &mut self,
        base: usize,
        (before, round): (&[Round], &Round),
        firsts: Vec<u32>,
        helpers: &mut Helpers,
        progress: &mut Progress,
    ) -> Result<bool, Error> {
        let present = || (0..base as u32).chain(before.iter().flat_map(Round::vertices));
        let control = progress.control;
        let divide = |this: &Self, vertices: &[u32], depth, planes| {
            let sample = sample(vertices.len(), depth).map(|i| this.at(vertices[i])).collect();
            let division = Division::new(sample, vertices.len(), depth, planes);
            division.share(&this.points, vertices, present(), control)
        };
        let (zone, inner) = if base <= round.rest.len() / FEW_OTHERS {
            // Vertices of before are nobody's.
            let copied = |list: &[u32]| memory::copied(list, "order", control);
            (copied(&round.zone)?, Partition::of_ids(copied(&round.rest)?, firsts))
        } else {
            // They have ids of any order. The two lists of the round are in order.
            let all = merged([&round.zone, &round.rest], control)?;
            divide(self, &all, round.depth, Planes::AlongAxes)?
        };
        let (zone, outer) = divide(self, &zone, round.depth.min(ZONE_DEPTH), Planes::Oblique)?;
        if !self.insert_all_of(zone.into_iter().map(|v| (v, NONE)), progress)? {
            return Ok(false);
        }
        let mut put_off = Vec::new();
        for partition in [outer, inner] {
            self.insert_pass(&partition, helpers, progress, &mut put_off)?;
        }
        self.insert_all_of(put_off.into_iter(), progress)
    }

    /// One pass over the territories, unless the control says stop. What has to be put off is added to the list.
    fn insert_pass(
        &mut self,
        partition: &Partition,
        helpers: &mut Helpers,
        progress: &mut Progress,
        put_off: &mut Vec<(u32, u32)>,
    ) -> Result<(), Error> {
        let territories = partition.count();
        let starts = (0..territories).map(|i| self.starts_in(partition, i, progress.control));
        let starts: Vec<Vec<u32>> = starts.collect::<Result<_, Error>>()?;
        let (room, vertices, control) = (self.topology.tets.capacity(), self.points.len(), progress.control);
        let cavities = &mut helpers.cavities.0;
        cavities.resize_with(helpers.threads.min(territories), Cavity::default);
        // Without memory for all there are fewer threads.
        let mut ready = 0;
        for cavity in cavities.iter_mut() {
            match cavity.reserve(room, vertices, control) {
                Ok(()) => ready += 1,
                Err(Error::OutOfMemory { .. }) if ready > 0 => break,
                Err(error) => return Err(error),
            }
        }
        // Should a callback panic, no half-made tetrahedra remain.
        let mut tets = std::mem::take(&mut self.topology.tets);
        let used = tets.len();
        let site = Site::new(&mut tets, &self.points);
        let pass = Pass { site, filter: &self.filter, partition, starts: &starts, used, control: progress.control };
        // SAFETY: this is the triangulation, and nobody else has it; the starts were found for their territories, and there is room in
        // the cavities.
        let outcomes = unsafe { pass.run(&mut cavities[..ready], |more| progress.report(more)) };
        let settled = outcomes.ok_or(Error::Cancelled).and_then(|outcomes| {
            // SAFETY: the outcomes of this pass.
            let settled = unsafe { pass.settle(&outcomes) };
            settled.map(|(end, free)| (outcomes, end, free))
        });
        let (outcomes, end, mut free) = match settled {
            Ok(settled) => settled,
            Err(error) => {
                // All of it is forgotten now; the memory may serve again.
                tets.clear();
                self.topology.tets = tets;
                return Err(error);
            }
        };
        // SAFETY: settled: all places up to the end have been written.
        unsafe { tets.set_len(end) };
        self.topology.tets = tets;
        self.topology.free.append(&mut free);
        let mut done = partition.pending.len();
        for outcome in outcomes {
            self.topology.ghosts = self.topology.ghosts.wrapping_add_signed(outcome.ghosts);
            if outcome.last != NONE {
                self.last = outcome.last;
            }
            done -= outcome.put_off.len();
            put_off.extend(outcome.put_off);
            progress.duplicates.extend(outcome.duplicates);
        }
        progress.done += done;
        Ok(())
    }

    fn is_live(&self, t: u32) -> bool {
        self.topology.tets.get(t as usize).is_some_and(|tet| tet.is_live())
    }

    /// Tetrahedra near every [`BLOCK`]th point of a territory that have two vertices in it; [`NONE`] where there is none.
    fn starts_in(&mut self, partition: &Partition, territory: usize, control: &Control) -> Result<Vec<u32>, Error> {
        let own = |v: [u32; 4]| {
            // SAFETY: vertices of a live tetrahedron.
            let bits = unsafe {
                match partition.territory(territory) {
                    AnyTerritory::Ids(own) => own.of::<Portable>(&v),
                    AnyTerritory::Own(own) => own.of::<Portable>(&v),
                }
            };
            bits.count_ones() >= 2
        };
        let start_of = |block: &[u32]| {
            control.check()?;
            for &v in block.iter().step_by(BLOCK / STARTS) {
                self.last = self.walk_within(&self.filter, self.at(v), self.last, control)?;
                if own(self.topology.tet(self.last).v) {
                    return Ok(self.last);
                }
            }
            Ok(NONE)
        };
        partition.pending_in(territory).chunks(BLOCK).map(start_of).collect()
    }

    /// Numbers the vertices from `base` on by their first occurrence in the input. `order` is the input's order of insertion;
    /// `duplicates` are places in it, with the vertex that was there before. Returns the vertex of each input point.
    fn number_in_input_order(
        &mut self,
        base: usize,
        points: &[DVec3],
        order: &[u32],
        (duplicates, threads): (&[(usize, u32)], usize),
        control: &Control,
    ) -> Result<Vec<u32>, Error> {
        let mut new_id = memory::room_in_pieces::<u32>(base + points.len(), "ids", control)?;
        let mut ids = memory::room_in_pieces::<u32>(points.len(), "ids", control)?;
        for (list, numbers) in [(&mut new_id, 0..base), (&mut ids, base..base + points.len())] {
            for start in numbers.clone().step_by(PART) {
                control.check()?;
                list.extend(start as u32..numbers.end.min(start + PART) as u32);
            }
        }
        self.points.truncate(base);
        if duplicates.is_empty() {
            for (order, points) in order.chunks(PART).zip(points.chunks(PART)) {
                control.check()?;
                new_id.extend(order.iter().map(|&i| base as u32 + i));
                self.points.extend(points.iter().map(|&p| p + DVec3::ZERO));
            }
        } else {
            memory::lengthen(&mut new_id, base + points.len(), NONE, "ids", control)?;
            for (part, order) in order.chunks(PART).enumerate() {
                control.check()?;
                for (done, &i) in (part * PART..).zip(order) {
                    ids[i as usize] = (base + done) as u32;
                }
            }
            for part in duplicates.chunks(PART) {
                control.check()?;
                for &(done, at) in part {
                    ids[order[done] as usize] = at;
                }
            }
            for (ids, points) in ids.chunks_mut(PART).zip(points.chunks(PART)) {
                control.check()?;
                for (id, &point) in ids.iter_mut().zip(points) {
                    let entry = &mut new_id[*id as usize];
                    if *entry == NONE {
                        *entry = self.points.len() as u32;
                        self.points.push(point + DVec3::ZERO);
                    }
                    *id = *entry;
                }
            }
        }
        self.topology.renumber(&new_id, self.points.len(), threads, control)?;
        Ok(ids.keep())
    }
}

/// Two ordered lists of numbers as one.
fn merged<'a>(lists: [&[u32]; 2], control: &'a Control) -> Result<InPieces<'a, Vec<u32>>, Error> {
    let [mut a, mut b] = lists;
    let mut all = memory::room_in_pieces(a.len() + b.len(), "order", control)?;
    while let (Some(&x), Some(&y)) = (a.first(), b.first()) {
        if all.len() % PART == 0 {
            control.check()?;
        }
        let from = if x < y { &mut a } else { &mut b };
        all.push(x.min(y));
        *from = &from[1..];
    }
    all.extend_from_slice(a);
    all.extend_from_slice(b);
    Ok(all)
}

#[cfg(test)]
mod tests;
