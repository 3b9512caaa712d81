//! Any bytes as a STEP file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| covact_geometry_fuzz::step(bytes));
