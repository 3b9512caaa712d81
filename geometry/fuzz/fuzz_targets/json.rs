//! Any bytes as JSON of Kratos, geomdl or our own; what is read must survive being written.
#![no_main]
use covact_geometry::io::{read_json, write_json};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = read_json(bytes, "fuzz.json") {
        let text = write_json(&file).expect("written");
        let back = read_json(text.as_bytes(), "back.json").expect("read back");
        for (a, b) in back.patches.iter().zip(&file.patches) {
            assert_eq!(a.patch, b.patch);
        }
        covact_geometry_fuzz::use_patches(file, bytes.len());
    }
});
