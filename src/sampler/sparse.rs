//! Fewer and wider pieces than the paper's: our own rule.
//!
//! **What can be chosen.** Let `pq` have length 1, and let an arc of span γ bound a component. `n` samples mend it alone when each cuts off a piece of angle θ = γ/n,
//! and the least that does it is a bisector through the ends of the piece: the sample on the ray through the piece's middle at the distance `d(θ)`
//! of [`paper`](super::paper), where the new Voronoi edge is the piece's chord. `d(θ) = c + sqrt(c² + ¼)` with `c = cos(θ/2)·sqrt(β² − ¼)`. Two distances
//! are new:
//! - to `p` and `q`: `ψ(θ) = sqrt(d(θ)² + ¼)`, which falls as θ grows;
//! - between neighbours of one batch: `χ(θ) = 2 sin(θ/2)·d(θ)`, which grows with θ up to 90° for large β and falls from there.
//!
//! The smaller of both is largest where they are equal, for large β at `sin(θ/2) = ½`: pieces of 60°. There every new edge is as long as can be, but six samples close
//! a full circle where four do. From 60° on a wider piece costs some of ψ and saves a sample at once; `χ ≥ ψ` then, so that the distance to `p` and `q` is
//! all that has to be watched. The rule takes the fewest pieces, `count = round(γ / 84°)`, for which that distance stays near its best: at 84° it is still 1.49
//! to 1.51 times β for β ≥ 1.5. (Pieces of 72° to 96° were tried on all data sets; 84° is where the count over a whole refinement is least.) A lone sample of a narrow
//! arc gains nothing by going out to `d(γ)`: it cuts off the arc and nothing else, and its corner lies on the very rim, where the next sample nearby tips
//! it out. So no sample goes farther than `d(80°)`, at which it cuts a wider chord than it must.
//!
//! **Crowded corners.** But where more than two link vertices are as near to the facet's corner ahead as the edge is, that is a Voronoi vertex of many tetrahedra: a centre of
//! symmetry, or the middle of a round body. A lone sample that would reach it, at `d(γ)`, is put just there: all that is around it gets one vertex, where off-centres
//! from all sides get several, none of them in the middle (of a sphere with 162 vertices, one with 320 tetrahedra at it instead of four with 374).
//!
//! **Lemma.** A sample for a piece of angle θ is at least `min(β, ψ(θ'))·|pq|` from every vertex, θ' the larger of θ and 80°, and two samples of a batch are at
//! least `β·|pq|` apart. *Proof.* The sample lies on a ray from the midpoint `m` that crosses the rim inside the facet, not beyond where the ray leaves the facet; the
//! facet is convex, so it lies in it, and no vertex is nearer to it than `p` and `q`. If it is where the ray leaves the facet, it is beyond the rim, whose points have
//! distance `β·|pq|` from `p` and `q`; else its distance is `ψ(θ')·|pq|`. That samples of one batch keep β is checked, and where they don't,
//! the farthest is taken alone. ∎
//!
//! A lone piece has θ < 126°, more have θ ≤ 105°: so every sample is at least `ψ(126°) > |pq|` from every vertex for all β ≥ 1 (1.14 for β = 1, 1.95 for β = 2).
//! New edges are longer than the edge they mend, so refinement ends by the same packing argument as the paper's. At hull edges, and where subfacets part the
//! tetrahedra around an edge, the facets are the walls of the wedge that holds the facet ([`facet`](super::facet)): a component ends there as at a vertex's mirror image,
//! and the lemma holds as it stands.
//!
//! **One at a time.** Where each sample is tried with the Steiner points around it before it is inserted ([`sparsify`](crate::sparsify)), a batch is chosen too early: what is
//! moved for its first sample changes what the others are for. So only the first sample of the arc is placed ([`sample_first`]), and the edge
//! is looked at again. It needs no distance from others of its batch, and as places are chosen anew, still wider pieces are better: [`wide_count`] aims
//! at 100° and narrows the pieces only where a sample would come nearer than `1.1·|pq|`, for small β. The lemma's first half holds with its θ.

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
pub const WIDE_DISTANCE: f64 = 1.1;

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

/// So many link vertices, with the edge's ends five and more on a sphere, make a corner crowded.
const CROWD: usize = 3;
/// They are as near to it as the edge, but for this share of the squared distance. It decides between two places that both mend the edge.
const CROWD_SHARE: f64 = 1e-3;

/// The sample of the first of `count` pieces.
fn sample_piece(facet: &VoronoiFacet, arc: Arc, count: usize, radius_edge: f64) -> Samples {
    let theta = arc.span / count as f64;
    let angle = arc.start + 0.5 * theta;
    let reach = |theta: f64| sample_distance(theta, facet.length, radius_edge) * (1.0 - PULL);
    let exit = facet.exit(angle);
    let is_crowded = || facet.crowd(angle, exit, CROWD_SHARE) >= CROWD;
    let goes_there = count == 1 && exit <= reach(theta) && is_crowded();
    let distance = if goes_there { exit } else { reach(theta.max(MIN_THETA)).min(exit) };
    Samples { points: vec![facet.point(angle, distance)], span: arc.span, theta }
}

/// The sample of the first of [`wide_count`] pieces.
pub fn sample_first(facet: &VoronoiFacet, arc: Arc, radius_edge: f64) -> Samples {
    sample_piece(facet, arc, wide_count(arc.span, radius_edge), radius_edge)
}

/// The batch for one arc.
pub fn sample_arc(facet: &VoronoiFacet, arc: Arc, radius_edge: f64) -> Samples {
    match sample_count(arc.span) {
        1 => sample_piece(facet, arc, 1, radius_edge),
        count => sample_pieces(facet, arc, count, MIN_THETA, radius_edge),
    }
}
