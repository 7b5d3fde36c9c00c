//! Numbers, points and domains for tests.

use crate::{DVec3, Plc, PlcFacet};

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

pub(crate) fn facet(polygon: impl IntoIterator<Item = u32>, marker: i32) -> PlcFacet {
    PlcFacet { polygons: vec![polygon.into_iter().collect()], marker, ..PlcFacet::default() }
}

/// The prism over a polygon in the plane z = 0, its corners in order.
pub(crate) fn prism(outline: &[[f64; 2]], height: f64) -> Plc {
    let n = outline.len() as u32;
    let at = |z: f64| outline.iter().map(move |&[x, y]| DVec3::new(x, y, z));
    let mut facets = vec![facet(0..n, 1), facet(n..2 * n, 2)];
    facets.extend((0..n).map(|i| facet([i, (i + 1) % n, n + (i + 1) % n, n + i], 3 + i as i32)));
    Plc { points: at(0.0).chain(at(height)).collect(), facets, ..Plc::default() }
}

/// A plate so thin that every vertex encroaches upon what is beside it, with few of its tetrahedra bad.
pub(crate) fn thin_plate() -> Plc {
    let at = |k: u32| (std::f64::consts::TAU * f64::from(k) / 24.0).sin_cos();
    let outline: Vec<[f64; 2]> = (0..24).map(|k| [40.0 * at(k).1, 40.0 * at(k).0]).collect();
    prism(&outline, 6.0)
}
