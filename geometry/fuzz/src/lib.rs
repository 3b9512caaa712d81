//! What all targets share: the bounds of a reader, and what becomes of a file that was read.

mod bounds;
mod entities;

pub use bounds::{Budget, bounded};
pub use entities::mutate;

use covact_geometry::io::{CadFile, read_iges, read_iges_geometry, read_step};
use covact_geometry::{PatchSet, Vec3};

/// Sets of more patches than this are not made.
const MOST_PATCHES: usize = 20;

/// Reads bytes as an IGES file, both ways, within the bounds of a reader.
pub fn iges(bytes: &[u8]) {
    let file = bounded(Budget::reader(bytes.len()), || read_iges(bytes, "fuzz.igs"));
    if let Ok(file) = file
        && one_in_four(bytes)
    {
        use_patches(file);
    }
    // Every curve and surface, also those that no face uses.
    let _ = bounded(Budget::reader(bytes.len()), || {
        read_iges_geometry(bytes, "fuzz.igs")
    });
}

/// Reads bytes as a STEP file within the bounds of a reader.
pub fn step(bytes: &[u8]) {
    let file = bounded(Budget::reader(bytes.len()), || {
        read_step(bytes, "fuzz.step")
    });
    if let Ok(file) = file
        && one_in_four(bytes)
    {
        use_patches(file);
    }
}

/// Chooses inputs for what takes long, always the same ones.
fn one_in_four(bytes: &[u8]) -> bool {
    let sum = (bytes.iter()).fold(0u32, |sum, &b| sum.wrapping_mul(31) ^ u32::from(b));
    (sum ^ sum >> 7).is_multiple_of(4)
}

/// Makes a set of the patches where they are few, and projects a point on it.
pub fn use_patches(file: CadFile) {
    let patches: Vec<_> = file.patches.into_iter().map(|p| p.patch).collect();
    if patches.len() > MOST_PATCHES {
        return;
    }
    bounded(Budget::projection(), || {
        if let Ok(set) = PatchSet::new(patches, None) {
            let [low, high] = set.bounds();
            let q = high + (high - low).component_mul(&Vec3::new(0.3, 0.2, 0.1));
            let foot = set.project(&q, None, f64::INFINITY);
            assert!(foot.is_none_or(|foot| !(foot.distance < 0.0)));
        }
    });
}
