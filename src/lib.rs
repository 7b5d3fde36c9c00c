//! **wellspaced** turns points and piecewise linear domains into quality tetrahedral meshes with
//! few elements. It implements R. Jampani and A. Üngör, "Construction of Sparse Well-spaced Point
//! Sets for Quality Tetrahedralizations", 16th International Meshing Roundtable, 2007.
//!
//! The crate is a plain Rust library; [`capi`] is the thin C face over it, which
//! `include/wellspaced.h` declares.
//!
//! | module | idea |
//! |---|---|
//! | [`geometry`] | exact predicates behind static filters, symbolic perturbation, circumspheres, quality |
//! | [`triangulation`] | the incremental Delaunay triangulation |
//! | [`sampler`] | bad short edges and Steiner batches, pure functions of an edge and its link |
//! | [`domain`] | piecewise linear complexes and their boundary rules |
//! | [`refine`] | the refinement loop |
//! | [`sparsify`] | Steiner points taken away again |
//! | [`host`] | the same, a round at a time, on the arrays of another mesher |
//! | [`mesh`] | a triangulation with its domain: what most callers hold |

#![warn(missing_docs)]

pub mod capi;
mod control;
mod distinct;
pub mod domain;
mod error;
#[cfg(wellspaced_gaps)]
pub mod gaps;
pub mod geometry;
pub mod host;
mod leavings;
mod memory;
pub mod mesh;
mod parted;
pub mod refine;
pub mod sampler;
#[cfg(test)]
mod samples;
mod sorting;
pub mod sparsify;
mod threads;
pub mod triangulation;

pub use control::{Control, LogLevel, Progress};
pub use domain::check::{PlcCheck, PlcDefect, PlcDefectKind, Severity, SmallAngle};
pub use domain::plc::{Plc, PlcFacet, PlcRegion, PlcSegment};
pub use error::{DomainElement, Error};
pub use glam::DVec3;
pub use mesh::{BoundaryView, Mesh, MeshView, On};
pub use refine::sizing::Sizing;
pub use refine::step::{Batch, Origin, SteinerPoint, StepOptions};
pub use refine::{RefineOptions, RefineReport, RefineStatus, Unrefined};
pub use sampler::Rule;
pub use sparsify::Sparsify;
pub use triangulation::{Location, Triangulation};

/// Compiles and runs the README's Rust.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
