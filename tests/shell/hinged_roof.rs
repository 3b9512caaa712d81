//! Hinged cylindrical roof under a point load, K. Y. Sze, X. H. Liu and S. H. Lo, Finite Elem. Anal. Des. 40 (2004)
//! 1551, section 3.6: radius 2540, length 508, half angle 0.1, thickness 12.7, E = 3102.75, nu = 0.3. Straight edges
//! hinged, curved ones free. The load rises to a limit point and falls to a minimum before the shell, turned over, carries
//! again: displacement control. Tabulated (of P = 3000): 0.7421 at 11.29 and 0.1729 at 19.85, extremes of the table;
//! 0.4443 at 24.66, 1.0835 at 29.37.
//!
//! The rise, 12.69, is as large as the thickness, so the hinge has to be where theirs is, on the mid-surface: the mean of
//! top and bottom is held.
use super::support::{Model, Ties, grid_of, st_venant, zeros};
use covact::mesh::ElementKind;
use covact::shell::Formulation;

/// Loads of the whole roof at the given deflections of its centre, by `n` x `n` elements on a quarter.
fn loads(kind: ElementKind, n: usize, deflections: &[f64]) -> (Vec<f64>, usize) {
    let (radius, t) = (2540.0, 12.7);
    let grid = grid_of(kind, n, n, |a, b, c| {
        let (r, phi) = (radius + 0.5 * c * t, 0.1 * a);
        [r * phi.sin(), 254.0 * b, r * phi.cos()]
    });
    let (nx, ny) = (grid.nx, grid.ny);
    let mut fixed = grid.dofs(&[0], |i, _| i == 0);
    fixed.extend(grid.dofs(&[1], |_, j| j == 0));
    let fixed = zeros(fixed);
    let law = st_venant(3102.75, 0.3);
    let mut model = match kind {
        ElementKind::H8 => Model::new(&grid.mesh, Formulation::Eas7, law),
        ElementKind::Q18 => Model::q18(&grid.mesh, law),
        ElementKind::Nurbs => unreachable!("these are meshes of solid-shells"),
    };
    let mut u = vec![0.0; 3 * grid.mesh.nodes.len()];
    let pair = |i: usize, j: usize, axis: usize| [0, 1].map(|k| 3 * grid.node(i, j, k) + axis);
    let mut iterations = 0;
    let loads = (deflections.iter())
        .map(|w| {
            let mut ties = Ties::new();
            for j in 0..=ny {
                // On the symmetry plane y is held already.
                let axes: &[usize] = if j == 0 { &[0, 2] } else { &[0, 1, 2] };
                for &axis in axes {
                    ties.insert(pair(nx, j, axis), (1.0, 0.0));
                }
            }
            let centre = pair(0, 0, 2);
            ties.insert(centre, (1.0, -2.0 * w));
            let load = vec![0.0; u.len()];
            iterations += model.newton_tied(&mut u, &load, &fixed, &ties);
            let f = model.assemble(&u).0;
            assert!(
                (f[centre[0]] - f[centre[1]]).abs() < 1e-6 * 3000.0,
                "not shared alike"
            );
            -4.0 * (f[centre[0]] + f[centre[1]])
        })
        .collect();
    (loads, iterations)
}

/// Values at deflections, and the extremes by parabolas through three points.
struct Path {
    /// Limit load and the deflection there.
    limit: [f64; 2],
    minimum: [f64; 2],
    /// At 24.66 and 29.37.
    after: [f64; 2],
}

/// Vertex of the parabola through three equally spaced points.
fn vertex(x: &[f64], y: &[f64]) -> [f64; 2] {
    let step = x[1] - x[0];
    let (slope, curve) = ((y[2] - y[0]) / 2.0, y[2] - 2.0 * y[1] + y[0]);
    let at = -slope / curve;
    [y[1] + 0.5 * slope * at, x[1] + at * step]
}

fn path(kind: ElementKind, n: usize) -> Path {
    const W: [f64; 12] = [
        5.0, 9.0, 10.5, 11.0, 11.5, 15.0, 18.0, 19.25, 19.75, 20.25, 24.66, 29.37,
    ];
    let (p, iterations) = loads(kind, n, &W);
    let path = Path {
        limit: vertex(&W[2..5], &p[2..5]),
        minimum: vertex(&W[7..10], &p[7..10]),
        after: [p[10], p[11]],
    };
    println!(
        "{kind:?} {n} x {n}: limit {:.2?}, minimum {:.2?}, then {:.2?}; {iterations} iterations",
        path.limit, path.minimum, path.after
    );
    assert!(iterations <= 8 * W.len());
    path
}

impl Path {
    fn values(&self) -> [f64; 4] {
        [self.limit[0], self.minimum[0], self.after[0], self.after[1]]
    }
}

/// Both elements go to one curve: 2216, 509, 1340 and 3277 (Q18 on 8 x 8 and H8 on 24 x 24 differ by 0.3 % at most). The
/// table's shell element on its own mesh lies 0.5 %, 1.9 %, 0.6 % and 0.9 % beside it, in both directions; its rows are 0.5
/// apart or more, so its extremes are known in place only to that.
#[test]
fn through_the_limit_point() {
    const TABLE: [f64; 4] = [2226.0, 519.0, 0.4443 * 3000.0, 1.0835 * 3000.0];
    const OWN: [f64; 4] = [2215.7, 509.2, 1340.0, 3277.0];
    let coarse = path(ElementKind::H8, 5).values();
    let h8 = path(ElementKind::H8, 10);
    let q18 = path(ElementKind::Q18, 4);
    for (path, tolerance) in [(&q18, 6e-3), (&h8, 2e-2)] {
        assert!((path.limit[1] - 10.8).abs() < 0.1 && (path.limit[1] - 11.29).abs() < 0.6);
        assert!((path.minimum[1] - 19.5).abs() < 0.1 && (path.minimum[1] - 19.85).abs() < 0.5);
        for ((value, own), table) in path.values().into_iter().zip(OWN).zip(TABLE) {
            assert!((value / own - 1.0).abs() < tolerance, "{value} {own}");
            assert!((value / table - 1.0).abs() < 2.5e-2, "{value} {table}");
        }
    }
    // Second order where the error is large enough to show it and the shell has not yet turned over.
    for i in 1..3 {
        let rate = ((coarse[i] - OWN[i]) / (h8.values()[i] - OWN[i])).log2();
        println!("rate {rate:.2}");
        assert!(rate > 1.5 && rate < 2.5, "{rate}");
    }
}
