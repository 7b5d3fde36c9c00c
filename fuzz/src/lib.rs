//! What the fuzz targets do with the fuzzer's bytes. Plain functions, so that the corpus can be replayed by `cargo test`, without a fuzzer.
//!
//! | target | claim |
//! |---|---|
//! | [`predicates`] | every predicate has the sign that exact rationals have |
//! | [`operations`] | after any sequence of insertions and removals the triangulation is valid, and that of its points |
//! | [`complex`] | any complex is refused or becomes a valid mesh, and so does its refinement under any limits |
//! | [`readers`] | any bytes are refused by name and line or read; what is written is read back as it was |
//! | [`calls`] | the C interface answers any order of calls by its statuses, and never by an internal error |
//!
//! A claim that fails is a panic.

pub mod bytes;
pub mod calls;
pub mod complex;
pub mod operations;
pub mod predicates;
pub mod readers;

// The command's own modules, as they are; not all of what they offer is used here.
#[allow(dead_code, unused_imports)]
#[path = "../../src/bin/wellspaced/failure.rs"]
mod failure;
#[allow(dead_code, unused_imports)]
#[path = "../../src/bin/wellspaced/read/mod.rs"]
mod read;
#[allow(dead_code)]
mod write;

/// A fuzz target.
pub type Target = fn(&[u8]);

/// All targets by name.
pub const TARGETS: [(&str, Target); 5] = [
    ("predicates", predicates::run),
    ("operations", operations::run),
    ("complex", complex::run),
    ("readers", readers::run),
    ("calls", calls::run),
];
