//! Any bytes as an IGES file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| covact_geometry_fuzz::iges(bytes));
