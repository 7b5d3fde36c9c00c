//! A facet's own plane: its normal, and the triangles that fill its polygons, from a planar constrained triangulation (the `spade` crate).
//! Vertices are positions in `points`.

use glam::DVec3;
use rustc_hash::FxHashMap;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

use crate::geometry::predicates::collinear;

/// How far a facet's points may lie off its plane, relative to its size. Points of a slanted plane have no exact coordinates.
pub const PLANARITY: f64 = 1e-9;

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

/// The vertex that lies too far off the plane, and how far.
pub fn off_plane(points: &[DVec3], vertices: &[u32], normal: DVec3) -> Option<(u32, f64)> {
    let origin = points[vertices[0] as usize];
    let size = vertices.iter().map(|&v| points[v as usize].distance(origin)).fold(0.0, f64::max);
    let off = vertices.iter().map(|&v| (v, (points[v as usize] - origin).dot(normal).abs()));
    off.max_by(|(_, a), (_, b)| a.total_cmp(b)).filter(|&(_, off)| off > PLANARITY * size)
}

/// The triangles of the constrained planar triangulation that lie within the polygons: not reached from outside, nor from a hole's seed.
pub fn triangles_within(
    points: &[DVec3],
    vertices: &[u32],
    constraints: &[[u32; 2]],
    axis: usize,
    holes: &[DVec3],
) -> Result<Vec<[u32; 3]>, PlanarDefect> {
    // The commonest facet needs no machinery.
    if let (&[a, b, c], 3, []) = (vertices, constraints.len(), holes) {
        if constraints.iter().all(|e| e[0] != e[1] && vertices.contains(&e[0]) && vertices.contains(&e[1])) {
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
    for &[a, b] in constraints {
        let (from, to) = (handle_of[&a], handle_of[&b]);
        if !planar.can_add_constraint(from, to) {
            return Err(PlanarDefect::Crossing([a, b]));
        }
        planar.add_constraint(from, to);
    }
    let mut outside = vec![false; planar.num_all_faces()];
    let mut queue = vec![planar.outer_face().fix()];
    for &hole in holes {
        if let spade::PositionInTriangulation::OnFace(face) = planar.locate(project(hole)) {
            // Any edge knows its face in the form that includes the outer one.
            queue.push(planar.face(face).adjacent_edge().face().fix());
        }
    }
    let neighbours: FxHashMap<_, Vec<_>> = planar.directed_edges().fold(FxHashMap::default(), |mut map, edge| {
        if !edge.is_constraint_edge() {
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
