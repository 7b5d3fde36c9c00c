//! The sampler over a host's arrays: from points and tetrahedra to a batch of Steiner points that may all be inserted together.
//!
//! | module | idea |
//! |---|---|
//! | `topology` | the arrays as a mesh: checks, adjacency, walks, cavities, links |
//! | [`boundary`] | facets and segments of the mesh, found in its arrays |
//! | [`batch`] | bad short edges and boundary splits, and an independent set of their points |
//!
//! Nothing is kept between two calls: the host's arrays say all. So a host repeats 'batch, insert, repeat' with whatever mesher it has, as
//! long as it keeps the mesh Delaunay, and is done when a batch finds nothing bad.

pub mod batch;
pub mod boundary;
mod topology;

#[cfg(test)]
mod tests;

use glam::DVec3;

pub use batch::{sample_arrays, ArrayBatch, ArrayOptions, ArrayPoint};

/// A host's mesh. It must be Delaunay, and stay so: points in the batch's cavities are inserted by the empty-sphere rule.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arrays<'a> {
    /// The vertices. Those of no tetrahedron are not looked at.
    pub points: &'a [DVec3],
    /// Four vertices a tetrahedron, positively oriented: `det[b−a, c−a, d−a] > 0`. They are the domain: a face with a tetrahedron on one
    /// side only is part of its boundary. Those on the outside that are flat but for rounding are left out of it.
    pub tetrahedra: &'a [[u32; 4]],
    /// The tetrahedron across the face opposite each vertex, `u32::MAX` for none; may be empty.
    pub neighbours: &'a [[u32; 4]],
    /// Faces inside the mesh that no sample may encroach upon either, and faces of the boundary that are to have a number.
    pub faces: &'a [[u32; 3]],
    /// A number for each of `faces`, or none at all: faces of one number are of one facet, and edges between facets are segments. Without
    /// numbers, neighbours that are exactly coplanar are of one facet.
    pub facets: &'a [u32],
}
