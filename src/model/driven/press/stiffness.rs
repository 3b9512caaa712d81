//! Steps of a surface towards equilibrium, and what resists it.
use nalgebra::{Matrix6, SymmetricEigen, Vector6};

/// Step against the forces `f` with the magnitudes of the stiffness's eigenvalues: downhill also where it is indefinite
/// or zero.
pub(super) fn modified_step(
    tangent: &Matrix6<f64>,
    free: &[bool; 6],
    f: &Vector6<f64>,
) -> Vector6<f64> {
    let k = Matrix6::from_fn(|i, j| {
        if free[i] && free[j] {
            tangent[(i, j)]
        } else {
            0.0
        }
    });
    let eigen = SymmetricEigen::new(k);
    let largest = eigen.eigenvalues.amax();
    if largest <= 0.0 {
        // No contact: any length, the caller bounds it.
        return f * (1e100 / f.norm());
    }
    let mut step = Vector6::zeros();
    for i in 0..6 {
        let v = eigen.eigenvectors.column(i);
        step += v * (v.dot(f) / eigen.eigenvalues[i].abs().max(1e-8 * largest));
    }
    step
}

/// The part of forces that works along directions which have stiffness.
pub(super) fn resisted(tangent: &Matrix6<f64>, free: &[bool; 6], f: &Vector6<f64>) -> Vector6<f64> {
    let masked = |i: usize, j: usize| match free[i] && free[j] {
        true => tangent[(i, j)],
        false => 0.0,
    };
    let eigen = SymmetricEigen::new(Matrix6::from_fn(masked));
    let smallest = 1e-6 * eigen.eigenvalues.amax();
    let stiff = (0..6).filter(|&i| eigen.eigenvalues[i].abs() > smallest);
    stiff.fold(Vector6::zeros(), |sum, i| {
        let v = eigen.eigenvectors.column(i);
        sum + v * v.dot(f)
    })
}
