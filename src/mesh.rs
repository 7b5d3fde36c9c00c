//! A triangulation together with its domain: what most callers hold, and what the C handle wraps.

mod outline;
mod refinement;

use std::sync::OnceLock;

use glam::DVec3;

use crate::domain::plc::{Plc, PlcRegion};
use crate::domain::Boundary;
use crate::geometry::quality::exceeds_radius_edge;
use crate::leavings::{InPieces, Leavings};
use crate::refine::refiner::Refiner;
use crate::triangulation::topology::tet_of;
use crate::triangulation::Defect;
use crate::{memory, Control, Error, RefineOptions, RefineStatus, Triangulation};
use outline::Outline;
pub use outline::{BoundaryView, On};
use refinement::Unfinished;

/// Recovery may make so many vertices in any case, and so many more for each vertex and element.
const RECOVERY_ROOM: usize = 100_000;
const RECOVERY_FACTOR: usize = 100;

/// Tetrahedra between two looks at the control, where arrays of them are made.
const BLOCK: usize = 1 << 14;
const WHAT: &str = "view";

type Numbers<'a> = InPieces<'a, Vec<u32>>;

/// A Delaunay triangulation and, once one is set, the domain that it fills.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub(crate) t: Triangulation,
    pub(crate) domain: Option<Domain>,
    /// Vertices that are no Steiner points.
    input_vertices: usize,
    /// Their ids are below this, and no others are.
    input_slots: usize,
    /// Ids of Steiner points are missing: a call was cancelled before it could close the gaps.
    has_gaps: bool,
    /// What a call that was stopped has left to the next one.
    pub(crate) unfinished: Option<Box<Unfinished>>,
    view: OnceLock<View>,
    outline: OnceLock<Outline>,
}

/// What bounds the mesh; which tetrahedra it encloses, their labels tell.
#[derive(Clone, Debug, Default)]
pub(crate) struct Domain {
    pub boundary: Boundary,
    /// The seeds of regions.
    pub regions: Vec<PlcRegion>,
}

#[derive(Clone, Debug, Default)]
struct View {
    tetrahedra: Vec<[u32; 4]>,
    neighbours: Vec<[u32; 4]>,
    regions: Vec<u32>,
}

/// Arrays of the mesh for reading. Vertices are numbered by id.
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a> {
    /// One point a vertex id; NaN for ids without a vertex, which removals leave.
    pub points: &'a [DVec3],
    /// Four vertex ids a tetrahedron, positively oriented: `det[b−a, c−a, d−a] > 0`. Those of the domain, or all without one.
    pub tetrahedra: &'a [[u32; 4]],
    /// The tetrahedron across the face opposite each vertex; `u32::MAX` where there is none in the view.
    pub neighbours: &'a [[u32; 4]],
    /// The region of each tetrahedron: 0 for none of the caller's regions, else 1 + its position in [`Plc::regions`].
    pub regions: &'a [u32],
}

impl Mesh {
    /// An empty mesh without a domain.
    pub fn new() -> Self {
        Self::default()
    }

    /// How many threads an insertion of many points, and the pass over Steiner points ([`Sparsify`](crate::Sparsify)), may use: 1 by default, 0 for as many as
    /// there are processors. The result is the same in every byte.
    pub fn set_threads(&mut self, threads: usize) {
        self.t.set_threads(threads);
    }

    /// The triangulation of the complex's points, with the complex as its domain.
    ///
    /// Segments and facets are recovered: they are split where they are missing from the Delaunay triangulation. (What vertices encroach upon waits for a
    /// refinement.) A complex of points alone has its hull as domain. [`Error::InvalidDomain`] names the element that makes the complex
    /// unusable, and tells when the facets enclose no volume; [`Error::Cancelled`] when the control cancels it.
    pub fn from_plc(plc: &Plc, control: &Control) -> Result<Mesh, Error> {
        Self::from_plc_on(1, plc, control)
    }

    /// As [`from_plc`](Self::from_plc), with [so many threads](Self::set_threads).
    pub fn from_plc_on(threads: usize, plc: &Plc, control: &Control) -> Result<Mesh, Error> {
        Self::from_plc_as(threads, plc, false, control)
    }

    /// As [`from_plc_on`](Self::from_plc_on), but no segment or facet is split: where one is missing from the Delaunay triangulation of the complex's points,
    /// [`Error::InvalidDomain`] names it. With [`RefineOptions::keep_boundary`] the boundary stays the one that was given.
    pub fn from_plc_kept(threads: usize, plc: &Plc, control: &Control) -> Result<Mesh, Error> {
        Self::from_plc_as(threads, plc, true, control)
    }

    fn from_plc_as(threads: usize, plc: &Plc, kept: bool, control: &Control) -> Result<Mesh, Error> {
        let parts = plc.arrange(control)?;
        let mut mesh = InPieces::new(Mesh::new(), control);
        mesh.set_threads(threads);
        let ids = mesh.t.insert_many(&plc.points, control)?.ok_or(Error::Cancelled)?;
        mesh.set_inputs();
        let whole =
            |problem: &str| Error::InvalidDomain { element: crate::DomainElement::Whole, problem: problem.into() };
        if plc.facets.is_empty() {
            if !plc.segments.is_empty() {
                return Err(whole("has segments but no facets that enclose a volume"));
            }
            mesh.use_hull_as_domain_within(control)?;
            return Ok(mesh.keep());
        }
        if mesh.t.dimension() < 3 {
            return Err(whole("its points lie in a plane and enclose no volume"));
        }
        let boundary = Boundary::from_plc(&mesh.t, plc, (&parts, &ids), control)?;
        if kept {
            if let Some(error) = mesh.missing(&boundary, "would have to be split", control)? {
                return Err(error);
            }
        }
        if mesh.set_boundary(boundary, &plc.holes, &plc.regions, control)? == RefineStatus::Cancelled {
            return Err(Error::Cancelled);
        }
        if let Some(boundary) = mesh.boundary().filter(|boundary| boundary.misses()) {
            if let Some(error) = mesh.missing(boundary, "can't be recovered by splits", control)? {
                return Err(error);
            }
        }
        let turns = control.turns();
        if mesh.t.topology.live().take_while(|_| turns.go_on()).all(|t| !mesh.t.is_inside(t)) {
            turns.end()?;
            return Err(whole("its facets enclose no volume"));
        }
        Ok(mesh.keep())
    }

    /// The error for a subsegment or subfacet that is missing, and what follows from it.
    fn missing(&self, boundary: &Boundary, what: &str, control: &Control) -> Result<Option<Error>, Error> {
        let Some(defect) = boundary.first_missing(&self.t, control)? else { return Ok(None) };
        let facet = match defect {
            Defect::MissingSubfacet { face } => boundary.facet_of(face),
            Defect::MissingSubsegment { edge } => boundary.facet_beside(edge),
            _ => None,
        };
        let element = facet.map_or(crate::DomainElement::Whole, crate::DomainElement::Facet);
        Ok(Some(Error::InvalidDomain { element, problem: format!("{what}: {defect}") }))
    }

    /// Makes the convex hull of the present points the domain: its coplanar facets are kept as facets, its other edges as segments.
    /// Below dimension 3 there is no hull, and nothing to refine.
    pub fn use_hull_as_domain(&mut self) -> Result<(), Error> {
        self.use_hull_as_domain_within(Control::never())
    }

    /// [`use_hull_as_domain`](Self::use_hull_as_domain) that a control can cancel: [`Error::Cancelled`], and nothing has changed.
    pub fn use_hull_as_domain_within(&mut self, control: &Control) -> Result<(), Error> {
        if self.domain.is_some() {
            return Err(Error::Domain { problem: "the mesh has a domain already" });
        }
        control.check()?;
        let mut boundary = InPieces::new(Boundary::default(), control);
        if self.t.dimension() == 3 {
            // The hull's facets are faces already: there is nothing to recover, only to label; encroached parts wait for the refinement.
            *boundary = Boundary::from_hull(&self.t, control)?;
            boundary.find_room(&self.t, control)?;
            boundary.enqueue_all(&self.t, control)?;
            boundary.label(&mut self.t, &[], &[], control)?;
        }
        // An id of an input vertex stays one.
        self.t.retire_free_ids();
        self.domain = Some(Domain { boundary: boundary.keep(), ..Domain::default() });
        self.give_view_back(control);
        Ok(())
    }

    fn set_boundary(
        &mut self,
        boundary: Boundary,
        holes: &[DVec3],
        regions: &[PlcRegion],
        control: &Control,
    ) -> Result<RefineStatus, Error> {
        let mut boundary = InPieces::new(boundary, control);
        let mut status = RefineStatus::Done;
        if self.t.dimension() == 3 {
            boundary.enqueue_missing(&self.t, control)?;
            // Angles near 0 may ask for splits without end, almost: then the element that is still missing is named.
            let elements = self.t.vertex_count() + boundary.element_count();
            let max_vertices = RECOVERY_ROOM + RECOVERY_FACTOR.saturating_mul(elements);
            let options = RefineOptions { max_vertices, ..RefineOptions::default() };
            status = Refiner::new(&mut self.t, &mut boundary, &options).recover(control)?;
            if status == RefineStatus::Cancelled {
                return Ok(status);
            }
            boundary.find_room(&self.t, control)?;
            boundary.enqueue_all(&self.t, control)?;
            boundary.label(&mut self.t, holes, regions, control)?;
        }
        self.domain = Some(Domain { boundary: boundary.keep(), regions: regions.to_vec() });
        self.give_view_back(control);
        Ok(status)
    }

    /// The triangulation.
    pub fn triangulation(&self) -> &Triangulation {
        &self.t
    }

    /// Whether a domain has been set.
    pub fn has_domain(&self) -> bool {
        self.domain.is_some()
    }

    /// The domain's boundary as it is split now.
    pub fn boundary(&self) -> Option<&Boundary> {
        self.domain.as_ref().map(|domain| &domain.boundary)
    }

    /// Number of vertices that are no Steiner points; they have the lowest ids, see
    /// [`input_vertex_slots`](Self::input_vertex_slots).
    pub fn input_vertex_count(&self) -> usize {
        if self.domain.is_some() {
            self.input_vertices
        } else {
            self.t.vertex_count()
        }
    }

    /// A vertex is a Steiner point if its id is not below this. That is the number of [input vertices](Self::input_vertex_count) unless some have
    /// been removed.
    pub fn input_vertex_slots(&self) -> usize {
        if self.domain.is_some() {
            self.input_slots
        } else {
            self.t.vertex_slots()
        }
    }

    fn set_inputs(&mut self) {
        self.input_vertices = self.t.vertex_count();
        self.input_slots = self.t.vertex_slots();
    }

    /// Inserts all points; `ids[i]` becomes the vertex of `points[i]`, for a duplicate that of the first one.
    ///
    /// All or nothing: after an error, or `Ok(false)` for a cancellation, the mesh is as it was. A mesh with a domain takes no further
    /// points except as Steiner batches: [`Error::Domain`].
    pub fn insert(&mut self, points: &[DVec3], ids: Option<&mut Vec<u32>>, control: &Control) -> Result<bool, Error> {
        if self.domain.is_some() {
            return Err(Error::Domain { problem: "points can't be inserted once the mesh has a domain" });
        }
        let Some(vertices) = self.t.insert_many(points, control)? else { return Ok(false) };
        self.give_view_back(control);
        self.set_inputs();
        if let Some(ids) = ids {
            *ids = vertices;
        }
        Ok(true)
    }

    /// Removes a vertex; the others keep their ids. A single point that is [inserted](Self::insert) later takes the id that was freed last.
    ///
    /// A mesh with a domain gives no vertex away: [`Error::Domain`]. Cost: see [`Triangulation::remove`].
    pub fn remove(&mut self, vertex: u32) -> Result<(), Error> {
        self.remove_within(vertex, Control::never())
    }

    /// [`remove`](Self::remove) that a control can cancel: [`Error::Cancelled`], and nothing has changed. See
    /// [`Triangulation::remove_within`].
    pub fn remove_within(&mut self, vertex: u32, control: &Control) -> Result<(), Error> {
        if self.domain.is_some() {
            return Err(Error::Domain { problem: "vertices can't be removed once the mesh has a domain" });
        }
        self.t.remove_within(vertex, control)?;
        self.input_vertices -= usize::from((vertex as usize) < self.input_slots);
        self.give_view_back(control);
        Ok(())
    }

    /// The two parts, to change them; a view must be forgotten with it.
    pub(crate) fn parts(&mut self) -> (&mut Triangulation, Option<&mut Boundary>) {
        (&mut self.t, self.domain.as_mut().map(|domain| &mut domain.boundary))
    }

    /// A copy, unless memory is lacking; [`Error::Cancelled`] when the control says stop. The view is not copied.
    pub fn try_clone(&self, control: &Control) -> Result<Mesh, Error> {
        let Mesh { input_vertices, input_slots, has_gaps, .. } = *self;
        let mut copy = InPieces::new(Mesh { input_vertices, input_slots, has_gaps, ..Mesh::default() }, control);
        copy.t = self.t.try_clone(control)?;
        if let Some(Domain { boundary, regions }) = &self.domain {
            copy.domain = Some(Domain { boundary: boundary.try_clone(control)?, regions: regions.clone() });
        }
        Ok(copy.keep())
    }

    /// Drops the arrays of the views, because what they show changes.
    pub(crate) fn forget_view(&mut self) {
        self.unfinished = None;
        self.view = OnceLock::new();
        self.outline = OnceLock::new();
    }

    /// [`forget_view`](Self::forget_view) within a call that can be cancelled.
    fn give_view_back(&mut self, control: &Control) {
        self.unfinished = None;
        if let Some(view) = self.view.take() {
            control.give_back(view);
        }
        if let Some(outline) = self.outline.take() {
            control.give_back(outline);
        }
    }

    /// The tetrahedra of the domain, or all without one, each with its region: as [`view`](Self::view) has them, for those who go through them once.
    pub fn elements(&self) -> impl Iterator<Item = ([u32; 4], u32)> + '_ {
        self.inside().map(|t| (self.t.topology.tet(t).v, self.region(t)))
    }

    /// The region of a tetrahedron in the domain, as a view has it.
    fn region(&self, t: u32) -> u32 {
        self.t.topology.region.get(t as usize).map_or(0, |&label| u32::from(label.saturating_sub(1)))
    }

    /// The tetrahedra of the domain.
    pub(crate) fn inside(&self) -> impl Iterator<Item = u32> + '_ {
        self.t.topology.finite().filter(|&t| self.t.is_inside(t))
    }

    /// Checks the invariants up to a level: 1 topology, 2 orientation, 3 the Delaunay property and that all subsegments and subfacets
    /// are edges and faces, facets consist of theirs, and regions meet at them only. Exact, linear time.
    pub fn validate(&self, level: u32) -> Result<(), Defect> {
        self.validate_within(level, Control::never()).map(|_| ())
    }

    /// [`validate`](Self::validate) that a control can follow and cancel: `Ok(false)` then.
    pub fn validate_within(&self, level: u32, control: &Control) -> Result<bool, Defect> {
        if !self.t.validate_within(level, control)? {
            return Ok(false);
        }
        match &self.domain {
            Some(domain) if level >= 3 && self.t.dimension() == 3 => {
                match domain.boundary.first_defect(&self.t, control) {
                    Ok(None) => Ok(true),
                    Ok(Some(defect)) => Err(defect),
                    Err(_) => Ok(false),
                }
            }
            _ => Ok(true),
        }
    }

    /// Checks that every tetrahedron of the domain keeps the radius-edge bound. Exact.
    pub fn validate_quality(&self, bound: f64) -> Result<(), Defect> {
        self.validate_quality_within(bound, Control::never()).map(|_| ())
    }

    /// [`validate_quality`](Self::validate_quality) that a control can cancel: `Ok(false)` then.
    pub fn validate_quality_within(&self, bound: f64, control: &Control) -> Result<bool, Defect> {
        let turns = control.turns();
        let bad = self.inside().find(|&t| !turns.go_on() || exceeds_radius_edge(self.t.corners(t), bound));
        match bad {
            _ if turns.end().is_err() => Ok(false),
            Some(t) => Err(Defect::BadTetrahedron { tetrahedron: self.t.topology.tet(t).v }),
            None => Ok(true),
        }
    }

    /// The mesh as arrays. They are made at the first call after a change, in linear time.
    pub fn view(&self) -> MeshView<'_> {
        match self.try_view(Control::never()) {
            Ok(view) => view,
            // As other lists of Rust do that find no memory.
            Err(_) => std::alloc::handle_alloc_error(std::alloc::Layout::new::<View>()),
        }
    }

    /// [`view`](Self::view), unless memory is lacking; [`Error::Cancelled`] when the control says stop.
    pub fn try_view(&self, control: &Control) -> Result<MeshView<'_>, Error> {
        let view = match self.view.get() {
            Some(view) => view,
            None => {
                let view = self.make_view(control)?;
                // Another thread may have been faster, with the same.
                self.view.get_or_init(|| view)
            }
        };
        Ok(MeshView {
            points: self.t.points(),
            tetrahedra: &view.tetrahedra,
            neighbours: &view.neighbours,
            regions: &view.regions,
        })
    }

    fn make_view(&self, control: &Control) -> Result<View, Error> {
        let topology = &self.t.topology;
        let (number, inside) = self.number_inside(control)?;
        let mut view = InPieces::new(View::default(), control);
        memory::reserve_exact(&mut view.tetrahedra, inside.len(), WHAT)?;
        memory::reserve_exact(&mut view.neighbours, inside.len(), WHAT)?;
        memory::reserve_exact(&mut view.regions, inside.len(), WHAT)?;
        for (i, block) in inside.chunks(BLOCK).enumerate() {
            let fraction = 0.5 + 0.5 * (i * BLOCK) as f64 / inside.len() as f64;
            if !control.report("view", fraction, self.t.vertex_count()) {
                return Err(Error::Cancelled);
            }
            view.tetrahedra.extend(block.iter().map(|&t| topology.tet(t).v));
            view.neighbours.extend(block.iter().map(|&t| topology.tet(t).n.map(|f| number[tet_of(f) as usize])));
            view.regions.extend(block.iter().map(|&t| self.region(t)));
        }
        Ok(view.keep())
    }

    /// By place of each tetrahedron its number in the view, `u32::MAX` for those that are not shown; and the places of those that are, in order.
    fn number_inside<'a>(&self, control: &'a Control) -> Result<(Numbers<'a>, Numbers<'a>), Error> {
        let topology = &self.t.topology;
        let mut number = memory::room_in_pieces(topology.tets.len(), WHAT, control)?;
        let mut inside = memory::room_in_pieces::<u32>(topology.finite_count(), WHAT, control)?;
        for t in 0..topology.tets.len() as u32 {
            if t as usize % BLOCK == 0 {
                if !control.report("view", 0.5 * f64::from(t) / topology.tets.len() as f64, self.t.vertex_count()) {
                    return Err(Error::Cancelled);
                }
                memory::reserve(&mut inside, BLOCK, WHAT)?;
            }
            let tet = topology.tet(t);
            let shown = tet.is_live() && !tet.is_ghost() && self.t.is_inside(t);
            number.push(if shown { inside.len() as u32 } else { u32::MAX });
            if shown {
                inside.push(t);
            }
        }
        Ok((number, inside))
    }
}

impl Leavings for View {
    fn give_back(&mut self) -> bool {
        self.tetrahedra.give_back() || self.neighbours.give_back() || self.regions.give_back()
    }
}

impl Leavings for Mesh {
    fn give_back(&mut self) -> bool {
        self.view.get_mut().is_some_and(Leavings::give_back)
            || self.outline.get_mut().is_some_and(Leavings::give_back)
            || self.t.give_back()
            || self.domain.as_mut().is_some_and(|domain| domain.boundary.give_back())
    }
}
