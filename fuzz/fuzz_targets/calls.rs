//! See `wellspaced_fuzz::calls`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wellspaced_fuzz::calls::run(data));
