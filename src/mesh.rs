//! A triangulation together with its domain: what most callers hold, and what the C handle wraps.

use std::sync::OnceLock;

use glam::DVec3;

use crate::domain::plc::{Plc, PlcRegion};
use crate::domain::Boundary;
use crate::geometry::quality::{
    exceeds_radius_edge, four_exceed_radius_edge, four_may_exceed, may_be_narrower, min_dihedral_degrees, radius_edge,
};
use crate::refine::queue::shortest_edge;
use crate::refine::refiner::Refiner;
use crate::sparsify::{Sparsifier, Sparsify};
use crate::triangulation::topology::tet_of;
use crate::triangulation::Defect;
use crate::{Control, Error, RefineOptions, RefineReport, RefineStatus, Triangulation};

/// A Delaunay triangulation and, once one is set, the domain that it fills.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub(crate) t: Triangulation,
    pub(crate) domain: Option<Domain>,
    /// Vertices that are no Steiner points.
    input_vertices: usize,
    /// Their ids are below this, and no others are.
    input_slots: usize,
    view: OnceLock<View>,
}

/// What bounds the mesh; which tetrahedra it encloses, their labels tell.
#[derive(Clone, Debug, Default)]
pub(crate) struct Domain {
    pub boundary: Boundary,
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

    /// How many threads an insertion of many points may use: 1 by default, 0 for as many as there are processors. The result is the
    /// same in every byte.
    pub fn set_threads(&mut self, threads: usize) {
        self.t.set_threads(threads);
    }

    /// The triangulation of the complex's points, with the complex as its domain.
    ///
    /// Segments and facets are recovered: Steiner points are added where they are missing from the Delaunay triangulation. What is
    /// encroached waits for the refinement. A complex of points alone has its hull as domain. [`Error::InvalidDomain`] names the element that makes the complex
    /// unusable, and tells when the facets enclose no volume; [`Error::Cancelled`] when the control cancels it.
    pub fn from_plc(plc: &Plc, control: &Control) -> Result<Mesh, Error> {
        Self::from_plc_on(1, plc, control)
    }

    /// As [`from_plc`](Self::from_plc), with [so many threads](Self::set_threads).
    pub fn from_plc_on(threads: usize, plc: &Plc, control: &Control) -> Result<Mesh, Error> {
        plc.check_references()?;
        let mut mesh = Mesh::new();
        mesh.set_threads(threads);
        let ids = mesh.t.insert_many(&plc.points, control)?.ok_or(Error::Cancelled)?;
        mesh.set_inputs();
        let whole =
            |problem: &str| Error::InvalidDomain { element: crate::DomainElement::Whole, problem: problem.into() };
        if plc.facets.is_empty() {
            if !plc.segments.is_empty() {
                return Err(whole("has segments but no facets that enclose a volume"));
            }
            mesh.use_hull_as_domain()?;
            return Ok(mesh);
        }
        if mesh.t.dimension() < 3 {
            return Err(whole("its points lie in a plane and enclose no volume"));
        }
        let boundary = Boundary::from_plc(&mesh.t, plc, &ids)?;
        if mesh.set_boundary(boundary, &plc.holes, &plc.regions, control)? == RefineStatus::Cancelled {
            return Err(Error::Cancelled);
        }
        if let Some(error) = mesh.unrecovered() {
            return Err(error);
        }
        if mesh.inside().next().is_none() {
            return Err(whole("its facets enclose no volume"));
        }
        Ok(mesh)
    }

    /// The error for a subsegment or subfacet that recovery had to leave missing.
    fn unrecovered(&self) -> Option<Error> {
        let boundary = self.boundary()?;
        let defect = boundary.first_missing(&self.t)?;
        let element = match defect {
            Defect::MissingSubfacet { face } => boundary.facet_of(face).map(crate::DomainElement::Facet),
            _ => None,
        };
        let element = element.unwrap_or(crate::DomainElement::Whole);
        Some(Error::InvalidDomain { element, problem: format!("can't be recovered by splits: {defect}") })
    }

    /// Makes the convex hull of the present points the domain: its coplanar facets are kept as facets, its other edges as segments.
    /// Below dimension 3 there is no hull, and nothing to refine.
    pub fn use_hull_as_domain(&mut self) -> Result<(), Error> {
        if self.domain.is_some() {
            return Err(Error::Domain { problem: "the mesh has a domain already" });
        }
        let boundary = if self.t.dimension() == 3 { Boundary::from_hull(&self.t) } else { Boundary::default() };
        // The hull's facets are faces already: there is nothing to recover, only to label; encroached parts wait for the refinement.
        self.forget_view();
        // An id of an input vertex stays one.
        self.t.retire_free_ids();
        let mut domain = Domain { boundary };
        if self.t.dimension() == 3 {
            domain.boundary.enqueue_all(&self.t);
            domain.boundary.label(&mut self.t, &[], &[]);
        }
        self.domain = Some(domain);
        Ok(())
    }

    fn set_boundary(
        &mut self,
        mut boundary: Boundary,
        holes: &[DVec3],
        regions: &[PlcRegion],
        control: &Control,
    ) -> Result<RefineStatus, Error> {
        let mut status = RefineStatus::Done;
        if self.t.dimension() == 3 {
            boundary.be_tolerant(&self.t);
            status = Refiner::new(&mut self.t, &mut boundary, &RefineOptions::default()).recover(control)?;
            boundary.label(&mut self.t, holes, regions);
            boundary.be_strict(&self.t);
        }
        self.forget_view();
        self.domain = Some(Domain { boundary });
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
        self.forget_view();
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
        if self.domain.is_some() {
            return Err(Error::Domain { problem: "vertices can't be removed once the mesh has a domain" });
        }
        self.t.remove(vertex)?;
        self.input_vertices -= usize::from((vertex as usize) < self.input_slots);
        self.forget_view();
        Ok(())
    }

    /// Refines until every tetrahedron of the domain keeps the bound, or a limit says stop. Without a domain the hull becomes it.
    ///
    /// Cost: near-linear in the vertices of the result.
    pub fn refine(&mut self, options: &RefineOptions, control: &Control) -> Result<RefineReport, Error> {
        options.check()?;
        if self.domain.is_none() {
            self.use_hull_as_domain()?;
        }
        self.forget_view();
        let (mut counts, mut taken) = ([0; 3], [0; 2]);
        let mut status = RefineStatus::Done;
        if let (3, Some(domain)) = (self.t.dimension(), &mut self.domain) {
            let mut refiner = Refiner::new(&mut self.t, &mut domain.boundary, options);
            let level = options.sparsify();
            if level != Sparsify::Off {
                let first = self.input_slots as u32;
                refiner.sparsifier = Some(Sparsifier::new(level, options.radius_edge, refiner.min_edge, first));
            }
            let result = refiner.refine(control);
            counts = [refiner.samples, refiner.segment_splits, refiner.facet_splits];
            let sparsifier = refiner.sparsifier.take();
            status = self.thin_out(sparsifier, result, control, &mut taken)?;
        }
        let mut report = self.report(options.radius_edge, status);
        let waits =
            |boundary: &Boundary| boundary.next_pending_segment().is_some() || boundary.next_pending_facet().is_some();
        let left = report.bad > 0 || self.boundary().is_some_and(waits);
        if !left && report.status != RefineStatus::Cancelled {
            // A limit was met with nothing left to do, or what was refused has been mended on the way.
            report.status = RefineStatus::Done;
        }
        [report.samples, report.segment_splits, report.facet_splits] = counts;
        [report.removed, report.replaced] = taken;
        Ok(report)
    }

    /// What follows a refinement that ended like this: the sparsifier's last pass, and the closing of the gaps that it has made among the
    /// Steiner points' ids, which comes even after an error.
    fn thin_out(
        &mut self,
        sparsifier: Option<Sparsifier>,
        result: Result<RefineStatus, Error>,
        control: &Control,
        taken: &mut [usize; 2],
    ) -> Result<RefineStatus, Error> {
        let (Some(mut sparsifier), Some(domain)) = (sparsifier, &mut self.domain) else { return result };
        let result = match result {
            Ok(status @ (RefineStatus::Done | RefineStatus::Unrefined)) if sparsifier.has_pass() => {
                let finished = sparsifier.run(&mut self.t, &mut domain.boundary, control);
                finished.map(|finished| if finished { status } else { RefineStatus::Cancelled })
            }
            other => other,
        };
        *taken = [sparsifier.removed, sparsifier.replaced];
        if sparsifier.removed + sparsifier.replaced > 0 {
            let new_id = self.t.compact_from(self.input_slots as u32);
            domain.boundary.renumber(&new_id);
        }
        result
    }

    /// Takes Steiner points away, or puts one in the place of two, wherever every tetrahedron that comes keeps the bound: see
    /// [`sparsify`](crate::sparsify). Input vertices stay, segments and facets stay covered, and nothing becomes bad. Steiner points that are left
    /// get new ids, in their order, behind the input's.
    ///
    /// For a mesh that is refined already, by this library or another: the points inserted after
    /// [`use_hull_as_domain`](Self::use_hull_as_domain), or after [`from_plc`](Self::from_plc), are its Steiner points. Refining with
    /// [`RefineOptions::sparsify`] leaves fewer, as points are taken away while that is still easy.
    ///
    /// Cost: some tens of microseconds a Steiner point.
    pub fn sparsify(&mut self, radius_edge: f64, level: Sparsify, control: &Control) -> Result<RefineReport, Error> {
        crate::refine::check_radius_edge(radius_edge)?;
        if self.domain.is_none() {
            self.use_hull_as_domain()?;
        }
        self.forget_view();
        let (mut taken, mut status) = ([0; 2], RefineStatus::Done);
        if self.t.dimension() == 3 && level.has_pass() {
            let mut sparsifier = Sparsifier::new(level, radius_edge, 0.0, self.input_slots as u32);
            sparsifier.begin_with_all();
            status = self.thin_out(Some(sparsifier), Ok(RefineStatus::Done), control, &mut taken)?;
        }
        let mut report = self.report(radius_edge, status);
        if report.bad > 0 && status == RefineStatus::Done {
            report.status = RefineStatus::Unrefined;
        }
        [report.removed, report.replaced] = taken;
        Ok(report)
    }

    /// The mesh's sizes and quality now.
    pub fn report(&self, bound: f64, status: RefineStatus) -> RefineReport {
        let mut report = RefineReport {
            status,
            input_vertices: self.input_vertex_count(),
            vertices: self.t.vertex_count(),
            tetrahedra: 0,
            steiner: self.t.vertex_count() - self.input_vertex_count(),
            samples: 0,
            segment_splits: 0,
            facet_splits: 0,
            removed: 0,
            replaced: 0,
            bad: 0,
            bad_at_small_angles: 0,
            worst_radius_edge: 0.0,
            min_dihedral_degrees: 180.0,
        };
        // Four at a time; few of them can be the worst so far.
        let mut inside = self.inside();
        let mut cotangent = f64::NEG_INFINITY;
        loop {
            let (mut four, mut count) = ([0; 4], 0);
            for (place, tet) in four.iter_mut().zip(&mut inside) {
                *place = tet;
                count += 1;
            }
            if count == 0 {
                return report;
            }
            let last = four[count - 1];
            four[count..].fill(last);
            report.tetrahedra += count;
            let corners = four.map(|tet| self.t.corner_refs(tet));
            let bad = four_exceed_radius_edge(&corners, bound).0;
            let worse = four_may_exceed(&corners, report.worst_radius_edge);
            for (i, &tet) in four.iter().enumerate().take(count) {
                let corners = corners[i].map(|&p| p);
                if bad >> i & 1 != 0 {
                    report.bad += 1;
                    report.bad_at_small_angles += usize::from(self.is_at_small_angle(tet));
                }
                if worse >> i & 1 != 0 {
                    report.worst_radius_edge = report.worst_radius_edge.max(radius_edge(corners));
                }
                if may_be_narrower(corners, cotangent) {
                    report.min_dihedral_degrees = report.min_dihedral_degrees.min(min_dihedral_degrees(corners));
                    cotangent = report.min_dihedral_degrees.to_radians().tan().recip();
                }
            }
        }
    }

    /// Whether a tetrahedron's shortest edge spans an acute input angle.
    fn is_at_small_angle(&self, tet: u32) -> bool {
        let ([i, j], _) = shortest_edge(&self.t, tet);
        let v = self.t.topology.tet(tet).v;
        self.boundary().is_some_and(|boundary| boundary.is_seditious(&self.t, [v[i], v[j]]))
    }

    /// The two parts, to change them; a view must be forgotten with it.
    pub(crate) fn parts(&mut self) -> (&mut Triangulation, Option<&mut Boundary>) {
        (&mut self.t, self.domain.as_mut().map(|domain| &mut domain.boundary))
    }

    /// Drops the arrays of the view, because what they show changes.
    pub(crate) fn forget_view(&mut self) {
        self.view = OnceLock::new();
    }

    /// The tetrahedra of the domain.
    pub(crate) fn inside(&self) -> impl Iterator<Item = u32> + '_ {
        self.t.topology.finite().filter(|&t| self.t.is_inside(t))
    }

    /// Checks the invariants up to a level: 1 topology, 2 orientation, 3 the Delaunay property and that all subsegments and subfacets
    /// are edges and faces. Exact, linear time.
    pub fn validate(&self, level: u32) -> Result<(), Defect> {
        self.t.validate(level)?;
        match &self.domain {
            Some(domain) if level >= 3 && self.t.dimension() == 3 => {
                domain.boundary.first_missing(&self.t).map_or(Ok(()), Err)
            }
            _ => Ok(()),
        }
    }

    /// Checks that every tetrahedron of the domain keeps the radius-edge bound. Exact.
    pub fn validate_quality(&self, bound: f64) -> Result<(), Defect> {
        match self.inside().find(|&t| exceeds_radius_edge(self.t.corners(t), bound)) {
            Some(t) => Err(Defect::BadTetrahedron { tetrahedron: self.t.topology.tet(t).v }),
            None => Ok(()),
        }
    }

    /// The mesh as arrays. They are made at the first call after a change, in linear time.
    pub fn view(&self) -> MeshView<'_> {
        let view = self.view.get_or_init(|| self.make_view());
        MeshView {
            points: self.t.points(),
            tetrahedra: &view.tetrahedra,
            neighbours: &view.neighbours,
            regions: &view.regions,
        }
    }

    fn make_view(&self) -> View {
        let topology = &self.t.topology;
        let mut number = vec![u32::MAX; topology.tets.len()];
        let inside: Vec<u32> = self.inside().collect();
        for (i, &t) in inside.iter().enumerate() {
            number[t as usize] = i as u32;
        }
        let region = |&t: &u32| topology.region.get(t as usize).map_or(0, |&label| u32::from(label.saturating_sub(1)));
        View {
            tetrahedra: inside.iter().map(|&t| topology.tet(t).v).collect(),
            neighbours: inside.iter().map(|&t| topology.tet(t).n.map(|f| number[tet_of(f) as usize])).collect(),
            regions: inside.iter().map(region).collect(),
        }
    }
}
