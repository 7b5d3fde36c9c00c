//! Open and branching edges, and the smallest angles between segments and between facets.

use rstar::RTree;

use super::arrangement::Arrangement;
use super::defect::{PlcDefect, PlcDefectKind};
use super::{PlcCheck, SmallAngle};
use crate::domain::boundary::edge_key;
use crate::leavings::InPieces;
use crate::sorting::{sort, sort_by};
use crate::{Control, DVec3, DomainElement, Error};

/// Up to this many directions are compared pair by pair.
const FEW: usize = 48;

/// A triangle at an edge, which is a part of a side.
#[derive(Clone, Copy)]
struct AtEdge {
    edge: [u32; 2],
    triangle: u32,
    /// The corner that is not on the edge.
    apex: u32,
    facet: u32,
}

pub(super) fn find(a: &Arrangement, check: &mut PlcCheck, control: &Control) -> Result<(), Error> {
    let turns = control.turns();
    // A side that is cut in the points on it has its parts as edges.
    let mut around = InPieces::new(Vec::new(), control);
    for (i, &(triangle, facet)) in a.triangles.iter().enumerate() {
        turns.check()?;
        for k in 0..3 {
            let [v, w, apex] = [0, 1, 2].map(|j| triangle[(k + j) % 3]);
            let Some(&side) = a.side_of.get(&edge_key([v, w])) else { continue };
            let parts = a.sides[side as usize].parts();
            around.extend(parts.map(|part| AtEdge { edge: edge_key(part), triangle: i as u32, apex, facet }));
        }
    }
    sort_by(&mut around, &control.watch(), |x, y| (x.edge, x.triangle).cmp(&(y.edge, y.triangle)))?;
    for facets in around.chunk_by(|x, y| x.edge == y.edge) {
        turns.check()?;
        let [p, q] = facets[0].edge.map(|v| a.points[v as usize]);
        let kind = match facets.len() {
            1 => PlcDefectKind::OpenEdge,
            2 => continue,
            _ => PlcDefectKind::NonManifoldEdge,
        };
        let element = DomainElement::Facet(facets[0].facet as usize);
        check.defects.push(PlcDefect::new(kind, [element], 0.5 * p + 0.5 * q).measured(facets.len() as f64));
    }
    check.facet_angle = facet_angle(a, &around, control)?;
    check.segment_angle = segment_angle(a, control)?;
    Ok(())
}

/// The smallest of those that there are.
fn smaller(angle: SmallAngle, least: &mut Option<SmallAngle>) {
    if least.as_ref().is_none_or(|known| angle.degrees < known.degrees) {
        *least = Some(angle);
    }
}

/// Around each edge the facets in the order of their angle: the smallest is between two neighbours.
fn facet_angle(a: &Arrangement, around: &[AtEdge], control: &Control) -> Result<Option<SmallAngle>, Error> {
    let mut least = None;
    let watch = control.turns();
    for facets in around.chunk_by(|x, y| x.edge == y.edge).filter(|facets| facets.len() > 1) {
        watch.check()?;
        let [p, q] = facets[0].edge.map(|v| a.points[v as usize]);
        let along = (q - p).normalize_or_zero();
        let across = |apex: u32| (a.points[apex as usize] - p).reject_from_normalized(along).normalize_or_zero();
        let (u, w) = (across(facets[0].apex), along.cross(across(facets[0].apex)));
        let turn = |x: &AtEdge| (across(x.apex).dot(w).atan2(across(x.apex).dot(u)), x.facet);
        let mut turns: Vec<(f64, u32)> = facets.iter().map(turn).collect();
        turns.sort_by(|s, t| s.0.total_cmp(&t.0).then(s.1.cmp(&t.1)));
        for i in 0..turns.len() {
            let (s, t) = (turns[i], turns[(i + 1) % turns.len()]);
            let turn = (t.0 - s.0).rem_euclid(std::f64::consts::TAU);
            let degrees = turn.min(std::f64::consts::TAU - turn).to_degrees();
            let elements = [s.1, t.1].map(|facet| DomainElement::Facet(facet as usize));
            smaller(SmallAngle { degrees, elements, place: 0.5 * p + 0.5 * q }, &mut least);
        }
    }
    Ok(least)
}

fn segment_angle(a: &Arrangement, control: &Control) -> Result<Option<SmallAngle>, Error> {
    let mut ends = InPieces::new(Vec::new(), control);
    let turns = control.turns();
    for (i, side) in a.sides.iter().enumerate() {
        turns.check()?;
        for [v, w] in side.parts() {
            ends.extend([(v, w, i as u32), (w, v, i as u32)]);
        }
    }
    sort(&mut ends, &control.watch())?;
    let mut least = None;
    for at_point in ends.chunk_by(|e: &(u32, u32, u32), f| e.0 == f.0) {
        turns.check()?;
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
    Ok(least)
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
