//! Equilibria that are lost, and bodies that nothing holds until they touch.
use super::{Broken, Case, Group, Outcome, Trial};
use serde_json::{Value, json};

pub const GROUP: Group = Group {
    name: "instability",
    cases: &[
        Case {
            name: "rests_on_contact_alone",
            what: "cube without supports, dropped .2 above a floor under a dead weight",
            right: "floor force = weight; weight x way = dissipated + stored, first order in the step; told",
            run: rests_on_contact_alone,
        },
        Case {
            name: "first_touch_flush",
            what: "cube without supports, exactly flush on a floor, weight and pull below the friction limit",
            right: "forces = those of the loads; nothing dissipated by friction; at rest",
            run: first_touch_flush,
        },
        Case {
            name: "slides_off",
            what: "the same with a pull above the friction limit",
            right: "ends with a message that names the body, the free motion and how far it has got",
            run: slides_off,
        },
        Case {
            name: "refused_without",
            what: "the same without stabilisation; with it but without contact; and never stopped by its contact",
            right: "each named: the free motion and the remedy",
            run: refused_without,
        },
        Case {
            name: "between_tools",
            what: "cube without supports, .05 off the floor, pressed by a plane from above",
            right: "the same cube held by symmetry supports: forces and energy equal",
            run: between_tools,
        },
        Case {
            name: "soft_support",
            what: "strip of length / thickness 1000, clamped at one end, falls on a floor under its weight",
            right: "the same without stabilisation: floor force and energy equal",
            run: soft_support,
        },
        Case {
            name: "snap_under_dead_load",
            what: "hinged roof (Sze et al. 2004, 3.6), crown force grown past the limit point",
            right: "lands where prescribed crown displacement leads; energy released = dissipated, first order",
            run: snap_under_dead_load,
        },
        Case {
            name: "snap_under_tool",
            what: "thinner roof pushed down by a cylinder, from which it snaps away",
            right: "the end reached by another way (pushed through by a load before the tool comes): equal",
            run: snap_under_tool,
        },
    ],
};

/// A cube of edge 1 and modulus 1000 at height `gap` over a rigid floor with friction `mu`, without supports, under the total
/// force `load` on its top.
fn cube(gap: f64, load: [Value; 3], mu: f64) -> Value {
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "neo_hooke": { "E": 1000, "nu": 0.3 } } },
        "bodies": { "cube": {
            "mesh": { "block": { "min": [0, 0, gap], "max": [1, 1, gap + 1.0], "elements": [3, 3, 3] } },
            "material": "m"
        } },
        "surfaces": { "floor": { "plane": { "size": [10, 10] } } },
        "contacts": { "on_floor": { "slave": "cube.bottom", "master": "floor" } },
        "loads": { "weight": { "on": "cube.top", "force": load } },
        "solution": { "stabilization": { "viscous": {} } },
        "output": { "every": 0 }
    });
    if mu > 0.0 {
        scene["contacts"]["on_floor"]["friction"] = json!({ "coulomb": { "mu": mu } });
    }
    scene
}

/// Grows to the middle of the run and stays.
fn grown(value: f64) -> Value {
    json!({ "table": [[0, 0], [0.5, value], [1, value]] })
}

fn rests_on_contact_alone(trial: &mut Trial) -> Result<(), Broken> {
    let fallen = |trial: &mut Trial, steps: u32| -> Result<(Outcome, f64), Broken> {
        let mut scene = cube(0.2, [json!(0), json!(0), json!(-10)], 0.0);
        let step = 1.0 / f64::from(steps);
        scene["solution"]["step"] = json!({ "initial": step, "max": step, "adaptive": false });
        let outcome = trial.done(&scene)?;
        // The weight falls with the top of the cube, by the gap and what compresses it: twice the stored energy.
        let stored = outcome.last("energy.internal")? + outcome.last("energy.contact")?;
        let work = 10.0 * 0.2 + 2.0 * stored;
        let error = work - stored - outcome.last("energy.stabilization")?;
        Ok((outcome, error / work))
    };
    let (outcome, _) = fallen(trial, 10)?;
    trial.equal("floor force", outcome.last("force.floor.z")?, -10.0, 1e-7);
    trial.within(
        "stabilisation at the end",
        outcome.last("stabilization.share")?,
        1e-7,
    );
    trial.holds(
        "the dissipation is told",
        outcome.warnings("stabilization has dissipated").len() == 1,
    );
    Ok(())
}

fn first_touch_flush(trial: &mut Trial) -> Result<(), Broken> {
    let outcome = trial.done(&cube(0.0, [grown(2.9), json!(0), grown(-10.0)], 0.3))?;
    trial.equal("floor force", outcome.last("force.floor.z")?, -10.0, 1e-7);
    trial.equal("friction force", outcome.last("force.floor.x")?, 2.9, 1e-6);
    Ok(())
}

fn slides_off(trial: &mut Trial) -> Result<(), Broken> {
    let outcome = trial.run(&cube(0.0, [grown(3.1), json!(0), grown(-10.0)], 0.3))?;
    trial.holds(
        "does not end",
        outcome.summary.status.name() == "not_converged",
    );
    trial.says(outcome.reason(), &["cube", "runs away", "along x"]);
    Ok(())
}

fn refused_without(_trial: &mut Trial) -> Result<(), Broken> {
    Ok(())
}

fn between_tools(_trial: &mut Trial) -> Result<(), Broken> {
    Ok(())
}

fn soft_support(_trial: &mut Trial) -> Result<(), Broken> {
    Ok(())
}

fn snap_under_dead_load(_trial: &mut Trial) -> Result<(), Broken> {
    Ok(())
}

fn snap_under_tool(_trial: &mut Trial) -> Result<(), Broken> {
    Ok(())
}
