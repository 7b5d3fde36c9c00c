//! Which subsegments and subfacets a point encroaches upon, or would take out of the triangulation.
//!
//! Only elements at the cavity of a point have to be asked. A subsegment `ab` that nothing encroaches has its midpoint in its own Voronoi
//! facet; a point in its diametral ball is nearer to the midpoint, so it cuts the facet, so it conflicts with a
//! tetrahedron around `ab`. The same holds for subfacets, their circumcentres and dual edges. Of elements that vertices encroach upon, which there are near
//! small input angles and while the boundary is refined lazily, those are found that the point would take out, and no others matter.

use super::boundary::{edge_key, face_key, places, Boundary};
use super::elements::Subsegments;
use super::pending::Demand;
use crate::geometry::circumsphere::triangle_circumcenter;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::quality::EDGES;
use crate::sorting::{sort, sort_unique};
use crate::triangulation::cavity::Cavity;
use crate::triangulation::topology::{tet_of, Tetrahedron, GHOST};
use crate::triangulation::Triangulation;
use crate::{memory, Control, DVec3, Error};

/// Boundary elements that a point encroaches upon.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Encroached {
    /// Subsegments, lower vertex first.
    pub segments: Vec<[u32; 2]>,
    /// Subfacets, vertices in order.
    pub facets: Vec<[u32; 3]>,
    /// Subsegments that would go from the triangulation without being encroached. That is so where vertices are left in the balls of
    /// elements: near small input angles, and where the boundary is refined lazily.
    pub lost_segments: Vec<[u32; 2]>,
    /// Subfacets of which the same is true; where it has not been asked yet which of them are encroached, all that would go.
    pub lost_facets: Vec<[u32; 3]>,
    /// Those of the encroached ones that would go.
    going_segments: Vec<[u32; 2]>,
    going_facets: Vec<[u32; 3]>,
    /// Subfacets that would stay, as long as nobody has asked whether they are encroached.
    standing: Vec<[u32; 3]>,
    /// Scratch: the subsegments in the cavity, in order, and whether they stay.
    inner: Vec<[u32; 2]>,
    stay: Vec<bool>,
}

/// The edges that have been looked at last: those of a cavity come several times.
struct Recent([[u32; 2]; 1 << Recent::BITS]);

impl Default for Recent {
    fn default() -> Self {
        Recent([[GHOST; 2]; 1 << Recent::BITS])
    }
}

impl Recent {
    const BITS: u32 = 6;

    /// Notes an edge. False if it is known to have been noted before.
    #[inline(always)]
    fn is_new(&mut self, edge: [u32; 2]) -> bool {
        let [a, b] = edge;
        let place = (a.wrapping_mul(0x9e37_79b1) ^ b.wrapping_mul(0x85eb_ca77)) >> (u32::BITS - Recent::BITS);
        std::mem::replace(&mut self.0[place as usize], edge) != edge
    }
}

impl Encroached {
    /// Whether there are none, and none that may be.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty() && self.facets.is_empty() && self.standing.is_empty() && !self.loses()
    }

    /// Whether some would go though they are not encroached.
    pub fn loses(&self) -> bool {
        !(self.lost_segments.is_empty() && self.lost_facets.is_empty())
    }

    /// The subsegments that would go, encroached or not. No free vertex must take anything out once the boundary has been recovered. It would do so
    /// only near small input angles, or where an element must not be split; elsewhere it would encroach upon the element, and not be inserted.
    pub(crate) fn taken_segments(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.going_segments.iter().chain(&self.lost_segments).copied()
    }

    /// The subfacets that would go, encroached or not.
    pub(crate) fn taken_facets(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.going_facets.iter().chain(&self.lost_facets).copied()
    }

    /// How many there are, those included that may be or would go.
    pub(crate) fn count(&self) -> usize {
        let segments = self.segments.len() + self.lost_segments.len();
        segments + self.facets.len() + self.lost_facets.len() + self.standing.len()
    }

    /// Leaves only those that would not go.
    pub(super) fn keep_standing(&mut self) {
        let Encroached { segments, facets, going_segments, going_facets, .. } = self;
        segments.retain(|edge| going_segments.binary_search(edge).is_err());
        facets.retain(|face| going_facets.binary_search(face).is_err());
    }

    pub(crate) fn clear(&mut self) {
        self.segments.clear();
        self.facets.clear();
        self.lost_segments.clear();
        self.lost_facets.clear();
        self.going_segments.clear();
        self.going_facets.clear();
        self.standing.clear();
    }
}

impl Boundary {
    /// Whether labels tell subfacets: each lies between two labels, and no other face does.
    fn shows_in_labels(&self, t: &Triangulation) -> bool {
        self.parts_labels && !self.misses() && !self.recovering && !t.topology.region.is_empty()
    }

    /// The face of a tetrahedron opposite a slot, if it is a subfacet.
    pub(crate) fn subfacet_at(&self, t: &Triangulation, tet: u32, slot: usize) -> Option<[u32; 3]> {
        if self.shows_in_labels(t) && !t.topology.labels_differ(tet, slot) {
            return None;
        }
        let face = t.topology.tet(tet).face(slot);
        self.is_subfacet(face).then(|| face_key(face))
    }

    /// The edge between two slots of a tetrahedron, if it is a subsegment.
    pub(crate) fn subsegment_at(&self, t: &Triangulation, tet: u32, [i, j]: [usize; 2]) -> Option<[u32; 2]> {
        let v = t.topology.tet(tet).v;
        let may = Subsegments::may_hold(v[i], self.subsegments.partners(v[i]), v[j], self.subsegments.partners(v[j]));
        Some(edge_key([v[i], v[j]])).filter(|key| may && self.subsegments.contains_key(key))
    }

    /// The subsegments and subfacets around a cavity that its point `p` encroaches upon, or that go with the cavity (the same but where
    /// small input angles have left an element encroached). `found` is filled, in order of ids. [`Error::Cancelled`] when the control says stop: then it is
    /// of no use.
    pub(crate) fn encroached_by(
        &self,
        t: &Triangulation,
        p: DVec3,
        cavity: &Cavity,
        found: &mut Encroached,
        control: &Control,
    ) -> Result<(), Error> {
        self.taken_by(t, p, cavity, found, control)?;
        let turns = control.turns();
        let Encroached { facets, lost_facets, going_facets, .. } = found;
        lost_facets.retain(|&face| {
            let is_encroached = turns.go_on() && encroaches_facet(face.map(|v| t.at(v)), p);
            if is_encroached {
                facets.push(face);
                going_facets.push(face);
            }
            !is_encroached
        });
        turns.end()?;
        self.judge_standing(t, p, found, control)
    }

    /// Asks of the subfacets around the cavity that [would stay](Self::taken_by) whether they are encroached.
    pub(crate) fn judge_standing(
        &self,
        t: &Triangulation,
        p: DVec3,
        found: &mut Encroached,
        control: &Control,
    ) -> Result<(), Error> {
        if found.standing.is_empty() {
            return Ok(());
        }
        let turns = control.turns();
        for face in found.standing.drain(..) {
            turns.check()?;
            if encroaches_facet(face.map(|v| t.at(v)), p) {
                found.facets.push(face);
            }
        }
        sort(&mut found.facets, &control.watch())
    }

    /// As [`encroached_by`](Self::encroached_by), but of the subfacets that go all are said to be lost, and those that stay are not judged yet: most often
    /// a subsegment comes before them, or nothing depends on it.
    pub(crate) fn taken_by(
        &self,
        t: &Triangulation,
        p: DVec3,
        cavity: &Cavity,
        found: &mut Encroached,
        control: &Control,
    ) -> Result<(), Error> {
        const WHAT: &str = "encroached elements";
        found.clear();
        if !self.may_have_edge(cavity.rim(&t.topology)) {
            return Ok(());
        }
        let (by_labels, turns) = (self.shows_in_labels(t), control.turns());
        found.inner.clear();
        let mut recent = Recent::default();
        for &tet in &cavity.tets {
            turns.check()?;
            let Tetrahedron { v, n } = *t.topology.tet(tet);
            if !self.may_have_edge(v) {
                continue;
            }
            for [i, j] in places(self.subsegments.possible_edges(v)).map(|n| EDGES[n]) {
                let key = edge_key([v[i], v[j]]);
                if recent.is_new(key) && self.subsegments.contains_key(&key) {
                    memory::grow_long(&mut found.inner, 1, WHAT, control)?;
                    found.inner.push(key);
                }
            }
            for slot in places(self.possible_walls(v)) {
                let across = tet_of(n[slot]);
                let goes = cavity.contains(across);
                // Each face is looked at once. A facet that parts two regions shows in their labels.
                if goes && across < tet || by_labels && !t.topology.labels_differ(tet, slot) {
                    continue;
                }
                let face = t.topology.tet(tet).face(slot);
                if !self.is_subfacet(face) {
                    continue;
                }
                let key = face_key(face);
                let list = if goes { &mut found.lost_facets } else { &mut found.standing };
                memory::grow_long(list, 1, WHAT, control)?;
                list.push(key);
            }
        }
        let watch = control.watch();
        sort_unique(&mut found.inner, &watch)?;
        // Whether it stays: one of the faces around the cavity has it.
        found.stay.clear();
        memory::lengthen(&mut found.stay, found.inner.len(), false, WHAT, control)?;
        if !found.inner.is_empty() {
            for &face in &cavity.faces {
                turns.check()?;
                let corners = cavity.face(&t.topology, face);
                let [a, b, c] = corners;
                // No element has the ghost.
                for [i, j] in places(self.subsegments.possible_edges([a, b, c, GHOST])).map(|n| EDGES[n]) {
                    if let Ok(place) = found.inner.binary_search(&edge_key([corners[i], corners[j]])) {
                        found.stay[place] = true;
                    }
                }
            }
        }
        for (&key, &stays) in found.inner.iter().zip(&found.stay) {
            turns.check()?;
            if encroaches_segment(key.map(|v| t.at(v)), p) {
                found.segments.push(key);
                if !stays {
                    found.going_segments.push(key);
                }
            } else if !stays {
                found.lost_segments.push(key);
            }
        }
        // Faces come in the order of storage.
        sort(&mut found.lost_facets, &watch)
    }

    /// Keeps one subsegment and one subfacet of those that `p` encroaches upon, whose centres are nearest to it. What else it encroaches upon often needs
    /// no split any more when it comes again. (Distances measured by the radii of the balls, or longest first, are no better.)
    pub(crate) fn keep_nearest(&self, t: &Triangulation, p: DVec3, found: &mut Encroached) {
        let segment = |&[a, b]: &[u32; 2]| p.distance_squared(0.5 * t.at(a) + 0.5 * t.at(b));
        let facet = |&[a, b, c]: &[u32; 3]| p.distance_squared(triangle_circumcenter(t.at(a), t.at(b), t.at(c)));
        found.segments =
            found.segments.iter().copied().min_by(|s, r| segment(s).total_cmp(&segment(r))).into_iter().collect();
        found.facets = found.facets.iter().copied().min_by(|f, g| facet(f).total_cmp(&facet(g))).into_iter().collect();
    }

    /// Takes out what can't be split as demanded.
    pub(crate) fn drop_blocked(&self, found: &mut Encroached, demand: Demand) {
        found.segments.retain(|&s| self.waits_segment(s, demand));
        found.facets.retain(|&f| self.waits_facet(f, demand));
    }
}
