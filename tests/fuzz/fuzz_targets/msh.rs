//! Any bytes as a gmsh mesh.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    covact_fuzz::mesh(bytes, "fuzz.msh", covact::mesh::read_gmsh);
});
