//! Collisions that must not depend on who looks at them.
use super::steps;
use crate::gauntlet::drawn::difference;
use crate::gauntlet::{CaseError, Outcome, Trial};
use covact_geometry::Vec3;
use nalgebra::{Rotation3, Unit};
use serde_json::{Value, json};

/// Units of length, time and mass.
struct Units([f64; 3]);

impl Units {
    fn force(&self) -> f64 {
        let [length, time, mass] = self.0;
        mass * length / (time * time)
    }
}

/// Two cubes that collide aslant with friction, both moved along by `speed`.
fn collision(units: &Units, speed: Vec3) -> Value {
    let [length, time, mass] = units.0;
    let stress = units.force() / (length * length);
    let cube = |min: [f64; 3], v: Vec3| {
        let max = min.map(|x| (x + 1.0) * length);
        let v = (v + speed) * (length / time);
        json!({
            "mesh": { "block": { "min": min.map(|x| x * length), "max": max, "elements": [3, 3, 3] } },
            "material": "m",
            "element": "h8_displacement",
            "velocity": [v.x, v.y, v.z]
        })
    };
    json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 50.0 * stress, "nu": 0.3, "density": mass / length.powi(3) } } },
        "bodies": {
            "a": cube([0.0; 3], Vec3::new(0.6, 0.2, 0.0)), "b": cube([1.05, 0.3, 0.2], Vec3::new(-0.6, 0.0, 0.1))
        },
        "contacts": { "hit": {
            "slave": "a.x_max", "master": "b.x_min", "points": { "gauss": 2 }, "passes": "one", "friction": 0.2,
            "penalty": { "value": 500.0 * stress / length }, "tangential_penalty": { "value": 200.0 * stress / length }
        } },
        "probes": { "a": { "body": "a" }, "b": { "body": "b" } },
        "solution": steps(0.01 * time, 0.6 * time),
        "output": { "every": 0 }
    })
}

const COLLISION: [&str; 7] = [
    "slave.force.hit.x",
    "slave.force.hit.y",
    "slave.force.hit.z",
    "energy.internal",
    "energy.contact",
    "energy.dissipated",
    "pressure.max",
];

const ONE: Units = Units([1.0; 3]);

/// That the cubes have come back from each other.
fn rebounds(trial: &mut Trial, out: &Outcome) -> Result<(), CaseError> {
    let force = out.column("slave.force.hit.x")?;
    let largest = force.iter().fold(0.0f64, |l, f| l.max(f.abs()));
    trial.holds(
        "they rebound",
        largest > 1.0 && out.last("points.active")? == 0.0,
    );
    Ok(())
}

pub fn frame(trial: &mut Trial) -> Result<(), CaseError> {
    let rest = trial.done(&collision(&ONE, Vec3::zeros()))?;
    rebounds(trial, &rest)?;
    let moving = trial.done(&collision(&ONE, Vec3::new(0.5, 1.0, -0.5)))?;
    let off = difference(&rest, &moving, &COLLISION)?;
    trial.within("forces and energies", off, 1e-9);
    // Forces of both sides cancel in every step.
    let imbalance = rest.column("imbalance.force.hit")?;
    let force = rest.column("slave.force.hit.x")?;
    let largest = force.iter().fold(0.0f64, |l, f| l.max(f.abs()));
    let worst = imbalance.iter().copied().fold(0.0, f64::max);
    trial.within("forces of both sides together", worst / largest, 1e-12);
    trial.iterations(555);
    Ok(())
}

pub fn units(trial: &mut Trial) -> Result<(), CaseError> {
    let here = trial.done(&collision(&ONE, Vec3::zeros()))?;
    rebounds(trial, &here)?;
    let own = Units([1e-3, 1e-6, 1e4]);
    let there = trial.done(&collision(&own, Vec3::zeros()))?;
    let (length, force) = (own.0[0], own.force());
    for name in COLLISION {
        let unit = match name {
            name if name.starts_with("slave") => force,
            "pressure.max" => force / (length * length),
            _ => force * length,
        };
        let [a, b] = [here.column(name)?, there.column(name)?];
        let scale = a.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        trial.holds(
            format!("{name} is something"),
            scale > 0.0 && a.len() == b.len(),
        );
        let off = a.iter().zip(&b).map(|(a, b)| (b / unit - a).abs() / scale);
        trial.within(name, off.fold(0.0, f64::max), 1e-9);
    }
    trial.iterations(560);
    Ok(())
}

/// A block that flies and spins towards a wall, both turned in space.
fn thrown(turn: &Rotation3<f64>, to: Vec3) -> Value {
    let (axis, angle) = turn
        .axis_angle()
        .map_or((Vec3::z(), 0.0), |(a, r)| (a.into_inner(), r));
    let placement = json!({
        "axis": [axis.x, axis.y, axis.z], "angle": angle.to_degrees(), "translation": [to.x, to.y, to.z]
    });
    let list = |v: Vec3| [v.x, v.y, v.z];
    let v = turn * Vec3::new(0.3, -0.1, -1.0);
    let spin = turn * Vec3::new(0.4, 0.7, -0.2);
    let inside = turn * Vec3::new(0.0, 0.0, 5.0) + to;
    json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 50, "nu": 0.3, "density": 1 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0.05], "max": [1.5, 1, 0.65], "elements": [4, 3, 2] } },
            "material": "m",
            "placement": placement,
            "velocity": list(v),
            "spin": { "rate": list(spin) }
        } },
        "surfaces": { "wall": {
            "plane": { "size": [20, 20] }, "placement": placement, "side": { "point": list(inside) }
        } },
        "contacts": { "hit": {
            "slave": "block", "master": "wall", "points": { "gauss": 2 }, "friction": 0.3,
            "penalty": { "value": 500 }, "tangential_penalty": { "value": 200 }
        } },
        "solution": steps(0.01, 0.6),
        "output": { "every": 0 }
    })
}

pub fn askew(trial: &mut Trial) -> Result<(), CaseError> {
    let axis = Unit::new_normalize(Vec3::new(-1.0, 0.4, 2.0));
    let turn = Rotation3::from_axis_angle(&axis, 131f64.to_radians());
    let here = trial.done(&thrown(&Rotation3::identity(), Vec3::zeros()))?;
    let there = trial.done(&thrown(&turn, Vec3::new(4.0, -7.0, 2.0)))?;
    let columns = [
        "energy.internal",
        "energy.contact",
        "energy.kinetic",
        "energy.dissipated",
        "pressure.max",
    ];
    let off = difference(&here, &there, &columns)?;
    trial.within("energies and pressure", off, 1e-9);
    let read = |out: &Outcome| -> Result<Vec<Vec3>, CaseError> {
        let [x, y, z] = ["x", "y", "z"].map(|a| out.column(&format!("force.wall.{a}")));
        let (x, y, z) = (x?, y?, z?);
        Ok((0..x.len()).map(|i| Vec3::new(x[i], y[i], z[i])).collect())
    };
    let [a, b] = [read(&here)?, read(&there)?];
    let largest = a.iter().map(Vec3::norm).fold(0.0, f64::max);
    trial.holds("it hits", largest > 1.0);
    let off = a.iter().zip(&b).map(|(a, b)| (turn * a - b).norm());
    let off = off.fold(0.0, f64::max);
    trial.within("forces", off / largest, 1e-9);
    trial.iterations(560);
    Ok(())
}
