//! Facets that lie in one plane and share a side become one facet. The triangles of a surface's flat parts are then one polygon each, and the edges
//! between them, which often meet at small angles, are no segments that have to be kept.

use super::boundary::{edge_key, face_key};
use super::facet::{dominant_axis, FacetTriangulation};
use super::planar::{
    extent, facet_normal, gaps, off_plane, outline_of, planarity, triangles_of_facet, triangles_within,
};
use super::plc::{Plc, PlcFacet};
use crate::leavings::InPieces;
use crate::parted::PartedMap;
use crate::sorting::{sort, sort_by, sort_unique};
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
        self.join_coplanar_within(degrees, Control::never()).unwrap_or_default()
    }

    /// [`join_coplanar`](Self::join_coplanar); [`Error::Cancelled`] when the control says stop. Nothing has changed then.
    pub fn join_coplanar_within(&mut self, degrees: f64, control: &Control) -> Result<Vec<u32>, Error> {
        control.check()?;
        let turns = control.turns();
        let count = self.facets.len();
        let mut normals: Vec<Option<DVec3>> = Vec::with_capacity(count);
        for facet in &self.facets {
            turns.check()?;
            normals.push(self.single_normal(facet));
        }
        let at_side = AtSides::new(self, control)?;
        let cosine = degrees.clamp(0.0, 90.0).to_radians().cos();
        let extent = extent(&self.points, control)?;
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
                        let &[(_, f), (_, g)] = at_side.facets(side) else { continue };
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
        // By the first member of each.
        let mut order: Vec<(u32, u32)> = Vec::with_capacity(groups.len());
        for (i, members) in groups.iter().enumerate() {
            turns.check()?;
            order.push((members.iter().min().copied().unwrap_or_default(), i as u32));
        }
        sort(&mut order, &control.watch())?;
        let mut facets: Vec<PlcFacet> = Vec::new();
        let mut members_of: Vec<Vec<u32>> = Vec::new();
        for (_, i) in order {
            turns.check()?;
            let members = std::mem::take(&mut groups[i as usize]);
            let union = self.union(&members, &at_side, control)?;
            if members.len() == 1 || self.covers(&union, &members, control)? {
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
            let mut all = InPieces::new(Vec::new(), control);
            for side in facets.iter().flat_map(sides) {
                turns.check()?;
                all.push(side);
            }
            all.extend(self.segments.iter().map(|segment| edge_key(segment.ends)));
            sort_unique(&mut all, &control.watch())?;
            let mut first_with = InPieces::new(PartedMap::default(), control);
            let mut overlaps = vec![false; facets.len()];
            for (i, facet) in facets.iter().enumerate() {
                turns.check()?;
                for triangle in self.final_triangles(facet, &all, extent, control)? {
                    turns.check()?;
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
    fn final_triangles(
        &self,
        facet: &PlcFacet,
        all: &[[u32; 2]],
        extent: f64,
        control: &Control,
    ) -> Result<Vec<[u32; 3]>, Error> {
        if let ([polygon], []) = (&facet.polygons[..], &facet.holes[..]) {
            if let &[a, b, c] = &polygon[..] {
                return Ok(vec![[a, b, c]]);
            }
        }
        let (vertices, mut own) = outline_of(facet, control)?;
        own.retain(|[a, b]| a != b);
        // What is defective has none.
        let usable = |p: &DVec3| crate::geometry::check_range(0, *p).is_ok();
        let known = vertices.iter().all(|&v| self.points.get(v as usize).is_some_and(usable));
        let known = known && facet.holes.iter().all(|hole| hole.is_finite());
        let normal = known.then(|| facet_normal(&self.points, &vertices)).flatten();
        let flat = |normal: &DVec3| off_plane(&self.points, &vertices, *normal, extent).is_none();
        let Some(normal) = normal.filter(flat) else { return Ok(Vec::new()) };
        let turns = control.turns();
        let (mut fixed, mut others) = (Vec::new(), Vec::new());
        for &v in &vertices {
            turns.check()?;
            let of_v = all[all.partition_point(|side| side[0] < v)..].iter().take_while(|side| side[0] == v);
            for side in of_v.filter(|side| vertices.binary_search(&side[1]).is_ok()) {
                fixed.push(*side);
                if own.binary_search(side).is_err() {
                    others.push(*side);
                }
            }
        }
        let axis = dominant_axis(normal);
        let triangles = triangles_within(&self.points, &vertices, (&own, &others), axis, &facet.holes, control)?
            .unwrap_or_default();
        let mut planar = FacetTriangulation::new(&triangles, normal, 0, &self.points, control)?;
        planar.make_delaunay(&self.points, |edge| fixed.binary_search(&edge_key(edge)).is_ok(), control)?;
        planar.triangles_within(control)
    }

    /// A measure of a facet's size: the area of its first corners' triangle, or more.
    fn size_of(&self, facet: usize) -> f64 {
        let polygon = &self.facets[facet].polygons[0];
        let at = |v: u32| self.points[v as usize];
        let corners = polygon[1..].windows(2).map(|w| (at(w[0]) - at(polygon[0])).cross(at(w[1]) - at(polygon[0])));
        corners.sum::<DVec3>().length()
    }

    /// Whether a union fills the area that its members fill, all seen along one axis.
    fn covers(&self, union: &PlcFacet, members: &[u32], control: &Control) -> Result<bool, Error> {
        let Some((axis, whole)) = triangles_of_facet(&self.points, union, control)? else { return Ok(false) };
        let area = |triangles: &[[u32; 3]]| -> f64 {
            let corners = triangles.iter().map(|t| t.map(|v| self.points[v as usize]));
            corners.map(|[a, b, c]| 0.5 * (b - a).cross(c - a)[axis].abs()).sum()
        };
        let turns = control.turns();
        let mut parts = 0.0;
        for &member in members {
            turns.check()?;
            match triangles_of_facet(&self.points, &self.facets[member as usize], control)? {
                Some((_, triangles)) => parts += area(&triangles),
                None => return Ok(false),
            }
        }
        Ok((area(&whole) - parts).abs() <= 1e-9 * parts)
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
    fn union(&self, members: &[u32], at_side: &AtSides<'_>, control: &Control) -> Result<PlcFacet, Error> {
        let first = &self.facets[members[0] as usize];
        if members.len() == 1 {
            return Ok(first.clone());
        }
        let (turns, watch) = (control.turns(), control.watch());
        let mut inside: Vec<u32> = members.to_vec();
        sort(&mut inside, &watch)?;
        let mut kept: Vec<[u32; 2]> = Vec::new();
        let mut points: Vec<u32> = Vec::new();
        for &member in members {
            turns.check()?;
            for side in sides(&self.facets[member as usize]) {
                let at = at_side.facets(side);
                let between = at.len() == 2 && at.iter().all(|(_, facet)| inside.binary_search(facet).is_ok());
                if !between {
                    kept.push(side);
                }
                points.extend(side);
            }
        }
        sort_unique(&mut kept, &watch)?;
        sort_unique(&mut points, &watch)?;
        let mut polygons = rings(&kept, control)?;
        let mut on_sides: Vec<u32> = kept.iter().flatten().copied().collect();
        sort(&mut on_sides, &watch)?;
        for v in points {
            turns.check()?;
            if on_sides.binary_search(&v).is_err() {
                polygons.push(vec![v]);
            }
        }
        let mut facet = PlcFacet { polygons, holes: Vec::new(), marker: first.marker };
        // The inner rings bound either a gap that the members leave within their outline, or nothing.
        if facet.polygons.iter().filter(|polygon| polygon.len() > 1).count() > 1 {
            facet.holes = gaps(self, &facet, members, control)?;
        }
        Ok(facet)
    }
}

/// The facets at each side that is no listed segment.
struct AtSides<'a>(InPieces<'a, Vec<([u32; 2], u32)>>);

impl<'a> AtSides<'a> {
    fn new(plc: &Plc, control: &'a Control) -> Result<AtSides<'a>, Error> {
        let mut segments: Vec<[u32; 2]> = plc.segments.iter().map(|segment| edge_key(segment.ends)).collect();
        sort(&mut segments, &control.watch())?;
        let mut all = InPieces::new(Vec::new(), control);
        let turns = control.turns();
        for (i, facet) in plc.facets.iter().enumerate() {
            turns.check()?;
            let free = sides(facet).filter(|side| segments.binary_search(side).is_err());
            all.extend(free.map(|side| (side, i as u32)));
        }
        sort(&mut all, &control.watch())?;
        Ok(AtSides(all))
    }

    /// In order, one that has the side twice twice.
    fn facets(&self, side: [u32; 2]) -> &[([u32; 2], u32)] {
        let rest = &self.0[self.0.partition_point(|entry| entry.0 < side)..];
        let count = rest.iter().take_while(|entry| entry.0 == side).count();
        &rest[..count]
    }
}

/// The sides of a facet, lower point first.
fn sides(facet: &PlcFacet) -> impl Iterator<Item = [u32; 2]> + '_ {
    facet.polygons.iter().flat_map(|polygon| {
        (0..polygon.len()).map(|i| edge_key([polygon[i], polygon[(i + 1) % polygon.len()]])).filter(|[a, b]| a != b)
    })
}

/// Sides put together to closed polygons; what does not close, as polygons of two points.
fn rings(sides: &[[u32; 2]], control: &Control) -> Result<Vec<Vec<u32>>, Error> {
    let mut ends: Vec<(u32, usize)> = sides.iter().enumerate().flat_map(|(i, side)| side.map(|v| (v, i))).collect();
    sort(&mut ends, &control.watch())?;
    let at = |v: u32| {
        let rest = &ends[ends.partition_point(|end| end.0 < v)..];
        rest.iter().take_while(move |end| end.0 == v).map(|&(_, i)| i)
    };
    let turns = control.turns();
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
            turns.check()?;
            let Some(next) = at(last).find(|&i| !used[i]) else { break };
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
    Ok(polygons)
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
