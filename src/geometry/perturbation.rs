//! The symbolic perturbation of O. Devillers and M. Teillaud, "Perturbations and vertex removal in a 3D
//! Delaunay triangulation", SODA 2003: it decides cospherical points so that the Delaunay
//! triangulation of any point set is unique and depends on no order of insertion.
//!
//! Each point's height on the lifting paraboloid is raised by its own infinitesimal, and the
//! lexicographically greater a point is, the greater its infinitesimal. The in-sphere determinant
//! becomes a polynomial in them; its first coefficient that doesn't vanish gives the sign. The coefficient of a
//! point is (up to sign) the orientation of the other four.

use glam::DVec3;

use super::predicates::{Filter, Sign};

/// Whether `a` comes after `b` in the lexicographic order of points, x first. Without branches: on grids any comparison
/// may settle it.
#[inline]
fn after(a: DVec3, b: DVec3) -> bool {
    (a.x > b.x) | (a.x == b.x) & ((a.y > b.y) | (a.y == b.y) & (a.z > b.z))
}

/// Where `p` lies to the circumsphere of the positive tetrahedron `tet`: whether inside, after perturbation.
/// `p` must differ from the four corners.
#[inline]
pub fn in_conflict(filter: &Filter, tet: [DVec3; 4], p: DVec3) -> bool {
    match filter.insphere(tet[0], tet[1], tet[2], tet[3], p) {
        Sign::Positive => true,
        Sign::Negative => false,
        Sign::Zero => perturbed(filter, tet, p),
    }
}

/// The decision for five cospherical points, `tet` a positive tetrahedron.
#[inline(never)]
pub fn perturbed(filter: &Filter, tet: [DVec3; 4], p: DVec3) -> bool {
    // How many corners come after p, and after each corner: the order of raising, the last one in lexicographic order first.
    let above: usize = tet.iter().map(|&corner| usize::from(after(corner, p))).sum();
    let mut rank = [0usize; 4];
    for j in 1..4 {
        for i in 0..j {
            let first = usize::from(after(tet[i], tet[j]));
            rank[j] += first;
            rank[i] += 1 - first;
        }
    }
    let mut order = [0; 4];
    for (corner, rank) in rank.into_iter().enumerate() {
        order[rank & 3] = corner;
    }
    // `[i, j, k, l]` is an even permutation for each i.
    const EVEN: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
    for &slot in &order[..above] {
        // Raising corner `slot` moves p inside where p can replace the corner in a positive tetrahedron.
        let [j, k, l] = EVEN[slot];
        match filter.orient3d(p, tet[j], tet[k], tet[l]) {
            Sign::Positive => return true,
            Sign::Negative => return false,
            Sign::Zero => {}
        }
    }
    // Raising p lifts it out of the sphere: the coefficient is the tetrahedron's orientation.
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cube_has_one_answer_from_every_tetrahedron_order() {
        // Even permutations describe the same tetrahedron: the answer may not depend on them.
        let corners: Vec<DVec3> =
            (0..8).map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64)).collect();
        let filter = Filter::for_points(&corners);
        let even = [[0, 1, 2, 3], [1, 2, 0, 3], [2, 0, 1, 3], [1, 0, 3, 2], [3, 2, 1, 0], [0, 3, 1, 2], [2, 3, 0, 1]];
        for quad in 0..70u32 {
            let ids: Vec<usize> = (0..8).filter(|&i| combination(quad) >> i & 1 == 1).collect();
            let mut tet = [corners[ids[0]], corners[ids[1]], corners[ids[2]], corners[ids[3]]];
            match filter.orient3d(tet[0], tet[1], tet[2], tet[3]) {
                Sign::Zero => continue,
                Sign::Negative => tet.swap(0, 1),
                Sign::Positive => {}
            }
            for &p in corners.iter().filter(|p| !tet.contains(p)) {
                let answer = in_conflict(&filter, tet, p);
                for e in even {
                    assert_eq!(in_conflict(&filter, e.map(|i| tet[i]), p), answer);
                }
            }
        }
    }

    /// The `n`-th of the 70 bit sets of four among eight.
    fn combination(n: u32) -> u32 {
        (0..256).filter(|bits: &u32| bits.count_ones() == 4).nth(n as usize).unwrap()
    }
}
