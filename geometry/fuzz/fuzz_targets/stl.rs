//! Any bytes as an STL file, read three times: with the default distance for merging, without any and with one.
#![no_main]
use covact_geometry::io::read_stl;
use covact_geometry_fuzz::{Budget, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for merge in [None, Some(0.0), Some(0.125)] {
        let read = bounded(Budget::reader(bytes.len()), || {
            read_stl(bytes, "fuzz.stl", merge)
        });
        if let Ok(stl) = read {
            assert_eq!(
                stl.triangles.len() + stl.report.degenerate.len(),
                stl.report.triangles
            );
            let facets = bounded(Budget::reader(bytes.len()), || stl.facets());
            assert_eq!(facets.facets.len(), 3 * stl.triangles.len());
            if let Ok(back) = read_stl(&stl.to_binary(), "back.stl", Some(0.0)) {
                assert_eq!(back.report.triangles, stl.triangles.len());
            }
        }
    }
});
