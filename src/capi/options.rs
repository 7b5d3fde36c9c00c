//! Option structs and the values of their fields.

use super::guard::{call, Failure};
use super::sized::{self, Sized_};
use super::status::*;
use crate::host::ArrayOptions;
use crate::{RefineOptions, Rule, Sparsify};

/// How Steiner points are chosen: one of the WSP_RULE_ constants.
pub type wsp_rule = u32;

/// Batches of off-centres around the core disk of a bad short edge: section 4 of Jampani and Üngör, 2007.
pub const WSP_RULE_PAPER: u32 = 1;
/// One circumcentre at a time: the classical method, for comparison.
pub const WSP_RULE_CIRCUMCENTER: u32 = 2;
/// As WSP_RULE_PAPER with fewer and wider pieces: the sparsest result. Unless its WSP_SPARSIFY level is OFF, segments and facets are not split because
/// a vertex encroaches upon them (lies in the smallest ball around a piece), but when a Steiner point is due that does so, too, or would take the piece
/// out of the mesh. Thin parts need far fewer vertices so. It is not so in
/// steps, nor where sizes are limited.
pub const WSP_RULE_SPARSE: u32 = 3;

/// How hard to try to do with fewer Steiner points: one of the WSP_SPARSIFY_ constants.
pub type wsp_sparsify = u32;

/// WSP_SPARSIFY_QUICK with WSP_RULE_SPARSE, WSP_SPARSIFY_OFF with the other rules.
pub const WSP_SPARSIFY_DEFAULT: u32 = 0;
/// The sampler alone: Steiner points stay where they are put.
pub const WSP_SPARSIFY_OFF: u32 = 1;
/// Steiner points are taken away where that is found out at little cost.
pub const WSP_SPARSIFY_QUICK: u32 = 2;
/// More is tried: three to five times the time, for about an eighth fewer Steiner points.
pub const WSP_SPARSIFY_THOROUGH: u32 = 3;
/// Nothing is taken away from what stands; but instead of inserting a sample one of two Steiner points near it is moved where
/// one place serves both, if that is found at next to no cost; and a point that splits
/// a segment or facet is made one with a neighbour.
pub const WSP_SPARSIFY_MOVES: u32 = 4;

pub(super) fn sparsify(value: wsp_sparsify) -> Result<Option<Sparsify>, Failure> {
    match value {
        WSP_SPARSIFY_DEFAULT => Ok(None),
        WSP_SPARSIFY_OFF => Ok(Some(Sparsify::Off)),
        WSP_SPARSIFY_QUICK => Ok(Some(Sparsify::Quick)),
        WSP_SPARSIFY_MOVES => Ok(Some(Sparsify::Moves)),
        WSP_SPARSIFY_THOROUGH => Ok(Some(Sparsify::Thorough)),
        _ => Err(Failure::new(WSP_ERR_OPTION, format!("sparsify is {value}, expected a WSP_SPARSIFY_ constant"))),
    }
}

pub(super) fn sparsify_number(level: Option<Sparsify>) -> wsp_sparsify {
    match level {
        None => WSP_SPARSIFY_DEFAULT,
        Some(Sparsify::Off) => WSP_SPARSIFY_OFF,
        Some(Sparsify::Quick) => WSP_SPARSIFY_QUICK,
        Some(Sparsify::Moves) => WSP_SPARSIFY_MOVES,
        Some(Sparsify::Thorough) => WSP_SPARSIFY_THOROUGH,
    }
}

pub(super) fn rule(value: wsp_rule) -> Result<Rule, Failure> {
    match value {
        WSP_RULE_SPARSE => Ok(Rule::Sparse),
        WSP_RULE_PAPER => Ok(Rule::Paper),
        WSP_RULE_CIRCUMCENTER => Ok(Rule::Circumcenter),
        _ => Err(Failure::new(WSP_ERR_OPTION, format!("rule is {value}, expected a WSP_RULE_ constant"))),
    }
}

pub(super) fn rule_number(rule: Rule) -> wsp_rule {
    match rule {
        Rule::Sparse => WSP_RULE_SPARSE,
        Rule::Paper => WSP_RULE_PAPER,
        Rule::Circumcenter => WSP_RULE_CIRCUMCENTER,
    }
}

/// An option that is on or off.
pub(super) fn switch(name: &str, value: u32) -> Result<bool, Failure> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(Failure::new(WSP_ERR_OPTION, format!("{name} is {value}, expected 0 or 1"))),
    }
}

/// A field that means nothing yet.
pub(super) fn unused(reserved: u32) -> Result<(), Failure> {
    match reserved {
        0 => Ok(()),
        _ => Err(Failure::new(WSP_ERR_OPTION, format!("reserved is {reserved}, expected 0"))),
    }
}

/// Options of a triangulation. Fill it with wsp_triangulation_options_init, or pass NULL for the defaults.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_triangulation_options {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// Must be 0.
    pub flags: u32,
    /// How many threads an insertion of many points, and the pass over Steiner points after a refinement or in wsp_sparsify_mesh,
    /// may use, the caller's among them: 0 for as many as there are processors, else up to 1024. Default: 1. The result
    /// is the same in every byte. Callbacks run on the caller's thread only.
    pub threads: u32,
    /// 1 splits no segment or facet to recover it: wsp_triangulation_from_plc refuses a domain of which one is missing from the
    /// Delaunay triangulation of its points, and names it (WSP_ERR_INVALID_DOMAIN). Default: 0.
    pub keep_boundary: u32,
}

/// The most threads that may be asked for.
const MAX_THREADS: u32 = 1024;

// SAFETY: repr(C), integers only, struct_size first.
unsafe impl Sized_ for wsp_triangulation_options {
    const NAME: &'static str = "wsp_triangulation_options";
    // The first version ended before `threads`, the second behind it.
    const SIZES: &'static [usize] =
        &[std::mem::offset_of!(Self, threads), std::mem::offset_of!(Self, keep_boundary), size_of::<Self>()];

    fn defaults() -> Self {
        wsp_triangulation_options { struct_size: 0, flags: 0, threads: 1, keep_boundary: 0 }
    }
}

impl wsp_triangulation_options {
    pub(super) fn check(&self) -> Result<(), Failure> {
        if self.flags != 0 {
            return Err(Failure::new(WSP_ERR_OPTION, format!("flags is {:#x}, expected 0", self.flags)));
        }
        if self.threads > MAX_THREADS {
            let text = format!("threads is {}, expected 0 to {MAX_THREADS}", self.threads);
            return Err(Failure::new(WSP_ERR_OPTION, text));
        }
        switch("keep_boundary", self.keep_boundary).map(|_| ())
    }
}

/// What the sampler aims at. Fill it with wsp_sampler_options_init, or pass NULL for the defaults.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_sampler_options {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// How Steiner points are chosen. Default: WSP_RULE_SPARSE.
    pub rule: wsp_rule,
    /// The bound on a tetrahedron's circumradius over its shortest edge, 0.62 to 1e6 (a regular one has 0.612).
    /// Default: 2.
    pub radius_edge: f64,
    /// For wsp_sample_mesh, the only call that looks at this and what follows: 1 puts no points on the boundary, that is on faces with one
    /// tetrahedron and on the view's `faces`, and leaves out the samples that would encroach upon it. What could only be mended so is left
    /// and counted. Default: 0.
    pub keep_boundary: u32,
    /// Must be 0.
    pub reserved: u32,
    /// For wsp_sample_mesh: no point comes nearer than this to a vertex, in the units of the coordinates; what could only be mended so is left and
    /// counted. With it no loop can go on for ever. 0, the default, takes 2^-40 of the diagonal of the points' bounding box, but
    /// no less than 2^-46 of the largest coordinate; so does anything below.
    pub min_edge: f64,
}

// SAFETY: repr(C), numbers only, struct_size first.
unsafe impl Sized_ for wsp_sampler_options {
    const NAME: &'static str = "wsp_sampler_options";
    // The first version ended before `keep_boundary`.
    const SIZES: &'static [usize] = &[std::mem::offset_of!(Self, keep_boundary), size_of::<Self>()];

    fn defaults() -> Self {
        let ArrayOptions { radius_edge, rule, keep_boundary, min_edge } = ArrayOptions::default();
        wsp_sampler_options {
            struct_size: 0,
            rule: rule_number(rule),
            radius_edge,
            keep_boundary: u32::from(keep_boundary),
            reserved: 0,
            min_edge,
        }
    }
}

impl wsp_sampler_options {
    /// What a round on a host's arrays aims at.
    pub(super) fn for_arrays(&self) -> Result<ArrayOptions, Failure> {
        unused(self.reserved)?;
        let keep_boundary = switch("keep_boundary", self.keep_boundary)?;
        let wsp_sampler_options { radius_edge, min_edge, .. } = *self;
        let options = ArrayOptions { radius_edge, rule: rule(self.rule)?, keep_boundary, min_edge };
        options.check()?;
        Ok(options)
    }
}

/// What a refinement shall reach and when it shall stop. Fill it with wsp_refine_options_init, or pass NULL for
/// the defaults.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_refine_options {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// How Steiner points are chosen. Default: WSP_RULE_SPARSE.
    pub rule: wsp_rule,
    /// The bound on a tetrahedron's circumradius over its shortest edge, 0.62 to 1e6 (a regular one has 0.612).
    /// Default: 2. From 2 on refinement is sure to end by itself, and it usually does so well below; below about 1.1 it
    /// goes on until a limit ends it.
    pub radius_edge: f64,
    /// No Steiner point is added nearer than this to a vertex, in the units of the coordinates. 0, the default,
    /// takes 2^-40 of the diagonal of the points' bounding box, but no less than 2^-46 of the largest coordinate.
    pub min_edge: f64,
    /// No vertex is added beyond this many, input included, but for the few that may be needed to keep segments and facets whole where their
    /// points can't stand exactly on them (WSP_VERTEX_LIMIT). Default: 100 million.
    pub max_vertices: usize,
    /// How hard to try to do with fewer Steiner points, one of the WSP_SPARSIFY_ constants. Default: WSP_SPARSIFY_DEFAULT.
    pub sparsify: wsp_sparsify,
    /// Must be 0.
    pub reserved: u32,
    /// The largest length of an edge of a tetrahedron. 0, the default, asks for nothing. See wsp_refine_sized for more.
    pub max_edge: f64,
    /// 1 puts no Steiner points on segments and facets; what could only be mended so is left and counted. What the domain's recovery has put there when
    /// it was made remains: wsp_triangulation_options has a `keep_boundary` too. Default: 0.
    pub keep_boundary: u32,
    /// Must be 0.
    pub reserved2: u32,
    /// The refinement stops after so many seconds (WSP_TIME_LIMIT). 0, the default: no limit.
    pub max_seconds: f64,
    /// The refinement stops before its large arrays and those of the mesh take more than so many bytes (WSP_MEMORY_LIMIT); those of views,
    /// small lists, and copies made for the time of a large change are not counted. 0, the default: no limit.
    pub max_memory: usize,
}

// SAFETY: repr(C), numbers only, struct_size first.
unsafe impl Sized_ for wsp_refine_options {
    const NAME: &'static str = "wsp_refine_options";
    // The first version ended before `max_edge`.
    const SIZES: &'static [usize] = &[std::mem::offset_of!(Self, max_edge), size_of::<Self>()];

    fn defaults() -> Self {
        let RefineOptions {
            radius_edge,
            rule,
            max_vertices,
            min_edge,
            sparsify,
            keep_boundary,
            max_seconds,
            max_memory,
        } = RefineOptions::default();
        wsp_refine_options {
            struct_size: 0,
            rule: rule_number(rule),
            radius_edge,
            min_edge,
            max_vertices,
            sparsify: sparsify_number(sparsify),
            reserved: 0,
            max_edge: 0.0,
            keep_boundary: u32::from(keep_boundary),
            reserved2: 0,
            max_seconds,
            max_memory,
        }
    }
}

/// Fills `options` with defaults. `size` is `sizeof *options`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_triangulation_options_init(
    options: *mut wsp_triangulation_options,
    size: usize,
) -> wsp_status {
    call("wsp_triangulation_options_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(options, size, "options")? };
        Ok(WSP_DONE)
    })
}

/// Fills `options` with defaults. `size` is `sizeof *options`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_sampler_options_init(options: *mut wsp_sampler_options, size: usize) -> wsp_status {
    call("wsp_sampler_options_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(options, size, "options")? };
        Ok(WSP_DONE)
    })
}

/// Fills `options` with defaults. `size` is `sizeof *options`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_refine_options_init(options: *mut wsp_refine_options, size: usize) -> wsp_status {
    call("wsp_refine_options_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(options, size, "options")? };
        Ok(WSP_DONE)
    })
}
