//! A facet's own plane: its normal, and the triangles that fill its polygons, from a planar constrained triangulation (the `spade` crate).
//! Vertices are positions in `points`.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use spade::{ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation as _};

use crate::geometry::predicates::collinear;

/// How far a facet's points may lie off its plane in any case, relative to its size. Points of a slanted plane have no exact coordinates.
pub const PLANARITY: f64 = 1e-9;

/// Coordinates in files often have five or six digits. Facets may be as uneven as that makes them: so much relative to the extent of all points.
const ROUNDED: f64 = 1e-5;

/// But no facet may be more uneven than this relative to its own size.
const UNEVEN: f64 = 1e-4;

/// How far the points of a facet of this size may lie off its plane, among points of this extent.
pub fn planarity(size: f64, extent: f64) -> f64 {
    (PLANARITY * size).max((ROUNDED * extent).min(UNEVEN * size))
}

/// The diagonal of the bounding box of those of some points that are finite.
pub fn extent(points: &[DVec3]) -> f64 {
    let finite = || points.iter().copied().filter(|p| p.is_finite());
    let (low, high) = (finite().reduce(DVec3::min), finite().reduce(DVec3::max));
    low.zip(high).map_or(0.0, |(low, high)| low.distance(high))
}

/// Why a facet can't be triangulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarDefect {
    /// Two corners fall on one place of the plane.
    SamePlace(u32, u32),
    /// This side crosses another one.
    Crossing([u32; 2]),
    /// The planar triangulation refused a coordinate.
    Range(u32),
}

/// A normal of the plane that the vertices span, from the corner triple of the largest area found by two scans.
pub fn facet_normal(points: &[DVec3], vertices: &[u32]) -> Option<DVec3> {
    let at = |v: u32| points[v as usize];
    let origin = at(*vertices.first()?);
    let by = |f: &dyn Fn(DVec3) -> f64| vertices.iter().map(|&v| at(v)).max_by(|&a, &b| f(a).total_cmp(&f(b)));
    let far = by(&|p| p.distance_squared(origin))?;
    let third = by(&|p| (p - origin).cross(far - origin).length_squared())?;
    if collinear(origin, far, third) {
        return None;
    }
    (far - origin).cross(third - origin).try_normalize()
}

/// The size of a facet with these corners: how far the farthest is from the first.
pub fn size_from(points: &[DVec3], vertices: &[u32]) -> f64 {
    let origin = points[vertices[0] as usize];
    vertices.iter().map(|&v| points[v as usize].distance(origin)).fold(0.0, f64::max)
}

/// The vertex that lies too far off the plane, and how far. All points have this [`extent`].
pub fn off_plane(points: &[DVec3], vertices: &[u32], normal: DVec3, extent: f64) -> Option<(u32, f64)> {
    let origin = points[vertices[0] as usize];
    let size = size_from(points, vertices);
    let off = vertices.iter().map(|&v| (v, (points[v as usize] - origin).dot(normal).abs()));
    off.max_by(|(_, a), (_, b)| a.total_cmp(b)).filter(|&(_, off)| off > planarity(size, extent))
}

/// The triangles of the constrained planar triangulation that lie within the polygons: not reached from outside, nor from a hole's seed. Only `sides`, those of
/// the polygons, bound what is outside; edges that `others` need in it do not.
pub fn triangles_within(
    points: &[DVec3],
    vertices: &[u32],
    sides: &[[u32; 2]],
    others: &[[u32; 2]],
    axis: usize,
    holes: &[DVec3],
) -> Result<Vec<[u32; 3]>, PlanarDefect> {
    // The commonest facet needs no machinery.
    if let (&[a, b, c], 3, [], []) = (vertices, sides.len(), others, holes) {
        if sides.iter().all(|e| e[0] != e[1] && vertices.contains(&e[0]) && vertices.contains(&e[1])) {
            return Ok(vec![[a, b, c]]);
        }
    }
    let at = |v: u32| points[v as usize];
    let project = |p: DVec3| Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    let mut planar: ConstrainedDelaunayTriangulation<Point2<f64>> = ConstrainedDelaunayTriangulation::new();
    let mut handle_of = FxHashMap::default();
    let mut vertex_of = FxHashMap::default();
    for &v in vertices {
        let handle = planar.insert(project(at(v))).map_err(|_| PlanarDefect::Range(v))?;
        handle_of.insert(v, handle);
        if let Some(other) = vertex_of.insert(handle, v) {
            return Err(PlanarDefect::SamePlace(other, v));
        }
    }
    // A side that a vertex lies on becomes several edges.
    let mut bounding: FxHashSet<[u32; 2]> = FxHashSet::default();
    for (i, &[a, b]) in sides.iter().chain(others).enumerate() {
        let (from, to) = (handle_of[&a], handle_of[&b]);
        if !planar.can_add_constraint(from, to) {
            return Err(PlanarDefect::Crossing([a, b]));
        }
        let parts = planar.try_add_constraint(from, to);
        if i < sides.len() {
            let ends = |edge| planar.directed_edge(edge).vertices().map(|v| vertex_of[&v.fix()]);
            bounding.extend(parts.into_iter().map(|edge| super::boundary::edge_key(ends(edge))));
        }
    }
    let is_side = |edge: spade::handles::DirectedEdgeHandle<_, _, spade::CdtEdge<()>, ()>| {
        edge.is_constraint_edge()
            && bounding.contains(&super::boundary::edge_key(edge.vertices().map(|v| vertex_of[&v.fix()])))
    };
    let mut outside = vec![false; planar.num_all_faces()];
    let mut queue = vec![planar.outer_face().fix()];
    for &hole in holes {
        match planar.locate(project(hole)) {
            // Any edge knows its face in the form that includes the outer one.
            PositionInTriangulation::OnFace(face) => queue.push(planar.face(face).adjacent_edge().face().fix()),
            // A diagonal of the hole, which is on neither of its triangles. On a side of the facet a seed means nothing.
            PositionInTriangulation::OnEdge(edge) if !is_side(planar.directed_edge(edge)) => {
                queue.push(planar.directed_edge(edge).face().fix());
            }
            _ => {}
        }
    }
    let neighbours: FxHashMap<_, Vec<_>> = planar.directed_edges().fold(FxHashMap::default(), |mut map, edge| {
        if !is_side(edge) {
            map.entry(edge.face().fix()).or_insert_with(Vec::new).push(edge.rev().face().fix());
        }
        map
    });
    while let Some(face) = queue.pop() {
        if !std::mem::replace(&mut outside[face.index()], true) {
            queue.extend(neighbours.get(&face).into_iter().flatten().copied());
        }
    }
    Ok(planar
        .inner_faces()
        .filter(|face| !outside[face.fix().index()])
        .map(|face| face.vertices().map(|v| vertex_of[&v.fix()]))
        .collect())
}

/// The dominant axis of a facet's normal, and its triangles; none when it can't be triangulated.
pub fn triangles_of_facet(points: &[DVec3], facet: &super::plc::PlcFacet) -> Option<(usize, Vec<[u32; 3]>)> {
    let mut vertices: Vec<u32> = facet.polygons.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut sides = Vec::new();
    for polygon in facet.polygons.iter().filter(|polygon| polygon.len() > 1) {
        sides.extend(
            (0..polygon.len()).map(|i| super::boundary::edge_key([polygon[i], polygon[(i + 1) % polygon.len()]])),
        );
    }
    sides.sort_unstable();
    sides.dedup();
    let axis = super::facet::dominant_axis(facet_normal(points, &vertices)?);
    Some((axis, triangles_within(points, &vertices, &sides, &[], axis, &facet.holes).ok()?))
}

/// Seeds in the parts within a facet's outline that none of the `members` covers, which it is the union of: one in each triangle of them.
pub fn gaps(plc: &super::plc::Plc, facet: &super::plc::PlcFacet, members: &[u32]) -> Vec<DVec3> {
    let points = &plc.points;
    let mut vertices: Vec<u32> = facet.polygons.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let Some(normal) = facet_normal(points, &vertices) else { return Vec::new() };
    let axis = super::facet::dominant_axis(normal);
    let mut constraints: Vec<[u32; 2]> = Vec::new();
    for polygon in facet.polygons.iter().filter(|polygon| polygon.len() > 1) {
        for i in 0..polygon.len() {
            constraints.push(super::boundary::edge_key([polygon[i], polygon[(i + 1) % polygon.len()]]));
        }
    }
    constraints.sort_unstable();
    constraints.dedup();
    // A member lies on one side of each of its sides that stay. The triangle there belongs to the facet if it is on that side.
    let mut inner: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    for &member in members {
        let polygon = &plc.facets[member as usize].polygons[0];
        let Ok(own) = triangles_of(points, polygon, axis) else { return Vec::new() };
        for triangle in own {
            for i in 0..3 {
                let side = super::boundary::edge_key([triangle[i], triangle[(i + 1) % 3]]);
                inner.insert(side, triangle[(i + 2) % 3]);
            }
        }
    }
    let Ok(triangles) = triangles_within(points, &vertices, &constraints, &[], axis, &[]) else { return Vec::new() };
    let side_of = |a: u32, b: u32, c: u32| {
        crate::geometry::predicates::orient2d(axis, points[a as usize], points[b as usize], points[c as usize])
    };
    let mut seeds = Vec::new();
    for triangle in triangles {
        let outer = (0..3).any(|i| {
            let side = super::boundary::edge_key([triangle[i], triangle[(i + 1) % 3]]);
            let kept = constraints.binary_search(&side).is_ok();
            kept && inner.get(&side).is_some_and(|&apex| {
                side_of(side[0], side[1], apex) != side_of(side[0], side[1], triangle[(i + 2) % 3])
            })
        });
        if outer {
            let [a, b, c] = triangle.map(|v| points[v as usize]);
            seeds.push((a + b + c) / 3.0);
        }
    }
    seeds
}

fn triangles_of(points: &[DVec3], polygon: &[u32], axis: usize) -> Result<Vec<[u32; 3]>, PlanarDefect> {
    let mut vertices = polygon.to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let mut sides: Vec<[u32; 2]> =
        (0..polygon.len()).map(|i| super::boundary::edge_key([polygon[i], polygon[(i + 1) % polygon.len()]])).collect();
    sides.sort_unstable();
    sides.dedup();
    triangles_within(points, &vertices, &sides, &[], axis, &[])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the seed in TetGen's example.poly is, on the diagonal of the hole.
    #[test]
    fn a_seed_between_two_triangles_empties_both() {
        let square = |low: f64, high: f64| [[low, low], [high, low], [high, high], [low, high]];
        let corners = square(0.0, 4.0).into_iter().chain(square(1.0, 3.0));
        let points: Vec<DVec3> = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).collect();
        let vertices: Vec<u32> = (0..8).collect();
        let sides: Vec<[u32; 2]> = (0..4).flat_map(|i| [[i, (i + 1) % 4], [4 + i, 4 + (i + 1) % 4]]).collect();
        let count = |holes: &[DVec3]| triangles_within(&points, &vertices, &sides, &[], 2, holes).unwrap().len();
        assert_eq!(count(&[]), 10);
        assert_eq!(count(&[DVec3::new(2.0, 2.0, 0.0)]), 8);
        assert_eq!(count(&[DVec3::new(2.5, 1.75, 0.0)]), 8);
        // On a side it says nothing.
        assert_eq!(count(&[DVec3::new(1.0, 2.0, 0.0)]), 10);
    }

    /// A side that a vertex lies on, as seen along the axis, still bounds; an edge of others does not, in whole or in parts.
    #[test]
    fn sides_bound_and_other_edges_do_not() {
        // A square with a notch from above, down to y = 1; the last vertex is in the middle of the bottom.
        let corners = [[0., 0.], [3., 0.], [3., 3.], [2., 3.], [2., 1.], [1., 1.], [1., 3.], [0., 3.], [1.5, 0.]];
        let points: Vec<DVec3> = corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect();
        let vertices: Vec<u32> = (0..9).collect();
        let sides: Vec<[u32; 2]> = (0..8).map(|i| [i, (i + 1) % 8]).collect();
        let area = |others: &[[u32; 2]], holes: &[DVec3]| -> f64 {
            let triangles = triangles_within(&points, &vertices, &sides, others, 2, holes).unwrap();
            let corners = triangles.into_iter().map(|t| t.map(|v| points[v as usize]));
            corners.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).z.abs()).sum()
        };
        assert_eq!(area(&[], &[]), 7.0);
        assert_eq!(area(&[[3, 6], [0, 8], [8, 1]], &[]), 7.0);
        // Through the notch's corners, from wall to wall: a seed empties both parts.
        assert_eq!(area(&[[0, 5], [4, 1]], &[DVec3::new(1.5, 0.5, 0.0)]), 0.0);
    }
}
