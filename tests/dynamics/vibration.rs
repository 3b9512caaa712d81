//! Vibrations of one element, a system of one degree of freedom whose motion is known: a bar of length h with linear shape
//! functions has the stiffness `E A / h` and, with its base held, the mass `rho A h / 3` at its top, so that
//! `w = sqrt(3 E / rho) / h`.
use crate::support::{column, fixed, run};
use covact::run::Simulation;
use serde_json::{Value, json};

const E: f64 = 300.0;
const RHO: f64 = 1.0;
const HEIGHT: f64 = 3.0;

fn omega() -> f64 {
    (3.0 * E / RHO).sqrt() / HEIGHT
}

/// A bar that stands on its base.
fn bar(solution: Value) -> Value {
    let sides = json!(["b.x_min", "b.x_max"]);
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": E, "nu": 0.0, "density": RHO } } },
        "bodies": { "b": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [1, 2, HEIGHT], "elements": [1, 1, 1] } },
            "material": "m", "element": "h8_displacement"
        } },
        "supports": {
            "base": { "on": "b.z_min", "displacement": { "z": 0 } },
            "x": { "on": sides, "symmetry": "x" },
            "y": { "on": ["b.y_min", "b.y_max"], "symmetry": "y" }
        },
        "solution": solution,
        "output": { "every": 0 }
    })
}

fn top(simulation: &Simulation) -> f64 {
    let u = simulation.displacements("b").expect("the body");
    let nodes = &simulation.model().bodies[0].mesh.nodes;
    let top = nodes.iter().position(|x| x.z == HEIGHT).expect("a node");
    u[top].z
}

/// Largest error over a run of a displacement that is known at all times.
fn error(scene: &Value, exact: impl Fn(f64) -> f64) -> f64 {
    let mut error = 0.0f64;
    run(scene, |s| {
        error = error.max((top(s) - exact(s.time())).abs());
    });
    error
}

/// Closed form: weight that acts at once makes the top swing about where it would rest, `u_s (1 - cos w t)`. The mean of the
/// reactions is that weight.
#[test]
fn weight_that_acts_at_once_makes_it_swing() {
    let (g, w) = (1e-5, omega());
    let rest = -RHO * HEIGHT * HEIGHT * g / (2.0 * E);
    let period = std::f64::consts::TAU / w;
    for rho_inf in [1.0, 0.8, 0.5] {
        let errors = [40, 80].map(|n| {
            let mut solution = fixed(period / f64::from(n), 2.0 * period);
            solution["dynamics"]["rho_inf"] = json!(rho_inf);
            let mut scene = bar(solution);
            scene["loads"] = json!({ "weight": { "on": "b", "gravity": [0, 0, -g] } });
            error(&scene, |t| rest * (1.0 - (w * t).cos())) / rest.abs()
        });
        let order = (errors[0] / errors[1]).log2();
        println!("rho_inf {rho_inf}: errors {errors:?}, order {order:.3}");
        assert!(errors[1] > 1e-5 && errors[1] < 2e-2, "{errors:?}");
        assert!(
            (order - 2.0).abs() < 0.12,
            "rho_inf {rho_inf}: order {order}"
        );
    }
    let solution = fixed(period / 400.0, period);
    let mut scene = bar(solution);
    scene["loads"] = json!({ "weight": { "on": "b", "gravity": [0, 0, -g] } });
    let simulation = run(&scene, |_| {});
    let force = column(&simulation, "force.base.z");
    let mean = force.iter().sum::<f64>() / force.len() as f64;
    // With the base held, a third of the mass hangs on the base, another on the top, and a sixth couples them:
    // the reaction is R = m g / 2 + k |u| - m a / 6, whose mean over a period is the weight.
    let weight = RHO * 2.0 * HEIGHT * g;
    assert!((mean / weight - 1.0).abs() < 1e-3, "{mean} {weight}");
    let largest = force.iter().copied().fold(0.0, f64::max);
    let swing = 0.5 * weight + 0.5 * weight * (1.0 + 0.5 * 1.0);
    assert!(largest <= 1.01 * (weight + swing), "{largest}");
}

/// Closed form of `u'' + a u' + w^2 u = w^2 u_s` from rest: swings fall with `exp(-a t / 2)`, and the book has what damping took.
#[test]
fn damping_takes_its_part() {
    let (g, w) = (1e-5, omega());
    let rest = -RHO * HEIGHT * HEIGHT * g / (2.0 * E);
    let period = std::f64::consts::TAU / w;
    let a = 0.2 * w;
    let mut solution = fixed(period / 150.0, 16.0 * period);
    solution["dynamics"]["damping"] = json!({ "mass": a });
    let mut scene = bar(solution);
    scene["loads"] = json!({ "weight": { "on": "b", "gravity": [0, 0, -g] } });
    let damped = (w * w - 0.25 * a * a).sqrt();
    let exact = |t: f64| {
        let swing = (damped * t).cos() + 0.5 * a / damped * (damped * t).sin();
        rest * (1.0 - (-0.5 * a * t).exp() * swing)
    };
    let mut error = 0.0f64;
    let simulation = run(&scene, |s| {
        error = error.max((top(s) - exact(s.time())).abs() / rest.abs());
    });
    assert!(error < 2e-3, "{error}");
    // At rest in the end: of the work of the weight one half is stored, the other taken.
    let last = |name: &str| column(&simulation, name).last().copied().expect("a step");
    let (work, taken) = (last("energy.external"), last("energy.damping"));
    println!(
        "error {error:.1e}, damping took {:.5} of the work",
        taken / work
    );
    assert!((taken / work - 0.5).abs() < 2e-3, "{taken} {work}");
    assert!(last("energy.integrator").abs() < 2e-3 * work);
}

/// The same with `a = eta w^2`: viscous material of Kelvin and Voigt, in elements of every kind.
#[test]
fn viscous_material_takes_its_part() {
    let (g, w) = (1e-5, omega());
    let rest = -RHO * HEIGHT * HEIGHT * g / (2.0 * E);
    let period = std::f64::consts::TAU / w;
    let a = 0.2 * w;
    for element in ["h8", "h8_displacement", "h8_mean_dilatation", "q18"] {
        let mut solution = fixed(period / 150.0, 12.0 * period);
        solution["dynamics"]["damping"] = json!({ "viscosity": a / (w * w) });
        let mut scene = bar(solution);
        scene["bodies"]["b"]["element"] = json!(element);
        scene["loads"] = json!({ "weight": { "on": "b", "gravity": [0, 0, -g] } });
        let damped = (w * w - 0.25 * a * a).sqrt();
        let exact = |t: f64| {
            let swing = (damped * t).cos() + 0.5 * a / damped * (damped * t).sin();
            rest * (1.0 - (-0.5 * a * t).exp() * swing)
        };
        let (mut error, mut smallest) = (0.0f64, 0.0f64);
        let simulation = run(&scene, |s| {
            error = error.max((top(s) - exact(s.time())).abs() / rest.abs());
            smallest = smallest.min(top(s) / rest.abs());
        });
        let last = |name: &str| column(&simulation, name).last().copied().expect("a step");
        let (work, taken) = (last("energy.external"), last("energy.viscosity"));
        println!(
            "{element}: error {error:.1e}, farthest {smallest:.4}, viscosity took {:.5} of the work",
            taken / work
        );
        assert!(error < 2e-3, "{element}: {error}");
        assert!(smallest < -1.7, "{element}: {smallest}");
        assert!((taken / work - 0.5).abs() < 2e-3, "{taken} {work}");
        assert_eq!(taken, last("energy.damping"));
        let column = column(&simulation, "energy.viscosity");
        assert!(column.windows(2).all(|w| w[1] >= w[0]));
        assert!(last("energy.integrator").abs() < 2e-3 * work);
    }
}

/// Motion at the start is resisted at once: from `v` at rest, `u = v / w_d exp(-a t / 2) sin(w_d t)`, and the first step has no less
/// than the order of the others.
#[test]
fn viscous_material_resists_motion_at_the_start() {
    let (v, w) = (1e-6, omega());
    let period = std::f64::consts::TAU / w;
    let a = 0.2 * w;
    let damped = (w * w - 0.25 * a * a).sqrt();
    let exact = |t: f64| v / damped * (-0.5 * a * t).exp() * (damped * t).sin();
    let errors = [50, 100].map(|n| {
        let mut solution = fixed(period / f64::from(n), 2.0 * period);
        solution["dynamics"]["damping"] = json!({ "viscosity": a / (w * w) });
        solution["dynamics"]["rho_inf"] = json!(1.0);
        let mut scene = bar(solution);
        // About the base: the top alone moves up at `v`, as the base is held.
        scene["bodies"]["b"]["velocity"] = json!([0, 0, v]);
        error(&scene, exact) * damped / v
    });
    let order = (errors[0] / errors[1]).log2();
    println!("errors {errors:?}, order {order:.3}");
    assert!(errors[1] < 3e-3 && (order - 2.0).abs() < 0.15, "{errors:?}");
}

/// Closed form: a base that moves by `B sin(W t)` drives the top by `u'' + w^2 u = (w^2 + W^2 / 2) B sin(W t)`: a sixth of the
/// mass couples base and top. Supports start with the velocity that they prescribe.
#[test]
fn a_base_that_moves_drives_the_top() {
    let (b, w) = (1e-6, omega());
    let period = std::f64::consts::TAU / w;
    let rate = 0.6 * w;
    let c = (w * w + 0.5 * rate * rate) * b / (w * w - rate * rate);
    let exact = |t: f64| c * ((rate * t).sin() - rate / w * (w * t).sin());
    let errors = [50, 100].map(|n| {
        let mut scene = bar(fixed(period / f64::from(n), 3.0 * period));
        scene["supports"]["base"]["displacement"]["z"] = json!(format!("{b}*sin({rate}*t)"));
        error(&scene, exact) / c
    });
    let order = (errors[0] / errors[1]).log2();
    println!("errors {errors:?}, order {order:.3}");
    assert!((order - 2.0).abs() < 0.15 && errors[1] < 2e-2, "{errors:?}");
}

/// Steps are chosen by their error: it is what was asked for, and a tolerance 64 times smaller takes steps 4 times smaller, since
/// the error of a step is of third order.
#[test]
fn steps_follow_the_tolerance() {
    // Strains of 5e-5: what is not linear in them is no more than the error of the finer run.
    let (g, w) = (1e-2, omega());
    let period = std::f64::consts::TAU / w;
    let rest = -RHO * HEIGHT * HEIGHT * g / (2.0 * E);
    let runs = [1e-3, 1e-3 / 64.0].map(|tolerance| {
        let mut scene = bar(json!({
            "dynamics": { "tolerance": tolerance }, "end_time": 5.0 * period, "newton": { "tolerance": 1e-10 }
        }));
        scene["loads"] = json!({ "weight": { "on": "b", "gravity": [0, 0, -g] } });
        let mut worst = 0.0f64;
        let simulation = run(&scene, |s| {
            let exact = rest * (1.0 - (w * s.time()).cos());
            worst = worst.max((top(s) - exact).abs() / rest.abs());
        });
        (simulation.steps(), worst)
    });
    println!("{runs:?}");
    let [(few, coarse), (many, fine)] = runs;
    let ratio = f64::from(many) / f64::from(few);
    assert!((3.2..4.8).contains(&ratio), "{ratio}");
    // Over all steps, second order in their size.
    assert!(
        coarse < 0.4 && (10.0..20.0).contains(&(coarse / fine)),
        "{coarse} {fine}"
    );
}
