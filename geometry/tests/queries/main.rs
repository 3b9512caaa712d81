//! Rays, distances between sets and triangles, on surfaces with closed forms and on CAD files.

mod rays;
mod separation;
#[cfg(feature = "tessellate")]
mod tessellate;

use covact_geometry::io::read_path;
use covact_geometry::{PatchSet, Vec3};
use std::path::Path;

/// The set of a STEP file under tests/data, in its own unit.
fn cad(name: &str) -> PatchSet {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name);
    read_path(&path).unwrap().into_surface().unwrap().into_set()
}

/// Numbers between 0 and 1 from a linear congruential generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, [low, high]: [Vec3; 2], times: f64) -> Vec3 {
        let middle = (low + high) / 2.0;
        Vec3::from_fn(|k, _| middle[k] + times * (high[k] - low[k]) * (self.next() - 0.5))
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let d = Vec3::from_fn(|_, _| 2.0 * self.next() - 1.0);
            if (0.1..=1.0).contains(&d.norm()) {
                return d;
            }
        }
    }
}
