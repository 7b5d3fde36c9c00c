//! A triangulation together with its domain: what most callers hold, and what the C handle wraps.

use std::sync::OnceLock;

use glam::DVec3;

use crate::domain::plc::{Plc, PlcRegion};
use crate::domain::Boundary;
use crate::geometry::extremes::Extremes;
use crate::geometry::quality::{exceeds_radius_edge, four_exceed_radius_edge, in_fours};
use crate::leavings::{InPieces, Leavings};
use crate::parted::PartedMap;
use crate::refine::limits::Limits;
use crate::refine::queue::shortest_edge;
use crate::refine::refiner::Refiner;
use crate::refine::sizing::{Sizes, Sizing};
use crate::refine::Unrefined;
use crate::sparsify::{Sparsifier, Sparsify};
use crate::triangulation::topology::tet_of;
use crate::triangulation::Defect;
use crate::{memory, Control, Error, LogLevel, RefineOptions, RefineReport, RefineStatus, Triangulation};

/// Why tetrahedra were left as they are, by their vertices.
type Reasons = PartedMap<[u32; 4], Unrefined>;

/// Recovery may make so many vertices in any case, and so many more for each vertex and element.
const RECOVERY_ROOM: usize = 100_000;
const RECOVERY_FACTOR: usize = 100;

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
    view: OnceLock<View>,
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

    /// How many threads an insertion of many points may use: 1 by default, 0 for as many as there are processors. The result is the
    /// same in every byte.
    pub fn set_threads(&mut self, threads: usize) {
        self.t.set_threads(threads);
    }

    /// The triangulation of the complex's points, with the complex as its domain.
    ///
    /// Segments and facets are recovered: Steiner points are added where they are missing from the Delaunay triangulation, or
    /// encroached. A complex of points alone has its hull as domain. [`Error::InvalidDomain`] names the element that makes the complex
    /// unusable, and tells when the facets enclose no volume; [`Error::Cancelled`] when the control cancels it.
    pub fn from_plc(plc: &Plc, control: &Control) -> Result<Mesh, Error> {
        Self::from_plc_on(1, plc, control)
    }

    /// As [`from_plc`](Self::from_plc), with [so many threads](Self::set_threads).
    pub fn from_plc_on(threads: usize, plc: &Plc, control: &Control) -> Result<Mesh, Error> {
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
        if mesh.set_boundary(boundary, &plc.holes, &plc.regions, control)? == RefineStatus::Cancelled {
            return Err(Error::Cancelled);
        }
        if let Some(error) = mesh.unrecovered(control)? {
            return Err(error);
        }
        if mesh.inside().next().is_none() {
            return Err(whole("its facets enclose no volume"));
        }
        Ok(mesh.keep())
    }

    /// The error for a subsegment or subfacet that recovery had to leave missing.
    fn unrecovered(&self, control: &Control) -> Result<Option<Error>, Error> {
        let Some(boundary) = self.boundary() else { return Ok(None) };
        let Some(defect) = boundary.first_missing(&self.t, control)? else { return Ok(None) };
        let element = match defect {
            Defect::MissingSubfacet { face } => boundary.facet_of(face).map(crate::DomainElement::Facet),
            _ => None,
        };
        let element = element.unwrap_or(crate::DomainElement::Whole);
        Ok(Some(Error::InvalidDomain { element, problem: format!("can't be recovered by splits: {defect}") }))
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
            boundary.enqueue_all(&self.t, control)?;
            boundary.pending_segments.clear();
            boundary.pending_facets.clear();
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

    /// Refines until every tetrahedron of the domain keeps the bound, or a limit says stop. Without a domain the hull becomes it.
    ///
    /// Cost: near-linear in the vertices of the result.
    pub fn refine(&mut self, options: &RefineOptions, control: &Control) -> Result<RefineReport, Error> {
        self.refine_sized(options, &Sizing::default(), control)
    }

    /// [`refine`](Self::refine), with sizes that tetrahedra must not exceed. The largest volumes of the complex's regions are such sizes too,
    /// and are kept without being asked for here.
    pub fn refine_sized(
        &mut self,
        options: &RefineOptions,
        sizing: &Sizing,
        control: &Control,
    ) -> Result<RefineReport, Error> {
        options.check()?;
        control.log(LogLevel::Info, || {
            let RefineOptions { radius_edge, rule, .. } = options;
            format!("refine: {} vertices, radius-edge bound {radius_edge}, rule {rule:?}", self.t.vertex_count())
        });
        if !self.begin_changes(control)? {
            return Ok(self.unmeasured(RefineStatus::Cancelled));
        }
        let (mut counts, mut taken) = ([0; 3], [0; 2]);
        let mut reasons = Reasons::default();
        let (mut at_vertices, mut volumes) = (None, Vec::new());
        let mut status = RefineStatus::Done;
        if let (3, Some(domain)) = (self.t.dimension(), &mut self.domain) {
            domain.boundary.kept = options.keep_boundary;
            volumes = domain.regions.iter().map(|region| region.max_volume).collect();
            let asked = Sizes::new(*sizing, &volumes);
            let mut refiner = Refiner::new(&mut self.t, &mut domain.boundary, options);
            // The sparsifier knows of no sizes: it would take away what they ask for.
            let level = if asked.is_empty() { options.sparsify() } else { Sparsify::Off };
            refiner.sizes = (!asked.is_empty()).then_some(asked);
            if level != Sparsify::Off {
                let first = self.input_slots as u32;
                refiner.sparsifier = Some(Sparsifier::new(level, options.radius_edge, refiner.min_edge, first));
            }
            let mut limits = refiner.limits;
            let result = refiner.refine(control);
            refiner.give_back_to(control);
            at_vertices = refiner.sizes.take().map(Sizes::into_vertices);
            counts = [refiner.samples, refiner.segment_splits, refiner.facet_splits];
            reasons = std::mem::take(&mut refiner.reasons);
            let sparsifier = refiner.sparsifier.take();
            let thinned = self.thin_out(sparsifier, result, (control, &mut limits), &mut taken, &mut reasons);
            if let Some(domain) = &mut self.domain {
                domain.boundary.kept = false;
            }
            status = thinned?;
        }
        let mut report = self.report_unless_cancelled(options.radius_edge, status, &reasons, control);
        if let Some(at_vertices) = at_vertices.filter(|_| report.status != RefineStatus::Cancelled) {
            let mut sizes = Sizes::new(*sizing, &volumes).with_vertices(at_vertices);
            match self.count_too_large(&mut sizes, control) {
                Ok(count) => report.too_large = count,
                Err(_) => report = self.unmeasured(RefineStatus::Cancelled),
            }
        }
        tell(control, report.status, self.t.vertex_count());
        let waits =
            |boundary: &Boundary| boundary.next_pending_segment().is_some() || boundary.next_pending_facet().is_some();
        let left = report.bad > 0 || report.too_large > 0 || self.boundary().is_some_and(waits);
        let others = matches!(report.status, RefineStatus::VertexLimit | RefineStatus::Unrefined);
        if !left && others {
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
        (control, limits): (&Control, &mut Limits),
        taken: &mut [usize; 2],
        reasons: &mut Reasons,
    ) -> Result<RefineStatus, Error> {
        let (Some(mut sparsifier), Some(domain)) = (sparsifier, &mut self.domain) else { return result };
        let result = match result {
            Ok(status @ (RefineStatus::Done | RefineStatus::Unrefined)) if sparsifier.has_pass() => {
                let stopped = sparsifier.run(&mut self.t, &mut domain.boundary, control, limits);
                stopped.map(|stopped| stopped.unwrap_or(status))
            }
            other => other,
        };
        *taken = [sparsifier.removed, sparsifier.replaced];
        self.has_gaps |= sparsifier.removed + sparsifier.replaced > 0;
        let has_pass = sparsifier.has_pass();
        // After a cancellation the gaps stay for the next call: closing them takes a while.
        sparsifier.give_back(control);
        if !self.has_gaps || matches!(result, Ok(RefineStatus::Cancelled)) || !has_pass && self.fill_gaps(reasons) {
            return result;
        }
        match self.close_gaps(reasons, control) {
            Ok(()) => result,
            Err(Error::Cancelled) => Ok(RefineStatus::Cancelled),
            Err(error) => Err(error),
        }
    }

    /// Puts the last Steiner points into the gaps among the others' ids. Returns whether none is left: it is for a few gaps, and does nothing with what is on the boundary,
    /// which knows its vertices by id. Where points only move, at most one or two gaps are ever left, and all else is in order.
    fn fill_gaps(&mut self, reasons: &mut Reasons) -> bool {
        let (first, Some(domain)) = (self.input_slots as u32, &self.domain) else { return false };
        let is_free = |v: u32| domain.boundary.kind(v) == 0;
        let Some(moved) = self.t.fill_gaps(first, is_free) else { return false };
        let renamed = |v: u32| moved.iter().find(|&&(old, _)| old == v).map_or(v, |&(_, new)| new);
        if !moved.is_empty() {
            let mut names = Reasons::default();
            reasons.iter().for_each(|(v, &reason)| _ = names.insert(v.map(renamed), reason));
            *reasons = names;
        }
        self.has_gaps = false;
        true
    }

    /// Gives Steiner points ids without gaps. Nothing has changed after an error.
    fn close_gaps(&mut self, reasons: &mut Reasons, control: &Control) -> Result<(), Error> {
        let Some(domain) = &mut self.domain else { return Ok(()) };
        let mut boundary = InPieces::new(domain.boundary.try_clone(control)?, control);
        let (t, new_id) = self.t.compacted(self.input_slots as u32, control)?;
        let mut t = InPieces::new(t, control);
        boundary.renumber(&new_id, control)?;
        let renamed = |v: u32| new_id.get(v as usize).copied().unwrap_or(v);
        let turns = control.turns();
        let mut names = Reasons::default();
        for (v, &reason) in reasons.iter() {
            turns.check()?;
            names.insert(v.map(renamed), reason);
        }
        // What was there before is given back as these go.
        std::mem::swap(&mut *t, &mut self.t);
        std::mem::swap(&mut *boundary, &mut domain.boundary);
        (*reasons, self.has_gaps) = (names, false);
        Ok(())
    }

    /// What comes before changes of a mesh with a domain: the hull becomes the domain if there is none, and the view is given back. False when
    /// cancelled.
    fn begin_changes(&mut self, control: &Control) -> Result<bool, Error> {
        if self.domain.is_none() {
            match self.use_hull_as_domain_within(control) {
                Err(Error::Cancelled) => return Ok(false),
                other => other?,
            }
        }
        self.give_view_back(control);
        Ok(control.poll())
    }

    /// How many tetrahedra are larger than was asked for.
    fn count_too_large(&self, sizes: &mut Sizes<'_>, control: &Control) -> Result<usize, Error> {
        const PART: usize = 1 << 12;
        let (mut some, mut count) = (Vec::with_capacity(PART), 0);
        let mut inside = self.inside();
        loop {
            control.check()?;
            some.clear();
            some.extend(inside.by_ref().take(PART));
            if some.is_empty() {
                return Ok(count);
            }
            count += sizes.too_large(&self.t, &some).len();
        }
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
        if !self.begin_changes(control)? {
            return Ok(self.unmeasured(RefineStatus::Cancelled));
        }
        let (mut taken, mut status) = ([0; 2], RefineStatus::Done);
        if self.t.dimension() == 3 && level.has_pass() {
            let mut sparsifier = Sparsifier::new(level, radius_edge, 0.0, self.input_slots as u32);
            sparsifier.begin_with_all();
            let limits = &mut Limits::default();
            let result = Ok(RefineStatus::Done);
            status = self.thin_out(Some(sparsifier), result, (control, limits), &mut taken, &mut Reasons::default())?;
        }
        let mut report = self.report_unless_cancelled(radius_edge, status, &Reasons::default(), control);
        if report.bad > 0 && status == RefineStatus::Done {
            report.status = RefineStatus::Unrefined;
        }
        [report.removed, report.replaced] = taken;
        Ok(report)
    }

    /// [`report`](Self::report) with the reasons for which tetrahedra were left, without a look at all of them after a cancellation: it shall be quick.
    fn report_unless_cancelled(
        &self,
        bound: f64,
        status: RefineStatus,
        reasons: &Reasons,
        control: &Control,
    ) -> RefineReport {
        let report = if status == RefineStatus::Cancelled {
            Err(Error::Cancelled)
        } else {
            self.report_within(bound, status, reasons, control)
        };
        report.unwrap_or_else(|_| self.unmeasured(RefineStatus::Cancelled))
    }

    /// The mesh's sizes and quality now.
    pub fn report(&self, bound: f64, status: RefineStatus) -> RefineReport {
        let report = self.report_within(bound, status, &Reasons::default(), Control::never());
        report.unwrap_or_else(|_| self.unmeasured(status))
    }

    /// A report without a look at the tetrahedra.
    fn unmeasured(&self, status: RefineStatus) -> RefineReport {
        RefineReport {
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
            unrefined: [0; Unrefined::ALL.len()],
            too_large: 0,
            worst_radius_edge: f64::NAN,
            min_dihedral_degrees: f64::NAN,
            measured: false,
        }
    }

    fn report_within(
        &self,
        bound: f64,
        status: RefineStatus,
        reasons: &Reasons,
        control: &Control,
    ) -> Result<RefineReport, Error> {
        let mut report = RefineReport {
            worst_radius_edge: 0.0,
            min_dihedral_degrees: 180.0,
            measured: true,
            ..self.unmeasured(status)
        };
        let turns = control.turns();
        let mut extremes = Extremes::default();
        for (four, count) in in_fours(self.inside()) {
            turns.check()?;
            report.tetrahedra += count;
            let corners = four.map(|tet| self.t.corner_refs(tet));
            let keeps = extremes.radius_edge <= bound;
            if extremes.add(&corners) == 0 && keeps {
                continue;
            }
            let bad = four_exceed_radius_edge(&corners, bound).0;
            for (_, &tet) in four[..count].iter().enumerate().filter(|(i, _)| bad >> i & 1 != 0) {
                report.bad += 1;
                let known = reasons.get(&self.t.topology.tet(tet).v).copied();
                let reason = match known {
                    _ if self.is_at_small_angle(tet) => Unrefined::SmallAngle,
                    Some(reason) => reason,
                    None => Unrefined::Limit,
                };
                report.unrefined[reason as usize] += 1;
            }
        }
        report.worst_radius_edge = extremes.radius_edge;
        report.min_dihedral_degrees = extremes.dihedral_degrees;
        Ok(report)
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

    /// Drops the arrays of the view, because what they show changes.
    pub(crate) fn forget_view(&mut self) {
        self.view = OnceLock::new();
    }

    /// [`forget_view`](Self::forget_view) within a call that can be cancelled.
    fn give_view_back(&mut self, control: &Control) {
        if let Some(view) = self.view.take() {
            control.give_back(view);
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
        /// Tetrahedra between two looks at the control.
        const BLOCK: usize = 1 << 14;
        const WHAT: &str = "view";
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
}

impl Leavings for View {
    fn give_back(&mut self) -> bool {
        self.tetrahedra.give_back() || self.neighbours.give_back() || self.regions.give_back()
    }
}

impl Leavings for Mesh {
    fn give_back(&mut self) -> bool {
        self.view.get_mut().is_some_and(Leavings::give_back)
            || self.t.give_back()
            || self.domain.as_mut().is_some_and(|domain| domain.boundary.give_back())
    }
}

/// Tells the log how a refinement has ended.
fn tell(control: &Control, status: RefineStatus, vertices: usize) {
    let (level, how) = match status {
        RefineStatus::Done => (LogLevel::Info, "done"),
        RefineStatus::Cancelled => (LogLevel::Info, "cancelled"),
        RefineStatus::VertexLimit => (LogLevel::Warning, "stopped at the limit of vertices"),
        RefineStatus::TimeLimit => (LogLevel::Warning, "stopped at the limit of seconds"),
        RefineStatus::MemoryLimit => (LogLevel::Warning, "stopped at the limit of memory"),
        RefineStatus::Unrefined => (LogLevel::Warning, "some tetrahedra can't be mended"),
    };
    control.log(level, || format!("refine: {how}, {vertices} vertices"));
}
