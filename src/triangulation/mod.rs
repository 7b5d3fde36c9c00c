//! The incremental Delaunay triangulation of points in space.
//!
//! | module | idea |
//! |---|---|
//! | [`topology`] | tetrahedra, adjacency, ghosts; no coordinates |
//! | [`cavity`] | what an insertion would remove and create |
//! | [`remove`] | what a removal, or a replacement of vertices, would remove and create, then doing it |
//! | `search` | the walk to a point and the search of its cavity, four predicates at once |
//! | `incident` | the tetrahedra at a vertex |
//! | `toward` | edges and faces by their vertices |
//! | `labels` | small numbers for a cavity's vertices |
//! | `star` | the cavity replaced |
//! | `large_star` | a large one, in parts |
//! | `journal` | insertions taken back |
//! | `kept` | a large change taken back |
//! | `locate` | where a point lies |
//! | `insert` | one point, or a few |
//! | `bulk` | many points in a spatial order |
//! | `partition` | space divided among threads |
//! | `pass` | insertions in all divisions at once, with the same result as one after the other |
//! | `territory` | what a thread may touch |
//! | `site` | the triangulation as the hot loops and the threads see it |
//! | `order` | that order: BRIO rounds along a Hilbert curve |
//! | `lower` | points that span no volume yet |
//! | `room` | room made ahead, in pieces |
//! | `vertices` | vertex ids, and the gaps that removals leave |
//! | `validate` | the invariants, checked |
//!
//! Cospherical points are decided by [symbolic perturbation](crate::geometry::perturbation), so the triangulation of a point set is
//! unique: it depends on no order of insertion, and is the one that CGAL documents.

mod bulk;
pub mod cavity;
pub(crate) mod incident;
mod insert;
mod journal;
mod kept;
mod labels;
mod large_star;
mod locate;
mod lower;
mod order;
mod partition;
mod pass;
pub mod remove;
mod room;
mod search;
mod site;
mod star;
mod territory;
pub mod topology;
mod toward;
mod validate;
mod vertices;

use glam::DVec3;

use crate::geometry::Filter;
use crate::leavings::{InPieces, Leavings};
use crate::{memory, threads, Control, Error};
use cavity::Cavity;
pub(crate) use lower::ByPoint;
use lower::Lower;
use topology::{Topology, GHOST, NONE};

pub use insert::Inserted;
pub(crate) use insert::Unplaced;
pub(crate) use kept::LARGE;
pub use locate::Location;
pub(crate) use order::spatial_order;
pub use validate::Defect;

/// A Delaunay triangulation of points of any dimension.
///
/// Vertices are numbered in the order of the caller's points; a duplicate gets no number of its own. The id of a removed vertex is given to a
/// point that is inserted alone later. Below dimension 3 (no point, one point, points on a line or in a plane) there are vertices but no
/// tetrahedra; the first point that spans a volume creates them all.
#[derive(Clone, Debug, Default)]
pub struct Triangulation {
    points: Vec<DVec3>,
    gaps: vertices::Gaps,
    pub(crate) topology: Topology,
    pub(crate) filter: Filter,
    lower: Lower,
    /// Where the last insertion happened: the next walk starts there.
    last: u32,
    scratch: Cavity,
    hole: remove::Scratch,
    threads: Threads,
}

/// How many threads a bulk insertion may use; 0 for as many as there are processors.
#[derive(Clone, Copy, Debug)]
struct Threads(usize);

impl Default for Threads {
    fn default() -> Self {
        Threads(1)
    }
}

/// See [`Triangulation::least_edge`].
pub(crate) fn least_edge(low: DVec3, high: DVec3) -> f64 {
    let power = |exponent: u64| f64::from_bits((1023 - exponent) << 52);
    ((high - low).length() * power(40)).max(low.abs().max(high.abs()).max_element() * power(46))
}

impl Leavings for Triangulation {
    fn give_back(&mut self) -> bool {
        let Triangulation { points, gaps, topology, lower, scratch, hole, .. } = self;
        points.give_back()
            || gaps.give_back()
            || topology.give_back()
            || lower.give_back()
            || scratch.give_back()
            || hole.give_back()
    }
}

impl Triangulation {
    /// A copy, unless memory is lacking; [`Error::Cancelled`] when the control says stop. Scratch memory is not copied.
    pub fn try_clone(&self, control: &Control) -> Result<Triangulation, Error> {
        self.try_clone_with_room(0, control)
    }

    /// [`try_clone`](Self::try_clone), with room for so many more tetrahedra.
    fn try_clone_with_room(&self, more: usize, control: &Control) -> Result<Triangulation, Error> {
        let Triangulation { filter, last, threads, .. } = self;
        let (filter, last, threads) = (filter.clone(), *last, *threads);
        let mut copy = InPieces::new(Triangulation { filter, last, threads, ..Triangulation::default() }, control);
        copy.points = memory::copied(&self.points, "points", control)?;
        copy.gaps = self.gaps.try_clone(control)?;
        copy.topology = self.topology.try_clone(more, control)?;
        copy.lower = self.lower.try_clone(control)?;
        Ok(copy.keep())
    }

    /// Forgets all points and keeps the memory of the largest lists for the next ones.
    fn clear(&mut self, control: &Control) {
        let Triangulation { points, gaps, topology, filter, lower, last, .. } = self;
        points.clear();
        topology.clear();
        control.give_back(std::mem::take(lower));
        (*gaps, *filter, *last) = Default::default();
    }

    /// The bytes of its large arrays, with those that they will take besides when they next grow, if that is near.
    pub(crate) fn bytes(&self) -> usize {
        memory::bytes(&self.points) + self.topology.bytes() + self.scratch.bytes()
    }

    /// A triangulation without points.
    pub fn new() -> Self {
        Self::default()
    }

    /// How many threads [`insert_many`](Self::insert_many) may use: 1 by default, 0 for as many as there are processors. They
    /// make it faster and change nothing of the result, not even the order in which tetrahedra are stored.
    pub fn set_threads(&mut self, threads: usize) {
        self.threads = Threads(threads);
    }

    /// How many threads [that](Self::set_threads) stands for.
    pub(crate) fn threads(&self) -> usize {
        threads::count(self.threads.0)
    }

    /// −1 without points, then the dimension that they span: 0 to 3.
    pub fn dimension(&self) -> i32 {
        self.lower.dimension()
    }

    /// Number of tetrahedra.
    pub fn tetrahedron_count(&self) -> usize {
        self.topology.finite_count()
    }

    /// The point of a vertex that exists.
    #[inline]
    pub(crate) fn at(&self, vertex: u32) -> DVec3 {
        self.points[vertex as usize]
    }

    /// The corners of a tetrahedron without the ghost.
    #[inline]
    pub(crate) fn corners(&self, t: u32) -> [DVec3; 4] {
        let [a, b, c, d] = self.topology.tet(t).v;
        [self.at(a), self.at(b), self.at(c), self.at(d)]
    }

    /// [`corners`](Self::corners) where they are.
    #[inline]
    pub(crate) fn corner_refs(&self, t: u32) -> [&DVec3; 4] {
        self.topology.tet(t).v.map(|v| &self.points[v as usize])
    }

    /// The tetrahedra's vertices, positively oriented, in storage order.
    pub fn tetrahedra(&self) -> impl Iterator<Item = [u32; 4]> + '_ {
        self.topology.finite().map(|t| self.topology.tet(t).v)
    }

    /// The hull's facets, counterclockwise seen from outside.
    pub fn hull(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.topology.live().filter(|&t| self.topology.tet(t).is_ghost()).map(|t| {
            let [a, b, c, _] = self.topology.tet(t).v;
            [a, b, c]
        })
    }

    /// The corners of a box of all points, inverted when there is none. Removals don't shrink it; [`compact`](Self::compact) does.
    pub fn bounding_box(&self) -> (DVec3, DVec3) {
        self.filter.bounding_box()
    }

    /// The least length of an edge that a refinement makes where its caller names none: 2⁻⁴⁰ of the bounding box's diagonal, and not less than 2⁻⁴⁶ of
    /// the largest coordinate, of which a facet's points can be off its plane by rounding alone.
    pub(crate) fn least_edge(&self) -> f64 {
        let (low, high) = self.bounding_box();
        least_edge(low, high)
    }

    /// The vertices around an edge in order, and whether they form a ring; at the hull they form an open chain from one hull
    /// facet's third vertex to the other's. `None` when the two vertices are not joined.
    pub fn link(&self, [p, q]: [u32; 2]) -> Option<(Vec<u32>, bool)> {
        if p == q || (p as usize) >= self.points.len() || (q as usize) >= self.points.len() {
            return None;
        }
        let (t, i, j) = self.find_edge(p, q)?;
        let mut link = Vec::new();
        let closed = self.link_of(t, i, j, &mut link);
        Some((link, closed))
    }

    /// [`link`](Self::link) of the edge in two slots of a tetrahedron, which may be a ghost. Returns whether it is a ring.
    pub(crate) fn link_of(&self, t: u32, i: usize, j: usize, link: &mut Vec<u32>) -> bool {
        link.clear();
        for (t, k, _) in self.topology.around_edge(t, i, j) {
            link.push(self.topology.tet(t).v[k]);
        }
        match link.iter().position(|&v| v == GHOST) {
            None => true,
            Some(ghost) => {
                link.rotate_left(ghost);
                link.remove(0);
                false
            }
        }
    }

    /// A tetrahedron to start a walk from, near `hint` if that is a vertex.
    pub(crate) fn start(&self, hint: Option<u32>) -> u32 {
        match hint.and_then(|v| self.topology.vertex_tet.get(v as usize)) {
            Some(&t) if t != NONE => t,
            _ => self.last,
        }
    }
}
