//! Numbers and points for tests.

use crate::DVec3;

/// A value-stable source of numbers in [0, 1).
pub(crate) fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// So many points in the cube [−1, 1)³.
pub(crate) fn random_points(count: usize, seed: u64) -> Vec<DVec3> {
    let mut next = numbers(seed);
    (0..count).map(|_| DVec3::new(next(), next(), next()) * 2.0 - 1.0).collect()
}

/// So many points on the unit sphere, evenly along a spiral. One at its centre conflicts with everything inside.
pub(crate) fn on_a_sphere(count: usize) -> Vec<DVec3> {
    let point = |i: usize| {
        let (z, angle) = (1.0 - (2 * i + 1) as f64 / count as f64, i as f64 * 2.399963);
        DVec3::new((1.0 - z * z).sqrt() * angle.cos(), (1.0 - z * z).sqrt() * angle.sin(), z)
    };
    (0..count).map(point).collect()
}
