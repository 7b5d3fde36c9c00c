//! Open and branching edges, and the smallest angles between segments and between facets.

use rstar::RTree;
use rustc_hash::FxHashMap;

use super::arrangement::Arrangement;
use super::defect::{PlcDefect, PlcDefectKind};
use super::{PlcCheck, SmallAngle};
use crate::domain::boundary::edge_key;
use crate::{DVec3, DomainElement};

/// Up to this many directions are compared pair by pair.
const FEW: usize = 48;

pub(super) fn find(a: &Arrangement, check: &mut PlcCheck) {
    // A side that is cut in the points on it has its parts as edges.
    let mut around: FxHashMap<[u32; 2], Vec<(u32, u32)>> = FxHashMap::default();
    for &(triangle, facet) in &a.triangles {
        for i in 0..3 {
            let [v, w, apex] = [0, 1, 2].map(|k| triangle[(i + k) % 3]);
            let Some(&side) = a.side_of.get(&edge_key([v, w])) else { continue };
            for part in a.sides[side as usize].parts() {
                around.entry(edge_key(part)).or_default().push((apex, facet));
            }
        }
    }
    let mut edges: Vec<_> = around.into_iter().collect();
    edges.sort_unstable_by_key(|&(edge, _)| edge);
    for (edge, facets) in &edges {
        let [p, q] = edge.map(|v| a.points[v as usize]);
        let kind = match facets.len() {
            1 => PlcDefectKind::OpenEdge,
            2 => continue,
            _ => PlcDefectKind::NonManifoldEdge,
        };
        let element = DomainElement::Facet(facets[0].1 as usize);
        check.defects.push(PlcDefect::new(kind, [element], 0.5 * p + 0.5 * q).measured(facets.len() as f64));
    }
    check.facet_angle = facet_angle(a, &edges);
    check.segment_angle = segment_angle(a);
}

/// The smallest of those that there are.
fn smaller(angle: SmallAngle, least: &mut Option<SmallAngle>) {
    if least.as_ref().is_none_or(|known| angle.degrees < known.degrees) {
        *least = Some(angle);
    }
}

type Edge = ([u32; 2], Vec<(u32, u32)>);

/// Around each edge the facets in the order of their angle: the smallest is between two neighbours.
fn facet_angle(a: &Arrangement, edges: &[Edge]) -> Option<SmallAngle> {
    let mut least = None;
    for (edge, facets) in edges.iter().filter(|(_, facets)| facets.len() > 1) {
        let [p, q] = edge.map(|v| a.points[v as usize]);
        let along = (q - p).normalize_or_zero();
        let across = |apex: u32| (a.points[apex as usize] - p).reject_from_normalized(along).normalize_or_zero();
        let (u, w) = (across(facets[0].0), along.cross(across(facets[0].0)));
        let mut turns: Vec<(f64, u32)> =
            facets.iter().map(|&(apex, facet)| (across(apex).dot(w).atan2(across(apex).dot(u)), facet)).collect();
        turns.sort_by(|s, t| s.0.total_cmp(&t.0).then(s.1.cmp(&t.1)));
        for i in 0..turns.len() {
            let (s, t) = (turns[i], turns[(i + 1) % turns.len()]);
            let turn = (t.0 - s.0).rem_euclid(std::f64::consts::TAU);
            let degrees = turn.min(std::f64::consts::TAU - turn).to_degrees();
            let elements = [s.1, t.1].map(|facet| DomainElement::Facet(facet as usize));
            smaller(SmallAngle { degrees, elements, place: 0.5 * p + 0.5 * q }, &mut least);
        }
    }
    least
}

fn segment_angle(a: &Arrangement) -> Option<SmallAngle> {
    let mut ends: Vec<(u32, u32, u32)> = Vec::new();
    for (i, side) in a.sides.iter().enumerate() {
        for [v, w] in side.parts() {
            ends.extend([(v, w, i as u32), (w, v, i as u32)]);
        }
    }
    ends.sort_unstable();
    let mut least = None;
    for at_point in ends.chunk_by(|e, f| e.0 == f.0) {
        // Parts of two sides may be the same.
        let mut at_point = at_point.to_vec();
        at_point.dedup_by_key(|&mut (_, w, _)| w);
        let center = a.points[at_point[0].0 as usize];
        let directions: Vec<DVec3> =
            at_point.iter().map(|&(_, w, _)| (a.points[w as usize] - center).normalize_or_zero()).collect();
        let Some((i, j)) = closest(&directions) else { continue };
        let (u, v) = (directions[i], directions[j]);
        let degrees = (2.0 * (u - v).length().atan2((u + v).length())).to_degrees();
        let elements = [i, j].map(|k| a.sides[at_point[k].2 as usize].element());
        smaller(SmallAngle { degrees, elements, place: center }, &mut least);
    }
    least
}

/// The two closest of some unit vectors.
fn closest(directions: &[DVec3]) -> Option<(usize, usize)> {
    let distance = |i: usize, j: usize| directions[i].distance_squared(directions[j]);
    if directions.len() <= FEW {
        let all = (0..directions.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
        return all.min_by(|&(i, j), &(k, l)| distance(i, j).total_cmp(&distance(k, l)));
    }
    let of = rstar::primitives::GeomWithData::<[f64; 3], usize>::new;
    let tree = RTree::bulk_load(directions.iter().enumerate().map(|(i, d)| of(d.to_array(), i)).collect());
    let nearest = |i: usize| {
        let near = tree.nearest_neighbor_iter(directions[i].to_array()).map(|entry| entry.data);
        near.filter(|&j| j != i).take(1).map(move |j| (i.min(j), i.max(j))).next()
    };
    let pairs = (0..directions.len()).filter_map(nearest);
    pairs.min_by(|&(i, j), &(k, l)| distance(i, j).total_cmp(&distance(k, l)).then((i, j).cmp(&(k, l))))
}
