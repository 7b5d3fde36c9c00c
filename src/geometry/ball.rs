//! In-sphere tests of one tetrahedron with several points: the determinant relative to a corner of the tetrahedron, expanded by the row of the
//! point, so that all but a few operations are done once. The orientation is one of its cofactors.
//!
//! Its terms, and the depth of its sums, are those of [`insphere_lanes`](super::predicates::insphere_lanes), and differences of corners are no
//! longer than the box of all points, so the filter's bounds hold; what they leave open the predicates decide.

use glam::DVec3;

use super::perturbation::in_conflict;
use super::{Filter, Sign};

/// A tetrahedron, to be asked about points.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    corners: [DVec3; 4],
    /// The minors of three corners relative to the last one: without x, without y, without z, and without the squared length.
    minors: [f64; 4],
}

impl Ball {
    /// The circumscribed one.
    #[inline]
    pub fn of(corners: [DVec3; 4]) -> Ball {
        let [a, b, c, d] = corners;
        let (u, v, w) = (a - d, b - d, c - d);
        let [k, l, m] = [u, v, w].map(DVec3::length_squared);
        let [xy_uv, xy_uw, xy_vw] = [minor(u.x, u.y, v.x, v.y), minor(u.x, u.y, w.x, w.y), minor(v.x, v.y, w.x, w.y)];
        let [zl_uv, zl_uw, zl_vw] = [minor(u.z, k, v.z, l), minor(u.z, k, w.z, m), minor(v.z, l, w.z, m)];
        let minors = [
            w.y * zl_uv + (u.y * zl_vw - v.y * zl_uw),
            w.x * zl_uv + (u.x * zl_vw - v.x * zl_uw),
            m * xy_uv + (k * xy_vw - l * xy_uw),
            w.z * xy_uv + (u.z * xy_vw - v.z * xy_uw),
        ];
        Ball { corners, minors }
    }

    /// [`Filter::orient3d`] of the corners.
    #[inline]
    pub fn orientation(&self, filter: &Filter) -> Sign {
        let (bound, volume) = (filter.orient_bound(), self.minors[3]);
        if volume < -bound {
            return Sign::Positive;
        }
        if volume > bound {
            return Sign::Negative;
        }
        let [a, b, c, d] = self.corners;
        filter.orient3d(a, b, c, d)
    }

    /// [`in_conflict`]: whether `p`, which is none of the corners, lies inside, after perturbation. The tetrahedron is positive.
    #[inline]
    pub fn conflicts(&self, filter: &Filter, p: DVec3) -> bool {
        let (e, [yzl, xzl, xyl, xyz]) = (p - self.corners[3], self.minors);
        let det = (e.length_squared() * xyz - e.z * xyl) + (e.y * xzl - e.x * yzl);
        let bound = filter.insphere_bound();
        if det > bound {
            return true;
        }
        if det < -bound {
            return false;
        }
        in_conflict(filter, self.corners, p)
    }
}

#[inline]
fn minor(a: f64, b: f64, c: f64, d: f64) -> f64 {
    a * d - c * b
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = DVec3> {
        let axis =
            || prop_oneof![-1.0..1.0f64, (-4..5i32).prop_map(f64::from), (-4..5i32).prop_map(|i| f64::from(i) * 0.1)];
        (axis(), axis(), axis()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn it_answers_as_the_predicates_do(
            points in prop::collection::vec(point(), 5..9), scale in -60..60i32, shift in prop_oneof![Just(0.0), -1e9..1e9f64]
        ) {
            let points: Vec<DVec3> = points.into_iter().map(|p| p * 2f64.powi(scale) + shift).collect();
            let filter = Filter::for_points(&points);
            let corners = [points[0], points[1], points[2], points[3]];
            let [a, b, c, d] = corners;
            for corners in [[a, b, c, d], [b, a, c, d]] {
                let ball = Ball::of(corners);
                let [a, b, c, d] = corners;
                prop_assert_eq!(ball.orientation(&filter), filter.orient3d(a, b, c, d));
                if ball.orientation(&filter) == Sign::Positive {
                    for &p in points[4..].iter().filter(|p| !corners.contains(p)) {
                        prop_assert_eq!(ball.conflicts(&filter, p), in_conflict(&filter, corners, p));
                    }
                }
            }
        }
    }
}
