//! What rigid motions of the pair and the balance of its two sides ask of residual and tangent.
use crate::cases::Case;
use crate::support::V;
use nalgebra::DVector;

/// `K (omega x x) = omega x R`, `K t = 0`, and forces and moments of the two sides cancel, relative to the contact force.
pub fn check(case: &Case, tolerance: f64) {
    let name = &case.name;
    let x = case.all_nodes();
    let (r, k) = case.assemble(&case.evaluate());
    let at = |v: &DVector<f64>, i: usize| V::new(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    let force: f64 = (0..case.slave.len())
        .map(|i| at(&r, i))
        .sum::<V<f64>>()
        .norm();
    assert!(force > 1e-3, "{name}: no contact force");

    let total: V<f64> = (0..x.len()).map(|i| at(&r, i)).sum();
    assert!(
        total.norm() < tolerance * force,
        "{name}: force {:e}",
        total.norm()
    );
    // Lengths of the pair are near one.
    let moment: V<f64> = (0..x.len()).map(|i| x[i].cross(&at(&r, i))).sum();
    assert!(
        moment.norm() < tolerance * force,
        "{name}: moment {:e}",
        moment.norm()
    );

    let omega = V::new(0.3, -0.7, 0.5);
    let motion = |f: &dyn Fn(&V<f64>) -> V<f64>| {
        let v: Vec<f64> = x
            .iter()
            .flat_map(|x| f(x).iter().copied().collect::<Vec<_>>())
            .collect();
        &k * DVector::from_vec(v)
    };
    let scale = k.norm();
    let turned = motion(&|x| omega.cross(x));
    for i in 0..x.len() {
        let error = (at(&turned, i) - omega.cross(&at(&r, i))).norm();
        assert!(
            error < tolerance * scale,
            "{name}: turning, node {i}: {error:e}"
        );
    }
    let moved = motion(&|_| omega).norm();
    assert!(moved < tolerance * scale, "{name}: translation {moved:e}");
}
