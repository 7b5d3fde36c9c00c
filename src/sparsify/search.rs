//! Which vertices to replace by which point: found by forecasts alone.
//!
//! With `v` gone, some tetrahedra of what fills its star are bad: the *obstacles*. (Of a sample that is not inserted yet, they are the bad ones in its
//! cavity.) A point that shall stand in for `v` has to lie in the circumballs of all of them. So have those that stand for `v` and a neighbour `w`
//! together, in the balls of the obstacles that don't end at `w`: few of those, and near `w`, make a promising pair. Neighbours with most room around them
//! come to something most often: while refining, three tries of four where all edges at `w` are 1.7 times as long as the one in hand, one of four where
//! one is as short.
//!
//! For such a pair the place is looked for from a point in all balls of its own obstacles. Each try says where the point would have to go to be better:
//! against the gradient of R²/l² of the worst tetrahedron, or towards the ball that it missed. A step that makes something else worse is tried again,
//! shorter, between the two directions: what is minimized is a maximum, and its least values lie where several tetrahedra are equally bad (the idea of
//! bundle methods; C. Lemaréchal, "An extension of Davidon methods to non differentiable problems", Mathematical Programming Study 3, 1975).
//!
//! A vertex on a segment stands in for one on a facet beside it or a free one, a vertex on a facet for a free one; the place then is on
//! that segment or facet.

use super::forecast::{Forecast, Space};
use super::{Demand, Effort, Odds, Sample, Scope};
use crate::domain::{Boundary, Carrier, Unsplit};
use crate::geometry::flush_tiny;
use crate::triangulation::remove::Guess;
use crate::triangulation::Triangulation;
use crate::{Control, DVec3, Error};

/// A replacement that looks good.
#[derive(Clone, Debug)]
pub struct Found {
    /// The vertices that go.
    pub remove: Vec<u32>,
    /// Where one comes, and what it lies on.
    pub add: Option<(DVec3, Carrier)>,
    /// What becomes of the boundary without the vertices.
    pub plan: Unsplit,
    /// What goes and what comes in full, if it has been foreseen.
    pub guess: Option<Guess>,
}

/// Which vertices may be partners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Partners {
    All,
    /// Those on no segment or facet.
    Free,
    OnBoundary,
}

impl Partners {
    fn contain(self, is_free: bool) -> bool {
        self == Partners::All || is_free == (self == Partners::Free)
    }
}

/// A vertex that may be the partner.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    v: u32,
    distance: f64,
    /// To its nearest neighbour within the hole of what the partner is for.
    spacing: f64,
}

/// What a partner is looked for.
#[derive(Clone, Copy, Debug)]
enum Subject {
    /// A vertex.
    Vertex(u32),
    /// A point in the interior that is not inserted yet.
    Sample(DVec3),
}

impl Subject {
    fn position(self, t: &Triangulation) -> DVec3 {
        match self {
            Subject::Vertex(v) => t.at(v),
            Subject::Sample(p) => p,
        }
    }
}

/// What searches, and its memory.
#[derive(Debug, Default)]
pub(super) struct Searcher {
    pub scope: Scope,
    alone: Forecast,
    pair: Forecast,
    near: Vec<Candidate>,
    /// How pairs of vertices that are both on the boundary have come out in the last pass.
    pub pass_odds: Odds,
}

impl Searcher {
    pub fn new(scope: Scope) -> Searcher {
        Searcher { scope, ..Searcher::default() }
    }

    /// Makes its lists as long as the triangulation has room, in pieces.
    pub fn grow_for(&mut self, t: &Triangulation, control: &Control) -> Result<(), Error> {
        self.alone.grow_for(t, control)?;
        self.pair.grow_for(t, control)
    }

    /// Looks for something to do at `v`.
    pub fn search(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        v: u32,
        partners: Partners,
        demand: Demand,
    ) -> Option<Found> {
        let while_refining = demand.level2.is_finite();
        if !self.scope.may_go(t, boundary, v) || !self.alone.open(t, &[v]) {
            return None;
        }
        let limit = if while_refining {
            self.scope.reach(demand)
        } else {
            2.0 * self.scope.effort.reach * self.scope.radius_edge * spacing(t, self.alone.going(), v)
        };
        self.near.clear();
        for i in 0..self.alone.going().len() {
            for w in t.topology.tet(self.alone.going()[i]).v {
                if w != v {
                    self.consider(t, boundary, (w, t.at(w).distance_squared(t.at(v))), limit, partners);
                }
            }
        }
        // Of a new vertex nothing is gained by taking it away again: it needs a partner.
        if self.near.is_empty() && while_refining {
            return None;
        }
        let plan = boundary.without(t, &[v], self.alone.stars())?;
        let most = if while_refining { self.scope.effort.alone } else { self.scope.effort.obstacles };
        if !self.alone.fill(t, boundary, &[v], &plan, demand, most) {
            return None;
        }
        if self.alone.obstacles.is_empty() {
            return Some(Found { remove: vec![v], add: None, plan, guess: None });
        }
        self.find_partner(t, boundary, Subject::Vertex(v), demand)
    }

    /// Looks for a vertex that can be moved so that it does what the sample would do.
    pub fn search_instead(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        Sample { p, cavity, rim, .. }: Sample<'_>,
        demand: Demand,
    ) -> Option<Found> {
        if Forecast::is_too_large(cavity) {
            return None;
        }
        let limit = self.scope.reach(demand);
        self.near.clear();
        for &near in rim {
            self.consider(t, boundary, near, limit, Partners::Free);
        }
        if self.near.is_empty() || !self.alone.take_cavity(t, boundary, (p, cavity), demand, self.scope.effort.alone) {
            return None;
        }
        self.find_partner(t, boundary, Subject::Sample(p), demand)
    }

    /// Puts a vertex at this squared distance among the neighbours that are worth a try if it is, once.
    fn consider(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        (w, distance2): (u32, f64),
        limit: f64,
        partners: Partners,
    ) {
        if distance2 <= limit * limit
            && self.scope.may_go(t, boundary, w)
            && partners.contain(boundary.kind(w) == 0)
            && !self.near.iter().any(|n| n.v == w)
        {
            self.near.push(Candidate { v: w, distance: distance2.sqrt(), spacing: 0.0 });
        }
    }

    /// Tries the neighbours of what `alone` is about.
    fn find_partner(
        &mut self,
        t: &Triangulation,
        boundary: &Boundary,
        subject: Subject,
        demand: Demand,
    ) -> Option<Found> {
        let effort = match subject {
            Subject::Vertex(_) if demand.level2.is_finite() => self.scope.effort.at_boundary(),
            Subject::Vertex(_) | Subject::Sample(_) => self.scope.effort,
        };
        let Effort { neighbours, widest, remaining, obstacles, cap, places, spacing, patient, .. } = effort;
        let level = demand.level2.sqrt();
        let spacing = if level.is_finite() { spacing * level } else { 0.0 };
        let Searcher { alone, pair, near, pass_odds, .. } = self;
        let p = subject.position(t);
        let is_on_boundary = matches!(subject, Subject::Vertex(v) if boundary.kind(v) != 0);
        near.retain_mut(|candidate| {
            let Some(number) = alone.number_in_hole(candidate.v) else { return false };
            let misses = |&&i: &&u32| !alone.filling[i as usize].v.contains(&number);
            if alone.obstacles.iter().filter(misses).count() > remaining {
                return false;
            }
            candidate.spacing = alone.spacing(number);
            candidate.spacing >= spacing
        });
        let rank = |c: &Candidate| if widest { -c.spacing } else { c.distance };
        near.sort_unstable_by(|a, b| rank(a).total_cmp(&rank(b)).then(a.v.cmp(&b.v)));
        near.truncate(neighbours);
        for &Candidate { v: w, distance, .. } in near.iter() {
            let (lower, space) = match subject {
                Subject::Vertex(v) => match shared_space(t, boundary, v, w) {
                    Some(shared) => shared,
                    None => continue,
                },
                Subject::Sample(_) => (w, Space::ALL),
            };
            let carrier = boundary.carrier(lower);
            let q = t.at(w);
            let number = alone.number_in_hole(w)?;
            let base = t.at(lower);
            let mut place = base + space.along(0.5 * p + 0.5 * q - base);
            if !alone.move_into_obstacles(&mut place, &space, |tet| !tet.v.contains(&number)) {
                continue;
            }
            let on_boundary = [is_on_boundary, boundary.kind(w) != 0];
            // What becomes of the boundary takes longest to find: first whether it is worth it, and whether a star is too large.
            let hesitates = !patient && level.is_infinite() && on_boundary == [true; 2];
            if hesitates && !pass_odds.are_good() {
                continue;
            }
            let remove = match subject {
                Subject::Vertex(v) => vec![v, w],
                Subject::Sample(_) => vec![w],
            };
            let all_free = on_boundary == [false; 2];
            if !all_free && !pair.open(t, &remove) {
                continue;
            }
            let Some(plan) = boundary.without(t, &remove, pair.stars()) else { continue };
            let filled = if all_free {
                pair.fill_more(alone, t, boundary, (w, spacing), demand, obstacles)
            } else {
                pair.fill(t, boundary, &remove, &plan, demand, obstacles)
            };
            if !filled || !pair.move_into_obstacles(&mut place, &space, |_| true) {
                continue;
            }
            let on = boundary.facets_at(&carrier);
            let mut worst = pair.try_point(t, boundary, place, on, demand, cap);
            let (mut step, mut tries, mut direction) = (0.25 * distance, 1, pair.push);
            while tries < places && worst > 1.0 {
                let there = place + space.along(direction) * step;
                let outcome = pair.try_point(t, boundary, there, on, demand, worst.clamp(1.0, cap));
                tries += 1;
                if outcome < worst {
                    worst = outcome;
                    place = there;
                    direction = pair.push;
                } else {
                    direction = (direction + pair.push).normalize_or_zero();
                    step *= 0.6;
                }
            }
            if worst <= 1.0 {
                pass_odds.made += usize::from(hesitates);
                let is_foreseen = all_free && pair.foresee(t, boundary, flush_tiny(place));
                let guess = is_foreseen.then(|| std::mem::take(&mut pair.guess));
                return Some(Found { remove, add: Some((place, carrier)), plan, guess });
            }
        }
        None
    }
}

/// The distance from a vertex to the nearest of its neighbours.
fn spacing(t: &Triangulation, star: &[u32], v: u32) -> f64 {
    let others = star.iter().flat_map(|&id| t.topology.tet(id).v).filter(|&w| w != v);
    others.map(|w| t.at(w).distance_squared(t.at(v))).fold(f64::INFINITY, f64::min).sqrt()
}

/// Of two vertices the one on the lower boundary element, and where a point may go that stands for both. `None` when neither element holds the
/// other.
fn shared_space(t: &Triangulation, boundary: &Boundary, v: u32, w: u32) -> Option<(u32, Space)> {
    let carriers = [boundary.carrier(v), boundary.carrier(w)];
    let holds = |outer: Carrier, inner: Carrier| match (outer, inner) {
        (Carrier::Free, _) => true,
        (Carrier::Facet(f), Carrier::Segment(s)) => boundary.segments()[s as usize].facets.contains(&f),
        _ => outer == inner,
    };
    let lower = if holds(carriers[0], carriers[1]) {
        w
    } else if holds(carriers[1], carriers[0]) {
        v
    } else {
        return None;
    };
    let space = match boundary.carrier(lower) {
        Carrier::Free => Space::ALL,
        Carrier::Segment(s) => {
            let [a, b] = boundary.segments()[s as usize].ends.map(|v| t.at(v));
            Space { axes: [(b - a).normalize_or_zero(), DVec3::ZERO, DVec3::ZERO], dimension: 1 }
        }
        Carrier::Facet(f) => {
            let normal = boundary.facets()[f as usize].normal();
            // Along the axes the point stays exactly in the plane.
            let (e, f) = normal.any_orthonormal_pair();
            Space { axes: [e, f, DVec3::ZERO], dimension: 2 }
        }
        Carrier::Vertex(_) => return None,
    };
    Some((lower, space))
}
