//! A facet's own plane: its normal, and the triangles that fill its polygons, from a planar constrained triangulation (the `spade` crate).
//! Vertices are positions in `points`.

use glam::DVec3;
use spade::handles::{DirectedEdgeHandle, FixedVertexHandle};
use spade::{CdtEdge, ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation as _};

use super::boundary::edge_key;
use super::facet::dominant_axis;
use super::plc::{Plc, PlcFacet};
use crate::geometry::predicates::{collinear, orient2d};
use crate::leavings::{InPieces, Leavings};
use crate::parted::PartedMap;
use crate::sorting::sort_unique;
use crate::triangulation::spatial_order;
use crate::{memory, Control, Error};

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
pub fn extent(points: &[DVec3], control: &Control) -> Result<f64, Error> {
    let mut corners: Option<[DVec3; 2]> = None;
    let turns = control.turns();
    for &p in points {
        turns.check()?;
        if p.is_finite() {
            corners = corners.map(|[low, high]| [low.min(p), high.max(p)]).or(Some([p; 2]));
        }
    }
    Ok(corners.map_or(0.0, |[low, high]| low.distance(high)))
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
    facet_normal_within(points, vertices, Control::never()).unwrap_or_default()
}

/// [`facet_normal`], unless the control says stop.
pub fn facet_normal_within(points: &[DVec3], vertices: &[u32], control: &Control) -> Result<Option<DVec3>, Error> {
    let (at, turns) = (|v: u32| points[v as usize], control.turns());
    let by = |f: &dyn Fn(DVec3) -> f64| {
        let all = vertices.iter().take_while(|_| turns.go_on()).map(|&v| at(v));
        all.max_by(|&a, &b| f(a).total_cmp(&f(b)))
    };
    let origin = vertices.first().map_or(DVec3::ZERO, |&v| at(v));
    let far = by(&|p| p.distance_squared(origin)).unwrap_or(origin);
    let third = by(&|p| (p - origin).cross(far - origin).length_squared()).unwrap_or(origin);
    turns.end()?;
    if collinear(origin, far, third) {
        return Ok(None);
    }
    Ok((far - origin).cross(third - origin).try_normalize())
}

/// The size of a facet with these corners: how far the farthest is from the first.
pub fn size_from(points: &[DVec3], vertices: &[u32]) -> f64 {
    let origin = points[vertices[0] as usize];
    vertices.iter().map(|&v| points[v as usize].distance(origin)).fold(0.0, f64::max)
}

/// The vertex that lies too far off the plane, and how far. All points have this [`extent`].
pub fn off_plane(points: &[DVec3], vertices: &[u32], normal: DVec3, extent: f64) -> Option<(u32, f64)> {
    off_plane_within(points, vertices, normal, extent, Control::never()).unwrap_or_default()
}

/// [`off_plane`], unless the control says stop.
pub fn off_plane_within(
    points: &[DVec3],
    vertices: &[u32],
    normal: DVec3,
    extent: f64,
    control: &Control,
) -> Result<Option<(u32, f64)>, Error> {
    let (origin, turns) = (points[vertices[0] as usize], control.turns());
    let (mut size, mut farthest) = (0.0f64, (vertices[0], 0.0));
    for &v in vertices {
        turns.check()?;
        let from_origin = points[v as usize] - origin;
        size = size.max(from_origin.length());
        let off = from_origin.dot(normal).abs();
        if off >= farthest.1 {
            farthest = (v, off);
        }
    }
    Ok(Some(farthest).filter(|&(_, off)| off > planarity(size, extent)))
}

/// Vertices that are put in as they come; of more, one after the other in space.
const FEW: usize = 1 << 10;

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// The planar triangulation is the `spade` crate's: it goes in one piece, unless the control keeps it.
#[derive(Default)]
struct Whole(Cdt);

impl Leavings for Whole {
    fn give_back(&mut self) -> bool {
        false
    }
}

/// The triangles of the constrained planar triangulation that lie within the polygons: not reached from outside, nor from a hole's seed. Only `sides`, those of
/// the polygons, bound what is outside; edges that `others` need in it do not. `vertices` are in order. [`Error::Cancelled`] when the control says stop.
pub fn triangles_within(
    points: &[DVec3],
    vertices: &[u32],
    (sides, others): (&[[u32; 2]], &[[u32; 2]]),
    axis: usize,
    holes: &[DVec3],
    control: &Control,
) -> Result<Result<Vec<[u32; 3]>, PlanarDefect>, Error> {
    debug_assert!(vertices.is_sorted());
    // The commonest facet needs no machinery.
    if let (&[a, b, c], 3, [], []) = (vertices, sides.len(), others, holes) {
        if sides.iter().all(|e| e[0] != e[1] && vertices.contains(&e[0]) && vertices.contains(&e[1])) {
            return Ok(Ok(vec![[a, b, c]]));
        }
    }
    let place = |v: u32| points[v as usize];
    let project = |p: DVec3| Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    // Made large enough at once: its lists would be moved as they grow.
    let (count, border) = (vertices.len(), sides.len());
    let large = || Whole(Cdt::with_capacity(count, 3 * count + border, 2 * count + border));
    let mut planar = InPieces::new(if count > FEW { large() } else { Whole::default() }, control);
    let planar = &mut planar.0;
    let order = if vertices.len() > FEW {
        let mut places = memory::room_in_pieces(vertices.len(), "facet", control)?;
        let turns = control.turns();
        for &v in vertices {
            turns.check()?;
            places.push(place(v));
        }
        spatial_order(&places, control)?
    } else {
        (0..vertices.len() as u32).collect()
    };
    // By position in `vertices`, and by position in the triangulation.
    let mut handles: Vec<Option<FixedVertexHandle>> = vec![None; vertices.len()];
    let mut vertex_of: Vec<u32> = Vec::with_capacity(vertices.len());
    for i in order {
        control.check()?;
        let v = vertices[i as usize];
        let Ok(handle) = planar.insert(project(place(v))) else { return Ok(Err(PlanarDefect::Range(v))) };
        match vertex_of.get(handle.index()) {
            Some(&other) => return Ok(Err(PlanarDefect::SamePlace(other, v))),
            None => vertex_of.push(v),
        }
        handles[i as usize] = Some(handle);
    }
    let handle_of = |v: u32| vertices.binary_search(&v).ok().and_then(|i| handles[i]);
    // A side that a vertex lies on becomes several edges.
    let mut bounding = InPieces::new(PartedMap::default(), control);
    for (i, &[a, b]) in sides.iter().chain(others).enumerate() {
        control.check()?;
        let crossing = Ok(Err(PlanarDefect::Crossing([a, b])));
        let (Some(from), Some(to)) = (handle_of(a), handle_of(b)) else { return crossing };
        if !planar.can_add_constraint(from, to) {
            return crossing;
        }
        let parts = planar.try_add_constraint(from, to);
        if i < sides.len() {
            let ends = |edge| planar.directed_edge(edge).vertices().map(|v| vertex_of[v.fix().index()]);
            for edge in parts {
                bounding.insert(edge_key(ends(edge)), ());
            }
        }
    }
    let is_side = |edge: DirectedEdgeHandle<_, _, CdtEdge<()>, ()>| {
        let ends = || edge.vertices().map(|v| vertex_of[v.fix().index()]);
        edge.is_constraint_edge() && bounding.contains_key(&edge_key(ends()))
    };
    let mut outside = vec![false; planar.num_all_faces()];
    let mut queue = InPieces::new(vec![planar.outer_face().fix()], control);
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
    let turns = control.turns();
    while let Some(face) = queue.pop() {
        if std::mem::replace(&mut outside[face.index()], true) {
            continue;
        }
        let mut look = |edge: DirectedEdgeHandle<_, _, CdtEdge<()>, ()>| {
            // Of an edge of the hull both sides are asked for.
            let other = if edge.face().fix() == face { edge.rev().face().fix() } else { edge.face().fix() };
            if !is_side(edge) {
                queue.push(other);
            }
            turns.check()
        };
        match planar.face(face).as_inner() {
            Some(face) => face.adjacent_edges().into_iter().try_for_each(&mut look)?,
            // Its edges are those of the hull, seen from outside.
            None => planar.convex_hull().try_for_each(&mut look)?,
        }
    }
    let mut triangles = InPieces::new(Vec::new(), control);
    for face in planar.inner_faces() {
        turns.check()?;
        if !outside[face.fix().index()] {
            triangles.push(face.vertices().map(|v| vertex_of[v.fix().index()]));
        }
    }
    Ok(Ok(triangles.keep()))
}

/// The corners of a facet, and its sides, lower corner first; both in order.
pub fn outline_of(facet: &PlcFacet, control: &Control) -> Result<(Vec<u32>, Vec<[u32; 2]>), Error> {
    let watch = control.watch();
    let mut vertices: Vec<u32> = facet.polygons.iter().flatten().copied().collect();
    sort_unique(&mut vertices, &watch)?;
    let mut sides = Vec::new();
    for polygon in facet.polygons.iter().filter(|polygon| polygon.len() > 1) {
        sides.extend((0..polygon.len()).map(|i| edge_key([polygon[i], polygon[(i + 1) % polygon.len()]])));
    }
    sort_unique(&mut sides, &watch)?;
    Ok((vertices, sides))
}

/// A facet's triangles as seen along an axis.
type Seen = (usize, Vec<[u32; 3]>);

/// The dominant axis of a facet's normal, and its triangles; none when it can't be triangulated.
pub fn triangles_of_facet(points: &[DVec3], facet: &PlcFacet, control: &Control) -> Result<Option<Seen>, Error> {
    let (vertices, sides) = outline_of(facet, control)?;
    let Some(normal) = facet_normal(points, &vertices) else { return Ok(None) };
    let axis = dominant_axis(normal);
    let triangles = triangles_within(points, &vertices, (&sides, &[]), axis, &facet.holes, control)?;
    Ok(triangles.ok().map(|triangles| (axis, triangles)))
}

/// Seeds in the parts within a facet's outline that none of the `members` covers, which it is the union of: one in each triangle of them.
pub fn gaps(plc: &Plc, facet: &PlcFacet, members: &[u32], control: &Control) -> Result<Vec<DVec3>, Error> {
    let points = &plc.points;
    let (vertices, constraints) = outline_of(facet, control)?;
    let Some(normal) = facet_normal(points, &vertices) else { return Ok(Vec::new()) };
    let axis = dominant_axis(normal);
    // A member lies on one side of each of its sides that stay. The triangle there belongs to the facet if it is on that side.
    let mut inner = InPieces::new(PartedMap::default(), control);
    for &member in members {
        let (vertices, sides) = outline_of(&plc.facets[member as usize], control)?;
        let Ok(own) = triangles_within(points, &vertices, (&sides, &[]), axis, &[], control)? else {
            return Ok(Vec::new());
        };
        for triangle in own {
            for i in 0..3 {
                inner.insert(edge_key([triangle[i], triangle[(i + 1) % 3]]), triangle[(i + 2) % 3]);
            }
        }
    }
    let Ok(triangles) = triangles_within(points, &vertices, (&constraints, &[]), axis, &[], control)? else {
        return Ok(Vec::new());
    };
    let side_of = |a: u32, b: u32, c: u32| orient2d(axis, points[a as usize], points[b as usize], points[c as usize]);
    let mut seeds = Vec::new();
    let turns = control.turns();
    for triangle in triangles {
        turns.check()?;
        let outer = (0..3).any(|i| {
            let side = edge_key([triangle[i], triangle[(i + 1) % 3]]);
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
    Ok(seeds)
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
        let count = |holes: &[DVec3]| {
            triangles_within(&points, &vertices, (&sides, &[]), 2, holes, &Control::new()).unwrap().unwrap().len()
        };
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
            let triangles = triangles_within(&points, &vertices, (&sides, others), 2, holes, &Control::new());
            let triangles = triangles.unwrap().unwrap();
            let corners = triangles.into_iter().map(|t| t.map(|v| points[v as usize]));
            corners.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).z.abs()).sum()
        };
        assert_eq!(area(&[], &[]), 7.0);
        assert_eq!(area(&[[3, 6], [0, 8], [8, 1]], &[]), 7.0);
        // Through the notch's corners, from wall to wall: a seed empties both parts.
        assert_eq!(area(&[[0, 5], [4, 1]], &[DVec3::new(1.5, 0.5, 0.0)]), 0.0);
    }
}
