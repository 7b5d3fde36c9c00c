//! Refinement: Algorithm 2 of Jampani and Üngör with the boundary rules of Ruppert and Shewchuk.
//!
//! | module | idea |
//! |---|---|
//! | `refiner` | the loop, and rule 3 |
//! | [`sizing`] | how large tetrahedra may be |
//! | `split` | rules 1 and 2 |
//! | `watch` | what an insertion has created |
//! | `restore` | recovery of what is missing; each split a transaction |
//! | [`step`] | the same, one batch at a time, for a host's own loop |
//! | `near_side` | what samples meet on their own side of the boundary |
//! | `obstacle` | what stood in the way of samples |
//! | `off_centre` | where subfacets are split for samples |
//! | `limits` | seconds and bytes |
//! | `queue` | the bad tetrahedron with the shortest edge first |

mod kept;
pub(crate) mod limits;
mod near_side;
mod obstacle;
mod off_centre;
pub(crate) mod queue;
pub(crate) mod refiner;
pub(crate) mod restore;
pub mod sizing;
pub(crate) mod split;
pub mod step;
mod watch;

pub use crate::sampler::Rule;
pub use crate::sparsify::Sparsify;
use crate::Error;

/// What [`Mesh::refine`](crate::Mesh::refine) shall reach, and when it shall stop.
#[derive(Clone, Debug, PartialEq)]
pub struct RefineOptions {
    /// The bound β: no tetrahedron's circumradius is longer than β times its shortest edge. Finite, at least 0.62 (a
    /// regular tetrahedron has 0.612); refinement is sure to end for 2 and more, and usually does well below.
    pub radius_edge: f64,
    /// How Steiner points are chosen.
    pub rule: Rule,
    /// No vertex is added beyond this many, input included, but for the few that may be needed to keep segments and facets whole where their
    /// points can't stand exactly on them.
    pub max_vertices: usize,
    /// No Steiner point is added nearer than this to a vertex; 0 chooses 2⁻⁴⁰ of the bounding box's diagonal, but no less than 2⁻⁴⁶ of the
    /// largest coordinate.
    pub min_edge: f64,
    /// How hard to try to do with fewer Steiner points; `None` stands for [`Sparsify::Quick`] with [`Rule::Sparse`], for [`Sparsify::Off`] with the
    /// others.
    pub sparsify: Option<Sparsify>,
    /// Leaves segments and facets as they are: no Steiner point is put on them. Tetrahedra that could only be mended so are left and counted. What the
    /// domain's recovery had to add when the mesh was made remains.
    pub keep_boundary: bool,
    /// The refinement stops after so many seconds; 0 for no limit.
    pub max_seconds: f64,
    /// The refinement stops before its large arrays and the mesh's take more than so many bytes; 0 for no limit. Views, the last bits of
    /// bookkeeping, and copies made for the time of a large change are not counted.
    pub max_memory: usize,
}

impl Default for RefineOptions {
    fn default() -> Self {
        RefineOptions {
            radius_edge: 2.0,
            rule: Rule::default(),
            max_vertices: 100_000_000,
            min_edge: 0.0,
            sparsify: None,
            keep_boundary: false,
            max_seconds: 0.0,
            max_memory: 0,
        }
    }
}

pub(crate) fn check_radius_edge(value: f64) -> Result<(), Error> {
    if (0.62..=1e6).contains(&value) {
        return Ok(());
    }
    Err(Error::InvalidOption { name: "radius_edge", value, expected: "a number from 0.62 to 1e6" })
}

impl RefineOptions {
    /// [`sparsify`](Self::sparsify) with the default filled in.
    pub fn sparsify(&self) -> Sparsify {
        self.sparsify.unwrap_or(if self.rule == Rule::Sparse { Sparsify::Quick } else { Sparsify::Off })
    }

    /// Whether each option has a value that it can have.
    pub fn check(&self) -> Result<(), Error> {
        check_radius_edge(self.radius_edge)?;
        if !(self.min_edge.is_finite() && self.min_edge >= 0.0) {
            return Err(Error::InvalidOption {
                name: "min_edge",
                value: self.min_edge,
                expected: "a finite length, or 0 for the default",
            });
        }
        if self.max_seconds.is_nan() || self.max_seconds < 0.0 {
            return Err(Error::InvalidOption {
                name: "max_seconds",
                value: self.max_seconds,
                expected: "a number of seconds, or 0 for no limit",
            });
        }
        Ok(())
    }
}

/// How a refinement ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RefineStatus {
    /// Every tetrahedron of the domain keeps the bound.
    Done,
    /// The control was cancelled. The mesh is valid, and refining it again goes on from here. Its quality has not been measured: see
    /// [`RefineReport::measured`].
    Cancelled,
    /// The vertex limit was reached. The mesh is valid.
    VertexLimit,
    /// Some tetrahedra are left bad, for the reasons that the report counts; or none is, but some are [larger](RefineReport::too_large) than was asked
    /// for and could not be made smaller for such a reason.
    Unrefined,
    /// The seconds were over. The mesh is valid, and refining it again goes on from here.
    TimeLimit,
    /// More memory would have been needed than allowed. The mesh is valid.
    MemoryLimit,
}

/// Why a tetrahedron is over the bound after a refinement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Unrefined {
    /// Its shortest edge spans an input angle of less than 60°: the input gives the edge's length.
    SmallAngle,
    /// Its Steiner points would encroach upon segments or facets that can't be split: because of small input angles nearby, or because the boundary
    /// is to be [kept](RefineOptions::keep_boundary).
    Boundary,
    /// Mending it would need an edge below the minimum length.
    MinEdge,
    /// A vertex limit or a cancellation came first.
    Limit,
    /// Rounding left no place for a Steiner point.
    Rounding,
}

impl Unrefined {
    /// All reasons, in the order of [`RefineReport::unrefined`].
    pub const ALL: [Unrefined; 5] =
        [Unrefined::SmallAngle, Unrefined::Boundary, Unrefined::MinEdge, Unrefined::Limit, Unrefined::Rounding];

    /// A short name in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Unrefined::SmallAngle => "small_angle",
            Unrefined::Boundary => "boundary",
            Unrefined::MinEdge => "min_edge",
            Unrefined::Limit => "limit",
            Unrefined::Rounding => "rounding",
        }
    }
}

/// What a refinement did, and the mesh's quality after it.
#[derive(Clone, Debug, PartialEq)]
pub struct RefineReport {
    /// How it ended.
    pub status: RefineStatus,
    /// Vertices before any Steiner point.
    pub input_vertices: usize,
    /// Vertices now.
    pub vertices: usize,
    /// Tetrahedra of the domain.
    pub tetrahedra: usize,
    /// `vertices − input_vertices`.
    pub steiner: usize,
    /// Steiner points of this call that the sampling rule placed.
    pub samples: usize,
    /// Steiner points of this call that split subsegments.
    pub segment_splits: usize,
    /// Steiner points of this call that split subfacets.
    pub facet_splits: usize,
    /// Steiner points that lie on segments now: those of the domain's recovery and of earlier calls too.
    pub on_segments: usize,
    /// Steiner points that lie on facets now, but on no segment.
    pub on_facets: usize,
    /// Steiner points that this call took away again without putting another in their place.
    pub removed: usize,
    /// Steiner points that this call put in the place of two each.
    pub replaced: usize,
    /// Tetrahedra of the domain over the bound (exact).
    pub bad: usize,
    /// How many of them are left for each reason, in the order of [`Unrefined::ALL`]; their sum is `bad`.
    pub unrefined: [usize; Unrefined::ALL.len()],
    /// Tetrahedra of the domain that are larger than was asked for.
    pub too_large: usize,
    /// The largest radius-edge ratio in the domain, 0 without tetrahedra.
    pub worst_radius_edge: f64,
    /// The smallest dihedral angle in the domain in degrees, 180 without tetrahedra.
    pub min_dihedral_degrees: f64,
    /// Whether the domain's tetrahedra have been looked at. After a cancellation they are not, for that takes a while: the numbers of tetrahedra and of
    /// points on segments and facets are 0 then, and the ratios NaN. [`Mesh::report`](crate::Mesh::report) makes up for it.
    pub measured: bool,
}

#[cfg(test)]
mod tests;
