//! See `wellspaced_fuzz::readers`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wellspaced_fuzz::readers::run(data));
