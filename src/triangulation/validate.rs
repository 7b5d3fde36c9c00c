//! The invariants of a triangulation, checked one by one and exactly.

use std::fmt;

use super::topology::{slot_of, tet_of, GHOST, NONE};
use super::Triangulation;
use crate::geometry::Sign;
use crate::Control;

/// Tetrahedra between two looks at the control.
const BLOCK: usize = 1 << 9;

/// A broken invariant. Meeting one means an error in this library, not in its input.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the fields are the elements that each variant's text speaks of")]
pub enum Defect {
    /// Two tetrahedra disagree about being neighbours, or about the face between them.
    Adjacency { tetrahedron: [u32; 4], slot: usize },
    /// A vertex has no tetrahedron, or one that it doesn't belong to.
    Incidence { vertex: u32 },
    /// The numbers of vertices, edges, faces and tetrahedra don't fit a 3-sphere.
    Euler { characteristic: i64 },
    /// A tetrahedron is flat or inverted.
    Orientation { tetrahedron: [u32; 4] },
    /// A vertex lies inside the circumsphere of a neighbouring tetrahedron.
    NotDelaunay { tetrahedron: [u32; 4], vertex: u32 },
    /// A subsegment of the domain is no edge of the triangulation.
    MissingSubsegment { edge: [u32; 2] },
    /// A subfacet of the domain is no face of the triangulation.
    MissingSubfacet { face: [u32; 3] },
    /// A triangle of a facet is none of the domain's subfacets, or of another facet; or a subfacet is no triangle of its facet.
    FacetMismatch { face: [u32; 3] },
    /// The tetrahedra on the two sides of a face belong to different regions, and it is no subfacet.
    LabelLeak { face: [u32; 3] },
    /// A tetrahedron of the domain is over the radius-edge bound.
    BadTetrahedron { tetrahedron: [u32; 4] },
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Defect::Adjacency { tetrahedron, slot } => {
                write!(f, "tetrahedron {tetrahedron:?} and its neighbour across face {slot} don't match")
            }
            Defect::Incidence { vertex } => write!(f, "vertex {vertex} names no tetrahedron of its own"),
            Defect::Euler { characteristic } => write!(f, "Euler characteristic is {characteristic}, expected 0"),
            Defect::Orientation { tetrahedron } => write!(f, "tetrahedron {tetrahedron:?} is not positive"),
            Defect::NotDelaunay { tetrahedron, vertex } => {
                write!(f, "vertex {vertex} lies inside the circumsphere of tetrahedron {tetrahedron:?}")
            }
            Defect::MissingSubsegment { edge } => write!(f, "subsegment {edge:?} is no edge"),
            Defect::MissingSubfacet { face } => write!(f, "subfacet {face:?} is no face"),
            Defect::FacetMismatch { face } => write!(f, "facets and subfacets disagree about {face:?}"),
            Defect::LabelLeak { face } => write!(f, "face {face:?} parts two regions but is no subfacet"),
            Defect::BadTetrahedron { tetrahedron } => {
                write!(f, "tetrahedron {tetrahedron:?} is over the radius-edge bound")
            }
        }
    }
}

impl std::error::Error for Defect {}

impl Triangulation {
    /// Checks the invariants up to a level: 1 the topology, 2 also orientation, 3 also the Delaunay property (local, exact, perturbation
    /// included; local everywhere is global). Level 0 checks nothing. Linear time.
    pub fn validate(&self, level: u32) -> Result<(), Defect> {
        self.validate_within(level, Control::never()).map(|_| ())
    }

    /// [`validate`](Self::validate) that a control can follow and cancel: `Ok(false)` then.
    pub fn validate_within(&self, level: u32, control: &Control) -> Result<bool, Defect> {
        let levels = f64::from(level.clamp(1, 3));
        let look = |done: u32, t: u32| {
            let share = f64::from(t) / self.topology.tets.len() as f64;
            t as usize % BLOCK != 0
                || control.report("validate", (f64::from(done) + share) / levels, self.vertex_count())
        };
        Ok((level < 1 || self.validate_topology(|t| look(0, t))?)
            && (level < 2 || self.validate_orientation(|t| look(1, t))?)
            && (level < 3 || self.validate_delaunay(|t| look(2, t))?))
    }

    fn validate_topology(&self, go_on: impl Fn(u32) -> bool) -> Result<bool, Defect> {
        let topology = &self.topology;
        let mut edges = 0i64;
        for t in 0..topology.tets.len() as u32 {
            if !go_on(t) {
                return Ok(false);
            }
            if !topology.tet(t).is_live() {
                continue;
            }
            let tet = topology.tet(t);
            for slot in 0..4 {
                let defect = Defect::Adjacency { tetrahedron: tet.v, slot };
                let face = tet.n[slot];
                let other =
                    topology.tets.get(tet_of(face) as usize).filter(|other| other.is_live()).ok_or(defect.clone())?;
                let mut mine = tet.face(slot);
                let mut theirs = other.face(slot_of(face));
                mine.sort_unstable();
                theirs.sort_unstable();
                let distinct = tet.v[slot] != other.v[slot_of(face)];
                if other.n[slot_of(face)] != 4 * t + slot as u32 || mine != theirs || !distinct {
                    return Err(defect);
                }
                if tet.v[slot] == GHOST && slot != 3 {
                    return Err(defect);
                }
            }
            // Each edge is counted at the lowest tetrahedron around it.
            for [i, j] in crate::geometry::quality::EDGES {
                edges += i64::from(topology.around_edge(t, i, j).all(|(other, _, _)| other >= t));
            }
        }
        let last = (topology.tets.len() / BLOCK * BLOCK) as u32;
        for (v, &t) in topology.vertex_tet.iter().enumerate() {
            if v % BLOCK == 0 && !go_on(last) {
                return Ok(false);
            }
            let belongs = t != NONE && topology.tets.get(t as usize).is_some_and(|tet| tet.slot(v as u32).is_some());
            let expected = self.dimension() == 3 && self.is_vertex(v as u32);
            if belongs != expected || (t != NONE) != expected {
                return Err(Defect::Incidence { vertex: v as u32 });
            }
        }
        if self.dimension() == 3 {
            // A triangulated 3-sphere: V − E + F − T = 0 with F = 2T; the ghost is a vertex.
            let characteristic = self.vertex_count() as i64 + 1 - edges + topology.live_count() as i64;
            if characteristic != 0 {
                return Err(Defect::Euler { characteristic });
            }
        }
        Ok(true)
    }

    fn validate_orientation(&self, go_on: impl Fn(u32) -> bool) -> Result<bool, Defect> {
        for t in 0..self.topology.tets.len() as u32 {
            if !go_on(t) {
                return Ok(false);
            }
            if !self.topology.tet(t).is_live() || self.topology.tet(t).is_ghost() {
                continue;
            }
            let [a, b, c, d] = self.corners(t);
            if self.filter.orient3d(a, b, c, d) != Sign::Positive {
                return Err(Defect::Orientation { tetrahedron: self.topology.tet(t).v });
            }
        }
        Ok(true)
    }

    fn validate_delaunay(&self, go_on: impl Fn(u32) -> bool) -> Result<bool, Defect> {
        for t in 0..self.topology.tets.len() as u32 {
            if !go_on(t) {
                return Ok(false);
            }
            if !self.topology.tet(t).is_live() {
                continue;
            }
            let tet = self.topology.tet(t);
            for face in tet.n {
                let vertex = self.topology.tet(tet_of(face)).v[slot_of(face)];
                if vertex != GHOST && self.conflicts(&self.filter, t, self.at(vertex)) {
                    return Err(Defect::NotDelaunay { tetrahedron: tet.v, vertex });
                }
            }
        }
        Ok(true)
    }
}
