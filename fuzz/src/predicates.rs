//! The predicates against exact rationals. All coordinates are multiples of one power of two: with that as their common denominator,
//! rationals are whole numbers, and no fraction ever has to be reduced.

use num_bigint::{BigInt, Sign as BigSign};
use wellspaced::geometry::encroachment::{encroaches_facet, encroaches_segment};
use wellspaced::geometry::perturbation::in_conflict;
use wellspaced::geometry::predicates::{collinear, insphere, orient2d, orient3d};
use wellspaced::geometry::quality::{exceeds_radius_edge, four_exceed_radius_edge, radius_edge, EDGES};
use wellspaced::geometry::{Filter, Sign};
use wellspaced::DVec3;

use crate::bytes::{Bytes, Grid};

/// All coordinates are multiples of 2 to this: that of the last bit of the smallest magnitude.
const UNIT: i32 = -142 - 52;

type Exact = [BigInt; 3];

/// A multiple of `2^unit` as its whole number of units.
fn exact_number(x: f64, unit: i32) -> BigInt {
    if x == 0.0 {
        return BigInt::ZERO;
    }
    let bits = x.to_bits();
    let mantissa = BigInt::from(bits & ((1 << 52) - 1) | 1 << 52);
    let exponent = (bits >> 52 & 0x7ff) as i32 - 1075 - unit;
    // The last bits may be zeros below the unit.
    let magnitude = if exponent >= 0 { mantissa << exponent } else { mantissa >> -exponent };
    if x < 0.0 {
        -magnitude
    } else {
        magnitude
    }
}

fn exact(p: DVec3) -> Exact {
    p.to_array().map(|x| exact_number(x, UNIT))
}

fn sub(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn dot(a: &Exact, b: &Exact) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|i| &a[(i + 1) % 3] * &b[(i + 2) % 3] - &a[(i + 2) % 3] * &b[(i + 1) % 3])
}

fn scale(a: &Exact, s: &BigInt) -> Exact {
    std::array::from_fn(|i| &a[i] * s)
}

fn add(a: &Exact, b: &Exact) -> Exact {
    std::array::from_fn(|i| &a[i] + &b[i])
}

fn sign(x: &BigInt) -> Sign {
    match x.sign() {
        BigSign::Minus => Sign::Negative,
        BigSign::NoSign => Sign::Zero,
        BigSign::Plus => Sign::Positive,
    }
}

/// `det[b−a, c−a, d−a]`.
fn volume(a: &Exact, b: &Exact, c: &Exact, d: &Exact) -> BigInt {
    dot(&sub(b, a), &cross(&sub(c, a), &sub(d, a)))
}

/// Positive where `p` is inside the sphere of a positive tetrahedron.
fn sphere(a: &Exact, b: &Exact, c: &Exact, d: &Exact, p: &Exact) -> BigInt {
    let [a, b, c, d] = [a, b, c, d].map(|q| sub(q, p));
    let lift = [&a, &b, &c, &d].map(|q| dot(q, q));
    let det = |x: &Exact, y: &Exact, z: &Exact| dot(x, &cross(y, z));
    // The lifted determinant, developed by its last column: for a point inside the tetrahedron all terms are positive.
    &lift[0] * det(&b, &c, &d) - &lift[1] * det(&a, &c, &d) + &lift[2] * det(&a, &b, &d) - &lift[3] * det(&a, &b, &c)
}

pub fn run(data: &[u8]) {
    let mut bytes = Bytes(data);
    while !bytes.is_empty() {
        let grid = Grid::of(&mut bytes);
        let mut points: [DVec3; 5] = std::array::from_fn(|_| grid.point(&mut bytes));
        // Now and then the last is made of the others, so that it is near their plane or sphere.
        let made = match bytes.byte() % 6 {
            0 => points[0] + points[1] - points[2],
            1 => (points[0] + points[1]) * 0.5,
            2 => points[3] + (points[1] - points[0]) * 3.0,
            _ => points[4],
        };
        if wellspaced::geometry::check_range(0, made).is_ok() {
            points[4] = made;
        }
        let bound = match bytes.byte() {
            byte @ 0..=127 => 0.75 + f64::from(byte) / 32.0,
            byte => f64::from(byte),
        };
        check(points, bound);
    }
}

fn check([a, b, c, d, e]: [DVec3; 5], bound: f64) {
    let points = [a, b, c, d, e];
    let x = points.map(exact);
    let filter = Filter::for_points(&points);

    let volumes = [(a, b, c, d, [0, 1, 2, 3]), (b, c, d, e, [1, 2, 3, 4]), (e, a, c, b, [4, 0, 2, 1])];
    for (a, b, c, d, [i, j, k, l]) in volumes {
        let expected = sign(&volume(&x[i], &x[j], &x[k], &x[l]));
        assert_eq!(orient3d(a, b, c, d), expected, "orient3d {:?}", [a, b, c, d]);
        assert_eq!(filter.orient3d(a, b, c, d), expected, "Filter::orient3d {points:?}: {:?}", [a, b, c, d]);
    }
    for axis in 0..3 {
        let normal = cross(&sub(&x[1], &x[0]), &sub(&x[2], &x[0]));
        assert_eq!(orient2d(axis, a, b, c), sign(&normal[axis]), "orient2d {axis} {:?}", [a, b, c]);
    }
    let line = cross(&sub(&x[1], &x[0]), &sub(&x[4], &x[0])).iter().all(|x| x.sign() == BigSign::NoSign);
    assert_eq!(collinear(a, b, e), line, "collinear {:?}", [a, b, e]);

    // A ball of a segment and of a triangle.
    let apex = dot(&sub(&x[0], &x[4]), &sub(&x[1], &x[4]));
    assert_eq!(encroaches_segment([a, b], e), apex.sign() == BigSign::Minus, "encroaches_segment {:?}", [a, b, e]);
    let (u, v, w) = (sub(&x[1], &x[0]), sub(&x[2], &x[0]), sub(&x[4], &x[0]));
    let n = cross(&u, &v);
    let nn = dot(&n, &n);
    if nn.sign() == BigSign::Plus {
        // The centre is a + m / 2 |n|².
        let m = cross(&sub(&scale(&v, &dot(&u, &u)), &scale(&u, &dot(&v, &v))), &n);
        let excess = dot(&w, &w) * &nn - dot(&w, &m);
        assert_eq!(
            encroaches_facet([a, b, c], e),
            excess.sign() == BigSign::Minus,
            "encroaches_facet {:?}",
            [a, b, c, e]
        );
    }

    let six_volumes = volume(&x[0], &x[1], &x[2], &x[3]);
    let (tet, y) = match six_volumes.sign() {
        BigSign::Plus => ([a, b, c, d], [&x[0], &x[1], &x[2], &x[3]]),
        BigSign::Minus => ([b, a, c, d], [&x[1], &x[0], &x[2], &x[3]]),
        // Flat ones have no sphere, and are never asked about.
        BigSign::NoSign => return,
    };
    let expected = sign(&sphere(y[0], y[1], y[2], y[3], &x[4]));
    let [p, q, r, s] = tet;
    assert_eq!(insphere(p, q, r, s, e), expected, "insphere {tet:?} {e:?}");
    assert_eq!(filter.insphere(p, q, r, s, e), expected, "Filter::insphere {tet:?} {e:?}");
    if !tet.contains(&e) {
        let conflict = in_conflict(&filter, tet, e);
        if expected != Sign::Zero {
            assert_eq!(conflict, expected == Sign::Positive, "in_conflict {tet:?} {e:?}");
        }
        // The same tetrahedron, told in another order.
        assert_eq!(in_conflict(&filter, [q, r, p, s], e), conflict, "in_conflict turned {tet:?} {e:?}");
        assert_eq!(in_conflict(&filter, [s, r, q, p], e), conflict, "in_conflict turned {tet:?} {e:?}");
    }
    quality(tet, y, bound);
}

/// `R² > β² l²`, where `R = |N| / 2D` with `D` six volumes and `N = |u|² v×w + |v|² w×u + |w|² u×v`.
fn quality(tet: [DVec3; 4], y: [&Exact; 4], bound: f64) {
    let [u, v, w] = [1, 2, 3].map(|i| sub(y[i], y[0]));
    let parts = [(&u, &v, &w), (&v, &w, &u), (&w, &u, &v)].map(|(a, b, c)| scale(&cross(b, c), &dot(a, a)));
    let n = add(&add(&parts[0], &parts[1]), &parts[2]);
    let d = dot(&u, &cross(&v, &w));
    let lengths = EDGES.map(|[i, j]| {
        let edge = sub(y[i], y[j]);
        dot(&edge, &edge)
    });
    let shortest = lengths.iter().min().expect("six edges");
    // The bound in units of 2^-60.
    let (beta, beta_unit) = (exact_number(bound, -60), BigInt::from(1) << 120);
    let left = dot(&n, &n) * beta_unit;
    let right = BigInt::from(4) * &d * &d * &beta * &beta * shortest;
    let expected = left > right;
    assert_eq!(exceeds_radius_edge(tet, bound), expected, "exceeds_radius_edge {tet:?} {bound}");
    let turned = [tet[2], tet[0], tet[1], tet[3]];
    let four = [tet, turned, tet, turned];
    let (bad, shortest) = four_exceed_radius_edge(&four.each_ref().map(|t| t.each_ref()), bound);
    assert_eq!(bad, if expected { 15 } else { 0 }, "four_exceed_radius_edge {tet:?} {bound}");
    assert!(shortest[0] == shortest[2] && shortest[1] == shortest[3], "{shortest:?} {tet:?}");
    let ratio = radius_edge(tet);
    let agrees = if expected { ratio >= bound * (1.0 - 1e-8) } else { ratio <= bound * (1.0 + 1e-8) };
    assert!(agrees, "radius_edge {ratio} of {tet:?} and {bound}");
}
