//! The domain: a piecewise linear complex, and what of it the refinement keeps as the triangulation's boundary.
//!
//! | module | idea |
//! |---|---|
//! | [`plc`] | the complex as the caller describes it |
//! | [`check`] | every defect of a complex |
//! | [`boundary`] | its subsegments and subfacets as they are split |
//! | `waiting` | which of them wait to be split |
//! | `encroached` | which of them a point encroaches upon |
//! | `build` | from complex, or hull, to boundary |
//! | `cut` | polygons that are not planar cut into triangles |
//! | `join` | coplanar facets joined |
//! | `planar` | the plane of a facet and the triangles in it |
//! | [`facet`] | the planar triangulation of one facet |
//! | `split` | what a split changes in it |
//! | `outlook` | what its vertex will bring, told before it is there |
//! | `elements` | the subsegments, or the subfacets, as a map |
//! | `unsplit` | what taking vertices away changes in it |
//! | `acute` | small input angles |
//! | `protect` | where subfacets are split near them |
//! | [`pending`] | what is demanded of a split |
//! | `blocked` | which elements could not be split |
//! | `sector` | an edge's link on one side of the boundary |
//! | `label` | which tetrahedra lie in the domain |
//! | `validate` | the invariants, checked |
//!
//! Segments and facets are recovered and kept by rules 1 to 3 of the paper (Ruppert's and Shewchuk's): a subsegment
//! or subfacet that is missing from the triangulation, or encroached, is split.

pub(crate) mod acute;
mod blocked;
pub mod boundary;
mod build;
pub mod check;
mod cut;
mod elements;
mod encroached;
pub mod facet;
mod join;
pub(crate) mod label;
pub(crate) mod outlook;
pub mod pending;
pub(crate) mod planar;
pub mod plc;
pub(crate) mod protect;
mod sector;
mod split;
mod survey;
#[cfg(test)]
mod tests;
mod unsplit;
mod validate;
mod waiting;

pub use acute::Carrier;
pub use boundary::Boundary;
pub(crate) use unsplit::Unsplit;
