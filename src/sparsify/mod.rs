//! Fewer Steiner points: takes one away, or puts one in the place of two neighbours, wherever all tetrahedra that come keep the bound.
//!
//! | module | idea |
//! |---|---|
//! | `forecast` | what a replacement would create, foreseen in floating point |
//! | `search` | which vertices to replace, and the place of the one that comes |
//! | `change` | the replacement looked at exactly, then made or dropped |
//! | `pass` | all Steiner points, on several threads |
//!
//! It works twice, or, at the level of [`Moves`](Sparsify::Moves), only the first time: then nothing is taken away from what stands, the rule only decides at the
//! insertion of a sample that a point moves in its stead. *While refining*, before a sample is inserted, a vertex near it is looked for that can be moved to where it stands for both.
//! What splits a segment or facet is inserted first, for what follows from it must be seen, and then made one with a neighbour if that can be; so is a sample with one
//! on the boundary. Where facets have many vertices near them, a fifth of the splits come to nothing more than that.
//! Tetrahedra whose shortest edge is longer than the one being mended may still be bad then: the refinement comes to them later, with fewer vertices
//! in its way. This is worth far more than the same work on the finished mesh, where everything around a vertex has been fitted to it. *Afterwards*, or on any mesh, a queue of
//! all Steiner points is worked off in which each change brings its neighbourhood back, until nothing changes any more; there nothing
//! bad may come at all.
//!
//! Segments and facets stay covered by edges and faces. The last pass may leave some encroached, as the refinement with this rule does, which needs no split where all tetrahedra
//! are good; a later refinement splits them if it has to.
//!
//! A merge keeps its vertex in the ball of what was split, so that the split is not undone, and lets no tetrahedron with an edge up to the one in hand be bad; where
//! few succeed, few are tried (`Odds`).
//!
//! Refinement still ends. A change while refining makes no tetrahedron bad whose shortest edge is at most `LEAD` times the edge `l` being
//! mended, and, unless it is a merge, begins at a sample that is farther than that from all vertices, as samples are but for β near 1. So no bad edge up to
//! `LEAD·l` comes back or is made new, each step takes something off those there are, and `l` grows past any length. Splits of the boundary, or β < 1, may make
//! edges shorter than `l` again; for these, and for merges, the number of changes is bounded by that of vertices (`CHANGES`), and after that it is a plain refinement.

pub(crate) mod change;
pub(crate) mod forecast;
mod pass;
pub(crate) mod search;

use crate::domain::Boundary;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::flush_tiny;
use crate::triangulation::cavity::Cavity;
use crate::triangulation::remove::Hole;
use crate::triangulation::topology::GHOST;
use crate::triangulation::Triangulation;
use crate::{Control, DVec3, Error};
use forecast::Demand;
use search::{Partners, Searcher};

/// How hard to try to do with fewer Steiner points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sparsify {
    /// The sampler alone: Steiner points stay where they are put.
    Off,
    /// Nothing is taken away from what stands. But instead of inserting a sample one of two Steiner points near it, those with most room, is moved where one place
    /// serves both, if that is found at next to no cost; and a point that splits a segment or facet is made one with a neighbour.
    Moves,
    /// What is found at little cost: most of what can be had, in two to four times the time without.
    #[default]
    Quick,
    /// Less likely pairs, more places for each, and a last pass over all Steiner points: three to five times the time again, for about an eighth fewer.
    Thorough,
}

/// What the levels of [`Sparsify`] mean. The limits were found by looking at what of all that was tried came to something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Effort {
    /// Neighbours that are tried.
    pub neighbours: usize,
    /// Whether those come first that have most room around them, not the nearest ones. Where few are tried, they come to something more often.
    pub widest: bool,
    /// Obstacles of `v` alone that may be left when a neighbour goes with it.
    pub remaining: usize,
    /// Obstacles of a sample alone, or of a vertex to be merged, that are worth a try.
    pub alone: usize,
    /// Obstacles of a pair, and in the last pass those of the vertex alone: with more a partner is hardly ever found.
    pub obstacles: usize,
    /// A place is worth a search when no tetrahedron there has (R/βl)² above this.
    pub cap: f64,
    /// Places that are tried.
    pub places: usize,
    /// While refining, a neighbour that has another one nearer than this times the edge in hand stays where it is: it belongs to something finer.
    pub spacing: f64,
    /// How far a partner may be, in β times the length of the edge being mended.
    pub reach: f64,
    /// While refining, how often the vertex of one change may go into the next at once.
    pub cascade: usize,
    /// Whether the last pass begins with all Steiner points, not only with those on the boundary.
    pub all: bool,
    /// Whether the last pass tries every pair on the boundary, even where few come to something.
    pub patient: bool,
}

impl Sparsify {
    /// Whether a pass over Steiner points that stand already belongs to it.
    pub fn has_pass(self) -> bool {
        !matches!(self, Sparsify::Off | Sparsify::Moves)
    }
}

impl Effort {
    fn of(level: Sparsify) -> Effort {
        match level {
            Sparsify::Off | Sparsify::Moves => Effort {
                neighbours: 2,
                widest: true,
                remaining: 0,
                alone: 2,
                obstacles: 8,
                cap: 1.8,
                places: 3,
                spacing: 1.1,
                reach: 1.2,
                cascade: 0,
                all: false,
                patient: false,
            },
            Sparsify::Quick => Effort {
                neighbours: 3,
                widest: true,
                remaining: 0,
                alone: usize::MAX,
                obstacles: 8,
                cap: 2.5,
                places: 10,
                spacing: 0.9,
                reach: 1.75,
                cascade: 0,
                all: false,
                patient: false,
            },
            Sparsify::Thorough => Effort {
                neighbours: 8,
                widest: false,
                remaining: 3,
                alone: usize::MAX,
                obstacles: 20,
                cap: 5.0,
                places: 32,
                spacing: 0.0,
                reach: 1.75,
                cascade: 3,
                all: true,
                patient: true,
            },
        }
    }

    /// For a vertex that has come on the boundary, or beside it: they are few, and one of five finds a partner.
    fn at_boundary(self) -> Effort {
        Effort {
            neighbours: self.neighbours.max(4),
            places: self.places.max(6),
            spacing: self.spacing.min(0.9),
            ..self
        }
    }
}

impl Default for Effort {
    fn default() -> Self {
        Effort::of(Sparsify::default())
    }
}

/// Tetrahedra with shortest edges of this times the edge being mended may be left bad for later.
const LEAD: f64 = 1.01;
/// While refining at most this many changes are made for each vertex that there ever was at a time. One or two is usual.
const CHANGES: usize = 8;

/// A point that is to be inserted, and what is around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<'a> {
    pub p: DVec3,
    pub cavity: &'a Cavity,
    /// The vertices around the cavity and their squared distances; some may be missing where there are very many.
    pub rim: &'a [(u32, f64)],
    /// The distance from the nearest of them.
    pub clearance: f64,
}

/// What is to be done without, and how hard that is tried.
#[derive(Clone, Copy, Debug, Default)]
struct Scope {
    effort: Effort,
    radius_edge: f64,
    /// Vertices below are the caller's.
    first: u32,
}

impl Scope {
    /// Whether a vertex may be taken away: a Steiner point, but none on a boundary that is to be kept.
    fn may_go(&self, t: &Triangulation, boundary: &Boundary, v: u32) -> bool {
        v != GHOST && v >= self.first && t.is_vertex(v) && !(boundary.kept && boundary.kind(v) != 0)
    }

    fn demand(&self, level: f64) -> Demand {
        Demand { bound2: self.radius_edge * self.radius_edge, level2: level * level }
    }

    /// How far a partner may be while refining.
    fn reach(&self, demand: Demand) -> f64 {
        self.effort.reach * self.radius_edge * demand.level2.sqrt()
    }
}

/// The sparsifier and its memory.
#[derive(Debug, Default)]
pub(crate) struct Sparsifier {
    searcher: Searcher,
    /// Whether there is a last pass.
    pass: bool,
    min_edge: f64,
    pub hole: Hole,
    /// The vertex that the last replacement added.
    newest: u32,
    /// How merges after samples, and after splits, have come out.
    odds: [Odds; 2],
    /// What the last pass begins with, if one has been stopped, and what it has left when it is stopped again. Without it, it begins anew.
    pub waiting: Option<Vec<u32>>,
    /// Vertices taken away and not replaced.
    pub removed: usize,
    /// Vertices that came in the place of two.
    pub replaced: usize,
}

impl Sparsifier {
    /// For Steiner points from id `first` on.
    pub fn new(level: Sparsify, radius_edge: f64, min_edge: f64, first: u32) -> Sparsifier {
        let searcher = Searcher::new(Scope { effort: Effort::of(level), radius_edge, first });
        Sparsifier { searcher, pass: level.has_pass(), min_edge, ..Sparsifier::default() }
    }

    /// Whether a last pass follows the refinement.
    pub fn has_pass(&self) -> bool {
        self.pass
    }

    /// Lets the last pass begin with all Steiner points.
    pub fn begin_with_all(&mut self) {
        self.searcher.scope.effort.all = true;
    }

    /// Tries to do without a sample while an edge of length `edge` is being mended: instead of it a vertex is moved. Returns whether it did, and adds
    /// what is new then to `created`.
    pub fn instead_of(
        &mut self,
        t: &mut Triangulation,
        boundary: &mut Boundary,
        sample: Sample<'_>,
        edge: f64,
        created: &mut Vec<u32>,
    ) -> Result<bool, Error> {
        let budget = CHANGES * t.vertex_slots();
        if sample.clearance <= LEAD * edge || self.removed + self.replaced >= budget {
            return Ok(false);
        }
        let demand = self.searcher.scope.demand(LEAD * edge);
        let Some(found) = self.searcher.search_instead(t, boundary, sample, demand) else { return Ok(false) };
        if !self.make(t, boundary, &found, demand)? {
            return Ok(false);
        }
        created.extend_from_slice(&self.hole.created);
        // What has come may stand for another neighbour, too.
        for _ in 0..self.searcher.scope.effort.cascade {
            let Some(found) = self.searcher.search(t, boundary, self.newest, Partners::Free, demand) else { break };
            if !self.make(t, boundary, &found, demand)? {
                break;
            }
            created.extend_from_slice(&self.hole.created);
            if found.add.is_none() {
                break;
            }
        }
        Ok(true)
    }

    /// Whether the second of two neighbours is near enough to be the first one's partner while an edge of length `edge` is being mended.
    pub fn may_merge(&self, t: &Triangulation, boundary: &Boundary, [v, w]: [u32; 2], edge: f64) -> bool {
        let scope = self.searcher.scope;
        scope.may_go(t, boundary, w) && t.at(v).distance(t.at(w)) <= scope.reach(scope.demand(LEAD * edge))
    }

    /// Tries to put one vertex in the place of the new one `v` and a neighbour, at least one of them on the boundary, while an edge of length `edge` is being
    /// mended. What `v` has split must not come back: the place has to be in its ball, too. Returns whether it did, and adds what is new then to `created`.
    pub fn merge(
        &mut self,
        t: &mut Triangulation,
        boundary: &mut Boundary,
        (v, split): (u32, Option<&[DVec3]>),
        edge: f64,
        created: &mut Vec<u32>,
    ) -> Result<bool, Error> {
        let odds = usize::from(split.is_some());
        if self.removed + self.replaced >= CHANGES * t.vertex_slots() || !self.odds[odds].are_good() {
            return Ok(false);
        }
        let demand = self.searcher.scope.demand(LEAD * edge);
        let partners = if split.is_some() { Partners::All } else { Partners::OnBoundary };
        let Some(found) = self.searcher.search(t, boundary, v, partners, demand) else { return Ok(false) };
        let Some((place, _)) = found.add else { return Ok(false) };
        let place = flush_tiny(place);
        let splits = match *split.unwrap_or_default() {
            [a, b] => encroaches_segment([a, b], place),
            [a, b, c] => encroaches_facet([a, b, c], place),
            _ => true,
        };
        if !splits || !self.make(t, boundary, &found, demand)? {
            return Ok(false);
        }
        self.odds[odds].made += 1;
        created.extend_from_slice(&self.hole.created);
        Ok(true)
    }

    /// Makes its lists as long as the triangulation has room, in pieces.
    pub fn grow_for(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        self.searcher.grow_for(t, control)?;
        self.hole.grow_for_additions(t, control)
    }

    /// Gives its memory back.
    pub fn give_back(self, control: &Control) {
        control.give_back(self.hole);
    }
}

/// How often something has been tried, and has come to something.
#[derive(Clone, Copy, Debug, Default)]
struct Odds {
    turns: usize,
    tried: usize,
    made: usize,
}

impl Odds {
    const FIRST: usize = 100;
    const RARE: usize = 16;
    const SOME: usize = 12;

    /// Whether it is worth a try. Where fewer than one of [`RARE`](Self::RARE) have come to something, one of [`SOME`](Self::SOME) is, to see whether it still is so.
    fn are_good(&mut self) -> bool {
        self.turns += 1;
        let rare = self.tried >= Self::FIRST && Self::RARE * self.made < self.tried;
        let worth = !rare || self.turns % Self::SOME == 0;
        self.tried += usize::from(worth);
        worth
    }

    /// What has come since.
    fn since(self, before: Odds) -> Odds {
        Odds { turns: self.turns - before.turns, tried: self.tried - before.tried, made: self.made - before.made }
    }

    /// With what has come elsewhere.
    fn and(self, more: Odds) -> Odds {
        Odds { turns: self.turns + more.turns, tried: self.tried + more.tried, made: self.made + more.made }
    }
}

#[cfg(test)]
mod tests;
