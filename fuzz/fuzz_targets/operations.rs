//! See `wellspaced_fuzz::operations`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wellspaced_fuzz::operations::run(data));
