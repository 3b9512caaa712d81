//! Resultants of shells and nodal reactions in the files of results, against closed forms and the history.
use crate::support::*;
use serde_json::{Value, json};
use std::path::Path;

const LENGTH: f64 = 10.0;
const WIDTH: f64 = 2.0;
const HEIGHT: f64 = 0.5;
const ELEMENTS: usize = 10;

/// Points and fields of the last results of a body.
struct Last {
    points: Vec<[f64; 3]>,
    fields: Vec<(String, Vec<f64>)>,
}

impl Last {
    fn read(folder: &Path, file: &str) -> Last {
        use vtkio::model::{Attribute, DataSet, Piece, Vtk};
        let bytes = std::fs::read(folder.join("out").join(file)).unwrap();
        let bytes = covact::output::inlined(&bytes).unwrap();
        let vtk = Vtk::parse_xml(&bytes[..]).unwrap();
        let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else {
            panic!("no grid");
        };
        let Some(Piece::Inline(grid)) = pieces.into_iter().next() else {
            panic!("no piece");
        };
        let points: Vec<f64> = grid.points.cast_into().unwrap();
        let fields = grid.data.point.into_iter().map(|a| match a {
            Attribute::DataArray(a) => (a.name, a.data.cast_into().unwrap()),
            Attribute::Field { .. } => panic!("a field of fields"),
        });
        Last {
            points: points.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect(),
            fields: fields.collect(),
        }
    }

    fn field(&self, name: &str) -> &[f64] {
        &self.fields.iter().find(|f| f.0 == name).expect(name).1
    }
}

/// Runs a strip along x, held at x = 0, under tractions at its end, and reads its last results.
fn strip(element: &str, traction: [Value; 3], folder: &Path) -> Last {
    run(&scene_of(element, traction), folder)
}

fn scene_of(element: &str, traction: [Value; 3]) -> Value {
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": 1e6, "nu": 0}}},
        "bodies": {"strip": {
            "mesh": {"block": {
                "min": [0, -WIDTH / 2.0, -HEIGHT / 2.0], "max": [LENGTH, WIDTH / 2.0, HEIGHT / 2.0],
                "elements": [ELEMENTS, 2, 1]
            }},
            "element": element, "material": "m"
        }},
        "supports": {"clamp": {"on": "strip.x_min", "fixed": true}},
        "loads": {"end": {"on": "strip.x_max", "traction": traction}},
        "solution": {"step": {"initial": 1, "max": 1}, "newton": {"tolerance": 1e-12}},
        "output": {"full_precision": true}
    })
}

fn run(scene: &Value, folder: &Path) -> Last {
    std::fs::write(folder.join("scene.json"), scene.to_string()).unwrap();
    let run = covact(
        folder,
        &["run", "scene.json", "-o", "out", "--force", "--quiet"],
    );
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    Last::read(folder, "strip_0001.vtu")
}

/// A strip in plane tension, under an end moment and under an end force: N, M and Q of beams. Loads are so small that
/// the change of shape is below the tolerances.
#[test]
fn resultants_of_a_strip_are_those_of_a_beam() {
    let folder = tempfile::tempdir().unwrap();
    for element in ["h8", "q18"] {
        let near = |name: &str, of: &Last, expected: &dyn Fn(f64) -> Vec<f64>, scale: f64| {
            let field = of.field(name);
            let mut compared = 0;
            for (x, found) in
                (of.points.iter()).zip(field.chunks_exact(field.len() / of.points.len()))
            {
                // At the ends an element stands for half of what is beside it.
                if x[0] < 0.9 || x[0] > LENGTH - 0.9 {
                    continue;
                }
                for (f, e) in found.iter().zip(expected(x[0])) {
                    assert!(
                        (f - e).abs() < 2e-4 * scale,
                        "{element} {name} at {x:?}: {f} {e}"
                    );
                    compared += 1;
                }
            }
            assert!(compared > 100);
        };
        let pulled = strip(element, [json!("3*t"), json!(0), json!(0)], folder.path());
        near(
            "membrane_force",
            &pulled,
            &|_| vec![3.0 * HEIGHT, 0.0, 0.0],
            3.0,
        );
        near("bending_moment", &pulled, &|_| vec![0.0; 3], 1.0);

        let bent = strip(element, [json!("6*z*t"), json!(0), json!(0)], folder.path());
        let moment = 6.0 * HEIGHT.powi(3) / 12.0;
        near("bending_moment", &bent, &|_| vec![moment, 0.0, 0.0], moment);
        near("shear_force", &bent, &|_| vec![0.0; 2], moment);

        let lifted = strip(element, [json!(0), json!(0), json!("0.1*t")], folder.path());
        let force = 0.1 * HEIGHT;
        near("shear_force", &lifted, &|_| vec![force, 0.0], force);
        let moment = |x: f64| vec![-force * (LENGTH - x), 0.0, 0.0];
        near("bending_moment", &lifted, &moment, force * LENGTH);
    }
}

/// What the supports exert at the nodes adds up to the history's forces, and is in balance with the load; where nothing
/// holds a node nothing is shown.
#[test]
fn reactions_of_a_strip_are_in_balance_with_its_load() {
    let folder = tempfile::tempdir().unwrap();
    for element in ["h8", "q18"] {
        let last = strip(
            element,
            [json!("3*t"), json!(0), json!("0.1*t")],
            folder.path(),
        );
        let mut sum = [0.0; 3];
        for (x, force) in last
            .points
            .iter()
            .zip(last.field("reaction").chunks_exact(3))
        {
            if x[0] > 0.0 {
                assert_eq!(force, [0.0; 3]);
            }
            (0..3).for_each(|k| sum[k] += force[k]);
        }
        let load = [3.0, 0.0, 0.1].map(|t| t * WIDTH * HEIGHT);
        for (sum, load) in sum.iter().zip(load) {
            assert!(
                (sum + load).abs() < 1e-6 * load.max(1e-3),
                "{element}: {sum} {load}"
            );
        }
    }
}

/// Of a plate under a ball the slave's nodes share the force of the ball, and supports the rest.
#[test]
fn reactions_of_contact_add_up_to_the_force_of_the_tool() {
    let folder = tempfile::tempdir().unwrap();
    for kinematics in ["large", "small"] {
        let scene = plate_with(&[
            ("/solution/newton", json!({"tolerance": 1e-11})),
            ("/solution/kinematics", json!(kinematics)),
            ("/output", json!({"full_precision": true})),
        ]);
        std::fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
        let run = covact(
            folder.path(),
            &["run", "scene.json", "-o", "out", "--force", "--quiet"],
        );
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        let table = covact::output::read_csv(&folder.path().join("out/history.csv")).unwrap();
        let force = *table.column("force.ball.z").unwrap().last().unwrap();
        assert!(force < 0.0);
        let last = Last::read(folder.path(), "plate_0002.vtu");
        let (mut ball, mut all) = (0.0, [0.0; 3]);
        for (x, reaction) in last
            .points
            .iter()
            .zip(last.field("reaction").chunks_exact(3))
        {
            if x[0] < 39.0 && x[1] < 39.0 {
                ball += reaction[2];
            }
            (0..3).for_each(|k| all[k] += reaction[k]);
        }
        assert!(
            (ball / force - 1.0).abs() < 1e-6,
            "{kinematics}: {ball} {force}"
        );
        assert!(
            all.iter().all(|sum| sum.abs() < 1e-6 * force.abs()),
            "{kinematics}: {all:?}"
        );
    }
}

/// Stresses at the bottom, in the middle and at the top of the thickness: a bent strip has -6 M / t^2, none and 6 M / t^2 for a
/// moment M a width, a pulled one the same at all three, whatever the direction in which it lies; where they are not asked for
/// there are none.
#[test]
fn a_bent_strip_has_no_stress_in_its_middle() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["stress_bottom", "stress_mid", "stress_top"];
    let plain = strip("h8", [json!("3*t"), json!(0), json!(0)], folder.path());
    assert!(
        names
            .iter()
            .all(|n| !plain.fields.iter().any(|f| f.0 == *n))
    );
    let moment = 6.0 * HEIGHT.powi(3) / 12.0;
    let face = 6.0 * moment / HEIGHT.powi(2);
    for (element, layers, kinematics) in [
        ("h8", 1, "large"),
        ("h8", 2, "large"),
        ("h8", 3, "small"),
        ("q18", 1, "large"),
        ("q18", 1, "small"),
    ] {
        for (traction, expected) in [("6*z*t", [-face, 0.0, face]), ("3*t", [3.0; 3])] {
            let mut scene = scene_of(element, [json!(traction), json!(0), json!(0)]);
            scene["bodies"]["strip"]["mesh"]["block"]["elements"] = json!([ELEMENTS, 2, layers]);
            scene["solution"]["kinematics"] = json!(kinematics);
            scene["output"] = json!({"shell_stresses": true});
            let last = run(&scene, folder.path());
            let mut compared = 0;
            for (name, expected) in names.iter().zip(expected) {
                for (x, s) in last.points.iter().zip(last.field(name).chunks_exact(6)) {
                    if x[0] < 0.9 || x[0] > LENGTH - 0.9 {
                        continue;
                    }
                    let wanted = [expected, 0.0, 0.0, 0.0, 0.0, 0.0];
                    for (found, wanted) in s.iter().zip(wanted) {
                        assert!(
                            (found - wanted).abs() < 2e-4 * face,
                            "{element} {layers} {kinematics} {name} at {x:?}: {s:?}"
                        );
                    }
                    compared += 1;
                }
            }
            assert!(compared > 100);
        }
    }
}

/// A strip that hardens linearly, pulled to twice its yield strain and bent so far that its bottom yields the other way: force and
/// moment are the integrals of a beam's stress over strains of -6 to 10 yield strains. The stress in the middle is that of its
/// strain, not the mean of both faces (which is a fifth of the yield stress). Across the thickness the element is not free of stress
/// where flow begins, so that differences of both stresses are compared.
#[test]
fn the_middle_of_a_strip_that_flows_is_not_the_mean_of_its_faces() {
    let folder = tempfile::tempdir().unwrap();
    let (modulus, strength, tangent) = (1e6, 1.0, 1e5);
    let yields = strength / modulus;
    let stress = |strain: f64| match strain.abs() > yields {
        true => strain.signum() * (strength + tangent * (strain.abs() - yields)),
        false => modulus * strain,
    };
    let strain = |z: f64| yields * (2.0 + 8.0 * z / (0.5 * HEIGHT));
    let (mut force, mut moment) = (0.0, 0.0);
    for k in 0..2000 {
        let z = HEIGHT * ((f64::from(k) + 0.5) / 2000.0 - 0.5);
        force += stress(strain(z)) * HEIGHT / 2000.0;
        moment += stress(strain(z)) * z * HEIGHT / 2000.0;
    }
    let (mean, slope) = (force / HEIGHT, 12.0 * moment / HEIGHT.powi(3));
    let traction = format!("({mean} + {slope}*z)*t");
    let mut scene = scene_of("h8", [json!(traction), json!(0), json!(0)]);
    scene["materials"]["m"] = json!({"j2": {
        "E": modulus, "nu": 0.3, "hardening": {"linear": {
            "yield_stress": strength, "slope": modulus * tangent / (modulus - tangent)
        }}
    }});
    scene["solution"] = json!({});
    scene["output"] = json!({"shell_stresses": true});
    run(&scene, folder.path());
    let table = covact::output::read_csv(&folder.path().join("out/history.csv")).unwrap();
    let last = Last::read(folder.path(), &format!("strip_{:04}.vtu", table.rows.len()));
    let mut compared = 0;
    for (name, z) in [
        ("stress_bottom", -0.25),
        ("stress_mid", 0.0),
        ("stress_top", 0.25),
    ] {
        let expected = stress(strain(z));
        for (x, s) in last.points.iter().zip(last.field(name).chunks_exact(6)) {
            if x[0] < 3.9 || x[0] > LENGTH - 2.9 {
                continue;
            }
            assert!(
                (s[0] - s[2] - expected).abs() < 0.05,
                "{name} at {x:?}: {s:?} {expected}"
            );
            compared += 1;
        }
    }
    assert!(compared > 50);
}

/// Of a body that is no shell there are no stresses over the thickness, which is said.
#[test]
fn a_block_has_no_stresses_over_a_thickness() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = scene_of("h8", [json!("t"), json!(0), json!(0)]);
    scene["bodies"]["strip"]["mesh"]["block"]["max"] = json!([4, 1, 4]);
    scene["output"] = json!({"shell_stresses": true});
    let last = run(&scene, folder.path());
    assert!(last.fields.iter().all(|f| !f.0.starts_with("stress_")));
    let log = std::fs::read_to_string(folder.path().join("out/run.log")).unwrap();
    assert!(
        log.contains("`output.shell_stresses`: no body is a shell"),
        "{log}"
    );
}
