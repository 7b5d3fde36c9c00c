//! See `wellspaced_fuzz::complex`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| wellspaced_fuzz::complex::run(data));
