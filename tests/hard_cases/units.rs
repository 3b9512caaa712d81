//! The same plate in other units gives the same forces and pressures: no tolerance and no penalty has a unit.
use crate::common::{difference, done, plate};
use crate::support::Outcome;
use serde_json::json;

const MODULUS: f64 = 12000.0;

/// The plate in a unit of which `length` make a millimetre, forces in a unit of which `force` make a newton.
fn run(unit: &str, length: f64, force: f64, cad: bool) -> Outcome {
    let mut scene = plate(8, 5.0, 4);
    scene["units"] = json!({ "length": unit });
    let l = |x: f64| x * length;
    scene["materials"]["plate"]["st_venant_kirchhoff"]["E"] =
        json!(MODULUS * force / (length * length));
    let mesh = &mut scene["bodies"]["plate"]["mesh"]["plate"];
    mesh["size"] = json!([l(50.0), l(50.0)]);
    mesh["thickness"] = json!(l(2.0));
    let ball = &mut scene["surfaces"]["ball"];
    ball["sphere"] = json!({ "radius": l(25.0), "center": [0.0, 0.0, l(26.0)] });
    if cad {
        // The file holds a sphere of radius 5 mm about its origin.
        ball.as_object_mut().expect("a surface").remove("sphere");
        ball["cad"] = json!({ "file": "../../assets/sphere.igs" });
        ball["placement"] = json!({ "scale": 5.0, "translation": [0.0, 0.0, l(26.0)] });
    }
    ball["motion"]["translation"] = json!([0, 0, format!("-{:e}*t", l(5.0))]);
    scene["contacts"]["press"]["penalty"] = json!("auto");
    done(&scene)
}

#[test]
fn units_do_not_change_the_result() {
    let millimetres = run("mm", 1.0, 1.0, false);
    for (unit, length, force, cad) in [
        ("nm", 1e6, 1.0, false),
        ("um", 1e3, 1e6, false),
        ("m", 1e-3, 1e-3, false),
        ("km", 1e-6, 1e-9, false),
        ("in", 1.0 / 25.4, 1.0 / 4.448222, false),
        // The file is in millimetres throughout.
        ("mm", 1.0, 1.0, true),
        ("nm", 1e6, 1.0, true),
        ("km", 1e-6, 1e-9, true),
    ] {
        let other = run(unit, length, force, cad);
        let d = difference(&millimetres, &other, |column| match column {
            "penetration.max" => 1.0 / length,
            "pressure.max" => length * length / force,
            c if c.starts_with("energy") => 1.0 / (force * length),
            _ => 1.0 / force,
        });
        println!("{unit}{}: {d:.1e}", if cad { ", CAD file" } else { "" });
        // Powers of ten round every length anew; the plate amplifies that by (length / thickness)^2, about 600.
        assert!(d < 1e-8, "{unit}: {d}");
        if !cad {
            // A pole of the file's sphere lies under the ball's tip: other rounding of the gap, perhaps one iteration.
            assert_eq!(
                millimetres.column("iterations"),
                other.column("iterations"),
                "{unit}"
            );
        }
        assert_eq!(
            millimetres.column("points.active"),
            other.column("points.active"),
            "{unit}"
        );
    }
}

/// Half of a hinged arch that a roll pushes through until it snaps, within `end`: where no equilibrium goes on is told from the sizes
/// that steps have without anybody's choice, which are parts of a short run's time.
fn snapped(end: f64) -> Outcome {
    done(&json!({
        "covact": 1,
        "materials": { "steel": { "st_venant_kirchhoff": { "E": 206e3, "nu": 0.3 } } },
        "bodies": { "arch": {
            "mesh": { "cylinder_panel": {
                "radius": 60, "thickness": 0.8, "angles": [0, 25], "y": [0, 4], "elements": [12, 1], "center": [0, 0, -60]
            } },
            "material": "steel"
        } },
        "surfaces": { "push": {
            "cylinder": { "radius": 6, "length": 12, "center": [0, 2, 6.4], "axis": [0, 1, 0] },
            "side": "outward",
            "motion": { "translation": [0, 0, { "table": [[0, 0], [end, -9.5]] }] }
        } },
        "contacts": { "roll": { "slave": "arch.outer", "master": "push" } },
        "supports": {
            "hinge": { "on": "arch.phi_max", "mid_surface": true, "displacement": [0, 0, 0] },
            "middle": { "on": "arch.phi_min", "symmetry": "x" },
            "flat": { "on": "arch", "plane_strain": "y" }
        },
        "solution": { "end_time": end },
        "output": { "every": 0 }
    }))
}

#[test]
fn a_snap_does_not_depend_on_the_unit_of_time() {
    let [second, short] = [1.0, 0.017].map(snapped);
    let peak = |run: &Outcome| {
        run.column("force.push.z")
            .iter()
            .fold(0.0f64, |m, f| m.max(f.abs()))
    };
    assert!((peak(&second) - 164.0).abs() < 4.0, "{}", peak(&second));
    assert!(
        (peak(&short) / peak(&second) - 1.0).abs() < 1e-3,
        "{}",
        peak(&short)
    );
    let iterations = |run: &Outcome| run.column("iterations").iter().sum::<f64>();
    assert!(iterations(&short) < 1.1 * iterations(&second));
}
