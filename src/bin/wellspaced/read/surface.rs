//! What the files of surfaces have in common: points and polygons.

use glam::DVec3;
use wellspaced::{Plc, PlcFacet};

/// A surface of polygons.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    pub points: Vec<DVec3>,
    /// Positions of points.
    pub polygons: Vec<Vec<u32>>,
    /// The number of the part that each polygon belongs to, 0 for all if there is none.
    pub markers: Vec<i32>,
}

impl Surface {
    /// The domain that it bounds: each polygon is a facet.
    pub fn into_domain(self) -> Plc {
        let Surface { points, polygons, markers } = self;
        let facet = |(i, polygon)| PlcFacet {
            polygons: vec![polygon],
            marker: markers.get(i).copied().unwrap_or(0),
            ..PlcFacet::default()
        };
        Plc { points, facets: polygons.into_iter().enumerate().map(facet).collect(), ..Plc::default() }
    }
}
