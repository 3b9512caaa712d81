//! What cannot be a sheet, and what does not go with one, is refused by name and place.
use super::{Patch, knots, sheet};
use covact::model::build::build;
use covact::scene;
use serde_json::{Value, json};

fn scene_of(body: Value) -> Value {
    json!({
        "covact": 1,
        "materials": {
            "m": {"st_venant_kirchhoff": {"E": 1000, "nu": 0.3}},
            "other": {"hencky": {"E": 1000, "nu": 0.3}}
        },
        "bodies": {
            "sheet": body,
            "block": {
                "mesh": {"block": {"min": [0, 0, -2], "max": [1, 1, -1], "elements": [1, 1, 1]}}, "material": "m"
            }
        },
        "supports": {
            "all": {"on": ["sheet.edge.1", "sheet.edge.2"], "fixed": true},
            "floor": {"on": "block.bottom", "fixed": true}
        }
    })
}

/// Everything that is wrong with a scene, each with its place.
fn problems(scene: &Value, geometry: &Value) -> Vec<String> {
    let folder = tempfile::tempdir().expect("temporary folder");
    std::fs::write(folder.path().join("face.json"), geometry.to_string()).expect("written");
    let text = serde_json::to_string_pretty(scene).expect("serialisable");
    let mut loaded = match scene::parse(&text, "scene.json") {
        Ok(loaded) => loaded,
        Err(error) => return vec![error.to_string()],
    };
    loaded.dir = folder.path().to_path_buf();
    let found = scene::check(&loaded);
    if !found.is_empty() {
        return found.iter().map(|p| p.to_string()).collect();
    }
    match build(&loaded) {
        Ok(_) => Vec::new(),
        Err(error) => {
            let of = |e: &covact::model::ModelError| format!("{}: {e}", e.pointer);
            std::iter::once(of(&error))
                .chain(error.others.iter().map(of))
                .collect()
        }
    }
}

fn only(scene: &Value, geometry: &Value, words: &[&str]) {
    let found = problems(scene, geometry);
    assert_eq!(found.len(), 1, "{words:?}: {found:#?}");
    for word in words {
        assert!(found[0].contains(word), "`{word}` is not in {}", found[0]);
    }
}

fn plate() -> Value {
    Patch::plate([1.0, 1.0], 0.0).json()
}

#[test]
fn the_scene_itself_is_right() {
    assert_eq!(
        problems(&scene_of(sheet(0.1, [2, 2])), &plate()),
        Vec::<String>::new()
    );
}

#[test]
fn faces_that_cannot_be_sheets() {
    let scene = scene_of(sheet(0.1, [2, 2]));
    let pole = Patch::sphere(1.0, [0.0, std::f64::consts::FRAC_PI_2]).json();
    only(
        &scene,
        &pole,
        &["/bodies/sheet/nurbs/file", "edge 4", "pole"],
    );
    let bent = Patch {
        degree: [1, 1],
        knots: [vec![0.0, 0.0, 0.5, 1.0, 1.0], knots(1)],
        points: (0..6)
            .map(|k| {
                [
                    f64::from(k % 3),
                    f64::from(k / 3),
                    f64::from(u8::from(k % 3 == 1)),
                    1.0,
                ]
            })
            .collect(),
    };
    only(&scene, &bent.json(), &["crease", "xi1 = 0.5"]);
    let high = Patch {
        degree: [4, 1],
        knots: [knots(4), knots(1)],
        points: (0..10)
            .map(|k| [f64::from(k % 5), f64::from(k / 5), 0.0, 1.0])
            .collect(),
    };
    only(&scene, &high.json(), &["degree 4 along xi1, above 3"]);
    let mut two = plate();
    let mut second = two["patches"][0].clone();
    second["entity"] = json!(2);
    two["patches"].as_array_mut().expect("patches").push(second);
    only(
        &scene,
        &two,
        &["/bodies/sheet/nurbs/file", "faces 1 and 2 are the same"],
    );
    let mut chosen = scene.clone();
    chosen["bodies"]["sheet"]["nurbs"]["faces"] = json!([2]);
    assert_eq!(problems(&chosen, &two), Vec::<String>::new());
    chosen["bodies"]["sheet"]["nurbs"]["faces"] = json!([7]);
    only(&chosen, &two, &["/bodies/sheet/nurbs/faces/0", "no face 7"]);
    // Trimmed, beside another one.
    let loops = json!([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]].map(|[x, y]| [x, y, 1.0]));
    let side = |a: usize, b: usize| json!({"degree": 1, "knots": knots(1), "domain": [0.0, 1.0], "points": [loops[a], loops[b]]});
    let mut trimmed = two.clone();
    trimmed["patches"][1]["points"] =
        json!([[1, 0, 0, 1], [2, 0, 0, 1], [1, 1, 0, 1], [2, 1, 0, 1]]);
    trimmed["patches"][1]["trim"] = json!([[side(0, 1), side(1, 2), side(2, 0)]]);
    let mut beside = scene.clone();
    beside["supports"]["all"]["on"] = json!(["sheet.1.edge.1", "sheet.1.edge.3", "sheet.2.trim.1"]);
    assert_eq!(problems(&beside, &trimmed), Vec::<String>::new());
    trimmed["patches"]
        .as_array_mut()
        .expect("patches")
        .remove(0);
    let mut alone = scene.clone();
    alone["supports"]["all"]["on"] = json!("sheet.top");
    assert_eq!(problems(&alone, &trimmed), Vec::<String>::new());
    // Edges that are cut away are no sets.
    alone["supports"]["all"]["on"] = json!("sheet.edge.1");
    only(
        &alone,
        &trimmed,
        &["/supports/all/on", "no node set `edge.1`"],
    );
    // A collapsed net: no tangent plane anywhere.
    let line = Patch {
        degree: [1, 1],
        knots: [knots(1), knots(1)],
        points: [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]
            .map(|[x, y]| [x, y, 0.0, 1.0])
            .to_vec(),
    };
    only(&scene, &line.json(), &["no normal"]);
}

/// Half of a square, cut along its diagonal: edges 1 and 3 are left in part.
#[test]
fn what_trimmed_sheets_cannot_do() {
    let corners = [[0.0, 0.0], [0.9, 0.0], [0.0, 0.9]].map(|[x, y]| [x, y, 1.0]);
    let side = |a: usize, b: usize| {
        let points = [corners[a], corners[b]];
        json!({"degree": 1, "knots": knots(1), "domain": [0.0, 1.0], "points": points})
    };
    let mut half = plate();
    half["patches"][0]["trim"] = json!([[side(0, 1), side(1, 2), side(2, 0)]]);
    let mut scene = scene_of(sheet(0.1, [4, 4]));
    scene["supports"]["all"] = json!({"on": "sheet.edge.3", "clamped": true});
    assert_eq!(problems(&scene, &half), Vec::<String>::new());
    // What is left of an edge and the curve bear loads, and the curve is held; the face is a master.
    for (key, load) in [("couple", json!(1)), ("force", json!([0, 0, 1]))] {
        for on in ["sheet.edge.1", "sheet.trim.1", "sheet.trim.1.2"] {
            let mut loaded = scene.clone();
            loaded["loads"] = json!({"load": {"on": on, key: load}});
            assert_eq!(problems(&loaded, &half), Vec::<String>::new());
        }
    }
    let mut held = scene.clone();
    held["supports"]["all"]["on"] = json!("sheet.trim.1.2");
    assert_eq!(problems(&held, &half), Vec::<String>::new());
    held["supports"]["all"]["on"] = json!("sheet.trim.1.1");
    only(
        &held,
        &half,
        &["/supports/all/on", "no node set `trim.1.1`"],
    );
    scene["contacts"] = json!({"c": {"slave": "block.top", "master": "sheet.bottom"}});
    assert_eq!(problems(&scene, &half), Vec::<String>::new());
    // Folded along the curve.
    let mut folded = half.clone();
    let mut second = plate()["patches"][0].clone();
    second["entity"] = json!(2);
    second["points"] = json!([
        [0.9, 0, 0, 1],
        [0, 0.9, 0, 1],
        [0.9, 0, 0.5, 1],
        [0, 0.9, 0.5, 1]
    ]);
    folded["patches"]
        .as_array_mut()
        .expect("patches")
        .push(second);
    let mut master = scene.clone();
    master["supports"]["all"]["on"] = json!("sheet.1.edge.3");
    only(
        &master,
        &folded,
        &[
            "/contacts/c/master",
            "is folded along a curve of a trim between faces 1 and 2",
        ],
    );
    let mut nothing = half.clone();
    let small = json!([[0.0, 0.0, 1.0], [1e-9, 0.0, 1.0], [0.0, 1e-9, 1.0]]);
    for k in 0..3 {
        let points = json!([small[k], small[(k + 1) % 3]]);
        nothing["patches"][0]["trim"][0][k]["points"] = points;
    }
    only(
        &scene,
        &nothing,
        &["/bodies/sheet/nurbs/file", "leaves nothing of it"],
    );
}

#[test]
fn keys_that_do_not_fit() {
    let good = scene_of(sheet(0.1, [2, 2]));
    let with = |pointer: &str, key: &str, value: Value| {
        let mut scene = good.clone();
        scene.pointer_mut(pointer).expect(pointer)[key] = value;
        scene
    };
    let cases = [
        (
            with("/bodies/sheet", "element", json!("h8")),
            "leave `element` out",
        ),
        (
            with(
                "/bodies/sheet",
                "mesh",
                json!({"plate": {"size": [1, 1], "thickness": 1, "elements": [1, 1]}}),
            ),
            "not both",
        ),
        (
            with("/bodies/sheet", "material", json!("other")),
            "no form in plane stress",
        ),
        (
            with("/bodies/sheet/nurbs", "thickness", json!(-1)),
            "the thickness is -1",
        ),
        (with("/bodies/sheet/nurbs", "size", json!(0.2)), "at once"),
        (
            with("/bodies/sheet/nurbs", "elements", Value::Null),
            "elements",
        ),
        (
            with(
                "/bodies/sheet",
                "sets",
                json!({"none": {"nodes_near_point": {"point": [0.5, 0.5, 0], "tolerance": 0.1}}}),
            ),
            "whole edge or corner",
        ),
        (
            with(
                "/supports",
                "more",
                json!({"on": "block.top", "clamped": true}),
            ),
            "belongs to a body of elements",
        ),
        (
            with(
                "/supports",
                "more",
                json!({"on": "sheet.corner.1", "clamped": true}),
            ),
            "is no whole edge",
        ),
        (
            with(
                "/supports",
                "more",
                json!({"on": "sheet.edge.3", "mid_surface": true, "fixed": true}),
            ),
            "is a mid-surface already",
        ),
        (
            with(
                "",
                "loads",
                json!({"turn": {"on": "block.top", "couple": 1}}),
            ),
            "no edge of a body of kind `nurbs`",
        ),
        (
            with(
                "",
                "probes",
                json!({"p": {"on": "sheet.edge.1", "quantity": "von_mises"}}),
            ),
            "no stress at its control points",
        ),
        (
            with("", "solution", json!({"kinematics": "small"})),
            "does not go with a body of kind `nurbs`",
        ),
    ];
    for (scene, words) in cases {
        let geometry = plate();
        let found = problems(&scene, &geometry);
        assert!(
            found.iter().any(|p| p.contains(words)),
            "`{words}`: {found:#?}"
        );
    }
    // A dish is not extruded along y.
    let dish = Patch::sphere(1.0, [0.0, 1.0]).json();
    let scene = with(
        "/supports",
        "more",
        json!({"on": "sheet.top", "plane_strain": "y"}),
    );
    only(
        &scene,
        &dish,
        &["/supports/more/plane_strain", "is not extruded"],
    );
}

#[test]
fn contacts_that_are_not_there_yet() {
    let contact = |contact: Value| {
        let mut scene = scene_of(sheet(0.1, [2, 2]));
        scene["surfaces"] = json!({"ball": {"sphere": {"radius": 1, "center": [0.5, 0.5, 1.2]}}});
        scene["contacts"] = json!({"c": contact});
        scene
    };
    let good = json!({"slave": "sheet.top", "master": "ball"});
    assert_eq!(
        problems(&contact(good.clone()), &plate()),
        Vec::<String>::new()
    );
    for (scene, words) in [
        (
            contact(json!({"slave": "block.top", "master": "sheet.bottom", "passes": "edges"})),
            ["/contacts/c/passes", "two passes"],
        ),
        (
            contact(
                json!({"slave": "sheet.top", "master": "ball", "gap": "averaged", "points": {"gauss": 3}}),
            ),
            ["/contacts/c/gap", "averaged gaps"],
        ),
    ] {
        only(&scene, &plate(), &words);
    }
    let round = contact(json!({"slave": "block.top", "master": "sheet.bottom"}));
    let cylinder = Patch::cylinder(1.0, [0.0, 1.0], 1.0).json();
    assert_eq!(problems(&round, &cylinder), Vec::<String>::new());
    let mut driven = contact(good.clone());
    driven["surfaces"]["ball"]["motion"] = json!({"free": {"force": {"z": "-t"}}});
    only(&driven, &plate(), &["driven by force"]);
}
