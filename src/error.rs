//! The one error type of the core: every variant names the offending element, so that a
//! caller can point its own user at it. An operation that returns an error has changed nothing.

use std::fmt;

use glam::DVec3;

/// Why an operation was refused. Nothing has been changed when one of these is returned.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A coordinate of point `index` is NaN or infinite.
    NotFinite {
        /// Its position in the caller's list.
        index: usize,
        /// The point as given.
        point: DVec3,
    },
    /// A coordinate of point `index` is too large or too small for the exact predicates:
    /// other than 0, magnitudes from 2⁻¹⁴² to 2²⁰¹ are accepted.
    OutOfRange {
        /// Its position in the caller's list.
        index: usize,
        /// The point as given.
        point: DVec3,
    },
    /// More vertices or tetrahedra than 32-bit indices can name.
    TooManyVertices {
        /// How many there would be.
        requested: usize,
        /// How many there can be.
        limit: usize,
    },
    /// There is no (longer a) vertex of this id.
    NoSuchVertex {
        /// The id.
        vertex: u32,
    },
    /// The vertex stands where a new one was to be placed.
    Occupied {
        /// The id.
        vertex: u32,
    },
    /// The two vertices are not joined by an edge of the triangulation.
    NoSuchEdge {
        /// The two ids.
        edge: [u32; 2],
    },
    /// An option has a value that it can't have.
    InvalidOption {
        /// The option's field.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be, in words.
        expected: &'static str,
    },
    /// The domain can't be used: what is wrong, and with which element.
    InvalidDomain {
        /// The element.
        element: DomainElement,
        /// What is wrong with it, to follow its name in a sentence.
        problem: String,
    },
    /// The operation needs a domain and the mesh has none, or has one already.
    Domain {
        /// Which of these, in words.
        problem: &'static str,
    },
    /// A host's arrays are no Delaunay mesh: what is wrong, and with which tetrahedron or face.
    InvalidMesh {
        /// The sentence.
        problem: String,
    },
    /// The control cancelled a call that has no result to give then.
    Cancelled,
    /// Memory for `what` could not be had.
    OutOfMemory {
        /// The array's name.
        what: &'static str,
    },
}

/// An element of a piecewise linear complex, named by its position in the caller's lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum DomainElement {
    /// The domain as a whole.
    Whole,
    /// A point of the list of points.
    Point(usize),
    /// A segment of the list of segments.
    Segment(usize),
    /// A facet of the list of facets.
    Facet(usize),
    /// A hole seed.
    Hole(usize),
    /// A region seed.
    Region(usize),
}

impl fmt::Display for DomainElement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DomainElement::Whole => write!(f, "domain"),
            DomainElement::Point(i) => write!(f, "point {i}"),
            DomainElement::Segment(i) => write!(f, "segment {i}"),
            DomainElement::Facet(i) => write!(f, "facet {i}"),
            DomainElement::Hole(i) => write!(f, "hole {i}"),
            DomainElement::Region(i) => write!(f, "region {i}"),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::NotFinite { index, point } => {
                write!(f, "point {index} ({}, {}, {}) is not finite", point.x, point.y, point.z)
            }
            Error::OutOfRange { index, point } => write!(
                f,
                "point {index} ({:e}, {:e}, {:e}) has a coordinate outside the range of the exact predicates \
                 (0, or a magnitude from 2^-142 to 2^201)",
                point.x, point.y, point.z
            ),
            Error::TooManyVertices { requested, limit } => {
                write!(f, "{requested} vertices asked for, but 32-bit indices hold at most {limit}")
            }
            Error::NoSuchVertex { vertex } => write!(f, "there is no vertex {vertex}"),
            Error::Occupied { vertex } => write!(f, "vertex {vertex} stands at this place already"),
            Error::NoSuchEdge { edge: [p, q] } => write!(f, "vertices {p} and {q} are not joined by an edge"),
            Error::InvalidOption { name, value, expected } => {
                // Very small and very large values would be written with hundreds of zeros.
                let plain = *value == 0.0 || !value.is_finite() || (1e-4..1e15).contains(&value.abs());
                if plain {
                    write!(f, "option {name} is {value}, expected {expected}")
                } else {
                    write!(f, "option {name} is {value:e}, expected {expected}")
                }
            }
            Error::InvalidDomain { element, problem } => write!(f, "{element}: {problem}"),
            Error::Domain { problem } => f.write_str(problem),
            Error::InvalidMesh { problem } => f.write_str(problem),
            Error::Cancelled => f.write_str("cancelled"),
            Error::OutOfMemory { what } => write!(f, "out of memory for {what}"),
        }
    }
}

impl std::error::Error for Error {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_far_from_1_are_written_in_short() {
        let text = |value| Error::InvalidOption { name: "x", value, expected: "more" }.to_string();
        for (value, written) in [(1e-300, "1e-300"), (-2e200, "-2e200"), (0.5, "0.5"), (0.0, "0"), (f64::NAN, "NaN")] {
            assert_eq!(text(value), format!("option x is {written}, expected more"));
        }
    }
}
