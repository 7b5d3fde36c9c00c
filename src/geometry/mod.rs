//! Geometry apart from topology: exact signs behind floating-point filters, symbolic perturbation,
//! circumspheres and the quality of a tetrahedron. Nothing here knows of a triangulation.
//!
//! Orientation convention everywhere: a tetrahedron `abcd` is positive when `det[b−a, c−a, d−a] > 0`.

pub(crate) mod ball;
pub mod circumsphere;
pub mod encroachment;
mod exact;
pub(crate) mod extremes;
mod fixed;
pub mod lanes;
pub mod perturbation;
pub mod predicates;
pub mod quality;
mod range;
mod wide;

pub use predicates::{Filter, Sign};
pub use range::{check_points, check_range, flush_tiny, MAX_MAGNITUDE, MIN_LENGTH, MIN_MAGNITUDE};
