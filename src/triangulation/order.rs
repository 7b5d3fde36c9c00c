//! The order of bulk insertion: a biased randomized insertion order (N. Amenta, S. Choi, G. Rote, "Incremental constructions con
//! BRIO", SoCG 2003) whose rounds follow a Hilbert curve, so that each point lies near the one before it.
//!
//! The rounds grow by 7.5, as Marot, Pellerin and Remacle found best. A point's round comes from a hash of its position in the
//! input, so the order is the same in every run.

use glam::DVec3;

/// Bits an axis of the Hilbert key; four bits remain for the round.
const BITS: u32 = 20;
const FIRST_ROUND: f64 = 2048.0;
const GROWTH: f64 = 7.5;

/// The positions of `points` in the order to insert them.
pub fn spatial_order(points: &[DVec3]) -> Vec<u32> {
    let (low, high) =
        points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let size = (high - low).max_element();
    // Twice halved, so that no size overflows.
    let scale = if size > 0.0 { f64::from((1u32 << BITS) - 1) / size } else { 0.0 };
    let limits = round_limits(points.len());
    let mut keys: Vec<(u64, u32)> = points
        .iter()
        .enumerate()
        .map(|(i, &p)| {
            let cell = ((p - low) * scale).to_array().map(|x| x as u32);
            let chance = (splitmix(i as u64) >> 11) as f64 / (1u64 << 53) as f64;
            let round = limits.iter().take_while(|&&limit| chance >= limit).count() as u64;
            (round << (3 * BITS) | hilbert_key(cell), i as u32)
        })
        .collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, i)| i).collect()
}

/// The cumulated shares of all rounds but the last.
fn round_limits(count: usize) -> Vec<f64> {
    let mut limits = Vec::new();
    let mut share = 1.0;
    while count as f64 * share > FIRST_ROUND && limits.len() < 15 {
        share /= GROWTH;
        limits.push(share);
    }
    limits.reverse();
    limits
}

/// S. Vigna's SplitMix64: a well mixed function of a counter.
fn splitmix(i: u64) -> u64 {
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

/// The place of a cell on the Hilbert curve of 2^[`BITS`] cells an axis.
fn hilbert_key([x, y, z]: [u32; 3]) -> u64 {
    let (mut key, mut state) = (0u64, 0u8);
    for bit in (0..BITS).rev() {
        let octant = (x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2;
        let (rank, next) = CURVE[state as usize][octant as usize];
        key = key << 3 | u64::from(rank);
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
        let mut order = spatial_order(&points);
        assert_eq!(order.len(), points.len());
        order.sort_unstable();
        assert!(order.into_iter().eq(0..20_000));
        let limits = round_limits(20_000);
        assert_eq!(limits.len(), 2);
        assert!((limits[0] * 7.5 - limits[1]).abs() < 1e-15);
        assert!(spatial_order(&[]).is_empty());
        assert_eq!(spatial_order(&[DVec3::ONE; 3]), [0, 1, 2]);
    }
}
