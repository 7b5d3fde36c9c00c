//! The C face: a thin, guarded translation of the core to the functions that `include/wellspaced.h` declares.
//!
//! One file an object. Nothing here computes: a function checks its pointers and sizes, calls the core and
//! translates the answer. What every function has in common has a module of its own:
//!
//! | module | idea |
//! |---|---|
//! | `guard` | a panic ends at the boundary; the floating-point mode is set and restored; errors become statuses |
//! | `handle` | readers and one writer at most, counted, so that misuse is an answer and not undefined |
//! | `args` | pointers and sizes of the caller become slices, or an error |
//! | `sized` | structs that begin with their size, so that they can grow |
//! | `float_env` | round-to-nearest for the predicates, the host's own mode for the host |
//! | `last_error` | the text of a thread's last failure |
//!
//! The doc comments of the public items are the manual: cbindgen copies them to the header, so they are written
//! for readers of C.

#![deny(unsafe_op_in_unsafe_fn)]
#![warn(clippy::undocumented_unsafe_blocks)]
// C names, as the header has them.
#![allow(non_camel_case_types)]
// The rules for pointers are the same for all functions and stand at the top of the header.
#![allow(clippy::missing_safety_doc)]

mod args;
pub mod batch;
pub mod boundary;
pub mod check;
pub mod control;
mod float_env;
mod guard;
mod handle;
mod last_error;
pub mod mesh_batch;
pub mod options;
pub mod plc;
pub mod refine;
pub mod sampler;
mod sized;
pub mod status;
pub mod steps;
pub mod triangulation;
pub mod view;

#[cfg(test)]
mod header;
#[cfg(test)]
mod tests;
