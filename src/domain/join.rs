//! Facets that lie in one plane and share a side become one facet. The triangles of a surface's flat parts are then one polygon each, and the edges
//! between them, which often meet at small angles, are no segments that have to be kept.

use rustc_hash::FxHashMap;

use super::boundary::edge_key;
use super::planar::{facet_normal, PLANARITY};
use super::plc::{Plc, PlcFacet};
use crate::DVec3;

impl Plc {
    /// Joins facets of one marker that share a side with no third facet there, and whose normals differ by at most `degrees`, as long as
    /// all of their points stay within the planarity that a facet must have. Only facets of a single polygon without holes take part, and no side
    /// that is a listed segment is given up. Returns the position of each old facet among the new ones.
    ///
    /// The points stay, and the surface too, up to that planarity. Points that are left within a facet become vertices of its
    /// own. Cost: linear in the number of sides.
    pub fn join_coplanar(&mut self, degrees: f64) -> Vec<u32> {
        let count = self.facets.len();
        let normals: Vec<Option<DVec3>> = self.facets.iter().map(|facet| self.single_normal(facet)).collect();
        let mut at_side: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
        for (i, facet) in self.facets.iter().enumerate() {
            for side in sides(facet) {
                at_side.entry(side).or_default().push(i as u32);
            }
        }
        for segment in &self.segments {
            at_side.remove(&edge_key(segment.ends));
        }
        let cosine = degrees.clamp(0.0, 90.0).to_radians().cos();
        let mut group = vec![u32::MAX; count];
        let mut facets = Vec::new();
        for seed in 0..count {
            if group[seed] != u32::MAX {
                continue;
            }
            let mut members = vec![seed as u32];
            group[seed] = facets.len() as u32;
            if let Some(normal) = normals[seed] {
                let mut plane = Flat::new(self, &self.facets[seed], normal);
                let mut next = 0;
                while next < members.len() {
                    for side in sides(&self.facets[members[next] as usize]) {
                        let Some(&[f, g]) = at_side.get(&side).map(Vec::as_slice) else { continue };
                        let other = if f == members[next] { g } else { f } as usize;
                        let Some(theirs) = normals[other] else { continue };
                        let alike = theirs.dot(normal).abs() >= cosine - 1e-12
                            && self.facets[other].marker == self.facets[seed].marker;
                        if group[other] == u32::MAX && alike && plane.admit(self, &self.facets[other]) {
                            group[other] = facets.len() as u32;
                            members.push(other as u32);
                        }
                    }
                    next += 1;
                }
            }
            let union = self.union(&members, &at_side);
            if members.len() == 1 || self.covers(&union, &members) {
                facets.push(union);
                continue;
            }
            // The outline does not say where the facet is (rings that touch, folds): its parts stay apart.
            for &member in &members {
                group[member as usize] = facets.len() as u32;
                facets.push(self.facets[member as usize].clone());
            }
        }
        self.facets = facets;
        group
    }

    /// Whether a union fills the area that its members fill.
    fn covers(&self, union: &PlcFacet, members: &[u32]) -> bool {
        let area = |facet: &PlcFacet| super::planar::area(&self.points, facet);
        let parts: Option<f64> = members.iter().map(|&member| area(&self.facets[member as usize])).sum();
        match (area(union), parts) {
            (Some(whole), Some(parts)) => (whole - parts).abs() <= 1e-9 * parts,
            _ => false,
        }
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
}

impl Flat {
    fn new(plc: &Plc, facet: &PlcFacet, normal: DVec3) -> Flat {
        let origin = plc.points[facet.polygons[0][0] as usize];
        let mut flat = Flat { origin, normal, low: 0.0, high: 0.0, size: 0.0 };
        flat.admit(plc, facet);
        flat
    }

    /// Takes a facet's points in if the slab stays thin enough: half of what a facet is allowed, because its own plane may lie otherwise.
    fn admit(&mut self, plc: &Plc, facet: &PlcFacet) -> bool {
        let (mut low, mut high, mut size) = (self.low, self.high, self.size);
        for &v in &facet.polygons[0] {
            let offset = plc.points[v as usize] - self.origin;
            let height = offset.dot(self.normal);
            (low, high, size) = (low.min(height), high.max(height), size.max(offset.length()));
        }
        // The smallest size so far: a large facet must not make room for the bend of a small one.
        let limit = 0.25 * PLANARITY * if self.size > 0.0 { self.size } else { size };
        let fits = self.size == 0.0 || high - low <= limit;
        if fits {
            (self.low, self.high, self.size) = (low, high, size);
        }
        fits
    }
}
