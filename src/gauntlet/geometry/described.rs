//! The same surface in another description.
use super::super::scenes::block_under;
use super::{Case, CaseError, Trial, difference, tool};
use covact_geometry::basis::Basis;
use covact_geometry::primitives::{cylinder, sphere, sphere_without_poles};
use covact_geometry::{NurbsPatch, Vec3};
use nalgebra::{Isometry3, Vector3};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

pub const POLE: Case = Case {
    name: "pole",
    what: "a ball pressed into a block with its pole on a slave point, next to one, and between them",
    right: "as the ball of six patches without poles, to 1e-9",
    run: pole,
};

pub const SEAM: Case = Case {
    name: "seam",
    what: "a cylinder pressed into a block with its seam, or a knot line, along slave points",
    right: "as the cylinder turned until neither is in contact, to 1e-9",
    run: seam,
};

pub const WEIGHTS: Case = Case {
    name: "weights",
    what: "a ball of six patches whose weights run over six decades (another parametrisation)",
    right: "as the ball with even weights, to 1e-8",
    run: weights,
};

pub const SHORT_SPAN: Case = Case {
    name: "short_span",
    what: "a ball with a span of 1e-8 of its domain in the middle of the contact",
    right: "as the ball without, to 1e-9",
    run: short_span,
};

pub const SLIVER: Case = Case {
    name: "sliver",
    what: "a cylinder cut so that a patch 1e4 times as long as wide lies in the contact",
    right: "as the cylinder uncut, to 1e-9",
    run: sliver,
};

pub const REVERSED_PATCH: Case = Case {
    name: "reversed_patch",
    what: "a ball of six patches, two of which the file turns inside out",
    right: "as the ball with all turned out, to 1e-9",
    run: reversed_patch,
};

const RADIUS: f64 = 0.5;
const DOWN: [&str; 3] = ["0", "0", "-0.1*t"];

fn center() -> Vec3 {
    Vec3::new(0.0, 0.0, 1.0 + RADIUS - 0.5)
}

/// The block with slave points at nodes, one of them at the middle of its top.
fn at_nodes(tool: Value) -> Value {
    let mut scene = block_under(tool, 6, 3);
    scene["contacts"]["press"]["points"] = "nodes".into();
    scene
}

fn pole(trial: &mut Trial) -> Result<(), CaseError> {
    for (shift, name) in [
        (0.0, "on"),
        (1e-9, "1e-9"),
        (1e-6, "1e-6"),
        (0.04, "between"),
    ] {
        let at = center() + Vec3::new(shift, 0.0, 0.0);
        let six = sphere_without_poles(RADIUS, at, Vec3::new(1.0, 2.0, 3.0))?;
        let six = tool(trial, "six", six.to_vec(), DOWN)?;
        let one = tool(trial, "one", vec![sphere(RADIUS, at, Vec3::z())?], DOWN)?;
        let six = trial.done(&at_nodes(six))?;
        let one = trial.done(&at_nodes(one))?;
        trial.holds("contact", one.last("force.tool.z")? < -1.0);
        trial.within(
            format!("difference, pole {name}"),
            difference(&six, &one)?,
            1e-9,
        );
        let more = one.summary.newton_iterations as f64 - six.summary.newton_iterations as f64;
        trial.within("iterations more", more.max(0.0), 1.0);
    }
    trial.iterations(200);
    Ok(())
}

fn seam(trial: &mut Trial) -> Result<(), CaseError> {
    // The seam lies where x is largest; a turn about y takes it down.
    let round = cylinder(RADIUS, 3.0, Vec3::zeros(), Vec3::y())?;
    let turned = |angle: f64| {
        let turn = Vector3::y() * angle;
        round.moved(&Isometry3::new(center(), turn), 1.0)
    };
    let away = tool(trial, "away", vec![turned(0.5 * FRAC_PI_4)?], DOWN)?;
    let away = trial.done(&at_nodes(away))?;
    trial.holds("contact", away.last("force.tool.z")? < -1.0);
    for (name, angle) in [("seam", FRAC_PI_2), ("knot line", 0.0)] {
        let tool = tool(trial, "turned", vec![turned(angle)?], DOWN)?;
        let other = trial.done(&at_nodes(tool))?;
        trial.within(
            format!("difference, {name}"),
            difference(&away, &other)?,
            1e-9,
        );
    }
    trial.iterations(60);
    Ok(())
}

/// The patch with weights `c^(i + j)` times as large: of one Bezier piece another parametrisation.
fn reweighted(patch: &NurbsPatch, c: f64) -> Result<NurbsPatch, CaseError> {
    let columns = patch.counts()[0];
    let points = patch.homogeneous().iter().enumerate();
    let points = points.map(|(k, p)| p.map(|x| x * c.powi((k % columns + k / columns) as i32)));
    let basis: [Basis; 2] = [0, 1].map(|d| patch.basis(d).clone());
    Ok(NurbsPatch::from_homogeneous(basis, points.collect())?)
}

fn weights(trial: &mut Trial) -> Result<(), CaseError> {
    let six = sphere_without_poles(RADIUS, center(), Vec3::z())?;
    let even = tool(trial, "even", six.to_vec(), DOWN)?;
    let even = trial.done(&block_under(even, 6, 3))?;
    trial.holds("contact", even.last("force.tool.z")? < -1.0);
    // 8 steps of c from corner to corner.
    for c in [10.0f64.powf(0.75), 10.0f64.powf(-0.75)] {
        let patches = six
            .iter()
            .map(|p| reweighted(p, c))
            .collect::<Result<_, _>>()?;
        let tool = tool(trial, "uneven", patches, DOWN)?;
        let uneven = trial.done(&block_under(tool, 6, 3))?;
        trial.within("difference", difference(&even, &uneven)?, 1e-8);
    }
    trial.iterations(60);
    Ok(())
}

fn short_span(trial: &mut Trial) -> Result<(), CaseError> {
    let six = sphere_without_poles(RADIUS, center(), Vec3::z())?.to_vec();
    let plain = tool(trial, "plain", six.clone(), DOWN)?;
    let plain = trial.done(&at_nodes(plain))?;
    trial.holds("contact", plain.last("force.tool.z")? < -1.0);
    let cut = |p: NurbsPatch| -> Result<NurbsPatch, CaseError> {
        let mut p = p;
        for dir in 0..2 {
            let [a, b] = p.domain()[dir];
            let (middle, half) = (0.5 * (a + b), 0.5e-8 * (b - a));
            p = p.insert_knots(dir, &[middle - half, middle + half])?;
        }
        Ok(p)
    };
    let patches = six.into_iter().map(cut).collect::<Result<_, _>>()?;
    let tool = tool(trial, "short", patches, DOWN)?;
    let short = trial.done(&at_nodes(tool))?;
    trial.within("difference", difference(&plain, &short)?, 1e-9);
    trial.iterations(40);
    Ok(())
}

fn sliver(trial: &mut Trial) -> Result<(), CaseError> {
    let round = cylinder(RADIUS, 3.0, center(), Vec3::y())?;
    let whole = tool(trial, "whole", vec![round.clone()], DOWN)?;
    let whole = trial.done(&at_nodes(whole))?;
    trial.holds("contact", whole.last("force.tool.z")? < -1.0);
    // The lowest line is the knot line at pi/2; a strip of width 3e-4 beside it and one over it.
    let width = 3e-4 / RADIUS;
    for (name, start) in [("over the lowest line", -0.4 * width), ("beside it", 0.01)] {
        let start = FRAC_PI_2 + start;
        let [below, rest] = round.split(0, start)?;
        let [strip, above] = rest.split(0, start + width)?;
        let tool = tool(trial, "cut", vec![above, strip, below], DOWN)?;
        let cut = trial.done(&at_nodes(tool))?;
        trial.within(
            format!("difference, {name}"),
            difference(&whole, &cut)?,
            1e-9,
        );
    }
    trial.iterations(60);
    Ok(())
}

fn reversed_patch(trial: &mut Trial) -> Result<(), CaseError> {
    let six = sphere_without_poles(RADIUS, center(), Vec3::new(1.0, 2.0, 3.0))?.to_vec();
    let out = tool(trial, "out", six.clone(), DOWN)?;
    let out = trial.done(&block_under(out, 6, 3))?;
    trial.holds("contact", out.last("force.tool.z")? < -1.0);
    let mut mixed = six;
    mixed[0] = mixed[0].reversed(1)?;
    mixed[3] = mixed[3].swapped()?;
    let mut tool = tool(trial, "mixed", mixed, DOWN)?;
    for side in [json!("auto"), json!("reversed")] {
        tool["side"] = side.clone();
        let mixed = trial.done(&block_under(tool.clone(), 6, 3))?;
        trial.within(
            format!("difference, side {side}"),
            difference(&out, &mixed)?,
            1e-9,
        );
    }
    trial.iterations(60);
    Ok(())
}
