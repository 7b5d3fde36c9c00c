//! The predicates in whole numbers: an exact stage for points whose coordinates are multiples of one power of two, 62 bits of it.
//!
//! Grids with a spacing that is no power of two are like that, and the five points of most calls: rounding leaves cospherical points of grids,
//! and of rotated parts, on or very near common spheres, where no filter decides, and expansion arithmetic is slow. Here the width
//! of every number is known beforehand, so that there are neither loops nor branches: with differences of 62 bits minors have 125 bits, volumes 189, squared lengths 126 and the in-sphere
//! determinant 317, all with their signs.

use glam::DVec3;

use super::predicates::{divisor, Sign};

/// Coordinates are less than so many units.
pub(super) const MAX_UNITS: f64 = (1u64 << 61) as f64;

/// The grid that the points are on.
#[derive(Clone, Copy, Debug)]
pub(super) struct FixedPoint {
    /// Units in 1; a power of two.
    per_one: f64,
}

type Vector = [i64; 3];

impl FixedPoint {
    /// The arithmetic for coordinates that are multiples of `unit`, a power of two, and at most `greatest` in magnitude; `None` where there is
    /// none.
    pub fn new(unit: f64, greatest: f64) -> Option<FixedPoint> {
        let per_one = 1.0 / unit;
        (per_one.is_normal() && greatest * per_one < MAX_UNITS).then_some(FixedPoint { per_one })
    }

    /// The arithmetic for these points alone. Most coordinates that are nothing special have 53 bits and differ by some powers of two, so that it is there for
    /// most points even where a few others are too near to a coordinate plane for an arithmetic for all.
    #[inline]
    pub fn of<const N: usize>(points: [DVec3; N]) -> Option<FixedPoint> {
        let (unit, greatest) = unit_and_greatest(points);
        FixedPoint::new(unit, greatest)
    }

    /// `p − origin` in units. Exact: multiplication by a power of two rounds nothing.
    #[inline]
    fn difference(self, p: DVec3, origin: DVec3) -> Vector {
        let component = |x: f64, y: f64| (x * self.per_one) as i64 - (y * self.per_one) as i64;
        [component(p.x, origin.x), component(p.y, origin.y), component(p.z, origin.z)]
    }

    /// As [`Filter::orient3d`](super::Filter::orient3d).
    pub fn orient3d(self, [a, b, c]: [DVec3; 3], d: DVec3) -> Sign {
        let [u, v, w] = [a, b, c].map(|p| self.difference(p, d));
        let det = Wide::volume(u, v, w);
        // Negated: `d` is the origin here, and the last point of the tetrahedron.
        Sign::of(-det.sign())
    }

    /// As [`Filter::insphere`](super::Filter::insphere).
    pub fn insphere(self, corners: [DVec3; 4], p: DVec3) -> Sign {
        let [a, b, c, d] = corners.map(|q| self.difference(q, p));
        let mut sum = Sum::default();
        sum.add(Wide::volume(b, c, d), square(a));
        sum.subtract(Wide::volume(a, c, d), square(b));
        sum.add(Wide::volume(a, b, d), square(c));
        sum.subtract(Wide::volume(a, b, c), square(d));
        sum.sign()
    }
}

/// The largest power of two that divides the coordinates of these points, and their greatest magnitude.
#[inline]
pub(super) fn unit_and_greatest<const N: usize>(points: [DVec3; N]) -> (f64, f64) {
    let (mut unit, mut greatest) = (f64::INFINITY, 0.0f64);
    for p in points {
        unit = unit.min(divisor(p.x)).min(divisor(p.y)).min(divisor(p.z));
        greatest = greatest.max(p.abs().max_element());
    }
    (unit, greatest)
}

#[inline]
fn product(x: i64, y: i64) -> i128 {
    i128::from(x) * i128::from(y)
}

/// The squared length: less than 2¹²⁶.
#[inline]
fn square([x, y, z]: Vector) -> u128 {
    (product(x, x) + product(y, y) + product(z, z)) as u128
}

/// `high · 2⁶⁴ + low`.
#[derive(Clone, Copy)]
struct Wide {
    high: i128,
    low: u64,
}

impl Wide {
    /// Of magnitudes below 2¹²⁵ and 2⁶².
    #[inline]
    fn product(x: i128, y: i64) -> Wide {
        let low = i128::from(x as u64) * i128::from(y);
        Wide { high: product((x >> 64) as i64, y) + (low >> 64), low: low as u64 }
    }

    #[inline]
    fn plus(self, other: Wide) -> Wide {
        let (low, carry) = self.low.overflowing_add(other.low);
        Wide { high: self.high + other.high + i128::from(carry), low }
    }

    /// `det[u, v, w]`.
    #[inline]
    fn volume(u: Vector, v: Vector, w: Vector) -> Wide {
        let minor = |i: usize, j: usize| product(v[i], w[j]) - product(v[j], w[i]);
        Wide::product(minor(1, 2), u[0]).plus(Wide::product(minor(2, 0), u[1])).plus(Wide::product(minor(0, 1), u[2]))
    }

    #[inline]
    fn sign(self) -> f64 {
        // The low part only adds to it.
        if self.high != 0 {
            self.high.signum() as f64
        } else {
            f64::from(u8::from(self.low != 0))
        }
    }
}

/// A number of five words in two's complement, the lowest first.
#[derive(Clone, Copy, Debug, Default)]
struct Sum([u64; 5]);

impl Sum {
    /// Adds `x · y`.
    #[inline]
    fn add(&mut self, x: Wide, y: u128) {
        let is_negative = x.high < 0;
        // The magnitude, so that the words multiply as they are.
        let magnitude = if is_negative {
            let (low, borrow) = 0u64.overflowing_sub(x.low);
            Wide { high: -x.high - i128::from(borrow), low }
        } else {
            x
        };
        let words = [magnitude.low, magnitude.high as u64, (magnitude.high >> 64) as u64];
        let mut result = [0u64; 5];
        for (shift, y) in [y as u64, (y >> 64) as u64].into_iter().enumerate() {
            let mut carry = 0u64;
            for (i, word) in words.into_iter().enumerate() {
                let sum = u128::from(word) * u128::from(y) + u128::from(result[i + shift]) + u128::from(carry);
                result[i + shift] = sum as u64;
                carry = (sum >> 64) as u64;
            }
            result[3 + shift] = carry;
        }
        // To subtract is to add the complement and one.
        let flip = if is_negative { u64::MAX } else { 0 };
        let mut carry = u64::from(is_negative);
        for (to, word) in self.0.iter_mut().zip(result) {
            let sum = u128::from(*to) + u128::from(word ^ flip) + u128::from(carry);
            *to = sum as u64;
            carry = (sum >> 64) as u64;
        }
    }

    #[inline]
    fn subtract(&mut self, x: Wide, y: u128) {
        let (low, borrow) = 0u64.overflowing_sub(x.low);
        self.add(Wide { high: -x.high - i128::from(borrow), low }, y);
    }

    #[inline]
    fn sign(self) -> Sign {
        if self.0 == [0; 5] {
            Sign::Zero
        } else if self.0[4] >> 63 == 1 {
            Sign::Negative
        } else {
            Sign::Positive
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::super::circumsphere::circumcenter;
    use super::super::exact::{self, Dyadic, Scalar};
    use super::super::predicates;
    use super::*;

    /// The signs of `orient3d` and `insphere`.
    pub fn in_rationals(corners: [DVec3; 4], p: DVec3) -> [Sign; 2] {
        let [a, b, c, d] = corners.map(|q| exact::Vector::<Dyadic>::difference(q, p));
        let volume = |u: &exact::Vector<Dyadic>, v: &exact::Vector<Dyadic>, w| u.dot(&v.cross(w));
        let zero = Dyadic::new(0.0);
        let sphere = volume(&b, &c, &d)
            .mul(&a.length_squared())
            .sub(&volume(&a, &c, &d).mul(&b.length_squared()))
            .add(&volume(&a, &b, &d).mul(&c.length_squared()))
            .sub(&volume(&a, &b, &c).mul(&d.length_squared()));
        let orientation = zero.sub(&volume(&a, &b, &c));
        [orientation, sphere].map(|x| x.sign().unwrap())
    }

    fn agree(corners: [DVec3; 4], p: DVec3) {
        let mut filter = super::super::Filter::for_points(&corners);
        filter.extend(p);
        let (low, high) = filter.bounding_box();
        let fixed = FixedPoint::new(filter.unit(), low.abs().max(high.abs()).max_element()).unwrap();
        let [a, b, c, d] = corners;
        let expected = in_rationals(corners, p);
        assert_eq!([fixed.orient3d([a, b, c], p), fixed.insphere(corners, p)], expected);
        assert_eq!([filter.orient3d(a, b, c, p), filter.insphere(a, b, c, d, p)], expected);
        let robust = [predicates::orient3d(a, b, c, p), predicates::insphere(a, b, c, d, p)];
        assert_eq!(robust, expected);
    }

    fn tenths() -> impl Strategy<Value = DVec3> {
        [0..4i32, 0..4, 0..4].prop_map(|p| DVec3::from_array(p.map(|x| f64::from(x) * 0.1)))
    }

    fn wide() -> impl Strategy<Value = DVec3> {
        let whole = -(1i64 << 61) + 1..1i64 << 61;
        // As many bits as a double has, at any place.
        [whole.clone(), whole.clone(), whole]
            .prop_map(|p| DVec3::from_array(p.map(|x| (x >> 8 << 8) as f64 * 0.5f64.powi(70))))
    }

    proptest! {
        #[test]
        fn on_a_grid_of_tenths(corners in [tenths(), tenths(), tenths(), tenths()], p in tenths()) {
            agree(corners, p);
        }

        #[test]
        fn over_the_whole_width(corners in [wide(), wide(), wide(), wide()], p in wide()) {
            agree(corners, p);
        }

        #[test]
        fn corners_of_boxes(p in wide(), q in wide(), picks in [0..8usize, 0..8, 0..8, 0..8, 0..8]) {
            let corner = |i: usize| DVec3::new([p.x, q.x][i & 1], [p.y, q.y][i >> 1 & 1], [p.z, q.z][i >> 2]);
            let [a, b, c, d, e] = picks.map(corner);
            agree([a, b, c, d], e);
        }
    }

    proptest! {
        /// Of points so different that there is no arithmetic for all, five whose coordinates are near each other have one of their own.
        #[test]
        fn of_the_points_at_hand(corners in [near(), near(), near(), near()], p in near(), on_sphere in any::<bool>()) {
            let mut filter = super::super::Filter::for_points(&corners);
            filter.extend(p);
            filter.extend(DVec3::splat(1e-30));
            let (low, high) = filter.bounding_box();
            prop_assert!(FixedPoint::new(filter.unit(), low.abs().max(high.abs()).max_element()).is_none());
            prop_assert!(FixedPoint::of([corners[0], corners[1], corners[2], corners[3], p]).is_some());
            // The last point nearly on the sphere of the others, or as it is.
            let mut points = [corners[0], corners[1], corners[2], corners[3], p];
            if on_sphere {
                let center = circumcenter(corners[0], corners[1], corners[2], corners[3]);
                let direction = (p - center).normalize_or(DVec3::X);
                let there = center + direction * corners[0].distance(center);
                if there.is_finite() && there.abs().min_element() > 0.25 && there.abs().max_element() < 4.0 {
                    points[4] = there;
                }
            }
            let [a, b, c, d, p] = points;
            prop_assert_eq!([filter.orient3d(a, b, c, p), filter.insphere(a, b, c, d, p)], in_rationals([a, b, c, d], p));
        }
    }

    fn near() -> impl Strategy<Value = DVec3> {
        [0.25..4.0, 0.25..4.0, 0.25..4.0].prop_map(DVec3::from_array)
    }

    #[test]
    fn the_widest_numbers_fit() {
        let m = (1i64 << 61) as f64 - 256.0;
        let corner =
            |i: u32| DVec3::new([m, -m][(i & 1) as usize], [m, -m][(i >> 1 & 1) as usize], [m, -m][(i >> 2) as usize]);
        for picks in 0..1u32 << 15 {
            let [a, b, c, d, e] = [0, 3, 6, 9, 12].map(|shift| corner(picks >> shift & 7));
            if picks % 7 == 0 {
                agree([a, b, c, d], e);
            }
        }
        agree([corner(0), corner(3), corner(5), corner(6)], corner(7) * (1.0 - f64::EPSILON));
    }

    #[test]
    fn what_is_too_wide_is_refused() {
        assert!(FixedPoint::new(1.0, MAX_UNITS).is_none());
        assert!(FixedPoint::new(1.0, MAX_UNITS / 2.0).is_some());
        assert!(FixedPoint::new(2f64.powi(-194), 1.0).is_none());
        assert!(FixedPoint::new(0.0, 1.0).is_none());
    }
}
