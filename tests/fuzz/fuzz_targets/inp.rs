//! Any bytes as an Abaqus or CalculiX input file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    covact_fuzz::mesh(bytes, "fuzz.inp", covact::mesh::read_inp);
});
