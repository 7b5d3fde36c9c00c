//! Fewer and wider pieces than the paper's: our own rule.
//!
//! A sample on the ray through the middle of an arc of angle θ at distance `d(θ)` cuts the facet in the arc's chord (see
//! [`paper`](super::paper)). Its distance from `p` and `q`, `ψ(θ) = sqrt(d² + ¼)` edge lengths, falls with θ; the distance between neighbours in a
//! batch, `2 sin(θ/2)·d(θ)`, first grows. A wide piece saves a sample now, a narrow one places its samples farther out, which saves
//! samples later, as edges grow faster away from small features. The paper's pieces of 45° to 90° lean to the second. Two
//! observations on all data sets lead to the other side:
//! - a batch is sparsest over the whole refinement with pieces near 84°: `count = round(γ / 84°)`;
//! - a lone sample of a narrow arc does not gain from going out to `d(γ)`. There it cuts off the arc and nothing else, and the corner that it
//!   makes lies on the very rim, where the next sample nearby tips it out. So no sample goes farther than `d(80°)`.
//!
//! What is kept, as in Lemmas 1 and 2: a lone piece has θ < 126°, more have θ ≤ 105°, so every sample is at least `ψ(126°) > |pq|` from every
//! vertex for all β ≥ 1 (1.14 for β = 1, 1.95 for β = 2, or β itself where the facet ends before), and the samples of a batch are at least
//! β apart. New edges are longer than the edge they mend, so refinement ends by the same packing argument.

//!
//! Where [`sparsify`](crate::sparsify) puts one sample in the place of two right away, still wider pieces are better: the places are chosen anew
//! there, with more knowledge of what is around, so that a batch of fewer samples is nearer to what remains. [`wide_count`] aims at 100° and
//! narrows the pieces only where a sample would come nearer than `1.1·|pq|`, for small β.

use super::facet::{Arc, VoronoiFacet};
use super::paper::{sample_distance, sample_pieces, PULL};
use super::Samples;

/// The angle of the pieces aimed at, in radians.
const PIECE: f64 = 84.0 / 180.0 * std::f64::consts::PI;
/// Samples are placed as if their pieces had at least this angle.
const MIN_THETA: f64 = 80.0 / 180.0 * std::f64::consts::PI;
/// No piece is wider.
pub const MAX_THETA: f64 = 1.5 * PIECE;

/// How many samples an arc gets.
pub fn sample_count(span: f64) -> usize {
    ((span / PIECE).round() as usize).max(1)
}

/// The angle of the pieces aimed at when samples are joined again afterwards.
const WIDE_PIECE: f64 = 100.0 / 180.0 * std::f64::consts::PI;
/// Their samples are at least this far from `p` and `q`, in lengths of the edge.
const WIDE_DISTANCE: f64 = 1.1;

/// How many samples an arc gets when samples are joined again afterwards.
pub fn wide_count(span: f64, radius_edge: f64) -> usize {
    let radius2 = radius_edge * radius_edge - 0.25;
    // ψ(θ)², see the module.
    let distance2 = |theta: f64| {
        let cos = (0.5 * theta).cos().max(0.0);
        let d = (cos * cos * radius2 + 0.25).sqrt() + cos * radius2.max(0.0).sqrt();
        d * d + 0.25
    };
    let first = ((span / WIDE_PIECE).round() as usize).max(1);
    let fine = sample_count(span).max(first);
    (first..fine).find(|&count| distance2(span / count as f64) >= WIDE_DISTANCE * WIDE_DISTANCE).unwrap_or(fine)
}

/// The sample of the first of [`wide_count`] pieces.
pub fn sample_first(facet: &VoronoiFacet, arc: Arc, radius_edge: f64) -> Samples {
    let theta = arc.span / wide_count(arc.span, radius_edge) as f64;
    let angle = arc.start + 0.5 * theta;
    let distance = sample_distance(theta.max(MIN_THETA), facet.length, radius_edge) * (1.0 - PULL);
    let point = facet.point(angle, distance.min(facet.exit(angle)));
    Samples { points: vec![point], span: arc.span, theta }
}

/// The batch for one arc.
pub fn sample_arc(facet: &VoronoiFacet, arc: Arc, radius_edge: f64) -> Samples {
    sample_pieces(facet, arc, sample_count(arc.span), MIN_THETA, radius_edge)
}
