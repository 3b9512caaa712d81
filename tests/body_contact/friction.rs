//! Friction between deformable bodies.
use crate::blocks::done;
use crate::self_contact::{R, T, pinched};
use crate::support::Outcome;
use serde_json::{Value, json};

const MU: f64 = 0.3;
const E: f64 = 1e4;
const EPS: f64 = 1e5;

/// Two blocks of one layer of elements whose nodes keep their heights and their `y`: the interface is plane, and its nodes
/// are free to move along `x` where no other support holds them. The upper block (1 x 1) is pressed in by `sink` until
/// t = 0.25, then its top is moved along `x`.
pub fn layers(upper: [u32; 2], lower: [u32; 2], slave: &str, sink: f64, way: &str) -> Value {
    let down = format!("-{sink}*min(1, 4*t)");
    let master = match slave {
        "upper.bottom" => "lower.top",
        _ => "upper.bottom",
    };
    json!({
        "covact": 1,
        "materials": {"m": {"st_venant_kirchhoff": {"E": E, "nu": 0}}},
        "bodies": {
            "lower": {"mesh": {"block": {
                "min": [-1, -0.1, -0.5], "max": [3, 1.1, 0], "elements": [lower[0], lower[1], 1]
            }}, "material": "m"},
            "upper": {"mesh": {"block": {
                "min": [0, 0, 0], "max": [1, 1, 0.5], "elements": [upper[0], upper[1], 1]
            }}, "material": "m"}
        },
        "contacts": {"rub": {
            "slave": slave, "master": master, "points": {"gauss": 3},
            "penalty": {"value": EPS}, "tangential_penalty": {"value": EPS},
            "friction": {"coulomb": {"mu": MU}}
        }},
        "supports": {
            "ground": {"on": "lower.bottom", "fixed": true},
            "face": {"on": "lower.top", "displacement": {"y": 0, "z": 0}},
            "sole": {"on": "upper.bottom", "displacement": {"y": 0, "z": down.clone()}},
            "push": {"on": "upper.top", "displacement": {"x": way, "y": 0, "z": down}}
        },
        "solution": {
            "step": {"initial": 0.125, "max": 0.125}, "newton": {"tolerance": 1e-11}, "threads": 1
        },
        "output": {"every": 0}
    })
}

pub fn last(outcome: &Outcome, column: &str) -> f64 {
    *outcome.column(column).last().expect("steps")
}

/// `H = mu V` (Coulomb's law over a plane interface, on which all points slide the same way), whichever side is the slave,
/// and as two half passes, over many facets and past their borders.
#[test]
fn a_block_that_slides_is_held_back_by_mu_times_its_load() {
    for (slave, two_half) in [
        ("upper.bottom", false),
        ("lower.top", false),
        ("upper.bottom", true),
    ] {
        let mut scene = layers([2, 2], [7, 3], slave, 0.002, "1.3*max(0, t-0.25)");
        if two_half {
            scene["contacts"]["rub"]["passes"] = json!("two_half");
        }
        let outcome = done(&scene);
        let slide = |side: &str, c: &str| outcome.column(&format!("{side}.force.rub.{c}"));
        let (h, v) = (slide("slave", "x"), slide("slave", "z"));
        let (hm, vm) = (slide("master", "x"), slide("master", "z"));
        let (time, slip) = (outcome.column("time"), outcome.column("points.slip"));
        let mut sliding = 0;
        for i in 0..time.len() {
            println!(
                "{slave} {} {} {} {} {}",
                time[i], h[i], v[i], hm[i], slip[i]
            );
            assert!(v[i].abs() > 1.0);
            // Half passes integrate each over its own faces, of which only a part is covered.
            let balance = if two_half { 0.2 } else { 1e-12 };
            assert!((v[i] + vm[i]).abs() < balance * v[i].abs());
            if time[i] > 0.4 {
                assert!((h[i].abs() - MU * v[i].abs()).abs() < 1e-9 * v[i].abs());
                assert!((hm[i].abs() - MU * vm[i].abs()).abs() < 1e-9 * v[i].abs());
                assert!(h[i] * hm[i] < 0.0);
                sliding += 1;
            }
        }
        assert!(sliding >= 4 && last(&outcome, "points.slip") > 30.0);
        assert_eq!(last(&outcome, "points.stick"), 0.0);
        // The work of the drag over the way slid: the top moves by 0.975 in all, the shear of both layers takes 0.013 of it.
        // The load of faces that are covered in part varies with the points that are.
        let work = MU * v.last().expect("steps").abs() * 0.962;
        let dissipated = last(&outcome, "energy.dissipated");
        println!("dissipated {dissipated} {work}");
        let (low, high) = if slave == "upper.bottom" && !two_half {
            (0.98, 1.02)
        } else {
            (0.8, 1.2)
        };
        assert!(dissipated > low * work && dissipated < high * work);
    }
}

/// Largest difference of the `x` displacements of the free nodes of the interface from the exact state of two layers in
/// shear that stick to each other, relative to the shift of the top.
pub fn stick(points: Value, two_half: bool) -> f64 {
    match two_half {
        true => stick_as(points, ("passes", json!("two_half"))),
        false => stick_as(points, ("gap", json!("pointwise"))),
    }
}

/// [`stick`] of a contact with another choice.
pub fn stick_as(points: Value, (key, choice): (&str, Value)) -> f64 {
    // A hundredth of the penetration: second order terms of a larger shear would act on the free sides.
    let shift = 2e-5;
    let way = format!("{shift}*max(0, t-0.25)/0.75");
    let mut scene = layers([3, 3], [2, 2], "upper.bottom", 0.002, &way);
    let body = &mut scene["bodies"]["lower"]["mesh"]["block"];
    body["min"] = json!([0, 0, -0.5]);
    body["max"] = json!([1, 1, 0]);
    let rub = &mut scene["contacts"]["rub"];
    rub["points"] = points;
    rub["friction"]["coulomb"]["mu"] = json!(10.0);
    rub[key] = choice;
    scene["output"]["every"] = json!(1);
    let outcome = done(&scene);
    assert_eq!(last(&outcome, "points.slip"), 0.0);
    assert!(last(&outcome, "points.stick") > 0.0);
    let mut all = Vec::new();
    for (body, z) in [("upper", 0.0), ("lower", 0.0)] {
        let file = outcome.body(body, outcome.summary.steps);
        let u = file.field("displacement");
        let on = (file.points.iter().enumerate()).filter(|(_, p)| p[2] == z);
        let x: Vec<f64> = on.map(|(i, _)| u[3 * i]).collect();
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        println!("{body}: mean {mean:e} {x:?}");
        all.push((mean, x));
    }
    // Both layers are alike but for the compression of the upper one.
    let jump = all[0].0 - all[1].0;
    assert!(jump > 0.0 && all[1].0 > 0.1 * shift && all[0].0 < 0.9 * shift);
    let t = last(&outcome, "slave.force.rub.x").abs();
    assert!((t - EPS * jump).abs() < 0.02 * t, "{t} {}", EPS * jump);
    let off = (all.iter()).flat_map(|(mean, x)| x.iter().map(move |x| (x - mean).abs()));
    off.fold(0.0, f64::max) / shift
}

/// The patch test of sticking: uniform shear through an interface of meshes that do not match. Two half passes, each of which
/// integrates its own shape functions, pass it; one pass has the error of the kinks that its Gauss points integrate over, as
/// the patch test of pressure has.
#[test]
fn meshes_that_do_not_match_stick_in_uniform_shear() {
    let exact = stick(json!({"gauss": 3}), true);
    let errors = [2, 3, 5, 10].map(|n| stick(json!({"gauss": n}), false));
    println!("{exact:e} {errors:?}");
    assert!(exact < 1e-5, "{exact:e}");
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
    assert!(
        errors[0] < 0.02 && errors[3] < 0.1 * errors[0],
        "{errors:?}"
    );
}

/// Two blocks that stick to each other, sheared and then turned by 90 degrees as a whole in steps of 15: the force between
/// them turns with them and changes by nothing (F10: a projection of the traction of the step before would lose some in
/// every step).
#[test]
fn turning_a_sticking_pair_changes_nothing_in_its_traction() {
    turn(json!({"gauss": 2}), 0, "pointwise");
}

/// [`turning_a_sticking_pair_changes_nothing_in_its_traction`] with these slave points and gaps, from a step on.
pub fn turn(points: Value, first: usize, gap: &str) {
    // Pressed and sheared until t = 1, then turned about y.
    let angle = "1.5707963267948966*max(0, t-1)/6";
    let (c, s) = (format!("cos({angle})"), format!("sin({angle})"));
    let turned = |dx: &str, dz: &str| {
        json!({
            "x": format!("{c}*(x+{dx}) + {s}*(z+{dz}) - x"),
            "y": 0,
            "z": format!("{c}*(z+{dz}) - {s}*(x+{dx}) - z")
        })
    };
    let scene = json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {
            "lower": {"mesh": {"block": {
                "min": [-0.7, -0.7, -0.5], "max": [0.7, 0.7, 0], "elements": [3, 3, 2]
            }}, "material": "m"},
            "upper": {"mesh": {"block": {
                "min": [-0.5, -0.5, 0], "max": [0.5, 0.5, 0.5], "elements": [4, 2, 2]
            }}, "material": "m"}
        },
        "contacts": {"stick": {
            "slave": "upper.bottom", "master": "lower.top", "points": points, "gap": gap,
            "penalty": {"value": 2000}, "friction": {"coulomb": {"mu": 5.0}}
        }},
        "supports": {
            "ground": {"on": "lower.bottom", "displacement": turned("0", "0")},
            "push": {"on": "upper.top", "displacement": turned("0.04*min(1, t)", "-0.04*min(1, t)")}
        },
        "solution": {
            "end_time": 7, "step": {"initial": 1, "max": 1},
            "newton": {"tolerance": 1e-11}, "threads": 1
        },
        "output": {"every": 0}
    });
    let outcome = done(&scene);
    let [x, z] = ["x", "z"].map(|c| outcome.column(&format!("slave.force.stick.{c}")));
    let [time, slip] = ["time", "points.slip"].map(|c| outcome.column(c));
    let energy = outcome.column("energy.internal");
    assert!(time.len() >= 7 && slip.iter().all(|n| *n == 0.0));
    assert!(x[0].abs() > 0.1 && z[0].abs() > 0.5, "{} {}", x[0], z[0]);
    let angle = |i: usize| std::f64::consts::FRAC_PI_2 * (time[i] - 1.0).max(0.0) / 6.0;
    for i in first..time.len() {
        let (s, c) = (angle(i) - angle(first)).sin_cos();
        let expected = [c * x[first] + s * z[first], c * z[first] - s * x[first]];
        let error = (x[i] - expected[0]).abs().max((z[i] - expected[1]).abs());
        println!(
            "{}: {error:e} {:e}",
            time[i],
            energy[i] / energy[first] - 1.0
        );
        assert!(error < 1e-8 * z[0].abs(), "{error:e}");
        assert!((energy[i] / energy[first] - 1.0).abs() < 1e-8);
    }
}

/// A sledge on a curved bed of 12 faces, drawn over their edges.
fn sledge(bed: bool, friction: &Value, folder: &std::path::Path) -> Outcome {
    let (outer, thickness) = (10.25, 0.5);
    let mut scene = json!({
        "covact": 1,
        "materials": {"m": {"neo_hooke": {"E": 100, "nu": 0.3}}},
        "bodies": {"sledge": {"mesh": {"block": {
            "min": [-1.2, 0.1, 10.26], "max": [-0.4, 0.9, 10.66], "elements": [4, 2, 2]
        }}, "material": "m"}},
        "contacts": {"rub": {
            "slave": "sledge.bottom", "master": "bed.outer", "points": {"gauss": 2},
            "penalty": {"value": 1000}, "friction": friction, "depth": 0.3
        }},
        "supports": {"push": {"on": "sledge.top", "displacement": {
            "x": "1.5*max(0, t-0.2)/0.8", "y": 0, "z": "-0.06*min(1, t/0.2)"
        }}},
        "solution": {
            "step": {"initial": 0.1, "max": 0.1}, "newton": {"tolerance": 1e-11}, "threads": 1
        },
        "output": {"every": 0}
    });
    if bed {
        scene["bodies"]["bed"] = json!({"mesh": {"cylinder_panel": {
            "radius": outer - 0.5 * thickness, "thickness": thickness, "angles": [-15, 15],
            "y": [0, 1], "elements": [12, 1]
        }}, "material": "m"});
        scene["supports"]["bed_outer"] = json!({"on": "bed.outer", "fixed": true});
        scene["supports"]["bed_inner"] = json!({"on": "bed.inner", "fixed": true});
        return done(&scene);
    }
    let mut text = "solid bed\n".to_owned();
    for i in 0..12 {
        let at = |i: u32| (f64::from(i) * 2.5 - 15.0).to_radians().sin_cos();
        let (a, b) = (at(i), at(i + 1));
        let corners = [(a, 0.0), (b, 0.0), (a, 1.0), (b, 1.0)];
        for triangle in [[0, 1, 3], [0, 3, 2]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for k in triangle {
                let ((s, c), y): ((f64, f64), f64) = corners[k];
                text += &format!("vertex {:e} {y:e} {:e}\n", outer * s, outer * c);
            }
            text += "endloop\nendfacet\n";
        }
    }
    text += "endsolid bed\n";
    let path = folder.join("bed.stl");
    std::fs::write(&path, text).expect("a file");
    scene["surfaces"] = json!({"bed": {"cad": {"file": path}, "depth": 0.3}});
    scene["contacts"]["rub"]["master"] = json!("bed");
    (scene["contacts"]["rub"].as_object_mut().expect("keys")).remove("depth");
    done(&scene)
}

/// A body whose nodes are all held is a rigid surface of facets.
fn held(friction: &Value, forces: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let [body, rigid] = [true, false].map(|bed| sledge(bed, friction, folder.path()));
    for c in forces {
        let b = body.column(&format!("slave.force.rub.{c}"));
        let r = rigid.column(&format!("force.bed.{c}"));
        assert_eq!(b.len(), r.len());
        assert!(last(&body, &format!("slave.force.rub.{c}")).abs() > 1e-2);
        let size = b.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        for (b, r) in b.iter().zip(&r) {
            println!("{c}: {b} {r} {:e}", b / r - 1.0);
            let near = b.abs().max(if *c == "y" { size } else { 0.0 });
            assert!(near > 1e-3 && (b - r).abs() < 1e-7 * near, "{b} {r}");
        }
    }
    for c in ["energy.dissipated", "energy.friction", "points.slip"] {
        let (b, r) = (last(&body, c), last(&rigid, c));
        assert!(b > 0.0 && (b - r).abs() < 1e-7 * b, "{c}: {b} {r}");
    }
    assert_eq!(last(&body, "points.stick"), last(&rigid, "points.stick"));
}

#[test]
fn a_master_that_is_held_is_a_rigid_surface() {
    held(&json!({"coulomb": {"mu": 0.2}}), &["x", "z"]);
}

/// A direction that leans against all faces of the bed, over whose edges the sledge is drawn.
#[test]
fn a_master_that_is_held_is_a_rigid_surface_to_two_coefficients_as_well() {
    let two = json!({"orthotropic": {"mu": [0.1, 0.3], "direction": [1, 0.8, 0.1]}});
    held(&two, &["x", "y", "z"]);
}

/// Both bodies deform; the facets under the sledge change, and forces and moments of the two sides balance.
#[test]
fn a_sledge_on_a_soft_bed_balances_in_force_and_moment() {
    for surface in ["faces", "smooth"] {
        let mut scene = crate::sliding::slide(1.5, 8);
        scene["contacts"]["press"]["friction"] = json!({"coulomb": {"mu": 0.2}});
        scene["contacts"]["press"]["master_surface"] = json!(surface);
        let outcome = done(&scene);
        let column = |name: &str| outcome.column(&format!("{name}.force.press.z"));
        let (force, up) = (column("slave"), column("master"));
        let drag = outcome.column("slave.force.press.x");
        let [f, m] = ["force", "moment"].map(|w| outcome.column(&format!("imbalance.{w}.press")));
        for i in 0..force.len() {
            println!("{surface} {} {} {:e} {:e}", force[i], drag[i], f[i], m[i]);
            if force[i] == 0.0 {
                continue;
            }
            assert!((force[i] + up[i]).abs() < 1e-12 * force[i].abs());
            assert!(f[i] < 1e-12 * force[i].abs(), "{:e}", f[i]);
            // Lengths are up to 4.
            assert!(m[i] < 1e-11 * force[i].abs(), "{:e}", m[i]);
        }
        let (h, v) = (drag.last().expect("steps"), force.last().expect("steps"));
        assert!((h.abs() / v.abs() - 0.2).abs() < 0.02, "{h} {v}");
        let iterations = outcome.summary.newton_iterations;
        let rebuilds = outcome.summary.pattern_rebuilds;
        println!("{iterations} iterations, {rebuilds} rebuilds");
        // On the smooth bed attempts that fail, half of all iterations, lead to facets that nothing meets later.
        assert!(u64::from(rebuilds) * 2 < iterations);
    }
}

/// The blocks of [`layers`] as one body of two parts, in an Abaqus file at `path`.
fn both_blocks(path: &std::path::Path, upper: [usize; 2], lower: [usize; 2]) {
    let mut text = String::new();
    let mut surfaces = String::new();
    let (mut nodes, mut elements) = (0, 0);
    for (name, [nx, ny], min, max) in [
        ("lower", lower, [-1.0, -0.1, -0.5], [3.0, 1.1, 0.0]),
        ("upper", upper, [0.0, 0.0, 0.0], [1.0, 1.0, 0.5]),
    ] {
        let id = |i: usize, j: usize, k: usize| nodes + 1 + i + (nx + 1) * (j + (ny + 1) * k);
        text += "*NODE\n";
        for (k, j, i) in
            (0..2).flat_map(|k| (0..=ny).flat_map(move |j| (0..=nx).map(move |i| (k, j, i))))
        {
            let at = |c: usize, share: f64| min[c] + (max[c] - min[c]) * share;
            let [x, y] = [at(0, i as f64 / nx as f64), at(1, j as f64 / ny as f64)];
            text += &format!("{}, {x:e}, {y:e}, {:e}\n", id(i, j, k), at(2, k as f64));
        }
        text += &format!("*ELEMENT, TYPE=C3D8, ELSET={name}\n");
        for (j, i) in (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i))) {
            elements += 1;
            let ring = |k| {
                [
                    id(i, j, k),
                    id(i + 1, j, k),
                    id(i + 1, j + 1, k),
                    id(i, j + 1, k),
                ]
            };
            let all: Vec<String> = [ring(0), ring(1)]
                .concat()
                .iter()
                .map(ToString::to_string)
                .collect();
            text += &format!("{elements}, {}\n", all.join(", "));
        }
        surfaces += &format!("*SURFACE, NAME={name}_bottom, TYPE=ELEMENT\n{name}, S1\n");
        surfaces += &format!("*SURFACE, NAME={name}_top, TYPE=ELEMENT\n{name}, S2\n");
        nodes = id(nx, ny, 1);
    }
    std::fs::write(path, text + &surfaces).expect("a mesh file");
}

/// Two blocks are one body of two parts: contact of the body with itself, and friction as between two.
#[test]
fn a_body_slides_on_itself_as_on_another() {
    let (upper, lower) = ([2, 2], [7, 3]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("both.inp");
    both_blocks(&path, upper.map(|n| n as usize), lower.map(|n| n as usize));
    let ellipse = json!({"orthotropic": {"mu": [0.2, 0.4], "direction": [1, 1, 0]}});
    for (slave, friction) in [
        ("upper.bottom", json!({"coulomb": {"mu": MU}})),
        ("lower.top", json!({"coulomb": {"mu": MU}})),
        ("upper.bottom", ellipse),
    ] {
        let mut two = layers(upper, lower, slave, 0.002, "0.4*max(0, t-0.25)");
        two["contacts"]["rub"]["friction"] = friction;
        for body in ["upper", "lower"] {
            two["bodies"][body]["element"] = json!("h8_displacement");
        }
        let mut one = two.clone();
        one["bodies"] = json!({"both": {
            "mesh": {"file": {"path": path}}, "material": "m", "element": "h8_displacement"
        }});
        let named = |set: &Value| {
            let set = set.as_str().expect("a set").replace('.', "_");
            json!(format!("both.{set}"))
        };
        for side in ["slave", "master"] {
            one["contacts"]["rub"][side] = named(&two["contacts"]["rub"][side]);
        }
        for support in ["ground", "face", "sole", "push"] {
            one["supports"][support]["on"] = named(&two["supports"][support]["on"]);
        }
        let (two, one) = (done(&two), done(&one));
        assert!(last(&one, "points.slip") > 10.0 && last(&one, "energy.dissipated") > 0.1);
        for column in [
            "slave.force.rub.x",
            "slave.force.rub.z",
            "master.force.rub.x",
            "energy.internal",
            "energy.friction",
            "energy.dissipated",
            "points.stick",
            "points.slip",
        ] {
            let (a, b) = (two.column(column), one.column(column));
            let scale = a.iter().fold(0.0f64, |s, x| s.max(x.abs()));
            assert!(a.len() == b.len() && (scale > 0.0 || column == "points.stick"));
            for (a, b) in a.iter().zip(&b) {
                assert!((a - b).abs() <= 1e-9 * scale, "{slave}, {column}: {a} {b}");
            }
        }
    }
}

/// The walls of a pinched tube rub on each other: by symmetry nothing slides, and the force is that without friction.
#[test]
fn walls_that_meet_may_rub() {
    let run = |friction: bool| {
        let mut scene = pinched(2.0 * R - T + 0.05, json!("nodes"));
        if friction {
            scene["contacts"]["walls"]["friction"] = json!({"coulomb": {"mu": 0.3}});
        }
        done(&scene)
    };
    let (with, without) = (run(true), run(false));
    let touching = last(&with, "points.stick") + last(&with, "points.slip");
    assert!(touching > 0.0 && touching == last(&with, "points.active"));
    assert!(last(&with, "imbalance.force.walls") < 1e-12);
    let [a, b] = [&with, &without].map(|o| last(o, "force.push.z"));
    println!("{a} {b}");
    assert!((a - b).abs() < 1e-3 * b.abs(), "{a} {b}");
}

/// With multipliers a soft penalty leaves neither gap nor elastic slip, and the drag is that of a stiff one.
#[test]
fn augmentation_resolves_gap_and_elastic_slip_between_bodies() {
    let run = |penalty: f64, augmented: bool| {
        let mut scene = crate::sliding::slide(0.4, 4);
        let press = &mut scene["contacts"]["press"];
        press["friction"] = json!({"coulomb": {"mu": 0.4}});
        press["penalty"] = json!({ "value": penalty });
        if augmented {
            press["augmentation"] = json!({"gap": 1e-4, "slip": 1e-4, "max": 25});
        }
        done(&scene)
    };
    let (soft, augmented, stiff) = (run(2e3, false), run(2e3, true), run(2e5, false));
    let force = |o: &Outcome, c: &str| last(o, &format!("slave.force.press.{c}"));
    for c in ["x", "z"] {
        let [soft, augmented, stiff] = [&soft, &augmented, &stiff].map(|o| force(o, c));
        println!("{c}: {soft} {augmented} {stiff}");
        assert!(
            (augmented / stiff - 1.0).abs() < 5e-3,
            "{augmented} {stiff}"
        );
        assert!((augmented - stiff).abs() < 0.2 * (soft - stiff).abs());
    }
    let sunk = |o: &Outcome| {
        o.column("penetration.max")
            .iter()
            .fold(0.0, |a: f64, b| a.max(*b))
    };
    println!("{:e} {:e}", sunk(&soft), sunk(&augmented));
    // A ten thousandth of an element of side 0.25 at most.
    assert!(sunk(&augmented) < 1e-4 && sunk(&soft) > 1e-3);
    assert!(augmented.column("augmentations").iter().sum::<f64>() > 0.0);
}
