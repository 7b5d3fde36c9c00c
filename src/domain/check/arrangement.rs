//! A complex as plain geometry: points at one place merged, every side of a facet a segment, every facet a set of triangles.

use super::defect::{PlcDefect, PlcDefectKind};
use crate::domain::boundary::edge_key;
use crate::domain::facet::dominant_axis;
use crate::domain::planar::{extent, facet_normal_within, off_plane_within, triangles_within, PlanarDefect};
use crate::domain::plc::Plc;
use crate::geometry::check_range;
use crate::leavings::{give_elements_back, InPieces, Leavings};
use crate::parted::PartedMap;
use crate::sorting::sort_unique;
use crate::triangulation::ByPoint;
use crate::{memory, Control, DVec3, DomainElement, Error};

/// Labels of regions have 16 bits, of which a few values mean something else.
pub(crate) const MAX_REGIONS: usize = 60_000;

/// A segment of the list or a side of facets.
#[derive(Clone, Debug)]
pub(crate) struct Side {
    /// Lower point first, as all edges here.
    pub ends: [u32; 2],
    /// Its first position in the list of segments.
    pub listed: Option<usize>,
    /// The facets that have it as a side.
    pub facets: Vec<u32>,
    /// The points that lie on it, in order from the lower end.
    pub between: Vec<u32>,
}

impl Side {
    /// The element to name it by.
    pub fn element(&self) -> DomainElement {
        match (self.listed, self.facets.first()) {
            (Some(i), _) => DomainElement::Segment(i),
            (None, Some(&facet)) => DomainElement::Facet(facet as usize),
            (None, None) => DomainElement::Whole,
        }
    }

    /// Its parts between the points on it.
    pub fn parts(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let starts = std::iter::once(self.ends[0]).chain(self.between.iter().copied());
        let ends = self.between.iter().copied().chain(std::iter::once(self.ends[1]));
        starts.zip(ends).map(|(a, b)| [a, b])
    }
}

/// A complex taken apart. Points are named by the first position of those at one place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Arrangement {
    pub points: Vec<DVec3>,
    /// The first point at the place of each.
    pub first: Vec<u32>,
    pub sides: Vec<Side>,
    pub side_of: PartedMap<[u32; 2], u32>,
    /// Each with its facet.
    pub triangles: Vec<([u32; 3], u32)>,
    /// The corners of each facet, sorted.
    pub corners: Vec<Vec<u32>>,
    /// The points that lie in each facet, but on no side of it, and are no corners of it; sorted.
    pub inside: Vec<Vec<u32>>,
}

impl Arrangement {
    /// Takes a complex apart; elements that are defective by themselves are noted and left out.
    pub fn new<'a>(
        plc: &Plc,
        defects: &mut Vec<PlcDefect>,
        control: &'a Control,
    ) -> Result<InPieces<'a, Arrangement>, Error> {
        let mut new = InPieces::new(Arrangement::default(), control);
        new.points = memory::copied(&plc.points, "points", control)?;
        new.merge_points(defects, control)?;
        // Most facets are triangles, and most sides those of two polygons.
        memory::reserve(&mut new.triangles, plc.facets.len(), "facets")?;
        let turns = control.turns();
        let polygons = plc.facets.iter().take_while(|_| turns.go_on()).flat_map(|facet| &facet.polygons);
        let corners = polygons.take_while(|_| turns.go_on()).map(Vec::len).sum::<usize>();
        turns.end()?;
        memory::reserve(&mut new.sides, plc.segments.len() + corners.div_ceil(2), "sides")?;
        memory::reserve_exact(&mut new.corners, plc.facets.len(), "facets")?;
        memory::reserve_exact(&mut new.inside, plc.facets.len(), "facets")?;
        for _ in &plc.facets {
            turns.check()?;
            new.corners.push(Vec::new());
            new.inside.push(Vec::new());
        }
        for (i, segment) in plc.segments.iter().enumerate() {
            turns.check()?;
            new.add_segment(i, segment.ends, defects);
        }
        let extent = extent(&plc.points, control)?;
        for i in 0..plc.facets.len() {
            control.check()?;
            new.add_facet((plc, extent), i, defects, control)?;
        }
        check_seeds(plc, defects);
        Ok(new)
    }

    /// The points that stand for themselves and are fit for the predicates.
    pub fn usable_points(&self) -> impl Iterator<Item = u32> + '_ {
        let usable = |&v: &u32| self.first[v as usize] == v && check_range(0, self.points[v as usize]).is_ok();
        (0..self.points.len() as u32).filter(usable)
    }

    fn merge_points(&mut self, defects: &mut Vec<PlcDefect>, control: &Control) -> Result<(), Error> {
        let mut at_place = InPieces::new(ByPoint::default(), control);
        let turns = control.turns();
        for (i, &point) in self.points.iter().enumerate() {
            turns.check()?;
            if let Err(error) = check_range(i, point) {
                let kind = match error {
                    Error::NotFinite { .. } => PlcDefectKind::NotFinite,
                    _ => PlcDefectKind::OutOfRange,
                };
                defects.push(PlcDefect::new(kind, [DomainElement::Point(i)], point));
            }
            let first = at_place.first(point, i as u32);
            if first != i as u32 {
                let elements = [DomainElement::Point(i), DomainElement::Point(first as usize)];
                defects.push(PlcDefect::new(PlcDefectKind::DuplicatePoint, elements, point));
            }
            self.first.push(first);
        }
        Ok(())
    }

    /// The point that stands for a named one, if it is fit for the predicates.
    fn named(&self, v: u32, element: DomainElement, defects: &mut Vec<PlcDefect>) -> Option<u32> {
        let Some(&first) = self.first.get(v as usize) else {
            let defect = PlcDefect::new(PlcDefectKind::NoSuchPoint, [element], DVec3::NAN);
            defects.push(defect.measured(f64::from(v)));
            return None;
        };
        check_range(0, self.points[first as usize]).is_ok().then_some(first)
    }

    fn side(&mut self, ends: [u32; 2]) -> &mut Side {
        let key = edge_key(ends);
        let next = self.sides.len() as u32;
        let index = *self.side_of.entry(key).or_insert(next);
        if index == next {
            self.sides.push(Side { ends: key, listed: None, facets: Vec::new(), between: Vec::new() });
        }
        &mut self.sides[index as usize]
    }

    fn add_segment(&mut self, index: usize, ends: [u32; 2], defects: &mut Vec<PlcDefect>) {
        let element = DomainElement::Segment(index);
        let [a, b] = ends.map(|v| self.named(v, element, defects));
        let (Some(a), Some(b)) = (a, b) else { return };
        let place = self.points[a as usize];
        if a == b {
            defects.push(PlcDefect::new(PlcDefectKind::NoLength, [element], place));
            return;
        }
        match self.side([a, b]).listed {
            Some(other) => {
                let elements = [element, DomainElement::Segment(other)];
                defects.push(PlcDefect::new(PlcDefectKind::DuplicateSegment, elements, place));
            }
            None => self.side([a, b]).listed = Some(index),
        }
    }

    fn add_facet(
        &mut self,
        (plc, extent): (&Plc, f64),
        index: usize,
        defects: &mut Vec<PlcDefect>,
        control: &Control,
    ) -> Result<(), Error> {
        let element = DomainElement::Facet(index);
        let facet = &plc.facets[index];
        if facet.polygons.is_empty() || facet.polygons.iter().any(Vec::is_empty) {
            defects.push(PlcDefect::new(PlcDefectKind::Empty, [element], DVec3::NAN));
            return Ok(());
        }
        if facet.holes.iter().any(|hole| !hole.is_finite()) {
            defects.push(PlcDefect::new(PlcDefectKind::NotFinite, [element], DVec3::NAN));
            return Ok(());
        }
        let mut vertices = Vec::new();
        let mut sides = Vec::new();
        let (before, turns) = (defects.len(), control.turns());
        for polygon in &facet.polygons {
            let some = polygon.iter().take_while(|_| turns.go_on());
            let ring: Vec<u32> = some.filter_map(|&v| self.named(v, element, defects)).collect();
            turns.end()?;
            if ring.len() < polygon.len() {
                // An unusable point has a defect of its own.
                continue;
            }
            for (i, &v) in ring.iter().enumerate() {
                turns.check()?;
                vertices.push(v);
                let next = ring[(i + 1) % ring.len()];
                if v != next {
                    sides.push(edge_key([v, next]));
                }
            }
        }
        sort_unique(&mut vertices, &control.watch())?;
        sort_unique(&mut sides, &control.watch())?;
        if defects.len() > before || vertices.is_empty() {
            return Ok(());
        }
        let place = |v: u32| plc.points[v as usize];
        let Some(normal) = facet_normal_within(&self.points, &vertices, control)? else {
            defects.push(PlcDefect::new(PlcDefectKind::NoArea, [element], place(vertices[0])));
            return Ok(());
        };
        if let Some((v, off)) = off_plane_within(&self.points, &vertices, normal, extent, control)? {
            defects.push(PlcDefect::new(PlcDefectKind::NotPlanar, [element], place(v)).measured(off));
            return Ok(());
        }
        let axis = dominant_axis(normal);
        match triangles_within(&self.points, &vertices, (&sides, &[]), axis, &facet.holes, control)? {
            Ok(triangles) => {
                memory::grow_long(&mut self.triangles, triangles.len(), "facets", control)?;
                self.triangles.extend(triangles.into_iter().map(|t| (t, index as u32)));
            }
            Err(PlanarDefect::Range(v) | PlanarDefect::Crossing([v, _]) | PlanarDefect::SamePlace(v, _)) => {
                defects.push(PlcDefect::new(PlcDefectKind::CrossingSides, [element], place(v)));
                return Ok(());
            }
        }
        for ends in sides {
            turns.check()?;
            self.side(ends).facets.push(index as u32);
        }
        self.corners[index] = vertices;
        Ok(())
    }
}

/// Sides or facets given back at once.
const PART: usize = 1 << 12;

impl Leavings for Arrangement {
    fn give_back(&mut self) -> bool {
        let Arrangement { points, first, sides, side_of, triangles, corners, inside } = self;
        if points.give_back() || first.give_back() || side_of.give_back() || triangles.give_back() {
            return true;
        }
        give_elements_back(sides, PART) || give_elements_back(corners, PART) || give_elements_back(inside, PART)
    }
}

fn check_seeds(plc: &Plc, defects: &mut Vec<PlcDefect>) {
    if plc.regions.len() > MAX_REGIONS {
        let defect = PlcDefect::new(PlcDefectKind::TooManyRegions, [DomainElement::Region(MAX_REGIONS)], DVec3::NAN);
        defects.push(defect.measured(MAX_REGIONS as f64));
    }
    let holes = plc.holes.iter().enumerate().map(|(i, &p)| (DomainElement::Hole(i), p));
    let regions = plc.regions.iter().enumerate().map(|(i, r)| (DomainElement::Region(i), r.point));
    for (element, point) in holes.chain(regions).filter(|(_, point)| !point.is_finite()) {
        defects.push(PlcDefect::new(PlcDefectKind::NotFinite, [element], point));
    }
}
