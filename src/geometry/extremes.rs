//! The worst radius-edge ratio and the least dihedral angle of many tetrahedra. Few of them can be the worst so far: of all others a comparison
//! says so, without roots, divisions and arcs.

use glam::DVec3;

use super::quality::{four_may_be_narrower, four_may_exceed, min_dihedral_degrees, radius_edge};

/// The extremes of the tetrahedra added.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extremes {
    /// The greatest radius-edge ratio; 0 of none.
    pub radius_edge: f64,
    /// The least dihedral angle; 180 of none.
    pub dihedral_degrees: f64,
    cotangent: f64,
}

impl Default for Extremes {
    fn default() -> Self {
        Extremes { radius_edge: 0.0, dihedral_degrees: 180.0, cotangent: f64::NEG_INFINITY }
    }
}

impl Extremes {
    /// Adds four tetrahedra, one of them several times perhaps. Returns a bit for each that may have a greater radius-edge ratio than all before;
    /// the others have none.
    #[inline]
    pub fn add(&mut self, tets: &[[&DVec3; 4]; 4]) -> u32 {
        let worse = four_may_exceed(tets, self.radius_edge);
        let narrower = four_may_be_narrower(tets, self.cotangent);
        if worse | narrower == 0 {
            return 0;
        }
        for (i, tet) in tets.iter().enumerate() {
            let corners = tet.map(|&p| p);
            if worse >> i & 1 != 0 {
                self.radius_edge = self.radius_edge.max(radius_edge(corners));
            }
            if narrower >> i & 1 != 0 {
                self.dihedral_degrees = self.dihedral_degrees.min(min_dihedral_degrees(corners));
                self.cotangent = self.dihedral_degrees.to_radians().tan().recip();
            }
        }
        worse
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extremes_are_those_of_all() {
        let mut next = crate::samples::numbers(11);
        let mut tets: Vec<[DVec3; 4]> =
            (0..2000).map(|_| std::array::from_fn(|_| DVec3::new(next(), next(), next()))).collect();
        // Right angles, which have the cotangent 0, and one without volume.
        tets.insert(0, [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]);
        tets.insert(1000, [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.25, 0.25, 0.0)]);
        for until in [1, 1000, 1001, tets.len()] {
            let mut extremes = Extremes::default();
            for four in tets[..until].chunks(4) {
                extremes.add(&std::array::from_fn(|i| four[i.min(four.len() - 1)].each_ref()));
            }
            let worst = tets[..until].iter().map(|&tet| radius_edge(tet)).fold(0.0, f64::max);
            let narrowest = tets[..until].iter().map(|&tet| min_dihedral_degrees(tet)).fold(180.0, f64::min);
            assert_eq!((extremes.radius_edge, extremes.dihedral_degrees), (worst, narrowest), "{until}");
        }
    }
}
