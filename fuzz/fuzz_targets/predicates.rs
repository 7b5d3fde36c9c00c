//! See `wellspaced_fuzz::predicates`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wellspaced_fuzz::predicates::run(data));
