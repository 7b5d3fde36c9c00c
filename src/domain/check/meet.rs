//! Where elements of a complex meet that share nothing: points on segments and facets, segments that cross, segments through facets, facets that
//! overlap. Candidates are [what is close](super::close); each pair is then decided exactly.
//!
//! Two facets in different planes that meet where they should not have a side of one in the other, so that sides against triangles are
//! enough; only facets in one plane are compared with each other.
//!
//! Points that nothing else names, such as the nodes of a surface mesh, belong to a side or facet within the tolerance that a facet's own corners have:
//! on a slanted plane they can't lie exactly. Taken for points beside it, they would ask for edges as short as the last bits of coordinates.

use super::arrangement::Arrangement;
use super::close::Close;
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
    let (alone, reach) = (alone(a, control)?, PLANARITY * extent(&a.points, control)?);
    let reach_of = |v: u32| if alone[v as usize] { reach } else { 0.0 };
    let close = Close::find(a, reach_of, control)?;
    judge(plc, a, &close, &reach_of, defects, control)
}

/// [`find`] among what is close.
fn judge(
    plc: &Plc,
    a: &mut Arrangement,
    close: &Close,
    reach_of: &impl Fn(u32) -> f64,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    points_on_sides(a, &close.points_at_sides, reach_of, defects, control)?;
    points_in_facets(a, &close.points_at_triangles, reach_of, defects, control)?;
    sides_across_sides(a, &close.sides, defects, control)?;
    sides_through_facets(a, &close.sides_through, defects, control)?;
    facets_in_one_plane(plc, a, &close.triangles, defects, control)
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
    close: &[[u32; 2]],
    reach_of: &impl Fn(u32) -> f64,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let (mut found, turns) = (Vec::new(), control.turns());
    for &[v, side] in close {
        turns.check()?;
        let (p, reach) = (a.points[v as usize], reach_of(v));
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
    close: &[[u32; 2]],
    reach_of: &impl Fn(u32) -> f64,
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let (mut found, turns) = (Vec::new(), control.turns());
    let mut planes: PartedMap<u32, Option<Plane>> = PartedMap::default();
    for &[v, i] in close {
        turns.check()?;
        let (p, reach) = (a.points[v as usize], reach_of(v));
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
    close: &[[u32; 2]],
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let turns = control.turns();
    for &pair in close {
        turns.check()?;
        let [s, t] = pair.map(|i| &a.sides[i as usize]);
        let ([p, q], [r, u]) = (s.ends.map(|v| a.points[v as usize]), t.ends.map(|v| a.points[v as usize]));
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
    close: &[[u32; 2]],
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let turns = control.turns();
    let mut found = PartedMap::default();
    for &[i, j] in close {
        turns.check()?;
        let (side, (triangle, facet)) = (&a.sides[i as usize], a.triangles[j as usize]);
        let [p, q] = side.ends.map(|v| a.points[v as usize]);
        let corners = triangle.map(|v| a.points[v as usize]);
        let [x, y, z] = corners;
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
    close: &[[u32; 2]],
    defects: &mut Vec<PlcDefect>,
    control: &Control,
) -> Result<(), Error> {
    let turns = control.turns();
    let mut found = PartedMap::default();
    for &pair in close {
        turns.check()?;
        let [(first, f), (second, g)] = pair.map(|i| a.triangles[i as usize]);
        let (p, q) = (first.map(|v| a.points[v as usize]), second.map(|v| a.points[v as usize]));
        if found.contains_key(&(f, g)) || !overlap(p, q) {
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{PlcFacet, PlcSegment};

    /// Everything whose boxes meet, each pair looked at.
    fn all(a: &Arrangement, reach_of: &impl Fn(u32) -> f64) -> Close {
        let at = |v: u32| a.points[v as usize];
        let meet = |these: &[DVec3], those: &[DVec3], reach: f64| {
            let low = |of: &[DVec3]| of.iter().copied().reduce(DVec3::min).unwrap();
            let high = |of: &[DVec3]| of.iter().copied().reduce(DVec3::max).unwrap();
            (low(these) - reach).cmple(high(those)).all() && low(those).cmple(high(these) + reach).all()
        };
        let ends = |i: usize| a.sides[i].ends.map(at);
        let corners = |i: usize| a.triangles[i].0.map(at);
        let (sides, triangles) = (0..a.sides.len(), 0..a.triangles.len());
        let mut close = Close::default();
        for v in a.usable_points() {
            let near = |of: &[DVec3]| meet(&[at(v)], of, reach_of(v));
            close.points_at_sides.extend(sides.clone().filter(|&i| near(&ends(i))).map(|i| [v, i as u32]));
            close.points_at_triangles.extend(triangles.clone().filter(|&i| near(&corners(i))).map(|i| [v, i as u32]));
        }
        for i in sides.clone() {
            let (side, [p, q]) = (&a.sides[i], ends(i));
            for j in i + 1..a.sides.len() {
                let (other, [r, u]) = (&a.sides[j], ends(j));
                let in_common = side.ends.iter().any(|v| other.ends.contains(v))
                    || side.facets.iter().any(|f| other.facets.contains(f));
                if !in_common && meet(&[p, q], &[r, u], 0.0) && orient3d(p, q, r, u) == Sign::Zero {
                    close.sides.push([i as u32, j as u32]);
                }
            }
            for j in triangles.clone() {
                let ((triangle, facet), [x, y, z]) = (a.triangles[j], corners(j));
                let in_common = side.ends.iter().any(|v| triangle.contains(v)) || side.facets.contains(&facet);
                if !in_common && orient3d(x, y, z, p) as i8 * orient3d(x, y, z, q) as i8 == -1 {
                    close.sides_through.push([i as u32, j as u32]);
                }
            }
        }
        for i in triangles.clone() {
            for j in i + 1..a.triangles.len() {
                let ([x, y, z], other) = (corners(i), corners(j));
                let apart = a.triangles[i].1 != a.triangles[j].1 && meet(&[x, y, z], &other, 0.0);
                if apart && other.into_iter().all(|p| orient3d(x, y, z, p) == Sign::Zero) {
                    close.triangles.push([i as u32, j as u32]);
                }
            }
        }
        close
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        /// On a small grid nearly everything touches something.
        #[test]
        fn what_is_close_is_all_that_meets(
            points in prop::collection::vec((0..5u8, 0..5u8, 0..3u8), 4..24),
            facets in prop::collection::vec(prop::collection::vec(0..24u32, 3..5), 0..10),
            segments in prop::collection::vec((0..24u32, 0..24u32), 0..5),
        ) {
            let named = |v: u32| v % points.len() as u32;
            let facet = |polygon: Vec<u32>| PlcFacet { polygons: vec![polygon.into_iter().map(named).collect()], ..PlcFacet::default() };
            let segment = |(a, b)| PlcSegment { ends: [named(a), named(b)], ..PlcSegment::default() };
            let plc = Plc {
                points: points.iter().map(|&(x, y, z)| DVec3::new(x.into(), y.into(), z.into())).collect(),
                segments: segments.into_iter().map(segment).collect(),
                facets: facets.into_iter().map(facet).collect(),
                ..Plc::default()
            };
            let control = Control::new();
            let (mut found, mut expected) = (Vec::new(), Vec::new());
            let mut a = Arrangement::new(&plc, &mut found, &control).unwrap();
            expected.clone_from(&found);
            let mut b = a.clone();
            find(&plc, &mut a, &mut found, &control).unwrap();
            let (alone, reach) = (alone(&b, &control).unwrap(), PLANARITY * extent(&b.points, &control).unwrap());
            let reach_of = |v: u32| if alone[v as usize] { reach } else { 0.0 };
            let close = all(&b, &reach_of);
            judge(&plc, &mut b, &close, &reach_of, &mut expected, &control).unwrap();
            // As text, because places may be NaN.
            prop_assert_eq!(format!("{found:?}"), format!("{expected:?}"));
            let rest = |a: &Arrangement| format!("{:?} {:?}", a.sides, a.inside);
            prop_assert_eq!(rest(&a), rest(&b));
        }
    }
}
