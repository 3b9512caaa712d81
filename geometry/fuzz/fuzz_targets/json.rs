//! Any bytes as JSON of Kratos, geomdl or our own; what is read must survive being written.
#![no_main]
use covact_geometry::io::{read_json, write_json};
use covact_geometry_fuzz::{Budget, bounded, use_patches};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let read = bounded(Budget::reader(bytes.len()), || {
        read_json(bytes, "fuzz.json")
    });
    if let Ok(file) = read {
        let text = write_json(&file).expect("written");
        let back = read_json(text.as_bytes(), "back.json").expect("read back");
        assert_eq!(back.patches.len(), file.patches.len());
        for (a, b) in back.patches.iter().zip(&file.patches) {
            assert_eq!(a.patch, b.patch);
        }
        use_patches(file);
    }
});
