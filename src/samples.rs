//! Points for tests.

use crate::DVec3;

/// So many points on the unit sphere, evenly along a spiral. One at its centre conflicts with everything inside.
pub(crate) fn on_a_sphere(count: usize) -> Vec<DVec3> {
    let point = |i: usize| {
        let (z, angle) = (1.0 - (2 * i + 1) as f64 / count as f64, i as f64 * 2.399963);
        DVec3::new((1.0 - z * z).sqrt() * angle.cos(), (1.0 - z * z).sqrt() * angle.sin(), z)
    };
    (0..count).map(point).collect()
}
