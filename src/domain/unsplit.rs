//! The boundary when vertices on it are taken away again, or moved: subsegments are joined, a facet's triangles around the vertices give
//! way to the Delaunay triangles of the rest.
//!
//! It is the reverse of [`split`](super::split), and, as there, the planar triangulations go first: they say what subfacets there would be, the
//! triangulation in space has to agree, and otherwise everything is [undone](Boundary::undo).

use glam::DVec3;

use super::acute::Carrier;
use super::boundary::{edge_key, face_key, places, Boundary, ON_FACET};
use super::elements::Subsegments;
use super::facet::{FacetChange, InSpace};
use crate::triangulation::topology::{tet_of, GHOST};
use crate::triangulation::Triangulation;
use crate::{Control, Error};

/// What the boundary would be without some vertices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Unsplit {
    /// Facets that change, and how.
    pub facets: Vec<(u32, FacetChange)>,
    /// Subsegments that go.
    gone: Vec<[u32; 2]>,
    /// Subsegments that come, with their segment.
    pub joined: Vec<([u32; 2], u32)>,
}

/// How to take a change of the boundary back.
#[derive(Clone, Debug, Default)]
pub(crate) struct Journal {
    planar: Vec<(u32, FacetChange)>,
    gone: Vec<([u32; 2], u32)>,
    come: Vec<[u32; 2]>,
    new: Option<(u32, u8, Carrier)>,
}

impl Journal {
    /// Subfacets that the change makes and leaves there.
    pub fn created(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.planar.iter().enumerate().flat_map(move |(i, (facet, change))| {
            let later = &self.planar[i + 1..];
            let is_gone = move |face: [u32; 3]| {
                let gone = |(f, change): &(u32, FacetChange)| {
                    f == facet && change.removed.iter().any(|&r| face_key(r) == face_key(face))
                };
                later.iter().any(gone)
            };
            change.created.iter().copied().filter(move |&face| !is_gone(face))
        })
    }

    /// Subsegments that the change makes.
    pub fn joined(&self) -> &[[u32; 2]] {
        &self.come
    }
}

impl Boundary {
    /// The facets that a carrier lies in.
    pub(crate) fn facets_at<'a>(&'a self, carrier: &'a Carrier) -> &'a [u32] {
        match carrier {
            Carrier::Free | Carrier::Vertex(_) => &[],
            Carrier::Segment(s) => &self.segments[*s as usize].facets,
            Carrier::Facet(f) => std::slice::from_ref(f),
        }
    }

    /// What the boundary would be without these vertices, `None` when it can't be. `stars` has all tetrahedra at those that lie on the boundary, each once,
    /// and others perhaps.
    pub(crate) fn without(
        &self,
        t: &Triangulation,
        remove: &[u32],
        stars: impl Iterator<Item = u32> + Clone,
    ) -> Option<Unsplit> {
        let mut plan = Unsplit::default();
        let mut facets: Vec<u32> = Vec::new();
        let mut walls: Vec<(u32, [u32; 3])> = Vec::new();
        for &v in remove {
            let carrier = self.carrier(v);
            if self.kind(v) == 0 {
                continue;
            }
            let of_carrier = self.facets_at(&carrier);
            facets.extend_from_slice(of_carrier);
            let star = stars.clone().filter(|&id| t.topology.tet(id).v.contains(&v));
            for id in star.clone() {
                let tet = t.topology.tet(id);
                // Each face is looked at from one side.
                let here = |&slot: &usize| tet.v[slot] != v && tet_of(tet.n[slot]) > id;
                for face in places(self.possible_walls(tet.v)).filter(here).map(|slot| tet.face(slot)) {
                    let Some(facet) = self.wall(face) else { continue };
                    // Where rounding has brought two facets together, a vertex may be one of a facet that its carrier is not on.
                    if !of_carrier.contains(&facet) {
                        return None;
                    }
                    walls.push((facet, face_key(face)));
                }
            }
            match carrier {
                Carrier::Segment(segment) => self.join_at(t, (v, star), segment, &mut plan)?,
                Carrier::Facet(_) => {}
                Carrier::Vertex(_) | Carrier::Free => return None,
            }
        }
        // Two vertices that go may both have it.
        walls.sort_unstable();
        walls.dedup();
        facets.sort_unstable();
        facets.dedup();
        let joined: Vec<[u32; 2]> = plan.joined.iter().map(|&(edge, _)| edge).collect();
        let fixed = |edge: [u32; 2]| self.subsegments.contains_key(&edge_key(edge));
        for facet in facets {
            let on_it: Vec<u32> =
                remove.iter().copied().filter(|&v| self.facets_at(&self.carrier(v)).contains(&facet)).collect();
            let at_them = walls.iter().filter(|wall| wall.0 == facet).map(|wall| wall.1);
            let change = self.facets[facet as usize].without(&on_it, at_them, &joined, t.points(), fixed)?;
            plan.facets.push((facet, change));
        }
        Some(plan)
    }

    /// Joins the two subsegments at `v`.
    fn join_at(
        &self,
        t: &Triangulation,
        (v, star): (u32, impl Iterator<Item = u32>),
        segment: u32,
        plan: &mut Unsplit,
    ) -> Option<()> {
        let mut ends: Vec<u32> = Vec::new();
        plan.joined.retain(|&(edge, of)| {
            let at_v = of == segment && edge.contains(&v);
            if at_v {
                ends.push(if edge[0] == v { edge[1] } else { edge[0] });
            }
            !at_v
        });
        let partners = self.subsegments.partners(v);
        let may_end =
            |&w: &u32| w != v && w != GHOST && Subsegments::may_hold(v, partners, w, self.subsegments.partners(w));
        let mut others: Vec<u32> = star.flat_map(|tet| t.topology.tet(tet).v).filter(may_end).collect();
        others.sort_unstable();
        others.dedup();
        for w in others {
            let edge = edge_key([v, w]);
            if plan.gone.contains(&edge) {
                continue;
            }
            match self.subsegments.get(&edge) {
                Some(&of) if of == segment => {
                    plan.gone.push(edge);
                    ends.push(w);
                }
                Some(_) => return None,
                None => {}
            }
        }
        let [a, b] = ends[..] else { return None };
        let joined = edge_key([a, b]);
        if a == b || self.subsegments.contains_key(&joined) {
            return None;
        }
        plan.joined.push((joined, segment));
        Some(())
    }

    /// Makes a planned change, and puts the vertex `new` at `p` on its carrier if it has one. The triangulation in space is still the old
    /// one. `None`, with nothing changed, when the planar triangulations refuse.
    pub(crate) fn unsplit(
        &mut self,
        t: &mut Triangulation,
        plan: &Unsplit,
        add: Option<(u32, DVec3, Carrier)>,
    ) -> Option<Journal> {
        let mut journal = Journal::default();
        for &edge in &plan.gone {
            // Joined twice, an edge between two vertices that both go was never there.
            if let Some(segment) = self.subsegments.remove(&edge) {
                journal.gone.push((edge, segment));
            }
        }
        for &(edge, segment) in &plan.joined {
            self.subsegments.insert(edge, segment);
            journal.come.push(edge);
        }
        for (facet, change) in &plan.facets {
            if self.covers_another(*facet, change) {
                self.undo(journal);
                return None;
            }
            self.exchange(*facet, change);
            journal.planar.push((*facet, change.clone()));
        }
        let Some((new, p, carrier)) = add else { return Some(journal) };
        journal.new = Some((new, self.kind(new), self.carrier(new)));
        self.unmark(new);
        let fits = match carrier {
            Carrier::Free => true,
            Carrier::Vertex(_) => false,
            Carrier::Segment(segment) => self.put_on_segment(t, plan, segment, new, p, &mut journal),
            Carrier::Facet(facet) => self.put_on_facet(t, plan, facet, new, p, &mut journal),
        };
        if fits {
            return Some(journal);
        }
        self.undo(journal);
        None
    }

    fn put_on_segment(
        &mut self,
        t: &mut Triangulation,
        plan: &Unsplit,
        segment: u32,
        new: u32,
        p: DVec3,
        journal: &mut Journal,
    ) -> bool {
        let between = |&&([a, b], of): &&([u32; 2], u32)| {
            of == segment && crate::geometry::encroachment::encroaches_segment([t.at(a), t.at(b)], p)
        };
        let Some(&(edge, _)) = plan.joined.iter().find(between) else { return false };
        for facet in self.segments[segment as usize].facets.clone() {
            let subsegments = &self.subsegments;
            let fixed = |e: [u32; 2]| subsegments.contains_key(&edge_key(e));
            let planar = &mut self.facets[facet as usize];
            let start: Vec<[u32; 3]> = planar.at_edge(edge).collect();
            if start.is_empty() {
                return false;
            }
            let change = t.with_point(new, p, |t| {
                planar.insert(new, &start, Some(edge), t.points(), fixed, |_| InSpace::Missing)
            });
            if !change.is_some_and(|change| self.take_over(facet, change, journal)) {
                return false;
            }
        }
        self.subsegments.remove(&edge);
        journal.gone.push((edge, segment));
        for part in edge.map(|end| edge_key([end, new])) {
            self.subsegments.insert(part, segment);
            journal.come.push(part);
        }
        // What was joined only to be split again is no part of the result.
        journal.come.retain(|&come| come != edge);
        journal.gone.retain(|&(gone, _)| gone != edge);
        self.put_on(new, segment);
        if !self.segments[segment as usize].facets.is_empty() {
            self.mark(new, ON_FACET);
        }
        true
    }

    fn put_on_facet(
        &mut self,
        t: &mut Triangulation,
        plan: &Unsplit,
        facet: u32,
        new: u32,
        p: DVec3,
        journal: &mut Journal,
    ) -> bool {
        let Some((_, before)) = plan.facets.iter().find(|(f, _)| *f == facet) else { return false };
        let subsegments = &self.subsegments;
        let fixed = |e: [u32; 2]| subsegments.contains_key(&edge_key(e));
        let planar = &mut self.facets[facet as usize];
        let Some(start) = before.created.iter().copied().find(|&face| planar.holds(face, p, t.points())) else {
            return false;
        };
        let change =
            t.with_point(new, p, |t| planar.insert(new, &[start], None, t.points(), fixed, |_| InSpace::Missing));
        if !change.is_some_and(|change| self.take_over(facet, change, journal)) {
            return false;
        }
        self.mark(new, ON_FACET);
        self.carry(new, Carrier::Facet(facet));
        true
    }

    /// The planar triangulation has changed already: the rest. False, with the planar triangulation as it was, where a subfacet would lie on another facet's.
    fn take_over(&mut self, facet: u32, change: FacetChange, journal: &mut Journal) -> bool {
        if self.covers_another(facet, &change) {
            self.facets[facet as usize].exchange(&change.reversed());
            return false;
        }
        self.exchange_faces(facet, &change);
        journal.planar.push((facet, change));
        true
    }

    pub(super) fn exchange(&mut self, facet: u32, change: &FacetChange) {
        self.facets[facet as usize].exchange(change);
        self.exchange_faces(facet, change);
    }

    fn exchange_faces(&mut self, facet: u32, change: &FacetChange) {
        for &face in &change.removed {
            self.subfacets.remove(&face_key(face));
        }
        for &face in &change.created {
            self.subfacets.insert(face_key(face), facet);
        }
    }

    /// Gives the vertices new ids, `u32::MAX` for those that are gone.
    ///
    /// Half of it may be done when the control says stop.
    pub(crate) fn renumber(&mut self, new_id: &[u32], control: &Control) -> Result<(), Error> {
        let turns = control.turns();
        let renamed = |v: u32| new_id.get(v as usize).copied().unwrap_or(v);
        let gone = |v: &u32| renamed(*v) == u32::MAX;
        let (kinds, carriers) = (std::mem::take(&mut self.kinds), std::mem::take(&mut self.carriers));
        for (v, kind) in kinds.into_iter().enumerate().filter(|&(v, kind)| kind != 0 && !gone(&(v as u32))) {
            turns.check()?;
            self.mark(renamed(v as u32), kind);
        }
        for (v, carrier) in carriers.into_iter().enumerate().filter(|&(v, _)| !gone(&(v as u32))) {
            turns.check()?;
            let carrier = match carrier {
                Carrier::Vertex(v) => Carrier::Vertex(renamed(v)),
                other => other,
            };
            self.carry(renamed(v as u32), carrier);
        }
        for segment in &mut self.segments {
            turns.check()?;
            segment.ends = segment.ends.map(renamed);
        }
        for facet in &mut self.facets {
            facet.renumber(renamed, control)?;
        }
        let edge =
            |edge: [u32; 2]| Some(edge).filter(|edge| !edge.iter().any(gone)).map(|edge| edge_key(edge.map(renamed)));
        let face =
            |face: [u32; 3]| Some(face).filter(|face| !face.iter().any(gone)).map(|face| face_key(face.map(renamed)));
        self.subsegments.renumber(renamed, control)?;
        self.subfacets.renumber(renamed, control)?;
        // What waits has no elements that are gone left.
        let (segments, facets) = (&mut self.pending_segments, &mut self.pending_facets);
        segments.retain_mut(|(key, _)| turns.go_on() && edge(*key).map(|new| *key = new).is_some());
        facets.retain_mut(|(key, _)| turns.go_on() && face(*key).map(|new| *key = new).is_some());
        turns.end()?;
        self.blocked.rekey(control, edge, face)
    }

    /// Takes a change of the boundary back.
    pub(crate) fn undo(&mut self, journal: Journal) {
        for (facet, change) in journal.planar.into_iter().rev() {
            self.exchange(facet, &change.reversed());
        }
        for edge in journal.come {
            self.subsegments.remove(&edge);
        }
        for (edge, segment) in journal.gone {
            self.subsegments.insert(edge, segment);
        }
        if let Some((new, kind, carrier)) = journal.new {
            self.unmark(new);
            if kind != 0 {
                self.mark(new, kind);
            }
            self.carry(new, carrier);
        }
    }
}
