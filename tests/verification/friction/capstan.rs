//! Belt drawn over a rigid cylinder: the capstan formula (L. Euler, "Remarques sur l'effet du frottement dans l'equilibre",
//! 1769; J. A. Eytelwein, 1808) for a belt that is stiff in bending and thick.
//!
//! ```text
//!      T1 <----- ,-----.         The belt is flat and stress-free before it is wrapped, and drawn so far that every
//!              /    R    \       point in contact slides. The wrap angle theta is the angle between the two end forces,
//!             |     +     |      wherever the belt lifts off: T1 is a dead load, and the direction of T2 is that of the
//!              \         /       reaction (the clamp at the drawn end turns it by up to .3 degrees from the tangent,
//!      T2 <----- `-----'         because the tail is straight only nearly where it is clamped).
//! ```
//!
//! With the bending stiffness EI, the middle of the belt at `r = R + h/2` and `B = EI / 2 r^2`:
//!
//! * in a free tail `EI kappa^2 / 2 + T` is constant (T along the belt), so T is smaller by B where the curvature is 1/r: the
//!   tensions of the wrapped part are `T1 - B` and `T2 - B`;
//! * a piece `d phi` of the wrapped part, where the moment EI/r is constant, is in equilibrium with its shear force Q for
//!   `N' = t R^2 / r`, `Q = t R h / 2r`, `N - Q' = p R`; with `t = mu p` all grow as `exp(k phi)`, where
//!   `k = mu (R / r) / (1 + mu k h / 2r)`.
//!
//! Together `(T2 - B) / (T1 - B) = exp(k theta)`. What is left out is of the order `mu^2 B (1/T1 - 1/T2)`, the friction of the
//! line forces at the lift-offs: 1e-4 here.
use crate::support::{Outcome, scene_json, set, solve};
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

const R: f64 = 50.0;
const H: f64 = 0.5;
const RM: f64 = R + 0.5 * H;
const WIDTH: f64 = 20.0;
/// Modulus in plane strain.
const E: f64 = 2000.0 / (1.0 - 0.3 * 0.3);
const B: f64 = E * H * H * H / 12.0 / (2.0 * RM * RM);
/// Tension per width at the drawn-in end.
const T1: f64 = 3.0;
/// Length of an element.
const ELEMENT: f64 = 1.25;

/// `T2 / T1` for the wrap angle `theta`.
fn ratio(mu: f64, theta: f64) -> f64 {
    let mut k = mu;
    for _ in 0..50 {
        k = mu * (R / RM) / (1.0 + mu * k * H / (2.0 * RM));
    }
    (B + (T1 - B) * (k * theta).exp()) / T1
}

/// The shipped scene with shorter tails and another wrap angle (degrees), wrapped at time 1 and drawn by `draw` a unit of
/// time from there on.
fn belt(angle: f64, draw: f64, until: f64) -> Value {
    let mut scene = scene_json("strip_drawn.json");
    let (tail, out) = (20.0, 15.0);
    let wrap = RM * angle.to_radians();
    let elements = ((tail + wrap + out) / ELEMENT).round();
    let mesh = "/bodies/strip/mesh/plate";
    set(&mut scene, &format!("{mesh}/size/0"), elements * ELEMENT);
    set(&mut scene, &format!("{mesh}/elements/0"), elements as u32);
    set(&mut scene, &format!("{mesh}/origin/0"), -tail);
    let turn = format!("{}*min(1,t)", angle.to_radians());
    let arm = format!("(x-{RM}*{turn}+{draw}*max(0,t-1))");
    let end = "/supports/end/displacement";
    set(
        &mut scene,
        &format!("{end}/x"),
        format!("({R}+z)*sin({turn})+{arm}*cos({turn})-x"),
    );
    set(
        &mut scene,
        &format!("{end}/z"),
        format!("({R}+z)*cos({turn})-{R}-{arm}*sin({turn})-z"),
    );
    let full = -T1 * WIDTH;
    set(
        &mut scene,
        "/loads/tension/force/0",
        json!({"table": [[0, 0], [0.05, full], [until, full]]}),
    );
    set(&mut scene, "/solution/end_time", until);
    scene["output"] = json!({"every": 0});
    scene
}

/// `T2 / T1` and the wrap angle at a step.
fn measured(outcome: &Outcome, row: usize) -> (f64, f64) {
    let [x, z] = ["x", "z"].map(|a| outcome.column(&format!("force.end.{a}"))[row]);
    (x.hypot(z) / (T1 * WIDTH), (-z).atan2(x).rem_euclid(TAU))
}

fn row_at(outcome: &Outcome, time: f64) -> usize {
    let times = outcome.column("time");
    (times.iter().position(|t| (t - time).abs() < 1e-9)).expect("a step ends there")
}

fn report(outcome: &Outcome) -> f64 {
    let s = &outcome.summary;
    let average = s.newton_iterations as f64 / f64::from(s.steps);
    println!("{} steps, {average:.1} iterations a step", s.steps);
    average
}

/// The coefficient rises from .1 to .2 and .3 while the belt is drawn.
#[test]
fn tensions_of_a_belt() {
    // Bending and thickness matter: without them the formula is off by as much as is asked for here.
    assert!((ratio(0.3, PI) / (0.3 * PI).exp() - 1.0).abs() > 5e-3);
    for angle in [90.0f64, 180.0] {
        let mut scene = belt(angle, 1.5, 4.0);
        set(
            &mut scene,
            "/contacts/wrap/friction/coulomb/mu",
            json!({"table": [[0, 0.1], [2, 0.1], [2.2, 0.2], [3, 0.2], [3.2, 0.3], [4, 0.3]]}),
        );
        set(&mut scene, "/solution/step/initial", 0.05);
        set(&mut scene, "/solution/step/max", 0.25);
        set(&mut scene, "/solution/stops", vec![1, 2, 3]);
        let outcome = solve(&scene);
        report(&outcome);
        for (mu, time) in [(0.1, 2.0), (0.2, 3.0), (0.3, 4.0)] {
            let row = row_at(&outcome, time);
            assert_eq!(outcome.column("points.stick")[row], 0.0);
            assert!(outcome.column("points.slip")[row] > angle);
            let (ours, theta) = measured(&outcome, row);
            let turned = theta - angle.to_radians();
            let error = ours / ratio(mu, theta) - 1.0;
            let nominal = ours / ratio(mu, angle.to_radians()) - 1.0;
            println!(
                "{angle} degrees ({:+.3}), mu {mu}: T2/T1 {ours:.5}, off by {error:+.1e} (nominal angle {nominal:+.1e})",
                turned.to_degrees()
            );
            // Measured: up to 1.5e-4, and 8e-4 with the nominal angle.
            assert!(turned.abs() < 0.5f64.to_radians());
            assert!(error.abs() < 3e-4 && nominal.abs() < 3e-3);
        }
    }
}

/// The same tensions where the pressure is that of nodes with averaged gaps.
#[test]
fn tensions_of_a_belt_with_averaged_gaps() {
    for points in [2, 3] {
        let mut scene = belt(90.0, 1.5, 2.5);
        scene["contacts"]["wrap"]["gap"] = json!("averaged");
        scene["contacts"]["wrap"]["points"] = json!({"gauss": points});
        set(&mut scene, "/solution/step/initial", 0.05);
        set(&mut scene, "/solution/step/max", 0.25);
        let outcome = solve(&scene);
        report(&outcome);
        let row = row_at(&outcome, 2.5);
        assert_eq!(outcome.column("points.stick")[row], 0.0);
        let (ours, theta) = measured(&outcome, row);
        let error = ours / ratio(0.3, theta) - 1.0;
        println!("{points} points: T2/T1 {ours:.5}, off by {error:+.1e}");
        assert!(error.abs() < 1e-3);
    }
}

/// The shipped scene, wrapped by half a turn and drawn by 16 elements.
#[test]
fn the_shipped_belt() {
    let mut scene = scene_json("strip_drawn.json");
    scene["output"] = json!({"every": 0});
    let outcome = solve(&scene);
    assert!(report(&outcome) <= 8.0);
    assert_eq!(outcome.summary.cuts, 0);
    let times = outcome.column("time");
    let (stick, slip) = (
        outcome.column("points.stick"),
        outcome.column("points.slip"),
    );
    // While the belt is wrapped the friction holds it: it does not slide as a whole.
    let wrapped = row_at(&outcome, 1.0);
    assert!(stick[wrapped] > 0.5 * slip[wrapped + 20]);
    let sliding: Vec<usize> = (0..times.len()).filter(|i| times[*i] > 1.2).collect();
    assert!(sliding.len() > 20);
    let mut worst = 0.0f64;
    for &row in &sliding {
        assert_eq!(stick[row], 0.0);
        let (ours, theta) = measured(&outcome, row);
        worst = worst.max((ours / ratio(0.3, theta) - 1.0).abs());
    }
    println!("off by at most {worst:.1e} over {} steps", sliding.len());
    // Measured: 2e-4, over every position of the nodes.
    assert!(worst < 1e-3);
}

/// Mean over one element of sliding of `ln(T2 / T1)` less that of the closed form, on a quarter of a circle of `facets`
/// facets.
fn facet_error(facets: u32) -> f64 {
    let (mu, settled, samples) = (0.3, 3.5, 10);
    let until = settled + ELEMENT;
    let mut scene = belt(90.0, 1.0, until);
    // The exact cylinder is one patch of a full turn.
    let count = [4 * facets, 1];
    scene["surfaces"]["cylinder"]["facets"] = json!({"kind": "bilinear", "count": count});
    scene["contacts"]["wrap"]["points"] = json!({"gauss": 4});
    let mut stops = vec![1.0, settled];
    stops.extend((1..samples).map(|i| settled + ELEMENT * f64::from(i) / f64::from(samples)));
    set(&mut scene, "/solution/stops", stops);
    set(&mut scene, "/solution/step/max", 0.5);
    let outcome = solve(&scene);
    let rows: Vec<usize> = (outcome.column("time").iter().enumerate())
        .filter(|(_, t)| **t > settled + 1e-9)
        .map(|(row, _)| row)
        .collect();
    let stick = outcome.column("points.stick");
    assert!(rows.len() >= samples as usize && rows.iter().all(|row| stick[*row] == 0.0));
    let errors = rows.iter().map(|row| {
        let (ours, theta) = measured(&outcome, *row);
        (ours / ratio(mu, theta)).ln()
    });
    let mean = errors.sum::<f64>() / rows.len() as f64;
    println!("{facets} facets: mean of ln(T2/T1) off by {mean:+.5}");
    mean
}

/// Over a corner with the angle d between two facets `T2 / T1` is off by up to d^2 / 2 one way or the other, as points of
/// one facet or of the other carry the line force, and by the third power of d where they share it: the mean while the
/// belt slides by an element is of the second order at least.
#[test]
fn facets_converge_with_the_square_of_their_length() {
    // What the element length leaves on the exact cylinder is 3e-5.
    let errors = [5, 10, 20].map(|n| facet_error(n).abs());
    let rate = (errors[0] / errors[2]).log2() / 2.0;
    println!("{errors:.5?}: rate {rate:.2}");
    assert!(errors[0] > errors[1] && errors[1] > errors[2]);
    assert!(rate > 1.7, "rate {rate:.2}");
    assert!(errors[0] < 0.03 && errors[2] < 1e-3);
}
