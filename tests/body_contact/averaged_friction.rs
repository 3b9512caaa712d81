//! Friction at points whose normal tractions are those of slave nodes with averaged gaps.
use crate::shells::arch_on_plate;
use crate::support::{scene_json, set};
use covact::assembly::Assembler;
use covact::contact::friction::history::PointHistory;
use covact::model::state::State;
use covact::model::{Model, build::build};
use covact::scene;
use covact::system::DofMap;
use covact_geometry::{Hint, Vec3};
use serde_json::{Value, json};

fn model(scene: &Value) -> Model {
    let mut loaded = scene::parse(&scene.to_string(), "scene.json").expect("valid scene");
    loaded.dir = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes").into();
    build(&loaded).unwrap_or_else(|e| panic!("{e} at {}", e.pointer))
}

/// A number in (-1, 1) that looks random.
fn noise(i: usize) -> f64 {
    let x = (i as f64 * 12.9898 + 4.1414).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

fn vector(i: usize, size: f64) -> Vec3 {
    Vec3::from_fn(|c, _| size * noise(11 * i + 3 * c))
}

/// A state that is moved about, one body of it lifted, with a history at every point: attraction points beside the points, on bodies on
/// facets around the one below, some of points that have just come into contact.
fn state(model: &Model, lifted: &str, lift: f64) -> State {
    let mut state = State::new(model);
    let bodies = model.bodies.iter();
    for (i, u) in state.u.iter_mut().enumerate() {
        *u += 0.02 * noise(i);
    }
    for body in bodies.filter(|b| b.name == lifted) {
        let first = body.first_node as usize;
        for node in first..first + body.mesh.nodes.len() {
            state.u[3 * node + 2] += lift;
        }
    }
    let pair = &model.pairs[0];
    let range = state.history(model, 0).expect("histories");
    assert_eq!(range.len(), pair.points.len());
    for (i, p) in pair.points.iter().enumerate() {
        let x = model.point_position(p, &state.u);
        let mut history = PointHistory {
            lambda: vector(i + 5, 0.5),
            approach: if i % 3 == 0 { 0.4 } else { 0.0 },
            ..PointHistory::default()
        };
        match pair.body_master() {
            None => {
                let pose = model.surfaces[0].pose(0.0, &state.u).expect("a pose");
                let beside = x + vector(i, 0.2);
                history.base = pose.inverse_transform_point(&beside.into()).coords;
            }
            Some(master) => {
                let foot = (master.facets).project(&x, None, f64::INFINITY, |_| true);
                let foot = foot.expect("a foot").hint();
                let around = master.facets.neighbours(foot.patch);
                history.place = Some(Hint {
                    patch: match around.get(i % 5) {
                        Some(beside) => *beside,
                        None => foot.patch,
                    },
                    xi: [0.7 * noise(i), 0.7 * noise(i + 1)],
                });
                history.base = vector(i, 0.3);
            }
        }
        state.histories[range.start + i] = history;
    }
    state
}

/// Contact alone, evaluated at displacements `u` with the histories of `state`: its forces, and the points that slide and stick there.
fn forces(assembler: &mut Assembler, state: &State, u: &[f64]) -> (Vec<f64>, [usize; 3]) {
    let mut at = state.clone();
    at.u.copy_from_slice(u);
    let (mut r, mut rhs) = (vec![0.0; u.len()], vec![0.0; u.len()]);
    assembler.clear_matrix();
    let totals = assembler
        .linearize_contact(&mut at, 0.0, None, &mut r, &mut rhs)
        .unwrap_or_else(|e| panic!("{e}"));
    let points = assembler.rubbed_points(0).expect("points that rub");
    let (mut slip, mut stick) = (0, 0);
    for i in 0..state.histories.len() {
        let on_rigid = points.rigid(i).map(|g| g.touch.traction.slip.slides);
        let on_body = points.moving(i).map(|g| g.touch.response.slip.slides);
        match on_rigid.or(on_body) {
            Some(true) => slip += 1,
            Some(false) => stick += 1,
            None => {}
        }
    }
    (r, [totals.active, slip, stick])
}

/// Largest difference between the tangent and central differences of the forces, every closest point found anew, relative to the largest
/// entry; how far it is from symmetry; and the points that slide and stick.
fn tangent(name: &str, scene: &Value, lifted: &str, lift: f64) -> ([f64; 2], [usize; 2]) {
    let model = model(scene);
    let free = DofMap::free(model.nodes.len());
    let mut assembler = Assembler::new(&model, &free).expect("a pattern");
    let state = state(&model, lifted, lift);
    let n = state.u.len();
    let (r, counts) = forces(&mut assembler, &state, &state.u);
    let [active, slip, stick] = counts;
    let all = model.pairs[0]
        .averaged
        .as_ref()
        .expect("averaged gaps")
        .len();
    assert!(
        0 < active && active < all,
        "{name}: {active} of {all} closed"
    );
    // Where no point stays in front of the facets that the pattern has, it would be another one.
    let matrix = assembler.matrix().clone();
    let entry = |i: usize, j: usize| match matrix.pattern().block((i / 3) as u32, (j / 3) as u32) {
        Some(_) => matrix.get(i, j),
        None => 0.0,
    };
    let h = 1e-6;
    let (mut error, mut scale, mut skew, mut columns) = (0.0f64, 0.0f64, 0.0f64, 0);
    for j in 0..n {
        let mut side = |sign: f64| {
            let mut u = state.u.clone();
            u[j] += sign * h;
            forces(&mut assembler, &state, &u)
        };
        let (plus, minus) = (side(1.0), side(-1.0));
        assert_eq!([plus.1, minus.1], [counts; 2], "{name}: a kink is near");
        let mut largest = 0.0f64;
        for i in 0..n {
            let slope = (plus.0[i] - minus.0[i]) / (2.0 * h);
            error = error.max((slope - entry(i, j)).abs());
            skew = skew.max((entry(i, j) - entry(j, i)).abs());
            largest = largest.max(slope.abs());
        }
        scale = scale.max(largest);
        columns += usize::from(largest > 1e-6);
    }
    let force = r.iter().fold(0.0f64, |a, f| a.max(f.abs()));
    println!(
        "{name}: {active} of {all} nodes closed, {slip} points slide, {stick} stick, {columns} columns, tangent {:.1e}, skew {:.1e}",
        error / scale,
        skew / scale
    );
    assert!(
        force > 1e-2 && scale > 1.0 && columns > 20,
        "{name}: nothing rubs"
    );
    ([error / scale, skew / scale], [slip, stick])
}

/// The tangents of points that slide and of those that stick, on a rigid ball and on bodies, whose attraction points lie on other facets
/// than their feet, with faces of four and of nine nodes on either side.
#[test]
fn assembled_tangents_are_derivatives() {
    let ball = |element: &str, n: u32| {
        let mut scene = scene_json("ball_on_plate.json");
        set(&mut scene, "/bodies/plate/mesh/plate/elements", vec![n, n]);
        scene["bodies"]["plate"]["element"] = json!(element);
        scene
    };
    let arch = |slave: &str, master: &str, surface: &str| {
        let mut scene = arch_on_plate(2.0, 4, json!({"gauss": 3}));
        scene["bodies"]["arch"]["element"] = json!(slave);
        scene["bodies"]["plate"]["element"] = json!(master);
        scene["bodies"]["plate"]["mesh"]["plate"]["elements"] = json!([4, 2]);
        scene["bodies"]["arch"]["mesh"]["cylinder_panel"]["elements"] = json!([3, 1]);
        scene["contacts"]["press"]["master_surface"] = json!(surface);
        scene
    };
    let coulomb = |mu: f64| json!({"coulomb": {"mu": mu}});
    let limited = json!({"shear_limited": {"mu": 0.3, "limit": 0.5}});
    let orthotropic = json!({"orthotropic": {"mu": [0.2, 0.05], "direction": [1, 0.4, 0.1]}});
    let some = coulomb(0.3);
    let (mut slipped, mut stuck) = (0, 0);
    for (name, scene, friction, body, lift) in [
        ("ball on h8", ball("h8", 6), &some, "plate", 3.0),
        ("ball on q18", ball("q18", 4), &some, "plate", 3.0),
        (
            "ball on q18, stuck",
            ball("q18", 4),
            &coulomb(1e5),
            "plate",
            3.0,
        ),
        (
            "ball on q18, limited",
            ball("q18", 4),
            &limited,
            "plate",
            3.0,
        ),
        (
            "q18 on h8, limited",
            arch("q18", "h8", "faces"),
            &limited,
            "arch",
            -0.2,
        ),
        (
            "ball on h8, orthotropic",
            ball("h8", 6),
            &orthotropic,
            "plate",
            3.0,
        ),
        ("h8 on h8", arch("h8", "h8", "faces"), &some, "arch", -0.2),
        (
            "h8 on h8, stuck",
            arch("h8", "h8", "faces"),
            &coulomb(1e5),
            "arch",
            -0.2,
        ),
        ("q18 on h8", arch("q18", "h8", "faces"), &some, "arch", -0.2),
        ("h8 on q18", arch("h8", "q18", "faces"), &some, "arch", -0.2),
        (
            "q18 on q18",
            arch("q18", "q18", "faces"),
            &some,
            "arch",
            -0.2,
        ),
        (
            "h8 on smooth h8",
            arch("h8", "h8", "smooth"),
            &some,
            "arch",
            -0.2,
        ),
        (
            "h8 on q18, orthotropic",
            arch("h8", "q18", "faces"),
            &orthotropic,
            "arch",
            -0.2,
        ),
    ] {
        let mut scene = scene;
        for contact in scene["contacts"]
            .as_object_mut()
            .expect("contacts")
            .values_mut()
        {
            contact["points"] = json!({"gauss": 3});
            contact["gap"] = json!("averaged");
            contact["penalty"] = json!({"value": 500});
            contact["tangential_penalty"] = json!({"value": 300});
            contact["friction"] = friction.clone();
        }
        let ([error, skew], [slip, stick]) = tangent(name, &scene, body, lift);
        assert!(error < 1e-7, "{name}: {error:e}");
        let sticks = name.ends_with("stuck");
        assert_eq!(slip == 0, sticks, "{name}: {slip} slide");
        assert!(sticks || skew > 1e-4, "{name}: {skew:e}");
        slipped += slip;
        stuck += stick;
    }
    assert!(slipped > 20 && stuck > 20, "{slipped} {stuck}");
}
