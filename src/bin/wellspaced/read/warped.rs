//! Polygons of surfaces that were cut into triangles because they are not planar: `check` tells of them.

use std::ops::Range;

use wellspaced::{DomainElement, Plc, PlcDefect, PlcDefectKind};

/// A defect for each polygon that was cut, naming the first of its triangles. `origins` is what [`Plc::cut_warped`] returned for the domain.
pub fn warped(plc: &Plc, origins: &[u32]) -> Vec<PlcDefect> {
    let mut end = 0;
    let parts = origins.chunk_by(|a, b| a == b).map(|parts| {
        end += parts.len();
        end - parts.len()..end
    });
    parts.filter(|parts| parts.len() > 1).map(|parts| defect(plc, parts)).collect()
}

/// The corner of some triangles that is farthest off the plane of the largest of them.
fn defect(plc: &Plc, parts: Range<usize>) -> PlcDefect {
    let element = DomainElement::Facet(parts.start);
    let corners =
        || plc.facets[parts.clone()].iter().flat_map(|facet| &facet.polygons[0]).map(|&v| plc.points[v as usize]);
    let triangles = plc.facets[parts.clone()].iter().map(|facet| {
        let [a, b, c] = [0, 1, 2].map(|i| plc.points[facet.polygons[0][i] as usize]);
        (a, (b - a).cross(c - a))
    });
    let (origin, normal) = triangles.max_by(|(_, a), (_, b)| a.length().total_cmp(&b.length())).unwrap_or_default();
    let normal = normal.normalize_or_zero();
    let off = corners().map(|p| (p, (p - origin).dot(normal).abs()));
    let (place, measure) = off.max_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or_default();
    PlcDefect { kind: PlcDefectKind::NotPlanar, elements: vec![element], place, measure }
}
