//! Updates and closest points of moving facets allocate nothing once the first update has built the tree.

use crate::calls;
use std::hint::black_box;

use crate::moving_common::*;
use covact_geometry::{ShapeRows, Vec3};

#[test]
fn nothing_is_allocated() {
    // The counter counts.
    assert!(calls(|| drop(black_box(vec![1.0; 100]))) > 0);
    let (one, two) = (torus([9, 7], 1), sheet([3, 3], 2));
    for (mesh, mut set) in [
        (&one, one.faceted()),
        (&two, two.faceted()),
        (&one, one.smooth()),
    ] {
        assert!(calls(|| set.update(|k| mesh.nodes[k as usize])) > 0);
        let mut rows = ShapeRows::default();
        let mut random = Random(3);
        for seed in 0..3 {
            let moved = mesh.deformed(0.2, 0.03, seed);
            assert_eq!(calls(|| set.update(|k| moved[k as usize])), 0);
            for k in 0..60 {
                // The middle of the torus, where parts must be cut, among them.
                let q = if k % 20 == 0 {
                    Vec3::new(1e-3, 0.0, 0.0)
                } else {
                    random.vector(2.5)
                };
                let queries = || {
                    let foot = set.project(&q, None, f64::INFINITY, |_| true);
                    let hint = foot.map(|f| f.hint());
                    let foot = set.project(&(q + Vec3::repeat(1e-3)), hint, 5.0, |f| f != 2);
                    let foot = foot.expect("within reach");
                    set.shape(foot.facet, foot.xi, &mut rows);
                    black_box((foot, &rows));
                };
                assert_eq!(calls(queries), 0);
            }
        }
    }
}
