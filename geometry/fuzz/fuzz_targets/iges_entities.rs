//! IGES files with sound records, changed entity by entity.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| covact_geometry_fuzz::iges(bytes));

libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    covact_geometry_fuzz::mutate(data, size, max_size, seed)
});
