//! The five data sets of the paper's table, rebuilt as recipes (its files were never published), and two more of ours. Each is a cube of
//! eight corners and six facets with points inside.
//!
//! The same name and seed give the same bytes on every platform: the generator is value-stable, its numbers become
//! reals by hand, and sines and cosines come from `libm`, not from the system.

use clap::ValueEnum;
use glam::DVec3;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use wellspaced::Plc;

/// A data set of the paper, or one of ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Dataset {
    /// Two points at unit distance in a cube of side 100,000
    Cube1,
    /// Eight groups of three points at unit distance in a cube of side 1,000
    Cube8,
    /// 10,000 points on an ellipsoid
    Ellipsoid,
    /// Two near strands of 500 points each
    Helix,
    /// 10,000 points in a cube
    Random,
    /// Not the paper's: 100,000 points in a cube, which they fill
    Uniform,
    /// Not the paper's: 10,000 points whose spacing grows with their distance from the centre, a million times in all
    Graded,
}

impl Dataset {
    /// The paper's, in the order of its table.
    pub const ALL: [Dataset; 5] = [Dataset::Cube1, Dataset::Cube8, Dataset::Ellipsoid, Dataset::Helix, Dataset::Random];

    /// Ours.
    pub const MORE: [Dataset; 2] = [Dataset::Uniform, Dataset::Graded];

    /// The name on the command line and of its file.
    pub fn name(self) -> &'static str {
        match self {
            Dataset::Cube1 => "cube1",
            Dataset::Cube8 => "cube8",
            Dataset::Ellipsoid => "ellipsoid",
            Dataset::Helix => "helix",
            Dataset::Random => "random",
            Dataset::Uniform => "uniform",
            Dataset::Graded => "graded",
        }
    }

    /// The name in the paper.
    pub fn title(self) -> &'static str {
        match self {
            Dataset::Cube1 => "Cube1",
            Dataset::Cube8 => "Cube8",
            Dataset::Ellipsoid => "Ellipsoid",
            Dataset::Helix => "Helix",
            Dataset::Random => "Random",
            Dataset::Uniform => "Uniform",
            Dataset::Graded => "Graded",
        }
    }

    /// The domain. `seed` only matters to the random ones: all but Cube1 and Helix.
    pub fn build(self, seed: u64) -> Plc {
        let mut random = Random::new(seed);
        let (half, points) = match self {
            Dataset::Cube1 => (50_000.0, vec![DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0)]),
            Dataset::Cube8 => (500.0, cube8(&mut random)),
            Dataset::Ellipsoid => (1.0, (0..10_000).map(|_| on_ellipsoid(&mut random)).collect()),
            Dataset::Helix => (1.0, helix()),
            Dataset::Random => (1.5, (0..10_000).map(|_| random.in_cube()).collect()),
            Dataset::Uniform => (1.0, (0..100_000).map(|_| random.in_cube()).collect()),
            Dataset::Graded => (1.0, (0..10_000).map(|_| graded(&mut random)).collect()),
        };
        Plc::boxed(DVec3::splat(-half), DVec3::splat(half), points)
    }
}

/// At 0.7 × each corner that point and two at unit distance from it in random directions.
fn cube8(random: &mut Random) -> Vec<DVec3> {
    let mut points = Vec::with_capacity(24);
    for corner in 0..8 {
        let side = |bit: u32| if corner >> bit & 1 == 0 { -350.0 } else { 350.0 };
        let centre = DVec3::new(side(0), side(1), side(2));
        points.push(centre);
        points.push(centre + random.direction());
        points.push(centre + random.direction());
    }
    points
}

/// A point in a random direction whose distance from the centre is anything from 2⁻²⁰ to 1 by its logarithm.
fn graded(random: &mut Random) -> DVec3 {
    let distance = libm::exp2(-20.0 * random.unit());
    distance * random.direction()
}

const SEMI_AXES: DVec3 = DVec3::new(0.8, 0.5, 0.35);

/// A point uniform on the ellipsoid's surface.
fn on_ellipsoid(random: &mut Random) -> DVec3 {
    let DVec3 { x: a, y: b, z: c } = SEMI_AXES;
    loop {
        // Stretching the unit sphere to the ellipsoid makes a patch around u grow by |(bc, ac, ab)·u|, which is at
        // most ab as c is the least axis: a uniform direction is kept with the chance of that over ab.
        let u = random.direction();
        let growth = (DVec3::new(b * c, a * c, a * b) * u).length();
        if random.unit() * (a * b) < growth {
            return SEMI_AXES * u;
        }
    }
}

/// Two strands of 500 points around the z axis, ten turns, the second 0.005 rad ahead.
fn helix() -> Vec<DVec3> {
    let strand = |ahead: f64| {
        (0..500).map(move |i| {
            let t = if i == 499 { 1.0 } else { f64::from(i) * (1.0 / 499.0) };
            let angle = 20.0 * std::f64::consts::PI * t + ahead;
            DVec3::new(0.3 * libm::cos(angle), 0.3 * libm::sin(angle), 1.6 * t - 0.8)
        })
    };
    strand(0.0).chain(strand(0.005)).collect()
}

/// Random numbers that are the same everywhere.
struct Random(ChaCha8Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Random(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in [0, 1), a multiple of 2⁻⁵³.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in [−1, 1)³.
    fn in_cube(&mut self) -> DVec3 {
        let mut coordinate = || 2.0 * self.unit() - 1.0;
        DVec3::new(coordinate(), coordinate(), coordinate())
    }

    /// Uniform on the unit sphere: a point of the ball, pushed out.
    fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.in_cube();
            let square = point.length_squared();
            if (1e-4..=1.0).contains(&square) {
                return point / square.sqrt();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::write_poly;

    /// FNV-1a of the file, to notice any change of a single bit.
    fn hash(dataset: Dataset, seed: u64) -> u64 {
        let mut bytes = Vec::new();
        write_poly(&mut bytes, &dataset.build(seed)).unwrap();
        bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &b| (hash ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
    }

    #[test]
    fn counts_are_the_papers() {
        for (dataset, count) in Dataset::ALL.into_iter().zip([10, 32, 10_008, 1_008, 10_008]) {
            let plc = dataset.build(1);
            assert_eq!((plc.points.len(), plc.facets.len()), (count, 6), "{}", dataset.name());
            let inside = |p: &DVec3| p.abs().max_element() < plc.points[7].x;
            assert!(plc.points[8..].iter().all(inside), "{}", dataset.name());
        }
    }

    #[test]
    fn ours_are_as_described() {
        assert_eq!(Dataset::Uniform.build(1).points.len(), 100_008);
        let points = &Dataset::Graded.build(1).points[8..];
        let distance = |p: &DVec3| p.length();
        let (low, high) = points.iter().map(distance).fold((1f64, 0f64), |(l, h), d| (l.min(d), h.max(d)));
        assert!(low < 1e-6 * 1.05 && high > 0.99 && high < 1.0 + 1e-15, "{low} {high}");
        let far = points.iter().filter(|p| p.length() > 1e-3).count();
        assert!((4_800..5_200).contains(&far), "{far}");
    }

    #[test]
    fn the_ellipsoid_is_one_and_uniform() {
        let points = &Dataset::Ellipsoid.build(3).points[8..];
        let on = |p: &DVec3| ((*p / SEMI_AXES).length() - 1.0).abs() < 1e-15;
        assert!(points.iter().all(on));
        // The zone |x| < a/2 is half of a sphere's area, but not of the ellipsoid's.
        let share = points.iter().filter(|p| p.x.abs() < 0.4).count() as f64 / points.len() as f64;
        assert!((share - zone()).abs() < 0.02, "{share} {}", zone());
        assert!((zone() - 0.5).abs() > 0.03, "a stretched uniform sphere would pass too");
    }

    /// The share of the ellipsoid's area with |x| < a/2, by the midpoint rule over the sphere.
    fn zone() -> f64 {
        let DVec3 { x: a, y: b, z: c } = SEMI_AXES;
        let (mut part, mut whole) = (0.0, 0.0);
        for i in 0..400 {
            for j in 0..400 {
                let x = -1.0 + (f64::from(i) + 0.5) / 200.0;
                let angle = std::f64::consts::TAU * (f64::from(j) + 0.5) / 400.0;
                let r = (1.0 - x * x).sqrt();
                let area = (DVec3::new(b * c, a * c, a * b) * DVec3::new(x, r * angle.cos(), r * angle.sin())).length();
                whole += area;
                part += if x.abs() < 0.5 { area } else { 0.0 };
            }
        }
        part / whole
    }

    #[test]
    fn groups_of_cube8_are_at_unit_distance() {
        for group in Dataset::Cube8.build(9).points[8..].chunks(3) {
            assert!(group[0].abs() == DVec3::splat(350.0));
            assert!(group[1..].iter().all(|p| (p.distance(group[0]) - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn the_helix_turns_ten_times() {
        let points = &Dataset::Helix.build(1).points[8..];
        // First, second and last of the first strand, first of the second.
        for (place, expected) in [
            (0, [0.3, 0.0, -0.8]),
            (1, [0.2976249321157602, 0.037674922469583594, -0.7967935871743488]),
            (499, [0.3, 0.0, 0.8]),
            (500, [0.2999962500078125, 0.0014999937500078124, -0.8]),
        ] {
            assert!(points[place].distance(expected.into()) < 1e-15, "{place}: {}", points[place]);
        }
    }

    #[test]
    fn the_seed_decides_and_nothing_else() {
        for dataset in [Dataset::Cube8, Dataset::Ellipsoid, Dataset::Random] {
            assert_eq!(dataset.build(5), dataset.build(5));
            assert_ne!(dataset.build(5), dataset.build(6));
        }
        assert_eq!(Dataset::Helix.build(5), Dataset::Helix.build(6));
    }

    #[test]
    fn the_bytes_never_change() {
        let hashes = Dataset::ALL.map(|dataset| hash(dataset, 1));
        let expected = [
            0xa0c2_b028_477c_db7d,
            0x4301_a78f_d701_c7fa,
            0x9b9a_98d1_c0b2_23e8,
            0x3f30_3d74_9148_10f3,
            0x14d5_8d10_31f7_e5e7,
        ];
        assert_eq!(hashes, expected, "{hashes:#x?}");
    }
}
