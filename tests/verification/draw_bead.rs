//! Elastic sheet drawn through a draw bead against a back tension, with friction on three rollers: two shoulders and the
//! bead.
//!
//! ```text
//!      back        shoulder          bead           shoulder
//!   <--------___                                  ___--------->  pull
//!               '.--.    \              /    .--.'
//!                (    )   '.          .'   (      )
//!                 '--'      '.______.'      '----'
//! ```
//!
//! Closed form, chained from the tail to the pull. Free spans are elasticas (A. E. H. Love, "A Treatise on the Mathematical
//! Theory of Elasticity", 4th ed. 1927, articles 262 and 263): the force F is constant, and so is
//! `H = T + M^2 / 2 EI`, T being the tension at the middle of the sheet. On a roller of radius R the middle of the sheet has
//! the radius `r = R + h/2`, the moment EI / r, and `B = EI / 2 r^2`; where it lifts off there is a line force, equal to the
//! shear force V of the span. Friction acts at the face, so that the power of sliding along the sheet's own shape is
//! `dH = mu (R / r) dN` for every normal force dN: a line force adds `mu (R / r) V` to H, and a wrap multiplies `H - B`
//! by `exp(k theta)` with `k = mu (R / r) / (1 + mu k h / 2 r)` (capstan with thickness and bending stiffness). Spans begin and
//! end with the same angle to their force, because H and B are the same there; their middle is the middle between the
//! centres of the rollers. Neglected: jumps of the moment at line forces (mu h V / 2 against EI / r), shear, stretch.
//!
//! Without friction all H are equal: an elastic sheet is bent and straightened without any restraint.
use crate::drawn_scenes::effort;
use crate::support::{Outcome, scene_json, solve};
use serde_json::json;

const H: f64 = 1.0;
const R: f64 = 8.0;
const RM: f64 = R + 0.5 * H;
const WIDTH: f64 = 2.0;
const EI: f64 = 1000.0 / (1.0 - 0.3 * 0.3) * H * H * H / 12.0;
const B: f64 = EI / (2.0 * RM * RM);
/// Centres of shoulders and bead, apart.
const ACROSS: [f64; 2] = [18.0, 8.0];
const BACK_TENSION: f64 = 15.0;

/// What a span does where it lifts off: its slope (downwards on the way into the bead) and shear force.
#[derive(Clone, Copy)]
struct LiftOff {
    slope: f64,
    shear: f64,
}

/// A span from a roller to a point without moment in the direction `across` from its centre (along x, and up).
fn span(h: f64, across: [f64; 2]) -> LiftOff {
    let distance = across[0].hypot(across[1]);
    // In the frame of the force: angle at lift-off, point without moment as seen from the centre.
    let at = |excess: f64| {
        let f = h * (1.0 + excess);
        let (a, b) = (-(h / f).acos(), -((h - B) / f).acos());
        let mut to = [RM * b.sin(), RM * b.cos()];
        // psi = a + (b - a) v^2 takes the root out of the curvature at the end without moment.
        let n = 2000;
        for i in 0..n {
            let v = (f64::from(i) + 0.5) / f64::from(n);
            let psi = a + (b - a) * v * v;
            let fall = 2.0 * (0.5 * (psi + a)).sin() * (0.5 * (psi - a)).sin();
            let ds = 2.0 * (a - b) * v / (2.0 * f / EI * fall).sqrt() / f64::from(n);
            to[0] += psi.cos() * ds;
            to[1] -= psi.sin() * ds;
        }
        (to, b, f)
    };
    let (mut low, mut high) = (1e-14f64, 10.0f64);
    for _ in 0..80 {
        let middle = (low * high).sqrt();
        let (to, ..) = at(middle);
        if to[0].hypot(to[1]) > distance {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (to, b, f) = at(low);
    let force = to[1].atan2(to[0]) - across[1].atan2(across[0]);
    LiftOff {
        slope: force + b,
        shear: -f * b.sin(),
    }
}

/// A long end of the sheet to a hinge at the level of the roller's top, `length` from its centre: where it lifts off (the
/// slope counted towards the roller), and the horizontal force at the hinge.
fn end(h: f64, length: f64) -> (LiftOff, f64) {
    let b = (1.0 - B / h).acos();
    let lever = RM * b.cos() + EI / (RM * h);
    let distance = length.hypot(RM);
    let tilt = (lever / distance).asin() - (RM / distance).asin();
    let lift_off = LiftOff {
        slope: b - tilt,
        shear: h * b.sin(),
    };
    (lift_off, h * tilt.cos())
}

/// H beyond a roller that is left with `out(H)`, and how the sheet lifts off there.
fn roller(mu: f64, h: f64, before: LiftOff, out: impl Fn(f64) -> LiftOff) -> (f64, LiftOff) {
    let line = mu * R / RM;
    let k = (0..50).fold(0.0, |k, _| line / (1.0 + mu * k * H / (2.0 * RM)));
    let mut beyond = h;
    for _ in 0..40 {
        let after = out(beyond);
        let wrap = before.slope + after.slope;
        assert!(wrap > 0.0, "no wrap: {wrap}");
        beyond = B + (h + line * before.shear - B) * (k * wrap).exp() + line * after.shear;
    }
    (beyond, out(beyond))
}

/// Horizontal force of the pull per width, hinges at these distances from the shoulders.
fn pull(mu: f64, tail: f64, head: f64) -> f64 {
    let mut h = BACK_TENSION;
    for _ in 0..20 {
        h *= BACK_TENSION / end(h, tail).1;
    }
    let half = [0.5 * ACROSS[0], 0.5 * ACROSS[1]];
    let turned = |l: LiftOff| LiftOff {
        slope: -l.slope,
        ..l
    };
    let (h, first) = roller(mu, h, turned(end(h, tail).0), |h| span(h, half));
    let (h, second) = roller(mu, h, first, |h| span(h, half));
    let (h, _) = roller(mu, h, second, |h| turned(end(h, head).0));
    end(h, head).1
}

/// The shipped scene up to 7.2 mm of the stroke, in steps of this length (0.01 is shipped).
fn draw(mu: f64, step: f64) -> Outcome {
    let mut scene = scene_json("draw_bead.json");
    for side in ["above", "below"] {
        scene["contacts"][side]["friction"] = json!({ "coulomb": { "mu": mu } });
    }
    scene["solution"]["end_time"] = json!(1.6);
    scene["solution"]["step"]["initial"] = json!(step);
    scene["solution"]["step"]["max"] = json!(step);
    scene["output"]["every"] = json!((0.1 / step).round() as u32);
    let outcome = solve(&scene);
    let summary = &outcome.summary;
    assert_eq!(summary.status.name(), "done", "{:?}", summary.reason);
    let (cuts, iterations) = effort(&outcome);
    println!("mu {mu}: {iterations} iterations a step");
    assert!(cuts == 0.0 && iterations <= 8.0, "{cuts} {iterations}");
    outcome
}

/// Mean of the pull per width, and half its swing, over the last six elements.
fn mean(outcome: &Outcome) -> (f64, f64) {
    let force = outcome.column("force.pull.x");
    let last = &force[force.len() - 50..];
    let (low, high) = last
        .iter()
        .fold((f64::MAX, f64::MIN), |(a, b), f| (a.min(*f), b.max(*f)));
    let mean = last.iter().sum::<f64>() / 50.0;
    (mean / WIDTH, 0.5 * (high - low) / WIDTH)
}

/// Displacement of the tail at a step that was written.
fn tail(outcome: &Outcome, step: u32) -> f64 {
    let body = outcome.body("sheet", step);
    let u = body.field("displacement");
    let nodes: Vec<usize> = (0..body.points.len())
        .filter(|&i| body.points[i][0] < -80.0 + 1e-9)
        .collect();
    assert_eq!(nodes.len(), 4);
    nodes.iter().map(|i| u[3 * i]).sum::<f64>() / 4.0
}

#[test]
fn pull_is_that_of_elasticas_between_wraps() {
    let outcome = draw(0.15, 0.01);
    let (f, swing) = mean(&outcome);
    let to = tail(&outcome, 160);
    // Hinges midway through the last six elements.
    let head = 32.0 + 12.0 * 0.35 - ACROSS[0];
    let expected = pull(0.15, 80.0 - ACROSS[0] - to, head);
    let flexible = BACK_TENSION * (0.15 * R / RM * flexible_wrap()).exp();
    println!("pull {f} +- {swing}, chain {expected}, without bending stiffness {flexible}");
    assert!((f / expected - 1.0).abs() < 5e-3);
    // What the test can see: bending is 3 % of the pull.
    assert!((flexible / expected - 1.0).abs() > 2e-2);
    assert!(swing < 1.5e-3 * f, "{swing}");
    // Everything slides.
    let (slip, active) = (
        outcome.column("points.slip"),
        outcome.column("points.active"),
    );
    assert!(slip.last() == active.last() && slip[159] > 40.0, "{slip:?}");

    // Measured: .0092 and .0025 of what is dissipated (.0006 at half the step).
    let (coarse, fine) = (lost(&draw(0.15, 0.02)), lost(&outcome));
    println!(
        "work not found: {coarse}, {fine}, rate {}",
        (coarse / fine).log2()
    );
    assert!(fine < 3e-3 && (coarse / fine).log2() > 1.7);
}

/// Work done since everything slides that is neither stored nor dissipated, as a part of what is dissipated.
fn lost(outcome: &Outcome) -> f64 {
    let (force, time) = (outcome.column("force.pull.x"), outcome.column("time"));
    let last = time.len() - 1;
    let first =
        (time.iter().position(|t| (t - 1.1).abs() < 1e-9)).expect("a step that ends at 1.1");
    let work: f64 = (first + 1..=last)
        .map(|i| 0.5 * (force[i] + force[i - 1]) * 12.0 * (time[i] - time[i - 1]))
        .sum();
    let [from, to] = [first, last].map(|row| tail(outcome, row as u32 + 1));
    let change = |name: &str| {
        let column = outcome.column(name);
        column[last] - column[first]
    };
    let stored = ["energy.internal", "energy.contact", "energy.friction"].map(change);
    let dissipated = change("energy.dissipated");
    assert!(dissipated > 0.2 * work);
    (work - WIDTH * BACK_TENSION * (to - from) - stored.iter().sum::<f64>()) / dissipated - 1.0
}

#[test]
fn an_elastic_sheet_without_friction_is_not_held_back() {
    let (f, swing) = mean(&draw(0.0, 0.01));
    let expected = pull(0.0, 50.0, 32.0 + 12.0 * 0.35 - ACROSS[0]);
    println!("pull {f} +- {swing}, chain {expected}");
    // Both hinges pull at a slant, by less than this.
    assert!((expected / BACK_TENSION - 1.0).abs() < 1e-3, "{expected}");
    assert!((f / expected - 1.0).abs() < 2e-4, "{f}");
    assert!(swing < 1.5e-3 * f, "{swing}");
}

/// Wrap of a sheet without bending stiffness, rollers together.
fn flexible_wrap() -> f64 {
    let distance = ACROSS[0].hypot(ACROSS[1]);
    4.0 * ((2.0 * RM / distance).asin() - ACROSS[1].atan2(ACROSS[0]))
}
