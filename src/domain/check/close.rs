//! What is close enough in a complex to meet. One join of the triangles' [bounding boxes](super::boxes) finds nearly all of it: a side or a point of a triangle
//! can't touch what the triangle's box doesn't. Most pairs of triangles whose boxes meet have a corner in common and go apart from there, which
//! three orientations show. Only sides and points that are of no triangle are looked up by themselves.

use super::arrangement::{Arrangement, Side};
use super::boxes::Boxes;
use crate::domain::boundary::edge_key;
use crate::geometry::{Filter, Sign};
use crate::leavings::{InPieces, Leavings};
use crate::sorting::sort_unique;
use crate::{memory, Control, DVec3, Error};

const NONE: u32 = u32::MAX;

/// Pairs of what may meet, by number, each list in order. What can't, as its orientations show, is not among them.
#[derive(Debug, Default)]
pub(super) struct Close {
    /// Points, named by the first at their place, and sides.
    pub points_at_sides: Vec<[u32; 2]>,
    /// Points and triangles.
    pub points_at_triangles: Vec<[u32; 2]>,
    /// Sides in one plane, the lower number first.
    pub sides: Vec<[u32; 2]>,
    /// Sides and triangles between whose planes' two sides they go.
    pub sides_through: Vec<[u32; 2]>,
    /// Triangles of different facets in one plane, the lower number first.
    pub triangles: Vec<[u32; 2]>,
}

impl Close {
    fn lists(&mut self) -> [&mut Vec<[u32; 2]>; 5] {
        let Close { points_at_sides, points_at_triangles, sides, sides_through, triangles } = self;
        [points_at_sides, points_at_triangles, sides, sides_through, triangles]
    }

    /// Looks for what is close. A point reaches as far as `reach_of` says.
    pub fn find<'a>(
        a: &Arrangement,
        reach_of: impl Fn(u32) -> f64,
        control: &'a Control,
    ) -> Result<InPieces<'a, Close>, Error> {
        let at = |v: u32| a.points[v as usize];
        let triangles = Boxes::new(a.triangles.iter().map(|(triangle, _)| triangle.map(at)), control)?;
        let mut search = Search::new(a, control)?;
        triangles.each_pair(control, |i, j| search.triangles(i, j))?;
        search.what_is_alone(&triangles, reach_of)?;
        let mut close = InPieces::new(std::mem::take(&mut *search.close), control);
        for list in close.lists() {
            sort_unique(list, &control.watch())?;
        }
        Ok(close)
    }
}

impl Leavings for Close {
    fn give_back(&mut self) -> bool {
        self.lists().into_iter().any(Leavings::give_back)
    }
}

/// Whether a point lies in the bounding box of some.
fn in_box<const N: usize>(p: DVec3, of: [DVec3; N]) -> bool {
    boxes_meet([p], of)
}

/// Whether the bounding boxes of some points meet.
fn boxes_meet<const N: usize, const M: usize>(these: [DVec3; N], those: [DVec3; M]) -> bool {
    let ends = |(low, high): (DVec3, DVec3), p: DVec3| (low.min(p), high.max(p));
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let ((low, high), (from, to)) = (these.into_iter().fold(nothing, ends), those.into_iter().fold(nothing, ends));
    low.cmple(to).all() && from.cmple(high).all()
}

struct Search<'a, 'c> {
    a: &'a Arrangement,
    filter: Filter,
    /// The first triangle of each point.
    triangle_of: InPieces<'c, Vec<u32>>,
    /// By triangle: the sides that it is the first one of.
    sides_of: InPieces<'c, Vec<[u32; 3]>>,
    /// The sides of no triangle.
    alone: InPieces<'c, Vec<u32>>,
    close: InPieces<'c, Close>,
    control: &'c Control,
}

impl<'a, 'c> Search<'a, 'c> {
    fn new(a: &'a Arrangement, control: &'c Control) -> Result<Self, Error> {
        let turns = control.turns();
        let mut filter = Filter::default();
        let mut triangle_of = memory::filled(a.points.len(), NONE, "points", control)?;
        let mut triangle_of_side = memory::filled(a.sides.len(), NONE, "sides", control)?;
        let mut sides_of = memory::filled(a.triangles.len(), [NONE; 3], "sides", control)?;
        for (i, (triangle, _)) in (0..).zip(&a.triangles) {
            turns.check()?;
            for k in 0..3 {
                let of_point = &mut triangle_of[triangle[k] as usize];
                *of_point = i.min(*of_point);
                let Some(&side) = a.side_of.get(&edge_key([triangle[k], triangle[(k + 1) % 3]])) else { continue };
                let of_side = &mut triangle_of_side[side as usize];
                if *of_side == NONE {
                    *of_side = i;
                    sides_of[i as usize][k] = side;
                }
            }
        }
        let mut alone = memory::room_in_pieces(0, "sides", control)?;
        for (side, &of_side) in (0..).zip(triangle_of_side.iter()) {
            turns.check()?;
            if of_side == NONE {
                memory::grow_long(&mut alone, 1, "sides", control)?;
                alone.push(side);
            }
        }
        for v in a.usable_points() {
            turns.check()?;
            filter.extend(a.points[v as usize]);
        }
        let close = InPieces::new(Close::default(), control);
        Ok(Search { a, filter, triangle_of, sides_of, alone, close, control })
    }

    fn at<const N: usize>(&self, vertices: [u32; N]) -> [DVec3; N] {
        vertices.map(|v| self.a.points[v as usize])
    }

    fn push(&mut self, list: impl FnOnce(&mut Close) -> &mut Vec<[u32; 2]>, pair: [u32; 2]) -> Result<(), Error> {
        let list = list(&mut self.close);
        if list.len() == list.capacity() {
            memory::grow_long(list, 1, "pairs", self.control)?;
        }
        list.push(pair);
        Ok(())
    }

    /// On which sides of a triangle's plane the points of another lie that are not common to both: `None` where that is both, or on it.
    fn common_side(&self, triangle: [u32; 3], other: [u32; 3]) -> Option<Sign> {
        let [x, y, z] = self.at(triangle);
        let own = other.into_iter().filter(|v| !triangle.contains(v));
        let mut signs = own.map(|v| self.filter.orient3d(x, y, z, self.a.points[v as usize]));
        let first = signs.next().filter(|&sign| sign != Sign::Zero)?;
        signs.all(|sign| sign == first).then_some(first)
    }

    /// Whether all points of another triangle are in a triangle's plane.
    fn in_one_plane(&self, triangle: [u32; 3], other: [u32; 3]) -> bool {
        let [x, y, z] = self.at(triangle);
        let on_plane = |&v: &u32| self.filter.orient3d(x, y, z, self.a.points[v as usize]) == Sign::Zero;
        other.iter().filter(|v| !triangle.contains(v)).all(on_plane)
    }

    /// What may meet of two triangles whose boxes do.
    fn triangles(&mut self, i: u32, j: u32) -> Result<(), Error> {
        let a = self.a;
        let [(p, f), (q, g)] = [i, j].map(|i| a.triangles[i as usize]);
        // One of them is in the other's plane with what is common to both, and no more.
        if self.common_side(p, q).is_some() || self.common_side(q, p).is_some() {
            return Ok(());
        }
        if f != g && self.in_one_plane(p, q) {
            self.push(|close| &mut close.triangles, [i, j])?;
        }
        let sides = [i, j].map(|i| self.sides_of[i as usize]);
        for [(own, own_sides), (other, other_sides)] in [[(i, sides[0]), (j, sides[1])], [(j, sides[1]), (i, sides[0])]]
        {
            let corners = a.triangles[other as usize].0;
            let around = self.at(corners);
            for v in a.triangles[own as usize].0 {
                let place = a.points[v as usize];
                if self.triangle_of[v as usize] != own || corners.contains(&v) || !in_box(place, around) {
                    continue;
                }
                self.push(|close| &mut close.points_at_triangles, [v, other])?;
                for side in other_sides.into_iter().filter(|&side| side != NONE) {
                    if in_box(place, self.at(a.sides[side as usize].ends)) {
                        self.push(|close| &mut close.points_at_sides, [v, side])?;
                    }
                }
            }
            for side in own_sides.into_iter().filter(|&side| side != NONE) {
                self.side_and_triangle(side, other)?;
            }
        }
        for side in sides[0].into_iter().filter(|&side| side != NONE) {
            for other in sides[1].into_iter().filter(|&side| side != NONE) {
                self.two_sides(side, other)?;
            }
        }
        Ok(())
    }

    /// Whether a side may go through a triangle.
    fn side_and_triangle(&mut self, side: u32, other: u32) -> Result<(), Error> {
        let (Side { ends, facets, .. }, (triangle, facet)) =
            (&self.a.sides[side as usize], self.a.triangles[other as usize]);
        let ([p, q], [x, y, z]) = (self.at(*ends), self.at(triangle));
        if ends.iter().any(|v| triangle.contains(v)) || facets.contains(&facet) || !boxes_meet([p, q], [x, y, z]) {
            return Ok(());
        }
        if self.filter.orient3d(x, y, z, p) as i8 * self.filter.orient3d(x, y, z, q) as i8 >= 0 {
            return Ok(());
        }
        self.push(|close| &mut close.sides_through, [side, other])
    }

    /// Whether two sides may cross.
    fn two_sides(&mut self, i: u32, j: u32) -> Result<(), Error> {
        let [s, t] = [i, j].map(|i| &self.a.sides[i as usize]);
        // Sides of one facet are the facet's own affair.
        let are_of_one = s.ends.iter().any(|v| t.ends.contains(v)) || s.facets.iter().any(|f| t.facets.contains(f));
        let ([p, q], [r, u]) = (self.at(s.ends), self.at(t.ends));
        if i == j || are_of_one || !boxes_meet([p, q], [r, u]) || self.filter.orient3d(p, q, r, u) != Sign::Zero {
            return Ok(());
        }
        self.push(|close| &mut close.sides, [i.min(j), i.max(j)])
    }

    /// What may meet the sides and points that are of no triangle.
    fn what_is_alone(&mut self, triangles: &Boxes, reach_of: impl Fn(u32) -> f64) -> Result<(), Error> {
        let (a, control) = (self.a, self.control);
        let ends = |side: u32| a.sides[side as usize].ends.map(|v| a.points[v as usize]);
        let alone = Boxes::new(self.alone.iter().map(|&side| ends(side)), control)?;
        let mut sides = None;
        let turns = control.turns();
        for v in a.usable_points() {
            turns.check()?;
            let place = a.points[v as usize];
            if self.triangle_of[v as usize] == NONE {
                control.check()?;
                if sides.is_none() {
                    sides = Some(Boxes::new((0..a.sides.len() as u32).map(ends), control)?);
                }
                for side in sides.iter().flat_map(|sides| sides.at_point(place, reach_of(v))) {
                    self.push(|close| &mut close.points_at_sides, [v, side])?;
                }
                for triangle in triangles.at_point(place, reach_of(v)) {
                    self.push(|close| &mut close.points_at_triangles, [v, triangle])?;
                }
            } else if !self.alone.is_empty() {
                for side in alone.at_point(place, 0.0) {
                    self.push(|close| &mut close.points_at_sides, [v, self.alone[side as usize]])?;
                }
            }
        }
        if self.alone.is_empty() {
            return Ok(());
        }
        let sides = match sides {
            Some(sides) => sides,
            None => Boxes::new((0..a.sides.len() as u32).map(ends), control)?,
        };
        alone.each_pair_with(&sides, control, |i, j| self.two_sides(self.alone[i as usize], j))?;
        alone.each_pair_with(triangles, control, |i, j| self.side_and_triangle(self.alone[i as usize], j))
    }
}
