//! What all targets do with a file that was read.
use covact_geometry::io::CadFile;
use covact_geometry::{PatchSet, Vec3};

/// Makes a set of the patches of small inputs and projects a point on it: sets of large ones take their time.
pub fn use_patches(file: CadFile, bytes: usize) {
    let patches: Vec<_> = file.patches.into_iter().map(|p| p.patch).collect();
    if bytes <= 4096
        && let Ok(set) = PatchSet::new(patches, None)
    {
        let [low, high] = set.bounds();
        let q = high + (high - low).component_mul(&Vec3::new(0.3, 0.2, 0.1));
        let foot = set.project(&q, None, f64::INFINITY);
        assert!(foot.is_none_or(|foot| foot.distance >= 0.0));
    }
}
