//! Where elements of a complex meet that share nothing: points on segments and facets, segments that cross, segments through facets, facets that
//! overlap. Candidates come from [trees of bounding boxes](super::boxes); each pair is then decided exactly.
//!
//! Two facets in different planes that meet where they should not have a side of one in the other, so that sides against triangles are
//! enough; only facets in one plane are compared with each other.
//!
//! Points that nothing else names, such as the nodes of a surface mesh, belong to a side or facet within the tolerance that a facet's own corners have:
//! on a slanted plane they can't lie exactly. Taken for points beside it, they would ask for edges as short as the last bits of coordinates.

use super::arrangement::Arrangement;
use super::boxes::Boxes;
use super::defect::{PlcDefect, PlcDefectKind};
use crate::domain::facet::dominant_axis;
use crate::domain::planar::{extent, facet_normal, size_from, PLANARITY};
use crate::domain::plc::Plc;
use crate::geometry::predicates::{collinear, orient2d, orient3d};
use crate::geometry::Sign;
use crate::leavings::InPieces;
use crate::parted::PartedMap;
use crate::sorting::{sort_by, sort_unique};
use crate::{memory, Control, DVec3, DomainElement, Error};

/// Completes an arrangement by the points on sides and facets, and notes what meets where it should not.
pub(super) fn find(
    plc: &Plc,
    a: &mut Arrangement,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let at = |v: u32| a.points[v as usize];
    let sides = Boxes::new(a.sides.iter().map(|side| side.ends.map(at)), control)?;
    let triangles = Boxes::new(a.triangles.iter().map(|(triangle, _)| triangle.map(at)), control)?;
    let (alone, reach) = (alone(a, control)?, PLANARITY * extent(&a.points, control)?);
    let reach_of = |v: u32| if alone[v as usize] { reach } else { 0.0 };
    points_on_sides(a, &sides, &reach_of, defects, control)?;
    points_in_facets(a, &triangles, &reach_of, defects, control)?;
    sides_across_sides(a, &sides, defects, control)?;
    sides_through_facets(a, &sides, &triangles, defects, control)?;
    facets_in_one_plane(plc, a, &triangles, defects, control)
}

/// The points that stand for themselves and are fit for the predicates.
fn usable_points(a: &Arrangement) -> impl Iterator<Item = u32> + '_ {
    let usable = |&v: &u32| a.first[v as usize] == v && crate::geometry::check_range(0, a.points[v as usize]).is_ok();
    (0..a.points.len() as u32).filter(usable)
}

/// Of each point whether it stands alone: no side or facet names it.
fn alone(a: &Arrangement, control: &Control) -> Result<Vec<bool>, Error> {
    let mut alone = vec![true; a.points.len()];
    let turns = control.turns();
    for v in a.sides.iter().flat_map(|side| side.ends).chain(a.corners.iter().flatten().copied()) {
        turns.check()?;
        alone[v as usize] = false;
    }
    Ok(alone)
}

/// Whether `p` lies on the line `qr` between its ends, as nearly as a corner has to lie in its facet.
fn is_near_side([q, r]: [DVec3; 2], p: DVec3) -> bool {
    let (along, length2) = (r - q, q.distance_squared(r));
    let share = (p - q).dot(along) / length2;
    0.0 < share && share < 1.0 && (p - q - share * along).length_squared() <= PLANARITY * PLANARITY * length2
}

fn points_on_sides(
    a: &mut Arrangement,
    boxes: &Boxes,
    reach_of: &impl Fn(u32) -> f64,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let (mut found, turns) = (Vec::new(), control.turns());
    for v in usable_points(a) {
        control.check()?;
        let (p, reach) = (a.points[v as usize], reach_of(v));
        for side in boxes.at_point(p, reach) {
            turns.check()?;
            let ends = a.sides[side as usize].ends;
            let [q, r] = ends.map(|v| a.points[v as usize]);
            // Within the bounding box and on the line is between the ends.
            let on_line = || if reach > 0.0 { is_near_side([q, r], p) } else { collinear(q, r, p) };
            if !ends.contains(&v) && on_line() {
                let elements = [DomainElement::Point(v as usize), a.sides[side as usize].element()];
                defects.push(PlcDefect::new(PlcDefectKind::PointOnSegment, elements, p));
                found.push((side, v));
            }
        }
    }
    for (side, v) in found {
        a.sides[side as usize].between.push(v);
    }
    let points = &a.points;
    for side in &mut a.sides {
        turns.check()?;
        let start = points[side.ends[0] as usize];
        let distance = |&v: &u32| points[v as usize].distance_squared(start);
        sort_by(&mut side.between, &control.watch(), |v, w| distance(v).total_cmp(&distance(w)).then(v.cmp(w)))?;
    }
    Ok(())
}

/// The coordinate to drop so that a triangle keeps an area, and its orientation then.
pub(crate) fn projection([p, q, r]: [DVec3; 3]) -> Option<(usize, Sign)> {
    (0..3).map(|axis| (axis, orient2d(axis, p, q, r))).find(|&(_, sign)| sign != Sign::Zero)
}

/// Whether a point of its plane lies in a triangle, its border included.
fn in_triangle(triangle: [DVec3; 3], p: DVec3) -> bool {
    projection(triangle).is_some_and(|projection| in_projection(projection, triangle, p))
}

/// The same without a coordinate, in which the triangle has this orientation.
fn in_projection((axis, sign): (usize, Sign), triangle: [DVec3; 3], p: DVec3) -> bool {
    (0..3).all(|i| orient2d(axis, triangle[i], triangle[(i + 1) % 3], p) != -sign)
}

/// The plane of a facet, as its corners define it.
struct Plane {
    origin: DVec3,
    normal: DVec3,
    /// How far off a point of the facet may lie.
    tolerance: f64,
}

impl Plane {
    fn new(points: &[DVec3], corners: &[u32]) -> Option<Plane> {
        let normal = facet_normal(points, corners)?;
        Some(Plane { origin: points[corners[0] as usize], normal, tolerance: PLANARITY * size_from(points, corners) })
    }

    /// Whether a point lies in one of the facet's triangles, as nearly as a corner has to lie in its facet.
    fn has_near(&self, triangle: [DVec3; 3], p: DVec3) -> bool {
        let axis = dominant_axis(self.normal);
        let sign = orient2d(axis, triangle[0], triangle[1], triangle[2]);
        let off = (p - self.origin).dot(self.normal).abs();
        off <= self.tolerance && sign != Sign::Zero && in_projection((axis, sign), triangle, p)
    }
}

fn points_in_facets(
    a: &mut Arrangement,
    boxes: &Boxes,
    reach_of: &impl Fn(u32) -> f64,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let (mut found, turns) = (Vec::new(), control.turns());
    let mut planes: PartedMap<u32, Option<Plane>> = PartedMap::default();
    for v in usable_points(a) {
        control.check()?;
        let (p, reach) = (a.points[v as usize], reach_of(v));
        for i in boxes.at_point(p, reach) {
            turns.check()?;
            let (triangle, facet) = a.triangles[i as usize];
            let corners = &a.corners[facet as usize];
            if corners.binary_search(&v).is_ok() {
                continue;
            }
            let [x, y, z] = triangle.map(|v| a.points[v as usize]);
            let exactly = orient3d(x, y, z, p) == Sign::Zero && in_triangle([x, y, z], p);
            let mut nearly = || {
                reach > 0.0 && {
                    let plane = planes.entry(facet).or_insert_with(|| Plane::new(&a.points, corners));
                    plane.as_ref().is_some_and(|plane| plane.has_near([x, y, z], p))
                }
            };
            if exactly || nearly() {
                found.push((facet, v));
            }
        }
    }
    let mut on_sides = InPieces::new(PartedMap::default(), control);
    for side in &a.sides {
        turns.check()?;
        for pair in side.facets.iter().flat_map(|&facet| side.between.iter().map(move |&v| (facet, v))) {
            turns.check()?;
            on_sides.insert(pair, ());
        }
    }
    sort_unique(&mut found, &control.watch())?;
    // At once: a long list would be moved as it grows.
    memory::reserve(defects, found.len(), "defects")?;
    for (facet, v) in found {
        turns.check()?;
        if on_sides.contains_key(&(facet, v)) {
            continue;
        }
        let elements = [DomainElement::Point(v as usize), DomainElement::Facet(facet as usize)];
        defects.push(PlcDefect::new(PlcDefectKind::PointOnFacet, elements, a.points[v as usize]));
        a.inside[facet as usize].push(v);
    }
    Ok(())
}

fn sides_across_sides(
    a: &Arrangement,
    boxes: &Boxes,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let turns = control.turns();
    let apart = |i: u32, j: u32| {
        let (s, t) = (&a.sides[i as usize], &a.sides[j as usize]);
        // Sides of one facet are the facet's own affair.
        i < j && !s.ends.iter().any(|v| t.ends.contains(v)) && !s.facets.iter().any(|f| t.facets.contains(f))
    };
    for &(i, j) in &*boxes.pairs(boxes, apart, control)? {
        turns.check()?;
        let (s, t) = (&a.sides[i as usize], &a.sides[j as usize]);
        let ([p, q], [r, u]) = (s.ends.map(|v| a.points[v as usize]), t.ends.map(|v| a.points[v as usize]));
        if orient3d(p, q, r, u) != Sign::Zero {
            continue;
        }
        let Some((axis, _)) = projection([p, q, r]).or_else(|| projection([p, q, u])) else { continue };
        let side = |a, b, c| orient2d(axis, a, b, c) as i8;
        if side(p, q, r) * side(p, q, u) < 0 && side(r, u, p) * side(r, u, q) < 0 {
            let place = p + (q - p) * crossing((q - p).cross(u - r), (r - p).cross(u - r));
            defects.push(PlcDefect::new(PlcDefectKind::SegmentsCross, [s.element(), t.element()], place));
        }
    }
    Ok(())
}

/// The fraction `numerator / denominator` of two parallel vectors.
fn crossing(denominator: DVec3, numerator: DVec3) -> f64 {
    (numerator.dot(denominator) / denominator.length_squared()).clamp(0.0, 1.0)
}

fn sides_through_facets(
    a: &Arrangement,
    sides: &Boxes,
    triangles: &Boxes,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let turns = control.turns();
    let apart = |i: u32, j: u32| {
        let (side, (triangle, facet)) = (&a.sides[i as usize], &a.triangles[j as usize]);
        !side.ends.iter().any(|v| triangle.contains(v)) && !side.facets.contains(facet)
    };
    let mut found = PartedMap::default();
    for &(i, j) in &*sides.pairs(triangles, apart, control)? {
        turns.check()?;
        let (side, (triangle, facet)) = (&a.sides[i as usize], a.triangles[j as usize]);
        let [p, q] = side.ends.map(|v| a.points[v as usize]);
        let corners = triangle.map(|v| a.points[v as usize]);
        let [x, y, z] = corners;
        if orient3d(x, y, z, p) as i8 * orient3d(x, y, z, q) as i8 >= 0 {
            continue;
        }
        let signs = [orient3d(p, q, x, y), orient3d(p, q, y, z), orient3d(p, q, z, x)].map(|sign| sign as i8);
        if signs.contains(&1) && signs.contains(&-1) {
            continue;
        }
        let zeros: Vec<usize> = (0..3).filter(|&k| signs[k] == 0).collect();
        // At a corner, or across a side: the corner lies on the segment, or the sides cross, which is another defect.
        let across = match zeros[..] {
            [] => true,
            [k] => !a.side_of.contains_key(&crate::domain::boundary::edge_key([triangle[k], triangle[(k + 1) % 3]])),
            _ => false,
        };
        if across && found.insert((i, facet), ()).is_none() {
            let normal = (y - x).cross(z - x);
            let (above, below) = ((p - x).dot(normal).abs(), (q - x).dot(normal).abs());
            let place = p + (q - p) * (above / (above + below).max(f64::MIN_POSITIVE));
            let elements = [side.element(), DomainElement::Facet(facet as usize)];
            defects.push(PlcDefect::new(PlcDefectKind::SegmentThroughFacet, elements, place));
        }
    }
    Ok(())
}

fn facets_in_one_plane(
    plc: &Plc,
    a: &Arrangement,
    boxes: &Boxes,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let turns = control.turns();
    let mut found = PartedMap::default();
    let apart = |i: u32, j: u32| i < j && a.triangles[i as usize].1 != a.triangles[j as usize].1;
    for &(i, j) in &*boxes.pairs(boxes, apart, control)? {
        turns.check()?;
        let ((first, f), (second, g)) = (a.triangles[i as usize], a.triangles[j as usize]);
        let (p, q) = (first.map(|v| a.points[v as usize]), second.map(|v| a.points[v as usize]));
        let in_plane = |v: DVec3| orient3d(p[0], p[1], p[2], v) == Sign::Zero;
        if found.contains_key(&(f, g)) || !q.into_iter().all(in_plane) || !overlap(p, q) {
            continue;
        }
        found.insert((f, g), ());
        let same = a.corners[f as usize] == a.corners[g as usize] && {
            let sides = |i: u32| plc.facets[i as usize].polygons.iter().map(Vec::len).sum::<usize>();
            sides(f) == sides(g)
        };
        let kind = if same { PlcDefectKind::DuplicateFacet } else { PlcDefectKind::FacetsOverlap };
        let elements = [DomainElement::Facet(g as usize), DomainElement::Facet(f as usize)];
        defects.push(PlcDefect::new(kind, elements, (q[0] + q[1] + q[2]) / 3.0));
    }
    Ok(())
}

/// Whether two triangles of one plane have more than their borders in common: no side of either separates them.
fn overlap(p: [DVec3; 3], q: [DVec3; 3]) -> bool {
    let Some((axis, _)) = projection(p) else { return false };
    let separates = |p: [DVec3; 3], q: [DVec3; 3]| {
        let sign = orient2d(axis, p[0], p[1], p[2]);
        (0..3).any(|i| q.into_iter().all(|v| orient2d(axis, p[i], p[(i + 1) % 3], v) != sign))
    };
    !separates(p, q) && !separates(q, p)
}
