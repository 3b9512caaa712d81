//! Shells on NURBS patches in contact.
use super::{body, face};
use crate::gauntlet::drawn::difference;
use crate::gauntlet::scenes::{arc, solution};
use crate::gauntlet::{CaseError, Trial};
use covact_geometry::{NurbsPatch, Vec3};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// Shell and ball with steps to a tolerance that thin shells reach.
fn scene(bodies: Value, supports: Value, steps: u32) -> Value {
    let mut solution = solution(steps);
    solution["newton"]["tolerance"] = json!(1e-9);
    json!({
        "covact": 1,
        "materials": { "m": { "st_venant_kirchhoff": { "E": 1000, "nu": 0.3 } } },
        "bodies": bodies,
        "supports": supports,
        "solution": solution,
        "output": { "every": 0 }
    })
}

fn contact(slave: &str, master: &str, penalty: f64) -> Value {
    json!({ "slave": slave, "master": master, "penalty": { "value": penalty }, "points": { "gauss": 4 } })
}

/// Strain energy of a quarter of a plate of 16 x 16, clamped all round, bent by a ball by 1.
fn plate_energy(
    trial: &mut Trial,
    element: &str,
    n: u32,
    thickness: f64,
) -> Result<f64, CaseError> {
    let (sheet, supports) = match element {
        "nurbs" => {
            let patch = face(Vec3::zeros(), Vec3::x() * 8.0, Vec3::y() * 8.0)?;
            let keys = json!({ "thickness": thickness, "elements": [n, n] });
            let supports = json!({
                "x": { "on": "sheet.edge.1", "symmetry": "x" },
                "y": { "on": "sheet.edge.3", "symmetry": "y" },
                "rim": { "on": ["sheet.edge.2", "sheet.edge.4"], "clamped": true }
            });
            (body(trial, "plate", vec![patch], keys)?, supports)
        }
        _ => {
            let sheet = json!({
                "mesh": { "plate": { "size": [8, 8], "thickness": thickness, "elements": [n, n] } },
                "material": "m",
                "element": element
            });
            let supports = json!({
                "x": { "on": "sheet.x_min", "symmetry": "x" },
                "y": { "on": "sheet.y_min", "symmetry": "y" },
                "rim": { "on": ["sheet.x_max", "sheet.y_max"], "fixed": true }
            });
            (sheet, supports)
        }
    };
    let mut scene = scene(json!({ "sheet": sheet }), supports, 4);
    scene["surfaces"]["ball"] = json!({
        "sphere": { "radius": 4, "center": [0, 0, 4.0 + 0.5 * thickness] },
        "side": "outward",
        "motion": { "translation": [0, 0, "-t"] }
    });
    scene["contacts"]["press"] = contact("sheet.top", "ball", 2e3);
    let out = trial.done(&scene)?;
    trial.holds("contact", out.last("force.ball.z")? < -0.5);
    out.last("energy.internal")
}

pub fn elements(trial: &mut Trial) -> Result<(), CaseError> {
    let mut errors = Vec::new();
    for thickness in [0.5, 0.25] {
        let nurbs = plate_energy(trial, "nurbs", 8, thickness)?;
        let solid = plate_energy(trial, "q18", 8, thickness)?;
        errors.push((nurbs / solid - 1.0).abs());
        if thickness == 0.25 {
            let linear = plate_energy(trial, "h8", 20, thickness)?;
            trial.equal("energy of h8 against q18", linear, solid, 1e-2);
        }
    }
    trial.within("energy against q18", errors[1], 1e-2);
    // Shear, which the thin shell leaves out, is of second order in the thickness.
    let ratio = errors[1] / errors[0];
    trial.within("difference at half the thickness, by that", ratio, 0.3);
    trial.iterations(143);
    Ok(())
}

pub fn images(trial: &mut Trial) -> Result<(), CaseError> {
    let (radius, half, thickness, way, penalty) = (5.0, 1.2, 0.2, 0.7, 1e3);
    let keys = json!({ "thickness": thickness, "elements": [16, 2] });
    let angles = [FRAC_PI_2 + half, FRAC_PI_2 - half];
    let low = arc([0.0, 0.0], radius, angles, [0.0, 1.0])?;
    // The mirror image in the plane between the crowns: its bottom faces that plane.
    let gap = 2.0 * radius + thickness;
    let up = low.transformed(&|x| Vec3::new(x.x, x.y, gap - x.z))?;
    let low = body(trial, "low", vec![low], keys.clone())?;
    let up = body(trial, "up", vec![up], keys)?;
    let clamp = |body: &str, way: f64| {
        json!({
            "on": [format!("{body}.edge.1"), format!("{body}.edge.2")], "clamped": true,
            "displacement": { "x": 0, "y": 0, "z": format!("{way:?}*t") }
        })
    };
    let faces = |body: &str| json!({ "on": [format!("{body}.edge.3"), format!("{body}.edge.4")], "symmetry": "y" });
    let supports = json!({ "low": clamp("low", 0.0), "low_faces": faces("low") });
    let mut one = scene(json!({ "low": low }), supports.clone(), 8);
    one["surfaces"]["plane"] = json!({
        "plane": { "size": [30, 30], "center": [0, 0.5, 0.5 * gap], "normal": [0, 0, -1] },
        "motion": { "translation": [0, 0, format!("{:?}*t", -way)] }
    });
    one["contacts"]["press"] = contact("low.top", "plane", 2.0 * penalty);
    let mut two = scene(json!({ "low": low, "up": up }), supports, 8);
    two["supports"]["up"] = clamp("up", -2.0 * way);
    two["supports"]["up_faces"] = faces("up");
    // Mirrored, the normal of its patch points away from the other.
    two["contacts"]["press"] = contact("up.bottom", "low.top", penalty);
    let [one, two] = [trial.done(&one)?, trial.done(&two)?];
    trial.holds("contact", one.last("force.plane.z")? < -0.1);
    let name = "force.low.z";
    trial.equal(name, two.last(name)?, one.last(name)?, 1e-6);
    let name = "energy.internal";
    trial.equal(name, two.last(name)?, 2.0 * one.last(name)?, 1e-6);
    trial.equal(
        "largest pressure",
        two.last("pressure.max")?,
        one.last("pressure.max")?,
        1e-4,
    );
    trial.iterations(145);
    Ok(())
}

/// A shallow panel, quadratic in both directions.
fn panel() -> Result<NurbsPatch, CaseError> {
    let heights = [[0.0, 0.5, 0.0], [0.0, 1.5, 0.2], [0.0, 0.3, 0.0]];
    let points: Vec<Vec3> = (0..9)
        .map(|k| {
            Vec3::new(
                4.0 * (k % 3) as f64,
                4.0 * (k / 3) as f64,
                heights[k / 3][k % 3],
            )
        })
        .collect();
    let knots = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    NurbsPatch::new([2, 2], [knots(), knots()], [3, 3], &points, None).map_err(CaseError::from)
}

pub fn described(trial: &mut Trial) -> Result<(), CaseError> {
    let run = |trial: &mut Trial, name: &str, patch: NurbsPatch, slave: &str| {
        let keys = json!({ "thickness": 0.3, "elements": [10, 8] });
        let sheet = body(trial, name, vec![patch], keys)?;
        let supports =
            json!({ "rim": { "on": ["sheet.edge.1", "sheet.edge.2"], "clamped": true } });
        let mut scene = scene(json!({ "sheet": sheet }), supports, 3);
        scene["surfaces"]["ball"] = json!({
            "sphere": { "radius": 4, "center": [3.6, 4.1, 5] },
            "side": "outward",
            "motion": { "translation": [0, 0, "-0.9*t"] }
        });
        let mut contact = contact(slave, "ball", 2e3);
        contact["friction"] = json!(0.2);
        contact["tangential_penalty"] = json!({ "value": 500 });
        scene["contacts"]["press"] = contact;
        trial.done(&scene)
    };
    let plain = run(trial, "plain", panel()?, "sheet.top")?;
    trial.holds("something slides", plain.last("points.slip")? > 0.0);
    let columns = [
        "force.ball.x",
        "force.ball.y",
        "force.ball.z",
        "energy.internal",
        "energy.dissipated",
        "pressure.max",
    ];
    // Reversed once, the normal points to the other side.
    let reversed = panel()?.reversed(0)?;
    let turned = reversed.reversed(1)?;
    let elevated = panel()?.elevated(0, 1)?.elevated(1, 1)?;
    for (name, patch, slave) in [
        ("reversed", reversed, "sheet.bottom"),
        ("turned", turned, "sheet.top"),
        ("elevated", elevated, "sheet.top"),
    ] {
        let other = run(trial, name, patch, slave)?;
        let off = difference(&plain, &other, &columns)?;
        trial.within(format!("difference, {name}"), off, 1e-8);
    }
    trial.iterations(96);
    Ok(())
}
