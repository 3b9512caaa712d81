//! One problem along several ways.
use crate::gauntlet::drawn::difference;
use crate::gauntlet::metal::{metal, sheet};
use crate::gauntlet::scenes::{block_under, solution};
use crate::gauntlet::{CaseError, Trial};
use serde_json::{Value, json};

/// A rubber block of 2 x 1 x 0.6 under a ball and a cylinder.
fn two_tools(friction: f64) -> Value {
    let contact = |master: &str| {
        let mut contact = json!({
            "slave": "block.top", "master": master, "penalty": { "value": 2e3 }, "points": { "gauss": 2 }
        });
        if friction > 0.0 {
            contact["friction"] = json!(friction);
            contact["tangential_penalty"] = json!({ "value": 500 });
        }
        contact
    };
    json!({
        "covact": 1,
        "materials": { "rubber": { "neo_hooke": { "E": 100, "nu": 0.3 } } },
        "bodies": { "block": {
            "mesh": { "block": { "min": [0, 0, 0], "max": [2, 1, 0.6], "elements": [8, 4, 3] } },
            "material": "rubber",
            "element": "h8_displacement"
        } },
        "surfaces": {
            "ball": { "sphere": { "radius": 1, "center": [0.6, 0.5, 1.6] }, "side": "outward" },
            "bar": {
                "cylinder": { "radius": 0.7, "length": 3, "center": [1.4, 0.5, 1.3], "axis": [0, 1, 0] }, "side": "outward"
            }
        },
        "contacts": { "ball": contact("ball"), "bar": contact("bar") },
        "supports": { "floor": { "on": "block.bottom", "fixed": true } },
        "solution": solution(4),
        "output": { "every": 0 }
    })
}

/// Linear between these values at the times 0, 1, 2 and so on.
fn table(values: &[f64]) -> Value {
    let rows: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
    json!({ "table": rows })
}

pub fn tables(trial: &mut Trial) -> Result<(), CaseError> {
    let mut staged = two_tools(0.2);
    staged["solution"]["end_time"] = 3.into();
    staged["loads"] = json!({ "side": { "on": "block.x_min", "pressure": 2 } });
    let mut written = staged.clone();
    staged["stages"] = json!([
        { "name": "one", "until": 1, "tools": { "ball": [0, 0, -0.15], "bar": [0, 0, -0.05] } },
        { "name": "two", "until": 2, "tools": { "ball": [0.1, 0, -0.1], "bar": [0, 0, -0.2] }, "loads": { "side": 1 } },
        { "name": "three", "tools": { "ball": [0, 0.1, -0.2], "bar": [0, 0, -0.1] }, "loads": { "side": 0.5 } }
    ]);
    written["loads"]["side"]["pressure"] = table(&[0.0, 0.0, 2.0, 1.0]);
    written["surfaces"]["ball"]["motion"] = json!({ "translation": [
        table(&[0.0, 0.0, 0.1, 0.0]), table(&[0.0, 0.0, 0.0, 0.1]), table(&[0.0, -0.15, -0.1, -0.2])
    ] });
    written["surfaces"]["bar"]["motion"] =
        json!({ "translation": [0, 0, table(&[0.0, -0.05, -0.2, -0.1])] });
    let [staged, written] = [trial.done(&staged)?, trial.done(&written)?];
    let columns = [
        "force.ball.x",
        "force.ball.z",
        "force.bar.z",
        "energy.internal",
        "energy.dissipated",
        "pressure.max",
    ];
    trial.within("difference", difference(&staged, &written, &columns)?, 1e-9);
    trial.iterations(165);
    Ok(())
}

pub fn order(trial: &mut Trial) -> Result<(), CaseError> {
    let mut run = |ball: [f64; 2], bar: [f64; 2]| {
        let mut scene = two_tools(0.0);
        scene["solution"]["end_time"] = 2.into();
        for (name, [middle, end]) in [("ball", ball), ("bar", bar)] {
            scene["surfaces"][name]["motion"] =
                json!({ "translation": [0, 0, table(&[0.0, middle, end])] });
        }
        trial.done(&scene)
    };
    let once = run([-0.075, -0.15], [-0.1, -0.2])?;
    let others = [
        ("the ball first", run([-0.15, -0.15], [0.0, -0.2])?),
        ("the cylinder first", run([0.0, -0.15], [-0.2, -0.2])?),
    ];
    for (name, other) in &others {
        for column in [
            "force.ball.z",
            "force.ball.x",
            "force.bar.z",
            "energy.internal",
            "pressure.max",
        ] {
            let what = format!("{column}, {name}");
            trial.equal(what, other.last(column)?, once.last(column)?, 1e-9);
        }
    }
    trial.iterations(140);
    Ok(())
}

pub fn continued(trial: &mut Trial) -> Result<(), CaseError> {
    let mut friction = two_tools(0.2);
    friction["surfaces"]["ball"]["motion"] = json!({ "translation": ["0.1*t", 0, "-0.15*t"] });
    friction["surfaces"]["bar"]["motion"] = json!({ "translation": [0, 0, "-0.1*t"] });
    let flows = sheet(metal("j2"), [6.0, 6.0], 1.0, 1.0);
    let ball = json!({
        "sphere": { "radius": 2, "center": [0, 0, 2.5] }, "side": "outward", "motion": { "translation": ["0.05*t", 0, "-0.1*t"] }
    });
    let mut multipliers = block_under(ball.clone(), 4, 4);
    let contact = &mut multipliers["contacts"]["press"];
    contact["friction"] = json!(0.2);
    contact["penalty"] = json!({ "value": 500 });
    contact["tangential_penalty"] = json!({ "value": 200 });
    contact["augmentation"] = json!({ "gap": 1e-4, "slip": 1e-4 });
    let mut inertia = block_under(ball, 4, 4);
    inertia["materials"]["rubber"]["neo_hooke"]["density"] = json!(1);
    inertia["contacts"]["press"]["friction"] = json!(0.2);
    inertia["solution"] = json!({ "dynamics": {}, "end_time": 1, "newton": { "tolerance": 1e-9 } });
    for (name, scene, columns) in [
        ("friction", friction, &["force.ball.x", "energy.dissipated"]),
        ("metal", flows, &["force.ball.z", "energy.plastic"]),
        (
            "multipliers",
            multipliers,
            &["force.tool.x", "energy.dissipated"],
        ),
        ("inertia", inertia, &["force.tool.x", "energy.kinetic"]),
    ] {
        let straight = trial.done(&scene)?;
        let half = straight.summary.steps / 2;
        trial.holds(format!("steps before and after, {name}"), half > 0);
        let resumed = trial.continued(&scene, half)?;
        let off = difference(&straight, &resumed, columns)?;
        trial.within(format!("difference, {name}"), off, 0.0);
        let rows = |out: &crate::gauntlet::Outcome| out.column("time");
        trial.holds(
            format!("all steps, {name}"),
            rows(&straight)? == rows(&resumed)?,
        );
    }
    trial.iterations(2280);
    Ok(())
}

pub fn solvers(trial: &mut Trial) -> Result<(), CaseError> {
    let mut scene = two_tools(0.0);
    scene["surfaces"]["ball"]["motion"] = json!({ "translation": [0, 0, "-0.2*t"] });
    scene["surfaces"]["bar"]["motion"] = json!({ "translation": [0, 0, "-0.1*t"] });
    scene["solution"]["linear_solver"] = "llt".into();
    let one = trial.done(&scene)?;
    for solver in ["ldlt", "lu", "auto"] {
        scene["solution"]["linear_solver"] = solver.into();
        let other = trial.done(&scene)?;
        let columns = [
            "force.ball.z",
            "force.ball.x",
            "force.bar.z",
            "energy.internal",
            "pressure.max",
        ];
        let off = difference(&one, &other, &columns)?;
        trial.within(format!("difference, {solver}"), off, 1e-9);
        let same = one.summary.newton_iterations == other.summary.newton_iterations;
        trial.holds(format!("as many iterations, {solver}"), same);
    }
    trial.iterations(96);
    Ok(())
}
