//! Whether a point lies inside the smallest ball of a subsegment or subfacet. Exact, boundaries excluded.

use glam::DVec3;

use super::exact::{exact_sign, Scalar, Vector};
use super::predicates::Sign;

/// Whether `p` lies inside the diametral ball of segment `ab`: the angle `apb` is obtuse.
#[inline]
pub fn encroaches_segment([a, b]: [DVec3; 2], p: DVec3) -> bool {
    let (u, v) = (a - p, b - p);
    let dot = u.dot(v);
    let error = 1e-15 * (u.x * v.x).abs().max((u.y * v.y).abs()).max((u.z * v.z).abs()) * 4.0;
    if dot.abs() > error {
        return dot < 0.0;
    }
    exact_sign!(apex_dot(a, b, p)) == Sign::Negative
}

fn apex_dot<T: Scalar>(a: DVec3, b: DVec3, p: DVec3) -> T {
    Vector::<T>::difference(a, p).dot(&Vector::difference(b, p))
}

/// Whether `p` lies inside the smallest ball through the corners of triangle `abc` (centred at its circumcentre).
///
/// With `u = b − a`, `v = c − a`, `n = u × v` the circumcentre is `a + m/2|n|²`, `m = (|u|²v − |v|²u) × n`; `p = a + w`
/// is inside when `|w|²·|n|² < w·m`.
#[inline]
pub fn encroaches_facet([a, b, c]: [DVec3; 3], p: DVec3) -> bool {
    let (u, v, w) = (b - a, c - a, p - a);
    let n = u.cross(v);
    let m = (u.length_squared() * v - v.length_squared() * u).cross(n);
    let (left, right) = (w.length_squared() * n.length_squared(), w.dot(m));
    let length = u.length_squared().max(v.length_squared());
    // Off by at most 30u of |w|²·length⁴ and 90u of |w|·length⁵, and by what products of six lengths lose to underflow.
    let relative = w.length_squared() * length * length + w.length() * length * length * length.sqrt();
    let error = 3e-14 * relative + f64::MIN_POSITIVE;
    if (left - right).abs() > error {
        return left < right;
    }
    exact_sign!(ball_excess(a, b, c, p)) == Sign::Negative
}

fn ball_excess<T: Scalar>(a: DVec3, b: DVec3, c: DVec3, p: DVec3) -> T {
    let (u, v, w) = (Vector::<T>::difference(b, a), Vector::<T>::difference(c, a), Vector::<T>::difference(p, a));
    let n = u.cross(&v);
    let m = v.scale(&u.length_squared()).sub(&u.scale(&v.length_squared())).cross(&n);
    w.length_squared().mul(&n.length_squared()).sub(&w.dot(&m))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_the_sphere_is_outside() {
        let s = [DVec3::NEG_X, DVec3::X];
        assert!(!encroaches_segment(s, DVec3::Y));
        assert!(encroaches_segment(s, DVec3::Y * (1.0 - f64::EPSILON)));
        assert!(!encroaches_segment(s, DVec3::Y * (1.0 + f64::EPSILON)));
        assert!(!encroaches_segment(s, DVec3::X));
        // A right triangle: the ball about its hypotenuse's midpoint.
        let t = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let apex = DVec3::new(0.5, 0.5, 0.5f64.sqrt());
        assert!(!encroaches_facet(t, DVec3::new(1.0, 1.0, 0.0)));
        assert!(!encroaches_facet(t, DVec3::X));
        assert!(encroaches_facet(t, apex * (1.0 - 1e-15)));
        assert!(!encroaches_facet(t, apex * (1.0 + 1e-15)));
    }

    /// Found by fuzzing: products of six such lengths underflow, which the filter did not know.
    #[test]
    fn underflow_decides_nothing() {
        let t = [
            DVec3::new(2.5353799723618916e-40, 2.535379972361901e-40, 2.5353799723617966e-40),
            DVec3::new(2.5353799723617966e-40, 2.5353799723617966e-40, 2.5353799723618e-40),
            DVec3::new(2.5353799723617966e-40, 2.5353799723617966e-40, 2.535379972361803e-40),
        ];
        let p = DVec3::new(2.535379972361891e-40, 2.535379972361901e-40, 2.5353799723617933e-40);
        let exactly = exact_sign!(ball_excess(t[0], t[1], t[2], p)) == Sign::Negative;
        assert_eq!(encroaches_facet(t, p), exactly);
        // The same, so much larger that nothing underflows.
        let scale = 2f64.powi(130);
        assert_eq!(encroaches_facet(t.map(|q| q * scale), p * scale), exactly);
    }
}
