//! The domain: a piecewise linear complex, and what of it the refinement keeps as the triangulation's boundary.
//!
//! | module | idea |
//! |---|---|
//! | [`plc`] | the complex as the caller describes it |
//! | [`boundary`] | its subsegments and subfacets as they are split, and which of them a point encroaches upon |
//! | `build` | from complex, or hull, to boundary |
//! | [`facet`] | the planar triangulation of one facet |
//! | `split` | what a split changes in it |
//! | `unsplit` | what taking vertices away changes in it |
//! | `acute` | small input angles |
//! | `clearance` | which elements have to give way to a sample of the sparse rule |
//! | `sector` | an edge's link on one side of the boundary |
//! | `label` | which tetrahedra lie in the domain |
//!
//! Segments and facets are recovered and kept by rules 1 to 3 of the paper (Ruppert's and Shewchuk's): a subsegment
//! or subfacet that is missing from the triangulation, or encroached, is split.

pub(crate) mod acute;
pub mod boundary;
mod build;
pub(crate) mod clearance;
pub mod facet;
pub(crate) mod label;
pub mod plc;
mod sector;
mod split;
mod unsplit;

pub(crate) use acute::Carrier;
pub use boundary::Boundary;
pub(crate) use unsplit::Unsplit;
