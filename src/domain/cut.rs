//! Polygons that don't lie in a plane are cut into triangles, which do. Files of surfaces have such polygons: their coordinates are rounded, or they
//! were never flat.

use super::planar::{extent, facet_normal, off_plane};
use super::plc::{Plc, PlcFacet};
use crate::{Control, DVec3};

impl Plc {
    /// Replaces each facet of a single polygon that is not planar by a fan of triangles around one of its corners, the first from which all of them turn the way
    /// the polygon does. A polygon that has no such corner stays. Returns the position of the old facet for each new one.
    ///
    /// Cost: linear in the corners, but for polygons that are not planar quadratic.
    pub fn cut_warped(&mut self) -> Vec<u32> {
        let mut origins = Vec::with_capacity(self.facets.len());
        let mut facets = Vec::with_capacity(self.facets.len());
        let extent = extent(&self.points, Control::never()).unwrap_or(0.0);
        for (i, facet) in std::mem::take(&mut self.facets).into_iter().enumerate() {
            let parts = fan(&self.points, &facet, extent).unwrap_or_default();
            origins.extend((0..parts.len().max(1)).map(|_| i as u32));
            if parts.is_empty() {
                facets.push(facet);
            } else {
                let triangle = |corners: [u32; 3]| PlcFacet { polygons: vec![corners.to_vec()], ..facet.clone() };
                facets.extend(parts.into_iter().map(triangle));
            }
        }
        self.facets = facets;
        origins
    }
}

/// The triangles for a facet that has to be cut and can be.
fn fan(points: &[DVec3], facet: &PlcFacet, extent: f64) -> Option<Vec<[u32; 3]>> {
    let [polygon] = &facet.polygons[..] else { return None };
    let known = polygon.iter().all(|&v| points.get(v as usize).is_some_and(|p| p.is_finite()));
    if !known || polygon.len() < 4 || !facet.holes.is_empty() {
        return None;
    }
    off_plane(points, polygon, facet_normal(points, polygon)?, extent)?;
    let at = |v: u32| points[v as usize];
    let n = polygon.len();
    let normal = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(at(c) - at(a));
    // Twice the polygon's area as a vector, whatever its shape.
    let area: DVec3 = (1..n - 1).map(|i| normal([polygon[0], polygon[i], polygon[i + 1]])).sum();
    (0..n).find_map(|start| {
        let corner = |i: usize| polygon[(start + i) % n];
        let triangles: Vec<[u32; 3]> = (1..n - 1).map(|i| [corner(0), corner(i), corner(i + 1)]).collect();
        triangles.iter().all(|&t| normal(t).dot(area) > 0.0).then_some(triangles)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[[f64; 3]]) -> (Vec<Vec<u32>>, Vec<u32>) {
        let flat = PlcFacet { polygons: vec![vec![0, 1, 2]], marker: 7, ..PlcFacet::default() };
        let all = PlcFacet { polygons: vec![(0..points.len() as u32).collect()], marker: 9, ..PlcFacet::default() };
        let points = points.iter().map(|&p| DVec3::from(p)).collect();
        let mut plc = Plc { points, facets: vec![flat, all], ..Plc::default() };
        let origins = plc.cut_warped();
        assert_eq!(origins.len(), plc.facets.len());
        assert!(plc.facets.iter().zip(&origins).all(|(facet, &origin)| facet.marker == [7, 9][origin as usize]));
        (plc.facets.into_iter().map(|mut facet| facet.polygons.remove(0)).collect(), origins)
    }

    #[test]
    fn what_is_planar_stays() {
        let (polygons, origins) = cut(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!((polygons, origins), (vec![vec![0, 1, 2], vec![0, 1, 2, 3]], vec![0, 1]));
    }

    #[test]
    fn what_is_not_becomes_a_fan() {
        let (polygons, origins) = cut(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 1e-3], [0.0, 1.0, 0.0]]);
        assert_eq!((polygons, origins), (vec![vec![0, 1, 2], vec![0, 1, 2], vec![0, 2, 3]], vec![0, 1, 1]));
        // Corner 1 is a notch: only from it and from the one across do all triangles turn the right way.
        let (polygons, _) = cut(&[[0.0, 0.0, 0.0], [0.5, 0.4, 0.0], [1.0, 0.0, 1e-3], [0.5, 1.0, 0.0]]);
        assert_eq!(polygons[1..], [vec![1, 2, 3], vec![1, 3, 0]]);
    }
}
