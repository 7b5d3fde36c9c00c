//! From a complex, or from the hull, to the boundary that the refinement works on.
//!
//! Each facet gets a planar constrained triangulation of its vertices (the `spade` crate), of which the part within its
//! polygons remains; it is then made Delaunay by our own circle test, so that where its points are exactly coplanar and
//! cocircular the facet has the diagonals of the triangulation in space.

use glam::DVec3;
use rustc_hash::FxHashMap;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

use super::acute::Carrier;
use super::boundary::{edge_key, face_key, Boundary, Segment, ACUTE, ON_FACET, ON_SEGMENT};
use super::facet::{dominant_axis, FacetTriangulation};
use super::plc::{Plc, PlcFacet};
use crate::geometry::predicates::{collinear, orient3d};
use crate::geometry::Sign;
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::{DomainElement, Error};

/// How far a facet's points may lie off its plane, relative to its size. Points of a slanted plane have no exact coordinates.
const PLANARITY: f64 = 1e-9;

/// Labels of regions have 16 bits, of which a few values mean something else.
const MAX_REGIONS: usize = 60_000;

fn invalid(element: DomainElement, problem: impl Into<String>) -> Error {
    Error::InvalidDomain { element, problem: problem.into() }
}

impl Plc {
    /// Checks what needs no geometry: that every number names a point, and that polygons aren't empty.
    pub(crate) fn check_references(&self) -> Result<(), Error> {
        let count = self.points.len();
        let known = |v: u32, element| {
            if (v as usize) < count {
                Ok(())
            } else {
                Err(invalid(element, format!("names point {v}, but there are only {count} points")))
            }
        };
        for (i, segment) in self.segments.iter().enumerate() {
            for v in segment.ends {
                known(v, DomainElement::Segment(i))?;
            }
        }
        for (i, facet) in self.facets.iter().enumerate() {
            let element = DomainElement::Facet(i);
            if facet.polygons.is_empty() {
                return Err(invalid(element, "has no polygon"));
            }
            for polygon in &facet.polygons {
                if polygon.is_empty() {
                    return Err(invalid(element, "has a polygon without points"));
                }
                for &v in polygon {
                    known(v, element)?;
                }
            }
        }
        let finite = |p: DVec3, element| {
            if p.is_finite() {
                Ok(())
            } else {
                Err(invalid(element, "has a seed that is not finite"))
            }
        };
        for (i, facet) in self.facets.iter().enumerate() {
            facet.holes.iter().try_for_each(|&hole| finite(hole, DomainElement::Facet(i)))?;
        }
        if self.regions.len() > MAX_REGIONS {
            return Err(invalid(
                DomainElement::Region(MAX_REGIONS),
                format!("is one more than the {MAX_REGIONS} that there can be"),
            ));
        }
        for (i, &hole) in self.holes.iter().enumerate() {
            finite(hole, DomainElement::Hole(i))?;
        }
        for (i, region) in self.regions.iter().enumerate() {
            finite(region.point, DomainElement::Region(i))?;
        }
        Ok(())
    }
}

impl Boundary {
    /// The boundary of a complex whose points are in the triangulation as vertices `ids`.
    pub(crate) fn from_plc(t: &Triangulation, plc: &Plc, ids: &[u32]) -> Result<Boundary, Error> {
        let mut boundary = Boundary::default();
        let vertex = |i: u32| ids[i as usize];
        for (i, segment) in plc.segments.iter().enumerate() {
            let ends = segment.ends.map(vertex);
            if ends[0] == ends[1] {
                return Err(invalid(DomainElement::Segment(i), "has length 0"));
            }
            boundary.add_segment(t, ends, segment.marker, None);
        }
        for (i, facet) in plc.facets.iter().enumerate() {
            let facet = PlcFacet {
                polygons: facet.polygons.iter().map(|p| p.iter().map(|&v| vertex(v)).collect()).collect(),
                ..facet.clone()
            };
            boundary.add_facet(t, i, &facet)?;
        }
        boundary.find_acute(t);
        Ok(boundary)
    }

    /// The hull as boundary: exactly coplanar hull facets are joined, the edges between others are segments.
    pub(crate) fn from_hull(t: &Triangulation) -> Boundary {
        let mut boundary = Boundary::default();
        let ghosts: Vec<u32> = t.topology.live().filter(|&g| t.topology.tet(g).is_ghost()).collect();
        let mut facet_of: FxHashMap<u32, u32> = FxHashMap::default();
        for &seed in &ghosts {
            if facet_of.contains_key(&seed) {
                continue;
            }
            let index = boundary.facets.len() as u32;
            facet_of.insert(seed, index);
            let [a, b, c] = t.topology.tet(seed).face(3);
            let corners = [a, b, c].map(|v| t.at(v));
            let mut group = vec![seed];
            let mut triangles = Vec::new();
            while let Some(ghost) = group.pop() {
                let tet = t.topology.tet(ghost);
                triangles.push(tet.face(3));
                for slot in 0..3 {
                    let across = tet.n[slot];
                    let apex = t.topology.tet(tet_of(across)).v[slot_of(across)];
                    let coplanar = orient3d(corners[0], corners[1], corners[2], t.at(apex)) == Sign::Zero;
                    if coplanar && !facet_of.contains_key(&tet_of(across)) {
                        facet_of.insert(tet_of(across), index);
                        group.push(tet_of(across));
                    }
                }
            }
            // The largest triangle's normal: a slender one's may be lost to rounding.
            let normals = triangles.iter().map(|&[a, b, c]| (t.at(b) - t.at(a)).cross(t.at(c) - t.at(a)));
            let normal = normals.max_by(|m, n| m.length_squared().total_cmp(&n.length_squared())).unwrap_or_default();
            let facet = FacetTriangulation::new(&triangles, normal, 0, t.points());
            for &face in &triangles {
                boundary.subfacets.insert(face_key(face), index);
                for v in face {
                    boundary.mark(v, ON_FACET);
                    boundary.carry(v, Carrier::Vertex(v));
                }
            }
            boundary.facets.push(facet);
        }
        for &ghost in &ghosts {
            let tet = t.topology.tet(ghost);
            for slot in 0..3 {
                let across = tet_of(tet.n[slot]);
                let (mine, other) = (facet_of[&ghost], facet_of[&across]);
                if mine < other {
                    let mut ends = tet.v.into_iter().filter(|&v| v != GHOST && v != tet.v[slot]);
                    if let (Some(a), Some(b)) = (ends.next(), ends.next()) {
                        let segment = boundary.segments.len() as u32;
                        boundary.segments.push(Segment { marker: 0, ends: [a, b], facets: vec![mine, other] });
                        boundary.subsegments.insert(edge_key([a, b]), segment);
                        for v in [a, b] {
                            boundary.mark(v, ON_SEGMENT);
                            boundary.carry(v, Carrier::Vertex(v));
                        }
                    }
                }
            }
        }
        boundary.find_acute(t);
        boundary
    }

    /// Adds a segment, cut at the vertices that lie on it. Where parts exist already they stay, and the facet is noted at them.
    /// Returns the parts.
    fn add_segment(&mut self, t: &Triangulation, [a, b]: [u32; 2], marker: i32, facet: Option<u32>) -> Vec<[u32; 2]> {
        let mut chain = vec![a];
        if t.topology.find_edge(a, b).is_none() {
            let (p, q) = (t.at(a), t.at(b));
            let (low, high) = (p.min(q), p.max(q));
            let inside = |v: u32| {
                let r = t.at(v);
                v != a && v != b && r.cmpge(low).all() && r.cmple(high).all() && collinear(p, q, r)
            };
            let mut between: Vec<u32> = t.vertices().filter(|&v| inside(v)).collect();
            between.sort_unstable_by(|&v, &w| t.at(v).distance_squared(p).total_cmp(&t.at(w).distance_squared(p)));
            chain.extend(between);
        }
        chain.push(b);
        let mut own = None;
        let mut parts = Vec::with_capacity(chain.len() - 1);
        for pair in chain.windows(2) {
            let key = edge_key([pair[0], pair[1]]);
            let segment = match self.subsegments.get(&key) {
                Some(&segment) => segment,
                None => {
                    let segment = *own.get_or_insert_with(|| {
                        self.segments.push(Segment { marker, ends: [a, b], facets: Vec::new() });
                        self.segments.len() as u32 - 1
                    });
                    self.subsegments.insert(key, segment);
                    segment
                }
            };
            if let Some(facet) = facet {
                let facets = &mut self.segments[segment as usize].facets;
                if !facets.contains(&facet) {
                    facets.push(facet);
                }
            }
            for &v in pair {
                self.mark(v, ON_SEGMENT);
                self.carry(v, Carrier::Vertex(v));
            }
            parts.push(key);
        }
        parts
    }

    fn add_facet(&mut self, t: &Triangulation, index: usize, facet: &PlcFacet) -> Result<(), Error> {
        let element = DomainElement::Facet(index);
        let mut vertices: Vec<u32> = facet.polygons.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let normal =
            facet_normal(t, &vertices).ok_or_else(|| invalid(element, "has no area: its points lie on a line"))?;
        check_planar(t, &vertices, normal).map_err(|problem| invalid(element, problem))?;
        let position = self.facets.len() as u32;
        let mut constraints: Vec<[u32; 2]> = Vec::new();
        for polygon in &facet.polygons {
            for i in 0..polygon.len() {
                let side = [polygon[i], polygon[(i + 1) % polygon.len()]];
                if side[0] != side[1] {
                    constraints.extend(self.add_segment(t, side, facet.marker, Some(position)));
                }
            }
        }
        constraints.sort_unstable();
        constraints.dedup();
        vertices.extend(constraints.iter().flatten());
        let mut planar = planar_triangulation(t, &mut vertices, &constraints, normal, facet)
            .map_err(|problem| invalid(element, problem))?;
        // Other vertices in the facet keep one of its triangles from being a face. Only then is it worth to look through all.
        if planar.triangles().into_iter().any(|face| t.topology.find_face(face).is_none()) {
            vertices.extend(vertices_on_plane(t, &vertices));
            planar = planar_triangulation(t, &mut vertices, &constraints, normal, facet)
                .map_err(|problem| invalid(element, problem))?;
        }
        for face in planar.triangles() {
            if self.subfacets.insert(face_key(face), position).is_some() {
                return Err(invalid(element, "overlaps another facet"));
            }
            for v in face {
                self.mark(v, ON_FACET);
                self.carry(v, Carrier::Vertex(v));
            }
        }
        self.facets.push(planar);
        Ok(())
    }

    /// Marks the vertices at which two segments meet at less than 60°: around these, splits go on concentric shells
    /// (J. Ruppert, 1995), or two segments would split each other for ever.
    fn find_acute(&mut self, t: &Triangulation) {
        let mut ends: Vec<[u32; 2]> = self.subsegments.keys().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
        ends.sort_unstable();
        for at_vertex in ends.chunk_by(|e, f| e[0] == f[0]) {
            let directions: Vec<DVec3> =
                at_vertex.iter().map(|&[a, b]| (t.at(b) - t.at(a)).normalize_or_zero()).collect();
            let acute =
                directions.iter().enumerate().any(|(i, u)| directions[..i].iter().any(|v| u.dot(*v) > 0.5 + 1e-9));
            if acute {
                self.mark(at_vertex[0][0], ACUTE);
            }
        }
    }
}

/// The planar triangulation of a facet with these vertices, which are sorted on the way.
fn planar_triangulation(
    t: &Triangulation,
    vertices: &mut Vec<u32>,
    constraints: &[[u32; 2]],
    normal: DVec3,
    facet: &PlcFacet,
) -> Result<FacetTriangulation, String> {
    vertices.sort_unstable();
    vertices.dedup();
    let triangles = triangles_within(t, vertices, constraints, dominant_axis(normal), &facet.holes)?;
    let mut planar = FacetTriangulation::new(&triangles, normal, facet.marker, t.points());
    planar.make_delaunay(t.points(), |edge| constraints.binary_search(&edge_key(edge)).is_ok());
    Ok(planar)
}

/// A normal of the plane that the vertices span, from the corner triple of the largest area found by two scans.
fn facet_normal(t: &Triangulation, vertices: &[u32]) -> Option<DVec3> {
    let origin = t.at(*vertices.first()?);
    let by = |f: &dyn Fn(DVec3) -> f64| vertices.iter().map(|&v| t.at(v)).max_by(|&a, &b| f(a).total_cmp(&f(b)));
    let far = by(&|p| p.distance_squared(origin))?;
    let third = by(&|p| (p - origin).cross(far - origin).length_squared())?;
    if collinear(origin, far, third) {
        return None;
    }
    (far - origin).cross(third - origin).try_normalize()
}

fn check_planar(t: &Triangulation, vertices: &[u32], normal: DVec3) -> Result<(), String> {
    let origin = t.at(vertices[0]);
    let size = vertices.iter().map(|&v| t.at(v).distance(origin)).fold(0.0, f64::max);
    let off = |v: u32| (t.at(v) - origin).dot(normal).abs();
    match vertices.iter().copied().max_by(|&v, &w| off(v).total_cmp(&off(w))) {
        Some(v) if off(v) > PLANARITY * size => {
            let p = t.at(v);
            Err(format!(
                "is not planar: its corner ({}, {}, {}) lies {:e} off the plane of the others",
                p.x,
                p.y,
                p.z,
                off(v)
            ))
        }
        _ => Ok(()),
    }
}

/// Vertices within the facet's bounding box that lie exactly on the plane of its first three independent corners.
fn vertices_on_plane(t: &Triangulation, corners: &[u32]) -> Vec<u32> {
    let (low, high) = corners
        .iter()
        .map(|&v| t.at(v))
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let (a, b) = (t.at(corners[0]), t.at(corners[1]));
    let Some(c) = corners[2..].iter().map(|&v| t.at(v)).find(|&c| !collinear(a, b, c)) else { return Vec::new() };
    t.vertices()
        .filter(|&v| {
            let p = t.at(v);
            p.cmpge(low).all() && p.cmple(high).all() && orient3d(a, b, c, p) == Sign::Zero
        })
        .collect()
}

/// The triangles of the constrained planar triangulation that lie within the polygons: not reached from outside, nor from a hole's seed.
fn triangles_within(
    t: &Triangulation,
    vertices: &[u32],
    constraints: &[[u32; 2]],
    axis: usize,
    holes: &[DVec3],
) -> Result<Vec<[u32; 3]>, String> {
    let project = |p: DVec3| Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    let mut planar: ConstrainedDelaunayTriangulation<Point2<f64>> = ConstrainedDelaunayTriangulation::new();
    let mut handle_of = FxHashMap::default();
    let mut vertex_of = FxHashMap::default();
    for &v in vertices {
        let handle = planar.insert(project(t.at(v))).map_err(|e| format!("can't be triangulated: {e}"))?;
        handle_of.insert(v, handle);
        if let Some(other) = vertex_of.insert(handle, v) {
            return Err(format!("has points {other} and {v} at one place of its plane"));
        }
    }
    for &[a, b] in constraints {
        let (from, to) = (handle_of[&a], handle_of[&b]);
        if !planar.can_add_constraint(from, to) {
            let (p, q) = (t.at(a), t.at(b));
            return Err(format!(
                "has sides that cross, one from ({}, {}, {}) to ({}, {}, {})",
                p.x, p.y, p.z, q.x, q.y, q.z
            ));
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
