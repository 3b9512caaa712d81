//! Any bytes as an IGES file.
#![no_main]
use covact_geometry::io::read_iges;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = read_iges(bytes, "fuzz.igs") {
        covact_geometry_fuzz::use_patches(file, bytes.len());
    }
});
