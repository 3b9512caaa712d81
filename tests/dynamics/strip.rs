//! First frequency of a clamped strip against Euler and Bernoulli, `w = 1.8751^2 sqrt(E I / (rho A L^4))`, from the program's
//! own mass and stiffness. A strip a hundred times as long as thick and without Poisson's ratio is a beam to 1e-4.
use crate::support::loaded;
use covact::assembly::Assembler;
use covact::effects::inertia::Scheme;
use covact::model::build::build;
use covact::model::state::State;
use covact::system::SystemMatrix;
use covact::system::linear::{DirectSolver, LinearSolver, SolverOptions};
use serde_json::json;

const DT: f64 = 1e-2;

#[test]
fn the_first_frequency_of_a_clamped_strip() {
    for (element, count, tolerance) in [("h8", 16, 1e-3), ("h8", 32, 3e-4), ("q18", 8, 2e-4)] {
        let scene = |solution: serde_json::Value| {
            json!({
                "covact": 1,
                "materials": { "m": { "st_venant_kirchhoff": { "E": 1.0, "nu": 0.0, "density": 1.0 } } },
                "bodies": { "s": {
                    "mesh": { "plate": { "size": [10, 1], "thickness": 0.1, "elements": [count, 1] } },
                    "material": "m", "element": element
                } },
                "supports": { "clamp": { "on": "s.x_min", "fixed": true } },
                "solution": solution
            })
        };
        // The tangent at rest, with inertia and without.
        let tangent = |solution: serde_json::Value| -> SystemMatrix {
            let model = build(&loaded(&scene(solution))).unwrap_or_else(|e| panic!("{e}"));
            let mut assembler = Assembler::new(&model, &model.dofs).expect("a pattern");
            let mut state = State::new(&model);
            let n = state.u.len();
            let (mut residual, mut rhs) = (vec![0.0; n], vec![0.0; n]);
            assembler.begin_step(&state.u.clone(), 0.0, DT);
            (assembler.linearize(&mut state, 0.0, None, &mut residual, &mut rhs))
                .unwrap_or_else(|e| panic!("{e}"));
            assembler.matrix().clone()
        };
        let (stiffness, dynamic) = (tangent(json!({})), tangent(json!({ "dynamics": {} })));
        let scheme = Scheme::new(0.8);
        let [inertia, _] = scheme.tangent(DT);
        let n = 3 * stiffness.pattern().nodes();
        let model = build(&loaded(&scene(json!({})))).expect("a model");
        // M x, zero where the clamp is.
        let mass = |x: &[f64]| -> Vec<f64> {
            let (mut all, mut elastic) = (vec![0.0; n], vec![0.0; n]);
            dynamic.multiply(x, &mut all);
            stiffness.multiply(x, &mut elastic);
            let mut out: Vec<f64> = (all.iter().zip(&elastic))
                .map(|(d, k)| (d - (1.0 - scheme.alpha_f) * k) / inertia)
                .collect();
            model.dofs.removed().for_each(|d| out[d as usize] = 0.0);
            out
        };
        let mut solver = DirectSolver::new(SolverOptions::default());
        solver.analyze(stiffness.pattern()).expect("an analysis");
        solver.factorize(&stiffness).expect("factors");
        // Inverse iteration, in the direction in which the strip is thin.
        let mut x: Vec<f64> = (0..n)
            .map(|dof| if dof % 3 == 2 { 1.0 } else { 0.0 })
            .collect();
        let mut square = 0.0;
        for _ in 0..12 {
            let force = mass(&x);
            let mut y = force.clone();
            solver.solve_with(&stiffness, &mut y).expect("a solution");
            // Rayleigh's quotient of y: y K y = y M x.
            let (work, moved) = (dot(&y, &force), dot(&y, &mass(&y)));
            square = work / moved;
            let size = moved.sqrt();
            x = y.iter().map(|y| y / size).collect();
        }
        let (height, length) = (0.1f64, 10.0f64);
        let beam =
            1.875_104_068_711_961f64.powi(2) * (height * height / 12.0).sqrt() / length.powi(2);
        let ratio = square.sqrt() / beam;
        println!("{element} {count}: {ratio:.5}");
        assert!(
            (ratio - 1.0).abs() < tolerance,
            "{element} {count}: {ratio}"
        );
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
