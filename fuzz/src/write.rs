//! The part of the command's writers that is read back.

#[path = "../../src/bin/wellspaced/write/number.rs"]
mod number;
#[path = "../../src/bin/wellspaced/write/tetgen.rs"]
mod tetgen;

pub use tetgen::write_poly;
