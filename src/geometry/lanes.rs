//! Four doubles at a time, so that one predicate is evaluated for four simplices at once.
//!
//! Code that is generic over [`Lanes`] is compiled twice: with AVX2 and FMA, chosen at run time, and with plain arrays for every other
//! machine. The two may round differently. The filters hold for both, so the signs are the same: a fused
//! multiplication and addition only leaves out a rounding that the error bounds allow for.

use glam::DVec3;

/// Four doubles.
pub trait Lanes: Copy {
    /// The same number in each lane.
    fn splat(x: f64) -> Self;
    /// The coordinates of four points, x, y, z.
    fn load(points: [&DVec3; 4]) -> [Self; 3];
    /// The sum.
    fn add(self, other: Self) -> Self;
    /// The difference.
    fn sub(self, other: Self) -> Self;
    /// The product.
    fn mul(self, other: Self) -> Self;
    /// The quotient.
    fn div(self, other: Self) -> Self;
    /// `self · a + b`, rounded once or twice.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// `self · a − b`, rounded once or twice.
    fn mul_sub(self, a: Self, b: Self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The greater of two numbers, neither of them NaN.
    fn max(self, other: Self) -> Self;
    /// The lesser of two numbers, neither of them NaN.
    fn min(self, other: Self) -> Self;
    /// The numbers, lane 0 first.
    fn to_array(self) -> [f64; 4];
    /// Lanes 1, 2, 3, 0; then 2, 3, 0, 1; then 3, 0, 1, 2.
    fn rotations(self) -> [Self; 3];
    /// Lanes 1 and 3 with the opposite sign.
    fn alternate(self) -> Self;
    /// A bit for each lane, the lowest for lane 0: whether it is greater than that of `other`.
    fn greater(self, other: Self) -> u32;
    /// Those of `values` whose bit is set, in order, and anything behind them.
    fn compress(values: &[u32; 4], bits: u32) -> [u32; 4];
    /// A bit for each of `values`: whether it is one of `count` numbers from `first` on.
    fn within(values: &[u32; 4], first: u32, count: u32) -> u32;
}

/// Per bit set its elements' positions, then zeros.
pub const POSITIONS: [[u32; 4]; 16] = {
    let mut table = [[0; 4]; 16];
    let mut bits = 0;
    while bits < 16 {
        let (mut lane, mut count) = (0, 0);
        while lane < 4 {
            if bits >> lane & 1 == 1 {
                table[bits][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// For every machine.
#[derive(Clone, Copy)]
pub struct Portable([f64; 4]);

impl Portable {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let ([a, b, c, d], [e, f_, g, h]) = (self.0, other.0);
        Portable([f(a, e), f(b, f_), f(c, g), f(d, h)])
    }
}

impl Lanes for Portable {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Portable([x; 4])
    }
    #[inline(always)]
    fn load(points: [&DVec3; 4]) -> [Self; 3] {
        [Portable(points.map(|p| p.x)), Portable(points.map(|p| p.y)), Portable(points.map(|p| p.z))]
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |x, y| x + y)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |x, y| x - y)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |x, y| x * y)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(other, |x, y| x / y)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self.mul(a).add(b)
    }
    #[inline(always)]
    fn mul_sub(self, a: Self, b: Self) -> Self {
        self.mul(a).sub(b)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Portable(self.0.map(f64::abs))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(other, f64::max)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.with(other, f64::min)
    }
    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        self.0
    }
    #[inline(always)]
    fn rotations(self) -> [Self; 3] {
        let [a, b, c, d] = self.0;
        [Portable([b, c, d, a]), Portable([c, d, a, b]), Portable([d, a, b, c])]
    }
    #[inline(always)]
    fn alternate(self) -> Self {
        let [a, b, c, d] = self.0;
        Portable([a, -b, c, -d])
    }
    #[inline(always)]
    fn greater(self, other: Self) -> u32 {
        (0..4).map(|i| u32::from(self.0[i] > other.0[i]) << i).sum()
    }
    #[inline(always)]
    fn compress(values: &[u32; 4], bits: u32) -> [u32; 4] {
        POSITIONS[bits as usize & 15].map(|i| values[i as usize & 3])
    }
    #[inline(always)]
    fn within(values: &[u32; 4], first: u32, count: u32) -> u32 {
        (0..4).map(|i| u32::from(values[i].wrapping_sub(first) < count) << i).sum()
    }
}

#[cfg(target_arch = "x86_64")]
pub use x86::Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{DVec3, Lanes, POSITIONS};

    /// For x86-64 with AVX2 and FMA. To be used only where [`Avx2::available`] said yes, and in functions compiled for both, so
    /// that the intrinsics become single instructions.
    #[derive(Clone, Copy)]
    pub struct Avx2(__m256d);

    impl Avx2 {
        /// Whether this processor has what it takes. The answer is remembered.
        #[inline]
        pub fn available() -> bool {
            is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
        }
    }

    /// Lanes 2, 3, 0, 1. What crosses the middle takes long, and should be done once: of shuffles that are made of this one, the compiler would
    /// make three that cross it.
    #[inline]
    #[target_feature(enable = "avx2")]
    unsafe fn exchange_halves(x: __m256d) -> __m256d {
        let half: __m256d;
        // SAFETY: registers only.
        unsafe {
            std::arch::asm!(
                "vperm2f128 {half}, {all}, {all}, 1",
                half = lateout(ymm_reg) half,
                all = in(ymm_reg) x,
                options(pure, nomem, nostack, preserves_flags)
            );
        }
        half
    }

    // SAFETY of all intrinsics below: values of this type are made only where AVX2 and FMA are at hand.
    impl Lanes for Avx2 {
        #[inline(always)]
        fn splat(x: f64) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_set1_pd(x) })
        }
        #[inline(always)]
        fn load([a, b, c, d]: [&DVec3; 4]) -> [Self; 3] {
            // SAFETY: see above; a point's x and y are adjacent doubles.
            unsafe {
                let xy = |p: &DVec3| _mm_loadu_pd((&raw const *p).cast());
                let ac = _mm256_insertf128_pd::<1>(_mm256_castpd128_pd256(xy(a)), xy(c));
                let bd = _mm256_insertf128_pd::<1>(_mm256_castpd128_pd256(xy(b)), xy(d));
                let z = _mm256_set_pd(d.z, c.z, b.z, a.z);
                [Avx2(_mm256_unpacklo_pd(ac, bd)), Avx2(_mm256_unpackhi_pd(ac, bd)), Avx2(z)]
            }
        }
        #[inline(always)]
        fn add(self, other: Self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_add_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_sub_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_mul_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn div(self, other: Self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_div_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn mul_add(self, a: Self, b: Self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_fmadd_pd(self.0, a.0, b.0) })
        }
        #[inline(always)]
        fn mul_sub(self, a: Self, b: Self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_fmsub_pd(self.0, a.0, b.0) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_max_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_min_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn to_array(self) -> [f64; 4] {
            // SAFETY: see above; four doubles of 8 bytes.
            unsafe { std::mem::transmute(self.0) }
        }
        #[inline(always)]
        fn rotations(self) -> [Self; 3] {
            // SAFETY: see above.
            unsafe {
                let half = exchange_halves(self.0);
                let (first, last) =
                    (_mm256_shuffle_pd::<0b0101>(self.0, half), _mm256_shuffle_pd::<0b0101>(half, self.0));
                [Avx2(first), Avx2(half), Avx2(last)]
            }
        }
        #[inline(always)]
        fn alternate(self) -> Self {
            // SAFETY: see above.
            Avx2(unsafe { _mm256_xor_pd(self.0, _mm256_setr_pd(0.0, -0.0, 0.0, -0.0)) })
        }
        #[inline(always)]
        fn greater(self, other: Self) -> u32 {
            // SAFETY: see above.
            unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(self.0, other.0)) as u32 }
        }
        #[inline(always)]
        fn compress(values: &[u32; 4], bits: u32) -> [u32; 4] {
            // SAFETY: see above; arrays of 16 bytes.
            unsafe {
                let values = _mm_loadu_ps(values.as_ptr().cast());
                let positions = _mm_loadu_si128(POSITIONS[bits as usize & 15].as_ptr().cast());
                std::mem::transmute(_mm_permutevar_ps(values, positions))
            }
        }
        #[inline(always)]
        fn within(values: &[u32; 4], first: u32, count: u32) -> u32 {
            // SAFETY: see above; an array of 16 bytes.
            unsafe {
                let from_first = _mm_sub_epi32(_mm_loadu_si128(values.as_ptr().cast()), _mm_set1_epi32(first as i32));
                // There is no comparison of unsigned numbers: those that are not less than `count` are the greater of the two.
                let beyond = _mm_cmpeq_epi32(_mm_max_epu32(from_first, _mm_set1_epi32(count as i32)), from_first);
                !_mm_movemask_ps(_mm_castsi128_ps(beyond)) as u32 & 0b1111
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation, on lanes that differ, as bits or numbers that can be compared between machines.
    fn everything<L: Lanes>() -> (Vec<u32>, Vec<[u32; 4]>) {
        let points = [0.0, 1.0, 2.0, 3.0].map(|i| DVec3::new(i, 10.0 - 3.0 * i, i * i));
        let [x, y, z] = L::load([&points[0], &points[1], &points[2], &points[3]]);
        let [first, second, third] = x.rotations();
        let results = [
            x,
            y,
            z,
            x.add(y),
            x.sub(y),
            x.mul(y),
            x.mul(y).div(y),
            x.mul_add(y, z),
            x.mul_sub(y, z),
            x.sub(y).abs(),
            x.max(y),
            x.min(y),
            first,
            second,
            third,
            x.alternate(),
        ];
        assert_eq!(y.to_array(), [10.0, 7.0, 4.0, 1.0]);
        // The numbers are small integers: find each by comparisons.
        let mut bits = Vec::new();
        for value in results {
            bits.extend((-31..31).map(|i| value.greater(L::splat(f64::from(i) + 0.5))));
        }
        let compressed = (0..16)
            .map(|bits| {
                let mut out = L::compress(&[4, 5, 6, 7], bits);
                out[bits.count_ones() as usize..].fill(0);
                out
            })
            .collect();
        for (first, count) in [(0, 0), (5, 1), (5, 3), (4, 4), (0, u32::MAX), (u32::MAX, 1), (7, 0), (u32::MAX - 1, 8)]
        {
            bits.push(L::within(&[4, 5, u32::MAX, 7], first, count));
        }
        (bits, compressed)
    }

    #[test]
    fn the_portable_lanes_do_as_they_say() {
        let (bits, compressed) = everything::<Portable>();
        // Lane i of the values in order of `everything`.
        let expected: [[i32; 4]; 16] = [
            [0, 1, 2, 3],
            [10, 7, 4, 1],
            [0, 1, 4, 9],
            [10, 8, 6, 4],
            [-10, -6, -2, 2],
            [0, 7, 8, 3],
            [0, 1, 2, 3],
            [0, 8, 12, 12],
            [0, 6, 4, -6],
            [10, 6, 2, 2],
            [10, 7, 4, 3],
            [0, 1, 2, 1],
            [1, 2, 3, 0],
            [2, 3, 0, 1],
            [3, 0, 1, 2],
            [0, -1, 2, -3],
        ];
        for (value, bits) in expected.iter().zip(bits.chunks(62)) {
            for (i, &mask) in (-31..31).zip(bits) {
                let greater: u32 = (0..4).map(|lane| u32::from(value[lane] > i) << lane).sum();
                assert_eq!(mask, greater, "{value:?} > {i}.5");
            }
        }
        assert_eq!(bits[16 * 62..], [0, 0b10, 0b1010, 0b1011, 0b1011, 0b100, 0, 0b0111]);
        assert_eq!(compressed[0b1010], [5, 7, 0, 0]);
        assert_eq!(compressed[0b1111], [4, 5, 6, 7]);
        assert_eq!(compressed[0], [0; 4]);
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn the_fast_lanes_do_as_the_portable_ones() {
        if Avx2::available() {
            assert_eq!(everything::<Avx2>(), everything::<Portable>());
        }
    }
}
