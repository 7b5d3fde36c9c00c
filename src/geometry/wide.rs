//! The predicates in whole numbers, as [`fixed`](super::fixed) has them, for points whose coordinates take up to 125 bits.
//!
//! Of a mechanical part that somebody has turned, one coordinate often is what rounding has left of zero, 10⁻¹⁷ beside 1: more than 62 bits can tell.
//! Its points are on common circles and spheres as on no other input, and expansion arithmetic, which is made for numbers of any length, takes
//! eight times as long to see that. With differences below 2¹²⁶ minors are below 2²⁵³, volumes below 2³⁸¹, squared lengths below 2²⁵⁴ and the in-sphere determinant is below
//! 2⁶³⁷; each sign takes one bit more.

use glam::DVec3;

use super::fixed::unit_and_greatest;
use super::predicates::Sign;

/// Coordinates are less than so many units.
const MAX_UNITS: f64 = (1u128 << 125) as f64;

/// The grid that the points are on.
#[derive(Clone, Copy, Debug)]
pub(super) struct WidePoint {
    /// Units in 1; a power of two.
    per_one: f64,
}

type Vector = [Whole<2>; 3];

impl WidePoint {
    /// The arithmetic for these points; `None` where their coordinates are too different.
    pub fn of<const N: usize>(points: [DVec3; N]) -> Option<WidePoint> {
        let (unit, greatest) = unit_and_greatest(points);
        let per_one = 1.0 / unit;
        (per_one.is_normal() && greatest * per_one < MAX_UNITS).then_some(WidePoint { per_one })
    }

    /// `p − origin` in units. Exact: multiplication by a power of two rounds nothing.
    fn difference(self, p: DVec3, origin: DVec3) -> Vector {
        let component = |x: f64, y: f64| Whole::of((x * self.per_one) as i128 - (y * self.per_one) as i128);
        [component(p.x, origin.x), component(p.y, origin.y), component(p.z, origin.z)]
    }

    /// As [`Filter::orient3d`](super::Filter::orient3d).
    pub fn orient3d(self, [a, b, c]: [DVec3; 3], d: DVec3) -> Sign {
        let [u, v, w] = [a, b, c].map(|p| self.difference(p, d));
        // `d` is the origin here, and the last point of the tetrahedron.
        -volume(u, v, w).sign()
    }

    /// As [`Filter::insphere`](super::Filter::insphere).
    pub fn insphere(self, corners: [DVec3; 4], p: DVec3) -> Sign {
        let [a, b, c, d] = corners.map(|q| self.difference(q, p));
        let part = |u, v, w, other| -> Whole<10> { volume(u, v, w).times(square(other)) };
        let (even, odd) = (part(b, c, d, a).plus(part(a, b, d, c)), part(a, c, d, b).plus(part(a, b, c, d)));
        even.minus(odd).sign()
    }
}

fn square([x, y, z]: Vector) -> Whole<4> {
    x.times(x).plus(y.times(y)).plus(z.times(z))
}

/// `det[u, v, w]`.
fn volume(u: Vector, v: Vector, w: Vector) -> Whole<6> {
    let minor = |i: usize, j: usize| -> Whole<4> { v[i].times(w[j]).minus(v[j].times(w[i])) };
    minor(1, 2).times(u[0]).plus(minor(2, 0).times(u[1])).plus(minor(0, 1).times(u[2]))
}

/// A number of so many words in two's complement, the lowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Whole<const N: usize>([u64; N]);

impl Whole<2> {
    fn of(x: i128) -> Self {
        Whole([x as u64, (x >> 64) as u64])
    }
}

impl<const N: usize> Whole<N> {
    fn is_negative(self) -> bool {
        self.0[N - 1] >> 63 == 1
    }

    fn plus(self, other: Self) -> Self {
        self.sum(other.0, false)
    }

    fn minus(self, other: Self) -> Self {
        // To subtract is to add the complement and one.
        self.sum(other.0.map(|word| !word), true)
    }

    fn sum(mut self, words: [u64; N], mut carry: bool) -> Self {
        for (to, word) in self.0.iter_mut().zip(words) {
            let (sum, first) = to.overflowing_add(word);
            let (sum, second) = sum.overflowing_add(u64::from(carry));
            (*to, carry) = (sum, first | second);
        }
        self
    }

    fn magnitude(self) -> Self {
        if self.is_negative() {
            Whole([0; N]).minus(self)
        } else {
            self
        }
    }

    /// The product, which has as many words as both together.
    fn times<const M: usize, const R: usize>(self, other: Whole<M>) -> Whole<R> {
        const { assert!(N + M == R) };
        let (x, y) = (self.magnitude(), other.magnitude());
        let mut result = Whole([0; R]);
        for (shift, &y) in y.0.iter().enumerate() {
            let mut carry = 0;
            for (i, &x) in x.0.iter().enumerate() {
                let to = &mut result.0[i + shift];
                let sum = u128::from(x) * u128::from(y) + u128::from(*to) + u128::from(carry);
                (*to, carry) = (sum as u64, (sum >> 64) as u64);
            }
            result.0[N + shift] = carry;
        }
        if self.is_negative() == other.is_negative() {
            result
        } else {
            Whole([0; R]).minus(result)
        }
    }

    fn sign(self) -> Sign {
        if self == Whole([0; N]) {
            Sign::Zero
        } else if self.is_negative() {
            Sign::Negative
        } else {
            Sign::Positive
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::fixed::tests::in_rationals;
    use super::*;

    fn agree(corners: [DVec3; 4], p: DVec3) {
        let [a, b, c, d] = corners;
        let wide = WidePoint::of([a, b, c, d, p]).unwrap();
        let expected = in_rationals(corners, p);
        assert_eq!([wide.orient3d([a, b, c], p), wide.insphere(corners, p)], expected);
        let mut filter = super::super::Filter::for_points(&corners);
        filter.extend(p);
        assert_eq!([filter.orient3d(a, b, c, p), filter.insphere(a, b, c, d, p)], expected);
    }

    /// A point of a circle about an axis, as a part that was turned has them: its last coordinate is what is left of zero.
    fn on_circle() -> impl Strategy<Value = DVec3> {
        let turned = |angle: i32, height: i32, rest: f64| {
            let (sin, cos) = (f64::from(angle) * std::f64::consts::TAU / 24.0).sin_cos();
            DVec3::new(cos, sin, f64::from(height) + rest)
        };
        (0..24i32, 0..2i32, prop::sample::select(vec![0.0, 6.123e-17, -1.837e-16, 1e-21])).prop_map(
            move |(angle, height, rest)| {
                let p = turned(angle, 0, 0.0);
                if height == 0 {
                    p.with_z(rest)
                } else {
                    p
                }
            },
        )
    }

    fn any_size() -> impl Strategy<Value = DVec3> {
        let one = (-1.0..1.0, 0..70i32).prop_map(|(x, exponent)| x * 0.5f64.powi(exponent));
        [one.clone(), one.clone(), one].prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn on_a_turned_circle(corners in [on_circle(), on_circle(), on_circle(), on_circle()], p in on_circle()) {
            agree(corners, p);
        }

        #[test]
        fn whatever_fits(corners in [any_size(), any_size(), any_size(), any_size()], p in any_size()) {
            let [a, b, c, d] = corners;
            prop_assume!(WidePoint::of([a, b, c, d, p]).is_some());
            agree(corners, p);
        }
    }

    #[test]
    fn the_widest_numbers_fit() {
        let m = MAX_UNITS - 2f64.powi(72);
        let corner =
            |i: u32| DVec3::new([m, -m][(i & 1) as usize], [m, -m][(i >> 1 & 1) as usize], [m, -m][(i >> 2) as usize]);
        let wide = WidePoint { per_one: 1.0 };
        for picks in (0..1u32 << 15).step_by(7) {
            let [a, b, c, d, e] = [0, 3, 6, 9, 12].map(|shift| corner(picks >> shift & 7));
            let expected = in_rationals([a, b, c, d], e);
            assert_eq!([wide.orient3d([a, b, c], e), wide.insphere([a, b, c, d], e)], expected);
        }
    }

    #[test]
    fn what_is_too_wide_is_refused() {
        let at = |x: f64| [DVec3::splat(1.0), DVec3::splat(x)];
        assert!(WidePoint::of(at(2f64.powi(-124))).is_some());
        assert!(WidePoint::of(at(2f64.powi(-125))).is_none());
    }
}
