//! Steiner batches as in §4 of Jampani and Üngör: the arc that bounds a component is cut into equal pieces of angle θ, and each
//! sample is placed so that its bisector with `p` meets the facet's plane exactly in the chord of its piece.
//!
//! Deviation: the paper's remedy for samples beyond the facet is followed when it keeps the distances, and when not, the one
//! sample that lies farthest from the edge is taken.

use glam::DVec3;

use super::facet::{Arc, VoronoiFacet};
use super::Samples;

/// Samples are drawn towards the midpoint by this share of their distance, so that rounding doesn't leave the new
/// Voronoi corners just outside the disk.
pub(super) const PULL: f64 = 1.0 / (1u64 << 30) as f64;

/// How many samples an arc gets: 1 below a right angle, then ⌊4γ/π⌋.
pub fn sample_count(span: f64) -> usize {
    if span < std::f64::consts::FRAC_PI_2 {
        1
    } else {
        (4.0 * span / std::f64::consts::PI).floor() as usize
    }
}

/// Distance from the midpoint at which a sample's bisector cuts the rim in a chord of angle θ:
/// `x + cos(θ/2)·Rc` with `x = sqrt(cos²(θ/2)(β² − ¼) + ¼)·|pq|`.
pub fn sample_distance(theta: f64, length: f64, radius_edge: f64) -> f64 {
    let core = (radius_edge * radius_edge - 0.25).max(0.0).sqrt();
    let chord = (0.5 * theta).cos() * core;
    ((chord * chord + 0.25).sqrt() + chord) * length
}

/// The batch for one arc.
pub fn sample_arc(facet: &VoronoiFacet, arc: Arc, radius_edge: f64) -> Samples {
    sample_pieces(facet, arc, sample_count(arc.span), 0.0, radius_edge)
}

/// The batch for one arc cut into `count` pieces, each sample placed as if its piece had at least the angle `min_theta`.
pub(super) fn sample_pieces(facet: &VoronoiFacet, arc: Arc, count: usize, min_theta: f64, radius_edge: f64) -> Samples {
    let theta = arc.span / count as f64;
    let distance = sample_distance(theta.max(min_theta), facet.length, radius_edge) * (1.0 - PULL);
    let placed: Vec<(f64, DVec3)> = (0..count)
        .map(|i| {
            let angle = arc.start + (i as f64 + 0.5) * theta;
            // Beyond the facet other vertices are nearer than the edge: stop where the ray leaves it.
            let distance = distance.min(facet.exit(angle));
            (distance, facet.point(angle, distance))
        })
        .collect();
    let samples = |points| Samples { points, span: arc.span, theta };
    if keep_distance(&placed, radius_edge * facet.length) {
        return samples(placed.into_iter().map(|(_, point)| point).collect());
    }
    let farthest = placed.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    samples(farthest.map(|(_, point)| point).into_iter().collect())
}

/// Whether all samples are at least `least` apart (Lemma 2), but for rounding.
fn keep_distance(placed: &[(f64, DVec3)], least: f64) -> bool {
    let least = least * (1.0 - 1e-9);
    placed
        .iter()
        .enumerate()
        .all(|(i, (_, a))| placed[i + 1..].iter().all(|(_, b)| a.distance_squared(*b) >= least * least))
}
