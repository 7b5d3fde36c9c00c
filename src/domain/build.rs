//! From a complex, or from the hull, to the boundary that the refinement works on.
//!
//! Each facet gets a planar constrained triangulation of its vertices (the `spade` crate), of which the part within its
//! polygons remains; it is then made Delaunay by our own circle test, so that where its points are exactly coplanar and
//! cocircular the facet has the diagonals of the triangulation in space.

use super::acute::Carrier;
use super::boundary::{edge_key, face_key, Boundary, Segment, ACUTE, ON_FACET, ON_SEGMENT};
use super::check::arrangement::Arrangement;
use super::facet::{dominant_axis, FacetTriangulation};
use super::planar::{facet_normal_within, triangles_within};
use super::plc::{Plc, PlcFacet};
use crate::geometry::predicates::orient3d;
use crate::geometry::Sign;
use crate::leavings::{join_freed_blocks, InPieces};
use crate::parted::PartedMap;
use crate::sorting::{sort, sort_unique};
use crate::triangulation::topology::{slot_of, tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::{memory, Control, DomainElement, Error};
use glam::DVec3;

/// Facets between two times that what their making has freed is put together.
const PART: usize = 1 << 10;

fn invalid(element: DomainElement, problem: impl Into<String>) -> Error {
    Error::InvalidDomain { element, problem: problem.into() }
}

impl Boundary {
    /// The boundary of a complex whose points are in the triangulation as vertices `ids`. `parts` is that complex taken apart.
    pub(crate) fn from_plc(
        t: &Triangulation,
        plc: &Plc,
        (parts, ids): (&Arrangement, &[u32]),
        control: &Control,
    ) -> Result<Boundary, Error> {
        let mut boundary = InPieces::new(Boundary::default(), control);
        // Room for as much as there is, or will be soon.
        boundary.grow_for(t, control)?;
        boundary.lengthen_for(t, control)?;
        memory::reserve(&mut boundary.segments, parts.sides.len(), "segments")?;
        memory::reserve(&mut boundary.facets, plc.facets.len(), "facets")?;
        let turns = control.turns();
        // All segments first: a facet has to know those that lie in it.
        for segment in &plc.segments {
            turns.check()?;
            boundary.add_segment(parts, ids, segment.ends, segment.marker);
        }
        for facet in &plc.facets {
            for polygon in &facet.polygons {
                for (i, &v) in polygon.iter().enumerate() {
                    turns.check()?;
                    boundary.add_segment(parts, ids, [v, polygon[(i + 1) % polygon.len()]], facet.marker);
                }
            }
        }
        let spokes = boundary.spokes(control)?;
        for index in 0..plc.facets.len() {
            control.check()?;
            if index % PART == 0 {
                join_freed_blocks();
            }
            let outline = boundary.outline((plc, parts, ids), index, &spokes, control)?;
            boundary.add_facet(t, index, &plc.facets[index], outline, control)?;
        }
        boundary.find_angles(t, &spokes, control)?;
        Ok(boundary.keep())
    }

    /// What small angles ask for.
    fn find_angles(&mut self, t: &Triangulation, spokes: &[[u32; 2]], control: &Control) -> Result<(), Error> {
        self.find_acute(t, spokes, control)?;
        self.find_shortest(t, control)?;
        self.find_sharp(t, control)?;
        control.check()
    }

    /// The hull as boundary: exactly coplanar hull facets are joined, the edges between others are segments.
    pub(crate) fn from_hull(t: &Triangulation, control: &Control) -> Result<Boundary, Error> {
        let mut boundary = InPieces::new(Boundary::default(), control);
        boundary.lengthen_for(t, control)?;
        let turns = control.turns();
        let mut ghosts = InPieces::new(Vec::new(), control);
        for g in t.topology.live() {
            turns.check()?;
            if t.topology.tet(g).is_ghost() {
                ghosts.push(g);
            }
        }
        // A list of a million that grows is moved for some ten milliseconds. What of these is not needed is never touched.
        _ = boundary.facets.try_reserve_exact(ghosts.len());
        _ = boundary.segments.try_reserve_exact(ghosts.len() / 2 * 3);
        let mut facet_of = InPieces::new(PartedMap::default(), control);
        for &seed in &*ghosts {
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
                turns.check()?;
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
            let mut normal = DVec3::ZERO;
            for &[a, b, c] in &triangles {
                turns.check()?;
                let other = (t.at(b) - t.at(a)).cross(t.at(c) - t.at(a));
                normal = if other.length_squared() >= normal.length_squared() { other } else { normal };
            }
            let facet = FacetTriangulation::new(&triangles, normal, 0, t.points(), control)?;
            for &face in &triangles {
                turns.check()?;
                boundary.subfacets.insert(face_key(face), index);
                for v in face {
                    boundary.mark(v, ON_FACET);
                    boundary.carry(v, Carrier::Vertex(v));
                }
            }
            boundary.facets.push(facet);
        }
        for &ghost in &*ghosts {
            turns.check()?;
            let tet = t.topology.tet(ghost);
            for slot in 0..3 {
                let across = tet_of(tet.n[slot]);
                let (Some(&mine), Some(&other)) = (facet_of.get(&ghost), facet_of.get(&across)) else { continue };
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
        let spokes = boundary.spokes(control)?;
        boundary.find_angles(t, &spokes, control)?;
        Ok(boundary.keep())
    }

    /// Adds a segment or a facet's side, cut at the vertices that lie on it. Parts that exist already stay as they are.
    fn add_segment(&mut self, parts: &Arrangement, ids: &[u32], ends: [u32; 2], marker: i32) {
        let ends = ends.map(|v| parts.first[v as usize]);
        let Some(&side) = parts.side_of.get(&edge_key(ends)) else { return };
        let mut own = None;
        for part in parts.sides[side as usize].parts() {
            let key = edge_key(part.map(|v| ids[v as usize]));
            if self.subsegments.contains_key(&key) {
                continue;
            }
            let segment = *own.get_or_insert_with(|| {
                let ends = ends.map(|v| ids[v as usize]);
                self.segments.push(Segment { marker, ends, facets: Vec::new() });
                self.segments.len() as u32 - 1
            });
            self.subsegments.insert(key, segment);
            for v in key {
                self.mark(v, ON_SEGMENT);
                self.carry(v, Carrier::Vertex(v));
            }
        }
    }

    /// The subsegments, from either end, in order.
    fn spokes<'a>(&self, control: &'a Control) -> Result<InPieces<'a, Vec<[u32; 2]>>, Error> {
        let turns = control.turns();
        let mut spokes = memory::room_in_pieces(2 * self.subsegments.len(), "segments", control)?;
        for &[a, b] in self.subsegments.keys() {
            turns.check()?;
            spokes.extend([[a, b], [b, a]]);
        }
        sort(&mut spokes, &control.watch())?;
        Ok(spokes)
    }

    /// What a facet's planar triangulation has to hold: corners, the parts of its sides, other vertices in it, and segments between any of these.
    fn outline(
        &self,
        (plc, parts, ids): (&Plc, &Arrangement, &[u32]),
        index: usize,
        spokes: &[[u32; 2]],
        control: &Control,
    ) -> Result<Outline, Error> {
        let (turns, watch) = (control.turns(), control.watch());
        let id = |&v: &u32| ids[v as usize];
        let mut sides: Vec<[u32; 2]> = Vec::new();
        for polygon in &plc.facets[index].polygons {
            for (i, &v) in polygon.iter().enumerate() {
                turns.check()?;
                let ends = [v, polygon[(i + 1) % polygon.len()]].map(|v| parts.first[v as usize]);
                if let Some(&side) = parts.side_of.get(&edge_key(ends)) {
                    sides.extend(parts.sides[side as usize].parts().map(|part| edge_key(part.map(|v| id(&v)))));
                }
            }
        }
        let mut vertices: Vec<u32> = parts.corners[index].iter().chain(&parts.inside[index]).map(id).collect();
        vertices.extend(sides.iter().flatten());
        sort_unique(&mut vertices, &watch)?;
        sort_unique(&mut sides, &watch)?;
        let mut others: Vec<[u32; 2]> = Vec::new();
        // A triangle has no room for a segment between its corners.
        if vertices.len() > 3 {
            for &v in &vertices {
                turns.check()?;
                let first = spokes.partition_point(|spoke| spoke[0] < v);
                let near = &spokes[first..first + spokes[first..].partition_point(|spoke| spoke[0] == v)];
                if near.len() <= vertices.len() {
                    others.extend(near.iter().filter(|[v, w]| v < w && vertices.binary_search(w).is_ok()));
                } else {
                    let joined = |w: &&u32| v < **w && self.subsegments.contains_key(&[v, **w]);
                    others.extend(vertices.iter().filter(joined).map(|&w| [v, w]));
                }
            }
        }
        others.retain(|edge| turns.go_on() && sides.binary_search(edge).is_err());
        turns.end()?;
        sort(&mut others, &watch)?;
        Ok(Outline { vertices, sides, others })
    }

    fn add_facet(
        &mut self,
        t: &Triangulation,
        index: usize,
        facet: &PlcFacet,
        outline: Outline,
        control: &Control,
    ) -> Result<(), Error> {
        let element = DomainElement::Facet(index);
        let Outline { vertices, sides, others } = outline;
        let points = t.points();
        let normal = facet_normal_within(points, &vertices, control)?.ok_or_else(|| invalid(element, "has no area"))?;
        let axis = dominant_axis(normal);
        let triangles = triangles_within(points, &vertices, (&sides, &others), axis, &facet.holes, control)?;
        let triangles = triangles.map_err(|_| invalid(element, "has sides, or segments in it, that cross"))?;
        let mut planar = FacetTriangulation::new(&triangles, normal, facet.marker, points, control)?;
        let mut constraints = sides;
        constraints.extend(others);
        sort(&mut constraints, &control.watch())?;
        planar.make_delaunay(points, |edge| constraints.binary_search(&edge_key(edge)).is_ok(), control)?;
        let turns = control.turns();
        let position = self.facets.len() as u32;
        for face in planar.triangles_within(control)? {
            turns.check()?;
            if self.subfacets.insert(face_key(face), position).is_some() {
                return Err(invalid(element, "overlaps another facet"));
            }
            for v in face {
                self.mark(v, ON_FACET);
                self.carry(v, Carrier::Vertex(v));
            }
        }
        for &edge in &constraints {
            turns.check()?;
            let Some(&segment) = self.subsegments.get(&edge) else { continue };
            let facets = &mut self.segments[segment as usize].facets;
            if planar.at_edge(edge).next().is_some() && !facets.contains(&position) {
                facets.push(position);
            }
        }
        self.facets.push(planar);
        Ok(())
    }

    /// Marks the vertices at which two segments meet at less than 60°: around these, splits go on concentric shells
    /// (J. Ruppert, 1995), or two segments would split each other for ever.
    fn find_acute(&mut self, t: &Triangulation, spokes: &[[u32; 2]], control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        for at_vertex in spokes.chunk_by(|e, f| e[0] == f[0]) {
            turns.check()?;
            let directions: Vec<DVec3> =
                at_vertex.iter().map(|&[a, b]| (t.at(b) - t.at(a)).normalize_or_zero()).collect();
            // A vertex with many segments needs no exact figure.
            let few = &directions[..directions.len().min(64)];
            let cosines = few.iter().enumerate().flat_map(|(i, u)| few[..i].iter().map(move |v| u.dot(*v)));
            let sharpness = cosines.fold(0.0, f64::max);
            // Thirteen directions have two at less than 60° (no more than twelve balls touch a thirteenth of their size).
            if sharpness > 0.5 + 1e-9 || directions.len() > 12 {
                self.mark(at_vertex[0][0], ACUTE);
                self.sharpness.insert(at_vertex[0][0], sharpness);
            }
        }
        Ok(())
    }
}

/// The constraints of a facet's triangulation, and the vertices that it needs for them.
struct Outline {
    vertices: Vec<u32>,
    sides: Vec<[u32; 2]>,
    /// Segments between its vertices that are none of its sides.
    others: Vec<[u32; 2]>,
}
