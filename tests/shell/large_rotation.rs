//! Cantilever under end shear, K. Y. Sze, X. H. Liu and S. H. Lo, Finite Elem. Anal. Des. 40 (2004) 1551, section 3.1:
//! L = 10, b = 1, h = 0.1, E = 1.2e6, nu = 0, P = 4.
use super::support::{Model, close, grid, st_venant, zeros};
use covact::shell::Formulation;

#[test]
fn cantilever_end_shear() {
    let (length, width, h) = (10.0, 1.0, 0.1);
    let n = 16;
    let grid = grid(n, 1, |a, b, c| [length * a, width * b, 0.5 * c * h]);
    let fixed = zeros(grid.dofs(&[0, 1, 2], |i, _| i == 0));
    let mut model = Model::new(&grid.mesh, Formulation::Eas7, st_venant(1.2e6, 0.0));
    let mut u = vec![0.0; 3 * grid.mesh.nodes.len()];
    let mut iterations = 0;
    let mut tips = vec![];
    for step in 1..=10 {
        let mut load = vec![0.0; u.len()];
        for dof in grid.dofs(&[2], |i, _| i == n) {
            load[dof] = 0.1 * step as f64;
        }
        iterations += model.newton(&mut u, &load, &fixed);
        let mean = |axis| 0.5 * (grid.mean(&u, n, 0, axis) + grid.mean(&u, n, 1, axis));
        tips.push((-mean(0), mean(2)));
    }
    println!("{iterations} iterations in 10 steps");
    assert!(iterations <= 90);
    // Tabulated at P = 2 and P = 4, with three decimals.
    close("-u at P = 2", tips[4].0, 1.604, 3e-3);
    close("w at P = 2", tips[4].1, 4.933, 3e-3);
    close("-u at P = 4", tips[9].0, 3.286, 3e-3);
    close("w at P = 4", tips[9].1, 6.698, 3e-3);
    // The same formulation elsewhere: 3.2933 and 6.7049.
    close("-u, 16 elements", tips[9].0, 3.2933, 1e-4);
    close("w, 16 elements", tips[9].1, 6.7049, 1e-4);
}
