//! The planar triangulation of one facet: its own Delaunay triangulation inside the one in space, constrained to its segments.
//!
//! The representation is the map from directed edges to apices that J. R. Shewchuk describes for small planar
//! triangulations: `(u, v) ↦ w` for each counterclockwise triangle `uvw`. Points are inserted by the planar
//! Bowyer–Watson step.
//!
//! Facets that don't lie along the axes can't hold their points exactly. So nothing here asks whether a point is *on* the facet: orientation is
//! decided (exactly) after dropping the coordinate in which the normal is longest, and the circle test is an (exact) in-sphere test
//! with one auxiliary point far above the facet, whose sphere cuts the plane in that circle. For points
//! exactly in the plane this is the circle test of the triangulation in space, its perturbation included.

use glam::DVec3;
use rustc_hash::FxHashSet;

use crate::geometry::perturbation::in_conflict;
use crate::geometry::predicates::orient2d;
use crate::geometry::{Filter, Sign};
use crate::leavings::{InPieces, Leavings};
use crate::parted::PartedMap;
use crate::sorting::{sort, sort_unique};
use crate::{memory, Control, Error};

/// A facet's triangles, counterclockwise seen from the positive end of its dominant axis.
#[derive(Clone, Debug)]
pub struct FacetTriangulation {
    /// The caller's own number for the facet.
    pub marker: i32,
    /// The vertices that it started with, in order.
    pub corners: Vec<u32>,
    /// The coordinate that is dropped.
    axis: usize,
    /// A unit normal, rounded.
    plane_normal: DVec3,
    /// Above the facet, for circle tests.
    above: DVec3,
    filter: Filter,
    apex: PartedMap<[u32; 2], u32>,
}

/// What the triangulation in space says of a facet's triangle when a point is inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InSpace {
    /// It is a face, and both tetrahedra at it go: it goes.
    BothGo,
    /// It is a face, and one of them goes: rounding put the point beside the facet's plane. The circle decides.
    OneGoes,
    /// It is a face and stays.
    Stays,
    /// It is no face (yet): the circle decides.
    Missing,
}

/// What an insertion changed.
#[derive(Clone, Debug, Default)]
pub struct FacetChange {
    /// Triangles that are gone.
    pub removed: Vec<[u32; 3]>,
    /// Triangles that are new.
    pub created: Vec<[u32; 3]>,
}

impl FacetChange {
    /// What takes it back.
    pub fn reversed(self) -> FacetChange {
        FacetChange { removed: self.created, created: self.removed }
    }
}

/// The same triangle with the lowest vertex first, orientation kept.
fn rotate_lowest([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a <= b && a <= c {
        [a, b, c]
    } else if b <= a && b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// A triangle's directed edges, each with its apex.
fn sides([a, b, c]: [u32; 3]) -> [([u32; 2], u32); 3] {
    [([a, b], c), ([b, c], a), ([c, a], b)]
}

/// The coordinate in which a normal is longest.
pub fn dominant_axis(normal: DVec3) -> usize {
    let n = normal.abs();
    if n.x >= n.y && n.x >= n.z {
        0
    } else if n.y >= n.z {
        1
    } else {
        2
    }
}

impl FacetTriangulation {
    /// A facet from triangles that cover it, in any orientation. `normal` need not be exact.
    pub fn new(
        triangles: &[[u32; 3]],
        normal: DVec3,
        marker: i32,
        points: &[DVec3],
        control: &Control,
    ) -> Result<FacetTriangulation, Error> {
        let axis = dominant_axis(normal);
        let turns = control.turns();
        let corners = || triangles.iter().flatten().map(|&v| points[v as usize]);
        let mut filter = Filter::default();
        for p in corners() {
            turns.check()?;
            filter.extend(p);
        }
        let (low, high) = filter.bounding_box();
        let mut above = corners().next().unwrap_or_default();
        above[axis] = high[axis] + 2.0 * (high - low).max_element().max(crate::geometry::MIN_LENGTH);
        filter.extend(above);
        let level = (0..3).find(|&axis| low[axis] == high[axis]);
        let plane_normal = level.map_or(normal.normalize_or_zero(), |axis| DVec3::AXES[axis]);
        let mut unique = memory::room_in_pieces(3 * triangles.len(), "facet", control)?;
        for &triangle in triangles {
            turns.check()?;
            unique.extend(triangle);
        }
        sort_unique(&mut unique, &control.watch())?;
        let mut facet = FacetTriangulation {
            marker,
            corners: unique.keep(),
            axis,
            plane_normal,
            above,
            filter,
            apex: PartedMap::default(),
        };
        for &[a, b, c] in triangles {
            turns.check()?;
            let at = |v: u32| points[v as usize];
            let positive = orient2d(axis, at(a), at(b), at(c)) != Sign::Negative;
            facet.add(if positive { [a, b, c] } else { [a, c, b] });
        }
        Ok(facet)
    }

    /// A copy, unless memory is lacking or the control says stop.
    pub fn try_clone(&self, control: &Control) -> Result<FacetTriangulation, Error> {
        let FacetTriangulation { marker, axis, plane_normal, above, .. } = *self;
        let (filter, corners) = (self.filter.clone(), memory::copied(&self.corners, "facet", control)?);
        let apex = self.apex.try_clone(control)?;
        Ok(FacetTriangulation { marker, corners, axis, plane_normal, above, filter, apex })
    }

    fn add(&mut self, triangle: [u32; 3]) {
        for (edge, apex) in sides(triangle) {
            let old = self.apex.insert(edge, apex);
            debug_assert!(old.is_none());
        }
    }

    fn remove(&mut self, triangle: [u32; 3]) {
        for (edge, _) in sides(triangle) {
            self.apex.remove(&edge);
        }
    }

    /// All triangles, in order of storage.
    pub(crate) fn each_triangle(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let all = self.apex.iter().map(|(&[a, b], &c)| [a, b, c]);
        all.filter(|&triangle| rotate_lowest(triangle) == triangle)
    }

    /// All triangles, in order of their vertices.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        // Nobody cancels it.
        self.triangles_within(Control::never()).unwrap_or_default()
    }

    /// [`triangles`](Self::triangles), unless the control says stop.
    pub(crate) fn triangles_within(&self, control: &Control) -> Result<Vec<[u32; 3]>, Error> {
        let mut all = InPieces::new(Vec::new(), control);
        let turns = control.turns();
        for triangle in self.each_triangle() {
            turns.check()?;
            all.push(triangle);
        }
        sort(&mut all, &control.watch())?;
        Ok(all.keep())
    }

    /// The triangle with these vertices, counterclockwise.
    pub fn triangle(&self, [a, b, c]: [u32; 3]) -> Option<[u32; 3]> {
        [[a, b, c], [b, a, c]].into_iter().find(|&[a, b, c]| self.apex.get(&[a, b]) == Some(&c))
    }

    /// Whether a triangle is seen counterclockwise in this order of its vertices; `None` when it is none of the facet's.
    pub fn is_forward(&self, [a, b, c]: [u32; 3]) -> Option<bool> {
        if self.apex.get(&[a, b]) == Some(&c) {
            return Some(true);
        }
        (self.apex.get(&[b, a]) == Some(&c)).then_some(false)
    }

    /// A unit normal of the facet's plane, along an axis exactly where all points it started with agree in that coordinate.
    pub fn normal(&self) -> DVec3 {
        self.plane_normal
    }

    /// The triangles at an edge: one on the facet's border, two inside.
    pub fn at_edge(&self, [a, b]: [u32; 2]) -> impl Iterator<Item = [u32; 3]> + '_ {
        [[a, b], [b, a]].into_iter().filter_map(|[a, b]| self.apex.get(&[a, b]).map(|&c| [a, b, c]))
    }

    /// The triangle that holds the point `p`, by a walk from `start` that crosses no fixed edge; `None` when there is one between.
    pub fn locate_from(
        &self,
        start: [u32; 3],
        p: DVec3,
        points: &[DVec3],
        fixed: impl Fn([u32; 2]) -> bool,
    ) -> Option<[u32; 3]> {
        let at = |v: u32| points[v as usize];
        let mut triangle = self.triangle(start)?;
        // Rounding could make the walk go round in circles.
        for _ in 0..self.apex.len() + 1 {
            let beyond = |&([a, b], _): &([u32; 2], u32)| orient2d(self.axis, at(a), at(b), p) == Sign::Negative;
            let Some(([a, b], _)) = sides(triangle).into_iter().find(beyond) else { return Some(triangle) };
            if fixed([a, b]) {
                return None;
            }
            triangle = [b, a, *self.apex.get(&[b, a])?];
        }
        None
    }

    /// The fixed edge that hides the point `p` from a triangle's middle, if one does; the straight way is looked along. `None` also where that
    /// meets a vertex.
    pub fn hidden_by(
        &self,
        start: [u32; 3],
        p: DVec3,
        points: &[DVec3],
        fixed: impl Fn([u32; 2]) -> bool,
    ) -> Option<[u32; 2]> {
        let at = |v: u32| points[v as usize];
        let mut triangle = self.triangle(start)?;
        let middle = triangle.map(at).into_iter().sum::<DVec3>() / 3.0;
        let side = |v: u32| orient2d(self.axis, middle, p, at(v));
        for _ in 0..self.apex.len() + 1 {
            let crossed = |&([a, b], _): &([u32; 2], u32)| {
                side(a) == Sign::Negative
                    && side(b) == Sign::Positive
                    && orient2d(self.axis, at(a), at(b), p) == Sign::Negative
            };
            let ([a, b], _) = sides(triangle).into_iter().find(crossed)?;
            if fixed([a, b]) {
                return Some([a, b]);
            }
            triangle = [b, a, *self.apex.get(&[b, a])?];
        }
        None
    }

    fn in_circle(&self, filter: &Filter, [a, b, c]: [u32; 3], p: DVec3, points: &[DVec3]) -> bool {
        let at = |v: u32| points[v as usize];
        in_conflict(filter, [at(a), at(b), at(c), self.above], p)
    }

    fn counterclockwise(&self, a: DVec3, b: DVec3, c: DVec3) -> bool {
        orient2d(self.axis, a, b, c) == Sign::Positive
    }

    /// Inserts the vertex `new` at `points[new]`, which lies in the circumcircle of `start`, or on a fixed edge of it, which then is
    /// split. No other fixed edge is crossed. `None`, with nothing changed, when the point can't be
    /// seen from its cavity: it lies beyond a fixed edge, or rounding put it on the wrong side of one.
    ///
    /// `in_space` keeps the facet in step with the triangulation in space: for points exactly in the plane the circle would always say
    /// the same, but not where rounding decides about cocircular points.
    pub fn insert(
        &mut self,
        new: u32,
        start: &[[u32; 3]],
        split: Option<[u32; 2]>,
        points: &[DVec3],
        fixed: impl Fn([u32; 2]) -> bool,
        in_space: impl Fn([u32; 3]) -> InSpace,
    ) -> Option<FacetChange> {
        // Nobody cancels it.
        let change = self.plan((new, start, split), points, fixed, in_space, Control::never()).ok()??;
        self.apply(&change, points[new as usize], Control::never()).ok()?;
        Some(change)
    }

    /// What [`insert`](Self::insert) would change, unless the control says stop.
    pub fn plan(
        &self,
        (new, start, split): (u32, &[[u32; 3]], Option<[u32; 2]>),
        points: &[DVec3],
        fixed: impl Fn([u32; 2]) -> bool,
        in_space: impl Fn([u32; 3]) -> InSpace,
        control: &Control,
    ) -> Result<Option<FacetChange>, Error> {
        /// So many triangles are found faster by looking through them.
        const FEW: usize = 32;
        let turns = control.turns();
        let p = points[new as usize];
        let mut filter = self.filter.clone();
        filter.extend(p);
        let is_split = |[a, b]: [u32; 2]| split == Some([a, b]) || split == Some([b, a]);
        let mut removed: Vec<[u32; 3]> = start.to_vec();
        let mut known: FxHashSet<[u32; 3]> = FxHashSet::default();
        let mut next = 0;
        while next < removed.len() {
            turns.check()?;
            for ([a, b], _) in sides(removed[next]) {
                if is_split([a, b]) || fixed([a, b]) {
                    continue;
                }
                let Some(&c) = self.apex.get(&[b, a]) else { continue };
                let triangle = [b, a, c];
                if known.is_empty() && removed.len() > FEW {
                    known.extend(removed.iter().map(|&t| rotate_lowest(t)));
                }
                let lowest = rotate_lowest(triangle);
                let is_known = if known.is_empty() {
                    removed.iter().any(|&t| rotate_lowest(t) == lowest)
                } else {
                    known.contains(&lowest)
                };
                let goes = || match in_space(triangle) {
                    InSpace::BothGo => true,
                    InSpace::Stays => false,
                    InSpace::OneGoes | InSpace::Missing => self.in_circle(&filter, triangle, p, points),
                };
                if !is_known && goes() {
                    removed.push(triangle);
                    if !known.is_empty() {
                        known.insert(lowest);
                    }
                }
            }
            next += 1;
        }
        // Where rounding hides an edge of the cavity from the point, the cavity shrinks.
        let border = loop {
            control.check()?;
            let inner: FxHashSet<[u32; 2]> = removed.iter().flat_map(|&t| sides(t).map(|(e, _)| e)).collect();
            let border: Vec<([u32; 2], usize)> = removed
                .iter()
                .enumerate()
                .flat_map(|(i, &t)| sides(t).map(|(e, _)| (e, i)))
                .filter(|&([a, b], _)| !is_split([a, b]) && (!inner.contains(&[b, a]) || fixed([a, b])))
                .collect();
            let at = |v: u32| points[v as usize];
            let hidden = border.iter().find(|&&([a, b], _)| !self.counterclockwise(at(a), at(b), p));
            match hidden {
                None => break border,
                Some(&(_, i)) if i >= start.len() => {
                    removed.remove(i);
                }
                Some(_) => return Ok(None),
            }
        };
        let created: Vec<[u32; 3]> = border.into_iter().map(|([a, b], _)| [a, b, new]).collect();
        Ok(Some(FacetChange { removed, created }))
    }

    /// Does what was [planned](Self::plan) for a vertex at `p`. When the control says stop, half of it is done.
    pub fn apply(&mut self, change: &FacetChange, p: DVec3, control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        self.filter.extend(p);
        for &t in &change.removed {
            turns.check()?;
            self.remove(t);
        }
        for &t in &change.created {
            turns.check()?;
            self.add(t);
        }
        Ok(())
    }

    /// What the triangulation would be without some of its vertices. `at_them` are the triangles at them, `joined` the fixed edges that come in the
    /// place of two that meet in one of them. `None` where the rest can't be triangulated within the same border and fixed edges.
    pub fn without(
        &self,
        remove: &[u32],
        at_them: impl Iterator<Item = [u32; 3]>,
        joined: &[[u32; 2]],
        points: &[DVec3],
        fixed: impl Fn([u32; 2]) -> bool,
    ) -> Option<FacetChange> {
        let at = |v: u32| points[v as usize];
        let goes = |v: &u32| remove.contains(v);
        let removed: Vec<[u32; 3]> =
            at_them.map(|face| self.triangle(face).map(rotate_lowest)).collect::<Option<_>>()?;
        let mut inner: Vec<[u32; 2]> = removed.iter().flat_map(|&t| sides(t).map(|(e, _)| e)).collect();
        inner.sort_unstable();
        let is_inner = |edge: [u32; 2]| inner.binary_search(&edge).is_ok();
        let mut open: Vec<[u32; 2]> = Vec::with_capacity(removed.len() + 2);
        for &triangle in &removed {
            for ([a, b], _) in sides(triangle) {
                if goes(&a) || goes(&b) {
                    // A spoke must lead on, or lie on a segment.
                    if !is_inner([b, a]) && !fixed([a, b]) {
                        return None;
                    }
                } else if !is_inner([b, a]) {
                    open.push([a, b]);
                } else if fixed([a, b]) {
                    return None;
                }
            }
        }
        // Where a joined edge closes an open chain, it does so from the side that the chain lies on.
        for &[a, b] in joined {
            for [a, b] in [[a, b], [b, a]] {
                if inner.iter().any(|&[x, y]| x == a && goes(&y) && fixed([x, y])) && !goes(&b) {
                    open.push([a, b]);
                }
            }
        }
        let mut vertices: Vec<u32> = open.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let limit = removed.len() + 2;
        let mut created: Vec<[u32; 3]> = Vec::with_capacity(removed.len());
        while let Some([a, b]) = open.pop() {
            let mut apex: Option<u32> = None;
            for &x in &vertices {
                if x == a || x == b || !self.counterclockwise(at(a), at(b), at(x)) {
                    continue;
                }
                if apex.is_none_or(|c| self.in_circle(&self.filter, [a, b, c], at(x), points)) {
                    apex = Some(x);
                }
            }
            let c = apex?;
            created.push([a, b, c]);
            if created.len() > limit {
                return None;
            }
            for [p, q] in [[b, c], [c, a]] {
                match open.iter().position(|&edge| edge == [p, q]) {
                    Some(place) => {
                        open.swap_remove(place);
                    }
                    None => open.push([q, p]),
                }
            }
        }
        // Nothing that comes may stand across an edge from what stays.
        let free = |&[a, b, c]: &[u32; 3]| {
            sides([a, b, c]).into_iter().all(|(edge, _)| is_inner(edge) || !self.apex.contains_key(&edge))
        };
        created.iter().all(free).then_some(FacetChange { removed, created })
    }

    /// Puts triangles in the place of others.
    pub fn exchange(&mut self, change: &FacetChange) {
        for &triangle in &change.removed {
            self.remove(triangle);
        }
        for &triangle in &change.created {
            self.add(triangle);
        }
    }

    /// Gives its vertices new ids. What is left is of no use when the control says stop.
    pub fn renumber(&mut self, renamed: impl Fn(u32) -> u32, control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        for v in &mut self.corners {
            turns.check()?;
            *v = renamed(*v);
        }
        debug_assert!(self.corners.is_sorted());
        self.apex.rekey(control, |edge, apex| {
            *apex = renamed(*apex);
            Some(edge.map(&renamed))
        })
    }

    /// Whether a triangle's circumcircle holds a point of the facet.
    pub fn holds(&self, triangle: [u32; 3], p: DVec3, points: &[DVec3]) -> bool {
        let mut filter = self.filter.clone();
        filter.extend(p);
        self.in_circle(&filter, triangle, p, points)
    }

    /// Flips edges until every triangle's circle is free of its neighbours' apices, fixed edges excepted (C. L. Lawson, 1977).
    pub fn make_delaunay(
        &mut self,
        points: &[DVec3],
        fixed: impl Fn([u32; 2]) -> bool,
        control: &Control,
    ) -> Result<(), Error> {
        let mut queue = self.apex.sorted_keys(control)?;
        let turns = control.turns();
        queue.retain(|[a, b]| turns.go_on() && a < b);
        turns.end()?;
        // Exactly planar facets need at most a flip an edge pair; rounding elsewhere must not keep this going for ever.
        let mut budget = 64 + queue.len() * queue.len().min(4096);
        while let Some([a, b]) = queue.pop() {
            turns.check()?;
            let (Some(&c), Some(&d)) = (self.apex.get(&[a, b]), self.apex.get(&[b, a])) else { continue };
            if budget == 0 || fixed([a, b]) || !self.in_circle(&self.filter, [a, b, c], points[d as usize], points) {
                continue;
            }
            let at = |v: u32| points[v as usize];
            if !self.counterclockwise(at(c), at(d), at(b)) || !self.counterclockwise(at(d), at(c), at(a)) {
                continue;
            }
            budget -= 1;
            self.remove([a, b, c]);
            self.remove([b, a, d]);
            self.add([c, d, b]);
            self.add([d, c, a]);
            queue.extend([[a, d], [d, b], [b, c], [c, a]]);
        }
        Ok(())
    }
}

impl Leavings for FacetTriangulation {
    fn give_back(&mut self) -> bool {
        self.apex.give_back() || self.corners.give_back()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> (Vec<DVec3>, FacetTriangulation) {
        let points: Vec<DVec3> = [[0., 0., 3.], [4., 0., 3.], [4., 4., 3.], [0., 4., 3.]].map(DVec3::from).to_vec();
        let facet =
            FacetTriangulation::new(&[[0, 1, 2], [0, 3, 2]], DVec3::NEG_Z, 7, &points, &Control::new()).unwrap();
        (points, facet)
    }

    #[test]
    fn inserting_inside_and_on_the_border() {
        let (mut points, mut facet) = square();
        let border = |[a, b]: [u32; 2]| a < 4 && b < 4 && (a + b) % 2 == 1;
        points.push(DVec3::new(2.0, 1.0, 3.0));
        let start = facet.triangle([1, 2, 0]).unwrap();
        let change = facet.insert(4, &[start], None, &points, border, |_| InSpace::Missing).unwrap();
        assert_eq!((change.removed.len(), change.created.len()), (2, 4));
        points.push(DVec3::new(2.0, 0.0, 3.0));
        let start: Vec<_> = facet.at_edge([0, 1]).collect();
        let change = facet.insert(5, &start, Some([0, 1]), &points, border, |_| InSpace::Missing).unwrap();
        assert_eq!(facet.triangles().len(), 5);
        assert!(change.created.iter().all(|t| t.contains(&5)));
        assert!(facet.at_edge([0, 1]).next().is_none());
        assert_eq!(facet.at_edge([0, 5]).count(), 1);
    }

    #[test]
    fn points_beyond_a_fixed_edge_are_refused() {
        let (mut points, mut facet) = square();
        points.push(DVec3::new(2.0, -0.1, 3.0));
        let before = facet.triangles();
        let start = facet.triangle([0, 1, 2]).unwrap();
        assert!(facet.insert(4, &[start], None, &points, |_| true, |_| InSpace::Missing).is_none());
        assert_eq!(facet.triangles(), before);
    }

    /// All triangles of a round facet go for its centre.
    #[test]
    fn a_large_change_is_planned_as_a_small_one_is_and_can_be_cancelled() {
        let at = |k: u32| (std::f64::consts::TAU * f64::from(k) / 1000.0).sin_cos();
        let mut points: Vec<DVec3> = (0..1000).map(|k| DVec3::new(at(k).1, at(k).0, 0.0)).collect();
        points.push(DVec3::ZERO);
        let triangles: Vec<[u32; 3]> = (1..999).map(|k| [0, k, k + 1]).collect();
        let control = Control::new();
        let facet = FacetTriangulation::new(&triangles, DVec3::Z, 0, &points, &control).unwrap();
        let plan = || {
            let border = |[a, b]: [u32; 2]| (a + 1) % 1000 == b || (b + 1) % 1000 == a;
            facet.plan((1000, &[[0, 500, 501]], None), &points, border, |_| InSpace::BothGo, &control)
        };
        let mut change = None;
        let looks = control.looks(None, || change = plan().unwrap());
        let change = change.unwrap();
        let mut created = change.created.clone();
        created.sort_unstable();
        let expected: Vec<[u32; 3]> = (0..1000).map(|k| [k, (k + 1) % 1000, 1000]).collect();
        assert_eq!((change.removed.len(), created), (998, expected));
        assert!(looks > 3, "{looks}");
        for last in 1..=looks {
            control.looks(Some(last), || assert_eq!(plan().err(), Some(Error::Cancelled)));
        }
    }

    #[test]
    fn flips_make_it_delaunay() {
        let points: Vec<DVec3> = [[0., 0., 0.], [4., -1., 0.], [8., 0., 0.], [4., 1., 0.]].map(DVec3::from).to_vec();
        let mut facet =
            FacetTriangulation::new(&[[0, 1, 2], [0, 2, 3]], DVec3::Z, 0, &points, &Control::new()).unwrap();
        facet.make_delaunay(&points, |_| false, &Control::new()).unwrap();
        assert_eq!(facet.triangles(), [[0, 1, 3], [1, 2, 3]]);
    }
}
