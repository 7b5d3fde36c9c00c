//! One round of the refinement on a host's arrays: boundary splits and samples for bad short edges, of which a maximal independent set is taken.
//!
//! Candidates come in the order of the refinement: subsegments that a vertex encroaches upon, then subfacets, then the samples of bad short
//! edges, the shortest first; or, by rule 3, the splits of what a sample would encroach upon. A candidate is taken if its cavities neither
//! meet those taken before nor share a face with them. Then none of the new tetrahedra at one candidate's points can be in conflict with
//! another's: the conflict region of a point is connected through faces, so it would first have to reach across such a face. So all that was
//! decided here (distances, encroachment, cavities) holds in whatever order the points are inserted (compare D. Spielman, S.-H. Teng,
//! A. Üngör, "Parallel Delaunay refinement: algorithms and analyses", IJCGA 17, 2007). The samples of one edge may have cavities in common;
//! they are one candidate, and keep their distances as in the refinement.
//!
//! Deviation from the sequential order: edges far apart are mended in one round though one is longer. Edges longer than [`WINDOW`] times
//! the shortest wait, because what is inserted at the short ones often mends them too.

use rustc_hash::FxHashMap;

use super::boundary::Boundary;
use super::topology::{Cavity, Mesh, Walk, NONE};
use super::Arrays;
use crate::domain::boundary::{edge_key, Encroached};
use crate::domain::pending::OFF_MIDDLE;
use crate::geometry::circumsphere::triangle_circumcenter;
use crate::geometry::encroachment::encroaches_facet;
use crate::geometry::quality::{exceeds_radius_edge, EDGES};
use crate::geometry::{check_range, flush_tiny};
use crate::leavings::InPieces;
use crate::sampler::facet::{Arc, VoronoiFacet};
use crate::sampler::{sample_circumcenter, sample_component, Rule};
use crate::sorting::sort_by;
use crate::triangulation::topology::tet_of;
use crate::{memory, Control, DVec3, Error, Origin, RefineOptions};

/// Edges longer than this many times the shortest bad one that can be mended wait for a later round.
pub const WINDOW: f64 = 1.5;

/// What a round aims at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrayOptions {
    /// The bound β.
    pub radius_edge: f64,
    /// How Steiner points are chosen.
    pub rule: Rule,
    /// No point comes on the boundary, and no sample that encroaches upon it: what could only be mended so is left and counted.
    pub keep_boundary: bool,
    /// No point is nearer than this to a vertex; less than the default of [`RefineOptions::min_edge`] counts as that.
    pub min_edge: f64,
}

impl ArrayOptions {
    /// Whether each option has a value that it can have.
    pub fn check(&self) -> Result<(), Error> {
        let ArrayOptions { radius_edge, rule, keep_boundary, min_edge } = *self;
        RefineOptions { radius_edge, rule, keep_boundary, min_edge, ..RefineOptions::default() }.check()
    }
}

impl Default for ArrayOptions {
    fn default() -> Self {
        let RefineOptions { radius_edge, rule, keep_boundary, min_edge, .. } = RefineOptions::default();
        ArrayOptions { radius_edge, rule, keep_boundary, min_edge }
    }
}

/// A Steiner point of a round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrayPoint {
    /// Where it goes.
    pub position: DVec3,
    /// What asks for it.
    pub origin: Origin,
    /// The bad short edge whose mending asks for it; `[u32::MAX; 2]` for splits that a vertex asks for.
    pub edge: [u32; 2],
    /// A tetrahedron whose circumsphere holds the point: to start its location, or the search of its cavity, from.
    pub tetrahedron: u32,
}

/// What a round inserts, and what it saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArrayBatch {
    /// The points, those of one edge together and in the order of insertion.
    pub points: Vec<ArrayPoint>,
    /// The bad short edges, shortest first.
    pub bad_edges: Vec<[u32; 2]>,
    /// Subsegments and subfacets that a vertex encroaches upon.
    pub encroached: usize,
    /// Bad tetrahedra and encroached elements that can't be mended: that needs an edge below the minimum length, or a split of the boundary
    /// that makes an edge shorter than β/2 times the one to be mended, or this spans an input angle of less than 60°. With a boundary to be
    /// kept, the bad tetrahedra whose samples all encroach upon it, too; elements that a vertex encroaches upon are then not counted, as
    /// nothing is asked of them.
    pub refused: usize,
}

/// What became of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Taken,
    /// It meets one that was taken: it comes again in the next round.
    Waits,
    Refused,
}

/// Where a sample would come to lie.
enum Located {
    /// In the circumsphere of this tetrahedron, and the cavity is known.
    In(u32),
    /// Not in the domain; this face lies between, if the sample encroaches upon it.
    Beyond(Option<[u32; 3]>),
}

struct Round<'a> {
    control: &'a Control,
    mesh: Mesh<'a>,
    boundary: Boundary,
    radius_edge: f64,
    rule: Rule,
    keep_boundary: bool,
    min_edge: f64,
    /// By tetrahedron: whether a cavity that was taken holds it.
    taken: Vec<bool>,
    /// Boundary elements that have had their turn, and what came of it.
    tried_segments: FxHashMap<[u32; 2], Outcome>,
    tried_facets: FxHashMap<[u32; 3], Outcome>,
    /// Edges, with the ends of their link where it is a chain, that have had theirs.
    sampled: FxHashMap<([u32; 2], [u32; 2]), Outcome>,
    facet: VoronoiFacet,
    arcs: Vec<Arc>,
    link: Vec<u32>,
    batch: ArrayBatch,
}

/// A round of refinement on a host's arrays. The refinement is done when the batch has no points; it has then reached the bound unless
/// something was refused.
///
/// Cost: linear in the arrays, with one in-sphere test a face to check them, plus the candidates' cavities.
pub fn sample_arrays(
    arrays: &Arrays<'_>,
    options: &ArrayOptions,
    control: &Control,
) -> Result<Option<ArrayBatch>, Error> {
    options.check()?;
    match sample(arrays, options, control) {
        Ok(batch) => Ok(Some(batch)),
        Err(Error::Cancelled) => Ok(None),
        Err(error) => Err(error),
    }
}

fn sample(arrays: &Arrays<'_>, options: &ArrayOptions, control: &Control) -> Result<ArrayBatch, Error> {
    let mut mesh = Mesh::new(arrays, control)?;
    let boundary = match Boundary::new(&mesh, arrays, control) {
        Ok(boundary) => boundary,
        Err(error) => {
            mesh.give_back_to(control);
            return Err(error);
        }
    };
    let mut round = Round {
        control,
        taken: memory::zeroed(mesh.tets.len(), "tetrahedra", control)?.keep(),
        radius_edge: options.radius_edge,
        rule: options.rule,
        keep_boundary: options.keep_boundary,
        min_edge: mesh.min_edge.max(options.min_edge),
        mesh,
        boundary,
        tried_segments: FxHashMap::default(),
        tried_facets: FxHashMap::default(),
        sampled: FxHashMap::default(),
        facet: VoronoiFacet::default(),
        arcs: Vec::new(),
        link: Vec::new(),
        batch: ArrayBatch::default(),
    };
    let done = round.run();
    round.mesh.give_back_to(control);
    control.give_back(std::mem::take(&mut round.taken));
    done.map(|()| round.batch)
}

/// A bad tetrahedron: its shortest edge's squared length, as bits that sort like it, and the edge.
type Bad = (u64, [u32; 2], u32);

impl Round<'_> {
    fn run(&mut self) -> Result<(), Error> {
        let control = self.control;
        let encroached = self.boundary.encroached_by_vertices(&self.mesh, control)?;
        self.batch.encroached = encroached.segments.len() + encroached.facets.len();
        if !self.keep_boundary {
            self.split_all(&encroached)?;
        }
        let bad = self.bad(control)?;
        let mut edges = memory::room_in_pieces(bad.len(), "bad short edges", control)?;
        let turns = control.turns();
        for &(_, edge, _) in bad.iter() {
            turns.check()?;
            if edges.last() != Some(&edge) {
                edges.push(edge);
            }
        }
        self.batch.bad_edges = edges.keep();
        let mut limit = f64::INFINITY;
        for (i, &(bits, edge, tet)) in bad.iter().enumerate() {
            let goes_on = if i % 256 == 0 {
                control.report("refine", i as f64 / bad.len() as f64, self.mesh.points.len())
            } else {
                control.poll()
            };
            if !goes_on {
                return Err(Error::Cancelled);
            }
            let length = f64::from_bits(bits);
            if length > limit {
                break;
            }
            let outcome = self.mend(tet, edge)?;
            self.count(outcome);
            if outcome != Outcome::Refused {
                limit = limit.min(length * WINDOW * WINDOW);
            }
        }
        Ok(())
    }

    /// Splits what vertices encroach upon.
    fn split_all(&mut self, encroached: &Encroached) -> Result<(), Error> {
        for &edge in &encroached.segments {
            self.control.check()?;
            let outcome = self.split_segment(edge, [NONE; 2])?;
            self.count(outcome);
        }
        for &face in &encroached.facets {
            self.control.check()?;
            let outcome = self.split_facet(face, [NONE; 2])?;
            self.count(outcome);
        }
        Ok(())
    }

    fn count(&mut self, outcome: Outcome) {
        self.batch.refused += usize::from(outcome == Outcome::Refused);
    }

    /// All bad tetrahedra, the one with the shortest shortest edge first.
    fn bad<'a>(&self, control: &'a Control) -> Result<InPieces<'a, Vec<Bad>>, Error> {
        let mut bad = memory::room_in_pieces::<Bad>(0, "bad tetrahedra", control)?;
        let turns = control.turns();
        for t in 0..self.mesh.tets.len() as u32 {
            turns.check()?;
            if self.mesh.is_left_out(t) || !exceeds_radius_edge(self.mesh.corners(t), self.radius_edge) {
                continue;
            }
            let v = self.mesh.tets[t as usize];
            let length = |[i, j]: [usize; 2]| self.mesh.at(v[i]).distance_squared(self.mesh.at(v[j])).to_bits();
            let (length, edge) =
                EDGES.map(|e| (length(e), edge_key(e.map(|i| v[i])))).into_iter().min().unwrap_or_default();
            memory::grow_long(&mut bad, 1, "bad tetrahedra", control)?;
            bad.push((length, edge, t));
        }
        // Ties by vertices, not by places in the arrays, which say nothing.
        let key = |t: u32| {
            let mut v = self.mesh.tets[t as usize];
            v.sort_unstable();
            v
        };
        sort_by(&mut bad, &control.watch(), |a, b| {
            (a.0, a.1).cmp(&(b.0, b.1)).then_with(|| (key(a.2), a.2).cmp(&(key(b.2), b.2)))
        })?;
        Ok(bad)
    }

    /// Mends a bad tetrahedron at its shortest edge.
    fn mend(&mut self, tet: u32, edge: [u32; 2]) -> Result<Outcome, Error> {
        if self.taken[tet as usize] {
            // It will be gone.
            return Ok(Outcome::Waits);
        }
        if self.boundary.is_seditious(&self.mesh, edge) {
            return Ok(Outcome::Refused);
        }
        let v = self.mesh.tets[tet as usize];
        if self.rule != Rule::Circumcenter {
            let slot = |x: u32| v.iter().position(|&y| y == x).unwrap_or(0);
            let (mesh, boundary) = (&self.mesh, &self.boundary);
            let wall = |face: u32| boundary.is_wall(mesh, face);
            let closed = mesh.sector(tet, slot(edge[0]), slot(edge[1]), wall, &mut self.link);
            let sector = match (closed, self.link.first(), self.link.last()) {
                (false, Some(&a), Some(&b)) => (edge, edge_key([a, b])),
                _ => (edge, [NONE; 2]),
            };
            if let Some(outcome) = self.sampled.get(&sector) {
                // Another bad tetrahedron has asked for the same.
                return Ok(outcome.again());
            }
            let [p, q] = edge.map(|v| mesh.at(v));
            self.facet.set(p, q, self.link.iter().map(|&r| mesh.at(r)), closed);
            let samples = sample_component(&self.facet, &mut self.arcs, self.radius_edge, self.rule);
            if let Some(samples) = samples {
                let outcome = self.place(samples.points, tet, edge)?;
                self.sampled.insert(sector, outcome);
                return Ok(outcome);
            }
        }
        // Rounding must not depend on how a tetrahedron is stored: lower vertices first, as in the refinement.
        let mut rest = v.into_iter().filter(|v| !edge.contains(v));
        let rest = edge_key([rest.next().unwrap_or(v[2]), rest.next().unwrap_or(v[3])]);
        let corners = [edge[0], edge[1], rest[0], rest[1]].map(|v| self.mesh.at(v));
        self.place(sample_circumcenter(corners).points, tet, edge)
    }

    /// Takes an edge's samples as a candidate, or splits what they encroach upon.
    fn place(&mut self, points: Vec<DVec3>, tet: u32, edge: [u32; 2]) -> Result<Outcome, Error> {
        let mut group: Vec<(ArrayPoint, Cavity)> = Vec::new();
        let mut outcome = Outcome::Refused;
        for p in points {
            let p = flush_tiny(p);
            let mut cavity = Cavity::default();
            if check_range(0, p).is_err() {
                continue;
            }
            let (start, mut found) = match self.locate(p, tet, &mut cavity)? {
                Located::In(start) => (start, self.boundary.encroached_by(&self.mesh, p, &cavity, self.control)?),
                Located::Beyond(face) => {
                    let mut between = Encroached::default();
                    between.facets.extend(face);
                    (NONE, between)
                }
            };
            let encroaches = !found.segments.is_empty() || !found.facets.is_empty();
            // Where a vertex encroaches upon the boundary and nothing is to be done about it, a sample may lie beyond and encroach upon nothing.
            let is_lost = !encroaches && self.boundary.is_crossed(&self.mesh, p, &cavity, self.control)?;
            if is_lost || self.keep_boundary && encroaches {
                // The edge's other samples may still do.
                continue;
            }
            if encroaches {
                outcome = self.split_encroached(p, &mut found, edge)?;
                break;
            }
            if start != NONE && self.rim_distance(p, &cavity)? >= self.min_edge {
                group.push((ArrayPoint { position: p, origin: Origin::Sample, edge, tetrahedron: start }, cavity));
            }
        }
        match (group.is_empty(), outcome) {
            (true, outcome) => Ok(outcome),
            (false, Outcome::Refused) => self.take(group),
            // The samples before the one that met the boundary stay.
            (false, outcome) => self.take(group).map(|_| outcome),
        }
    }

    /// A tetrahedron in conflict with `p`, and the cavity; or what lies between.
    fn locate(&self, p: DVec3, near: u32, cavity: &mut Cavity) -> Result<Located, Error> {
        let (mesh, control) = (&self.mesh, self.control);
        if mesh.cavity(p, near, cavity, control)? {
            return Ok(Located::In(near));
        }
        let mut between = None;
        match mesh.walk(p, near, control)? {
            Walk::In(t) => {
                if mesh.cavity(p, t, cavity, control)? {
                    return Ok(Located::In(t));
                }
            }
            Walk::Beyond(face) => {
                let key = super::topology::face_key(mesh.face(face));
                between = Some(key).filter(|key| encroaches_facet(key.map(|v| mesh.at(v)), p));
            }
        }
        Ok(Located::Beyond(between))
    }

    /// Rule 3: the splits of what a sample encroaches upon.
    fn split_encroached(&mut self, p: DVec3, found: &mut Encroached, edge: [u32; 2]) -> Result<Outcome, Error> {
        if !found.segments.is_empty() {
            found.facets.clear();
        }
        if self.rule == Rule::Sparse {
            self.boundary.keep_nearest(&self.mesh, p, found);
        }
        let mut outcome = Outcome::Refused;
        for &segment in &found.segments {
            outcome = better(outcome, self.split_segment(segment, edge)?);
        }
        for &face in &found.facets {
            outcome = better(outcome, self.split_facet(face, edge)?);
        }
        Ok(outcome)
    }

    /// Rule 1.
    fn split_segment(&mut self, segment: [u32; 2], edge: [u32; 2]) -> Result<Outcome, Error> {
        if let Some(outcome) = self.tried_segments.get(&segment) {
            return Ok(outcome.again());
        }
        let outcome = self.try_segment(segment, edge)?;
        self.tried_segments.insert(segment, outcome);
        Ok(outcome)
    }

    fn try_segment(&mut self, segment: [u32; 2], edge: [u32; 2]) -> Result<Outcome, Error> {
        let p = flush_tiny(self.boundary.split_point(&self.mesh, segment));
        let mut cavity = Cavity::default();
        let Some(near) = self.boundary.at_segment(segment) else { return Ok(Outcome::Refused) };
        if !self.mesh.cavity(p, near, &mut cavity, self.control)?
            || self.rim_distance(p, &cavity)? < self.demanded(edge, &segment)
        {
            return Ok(Outcome::Refused);
        }
        let point = ArrayPoint { position: p, origin: Origin::Segment(segment), edge, tetrahedron: near };
        self.take(vec![(point, cavity)])
    }

    /// Rule 2.
    fn split_facet(&mut self, face: [u32; 3], edge: [u32; 2]) -> Result<Outcome, Error> {
        if let Some(outcome) = self.tried_facets.get(&face) {
            return Ok(outcome.again());
        }
        let outcome = self.try_facet(face, edge)?;
        self.tried_facets.insert(face, outcome);
        Ok(outcome)
    }

    fn try_facet(&mut self, face: [u32; 3], edge: [u32; 2]) -> Result<Outcome, Error> {
        let [a, b, c] = face.map(|v| self.mesh.at(v));
        let p = flush_tiny(triangle_circumcenter(a, b, c));
        let mut cavity = Cavity::default();
        let Some(near) = self.boundary.at_facet(face).map(tet_of) else { return Ok(Outcome::Refused) };
        if check_range(0, p).is_err()
            || !self.mesh.cavity(p, near, &mut cavity, self.control)?
            || self.rim_distance(p, &cavity)? < self.demanded(edge, &face)
        {
            return Ok(Outcome::Refused);
        }
        let found = self.boundary.encroached_by(&self.mesh, p, &cavity, self.control)?;
        let mut outcome = Outcome::Refused;
        for segment in found.segments {
            outcome = better(outcome, self.split_segment(segment, edge)?);
        }
        if outcome != Outcome::Refused {
            return Ok(outcome);
        }
        if let Some(segment) = self.boundary.hides(&self.mesh, face, p, self.control)? {
            // The point would lie outside the facet.
            return self.split_segment(segment, edge);
        }
        let point = ArrayPoint { position: p, origin: Origin::Subfacet(face), edge, tetrahedron: near };
        self.take(vec![(point, cavity)])
    }

    /// How near to a vertex the split of a boundary element with these corners may come, given the bad short edge that asks for it, if one does. See
    /// `domain::pending`; what follows from a split can't be told from other splits here, and is not asked for more than the least length.
    fn demanded(&self, edge: [u32; 2], corners: &[u32]) -> f64 {
        if edge == [NONE; 2] {
            return self.min_edge;
        }
        let length = 0.499 * self.radius_edge * self.mesh.at(edge[0]).distance(self.mesh.at(edge[1]));
        let part = if self.boundary.has_acute(corners) { OFF_MIDDLE } else { 1.0 };
        self.min_edge.max(part * length)
    }

    /// Takes a candidate, if its cavities are free and share no face with those taken.
    fn take(&mut self, group: Vec<(ArrayPoint, Cavity)>) -> Result<Outcome, Error> {
        let turns = self.control.turns();
        for &t in group.iter().flat_map(|(_, cavity)| cavity.tets.iter().chain(&cavity.around)) {
            turns.check()?;
            if self.taken[t as usize] {
                return Ok(Outcome::Waits);
            }
        }
        for (point, cavity) in group {
            for t in cavity.tets {
                turns.check()?;
                self.taken[t as usize] = true;
            }
            self.batch.points.push(point);
        }
        Ok(Outcome::Taken)
    }

    /// The distance from the cavity's point to the nearest vertex.
    fn rim_distance(&self, p: DVec3, cavity: &Cavity) -> Result<f64, Error> {
        let (mut least, turns) = (f64::INFINITY, self.control.turns());
        for &t in &cavity.tets {
            turns.check()?;
            least = self.mesh.corners(t).into_iter().map(|v| v.distance_squared(p)).fold(least, f64::min);
        }
        Ok(least.sqrt())
    }
}

impl Outcome {
    /// What it is to the next who asks for the same.
    fn again(self) -> Outcome {
        match self {
            Outcome::Taken | Outcome::Waits => Outcome::Waits,
            Outcome::Refused => Outcome::Refused,
        }
    }
}

fn better(a: Outcome, b: Outcome) -> Outcome {
    match (a, b) {
        (Outcome::Taken, _) | (_, Outcome::Taken) => Outcome::Taken,
        (Outcome::Waits, _) | (_, Outcome::Waits) => Outcome::Waits,
        _ => Outcome::Refused,
    }
}
