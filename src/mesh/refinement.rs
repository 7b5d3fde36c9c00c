//! The refinement of a mesh as one call: what comes before it, the sparsifier's last pass and the closing of gaps after it, and the report.

use super::Mesh;
use crate::domain::Boundary;
use crate::geometry::extremes::Extremes;
use crate::geometry::quality::{four_exceed_radius_edge, in_fours};
use crate::leavings::InPieces;
use crate::parted::PartedMap;
use crate::refine::limits::Limits;
use crate::refine::queue::shortest_edge;
use crate::refine::refiner::Refiner;
use crate::refine::sizing::{Sizes, Sizing};
use crate::refine::Unrefined;
use crate::sparsify::{Sparsifier, Sparsify};
use crate::{Control, Error, LogLevel, RefineOptions, RefineReport, RefineStatus};

/// Why tetrahedra were left as they are, by their vertices.
type Reasons = PartedMap<[u32; 4], Unrefined>;

/// What a call was asked for, but for seconds and bytes.
#[derive(Clone, Debug, PartialEq)]
struct Task {
    /// None for a pass of the sparsifier alone.
    options: Option<RefineOptions>,
    radius_edge: f64,
    level: Sparsify,
}

impl Task {
    fn refine(options: &RefineOptions, level: Sparsify) -> Task {
        let unlimited = RefineOptions { max_seconds: 0.0, max_memory: 0, ..options.clone() };
        Task { options: Some(unlimited), radius_edge: options.radius_edge, level }
    }
}

/// A pass of the sparsifier that was stopped: the status of the refinement before it, and the vertices that it has still to try, `None` for all.
type Pass = (RefineStatus, Option<Vec<u32>>);

/// What a call that was stopped has left to the next one for the same task, with nothing changed between them. Without it each call would try again
/// what the one before has tried in vain, and, where each is stopped early, none would come to the end.
#[derive(Clone, Debug)]
pub(crate) struct Unfinished {
    task: Task,
    reasons: Reasons,
    /// Where only the sparsifier's pass was left.
    pass: Option<Pass>,
}

impl Mesh {
    /// Refines until every tetrahedron of the domain keeps the bound, or a limit says stop. Without a domain the hull becomes it.
    ///
    /// A call that was cancelled or whose seconds were over can be repeated to go on. With the same options but for seconds and bytes, no sizes, and nothing
    /// changed between the calls, it tries nothing again that the other one has tried in vain. So calls that are stopped each time come to the end,
    /// too, if each may run until it has done something: it begins with a look at all tetrahedra, and the first report of progress may come before
    /// anything is done. The second comes after that.
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
        let unfinished = self.unfinished.take();
        if !self.begin_changes(control)? {
            self.unfinished = unfinished;
            return Ok(self.unmeasured(RefineStatus::Cancelled));
        }
        let (mut task, mut pass) = (None, None);
        let (mut counts, mut taken) = ([0; 3], [0; 2]);
        let mut reasons = Reasons::default();
        let (mut at_vertices, mut volumes) = (None, Vec::new());
        let mut status = RefineStatus::Done;
        if let (3, Some(domain)) = (self.t.dimension(), &mut self.domain) {
            volumes = domain.regions.iter().map(|region| region.max_volume).collect();
            let mut asked = Sizes::new(*sizing, &volumes);
            if let Err(error) = asked.begin(&self.t, self.input_slots, control) {
                control.give_back(asked.into_vertices(control));
                self.unfinished = unfinished;
                return match error {
                    Error::Cancelled => Ok(self.unmeasured(RefineStatus::Cancelled)),
                    other => Err(other),
                };
            }
            domain.boundary.kept = options.keep_boundary;
            let mut refiner = Refiner::new(&mut self.t, &mut domain.boundary, options);
            // The sparsifier knows of no sizes: it would take away what they ask for.
            let level = if asked.is_empty() { options.sparsify() } else { Sparsify::Off };
            task = asked.is_empty().then(|| Task::refine(options, level));
            let known = unfinished.filter(|unfinished| Some(&unfinished.task) == task.as_ref());
            refiner.sizes = (!asked.is_empty()).then_some(asked);
            if level != Sparsify::Off {
                let first = self.input_slots as u32;
                refiner.sparsifier = Some(Sparsifier::new(level, options.radius_edge, refiner.min_edge, first));
            }
            let mut limits = refiner.limits;
            let mut ended = None;
            if let Some(known) = known {
                refiner.goes_on = true;
                refiner.reasons = known.reasons;
                if let (Some((status, waiting)), Some(sparsifier)) = (known.pass, &mut refiner.sparsifier) {
                    sparsifier.waiting = waiting;
                    ended = Some(status);
                }
            }
            let result = match ended {
                Some(status) => Ok(status),
                None => refiner.refine(control),
            };
            refiner.give_back_to(control);
            at_vertices = refiner.sizes.take().map(|sizes| sizes.into_vertices(control));
            counts = [refiner.samples, refiner.segment_splits, refiner.facet_splits];
            reasons = std::mem::take(&mut refiner.reasons);
            let sparsifier = refiner.sparsifier.take();
            let thinned =
                self.thin_out(sparsifier, result, (control, &mut limits), (&mut taken, &mut pass), &mut reasons);
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
        self.leave(report.status, task, reasons, pass);
        Ok(report)
    }

    /// Remembers what a call that was stopped has left to do.
    fn leave(&mut self, status: RefineStatus, task: Option<Task>, reasons: Reasons, pass: Option<Pass>) {
        let stopped = matches!(status, RefineStatus::Cancelled | RefineStatus::TimeLimit);
        self.unfinished = task.filter(|_| stopped).map(|task| Box::new(Unfinished { task, reasons, pass }));
    }

    /// What follows a refinement that ended like this: the sparsifier's last pass, and the closing of the gaps that it has made among the
    /// Steiner points' ids, which comes even after an error.
    fn thin_out(
        &mut self,
        sparsifier: Option<Sparsifier>,
        result: Result<RefineStatus, Error>,
        (control, limits): (&Control, &mut Limits),
        (taken, pass): (&mut [usize; 2], &mut Option<Pass>),
        reasons: &mut Reasons,
    ) -> Result<RefineStatus, Error> {
        let (Some(mut sparsifier), Some(domain)) = (sparsifier, &mut self.domain) else { return result };
        let result = match result {
            Ok(status @ (RefineStatus::Done | RefineStatus::Unrefined)) if sparsifier.has_pass() => {
                let stopped = sparsifier.run(&mut self.t, &mut domain.boundary, control, limits);
                *pass = Some((status, sparsifier.waiting.take()));
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
        match self.close_gaps(reasons, pass, control) {
            Ok(()) => result,
            Err(Error::Cancelled) => Ok(RefineStatus::Cancelled),
            Err(error) => Err(error),
        }
    }

    /// Puts the last Steiner points into the gaps among the others' ids. Returns whether none is left: it is for a few gaps, and does nothing with what is
    /// on the boundary, which knows its vertices by id. Where points only move, at most one or two gaps are ever left, and all else is in order.
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
    fn close_gaps(&mut self, reasons: &mut Reasons, pass: &mut Option<Pass>, control: &Control) -> Result<(), Error> {
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
        if let Some((_, Some(waiting))) = pass {
            waiting.iter_mut().for_each(|v| *v = renamed(*v));
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
        let unfinished = self.unfinished.take();
        if !self.begin_changes(control)? {
            self.unfinished = unfinished;
            return Ok(self.unmeasured(RefineStatus::Cancelled));
        }
        let task = Task { options: None, radius_edge, level };
        let known = unfinished.filter(|unfinished| unfinished.task == task).and_then(|unfinished| unfinished.pass);
        let mut pass = None;
        let (mut taken, mut status) = ([0; 2], RefineStatus::Done);
        if self.t.dimension() == 3 && level.has_pass() {
            let mut sparsifier = Sparsifier::new(level, radius_edge, 0.0, self.input_slots as u32);
            sparsifier.begin_with_all();
            sparsifier.waiting = known.and_then(|(_, waiting)| waiting);
            let limits = &mut Limits::default();
            let result = Ok(RefineStatus::Done);
            let left = (&mut taken, &mut pass);
            status = self.thin_out(Some(sparsifier), result, (control, limits), left, &mut Reasons::default())?;
        }
        let mut report = self.report_unless_cancelled(radius_edge, status, &Reasons::default(), control);
        if report.bad > 0 && status == RefineStatus::Done {
            report.status = RefineStatus::Unrefined;
        }
        [report.removed, report.replaced] = taken;
        self.leave(report.status, Some(task), Reasons::default(), pass);
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
            on_segments: 0,
            on_facets: 0,
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
        let turns = control.slow_turns();
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
        [report.on_segments, report.on_facets] = self.steiner_on_boundary(control)?;
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
