//! Equilibria that are lost, and bodies that nothing holds until they touch.
use super::{Case, CaseError, Group, Trial};
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
            right: "lands where prescribed crown displacement leads; released = dissipated, first order; passed without help",
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

/// Fixed steps of `1 / n`.
fn fixed(n: u32) -> Value {
    let step = 1.0 / f64::from(n);
    json!({ "initial": step, "max": step, "adaptive": false })
}

fn rests_on_contact_alone(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(250);
    let dead = [json!(0), json!(0), json!(-10)];
    let outcome = trial.done(&cube(0.2, dead.clone(), 0.0))?;
    trial.equal("floor force", outcome.last("force.floor.z")?, 10.0, 1e-7);
    let share = outcome.last("stabilization.share")?;
    trial.within("stabilisation at the end", share, 1e-7);
    let told = outcome.warnings("stabilization has dissipated").len();
    trial.holds("the fall is told", told == 1);
    // Slow enough for the fall and the settling to be followed: all of the energy but an error of first order is dissipated.
    for n in [40, 80] {
        let mut scene = cube(0.2, dead.clone(), 0.0);
        scene["solution"]["stabilization"]["viscous"]["factor"] = json!(0.5);
        scene["solution"]["step"] = fixed(n);
        let outcome = trial.done(&scene)?;
        let left = outcome.last("energy.imbalance")? / outcome.last("energy.external")?;
        // A step that ends in contact loses what the cube would have fallen in it: .268 / n by the weight.
        let what = format!("energy left, {n} steps");
        trial.within(what, left, 1.28 / f64::from(n));
        let told = outcome.warnings("stabilization has dissipated").len();
        trial.holds("what is dissipated is told", told == 1);
    }
    Ok(())
}

/// Flush on the floor under a weight of 10, pulled at its base.
fn pulled(pull: f64) -> Value {
    let mut scene = cube(0.0, [json!(0), json!(0), grown(-10.0)], 0.3);
    scene["loads"]["pull"] = json!({ "on": "cube.bottom", "force": [grown(pull), 0, 0] });
    scene["surfaces"]["floor"]["plane"]["size"] = json!([200, 200]);
    scene
}

fn first_touch_flush(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(200);
    let outcome = trial.done(&pulled(2.9))?;
    trial.equal("floor force", outcome.last("force.floor.z")?, 10.0, 1e-7);
    let friction = outcome.last("force.floor.x")?;
    trial.equal("friction force", friction, -2.9, 1e-7);
    let share = outcome.last("stabilization.share")?;
    trial.within("stabilisation at the end", share, 1e-7);
    // A cube of a few elements is not much softer than its contact, which is told of its displacements.
    let mut others =
        (outcome.summary.warnings.iter()).filter(|w| !w.starts_with("contact gives way"));
    trial.holds("nothing else to warn of", others.next().is_none());
    Ok(())
}

fn slides_off(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(300);
    let outcome = trial.solve(&pulled(6.0))?;
    let status = outcome.summary.status.name();
    trial.holds("ends early", status == "not_converged");
    trial.says(
        outcome.reason(),
        &["body `cube` runs away", "along x", "support"],
    );
    // Only just above the limit it creeps, and the end is no state of rest.
    let outcome = trial.done(&pulled(3.2))?;
    let told = outcome.warnings("body `cube` still moves at the end").len();
    trial.holds("creep is told", told == 1);
    Ok(())
}

fn refused_without(trial: &mut Trial) -> Result<(), CaseError> {
    let mut scene = pulled(2.9);
    scene["solution"]["stabilization"] = json!("none");
    let message = trial.refused(&scene)?;
    let remedy = "`solution.stabilization`";
    trial.says(
        &message,
        &["body `cube` can move freely", "along x", remedy],
    );
    let mut scene = pulled(2.9);
    scene["bodies"]["other"] = scene["bodies"]["cube"].clone();
    let message = trial.refused(&scene)?;
    trial.says(&message, &["body `other`", "no contact", "add a support"]);
    // Lifted off the floor, it never touches.
    let outcome = trial.solve(&cube(0.2, [json!(0), json!(0), json!(10)], 0.0))?;
    trial.says(
        outcome.reason(),
        &["body `cube` runs away", "contact does not stop it"],
    );
    // Without friction nothing holds it sideways once the stabilisation is off.
    let mut scene = cube(0.0, [json!(0), json!(0), grown(-10.0)], 0.0);
    scene["solution"]["stabilization"]["viscous"]["until"] = json!(0.5);
    let outcome = trial.solve(&scene)?;
    trial.says(
        outcome.reason(),
        &["nothing resists body `cube`", "no support hinders", remedy],
    );
    trial.equal(
        "floor force at 0.5",
        outcome.at("force.floor.z", 0.5)?,
        10.0,
        1e-3,
    );
    Ok(())
}

fn between_tools(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(60);
    let newton = json!({ "tolerance": 1e-9 });
    let mut scene = cube(0.05, [json!(0), json!(0), json!(0)], 0.0);
    scene["loads"] = json!({});
    scene["solution"]["newton"] = newton.clone();
    scene["surfaces"]["tool"] = json!({
        "plane": { "size": [10, 10], "center": [0, 0, 1.05] },
        "motion": { "translation": [0, 0, grown(-0.1)] }
    });
    scene["contacts"]["on_floor"]["penalty"] = json!({ "value": 1e5 });
    scene["contacts"]["pressed"] = json!({
        "slave": "cube.top", "master": "tool", "penalty": { "value": 1e5 }
    });
    let free = trial.done(&scene)?;
    // Held at its base by a support, the two penalties in a row are one of half the value.
    let mut scene = cube(0.0, [json!(0), json!(0), json!(0)], 0.0);
    scene["loads"] = json!({});
    scene["solution"] = json!({ "newton": newton });
    scene["surfaces"] = json!({ "tool": {
        "plane": { "size": [10, 10], "center": [0, 0, 1] },
        "motion": { "translation": [0, 0, grown(-0.05)] }
    } });
    scene["contacts"] = json!({ "pressed": {
        "slave": "cube.top", "master": "tool", "penalty": { "value": 5e4 }
    } });
    scene["supports"] = json!({
        "x": { "on": "cube.x_min", "symmetry": "x" },
        "y": { "on": "cube.y_min", "symmetry": "y" },
        "z": { "on": "cube.bottom", "symmetry": "z" }
    });
    let held = trial.done(&scene)?;
    for name in ["force.tool.z", "energy.internal"] {
        trial.equal(name, free.last(name)?, held.last(name)?, 1e-8);
    }
    let (above, below) = (free.last("force.tool.z")?, free.last("force.floor.z")?);
    trial.equal("force of the floor", below, -above, 1e-8);
    Ok(())
}

fn soft_support(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(1400);
    let mut scene = json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1e6, "nu": 0 } } },
        "bodies": { "strip": {
            "mesh": { "plate": {
                "size": [1, 0.05], "thickness": 1e-3, "elements": [20, 1], "origin": [0, 0, 5e-4]
            } },
            "material": "m"
        } },
        "surfaces": { "floor": { "plane": { "size": [10, 10], "center": [0, 0, -0.02] } } },
        "contacts": { "on_floor": {
            "slave": "strip.bottom", "master": "floor", "penalty": { "scaled": 1 }
        } },
        "supports": { "clamp": { "on": "strip.x_min", "fixed": true } },
        "loads": { "weight": { "on": "strip.top", "traction": [0, 0, grown(-0.02)] } },
        "solution": { "newton": { "tolerance": 1e-10 } },
        "output": { "every": 0 }
    });
    let plain = trial.done(&scene)?;
    scene["solution"]["stabilization"] = json!({ "viscous": {} });
    let helped = trial.done(&scene)?;
    // Rounding in a strip as thin as this leaves six digits.
    for name in ["force.floor.z", "energy.internal"] {
        trial.equal(name, helped.last(name)?, plain.last(name)?, 1e-5);
    }
    let part = helped.last("energy.stabilization")? / helped.last("energy.internal")?;
    trial.within("dissipated, of the strain energy", part, 0.01);
    // Clamp and floor carry the weight.
    let sum = helped.last("force.floor.z")? + helped.last("force.clamp.z")?;
    trial.equal("floor and clamp", sum, 0.02 * 0.05, 1e-6);
    Ok(())
}

/// A quarter of the hinged roof of K. Y. Sze, X. H. Liu and S. H. Lo, Finite Elem. Anal. Des. 40 (2004) 1551, section 3.6,
/// with its crown at the origin, on `n` x `n` elements.
fn roof(n: u32, thickness: f64) -> Value {
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 3102.75, "nu": 0.3 } } },
        "bodies": { "roof": {
            "mesh": { "cylinder_panel": {
                "radius": 2540, "thickness": thickness, "angles": [0, 0.1f64.to_degrees()], "y": [0, 254],
                "elements": [n, n], "origin": [0, 0, -2540.0 - 0.5 * thickness]
            } },
            "material": "m",
            "sets": { "crown": { "nodes_in_box": { "min": [-1, -1, -50], "max": [1, 1, 50] } } }
        } },
        "supports": {
            "symmetry_x": { "on": "roof.phi_min", "symmetry": "x" },
            "symmetry_y": { "on": "roof.y_min", "symmetry": "y" },
            "hinge": {
                "on": "roof.phi_max", "mid_surface": true, "displacement": { "x": 0, "y": 0, "z": 0 }
            }
        },
        "solution": { "newton": { "tolerance": 1e-10 }, "stabilization": { "viscous": {} } },
        "output": { "every": 0 }
    })
}

fn snap_under_dead_load(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(1300);
    let mut prescribed = roof(4, 12.7);
    prescribed["supports"]["push"] = json!({
        "on": "roof.crown", "mid_surface": true, "displacement": { "z": "-29.37*t" }
    });
    prescribed["solution"] = json!({ "step": fixed(20), "newton": { "tolerance": 1e-10 } });
    let reference = trial.done(&prescribed)?;
    let force = reference.last("force.push.z")?;
    let mut scene = roof(4, 12.7);
    scene["loads"] = json!({ "push": { "on": "roof.crown", "force": [0, 0, grown(force)] } });
    let landed = trial.done(&scene)?;
    let (found, right) = (
        landed.last("energy.internal")?,
        reference.last("energy.internal")?,
    );
    trial.equal("strain energy after the snap", found, right, 1e-6);
    trial.holds(
        "the jump is told",
        landed.warnings("went nowhere").len() == 1,
    );
    // Past the limit point (about 554) in small steps without help.
    let mut alone = scene.clone();
    alone["loads"]["push"]["force"][2] = json!({ "table": [[0, 0], [0.5, -545], [1, -575]] });
    alone["solution"] = json!({
        "step": { "initial": 0.02, "max": 0.02, "min": 0.01 }, "newton": { "tolerance": 1e-10 }
    });
    let passed = trial.done(&alone)?;
    let told = passed.warnings("no equilibrium goes on from time").len();
    trial.holds("a jump that viscous forces pass is told", told == 1);
    // The other way: far beyond, and back to the load.
    let mut back = scene.clone();
    back["loads"]["push"]["force"][2] = json!({ "table": [[0, 0], [0.5, force], [1, -575]] });
    back["solution"] = json!({ "newton": { "tolerance": 1e-10 } });
    let [found, other] = [
        passed.last("energy.internal")?,
        trial.done(&back)?.last("energy.internal")?,
    ];
    trial.equal("strain energy after a jump", found, other, 1e-6);
    alone["solution"]["stabilization"] = json!("none");
    let outcome = trial.solve(&alone)?;
    let remedy = "`solution.stabilization`";
    let words = ["negative pivot", "body `roof` near", "along z", remedy];
    trial.says(outcome.reason(), &words);
    // Slow enough for the snap to be followed.
    let mut left = [0.0; 2];
    for (left, n) in left.iter_mut().zip([60, 120]) {
        scene["solution"]["stabilization"]["viscous"]["factor"] = json!(0.03);
        scene["solution"]["step"] = fixed(n);
        let outcome = trial.done(&scene)?;
        *left = outcome.last("energy.imbalance")? / outcome.last("energy.stabilization")?;
        let told = outcome.warnings("stabilization has dissipated").len();
        trial.holds("what is dissipated is told", told == 1);
        trial.equal(
            "strain energy, followed",
            outcome.last("energy.internal")?,
            right,
            1e-6,
        );
    }
    trial.within("energy left, of the dissipated, 120 steps", left[1], 0.05);
    trial.within("left at 120 steps, of 60", left[1] / left[0], 0.65);
    Ok(())
}

fn snap_under_tool(trial: &mut Trial) -> Result<(), CaseError> {
    trial.iterations(400);
    let mut scene = roof(8, 6.35);
    scene["surfaces"] = json!({ "tool": {
        "cylinder": { "radius": 100, "length": 800, "center": [0, 0, 100] },
        "motion": { "translation": [0, 0, { "table": [[0, 0], [0.9, -35], [1, -35]] }] }
    } });
    scene["contacts"] = json!({ "press": {
        "slave": "roof.outer", "master": "tool", "penalty": { "scaled": 1 }
    } });
    scene["solution"]["step"] = json!({ "initial": 0.05, "max": 0.05 });
    let snapped = trial.done(&scene)?;
    trial.holds(
        "the snap is told",
        snapped.warnings("went nowhere").len() == 1,
    );
    let opened = snapped.warnings("contact `press` opened").len();
    trial.holds("the roof leaves the tool", opened == 1);
    // The other way: a load takes the roof through before the tool comes, and goes when it is there.
    scene["loads"] = json!({ "push": { "on": "roof.crown", "force": [0, 0, {
        "table": [[0, 0], [0.3, -700], [0.6, -700], [0.8, 0], [1, 0]]
    }] } });
    scene["surfaces"]["tool"]["motion"]["translation"][2] =
        json!({ "table": [[0, 0], [0.3, 0], [0.6, -35], [1, -35]] });
    let pushed = trial.done(&scene)?;
    for name in ["energy.internal", "force.tool.z"] {
        trial.equal(name, snapped.last(name)?, pushed.last(name)?, 1e-6);
    }
    Ok(())
}
