//! The order of bulk insertion: a biased randomized insertion order (N. Amenta, S. Choi, G. Rote, "Incremental constructions con
//! BRIO", SoCG 2003) whose rounds follow a Hilbert curve, so that each point lies near the one before it.
//!
//! The rounds grow by 7.5, as Marot, Pellerin and Remacle found best. A point's round comes from a hash of its position in the
//! input, so the order is the same in every run. In memory the points of all rounds lie along one curve, or, where there are
//! enough for several threads, along one curve in each of the [territories](super::partition).
//!
//! The points are thrown into buckets by the leading bits of their places on the curve first, then each bucket is sorted by itself.

use glam::DVec3;

use super::partition::{depth, sample, Division, Planes};
use crate::leavings::{Each, InPieces, Leavings};
use crate::sorting::sort;
use crate::threads::share_out;
use crate::{memory, Control, Error};

/// Bits an axis of the Hilbert key.
const BITS: u32 = 18;
const KEY_BITS: u32 = 3 * BITS;
/// Behind it in the sorted keys: the round, and whether the point is in a zone. Before it: the territory.
const ROUND_BITS: u32 = 3;
const REST_BITS: u32 = ROUND_BITS + 1;
const FIRST_ROUND: f64 = 2048.0;
const GROWTH: f64 = 7.5;
/// Points a bucket, about; and no more leading bits of a territory's curve, and of all together, than these.
const BUCKET: usize = 1024;
const MAX_CURVE_BITS: u32 = 12;
const MAX_BUCKET_BITS: u32 = 14;
/// Points between two looks at the control.
const POLL_INTERVAL: usize = 1 << 12;
/// Points that a thread takes at once, at least, and into how many parts it is that they are divided at most.
const PART: usize = 1 << 15;
const MAX_PARTS: usize = 32;

/// How points are stored and inserted.
#[derive(Debug)]
pub(super) struct SpatialOrder {
    /// Their positions in the input, along the curve.
    pub order: Vec<u32>,
    /// What is inserted when.
    pub rounds: Vec<Round>,
    /// Where each of the last round's territories ends in `order`.
    pub ends: Vec<usize>,
}

/// The points of a round: positions in [`SpatialOrder::order`], increasing.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Round {
    /// Those near the planes between territories.
    pub zone: Vec<u32>,
    /// All others.
    pub rest: Vec<u32>,
    /// How deep the tree is that the round is divided by; territories of the last round in one of this go together.
    pub depth: u32,
}

impl Leavings for Round {
    fn give_back(&mut self) -> bool {
        self.zone.give_back() || self.rest.give_back()
    }
}

impl Round {
    /// All of them, in the order of insertion.
    pub fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        self.zone.iter().chain(&self.rest).copied()
    }
}

/// The positions of `points` in the order to insert them, unless memory is lacking or the control says stop.
pub fn spatial_order(points: &[DVec3], control: &Control) -> Result<Vec<u32>, Error> {
    let SpatialOrder { order, rounds, .. } = SpatialOrder::new(points, 1, control)?;
    let turns = control.turns();
    let mut all = memory::room_in_pieces(points.len(), "order", control)?;
    for i in rounds.iter().flat_map(Round::vertices) {
        turns.check()?;
        all.push(order[i as usize]);
    }
    Ok(all.keep())
}

impl SpatialOrder {
    /// The order to insert `points` in; the threads only make it faster. [`Error::Cancelled`] when the control says stop.
    pub fn new(points: &[DVec3], threads: usize, control: &Control) -> Result<SpatialOrder, Error> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for part in points.chunks(PART) {
            control.check()?;
            (low, high) = part.iter().fold((low, high), |(low, high), &p| (low.min(p), high.max(p)));
        }
        let limits = round_limits(points.len());
        // How many points a round has, for each of them, and its division.
        let mut shares = limits.clone();
        shares.push(1.0);
        (1..shares.len()).rev().for_each(|i| shares[i] -= shares[i - 1]);
        let counts = shares.iter().map(|share| (share * points.len() as f64) as usize);
        let max_depth = counts.clone().map(depth).max().unwrap_or(0);
        let sample: Vec<DVec3> = match max_depth {
            0 => Vec::new(),
            depth => sample(points.len(), depth).map(|i| points[i]).collect(),
        };
        let divide = |count| match depth(count) {
            0 => Division::none(),
            depth => Division::new(sample.clone(), count, depth, Planes::AlongAxes),
        };
        let divisions: Vec<Division> = counts.map(divide).collect();
        let last = &divisions[divisions.len() - 1];
        // A curve of its own for each territory: one through all would come back to it for every sliver of a cell.
        let curve = |(low, high): (DVec3, DVec3)| {
            let size = (high - low).max_element();
            (low, if size > 0.0 { f64::from((1u32 << BITS) - 1) / size } else { 0.0 })
        };
        let curves: Vec<(DVec3, f64)> = last.boxes(low, high).into_iter().map(curve).collect();

        let mut keys = memory::zeroed::<(u64, u32)>(points.len(), "keys", control)?;
        let curve_bits = (points.len() / BUCKET).next_power_of_two().trailing_zeros();
        let bits = last.depth() + curve_bits.min(MAX_CURVE_BITS).min(MAX_BUCKET_BITS - last.depth());
        let buckets = 1 << bits;
        let shift = last.depth() + KEY_BITS + REST_BITS - bits;
        let bucket = |key: u64| (key >> shift) as usize;
        // How many of each part of the points come to each bucket.
        let part_size = points.len().div_ceil(MAX_PARTS).max(PART);
        let mut counts = vec![0u32; buckets * points.len().div_ceil(part_size)];
        let watch = control.watch();
        let parts =
            keys.chunks_mut(part_size).zip(points.chunks(part_size)).zip(counts.chunks_mut(buckets)).enumerate();
        share_out(threads, parts, |(part, ((keys, points), counts))| {
            for ((key, &point), i) in keys.iter_mut().zip(points).zip(part * part_size..) {
                if i % POLL_INTERVAL == 0 && !watch.poll() {
                    return;
                }
                let chance = (splitmix(i as u64) >> 11) as f64 / (1u64 << 53) as f64;
                let round: usize = limits.iter().map(|&limit| usize::from(chance >= limit)).sum();
                let (territory, mut in_zone) = last.place(point);
                let (low, scale) = curves[usize::from(territory)];
                let cell = ((point - low) * scale).to_array().map(|x| x as u32);
                if round + 1 < divisions.len() {
                    in_zone = divisions[round].place(point).1;
                }
                let place = u64::from(territory) << KEY_BITS | hilbert_key(cell);
                *key = (place << REST_BITS | (round as u64) << 1 | u64::from(in_zone), i as u32);
                counts[bucket(key.0)] += 1;
            }
        });
        watch.end()?;

        // Each part has its own room in each bucket.
        let mut sorted = memory::zeroed::<(u64, u32)>(points.len(), "keys", control)?;
        let mut rooms: Vec<Vec<&mut [(u64, u32)]>> =
            counts.chunks(buckets).map(|_| Vec::with_capacity(buckets)).collect();
        let mut rest = &mut sorted[..];
        let mut ends = vec![0; buckets];
        let mut end = 0;
        for (bucket, bucket_end) in ends.iter_mut().enumerate() {
            for (rooms, counts) in rooms.iter_mut().zip(counts.chunks(buckets)) {
                let count = counts[bucket] as usize;
                let (room, others) = rest.split_at_mut(count);
                rooms.push(room);
                rest = others;
                end += count;
            }
            *bucket_end = end;
        }
        share_out(threads, keys.chunks(part_size).zip(rooms), |(keys, mut rooms)| {
            for (i, &key) in keys.iter().enumerate() {
                if i % POLL_INTERVAL == 0 && !watch.poll() {
                    return;
                }
                let room = &mut rooms[bucket(key.0)];
                if let Some((first, rest)) = std::mem::take(room).split_first_mut() {
                    *first = key;
                    *room = rest;
                }
            }
        });
        watch.end()?;
        drop(keys);

        let mut order = memory::zeroed::<u32>(points.len(), "order", control)?;
        let parts = Buckets { sorted: &mut sorted, order: &mut order, ends: &ends, done: 0 };
        share_out(threads, parts, |(sorted, order)| {
            if sort(sorted, &watch).is_ok() {
                order.iter_mut().zip(sorted).for_each(|(i, key)| *i = key.1);
            }
        });
        watch.end()?;
        let rounds = divisions.iter().map(|division| Round { depth: division.depth(), ..Round::default() }).collect();
        let mut rounds = InPieces::new(Each(rounds), control);
        // Most are the last round's.
        if let Some(last) = rounds.0.last_mut() {
            memory::reserve(&mut last.rest, points.len(), "order")?;
        }
        for (i, &(key, _)) in sorted.iter().enumerate() {
            if i % PART == 0 {
                control.check()?;
            }
            let round = &mut rounds.0[(key >> 1 & ((1 << ROUND_BITS) - 1)) as usize];
            if key & 1 == 1 { &mut round.zone } else { &mut round.rest }.push(i as u32);
        }
        let end = |territory: u64| sorted.partition_point(|&(key, _)| key >> (KEY_BITS + REST_BITS) <= territory);
        let ends = (0..1 << last.depth()).map(end).collect();
        Ok(SpatialOrder { order: order.keep(), rounds: rounds.keep().0, ends })
    }
}

/// The buckets, one by one.
struct Buckets<'a> {
    sorted: &'a mut [(u64, u32)],
    order: &'a mut [u32],
    ends: &'a [usize],
    done: usize,
}

impl<'a> Iterator for Buckets<'a> {
    type Item = (&'a mut [(u64, u32)], &'a mut [u32]);

    fn next(&mut self) -> Option<Self::Item> {
        let (&end, ends) = self.ends.split_first()?;
        let (sorted, rest) = std::mem::take(&mut self.sorted).split_at_mut(end - self.done);
        let (order, other) = std::mem::take(&mut self.order).split_at_mut(end - self.done);
        (self.sorted, self.order, self.ends, self.done) = (rest, other, ends, end);
        Some((sorted, order))
    }
}

/// The cumulated shares of all rounds but the last.
fn round_limits(count: usize) -> Vec<f64> {
    let mut limits = Vec::new();
    let mut share = 1.0;
    while count as f64 * share > FIRST_ROUND && limits.len() + 1 < 1 << ROUND_BITS {
        share /= GROWTH;
        limits.push(share);
    }
    limits.reverse();
    limits
}

/// S. Vigna's SplitMix64: a well mixed function of a counter.
pub(super) fn splitmix(i: u64) -> u64 {
    let mut z = i.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

/// Per state and octant, the octant's rank on the curve and the state within it, as in C. H. Hamilton, "Compact
/// Hilbert indices", Dalhousie CS-2006-07. A state is `entry corner · 3 + direction`.
const CURVE: [[(u8, u8); 8]; 24] = {
    const fn rotate_right(x: u32, n: u32) -> u32 {
        (x >> n | x << (3 - n)) & 7
    }
    const fn gray_inverse(x: u32) -> u32 {
        x ^ x >> 1 ^ x >> 2
    }
    const fn gray(x: u32) -> u32 {
        x ^ x >> 1
    }
    const fn entry(w: u32) -> u32 {
        if w == 0 {
            0
        } else {
            gray((w - 1) / 2 * 2)
        }
    }
    const fn direction(w: u32) -> u32 {
        if w == 0 {
            0
        } else if w % 2 == 0 {
            (w - 1).trailing_ones() % 3
        } else {
            w.trailing_ones() % 3
        }
    }
    let mut table = [[(0, 0); 8]; 24];
    let mut state = 0;
    while state < 24 {
        let (e, d) = (state / 3, state % 3);
        let mut octant = 0;
        while octant < 8 {
            let w = gray_inverse(rotate_right(octant ^ e, (d + 1) % 3));
            let next_e = e ^ rotate_right(entry(w), (2 * 3 - d - 1) % 3);
            let next_d = (d + direction(w) + 1) % 3;
            table[state as usize][octant as usize] = (w as u8, (next_e * 3 + next_d) as u8);
            octant += 1;
        }
        state += 1;
    }
    table
};

/// [`CURVE`] for two levels at once.
const CURVE_TWICE: [[(u8, u8); 64]; 24] = {
    let mut table = [[(0, 0); 64]; 24];
    let mut state = 0;
    while state < 24 {
        let mut octants = 0;
        while octants < 64 {
            let (rank, next) = CURVE[state][octants >> 3];
            let (lower, last) = CURVE[next as usize][octants & 7];
            table[state][octants] = (rank << 3 | lower, last);
            octants += 1;
        }
        state += 1;
    }
    table
};

/// The lowest [`BITS`] bits of a number, two places between each and the next.
#[inline]
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x) & ((1 << BITS) - 1);
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// The place of a cell on the Hilbert curve of 2^[`BITS`] cells an axis.
#[inline]
fn hilbert_key([x, y, z]: [u32; 3]) -> u64 {
    let octants = spread(x) | spread(y) << 1 | spread(z) << 2;
    let (mut key, mut state) = (0u64, 0u8);
    for level in (0..KEY_BITS).step_by(6).rev() {
        let (rank, next) = CURVE_TWICE[state as usize][(octants >> level & 63) as usize];
        key = key << 6 | u64::from(rank);
        state = next;
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_space() {
        // The 8³ cells of the curve's last three levels, in the order of their keys.
        let mut cells: Vec<(u64, [u32; 3])> =
            (0..512u32).map(|i| [i & 7, i >> 3 & 7, i >> 6]).map(|c| (hilbert_key(c), c)).collect();
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let steps: u32 = (0..3).map(|i| pair[0].1[i].abs_diff(pair[1].1[i])).sum();
            assert_eq!(steps, 1, "{pair:?}");
            assert_eq!(pair[0].0 + 1, pair[1].0);
        }
    }

    #[test]
    fn the_order_is_a_permutation_with_growing_rounds() {
        let points: Vec<DVec3> = (0..20_000).map(|i| DVec3::new((i % 37) as f64, (i % 101) as f64, i as f64)).collect();
        let mut order = spatial_order(&points, &Control::new()).unwrap();
        assert_eq!(order.len(), points.len());
        order.sort_unstable();
        assert!(order.into_iter().eq(0..20_000));
        let limits = round_limits(20_000);
        assert_eq!(limits.len(), 2);
        assert!((limits[0] * 7.5 - limits[1]).abs() < 1e-15);
        assert!(spatial_order(&[], &Control::new()).unwrap().is_empty());
        let SpatialOrder { order, rounds, .. } = SpatialOrder::new(&points, 1, &Control::new()).unwrap();
        assert_eq!(rounds.len(), 3);
        assert!(rounds.iter().all(|round| round.zone.is_empty() && round.rest.is_sorted()));
        assert!(rounds.windows(2).all(|pair| pair[0].rest.len() < pair[1].rest.len()));
        assert_eq!(rounds.iter().map(|round| round.rest.len()).sum::<usize>(), 20_000);
        let cell = |i: u32| (points[i as usize] * (f64::from((1 << BITS) - 1) / 19_999.0)).to_array().map(|x| x as u32);
        assert!(order.is_sorted_by_key(|&i| hilbert_key(cell(i))));
        let many: Vec<DVec3> = (0..100_000u64)
            .map(|i| DVec3::new((splitmix(i) % 1000) as f64, (splitmix(i + 7) % 99) as f64, i as f64))
            .collect();
        let [one, three] = [1, 3].map(|threads| SpatialOrder::new(&many, threads, &Control::new()).unwrap());
        assert_eq!((&one.order, &one.rounds, &one.ends), (&three.order, &three.rounds, &three.ends));
        // Divided into two, which are stored one behind the other, each along the curve.
        let last = &one.rounds[2];
        assert_eq!((last.depth, one.ends.len()), (1, 2));
        assert!(one.ends[0].abs_diff(50_000) < 5_000 && one.ends[1] == 100_000);
        assert!(last.zone.len() > 500 && last.zone.len() < 20_000 && last.zone.is_sorted() && last.rest.is_sorted());
        let mut sorted = one.order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..100_000));

        assert_eq!(spatial_order(&[DVec3::ONE; 3], &Control::new()).unwrap(), [0, 1, 2]);
    }
}
