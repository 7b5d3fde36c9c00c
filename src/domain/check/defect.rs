//! The kinds of defects of a complex.

use std::cmp::Ordering;
use std::fmt;

use crate::{DVec3, DomainElement, Error};

/// Whether a complex with the defect can be meshed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// It can't.
    Error,
    /// It can.
    Warning,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum PlcDefectKind {
    /// A point's or seed's coordinate is NaN or infinite.
    NotFinite,
    /// A point's coordinate is too large or too small for the exact predicates.
    OutOfRange,
    /// A segment or facet names a point that does not exist.
    NoSuchPoint,
    /// A facet has no polygon, or a polygon no point.
    Empty,
    /// There are more regions than can be told apart.
    TooManyRegions,
    /// A segment's ends are at one place.
    NoLength,
    /// A facet's points lie on a line.
    NoArea,
    /// A facet's points don't lie in a plane; the measure is how far one is off.
    NotPlanar,
    /// Sides of one facet cross, or two of its corners lie upon each other in its plane.
    CrossingSides,
    /// Two segments cross.
    SegmentsCross,
    /// A segment, or the side of a facet, goes through a facet.
    SegmentThroughFacet,
    /// Two facets have the same triangles.
    DuplicateFacet,
    /// Two facets in one plane overlap.
    FacetsOverlap,
    /// Two points are at one place. They become one vertex.
    DuplicatePoint,
    /// Two segments of the list are the same.
    DuplicateSegment,
    /// A point lies inside a segment or a facet's side. It is cut there.
    PointOnSegment,
    /// A point lies in a facet and is none of its corners. It becomes a vertex of it.
    PointOnFacet,
    /// An edge has one facet at it: the surface is open there.
    OpenEdge,
    /// An edge has more than two facets at it; the measure is how many.
    NonManifoldEdge,
}

impl PlcDefectKind {
    /// All kinds.
    pub const ALL: [PlcDefectKind; 19] = {
        use PlcDefectKind::*;
        [
            NotFinite,
            OutOfRange,
            NoSuchPoint,
            Empty,
            TooManyRegions,
            NoLength,
            NoArea,
            NotPlanar,
            CrossingSides,
            SegmentsCross,
            SegmentThroughFacet,
            DuplicateFacet,
            FacetsOverlap,
            DuplicatePoint,
            DuplicateSegment,
            PointOnSegment,
            PointOnFacet,
            OpenEdge,
            NonManifoldEdge,
        ]
    };

    /// Whether a complex with this defect can be meshed.
    pub fn severity(self) -> Severity {
        if self >= PlcDefectKind::DuplicatePoint {
            Severity::Warning
        } else {
            Severity::Error
        }
    }

    /// A short name in lower case.
    pub fn name(self) -> &'static str {
        match self {
            PlcDefectKind::NotFinite => "not_finite",
            PlcDefectKind::OutOfRange => "out_of_range",
            PlcDefectKind::NoSuchPoint => "no_such_point",
            PlcDefectKind::Empty => "empty",
            PlcDefectKind::TooManyRegions => "too_many_regions",
            PlcDefectKind::NoLength => "no_length",
            PlcDefectKind::NoArea => "no_area",
            PlcDefectKind::NotPlanar => "not_planar",
            PlcDefectKind::CrossingSides => "crossing_sides",
            PlcDefectKind::SegmentsCross => "segments_cross",
            PlcDefectKind::SegmentThroughFacet => "segment_through_facet",
            PlcDefectKind::DuplicateFacet => "duplicate_facet",
            PlcDefectKind::FacetsOverlap => "facets_overlap",
            PlcDefectKind::DuplicatePoint => "duplicate_point",
            PlcDefectKind::DuplicateSegment => "duplicate_segment",
            PlcDefectKind::PointOnSegment => "point_on_segment",
            PlcDefectKind::PointOnFacet => "point_on_facet",
            PlcDefectKind::OpenEdge => "open_edge",
            PlcDefectKind::NonManifoldEdge => "non_manifold_edge",
        }
    }
}

/// One defect of a complex.
#[derive(Clone, Debug, PartialEq)]
pub struct PlcDefect {
    /// What is wrong.
    pub kind: PlcDefectKind,
    /// The elements concerned, one or two. A segment that is no element of its own, the side of a facet, is named by that facet.
    pub elements: Vec<DomainElement>,
    /// A point where it is wrong; NaN where that means nothing.
    pub place: DVec3,
    /// A number that goes with the kind: a distance, a count, the position that names no point; else 0.
    pub measure: f64,
}

impl PlcDefect {
    pub(super) fn new(kind: PlcDefectKind, elements: impl Into<Vec<DomainElement>>, place: DVec3) -> PlcDefect {
        PlcDefect { kind, elements: elements.into(), place, measure: 0.0 }
    }

    pub(super) fn measured(self, measure: f64) -> PlcDefect {
        PlcDefect { measure, ..self }
    }

    /// Errors first, kind by kind, then by elements.
    pub(super) fn order(a: &PlcDefect, b: &PlcDefect) -> Ordering {
        let place = |d: &PlcDefect| d.place.to_array().map(f64::to_bits);
        (a.kind, &a.elements, place(a)).cmp(&(b.kind, &b.elements, place(b)))
    }

    /// The error for a complex that can't be meshed because of it.
    pub(super) fn error(&self) -> Error {
        match (self.kind, self.elements.first()) {
            (PlcDefectKind::NotFinite, Some(&DomainElement::Point(index))) => {
                Error::NotFinite { index, point: self.place }
            }
            (PlcDefectKind::OutOfRange, Some(&DomainElement::Point(index))) => {
                Error::OutOfRange { index, point: self.place }
            }
            (_, element) => Error::InvalidDomain {
                element: element.copied().unwrap_or(DomainElement::Whole),
                problem: self.problem(),
            },
        }
    }

    /// What is wrong, to follow the first element's name in a sentence.
    pub fn problem(&self) -> String {
        let place = format!("({}, {}, {})", self.place.x, self.place.y, self.place.z);
        let other = self.elements.get(1).map(ToString::to_string).unwrap_or_default();
        let measure = self.measure;
        match self.kind {
            PlcDefectKind::NotFinite if matches!(self.elements[..], [DomainElement::Facet(_)]) => {
                "has a seed that is not finite".into()
            }
            PlcDefectKind::NotFinite => format!("{place} is not finite"),
            PlcDefectKind::OutOfRange => {
                format!("{place} has a coordinate outside the range of the exact predicates")
            }
            PlcDefectKind::NoSuchPoint => format!("names point {measure}, which does not exist"),
            PlcDefectKind::Empty => "has no polygon, or a polygon without points".into(),
            PlcDefectKind::TooManyRegions => format!("is one more than the {measure} that there can be"),
            PlcDefectKind::NoLength => format!("has length 0 at {place}"),
            PlcDefectKind::NoArea => format!("has no area: its points lie on a line through {place}"),
            PlcDefectKind::NotPlanar => {
                format!("is not planar: its corner {place} lies {measure:e} off the plane of the others")
            }
            PlcDefectKind::CrossingSides => format!("has sides that cross or touch, near {place}"),
            PlcDefectKind::SegmentsCross => format!("crosses {other} at {place}"),
            PlcDefectKind::SegmentThroughFacet => format!("goes through {other} at {place}"),
            PlcDefectKind::DuplicateFacet => format!("is the same as {other}, at {place}"),
            PlcDefectKind::FacetsOverlap => format!("overlaps {other} in one plane, at {place}"),
            PlcDefectKind::DuplicatePoint => format!("is at the same place as {other}, {place}"),
            PlcDefectKind::DuplicateSegment => format!("is the same as {other}, at {place}"),
            PlcDefectKind::PointOnSegment => format!("lies on a segment or side of {other}, at {place}"),
            PlcDefectKind::PointOnFacet => format!("lies in {other} and is no corner of it, at {place}"),
            PlcDefectKind::OpenEdge => format!("has an edge where no other facet is, at {place}"),
            PlcDefectKind::NonManifoldEdge => format!("has an edge with {measure} facets around it, at {place}"),
        }
    }
}

impl fmt::Display for PlcDefect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let element = self.elements.first().copied().unwrap_or(DomainElement::Whole);
        write!(f, "{element}: {}", self.problem())
    }
}
