//! Closest point queries allocate nothing, once what proves a part of a surface has been made by the first query that ends in it
//! (subdivision keeps its room from query to query).

use crate::calls;
use std::hint::black_box;

use crate::projection_common::*;
use covact_geometry::primitives::{sphere, sphere_without_poles};
use covact_geometry::{PatchSet, Vec3};

#[test]
fn queries_allocate_nothing() {
    // The counter counts.
    assert!(calls(|| drop(black_box(vec![1.0; 100]))) > 0);
    let sets = [
        vec![bumpy(3, 20, true, 7)],
        vec![sphere(4.0, Vec3::zeros(), Vec3::z()).unwrap()],
        sphere_without_poles(4.0, Vec3::zeros(), Vec3::z())
            .unwrap()
            .to_vec(),
    ];
    for patches in sets {
        let set = PatchSet::new(patches, None).unwrap();
        let mut random = Random(3);
        let points: Vec<(Vec3, Vec3)> = (0..100)
            .map(|_| {
                let patch = &set.patches()[0];
                let xi = random.xi(patch);
                let n = normal(patch, xi).unwrap();
                let q = patch.point(xi) + n * random.between(-0.1, 0.1);
                (q, random.direction() * 1e-3)
            })
            .collect();
        // Subdivision, which the centres of the spheres need, makes its room once.
        let centre = || {
            black_box(set.project(&Vec3::new(1e-6, 2e-6, 0.0), None, f64::INFINITY));
        };
        centre();
        for (q, step) in &points {
            let mut hint = None;
            // Of two points so near to each other the first makes the proofs of both.
            black_box(set.project(q, None, f64::INFINITY));
            black_box(set.project(&(q + step), None, 0.5));
            assert_eq!(
                calls(|| hint = set.project(q, None, f64::INFINITY).map(|f| f.hint())),
                0
            );
            assert!(hint.is_some());
            let warm = || {
                black_box(set.project(&(q + step), hint, 0.5));
            };
            assert_eq!(calls(warm), 0);
        }
        assert_eq!(calls(centre), 0);
    }
}
