//! The piecewise linear complex as a caller describes it: plain lists, no geometry decided yet.
//!
//! The model is that of TetGen's `.poly` files: facets are sets of coplanar polygons with holes,
//! volume holes and regions are named by a seed point.

use glam::DVec3;

/// A piecewise linear complex: points, segments, polygonal facets, hole and region seeds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plc {
    /// The points; facets and segments name them by position.
    pub points: Vec<DVec3>,
    /// One marker a point, or none at all.
    pub point_markers: Vec<i32>,
    /// Segments that are no facet's side (a facet's sides need not be listed).
    pub segments: Vec<PlcSegment>,
    /// Planar facets.
    pub facets: Vec<PlcFacet>,
    /// A point in each volume that is not part of the domain.
    pub holes: Vec<DVec3>,
    /// A point in each volume that carries an attribute.
    pub regions: Vec<PlcRegion>,
}

/// A straight segment between two points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlcSegment {
    /// Positions of its ends in [`Plc::points`].
    pub ends: [u32; 2],
    /// The caller's own number for it.
    pub marker: i32,
}

/// A planar facet: the region bounded by its polygons, less its holes.
///
/// Coordinates on a slanted plane are rounded, so it need not be exactly planar: its points may lie off its plane by 1e-5 of the diagonal of the
/// bounding box of all points, but by no more than 1e-4 of the facet's size. They are kept where they are; new ones lie near the plane, so that refinement may
/// change the volume by as little. Triangles are always planar.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlcFacet {
    /// Closed polygons of positions in [`Plc::points`]; a polygon of two points is a segment
    /// within the facet, one of one point a vertex within it.
    pub polygons: Vec<Vec<u32>>,
    /// A point in each part of the plane within the polygons that is not part of the facet. Only the facet's own polygons bound such a part.
    pub holes: Vec<DVec3>,
    /// The caller's own number for it.
    pub marker: i32,
}

/// A seed that labels the volume around it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlcRegion {
    /// A point inside the volume.
    pub point: DVec3,
    /// The label.
    pub attribute: f64,
    /// Largest tetrahedron volume asked for, if any.
    pub max_volume: Option<f64>,
}

impl Plc {
    /// The axis-parallel box from `low` to `high` as eight points and six facets, with `points` inside.
    pub fn boxed(low: DVec3, high: DVec3, points: impl IntoIterator<Item = DVec3>) -> Plc {
        let corner = |i: u32| {
            let pick = |bit: u32, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
        };
        let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        Plc {
            points: (0..8).map(corner).chain(points).collect(),
            facets: sides.iter().map(|s| PlcFacet { polygons: vec![s.to_vec()], ..PlcFacet::default() }).collect(),
            ..Plc::default()
        }
    }
}
