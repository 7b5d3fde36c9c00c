//! Which coordinates the exact predicates hold.
//!
//! `insphere` is a polynomial of degree 5. With magnitudes of at most 2²⁰¹ its terms stay below
//! 2¹⁰²³, and with magnitudes of at least 2⁻¹⁴² the coordinates are multiples of 2⁻¹⁹⁴, so that every product
//! of five differences is a multiple of 2⁻⁹⁷⁰ and no rounding error is lost to underflow.

use glam::DVec3;

use crate::Error;

/// Smallest magnitude other than 0 that a coordinate may have.
pub const MIN_MAGNITUDE: f64 = f64::from_bits((1023 - 142) << 52);
/// Largest magnitude that a coordinate may have.
pub const MAX_MAGNITUDE: f64 = f64::from_bits((1023 + 201) << 52);

/// A length that is safe to add to any coordinate or to have a triangulation in: far above the smallest magnitude.
pub const MIN_LENGTH: f64 = MIN_MAGNITUDE * 1024.0;

fn in_range(x: f64) -> bool {
    let magnitude = x.abs();
    x == 0.0 || (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&magnitude)
}

/// Refuses a point with a coordinate that the predicates can't hold; `index` names it in the error.
pub fn check_range(index: usize, point: DVec3) -> Result<(), Error> {
    if !point.is_finite() {
        return Err(Error::NotFinite { index, point });
    }
    if !point.to_array().into_iter().all(in_range) {
        return Err(Error::OutOfRange { index, point });
    }
    Ok(())
}

/// [`check_range`] for all points; the error names the first bad one.
pub fn check_points(points: &[DVec3]) -> Result<(), Error> {
    points.iter().enumerate().try_for_each(|(index, &point)| check_range(index, point))
}

/// Sets coordinates too small for the predicates to 0. Constructed points need it: cancellation may leave
/// any residue, while 0 is as good an answer.
pub fn flush_tiny(point: DVec3) -> DVec3 {
    let flush = |x: f64| if x.abs() < MIN_MAGNITUDE { 0.0 } else { x };
    DVec3::new(flush(point.x), flush(point.y), flush(point.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_inclusive_and_zero_is_legal() {
        let at = |x: f64| check_range(3, DVec3::new(0.0, x, -0.0));
        assert!(at(MIN_MAGNITUDE).is_ok() && at(-MAX_MAGNITUDE).is_ok() && at(0.0).is_ok());
        assert!(matches!(at(MIN_MAGNITUDE / 2.0), Err(Error::OutOfRange { index: 3, .. })));
        assert!(matches!(at(MAX_MAGNITUDE * 1.5), Err(Error::OutOfRange { .. })));
        assert!(matches!(at(f64::NAN), Err(Error::NotFinite { .. })));
        assert!(matches!(at(f64::NEG_INFINITY), Err(Error::NotFinite { .. })));
    }

    #[test]
    fn flushing_leaves_only_legal_magnitudes() {
        let p = flush_tiny(DVec3::new(1e-300, -f64::MIN_POSITIVE, 2.0));
        assert_eq!(p, DVec3::new(0.0, 0.0, 2.0));
    }
}
