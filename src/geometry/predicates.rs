//! Exact orientation and in-sphere signs in three stages: a static filter from the bounding box of all
//! points, a semi-static one from the magnitudes of the call, and the adaptive exact predicates of
//! J. R. Shewchuk ("Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates", DCG 18, 1997) as the `robust` crate has them.
//!
//! Before the last stage stand two tests that make grids cheap: when all coordinates are multiples of
//! one power of two and the differences at hand are small multiples of it, the floating-point
//! determinant is exact as it stands, zero included; and when no coordinate is more than 61 bits of it, be it of all points or of
//! those at hand, the determinant is computed in whole numbers (`fixed`), and so it is when no coordinate of those at hand is more than 125 bits (`wide`).
//!
//! The error constants are Shewchuk's for the same evaluation order, with the permanent replaced by its upper bound.

use glam::DVec3;
use robust::Coord3D;

use super::fixed::FixedPoint;
use super::lanes::Lanes;
use super::wide::WidePoint;

/// The sign of an exactly evaluated determinant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i8)]
pub enum Sign {
    /// Below zero.
    Negative = -1,
    /// Exactly zero.
    Zero = 0,
    /// Above zero.
    Positive = 1,
}

impl Sign {
    /// The sign of a number that is not NaN.
    #[inline]
    pub fn of(value: f64) -> Sign {
        if value > 0.0 {
            Sign::Positive
        } else if value < 0.0 {
            Sign::Negative
        } else {
            Sign::Zero
        }
    }
}

impl std::ops::Neg for Sign {
    type Output = Sign;
    #[inline]
    fn neg(self) -> Sign {
        match self {
            Sign::Negative => Sign::Positive,
            Sign::Zero => Sign::Zero,
            Sign::Positive => Sign::Negative,
        }
    }
}

const U: f64 = f64::EPSILON / 2.0;
/// (7 + 56u)u times the 6 terms of the permanent, rounded up.
const ORIENT_ERROR: f64 = 43.0 * U;
/// (16 + 224u)u times the 24 terms of the permanent, rounded up.
const INSPHERE_ERROR: f64 = 388.0 * U;
/// Differences of at most this many grid units make the floating-point determinants exact: 6·b³ and 72·b⁵ stay
/// below 2⁵³.
const ORIENT_EXACT_UNITS: f64 = 65_536.0;
const INSPHERE_EXACT_UNITS: f64 = 512.0;

/// What the filters know of all points together: the box they lie in and the power of two that divides their
/// coordinates. It only ever grows coarser in the box and finer in the unit, so one that was made for more points
/// stays valid for fewer.
#[derive(Clone, Debug)]
pub struct Filter {
    low: DVec3,
    high: DVec3,
    orient_bound: f64,
    insphere_bound: f64,
    /// The largest power of two that divides every coordinate.
    unit: f64,
    /// Arithmetic in this unit, if the coordinates are not too long.
    fixed: Option<FixedPoint>,
}

impl Default for Filter {
    fn default() -> Self {
        Filter {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
            orient_bound: 0.0,
            insphere_bound: 0.0,
            unit: MAX_UNIT,
            fixed: None,
        }
    }
}

const MAX_UNIT: f64 = super::range::MAX_MAGNITUDE;

/// The largest power of two that divides `x`.
#[inline]
pub(super) fn divisor(x: f64) -> f64 {
    if x == 0.0 {
        return MAX_UNIT;
    }
    let bits = x.to_bits();
    // Coordinates are normal numbers: the hidden bit stands above the 52 of the mantissa.
    let trailing = (bits & ((1 << 52) - 1) | 1 << 52).trailing_zeros() as u64;
    let exponent = (bits >> 52 & 0x7ff) + trailing;
    f64::from_bits(exponent.saturating_sub(52).max(1) << 52)
}

impl Filter {
    /// The filter for these points.
    pub fn for_points(points: &[DVec3]) -> Filter {
        let mut filter = Filter::default();
        filter.extend_all(points);
        filter
    }

    /// Extends the filter to one more point.
    #[inline]
    pub fn extend(&mut self, point: DVec3) {
        let (low, high, unit) = (self.low, self.high, self.unit);
        self.cover(point);
        if low != self.low || high != self.high || unit != self.unit {
            self.update_bounds();
        }
    }

    /// Extends the filter to many more points. NaN, which stands where a vertex was removed, is passed over.
    pub fn extend_all(&mut self, points: &[DVec3]) {
        for &point in points.iter().filter(|point| !point.is_nan()) {
            self.cover(point + DVec3::ZERO);
        }
        self.update_bounds();
    }

    /// The corners of the box of all points; inverted when there is none.
    pub fn bounding_box(&self) -> (DVec3, DVec3) {
        (self.low, self.high)
    }

    #[inline]
    fn cover(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
        self.unit = self.unit.min(divisor(point.x)).min(divisor(point.y)).min(divisor(point.z));
    }

    fn update_bounds(&mut self) {
        // Rounded up, as the differences of the predicates may be.
        let size = (self.high - self.low) * (1.0 + 4.0 * f64::EPSILON);
        let volume = size.x * size.y * size.z;
        self.orient_bound = ORIENT_ERROR * volume * (1.0 + 8.0 * f64::EPSILON);
        self.insphere_bound = INSPHERE_ERROR * volume * size.length_squared() * (1.0 + 16.0 * f64::EPSILON);
        // On a grid of few steps all determinants are exact as they stand.
        let extent = size.max_element();
        self.fixed = FixedPoint::new(self.unit, self.low.abs().max(self.high.abs()).max_element());
        if extent <= ORIENT_EXACT_UNITS * self.unit {
            self.orient_bound = 0.0;
        }
        if extent <= INSPHERE_EXACT_UNITS * self.unit {
            self.insphere_bound = 0.0;
        }
    }

    /// What [`orient_lanes`] must exceed in magnitude to be right, for these points. When it is 0, a result of 0 is right too.
    #[inline]
    pub fn orient_bound(&self) -> f64 {
        self.orient_bound
    }

    /// The same for [`insphere_lanes`].
    #[inline]
    pub fn insphere_bound(&self) -> f64 {
        self.insphere_bound
    }

    /// The sign of `det[b−a, c−a, d−a]`: positive when `d` sees `abc` counterclockwise from the inside of a positive
    /// tetrahedron.
    #[inline]
    pub fn orient3d(&self, a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Sign {
        let (u, v, w) = (a - d, b - d, c - d);
        let det = orient_determinant(u, v, w);
        if det > self.orient_bound {
            return Sign::Positive;
        }
        if det < -self.orient_bound {
            return Sign::Negative;
        }
        self.orient3d_slow(a, b, c, d, det)
    }

    #[cold]
    #[inline(never)]
    fn orient3d_slow(&self, a: DVec3, b: DVec3, c: DVec3, d: DVec3, det: f64) -> Sign {
        let m = (a - d).abs().max((b - d).abs()).max((c - d).abs());
        let bound = ORIENT_ERROR * (1.0 + 8.0 * f64::EPSILON) * (m.x * m.y * m.z);
        if det.abs() > bound || m.max_element() <= ORIENT_EXACT_UNITS * self.unit {
            return Sign::of(det);
        }
        if let Some(fixed) = self.fixed.or_else(|| FixedPoint::of([a, b, c, d])) {
            return fixed.orient3d([a, b, c], d);
        }
        match WidePoint::of([a, b, c, d]) {
            Some(wide) => wide.orient3d([a, b, c], d),
            None => orient3d(a, b, c, d),
        }
    }

    /// Where `p` lies to the circumsphere of the positive tetrahedron `abcd`: positive inside.
    #[inline]
    pub fn insphere(&self, a: DVec3, b: DVec3, c: DVec3, d: DVec3, p: DVec3) -> Sign {
        let det = insphere_determinant(a - p, b - p, c - p, d - p);
        if det > self.insphere_bound {
            return Sign::Positive;
        }
        if det < -self.insphere_bound {
            return Sign::Negative;
        }
        self.insphere_slow(a, b, c, d, p, det)
    }

    #[cold]
    #[inline(never)]
    fn insphere_slow(&self, a: DVec3, b: DVec3, c: DVec3, d: DVec3, p: DVec3, det: f64) -> Sign {
        let m = (a - p).abs().max((b - p).abs()).max((c - p).abs()).max((d - p).abs());
        let bound = INSPHERE_ERROR * (1.0 + 16.0 * f64::EPSILON) * (m.x * m.y * m.z) * m.length_squared();
        if det.abs() > bound || m.max_element() <= INSPHERE_EXACT_UNITS * self.unit {
            return Sign::of(det);
        }
        if let Some(fixed) = self.fixed.or_else(|| FixedPoint::of([a, b, c, d, p])) {
            return fixed.insphere([a, b, c, d], p);
        }
        match WidePoint::of([a, b, c, d, p]) {
            Some(wide) => wide.insphere([a, b, c, d], p),
            None => insphere(a, b, c, d, p),
        }
    }

    /// The largest power of two that divides every coordinate.
    #[cfg(test)]
    pub(super) fn unit(&self) -> f64 {
        self.unit
    }
}

/// `−det[u, v, w]` in Shewchuk's order of evaluation, which his error bound is for; with `u = a − d` and so on it is
/// `det[b−a, c−a, d−a]`.
#[inline]
fn orient_determinant(u: DVec3, v: DVec3, w: DVec3) -> f64 {
    let x = v.x * w.y - w.x * v.y;
    let y = w.x * u.y - u.x * w.y;
    let z = u.x * v.y - v.x * u.y;
    -(u.z * x + v.z * y + w.z * z)
}

/// The 4 × 4 determinant of the rows `(vector, length²)`, negated, in Shewchuk's order of evaluation.
#[inline]
fn insphere_determinant(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let ab = a.x * b.y - b.x * a.y;
    let bc = b.x * c.y - c.x * b.y;
    let cd = c.x * d.y - d.x * c.y;
    let da = d.x * a.y - a.x * d.y;
    let ac = a.x * c.y - c.x * a.y;
    let bd = b.x * d.y - d.x * b.y;
    let abc = a.z * bc - b.z * ac + c.z * ab;
    let bcd = b.z * cd - c.z * bd + d.z * bc;
    let cda = c.z * da + d.z * ac + a.z * cd;
    let dab = d.z * ab + a.z * bd + b.z * da;
    let lift = |v: DVec3| v.x * v.x + v.y * v.y + v.z * v.z;
    (lift(c) * dab - lift(d) * abc) + (lift(a) * bcd - lift(b) * cda)
}

/// The lanes of `p.x·q.y − q.x·p.y`.
#[inline(always)]
fn minor<L: Lanes>(p: [L; 3], q: [L; 3]) -> L {
    p[0].mul_sub(q[1], q[0].mul(p[1]))
}

#[inline(always)]
fn lift<L: Lanes>(v: [L; 3]) -> L {
    v[2].mul_add(v[2], v[1].mul_add(v[1], v[0].mul(v[0])))
}

/// `det[u, v, w]` in each lane: the opposite of [`Filter::orient3d`] of three points and a last one that they are relative to.
#[inline(always)]
pub fn orient_lanes<L: Lanes>(u: [L; 3], v: [L; 3], w: [L; 3]) -> L {
    u[2].mul_add(minor(v, w), v[2].mul_add(minor(w, u), w[2].mul(minor(u, v))))
}

/// What [`insphere_lanes`] is about: lane i has the corners other than i of one tetrahedron, in cyclic order, and another point in place of corner i.
#[derive(Clone, Copy)]
pub struct Beside<L> {
    next: [L; 3],
    across: [L; 3],
    last: [L; 3],
    /// Of each coordinate, then of the three together: what [`insphere_lanes`] multiplies with those of the other point.
    cofactors: [L; 4],
}

impl<L: Lanes> Beside<L> {
    /// For a tetrahedron with these corners, one a lane, relative to the point in question.
    #[inline(always)]
    pub fn new(corners: [L; 3]) -> Self {
        let ([x, y, z], l) = (corners, lift(corners));
        let ([x1, x2, x3], [y1, y2, y3]) = (x.rotations(), y.rotations());
        let ([z1, z2, z3], [l1, l2, l3]) = (z.rotations(), l.rotations());
        // The minors of x and y, and of z and the lift, of two corners each.
        let xy12 = x1.mul_sub(y2, x2.mul(y1));
        let xy13 = x1.mul_sub(y3, x3.mul(y1));
        let [xy23, ..] = xy12.rotations();
        let zl12 = z1.mul_sub(l2, z2.mul(l1));
        let zl13 = z1.mul_sub(l3, z3.mul(l1));
        let [zl23, ..] = zl12.rotations();
        let yzl = y3.mul_add(zl12, y1.mul_sub(zl23, y2.mul(zl13)));
        let xzl = x3.mul_add(zl12, x1.mul_sub(zl23, x2.mul(zl13)));
        let xyl = l3.mul_add(xy12, l1.mul_sub(xy23, l2.mul(xy13)));
        let xyz = z3.mul_add(xy12, z1.mul_sub(xy23, z2.mul(xy13)));
        Beside { next: [x1, y1, z1], across: [x2, y2, z2], last: [x3, y3, z3], cofactors: [yzl, xzl, xyl, xyz] }
    }
}

/// [`Filter::insphere`] in each lane, of a tetrahedron whose corner of the lane's number is replaced by the lane's point in `others`, all
/// relative to the point in question.
///
/// The determinant is expanded by the row that is replaced, so that most of the work needs no other points, and is done while they are on
/// their way. Its terms and the depth of its sums are those of Shewchuk's order.
#[inline(always)]
pub fn insphere_lanes<L: Lanes>(beside: &Beside<L>, others: [L; 3]) -> L {
    let ([yzl, xzl, xyl, xyz], [x, y, z]) = (beside.cofactors, others);
    // In two halves: the error bound is for a sum of this depth. A cyclic order of four is an odd permutation: signs alternate.
    lift(others).mul_sub(xyz, z.mul(xyl)).add(y.mul_sub(xzl, x.mul(yzl))).alternate()
}

/// What more can be said of lanes that [`insphere_lanes`] leaves open, as bits: inside, outside, and on the sphere.
#[inline(always)]
pub fn insphere_lanes_again<L: Lanes>(filter: &Filter, det: L, beside: &Beside<L>, others: [L; 3]) -> [u32; 3] {
    let Beside { next: a, across: b, last: c, .. } = *beside;
    let x = greatest(a[0], b[0], c[0], others[0]);
    let y = greatest(a[1], b[1], c[1], others[1]);
    let z = greatest(a[2], b[2], c[2], others[2]);
    let error = L::splat(INSPHERE_ERROR * (1.0 + 16.0 * f64::EPSILON));
    let bound = error.mul(x.mul(y).mul(z)).mul(lift([x, y, z]));
    let zero = L::splat(0.0);
    let exact = !x.max(y).max(z).greater(L::splat(INSPHERE_EXACT_UNITS * filter.unit)) & 0b1111;
    let (positive, negative) = (det.greater(zero), zero.greater(det));
    let inside = det.greater(bound) | positive & exact;
    let outside = zero.sub(bound).greater(det) | negative & exact;
    [inside, outside, exact & !(positive | negative)]
}

#[inline(always)]
fn greatest<L: Lanes>(a: L, b: L, c: L, d: L) -> L {
    a.abs().max(b.abs()).max(c.abs().max(d.abs()))
}

fn coord(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// [`Filter::orient3d`] for points that no filter was made for.
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Sign {
    // Shewchuk's orientation is the opposite of ours.
    -Sign::of(robust::orient3d(coord(a), coord(b), coord(c), coord(d)))
}

/// [`Filter::insphere`] for points that no filter was made for.
pub fn insphere(a: DVec3, b: DVec3, c: DVec3, d: DVec3, p: DVec3) -> Sign {
    -Sign::of(robust::insphere(coord(a), coord(b), coord(c), coord(d), coord(p)))
}

/// The sign of the planar orientation of three points after dropping coordinate `axis` (0, 1, 2), the other two in
/// cyclic order: positive counterclockwise seen from the positive end of that axis.
pub fn orient2d(axis: usize, a: DVec3, b: DVec3, c: DVec3) -> Sign {
    let project = |p: DVec3| {
        let p = p.to_array();
        robust::Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] }
    };
    Sign::of(robust::orient2d(project(a), project(b), project(c)))
}

/// Whether three points lie on one line (or fewer than three differ).
pub fn collinear(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (0..3).all(|axis| orient2d(axis, a, b, c) == Sign::Zero)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::lanes::Portable;

    #[cfg(target_arch = "x86_64")]
    use crate::geometry::lanes::Avx2;

    const A: DVec3 = DVec3::ZERO;
    const B: DVec3 = DVec3::X;
    const C: DVec3 = DVec3::Y;
    const D: DVec3 = DVec3::Z;

    #[test]
    fn conventions() {
        let filter = Filter::for_points(&[A, B, C, D, DVec3::ONE]);
        assert_eq!(filter.orient3d(A, B, C, D), Sign::Positive);
        assert_eq!(filter.orient3d(B, A, C, D), Sign::Negative);
        assert_eq!(filter.insphere(A, B, C, D, DVec3::splat(0.25)), Sign::Positive);
        assert_eq!(filter.insphere(A, B, C, D, DVec3::splat(2.0)), Sign::Negative);
        assert_eq!(filter.insphere(A, B, C, D, DVec3::ONE), Sign::Zero);
        assert_eq!(orient3d(A, B, C, D), Sign::Positive);
        assert_eq!(insphere(A, B, C, D, DVec3::splat(0.25)), Sign::Positive);
        assert_eq!(orient2d(2, A, B, C), Sign::Positive);
        assert_eq!(orient2d(0, A, C, D), Sign::Positive);
        assert_eq!(orient2d(1, A, D, B), Sign::Positive);
        assert!(collinear(A, DVec3::ONE, DVec3::splat(-3.0)) && !collinear(A, B, C));
    }

    #[test]
    fn divisor_is_the_lowest_set_bit() {
        assert_eq!(divisor(12.0), 4.0);
        assert_eq!(divisor(-0.375), 0.125);
        assert_eq!(divisor(1.0 + f64::EPSILON), f64::EPSILON);
        assert_eq!(divisor(2f64.powi(-142)), 2f64.powi(-142));
    }

    #[test]
    fn one_ulp_off_the_sphere_is_seen() {
        let corners = [A, B, C, D];
        let up = f64::from_bits(1f64.to_bits() + 1);
        let p = DVec3::new(1.0, 1.0, up);
        let filter = Filter::for_points(&[A, B, C, D, p]);
        assert_eq!(filter.insphere(corners[0], corners[1], corners[2], corners[3], p), Sign::Negative);
        let p = DVec3::new(1.0, 1.0, 1.0 - f64::EPSILON / 2.0);
        assert_eq!(filter.insphere(corners[0], corners[1], corners[2], corners[3], p), Sign::Positive);
    }

    #[test]
    fn all_stages_agree_on_a_fine_grid() {
        // Every choice of five points of a small grid with a unit far below 1.
        let unit = 2f64.powi(-60);
        let points: Vec<DVec3> = (0..27)
            .map(|i| DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64) * unit + DVec3::splat(3.0 * unit))
            .collect();
        let filter = Filter::for_points(&points);
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            points[(state >> 33) as usize % 27]
        };
        for _ in 0..2000 {
            let (a, b, c, d, p) = (next(), next(), next(), next(), next());
            assert_eq!(filter.orient3d(a, b, c, d), orient3d(a, b, c, d));
            assert_eq!(filter.insphere(a, b, c, d, p), insphere(a, b, c, d, p));
        }
    }

    /// Four corners and four other points each time, of a filter's points: what the lanes say, as bits, must be so.
    fn lanes_against_single<L: Lanes>(points: &[DVec3]) -> u32 {
        let filter = Filter::for_points(points);
        let mut state = 5u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            points[(state >> 33) as usize % points.len()]
        };
        let mut decided = 0;
        for _ in 0..5000 {
            let (corners, others, p) = ([next(), next(), next(), next()], [next(), next(), next(), next()], next());
            let relative = |points: [DVec3; 4]| {
                let [x, y, z] = L::load([&points[0], &points[1], &points[2], &points[3]]);
                [x.sub(L::splat(p.x)), y.sub(L::splat(p.y)), z.sub(L::splat(p.z))]
            };
            let beside = Beside::new(relative(corners));
            let others_to_p = relative(others);
            let det = insphere_lanes(&beside, others_to_p);
            let bound = filter.insphere_bound();
            let (inside, outside) = (det.greater(L::splat(bound)), L::splat(-bound).greater(det));
            let [inside_too, outside_too, on] = insphere_lanes_again(&filter, det, &beside, others_to_p);
            for lane in 0..4 {
                let mut five = corners;
                five[lane] = others[lane];
                let [a, b, c, d] = five;
                let sign = insphere(a, b, c, d, p);
                let says = |bits: u32| bits >> lane & 1 == 1;
                assert!(!says(inside | inside_too) || sign == Sign::Positive);
                assert!(!says(outside | outside_too) || sign == Sign::Negative);
                assert!(!says(on) || sign == Sign::Zero);
                decided += u32::from(says(inside | outside | inside_too | outside_too | on));
            }
        }
        decided
    }

    #[test]
    fn four_at_once_say_what_one_says() {
        let mut next = crate::samples::numbers(3);
        let scattered: Vec<DVec3> = (0..300).map(|_| DVec3::new(next(), next(), next())).collect();
        // Nearly on a sphere, far from the origin.
        let shell: Vec<DVec3> =
            scattered.iter().map(|&p| (p - DVec3::splat(0.5)).normalize() + DVec3::splat(1e6)).collect();
        let grid = |unit: f64| -> Vec<DVec3> {
            (0..64).map(|i| DVec3::new((i & 3) as f64, (i >> 2 & 3) as f64, (i >> 4) as f64) * unit).collect()
        };
        for (points, least) in [(scattered, 19_000), (shell, 0), (grid(1.0), 20_000), (grid(0.1), 10_000)] {
            assert!(lanes_against_single::<Portable>(&points) >= least);
            #[cfg(target_arch = "x86_64")]
            if Avx2::available() {
                assert!(lanes_against_single::<Avx2>(&points) >= least);
            }
        }
    }
}
