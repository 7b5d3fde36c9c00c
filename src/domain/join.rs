//! Facets that lie in one plane and share a side become one facet. The triangles of a surface's flat parts are then one polygon each, and the edges
//! between them, which often meet at small angles, are no segments that have to be kept.

use rustc_hash::FxHashMap;

use super::boundary::{edge_key, face_key};
use super::facet::{dominant_axis, FacetTriangulation};
use super::planar::{extent, facet_normal, off_plane, planarity, triangles_of_facet, triangles_within};
use super::plc::{Plc, PlcFacet};
use crate::sorting::{sort, sort_by};
use crate::{Control, DVec3, Error};

impl Plc {
    /// Joins facets of one marker that share a side with no third facet there, and whose normals differ by at most `degrees`, as long as
    /// all of their points stay within the planarity that a facet must have. Only facets of a single polygon without holes take part, and no side
    /// that is a listed segment is given up. Returns the position of each old facet among the new ones.
    ///
    /// The points stay, and the surface too, up to that planarity. Points that are left within a facet become vertices of its
    /// own. Cost: n log n in the number of sides.
    pub fn join_coplanar(&mut self, degrees: f64) -> Vec<u32> {
        // Nobody cancels it.
        self.join_coplanar_within(degrees, &Control::new()).unwrap_or_default()
    }

    /// [`join_coplanar`](Self::join_coplanar); [`Error::Cancelled`] when the control says stop. Nothing has changed then.
    pub fn join_coplanar_within(&mut self, degrees: f64, control: &Control) -> Result<Vec<u32>, Error> {
        control.check()?;
        let turns = control.turns();
        let count = self.facets.len();
        let mut normals: Vec<Option<DVec3>> = Vec::with_capacity(count);
        let mut at_side: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
        for (i, facet) in self.facets.iter().enumerate() {
            turns.check()?;
            normals.push(self.single_normal(facet));
            for side in sides(facet) {
                at_side.entry(side).or_default().push(i as u32);
            }
        }
        for segment in &self.segments {
            at_side.remove(&edge_key(segment.ends));
        }
        let cosine = degrees.clamp(0.0, 90.0).to_radians().cos();
        let extent = extent(&self.points);
        let area = |i: usize| normals[i].map_or(0.0, |_| self.size_of(i));
        // Large ones first: their normals are the most exact.
        let mut seeds: Vec<(f64, usize)> = (0..count).map(|i| (area(i), i)).collect();
        sort_by(&mut seeds, &control.watch(), |(a, i), (b, j)| b.total_cmp(a).then(i.cmp(j)))?;
        let mut groups: Vec<Vec<u32>> = Vec::new();
        let mut taken = vec![false; count];
        for (_, seed) in seeds {
            turns.check()?;
            if taken[seed] {
                continue;
            }
            taken[seed] = true;
            let mut members = vec![seed as u32];
            if let Some(normal) = normals[seed] {
                let mut plane = Flat::new(self, &self.facets[seed], normal, extent);
                let mut next = 0;
                while next < members.len() {
                    turns.check()?;
                    for side in sides(&self.facets[members[next] as usize]) {
                        let Some(&[f, g]) = at_side.get(&side).map(Vec::as_slice) else { continue };
                        let other = if f == members[next] { g } else { f } as usize;
                        let Some(theirs) = normals[other] else { continue };
                        let alike = theirs.dot(normal).abs() >= cosine - 1e-12
                            && self.facets[other].marker == self.facets[seed].marker;
                        if !taken[other] && alike && plane.admit(self, &self.facets[other]) {
                            taken[other] = true;
                            members.push(other as u32);
                        }
                    }
                    next += 1;
                }
            }
            groups.push(members);
        }
        groups.sort_unstable_by_key(|members| members.iter().min().copied());
        let mut facets: Vec<PlcFacet> = Vec::new();
        let mut members_of: Vec<Vec<u32>> = Vec::new();
        for members in groups {
            turns.check()?;
            let union = self.union(&members, &at_side);
            if members.len() == 1 || self.covers(&union, &members) {
                facets.push(union);
                members_of.push(members);
                continue;
            }
            // The outline does not say where the facet is (rings that touch, folds): its parts stay apart.
            self.keep_apart(&members, &mut facets, &mut members_of);
        }
        self.part_overlapping(&mut facets, &mut members_of, extent, control)?;
        let mut group = vec![u32::MAX; count];
        for (i, members) in members_of.iter().enumerate() {
            members.iter().for_each(|&member| group[member as usize] = i as u32);
        }
        self.facets = facets;
        Ok(group)
    }

    /// Puts facets of before behind the list, each by itself.
    fn keep_apart(&self, members: &[u32], facets: &mut Vec<PlcFacet>, members_of: &mut Vec<Vec<u32>>) {
        for &member in members {
            facets.push(self.facets[member as usize].clone());
            members_of.push(vec![member]);
        }
    }

    /// Takes joined facets apart that would have a triangle in common with another one. Two sides of something very thin are so.
    fn part_overlapping(
        &self,
        facets: &mut Vec<PlcFacet>,
        members_of: &mut Vec<Vec<u32>>,
        extent: f64,
        control: &Control,
    ) -> Result<(), Error> {
        let turns = control.turns();
        while members_of.iter().any(|members| members.len() > 1) {
            // As in the boundary, sides of other facets between two points of a facet are kept.
            let mut all: Vec<[u32; 2]> = facets.iter().flat_map(sides).collect();
            all.extend(self.segments.iter().map(|segment| edge_key(segment.ends)));
            sort(&mut all, &control.watch())?;
            all.dedup();
            let mut first_with: FxHashMap<[u32; 3], u32> = FxHashMap::default();
            let mut overlaps = vec![false; facets.len()];
            for (i, facet) in facets.iter().enumerate() {
                turns.check()?;
                for triangle in self.final_triangles(facet, &all, extent) {
                    let first = *first_with.entry(face_key(triangle)).or_insert(i as u32) as usize;
                    if first != i {
                        (overlaps[i], overlaps[first]) = (true, true);
                    }
                }
            }
            if !overlaps.iter().zip(&*members_of).any(|(&overlaps, members)| overlaps && members.len() > 1) {
                return Ok(());
            }
            let (old, old_members) = (std::mem::take(facets), std::mem::take(members_of));
            for ((facet, members), overlaps) in old.into_iter().zip(old_members).zip(overlaps) {
                if overlaps {
                    self.keep_apart(&members, facets, members_of);
                } else {
                    facets.push(facet);
                    members_of.push(members);
                }
            }
        }
        Ok(())
    }

    /// The triangles that a facet begins with as a domain's boundary.
    fn final_triangles(&self, facet: &PlcFacet, all: &[[u32; 2]], extent: f64) -> Vec<[u32; 3]> {
        if let ([polygon], []) = (&facet.polygons[..], &facet.holes[..]) {
            if let &[a, b, c] = &polygon[..] {
                return vec![[a, b, c]];
            }
        }
        let mut vertices: Vec<u32> = facet.polygons.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        // What is defective has none.
        let usable = |p: &DVec3| crate::geometry::check_range(0, *p).is_ok();
        let known = vertices.iter().all(|&v| self.points.get(v as usize).is_some_and(usable));
        let known = known && facet.holes.iter().all(|hole| hole.is_finite());
        let normal = known.then(|| facet_normal(&self.points, &vertices)).flatten();
        let flat = |normal: &DVec3| off_plane(&self.points, &vertices, *normal, extent).is_none();
        let Some(normal) = normal.filter(flat) else { return Vec::new() };
        let of = |&v: &u32| all[all.partition_point(|side| side[0] < v)..].iter().take_while(move |side| side[0] == v);
        let fixed: Vec<[u32; 2]> =
            vertices.iter().flat_map(of).copied().filter(|side| vertices.binary_search(&side[1]).is_ok()).collect();
        let axis = dominant_axis(normal);
        let mut own: Vec<[u32; 2]> = sides(facet).collect();
        own.sort_unstable();
        own.dedup();
        let mut others = fixed.clone();
        others.retain(|side| own.binary_search(side).is_err());
        let Ok(triangles) = triangles_within(&self.points, &vertices, &own, &others, axis, &facet.holes) else {
            return Vec::new();
        };
        let mut planar = FacetTriangulation::new(&triangles, normal, 0, &self.points);
        planar.make_delaunay(&self.points, |edge| fixed.binary_search(&edge_key(edge)).is_ok());
        planar.triangles()
    }

    /// A measure of a facet's size: the area of its first corners' triangle, or more.
    fn size_of(&self, facet: usize) -> f64 {
        let polygon = &self.facets[facet].polygons[0];
        let at = |v: u32| self.points[v as usize];
        let corners = polygon[1..].windows(2).map(|w| (at(w[0]) - at(polygon[0])).cross(at(w[1]) - at(polygon[0])));
        corners.sum::<DVec3>().length()
    }

    /// Whether a union fills the area that its members fill, all seen along one axis.
    fn covers(&self, union: &PlcFacet, members: &[u32]) -> bool {
        let Some((axis, whole)) = triangles_of_facet(&self.points, union) else { return false };
        let area = |triangles: &[[u32; 3]]| -> f64 {
            let corners = triangles.iter().map(|t| t.map(|v| self.points[v as usize]));
            corners.map(|[a, b, c]| 0.5 * (b - a).cross(c - a)[axis].abs()).sum()
        };
        let part = |&member: &u32| triangles_of_facet(&self.points, &self.facets[member as usize]);
        let Some(parts) = members.iter().map(|m| part(m).map(|(_, t)| area(&t))).sum::<Option<f64>>() else {
            return false;
        };
        (area(&whole) - parts).abs() <= 1e-9 * parts
    }

    fn single_normal(&self, facet: &PlcFacet) -> Option<DVec3> {
        let [polygon] = &facet.polygons[..] else { return None };
        let known = polygon.iter().all(|&v| self.points.get(v as usize).is_some_and(|p| p.is_finite()));
        let usable = facet.holes.is_empty() && polygon.len() > 2 && known;
        if usable {
            facet_normal(&self.points, polygon)
        } else {
            None
        }
    }

    /// The facet that some facets are together: their sides without those between two of them.
    fn union(&self, members: &[u32], at_side: &FxHashMap<[u32; 2], Vec<u32>>) -> PlcFacet {
        let first = &self.facets[members[0] as usize];
        if members.len() == 1 {
            return first.clone();
        }
        let mut inside: Vec<u32> = members.to_vec();
        inside.sort_unstable();
        let mut kept: Vec<[u32; 2]> = Vec::new();
        let mut points: Vec<u32> = Vec::new();
        for &member in members {
            for side in sides(&self.facets[member as usize]) {
                let between = at_side
                    .get(&side)
                    .is_some_and(|at| at.len() == 2 && at.iter().all(|facet| inside.binary_search(facet).is_ok()));
                if !between {
                    kept.push(side);
                }
                points.extend(side);
            }
        }
        kept.sort_unstable();
        kept.dedup();
        points.sort_unstable();
        points.dedup();
        let mut polygons = rings(&kept);
        let mut on_sides: Vec<u32> = kept.iter().flatten().copied().collect();
        on_sides.sort_unstable();
        polygons.extend(points.iter().filter(|v| on_sides.binary_search(v).is_err()).map(|&v| vec![v]));
        let mut facet = PlcFacet { polygons, holes: Vec::new(), marker: first.marker };
        facet.holes = self.seeds_of_gaps(&facet, members);
        facet
    }

    /// A seed in each gap that the members leave within their outline: the inner rings bound either a gap or nothing.
    fn seeds_of_gaps(&self, facet: &PlcFacet, members: &[u32]) -> Vec<DVec3> {
        if facet.polygons.iter().filter(|polygon| polygon.len() > 1).count() < 2 {
            return Vec::new();
        }
        super::planar::gaps(self, facet, members)
    }
}

/// The sides of a facet, lower point first.
fn sides(facet: &PlcFacet) -> impl Iterator<Item = [u32; 2]> + '_ {
    facet.polygons.iter().flat_map(|polygon| {
        (0..polygon.len()).map(|i| edge_key([polygon[i], polygon[(i + 1) % polygon.len()]])).filter(|[a, b]| a != b)
    })
}

/// Sides put together to closed polygons; what does not close, as polygons of two points.
fn rings(sides: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut at: FxHashMap<u32, Vec<usize>> = FxHashMap::default();
    for (i, side) in sides.iter().enumerate() {
        for &v in side {
            at.entry(v).or_default().push(i);
        }
    }
    let mut used = vec![false; sides.len()];
    let mut polygons = Vec::new();
    for start in 0..sides.len() {
        if used[start] {
            continue;
        }
        used[start] = true;
        let [first, mut last] = sides[start];
        let (mut ring, mut taken) = (vec![first, last], vec![start]);
        while last != first {
            let Some(&next) = at[&last].iter().find(|&&i| !used[i]) else { break };
            used[next] = true;
            taken.push(next);
            last = if sides[next][0] == last { sides[next][1] } else { sides[next][0] };
            ring.push(last);
        }
        if last == first {
            ring.pop();
            polygons.push(ring);
        } else {
            polygons.extend(taken.into_iter().map(|i| sides[i].to_vec()));
        }
    }
    polygons
}

/// The slab that the points of a facet under way lie in.
struct Flat {
    origin: DVec3,
    normal: DVec3,
    low: f64,
    high: f64,
    size: f64,
    extent: f64,
}

impl Flat {
    fn new(plc: &Plc, facet: &PlcFacet, normal: DVec3, extent: f64) -> Flat {
        let origin = plc.points[facet.polygons[0][0] as usize];
        let mut flat = Flat { origin, normal, low: 0.0, high: 0.0, size: 0.0, extent };
        flat.admit(plc, facet);
        flat
    }

    /// Takes a facet's points in if the slab stays thin enough: a quarter of what a facet is allowed, because its own plane may lie otherwise.
    fn admit(&mut self, plc: &Plc, facet: &PlcFacet) -> bool {
        let (mut low, mut high, mut size) = (self.low, self.high, self.size);
        for &v in &facet.polygons[0] {
            let offset = plc.points[v as usize] - self.origin;
            let height = offset.dot(self.normal);
            (low, high, size) = (low.min(height), high.max(height), size.max(offset.length()));
        }
        // The smallest size so far: a large facet must not make room for the bend of a small one.
        let limit = 0.25 * planarity(if self.size > 0.0 { self.size } else { size }, self.extent);
        let fits = self.size == 0.0 || high - low <= limit;
        if fits {
            (self.low, self.high, self.size) = (low, high, size);
        }
        fits
    }
}
