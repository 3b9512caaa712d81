//! Large displacements and rotations: K. Y. Sze, X. H. Liu and S. H. Lo, Finite Elem. Anal. Des. 40 (2004) 1551.
use super::support::{Grid, Model, Ties, close, grid_of, st_venant, zeros};
use covact::mesh::ElementKind;
use covact::shell::Formulation;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

fn model(grid: &Grid, e: f64, nu: f64) -> Model {
    match grid.mesh.kind {
        ElementKind::H8 => Model::new(&grid.mesh, Formulation::Eas7, st_venant(e, nu)),
        ElementKind::Q18 => Model::q18(&grid.mesh, st_venant(e, nu)),
        ElementKind::Nurbs => unreachable!("these are meshes of solid-shells"),
    }
}

/// Hemisphere with an 18 degree hole, section 3.4: two pairs of radial forces on its edge; a quarter.
pub(super) struct Hemisphere {
    grid: Grid,
    model: Model,
    u: Vec<f64>,
}

impl Hemisphere {
    fn new(n: usize) -> Hemisphere {
        Hemisphere::of(ElementKind::Q18, n)
    }

    pub(super) fn of(kind: ElementKind, n: usize) -> Hemisphere {
        let (radius, t) = (10.0, 0.04);
        let grid = grid_of(kind, n, n, |a, b, c| {
            let (theta, phi, r) = (FRAC_PI_2 * a, 72f64.to_radians() * b, radius + 0.5 * c * t);
            [
                r * theta.cos() * phi.cos(),
                r * theta.sin() * phi.cos(),
                r * phi.sin(),
            ]
        });
        let u = vec![0.0; 3 * grid.mesh.nodes.len()];
        let model = model(&grid, 6.825e7, 0.3);
        Hemisphere { grid, model, u }
    }

    /// Equilibrium at `force`, half on each face of the mid-surface point; returns outward and inward displacement.
    fn solve(&mut self, force: f64) -> (f64, f64, usize) {
        self.solve_with(force, Model::newton)
    }

    pub(super) fn solve_with(
        &mut self,
        force: f64,
        newton: impl FnOnce(&mut Model, &mut [f64], &[f64], &BTreeMap<usize, f64>) -> usize,
    ) -> (f64, f64, usize) {
        let grid = &self.grid;
        let nx = grid.nx;
        let mut load = vec![0.0; self.u.len()];
        for k in 0..2 {
            load[3 * grid.node(0, 0, k)] = 0.25 * force;
            load[3 * grid.node(nx, 0, k) + 1] = -0.25 * force;
        }
        let mut fixed = grid.dofs(&[1], |i, _| i == 0);
        fixed.extend(grid.dofs(&[0], |i, _| i == nx));
        fixed.push(3 * grid.node(0, 0, 0) + 2);
        let iterations = newton(&mut self.model, &mut self.u, &load, &zeros(fixed));
        (
            grid.mean(&self.u, 0, 0, 0),
            -grid.mean(&self.u, nx, 0, 1),
            iterations,
        )
    }
}

/// Tabulated at P = 400: 4.067 and 8.178.
///
/// The recipe of Q18 without its two corrections (mean and first moment of the in-plane strain kept, volume strain
/// projected) gives, in an independent implementation, 4.024 and 7.971 on 8 x 8 elements, and 3.953 and 7.737 on 6 x 6.
/// With them the element is 0.5 % and 0.8 % softer there, and nearer to the reference by half and by a third of its error.
///
/// Meshes above 6 x 6 take too long for a test: their results are in `reference/hemisphere.json`, written down from this one
/// with `COVACT_HEMISPHERE=8` and so on in the environment.
#[test]
fn hemisphere_with_hole() {
    let file: serde_json::Value =
        serde_json::from_str(include_str!("reference/hemisphere.json")).unwrap();
    let row = |n: u64| {
        let rows = file["meshes"].as_array().unwrap();
        let row = rows.iter().find(|r| r["elements"] == n).unwrap();
        [&row["u_a"], &row["u_b"]].map(|x| x.as_f64().unwrap())
    };
    let asked = std::env::var("COVACT_HEMISPHERE").ok();
    let n = asked.map_or(6, |n| n.parse().unwrap());
    let mut shell = Hemisphere::new(n);
    let mut found = (0.0, 0.0, 0);
    // Thin elements take smaller steps.
    let steps = if n <= 8 {
        vec![40.0, 110.0, 220.0, 400.0]
    } else {
        (1..=20).map(|i| 20.0 * f64::from(i)).collect()
    };
    for force in steps {
        found = shell.solve(force);
    }
    println!("{n} x {n}: {found:?}");
    let [u_a, u_b] = row(n as u64);
    close("u_A", found.0, u_a, 1e-5);
    close("-u_B", found.1, u_b, 1e-5);
    // Between the recipe and the reference.
    let [u_a, u_b] = row(8);
    assert!(u_a > 4.024 && u_a < 4.067 && u_b > 7.971 && u_b < 8.178);
    let [fine_a, fine_b] = row(16);
    close("u_A, 16 x 16", fine_a, 4.067, 5e-3);
    close("-u_B, 16 x 16", fine_b, 8.178, 5e-3);
}

/// Cantilever bent to a circle by an end moment, section 3.2: L = 12, b = 1, h = 0.1, E = 1.2e6, nu = 0. The end section is
/// turned, free to move; returns -u, w of its middle and the moment at half and full turn.
fn roll(kind: ElementKind, n: usize) -> ([[f64; 3]; 2], usize) {
    let (length, width, h) = (12.0, 1.0, 0.1);
    let grid = grid_of(kind, n, 1, |a, b, c| [length * a, width * b, 0.5 * h * c]);
    let mut model = model(&grid, 1.2e6, 0.0);
    let mut u = vec![0.0; 3 * grid.mesh.nodes.len()];
    let fixed = zeros(grid.dofs(&[0, 1, 2], |i, _| i == 0));
    let nx = grid.nx;
    let mut out = [[0.0; 3]; 2];
    let mut iterations = 0;
    let steps = 2 * n.max(8);
    for step in 1..=steps {
        let angle = 2.0 * PI * step as f64 / steps as f64;
        let mut ties = Ties::new();
        for j in 0..=grid.ny {
            let pair = |axis| [0, 1].map(|k| 3 * grid.node(nx, j, k) + axis);
            // The director (0, 0, h) becomes h (-sin, 0, cos).
            ties.insert(pair(0), (-1.0, -h * angle.sin()));
            ties.insert(pair(2), (-1.0, h * (angle.cos() - 1.0)));
        }
        let load = vec![0.0; u.len()];
        iterations += model.newton_tied(&mut u, &load, &fixed, &ties);
        if 2 * step == steps || step == steps {
            let f = model.assemble(&u).0;
            // Couple of the top nodes with the opposite forces of the bottom ones: director x force.
            let moment: f64 = (0..=grid.ny)
                .map(|j| {
                    let top = 3 * grid.node(nx, j, 1);
                    h * (angle.sin() * f[top + 2] + angle.cos() * f[top])
                })
                .sum();
            let lines = grid.ny as f64 + 1.0;
            let mean = |axis| {
                (0..=grid.ny)
                    .map(|j| grid.mean(&u, nx, j, axis))
                    .sum::<f64>()
                    / lines
            };
            out[usize::from(step == steps)] = [-mean(0), mean(2), -moment];
        }
    }
    (out, iterations)
}

/// The closed form for a beam of St. Venant-Kirchhoff's material with curvature k and plane sections: `N = 0` shortens the
/// middle, `lambda^2 = 1 - (k h)^2 / 4`; the thickness shrinks by `(k h)^2 / 12` under its bending; two points through the
/// thickness take `h^5 / 144` for the fourth moment. Together `M = E I k (1 - (k h)^2 / 2)`, and a circle of radius
/// `lambda / k`. Linear elements follow with the square of their length, quadratic ones with the fourth power.
#[test]
fn cantilever_rolled_up() {
    let (length, h, ei) = (12.0, 0.1, 1.2e6 * 0.1f64.powi(3) / 12.0);
    // The published full moment is E I k.
    assert!((ei * 2.0 * PI / length / (50.0 * PI / 3.0) - 1.0).abs() < 1e-12);
    for (kind, meshes, order) in [
        (ElementKind::H8, [8, 16], 2.0),
        (ElementKind::Q18, [4, 8], 4.0),
    ] {
        let found = meshes.map(|n| roll(kind, n));
        for turn in 0..2 {
            let k = PI * (turn + 1) as f64 / length;
            let kh = (k * h).powi(2);
            let moment = ei * k * (1.0 - 0.5 * kh);
            let radius = (1.0 - 0.25 * kh).sqrt() / k;
            let errors = found.each_ref().map(|(states, _)| {
                let [u, w, m] = states[turn];
                println!("{kind:?}, turn {turn}: -u {u:.5} w {w:.5} M {m:.5} ({moment:.5})");
                // Half a circle: w is its diameter; both ends on one line, and again on a full turn.
                assert!((u - length).abs() < 1e-4 * length, "{u}");
                let diameter = if turn == 0 { 2.0 * radius } else { 0.0 };
                assert!((w - diameter).abs() < 7e-3 * length, "{w}");
                moment - m
            });
            let rate = (errors[0] / errors[1]).log2();
            println!("rate {rate:.2}, error {:.2e}", errors[1] / moment);
            assert!((rate - order).abs() < 0.15 * order, "{rate}");
        }
        for (_, iterations) in found {
            assert!(iterations < 250, "{iterations}");
        }
    }
}
