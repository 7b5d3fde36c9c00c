//! Exact signs of polynomials that are too rare or too long for a hand-made adaptive predicate: one generic
//! formula, evaluated first in floating point with a running error bound, then in dyadic rationals.

use glam::DVec3;
use num_bigint::{BigInt, Sign as BigSign};

use super::predicates::Sign;

/// The arithmetic that a formula is written in.
pub(super) trait Scalar: Sized {
    fn new(value: f64) -> Self;
    fn add(&self, other: &Self) -> Self;
    fn sub(&self, other: &Self) -> Self;
    fn mul(&self, other: &Self) -> Self;
    /// The sign, if this arithmetic is sure of it.
    fn sign(&self) -> Option<Sign>;
}

/// The sign of `formula`, which is called with the cheap arithmetic first.
macro_rules! exact_sign {
    ($formula:ident ( $($argument:expr),* )) => {{
        use $crate::geometry::exact::{Dyadic, Running, Scalar};
        match $formula::<Running>($($argument),*).sign() {
            Some(sign) => sign,
            None => $formula::<Dyadic>($($argument),*).sign().expect("dyadic numbers are exact"),
        }
    }};
}
pub(super) use exact_sign;

/// A floating-point number and a bound of its distance to the true value (Higham's running error analysis).
#[derive(Clone, Copy, Debug)]
pub(super) struct Running {
    value: f64,
    error: f64,
}

/// Covers a result's own rounding and, doubled, the rounding of its error bound.
const ROUNDING: f64 = 2.0 * f64::EPSILON;
/// Covers results that underflow.
const UNDERFLOW: f64 = f64::MIN_POSITIVE;

impl Running {
    fn with(value: f64, error: f64) -> Running {
        Running { value, error: error + ROUNDING * (error + value.abs()) + UNDERFLOW }
    }
}

impl Scalar for Running {
    fn new(value: f64) -> Self {
        Running { value, error: 0.0 }
    }
    fn add(&self, other: &Self) -> Self {
        Running::with(self.value + other.value, self.error + other.error)
    }
    fn sub(&self, other: &Self) -> Self {
        Running::with(self.value - other.value, self.error + other.error)
    }
    fn mul(&self, other: &Self) -> Self {
        let error = self.value.abs() * other.error + other.value.abs() * self.error + self.error * other.error;
        Running::with(self.value * other.value, error)
    }
    fn sign(&self) -> Option<Sign> {
        // Overflow makes the error infinite or NaN: never sure.
        (self.value.abs() > self.error).then(|| Sign::of(self.value))
    }
}

/// mantissa · 2^exponent.
#[derive(Clone, Debug)]
pub(super) struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    fn combine(&self, other: &Self, f: impl Fn(BigInt, BigInt) -> BigInt) -> Self {
        let exponent = self.exponent.min(other.exponent);
        let at = |d: &Dyadic| &d.mantissa << (d.exponent - exponent) as u64;
        Dyadic { mantissa: f(at(self), at(other)), exponent }
    }

    /// `self / other`, rounded; NaN or infinite where `other` is 0.
    pub fn quotient(&self, other: &Self) -> f64 {
        let ((a, i), (b, j)) = (self.leading(), other.leading());
        // Two steps, so that neither power leaves the range of doubles before the product does.
        let exponent = (i - j).clamp(-4000, 4000) as i32;
        a / b * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2)
    }

    /// The number's leading bits as a double of moderate size, and the power of two that they lack.
    fn leading(&self) -> (f64, i64) {
        let surplus = self.mantissa.bits().saturating_sub(64);
        let bits = (self.mantissa.magnitude() >> surplus).iter_u64_digits().next().unwrap_or(0) as f64;
        let signed = if self.mantissa.sign() == BigSign::Minus { -bits } else { bits };
        (signed, self.exponent + surplus as i64)
    }
}

impl Scalar for Dyadic {
    fn new(value: f64) -> Self {
        debug_assert!(value.is_finite());
        let bits = value.to_bits();
        let biased = (bits >> 52 & 0x7ff) as i64;
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let (magnitude, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        if magnitude == 0 {
            // Zero takes part in alignments with a harmless exponent.
            return Dyadic { mantissa: BigInt::ZERO, exponent: 0 };
        }
        let zeros = magnitude.trailing_zeros();
        let mantissa = magnitude >> zeros;
        let exponent = exponent + zeros as i64;
        Dyadic { mantissa: BigInt::from(if value < 0.0 { -mantissa } else { mantissa }), exponent }
    }
    fn add(&self, other: &Self) -> Self {
        self.combine(other, |a, b| a + b)
    }
    fn sub(&self, other: &Self) -> Self {
        self.combine(other, |a, b| a - b)
    }
    fn mul(&self, other: &Self) -> Self {
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
    fn sign(&self) -> Option<Sign> {
        Some(match self.mantissa.sign() {
            BigSign::Minus => Sign::Negative,
            BigSign::NoSign => Sign::Zero,
            BigSign::Plus => Sign::Positive,
        })
    }
}

/// A vector of scalars.
pub(super) struct Vector<T>([T; 3]);

impl<T: Scalar> Vector<T> {
    /// `a − b`, exactly rounded into the arithmetic.
    pub fn difference(a: DVec3, b: DVec3) -> Self {
        let component = |i: usize| T::new(a[i]).sub(&T::new(b[i]));
        Vector([component(0), component(1), component(2)])
    }
    pub fn add(&self, other: &Self) -> Self {
        let component = |i: usize| self.0[i].add(&other.0[i]);
        Vector([component(0), component(1), component(2)])
    }
    pub fn sub(&self, other: &Self) -> Self {
        let component = |i: usize| self.0[i].sub(&other.0[i]);
        Vector([component(0), component(1), component(2)])
    }
    pub fn scale(&self, factor: &T) -> Self {
        let component = |i: usize| self.0[i].mul(factor);
        Vector([component(0), component(1), component(2)])
    }
    pub fn dot(&self, other: &Self) -> T {
        let product = |i: usize| self.0[i].mul(&other.0[i]);
        product(0).add(&product(1)).add(&product(2))
    }
    pub fn cross(&self, other: &Self) -> Self {
        let component = |i: usize, j: usize| self.0[i].mul(&other.0[j]).sub(&self.0[j].mul(&other.0[i]));
        Vector([component(1, 2), component(2, 0), component(0, 1)])
    }
    pub fn length_squared(&self) -> T {
        self.dot(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn difference_of_squares<T: Scalar>(a: f64, b: f64) -> T {
        // (a + b)(a − b) − (a² − b²) + a·0 is 0; adding 2⁻³⁰⁰ makes it positive.
        let (a, b) = (T::new(a), T::new(b));
        let zero = a.add(&b).mul(&a.sub(&b)).sub(&a.mul(&a).sub(&b.mul(&b)));
        zero.add(&T::new(2f64.powi(-300)))
    }

    #[test]
    fn dyadic_decides_what_floating_point_can_not() {
        let (a, b) = (1.0 / 3.0, 1e-17);
        assert_eq!(difference_of_squares::<Running>(a, b).sign(), None);
        assert_eq!(exact_sign!(difference_of_squares(a, b)), Sign::Positive);
    }

    #[test]
    fn quotients_are_rounded_once() {
        let quotient =
            |a: f64, b: f64| Dyadic::new(a).mul(&Dyadic::new(1e300)).quotient(&Dyadic::new(b).mul(&Dyadic::new(1e300)));
        assert_eq!(quotient(-1.0, 4.0), -0.25);
        assert!((quotient(1e-200, 3e-200) - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!(quotient(0.0, 3.0), 0.0);
        assert_eq!(quotient(1.0, 0.0), f64::INFINITY);
    }

    #[test]
    fn overflow_is_never_sure() {
        let huge = Running::new(1e300).mul(&Running::new(1e300));
        assert_eq!(huge.sign(), None);
        assert_eq!(Dyadic::new(1e300).mul(&Dyadic::new(-1e300)).sign(), Some(Sign::Negative));
    }
}
