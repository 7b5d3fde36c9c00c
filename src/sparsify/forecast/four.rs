//! Four tetrahedra at a time: their spheres, and how bad they are.
//!
//! No operation is fused with another, so that the answers are the same on every machine, whatever its lanes.

use glam::DVec3;

use super::Demand;
#[cfg(target_arch = "x86_64")]
use crate::geometry::lanes::Avx2;
use crate::geometry::lanes::{Lanes, Portable};
use crate::geometry::quality::{corners, difference, squared};

/// Circumcentres relative to an origin, squared circumradii, and squared shortest edges.
pub(super) struct Spheres {
    pub center: [[f64; 4]; 3],
    pub radius2: [f64; 4],
    pub shortest2: [f64; 4],
}

/// The spheres of four tetrahedra.
#[inline]
pub(super) fn spheres(tets: &[[&DVec3; 4]; 4], origin: DVec3) -> Spheres {
    #[cfg(target_arch = "x86_64")]
    if Avx2::available() {
        // SAFETY: the processor has what the function is compiled for.
        return unsafe { spheres_avx2(tets, origin) };
    }
    spheres_in::<Portable>(tets, origin)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn spheres_avx2(tets: &[[&DVec3; 4]; 4], origin: DVec3) -> Spheres {
    spheres_in::<Avx2>(tets, origin)
}

#[inline(always)]
fn spheres_in<L: Lanes>(tets: &[[&DVec3; 4]; 4], origin: DVec3) -> Spheres {
    let ([a, b, c, d], origin) = (corners::<L>(tets), everywhere(origin));
    let (a, b, c, d) = (difference(a, origin), difference(b, origin), difference(c, origin), difference(d, origin));
    let (u, v, w) = (difference(b, a), difference(c, a), difference(d, a));
    let (uu, vv, ww) = (squared(u), squared(v), squared(w));
    let (n, volume) = circumcenter_and_volume([u, v, w], [uu, vv, ww]);
    let twice = L::splat(2.0).mul(volume);
    let offset = [n[0].div(twice), n[1].div(twice), n[2].div(twice)];
    let shortest2 =
        uu.min(vv).min(ww).min(squared(difference(b, c))).min(squared(difference(b, d))).min(squared(difference(c, d)));
    Spheres {
        center: [a[0].add(offset[0]).to_array(), a[1].add(offset[1]).to_array(), a[2].add(offset[2]).to_array()],
        radius2: squared(offset).to_array(),
        shortest2: shortest2.to_array(),
    }
}

/// R²/(β·l)² of the tetrahedra of four faces and `q`, 0 where that does not matter, infinite where `q` is not on the face's side.
#[inline]
pub(super) fn ratios(faces: &[[DVec3; 3]; 4], q: DVec3, demand: Demand) -> [f64; 4] {
    #[cfg(target_arch = "x86_64")]
    if Avx2::available() {
        // SAFETY: the processor has what the function is compiled for.
        return unsafe { ratios_avx2(faces, q, demand) };
    }
    ratios_in::<Portable>(faces, q, demand)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn ratios_avx2(faces: &[[DVec3; 3]; 4], q: DVec3, demand: Demand) -> [f64; 4] {
    ratios_in::<Avx2>(faces, q, demand)
}

#[inline(always)]
fn ratios_in<L: Lanes>(faces: &[[DVec3; 3]; 4], q: DVec3, demand: Demand) -> [f64; 4] {
    let q = everywhere::<L>(q);
    // What is done in lanes stands here itself: in a function that is passed on it would not be compiled for them.
    let corners = |k: usize| [&faces[0][k], &faces[1][k], &faces[2][k], &faces[3][k]];
    let u = difference(L::load(corners(0)), q);
    let v = difference(L::load(corners(1)), q);
    let w = difference(L::load(corners(2)), q);
    let (uu, vv, ww) = (squared(u), squared(v), squared(w));
    let (n, volume) = circumcenter_and_volume([u, v, w], [uu, vv, ww]);
    let shortest2 =
        uu.min(vv).min(ww).min(squared(difference(u, v)).min(squared(difference(v, w))).min(squared(difference(w, u))));
    let below = volume.mul(volume).mul(shortest2);
    let ratio = squared(n).div(L::splat(4.0 * demand.bound2).mul(below));
    let late = shortest2.greater(L::splat(demand.level2));
    let bad = ratio.greater(L::splat(1.0 - 1e-9));
    let zero = L::splat(0.0);
    let fits = zero.greater(volume) & below.greater(zero);
    let worse = ratio.add(L::splat(1e-9)).to_array();
    std::array::from_fn(|lane| match (fits >> lane & 1, (bad & !late) >> lane & 1) {
        (0, _) => f64::INFINITY,
        (_, 0) => 0.0,
        _ => worse[lane],
    })
}

/// Of tetrahedra with these edges from one corner, and their squares: the circumcentre from that corner times twice the volume, and the volume, sixfold.
#[inline(always)]
fn circumcenter_and_volume<L: Lanes>([u, v, w]: [[L; 3]; 3], [uu, vv, ww]: [L; 3]) -> ([L; 3], L) {
    let (vw, wu, uv) = (cross(v, w), cross(w, u), cross(u, v));
    let part = |i: usize| uu.mul(vw[i]).add(vv.mul(wu[i])).add(ww.mul(uv[i]));
    ([part(0), part(1), part(2)], dot(u, vw))
}

/// The same point in each lane.
#[inline(always)]
fn everywhere<L: Lanes>(p: DVec3) -> [L; 3] {
    [L::splat(p.x), L::splat(p.y), L::splat(p.z)]
}

#[inline(always)]
fn dot<L: Lanes>(p: [L; 3], q: [L; 3]) -> L {
    p[0].mul(q[0]).add(p[1].mul(q[1])).add(p[2].mul(q[2]))
}

#[inline(always)]
fn cross<L: Lanes>(p: [L; 3], q: [L; 3]) -> [L; 3] {
    [p[1].mul(q[2]).sub(p[2].mul(q[1])), p[2].mul(q[0]).sub(p[0].mul(q[2])), p[0].mul(q[1]).sub(p[1].mul(q[0]))]
}

#[cfg(test)]
mod tests {
    use super::super::sphere;
    use super::*;
    use crate::geometry::quality::EDGES;

    #[test]
    fn four_spheres_are_those_of_one_by_one() {
        let mut next = crate::samples::numbers(11);
        for _ in 0..1000 {
            let tets: [[DVec3; 4]; 4] =
                std::array::from_fn(|_| std::array::from_fn(|_| DVec3::new(next(), next(), next())));
            let origin = DVec3::new(next(), next(), next());
            let four = spheres(&tets.each_ref().map(|tet| tet.each_ref()), origin);
            let portable = spheres_in::<Portable>(&tets.each_ref().map(|tet| tet.each_ref()), origin);
            for (i, tet) in tets.iter().enumerate() {
                let corners = tet.map(|p| p - origin);
                let (center, radius2) = sphere(corners);
                let shortest2 =
                    EDGES.iter().map(|&[i, j]| corners[i].distance_squared(corners[j])).fold(f64::INFINITY, f64::min);
                for found in [&four, &portable] {
                    assert_eq!(found.center.map(|x| x[i]), center.to_array());
                    assert_eq!((found.radius2[i], found.shortest2[i]), (radius2, shortest2));
                }
            }
        }
    }

    #[test]
    fn ratios_are_those_of_the_sphere() {
        let mut next = crate::samples::numbers(12);
        let mut seen = [0; 3];
        for _ in 0..1000 {
            let faces: [[DVec3; 3]; 4] =
                std::array::from_fn(|_| std::array::from_fn(|_| DVec3::new(next(), next(), next())));
            let q = DVec3::new(next(), next(), next());
            let demand = Demand { bound2: 2.25, level2: 0.1 };
            let four = ratios(&faces, q, demand);
            assert_eq!(four, ratios_in::<Portable>(&faces, q, demand));
            for ([a, b, c], found) in faces.into_iter().zip(four) {
                let (_, radius2) = sphere([a, b, c, q]);
                let corners = [a, b, c, q];
                let shortest2 =
                    EDGES.iter().map(|&[i, j]| corners[i].distance_squared(corners[j])).fold(f64::INFINITY, f64::min);
                let ratio = radius2 / (demand.bound2 * shortest2);
                let kind = if (b - a).cross(c - a).dot(q - a) <= 0.0 {
                    assert_eq!(found, f64::INFINITY);
                    0
                } else if ratio < 0.999_999 || shortest2 > demand.level2 * (1.0 + 1e-12) {
                    assert_eq!(found, 0.0);
                    1
                } else {
                    assert!((found / ratio - 1.0).abs() < 1e-6, "{found} {ratio}");
                    2
                };
                seen[kind] += 1;
            }
        }
        assert!(seen.iter().all(|&count| count > 300), "{seen:?}");
    }
}
