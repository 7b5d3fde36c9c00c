//! What the files of surfaces have in common: points and polygons.

use std::path::Path;

use glam::DVec3;
use wellspaced::{Plc, PlcFacet};

use crate::failure::Failure;

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
    /// The domain that it bounds: each polygon is a facet. `path` is the file that it comes from: binary ones may have any numbers.
    pub fn into_domain(self, path: &Path) -> Result<Plc, Failure> {
        let Surface { points, polygons, markers } = self;
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            return Err(Failure::in_file(path, format_args!("point {index}: a coordinate is not finite")));
        }
        let facet = |(i, polygon)| PlcFacet {
            polygons: vec![polygon],
            marker: markers.get(i).copied().unwrap_or(0),
            ..PlcFacet::default()
        };
        Ok(Plc { points, facets: polygons.into_iter().enumerate().map(facet).collect(), ..Plc::default() })
    }
}
