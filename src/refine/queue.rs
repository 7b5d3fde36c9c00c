//! The queue of bad tetrahedra, the one with the shortest shortest edge first.
//!
//! Most die long before their turn. So they wait in buckets of about equal length (3 % wide), unsorted, as little more than their places: what
//! they cost was mostly the memory that their lists went through. Only the bucket whose turn it is is sorted. By then 19 of 20 have gone, which their
//! [hashes](Waiting::of) tell; the rest is looked at anew. It belongs there if it is bad and of that length, even if it is not what was
//! queued but has come to the same place: then it has been queued there itself. What comes meanwhile and is no longer than that goes into a
//! heap. When that is no longer small, as where sizes are wanted that are below all edges there are, the bucket in turn is an earlier one from
//! then on. So the order is that of one large heap, which took two fifths of the time of a refinement.
//!
//! Among equals vertex ids decide, in order and not as they are stored, so that any triangulation whose vertices are numbered alike is
//! refined alike: `wellspaced/cgal.hpp` does the same.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::geometry::quality::EDGES;
use crate::leavings::{Each, Leavings};
use crate::sorting::sort;
use crate::triangulation::topology::tet_of;
use crate::triangulation::Triangulation;
use crate::{memory, Control, Error};

/// A tetrahedron whose turn is near. Entries are in order as their fields are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    /// Bits of the squared length of its shortest edge: for positive numbers they sort as the numbers do.
    shortest: u64,
    /// Its vertices when it was found bad, in order and two in a word each: those around one edge are compared very often.
    vertices: [u64; 2],
    /// How they were stored: the rank of each, two bits, the first one's foremost. What comes back otherwise is another tetrahedron, queued by itself.
    order: u8,
    /// Where it was stored then.
    t: u32,
}

impl Entry {
    fn new(t: &Triangulation, tet: u32, shortest: f64) -> Entry {
        let (vertices, order) = Entry::vertices(t.topology.tet(tet).v);
        Entry { shortest: shortest.to_bits(), vertices, order, t: tet }
    }

    fn vertices(v: [u32; 4]) -> ([u64; 2], u8) {
        let order = v.iter().fold(0, |order, x| order << 2 | v.iter().filter(|&y| y < x).count() as u8);
        let mut sorted = v;
        sorted.sort_unstable();
        let [a, b, c, d] = sorted.map(u64::from);
        ([a << 32 | b, c << 32 | d], order)
    }

    fn is_live(&self, t: &Triangulation) -> bool {
        t.topology.get(self.t).is_some_and(|tet| Entry::vertices(tet.v) == (self.vertices, self.order))
    }
}

/// Exponent and four bits of the mantissa.
fn bucket(shortest: u64) -> u32 {
    (shortest >> 48) as u32
}

/// A priority queue of tetrahedra.
#[derive(Clone, Debug, Default)]
pub struct Queue {
    /// The entries that were in bucket `current` when its turn came, the next one last.
    near: Vec<Reverse<Entry>>,
    current: u32,
    /// What has come since and belongs into that bucket or an earlier one.
    late: BinaryHeap<Reverse<Entry>>,
    /// What of that became too long for a heap, in lists like `near`: to move a long one takes long.
    crowds: Vec<Vec<Reverse<Entry>>>,
    /// The entries of later buckets.
    waiting: Buckets,
    count: usize,
    /// Scratch: the places of a bucket where what waits may still be, and what is there.
    places: Vec<u32>,
    judged: Vec<(u32, f64)>,
}

impl Leavings for Queue {
    fn give_back(&mut self) -> bool {
        if let Some((_, last)) = self.waiting.full.last_mut() {
            if !last.give_back() {
                self.waiting.full.pop();
            }
            return true;
        }
        let mut rest = Each(std::mem::take(&mut self.waiting.lists));
        let mut crowds = Each(std::mem::take(&mut self.crowds));
        let more = rest.give_back() || crowds.give_back();
        (self.waiting.lists, self.crowds) = (rest.0, crowds.0);
        more || self.near.give_back() || {
            let mut late = std::mem::take(&mut self.late).into_vec();
            let more = late.give_back();
            self.late = late.into();
            more
        }
    }
}

/// A place where there was a tetrahedron to be mended.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    t: u32,
    hash: u32,
}

impl Waiting {
    fn new(t: &Triangulation, tet: u32) -> Waiting {
        Waiting { t: tet, hash: Waiting::of(t.topology.tet(tet).v) }
    }

    /// What tells most tetrahedra from what comes to their places.
    #[inline]
    fn of([a, b, c, d]: [u32; 4]) -> u32 {
        let mix = |v: u32, factor: u32| v.wrapping_mul(factor);
        mix(a, 0x9e37_79b1) ^ mix(b, 0x85eb_ca77) ^ mix(c, 0xc2b2_ae3d) ^ mix(d, 0x27d4_eb2f)
    }

    fn may_live(&self, t: &Triangulation) -> bool {
        t.topology.get(self.t).is_some_and(|tet| Waiting::of(tet.v) == self.hash)
    }
}

/// What waits, by bucket.
#[derive(Clone, Debug, Default)]
struct Buckets {
    /// The bucket that stands first, a multiple of 64.
    first: u32,
    lists: Vec<Vec<Waiting>>,
    /// Lists that were full and [long](LONG), each with its bucket: to have them grow would take as long as they are, with nobody asked meanwhile.
    full: Vec<(u32, Vec<Waiting>)>,
    /// A bit for each: whether there is anything in it.
    filled: Vec<u64>,
    /// What the lists have taken, about.
    bytes: usize,
}

impl Buckets {
    #[inline(always)]
    fn push(&mut self, bucket: u32, entry: Waiting) -> Result<(), Error> {
        let place = bucket.wrapping_sub(self.first) as usize;
        if let Some(list) = self.lists.get_mut(place).filter(|list| !list.is_empty() && list.len() < list.capacity()) {
            list.push(entry);
            return Ok(());
        }
        self.push_with_room(bucket, entry)
    }

    /// [`push`](Self::push) where there may be no place, no room or nothing yet.
    #[cold]
    #[inline(never)]
    fn push_with_room(&mut self, bucket: u32, entry: Waiting) -> Result<(), Error> {
        let place = bucket.wrapping_sub(self.first) as usize;
        let place = if place < self.lists.len() { place } else { self.make_place(bucket) };
        let list = &mut self.lists[place];
        if list.len() == list.capacity() {
            let before = if list.len() < LONG {
                let before = list.capacity();
                memory::reserve(list, 1, "bad tetrahedra")?;
                before
            } else {
                memory::reserve(&mut self.full, 1, "bad tetrahedra")?;
                let next = memory::with_room(LONG, "bad tetrahedra")?;
                self.full.push((bucket, std::mem::replace(list, next)));
                0
            };
            self.bytes += (list.capacity() - before) * size_of::<Waiting>();
        }
        self.filled[place / 64] |= 1 << (place % 64);
        list.push(entry);
        Ok(())
    }

    /// Makes places up to that of `bucket`, which has none yet.
    #[cold]
    fn make_place(&mut self, bucket: u32) -> usize {
        if self.lists.is_empty() {
            self.first = bucket / 64 * 64;
        }
        if bucket < self.first {
            let more = (self.first - bucket).div_ceil(64);
            self.filled.splice(0..0, (0..more).map(|_| 0));
            self.lists.splice(0..0, (0..64 * more).map(|_| Vec::new()));
            self.first -= 64 * more;
        }
        let place = (bucket - self.first) as usize;
        if place >= self.lists.len() {
            self.filled.resize(place / 64 + 1, 0);
            self.lists.resize_with(64 * self.filled.len(), Vec::new);
        }
        place
    }

    /// The first that is not empty.
    fn first_filled(&self) -> Option<u32> {
        let (word, bits) = self.filled.iter().enumerate().find(|(_, &bits)| bits != 0)?;
        Some(self.first + 64 * word as u32 + bits.trailing_zeros())
    }

    /// What is in a bucket that is [filled](Self::first_filled), in no order.
    fn entries(&self, bucket: u32) -> impl Iterator<Item = &[Waiting]> {
        let full = self.full.iter().filter(move |(of, _)| *of == bucket).map(|(_, list)| &list[..]);
        full.chain([&self.lists[(bucket - self.first) as usize][..]])
    }

    /// Empties a bucket that is [filled](Self::first_filled), and says how many entries it had.
    fn clear(&mut self, bucket: u32, control: &Control) -> usize {
        let place = (bucket - self.first) as usize;
        self.filled[place / 64] &= !(1 << (place % 64));
        let (mut count, mut next) = (0, Some(std::mem::take(&mut self.lists[place])));
        while let Some(list) = next {
            count += list.len();
            self.bytes -= list.capacity() * size_of::<Waiting>();
            control.give_back(list);
            let full = self.full.iter().position(|(of, _)| *of == bucket);
            next = full.map(|i| self.full.swap_remove(i).1);
        }
        count
    }
}

/// Places that are judged between two looks at the control.
const PART: usize = 1 << 8;

/// A list of what waits that is full is not made longer from this length on.
const LONG: usize = if cfg!(test) { 16 } else { 1 << 16 };
/// The heap has fewer than that.
const CROWD: usize = if cfg!(test) { 24 } else { 1 << 16 };
/// The heap has at most so many entries of several buckets.
const LATE: usize = if cfg!(test) { 16 } else { 1 << 12 };
/// Entries that are made ready while one is mended.
const NEXT: usize = 4;
/// How much earlier than it is looked at a place is fetched.
const AHEAD: usize = 32;

/// The slots of a tetrahedron's shortest edge and its squared length. Among equals the one of the lowest vertices.
pub fn shortest_edge(t: &Triangulation, tet: u32) -> ([usize; 2], f64) {
    let (v, corners) = (t.topology.tet(tet).v, t.corners(tet));
    let mut best = ([0, 1], f64::INFINITY);
    for [i, j] in EDGES {
        let length = corners[i].distance_squared(corners[j]);
        let vertices = |[i, j]: [usize; 2]| (v[i].min(v[j]), v[i].max(v[j]));
        if length < best.1 || length == best.1 && vertices([i, j]) < vertices(best.0) {
            best = ([i, j], length);
        }
    }
    best
}

impl Queue {
    /// Queues a tetrahedron, whose shortest edge squared that is.
    #[inline(always)]
    pub fn push(&mut self, t: &Triangulation, tet: u32, shortest: f64) -> Result<(), Error> {
        self.count += 1;
        let bucket = bucket(shortest.to_bits());
        if bucket > self.current {
            return self.waiting.push(bucket, Waiting::new(t, tet));
        }
        self.push_late(t, tet, shortest)
    }

    #[inline(never)]
    fn push_late(&mut self, t: &Triangulation, tet: u32, shortest: f64) -> Result<(), Error> {
        if self.late.len() == self.late.capacity() {
            self.late.try_reserve(1).map_err(|_| Error::OutOfMemory { what: "bad tetrahedra" })?;
        }
        self.late.push(Reverse(Entry::new(t, tet, shortest)));
        if self.late.len() >= CROWD {
            memory::reserve(&mut self.crowds, 1, "bad tetrahedra")?;
            let mut crowd = std::mem::take(&mut self.late).into_vec();
            crowd.sort_unstable();
            self.crowds.push(crowd);
        }
        Ok(())
    }

    /// The bytes that it has taken, about.
    pub fn bytes(&self) -> usize {
        let crowds = self.crowds.iter().map(Vec::capacity).sum::<usize>();
        (self.near.capacity() + self.late.capacity() + crowds) * size_of::<Entry>() + self.waiting.bytes
    }

    /// The next tetrahedron; [`Error::Cancelled`], and nothing is lost, when the control says stop. `judge` is asked about places, whatever is there now: it leaves
    /// those of tetrahedra to be mended in the list, in any order, each with its shortest edge squared.
    pub fn pop(
        &mut self,
        t: &Triangulation,
        control: &Control,
        mut judge: impl FnMut(&[u32], &mut Vec<(u32, f64)>),
    ) -> Result<Option<u32>, Error> {
        let turns = control.turns();
        loop {
            turns.check()?;
            if self.late.len() > LATE || !self.crowds.is_empty() {
                self.turn_back(t, control)?;
            }
            let next = self.next();
            let Some(Reverse(entry)) = next else {
                let Some(first) = self.waiting.first_filled() else { return Ok(None) };
                self.turn_to(first, t, control, &mut judge)?;
                continue;
            };
            self.count -= 1;
            if entry.is_live(t) {
                self.fetch_next(t);
                return Ok(Some(entry.t));
            }
        }
    }

    /// Takes the first entry out.
    #[inline(always)]
    fn next(&mut self) -> Option<Reverse<Entry>> {
        if !self.crowds.is_empty() {
            return self.next_of_crowds();
        }
        let is_late = match (self.late.peek(), self.near.last()) {
            (Some(late), Some(near)) => late > near,
            (late, _) => late.is_some(),
        };
        if is_late {
            self.late.pop()
        } else {
            self.near.pop()
        }
    }

    #[cold]
    fn next_of_crowds(&mut self) -> Option<Reverse<Entry>> {
        let lists = std::iter::once(&mut self.near).chain(&mut self.crowds);
        let first = lists.max_by_key(|list| list.last().copied());
        if self.late.peek() > first.as_ref().and_then(|list| list.last()) {
            return self.late.pop();
        }
        let next = first.and_then(Vec::pop);
        self.crowds.retain(|crowd| !crowd.is_empty());
        next
    }

    /// Asks for what will be looked at first when the next ones come, while there is time.
    fn fetch_next(&self, t: &Triangulation) {
        let next = self.near.iter().rev().map(|Reverse(next)| next.t);
        if let Some(later) = next.clone().nth(NEXT) {
            t.topology.prefetch(later);
        }
        for soon in next.take(NEXT / 2).filter_map(|soon| t.topology.get(soon)) {
            soon.n.into_iter().for_each(|n| t.topology.prefetch(tet_of(n)));
        }
    }

    /// Makes the first bucket of the heap the current one, if it is an earlier one; what is longer waits again. When the control says stop, some of that is
    /// where it was.
    fn turn_back(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        let Queue { near, current, late, crowds, waiting, count, .. } = self;
        let earliest = crowds.iter().filter_map(|crowd| crowd.last()).chain(late.peek()).max();
        let Some(first) = earliest.map(|Reverse(first)| bucket(first.shortest)).filter(|first| first < current) else {
            return Ok(());
        };
        let turns = control.turns();
        let mut wait = |entry: Entry| {
            turns.check()?;
            // A place whose tetrahedron has gone may have another one by now, which is not to come again.
            if entry.is_live(t) {
                waiting.push(bucket(entry.shortest), Waiting::new(t, entry.t))
            } else {
                *count -= 1;
                Ok(())
            }
        };
        *current = first;
        while let Some(&Reverse(entry)) = near.last() {
            wait(entry)?;
            near.pop();
        }
        let (mut heap, mut result) = (std::mem::take(late).into_vec(), Ok(()));
        for entries in std::iter::once(&mut heap).chain(&mut *crowds) {
            entries.retain(|&Reverse(entry)| {
                if result.is_ok() && bucket(entry.shortest) > first {
                    result = wait(entry);
                    return result.is_err();
                }
                true
            });
        }
        *late = heap.into();
        crowds.retain(|crowd| !crowd.is_empty());
        result
    }

    /// Makes a waiting bucket the current one, of which nothing is left.
    fn turn_to(
        &mut self,
        first: u32,
        t: &Triangulation,
        control: &Control,
        judge: &mut impl FnMut(&[u32], &mut Vec<(u32, f64)>),
    ) -> Result<(), Error> {
        self.judge_waiting(first, t, control, judge)?;
        let entries = self.entries_of(first, t, control)?;
        self.count = self.count - self.waiting.clear(first, control) + entries.len();
        control.give_back(std::mem::replace(&mut self.near, entries));
        self.current = first;
        Ok(())
    }

    /// Entries for those judged that are in this bucket, the first one last.
    fn entries_of(&self, first: u32, t: &Triangulation, control: &Control) -> Result<Vec<Reverse<Entry>>, Error> {
        let mut entries = memory::room_in_pieces(self.judged.len(), "queue", control)?;
        let turns = control.turns();
        for &(tet, shortest) in &self.judged {
            turns.check()?;
            if bucket(shortest.to_bits()) == first {
                entries.push(Reverse(Entry::new(t, tet, shortest)));
            }
        }
        sort(&mut entries, &control.watch())?;
        Ok(entries.keep())
    }

    /// Finds those in a bucket that are still to be mended.
    fn judge_waiting(
        &mut self,
        bucket: u32,
        t: &Triangulation,
        control: &Control,
        judge: &mut impl FnMut(&[u32], &mut Vec<(u32, f64)>),
    ) -> Result<(), Error> {
        let turns = control.turns();
        self.places.clear();
        for list in self.waiting.entries(bucket) {
            memory::grow_long(&mut self.places, list.len(), "queue", control)?;
            for (i, entry) in list.iter().enumerate() {
                turns.check()?;
                if let Some(later) = list.get(i + AHEAD) {
                    t.topology.prefetch(later.t);
                }
                if entry.may_live(t) {
                    self.places.push(entry.t);
                }
            }
        }
        // One that has gone and come again has been queued twice.
        sort(&mut self.places, &control.watch())?;
        self.places.dedup();
        self.judged.clear();
        for part in self.places.chunks(PART) {
            control.check()?;
            memory::grow_long(&mut self.judged, PART, "queue", control)?;
            judge(part, &mut self.judged);
        }
        Ok(())
    }

    /// Places queued, those of dead tetrahedra included.
    pub fn len(&self) -> usize {
        self.count
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::geometry::quality::exceeds_radius_edge;
    use crate::triangulation::cavity::Cavity;
    use crate::DVec3;

    const BOUND: f64 = 1.2;

    fn judge(t: &Triangulation, places: &[u32], out: &mut Vec<(u32, f64)>) {
        let bad = |&&tet: &&u32| t.is_inside(tet) && exceeds_radius_edge(t.corners(tet), BOUND);
        out.extend(places.iter().filter(bad).map(|&tet| (tet, shortest_edge(t, tet).1)));
    }

    fn sorted(t: &Triangulation, tet: u32) -> [u32; 4] {
        let mut v = t.topology.tet(tet).v;
        v.sort_unstable();
        v
    }

    /// Places are used again and again here, by bad tetrahedra and good ones, and the order goes back and forth.
    #[test]
    fn the_next_one_is_that_of_all_bad_ones_not_yet_popped() {
        let mut state = 5u64;
        let mut next = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / (1 << 24) as f64
        };
        let (mut t, mut queue, mut cavity) = (Triangulation::new(), Queue::default(), Cavity::default());
        let corners: Vec<DVec3> =
            (0..8).map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64)).collect();
        t.insert_many(&corners, &crate::Control::new()).unwrap().unwrap();
        let (mut popped, mut count) = (HashSet::new(), 0);
        for turn in 0..600 {
            // Dense where it is coarse before: shortest edges of all lengths.
            let scale = 0.5f64.powi(turn % 7);
            let p = DVec3::new(next(), next(), next()) * scale * 0.9 + DVec3::splat(0.05);
            t.prepare(p, t.recent(), &mut cavity, &Control::new()).unwrap();
            t.insert_into(p, &mut cavity, &Control::new()).unwrap();
            let mut bad = Vec::new();
            judge(&t, &cavity.created, &mut bad);
            bad.into_iter().for_each(|(tet, shortest)| queue.push(&t, tet, shortest).unwrap());
            if turn % 5 < 3 {
                let all =
                    t.topology.live().filter(|&tet| t.is_inside(tet) && exceeds_radius_edge(t.corners(tet), BOUND));
                let key = |tet: u32| (shortest_edge(&t, tet).1.to_bits(), sorted(&t, tet));
                let expected = all.map(key).filter(|(_, v)| !popped.contains(v)).min();
                let found = queue.pop(&t, &Control::new(), |places, out| judge(&t, places, out)).unwrap().map(key);
                assert_eq!(found, expected, "turn {turn}");
                popped.extend(found.map(|(_, v)| v));
                count += usize::from(found.is_some());
            }
        }
        assert!(count > 200, "{count}");
        assert!(queue.len() > 0);
    }

    /// A transaction that is taken back as a whole puts a copy in place that was made before the triangulation grew; what it has queued stays.
    #[test]
    fn places_that_there_are_no_more_are_passed_over() {
        let corners: Vec<DVec3> =
            (0..8).map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64)).collect();
        let mut before = Triangulation::new();
        before.insert_many(&corners, &Control::new()).unwrap().unwrap();
        let mut after = before.clone();
        after.insert_many(&crate::samples::random_points(40, 3), &Control::new()).unwrap().unwrap();
        let places = |t: &Triangulation| t.topology.live().filter(|&tet| t.is_inside(tet)).collect::<Vec<_>>();
        let everything = |t: &Triangulation, places: &[u32], out: &mut Vec<(u32, f64)>| {
            out.extend(places.iter().map(|&tet| (tet, shortest_edge(t, tet).1)));
        };
        let mut queue = Queue::default();
        for &tet in &places(&after) {
            queue.push(&after, tet, shortest_edge(&after, tet).1).unwrap();
        }
        // One is popped, so that a bucket is in order, and its next ones are made ready; some more come late.
        let first = queue.pop(&after, &Control::new(), |places, out| everything(&after, places, out)).unwrap().unwrap();
        (0..2 * LATE).for_each(|_| queue.push(&after, first, shortest_edge(&after, first).1).unwrap());
        for &tet in &places(&before) {
            queue.push(&before, tet, shortest_edge(&before, tet).1).unwrap();
        }
        let mut found = Vec::new();
        while let Some(tet) =
            queue.pop(&before, &Control::new(), |places, out| everything(&before, places, out)).unwrap()
        {
            found.push(tet);
        }
        found.sort_unstable();
        found.dedup();
        let expected: Vec<u32> = places(&before);
        assert!(after.topology.tets.len() > 4 * before.topology.tets.len());
        assert_eq!(found, expected);
    }
}
