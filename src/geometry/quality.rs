//! The quality of a tetrahedron: radius-edge ratio and dihedral angles.
//!
//! Whether a tetrahedron keeps the bound is decided exactly: a floating-point answer with a safe margin first, then
//! the generic formula of `exact`. With `D = det[u, v, w]` and
//! `N = |u|²(v×w) + |v|²(w×u) + |w|²(u×v)` the circumradius is `|N| / 2|D|`, so that `R > β·l` exactly when
//! `|N|² > 4β²l²D²`: a flat tetrahedron with `N ≠ 0` is bad for every β.

use glam::DVec3;

use super::exact::{exact_sign, Dyadic, Scalar, Vector};
#[cfg(target_arch = "x86_64")]
use super::lanes::Avx2;
use super::lanes::{Lanes, Portable};
use super::predicates::Sign;

/// The six edges of a tetrahedron as pairs of its slots.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Squared circumradius and squared shortest edge, in floating point. Infinite or NaN radius when flat.
#[inline]
pub fn radius_and_edge_squared(tet: [DVec3; 4]) -> (f64, f64) {
    let (shape, _) = shape(tet);
    (shape.numerator / (4.0 * shape.volume6 * shape.volume6), shape.shortest)
}

/// The radius-edge ratio to about nine digits; infinite when flat. Slivers are common (four samples of one batch may be cocircular but
/// for round-off), and floating point knows nothing of their circumradius: they are computed exactly.
pub fn radius_edge(tet: [DVec3; 4]) -> f64 {
    let (shape, longest) = shape(tet);
    let is_round = shape.volume6.abs() > SLIVER * longest * longest.sqrt()
        && shape.numerator.sqrt() > SLIVER * longest * longest
        && SAFE_SIZES.contains(&longest);
    let radius = if is_round {
        shape.numerator.sqrt() / (2.0 * shape.volume6.abs())
    } else {
        let (numerator, volume6) = numerator_and_volume::<Dyadic>(tet);
        numerator.quotient(&volume6.mul(&volume6)).sqrt() / 2.0
    };
    let ratio = radius / shape.shortest.sqrt();
    if ratio.is_nan() {
        f64::INFINITY
    } else {
        ratio
    }
}

/// Where the quantities of the formula, over the powers of the longest edge, are too small for nine digits: their errors are at most
/// about 60u.
const SLIVER: f64 = 1e-5;

/// Squared lengths for which the floating-point formulas, of degree 8, neither overflow nor lose their error bounds to underflow.
const SAFE_SIZES: std::ops::Range<f64> = 1e-60..1e60;

/// Relative to the powers of the longest edge, the error of the formula's quantities: see [`exceeds_radius_edge`].
const SLACK: f64 = 4e-14;

struct Shape {
    numerator: f64,
    volume6: f64,
    shortest: f64,
}

/// The quantities of the formula above, and the longest edge squared.
#[inline]
fn shape([a, b, c, d]: [DVec3; 4]) -> (Shape, f64) {
    let (u, v, w) = (b - a, c - a, d - a);
    let (vw, wu, uv) = (v.cross(w), w.cross(u), u.cross(v));
    let (uu, vv, ww) = (u.length_squared(), v.length_squared(), w.length_squared());
    let numerator = (uu * vw + vv * wu + ww * uv).length_squared();
    let (bc, bd, cd) = (b.distance_squared(c), b.distance_squared(d), c.distance_squared(d));
    let shortest = uu.min(vv).min(ww).min(bc).min(bd).min(cd);
    let longest = uu.max(vv).max(ww);
    (Shape { numerator, volume6: u.dot(vw), shortest }, longest)
}

/// Whether the tetrahedron's circumradius is more than `bound` times its shortest edge. Exact.
#[inline]
pub fn exceeds_radius_edge(tet: [DVec3; 4], bound: f64) -> bool {
    let (shape, longest) = shape(tet);
    let d2 = shape.volume6 * shape.volume6;
    let left = shape.numerator;
    let right = 4.0 * bound * bound * shape.shortest * d2;
    // Absolute errors, with L² = longest: D is off by at most 20u·L³ and |N| by at most 80u·L⁴, their squares by twice that times the
    // quantity and the square of it; the shortest edge's square by 6u of itself. 360u covers all.
    let slack = SLACK;
    let (scale3, scale4) = (longest * longest.sqrt(), longest * longest);
    let left_error = slack * scale4 * (left.sqrt() + slack * scale4);
    let right_error = slack * scale3 * 4.0 * bound * bound * shape.shortest * (shape.volume6.abs() + slack * scale3);
    if SAFE_SIZES.contains(&longest) {
        if left - right > left_error + right_error {
            return true;
        }
        if right - left > left_error + right_error {
            return false;
        }
    }
    exceeds_exactly(tet, bound)
}

/// Things four at a time, as the predicates below take them: the last ones are filled up, and how many count is said.
#[inline]
pub(crate) fn in_fours(mut all: impl Iterator<Item = u32>) -> impl Iterator<Item = ([u32; 4], usize)> {
    std::iter::from_fn(move || {
        let (mut four, mut count) = ([0; 4], 0);
        for (place, one) in four.iter_mut().zip(&mut all) {
            *place = one;
            count += 1;
        }
        let last = *four[..count].last()?;
        four[count..].fill(last);
        Some((four, count))
    })
}

/// [`exceeds_radius_edge`] of four tetrahedra, a bit for each, and their shortest edges squared, which are those of
/// [`DVec3::distance_squared`] on every machine.
#[inline]
pub fn four_exceed_radius_edge(tets: &[[&DVec3; 4]; 4], bound: f64) -> (u32, [f64; 4]) {
    let (exceed, unsure, shortest) = judge_four(tets, bound);
    let exactly = |i: &usize| unsure >> i & 1 != 0 && exceeds_radius_edge(tets[*i].map(|&p| p), bound);
    let decided = if unsure == 0 { 0 } else { (0..4).filter(exactly).map(|i| 1 << i).sum() };
    (exceed & !unsure | decided, shortest)
}

/// Which of four tetrahedra may have a radius-edge ratio above `ratio`, a bit for each; all others have none.
pub(crate) fn four_may_exceed(tets: &[[&DVec3; 4]; 4], ratio: f64) -> u32 {
    let (exceed, unsure, _) = judge_four(tets, ratio);
    exceed | unsure
}

#[inline]
fn judge_four(tets: &[[&DVec3; 4]; 4], bound: f64) -> (u32, u32, [f64; 4]) {
    #[cfg(target_arch = "x86_64")]
    if Avx2::available() {
        // SAFETY: the processor has what the function is compiled for.
        return unsafe { judge_four_avx2(tets, bound) };
    }
    judge::<Portable>(tets, bound)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn judge_four_avx2(tets: &[[&DVec3; 4]; 4], bound: f64) -> (u32, u32, [f64; 4]) {
    judge::<Avx2>(tets, bound)
}

/// Bits of those that exceed the bound, bits of those that can't be told, and the shortest edges squared.
#[inline(always)]
fn judge<L: Lanes>(tets: &[[&DVec3; 4]; 4], bound: f64) -> (u32, u32, [f64; 4]) {
    let [a, b, c, d] = corners::<L>(tets);
    let (u, v, w) = (difference(b, a), difference(c, a), difference(d, a));
    let (vw, wu, uv) = (cross(v, w), cross(w, u), cross(u, v));
    // Without fused operations, because the lengths are used for more than a decision.
    let (uu, vv, ww) = (squared(u), squared(v), squared(w));
    let shortest =
        uu.min(vv).min(ww).min(squared(difference(c, b))).min(squared(difference(d, b))).min(squared(difference(d, c)));
    let longest = uu.max(vv).max(ww);
    let part = |i: usize| uu.mul_add(vw[i], vv.mul_add(wu[i], ww.mul(uv[i])));
    let (x, y, z) = (part(0), part(1), part(2));
    let left = dot([x, y, z], [x, y, z]);
    let volume6 = dot(u, vw);
    let scale = L::splat(4.0 * bound * bound).mul(shortest);
    let right = scale.mul(volume6).mul(volume6);
    // As in `exceeds_radius_edge`, with |N| ≤ 3L⁴ and |D| ≤ L³, both a little more after rounding.
    let cube = longest.mul(longest).mul(longest);
    let error = L::splat(SLACK).mul(cube).mul(longest.mul(L::splat(3.1)).add(scale.mul(L::splat(1.1))));
    let excess = left.sub(right);
    let exceeds = excess.greater(error);
    let keeps = L::splat(0.0).sub(error).greater(excess);
    let safe = longest.greater(L::splat(SAFE_SIZES.start)) & L::splat(SAFE_SIZES.end).greater(longest);
    (exceeds, !((exceeds | keeps) & safe) & 0b1111, shortest.to_array())
}

/// The first corners of four tetrahedra, the second ones, and so on.
#[inline(always)]
pub(crate) fn corners<L: Lanes>([p, q, r, s]: &[[&DVec3; 4]; 4]) -> [[L; 3]; 4] {
    [
        L::load([p[0], q[0], r[0], s[0]]),
        L::load([p[1], q[1], r[1], s[1]]),
        L::load([p[2], q[2], r[2], s[2]]),
        L::load([p[3], q[3], r[3], s[3]]),
    ]
}

#[inline(always)]
fn dot<L: Lanes>(p: [L; 3], q: [L; 3]) -> L {
    p[0].mul_add(q[0], p[1].mul_add(q[1], p[2].mul(q[2])))
}

#[inline(always)]
pub(crate) fn difference<L: Lanes>(p: [L; 3], q: [L; 3]) -> [L; 3] {
    [p[0].sub(q[0]), p[1].sub(q[1]), p[2].sub(q[2])]
}

#[inline(always)]
fn cross<L: Lanes>(p: [L; 3], q: [L; 3]) -> [L; 3] {
    [p[1].mul_sub(q[2], p[2].mul(q[1])), p[2].mul_sub(q[0], p[0].mul(q[2])), p[0].mul_sub(q[1], p[1].mul(q[0]))]
}

/// The squared length, without fused operations.
#[inline(always)]
pub(crate) fn squared<L: Lanes>(v: [L; 3]) -> L {
    v[0].mul(v[0]).add(v[1].mul(v[1])).add(v[2].mul(v[2]))
}

#[cold]
#[inline(never)]
fn exceeds_exactly(tet: [DVec3; 4], bound: f64) -> bool {
    // R > β·shortest exactly when R > β·l for one of the edges at least.
    EDGES.iter().any(|&[i, j]| exact_sign!(excess(tet, [tet[i], tet[j]], bound)) == Sign::Positive)
}

/// `|N|² − 4β²l²D²` for one edge.
fn excess<T: Scalar>(tet: [DVec3; 4], [p, q]: [DVec3; 2], bound: f64) -> T {
    let (numerator, volume6) = numerator_and_volume::<T>(tet);
    let volume = T::new(2.0 * bound).mul(&volume6);
    numerator.sub(&Vector::<T>::difference(p, q).length_squared().mul(&volume.mul(&volume)))
}

/// `|N|²` and `D`.
fn numerator_and_volume<T: Scalar>([a, b, c, d]: [DVec3; 4]) -> (T, T) {
    let (u, v, w) = (Vector::<T>::difference(b, a), Vector::difference(c, a), Vector::difference(d, a));
    let vw = v.cross(&w);
    let n = vw
        .scale(&u.length_squared())
        .add(&w.cross(&u).scale(&v.length_squared()))
        .add(&u.cross(&v).scale(&w.length_squared()));
    (n.length_squared(), u.dot(&vw))
}

/// The smallest of the six dihedral angles, in degrees; 0 when flat.
pub fn min_dihedral_degrees([a, b, c, d]: [DVec3; 4]) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    // Twice the areas, normal to the faces opposite each corner, all outward or all inward.
    let (nb, nc, nd) = (w.cross(v), u.cross(w), v.cross(u));
    let na = -(nb + nc + nd);
    let volume6 = u.dot(nb).abs();
    // The cotangent falls from 0 to 180 degrees and keeps small angles accurate. Two faces' normals have a cross product of the volume times
    // their edge.
    let cotangent = |n: DVec3, m: DVec3, edge: DVec3| {
        let cotangent = -n.dot(m) / (volume6 * edge.length());
        if cotangent.is_nan() {
            f64::INFINITY
        } else {
            cotangent
        }
    };
    let greatest = cotangent(nc, nd, u)
        .max(cotangent(nb, nd, v))
        .max(cotangent(nb, nc, w))
        .max(cotangent(na, nd, c - b))
        .max(cotangent(na, nc, d - b))
        .max(cotangent(na, nb, d - c));
    1f64.atan2(greatest).to_degrees()
}

/// Which of four tetrahedra may have a dihedral angle smaller than the angle with this cotangent, a bit for each. Says no only where
/// [`min_dihedral_degrees`] is sure to be as large.
#[inline]
pub(crate) fn four_may_be_narrower(tets: &[[&DVec3; 4]; 4], cotangent: f64) -> u32 {
    // Other cotangents don't tell by their squares.
    if cotangent.is_nan() || cotangent <= 0.0 {
        return 0b1111;
    }
    #[cfg(target_arch = "x86_64")]
    if Avx2::available() {
        // SAFETY: the processor has what the function is compiled for.
        return unsafe { four_may_be_narrower_avx2(tets, cotangent) };
    }
    narrower::<Portable>(tets, cotangent)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn four_may_be_narrower_avx2(tets: &[[&DVec3; 4]; 4], cotangent: f64) -> u32 {
    narrower::<Avx2>(tets, cotangent)
}

#[inline(always)]
fn narrower<L: Lanes>(tets: &[[&DVec3; 4]; 4], cotangent: f64) -> u32 {
    let [a, b, c, d] = corners::<L>(tets);
    let (u, v, w) = (difference(b, a), difference(c, a), difference(d, a));
    let (nb, nc, nd) = (cross(w, v), cross(u, w), cross(v, u));
    // That of the fourth face, turned round.
    let na = [nb[0].add(nc[0]).add(nd[0]), nb[1].add(nc[1]).add(nd[1]), nb[2].add(nc[2]).add(nd[2])];
    let volume6 = dot(u, nb);
    let limit = volume6.mul(volume6).mul(L::splat(cotangent * cotangent * (1.0 - 1e-9)));
    let zero = L::splat(0.0);
    // What is no number is greater than nothing.
    let all = limit.greater(zero)
        & wide(dot(nc, nd), limit, u)
        & wide(dot(nb, nd), limit, v)
        & wide(dot(nb, nc), limit, w)
        & wide(zero.sub(dot(na, nd)), limit, difference(c, b))
        & wide(zero.sub(dot(na, nc)), limit, difference(d, b))
        & wide(zero.sub(dot(na, nb)), limit, difference(d, c));
    !all & 0b1111
}

/// Whether the angle between two faces with this product of normals is surely wide.
#[inline(always)]
fn wide<L: Lanes>(dot: L, limit: L, edge: [L; 3]) -> u32 {
    dot.greater(L::splat(0.0)) | limit.mul(squared(edge)).greater(dot.mul(dot))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn regular() -> [DVec3; 4] {
        [[0., 0., 0.], [1., 1., 0.], [1., 0., 1.], [0., 1., 1.]].map(DVec3::from)
    }

    #[test]
    fn regular_tetrahedron() {
        let t = regular();
        assert!((radius_edge(t) - (3f64 / 8.0).sqrt()).abs() < 1e-15);
        assert!((min_dihedral_degrees(t) - (1f64 / 3.0).acos().to_degrees()).abs() < 1e-12);
        assert!(!exceeds_radius_edge(t, 1.0));
    }

    #[test]
    fn four_at_a_time_are_as_one_by_one() {
        let mut next = crate::samples::numbers(7);
        let corner_of_box = |leg: f64| [[0., 0., 0.], [1., 0., 0.], [0., 2., 0.], [0., 0., leg]].map(DVec3::from);
        for turn in 0..4000 {
            let scale = 2f64.powi(turn % 400 - 200);
            let mut tets: [[DVec3; 4]; 4] =
                std::array::from_fn(|_| std::array::from_fn(|_| DVec3::new(next(), next(), next()) * scale));
            // One at the bound, or next to it, one nearly flat, one flat.
            tets[0] = corner_of_box(f64::from_bits(2f64.to_bits() + turn as u64 % 5 - 2)).map(|p| p * scale);
            tets[1][3] = tets[1][0] + (tets[1][1] - tets[1][0]) * next() + (tets[1][2] - tets[1][0]) * next();
            tets[2].iter_mut().for_each(|p| p.z = scale);
            for bound in [1.0, 1.5, 2.0, 8.0] {
                let (exceed, shortest) = four_exceed_radius_edge(&tets.each_ref().map(|tet| tet.each_ref()), bound);
                for (i, tet) in tets.iter().enumerate() {
                    assert_eq!(exceed >> i & 1 != 0, exceeds_radius_edge(*tet, bound), "{tet:?}");
                    let least =
                        EDGES.iter().map(|&[i, j]| tet[i].distance_squared(tet[j])).fold(f64::INFINITY, f64::min);
                    assert_eq!(shortest[i], least);
                }
            }
        }
    }

    #[test]
    fn equality_is_not_excess() {
        // The corner of a cube: R² = 3/4, l² = 1. β² = 3/4 has no exact β: take a box with R = 1.5, l = 1.
        let t = [[0., 0., 0.], [1., 0., 0.], [0., 2., 0.], [0., 0., 2.]].map(DVec3::from);
        assert!(!exceeds_radius_edge(t, 1.5));
        assert!(exceeds_radius_edge(t, f64::from_bits(1.5f64.to_bits() - 1)));
    }

    #[test]
    fn slivers_have_the_radius_of_their_circle() {
        // Four points of a circle of radius 5, one of them a unit in the last place off its plane.
        let off = f64::from_bits(1f64.to_bits() + 1);
        let sliver = [[3., 4., 1.], [-4., 3., 1.], [-3., -4., 1.], [4., -3., off]].map(DVec3::from);
        assert!((radius_edge(sliver) - 5.0 / 50f64.sqrt()).abs() < 1e-12);
        // Off the circle too, by more than off its plane: the circumsphere is about as large as the ratio of the two.
        let large = [[3., 4., 1.], [-4., 3., 1.], [-3., -4., 1.], [4.5, -3., off]].map(DVec3::from);
        assert!(radius_edge(large) > 1e14);
    }

    #[test]
    fn the_answer_does_not_depend_on_the_scale() {
        // Nearly at the bound: of the corner of a box with R = 1.5 one leg is longer by a few ulps, at scales from tiny to huge.
        for exponent in [-142, -130, -60, -20, -7, 0, 9, 33, 90, 190] {
            let s = 2f64.powi(exponent);
            for ulps in -3i64..=3 {
                let leg = f64::from_bits((2f64.to_bits() as i64 + ulps) as u64);
                let t = [[0., 0., 0.], [1., 0., 0.], [0., 2., 0.], [0., 0., leg]].map(|p| DVec3::from(p) * s);
                assert_eq!(exceeds_radius_edge(t, 1.5), ulps > 0, "2^{exponent}, {ulps} ulps");
                assert!((radius_edge(t) - 1.5).abs() < 1e-9);
                // Once more as a sliver's worst case: moved so that differences round.
                let moved = t.map(|p| p + DVec3::splat(s / 3.0));
                let exact = EDGES
                    .iter()
                    .any(|&[i, j]| excess::<Dyadic>(moved, [moved[i], moved[j]], 1.5).sign() == Some(Sign::Positive));
                assert_eq!(exceeds_radius_edge(moved, 1.5), exact);
            }
        }
    }

    #[test]
    fn flat_tetrahedra() {
        let flat = [[0., 0., 0.], [1., 0., 0.], [2., 1., 0.], [0., 4., 0.]].map(DVec3::from);
        assert!(exceeds_radius_edge(flat, 1e6));
        assert_eq!(radius_edge(flat), f64::INFINITY);
        assert_eq!(min_dihedral_degrees(flat), 0.0);
        // Flat and cocircular: no sphere is the circumsphere, N = 0 and D = 0, no excess.
        let square = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]].map(DVec3::from);
        assert!(!exceeds_radius_edge(square, 1.0));
    }
}
