//! A triangulation together with its domain: what most callers hold, and what the C handle wraps.

use glam::DVec3;

use crate::domain::plc::Plc;
use crate::sampler::Rule;
use crate::{Control, Error, RefineOptions, RefineReport, Triangulation};

/// A Delaunay triangulation and, once one is set, the domain it fills.
#[derive(Clone, Debug, Default)]
pub struct Mesh {}

/// Where a Steiner point comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Origin {
    /// The sampling rule, in the interior.
    Sample,
    /// The split of this encroached subsegment.
    Segment([u32; 2]),
    /// The split of this encroached subfacet.
    Subfacet([u32; 3]),
}

/// One Steiner point to insert.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteinerPoint {
    pub position: DVec3,
    pub origin: Origin,
}

/// The points that one step of the refinement inserts together.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The bad short edge that asked for them.
    pub edge: [u32; 2],
    pub points: Vec<SteinerPoint>,
    /// Span and sampling angle of the component, radians; 0 for boundary splits and circumcentres.
    pub span: f64,
    pub theta: f64,
}

/// What one step needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepOptions {
    pub radius_edge: f64,
    pub rule: Rule,
}

/// Arrays of the mesh's tetrahedra for reading. Vertices are numbered by id.
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a> {
    /// One point a vertex id; a removed vertex keeps its place (NaN).
    pub points: &'a [DVec3],
    /// Four vertex ids a tetrahedron, positively oriented: det[b−a, c−a, d−a] > 0.
    pub tetrahedra: &'a [[u32; 4]],
    /// The tetrahedron across the face opposite each vertex, `u32::MAX` on the hull.
    pub neighbours: &'a [[u32; 4]],
}

impl Mesh {
    /// An empty mesh without a domain.
    pub fn new() -> Self {
        unimplemented!()
    }
    /// The triangulation of the complex's points with the complex as its domain.
    pub fn from_plc(plc: &Plc, control: &Control) -> Result<Mesh, Error> {
        let _ = (plc, control);
        unimplemented!()
    }
    pub fn triangulation(&self) -> &Triangulation {
        unimplemented!()
    }
    pub fn has_domain(&self) -> bool {
        unimplemented!()
    }
    /// Inserts all points; `ids[i]` becomes the vertex of `points[i]`, for a duplicate the first one's.
    /// All or nothing, but for a cancellation (Ok(false)): then nothing is inserted either.
    pub fn insert(&mut self, points: &[DVec3], ids: Option<&mut Vec<u32>>, control: &Control) -> Result<bool, Error> {
        let _ = (points, ids, control);
        unimplemented!()
    }
    /// Makes the hull of the present points the domain.
    pub fn use_hull_as_domain(&mut self) -> Result<(), Error> {
        unimplemented!()
    }
    /// All bad short edges, shortest first (ties by vertex ids), as vertex pairs with the lower id first.
    pub fn bad_short_edges(&self, radius_edge: f64) -> Result<Vec<[u32; 2]>, Error> {
        let _ = radius_edge;
        unimplemented!()
    }
    /// The next step for this edge: boundary rules first, then its samples. Empty if the edge is not bad.
    pub fn steiner_batch(&self, edge: [u32; 2], options: &StepOptions) -> Result<Batch, Error> {
        let _ = (edge, options);
        unimplemented!()
    }
    /// Inserts a batch made by `steiner_batch` of this mesh; returns the new vertices' ids.
    pub fn insert_batch(&mut self, batch: &Batch) -> Result<Vec<u32>, Error> {
        let _ = batch;
        unimplemented!()
    }
    /// Refines until every tetrahedron keeps the bound, or a limit says stop.
    pub fn refine(&mut self, options: &RefineOptions, control: &Control) -> Result<RefineReport, Error> {
        let _ = (options, control);
        unimplemented!()
    }
    /// Whether and how the mesh is broken.
    pub fn validate(&self, level: u32) -> Result<(), String> {
        let _ = level;
        unimplemented!()
    }
    /// The tetrahedra of the domain (all finite ones without a domain).
    pub fn view(&self) -> MeshView<'_> {
        unimplemented!()
    }
}
