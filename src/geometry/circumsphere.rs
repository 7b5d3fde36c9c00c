//! Circumcentres, in plain floating point: constructions need no exactness, the predicates decide
//! about what was constructed.

use glam::DVec3;

/// The circumcentre of a tetrahedron; not finite when it is flat to rounding.
#[inline]
pub fn circumcenter(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> DVec3 {
    let (u, v, w) = (b - a, c - a, d - a);
    let (vw, wu, uv) = (v.cross(w), w.cross(u), u.cross(v));
    let numerator = u.length_squared() * vw + v.length_squared() * wu + w.length_squared() * uv;
    a + numerator / (2.0 * u.dot(vw))
}

/// The circumcentre of a triangle, in its plane; not finite when it is a line to rounding.
///
/// Where the three points share a coordinate exactly, so does the result: facets along the axes stay exactly planar.
#[inline]
pub fn triangle_circumcenter(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    let numerator = (u.length_squared() * v - v.length_squared() * u).cross(normal);
    a + numerator / (2.0 * normal.length_squared())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equidistant() {
        let [a, b, c, d] = [[0.1, 0.2, 0.3], [1.0, 0.0, 0.2], [0.3, 1.5, 0.1], [0.2, 0.4, 2.0]].map(DVec3::from);
        let o = circumcenter(a, b, c, d);
        for p in [b, c, d] {
            assert!((o.distance(p) / o.distance(a) - 1.0).abs() < 1e-13);
        }
        let o = triangle_circumcenter(a, b, c);
        for p in [b, c] {
            assert!((o.distance(p) / o.distance(a) - 1.0).abs() < 1e-13);
        }
        assert!((o - a).dot((b - a).cross(c - a)).abs() < 1e-14);
    }

    #[test]
    fn shared_coordinates_stay_exact() {
        let [a, b, c] = [[0.1, 0.7, 1.3], [0.1, -0.2, 0.2], [0.1, 1.5, 0.1]].map(DVec3::from);
        assert_eq!(triangle_circumcenter(a, b, c).x, 0.1);
    }
}
