//! Scenes as people write them: short forms, comments, and all that is wrong in one round.
use crate::support::{assert_parts, covact, problems, stderr};
use covact::contact::closest::ClosestPoint;
use covact::model::build::build;
use covact::scene::{self, LoadedScene};
use covact_geometry::Vec3;
use std::path::Path;

fn loaded(text: &str) -> LoadedScene {
    let loaded = scene::parse(text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
    let problems = scene::check(&loaded);
    assert!(problems.is_empty(), "{}", loaded.error(problems));
    loaded
}

/// A sheet under a ball, with further keys in the places that tests are about.
fn sheet(mesh: &str, surface: &str, contact: &str, support: &str) -> String {
    format!(
        r#"{{
  "covact": 1,
  "materials": {{"rubber": {{"neo_hooke": {{"E": 10, "nu": 0.3}}}}}},
  "bodies": {{"sheet": {{"mesh": {mesh}, "material": "rubber"}}}},
  "surfaces": {{"ball": {{{surface}}}}},
  "contacts": {{"press": {{"slave": "sheet.top", "master": "ball"{contact}}}}},
  "supports": {{"held": {{"on": {support}, "fixed": true}}}}
}}"#
    )
}

const PLATE: &str = r#"{"plate": {"size": [4, 2], "thickness": 1, "elements": [4, 2]}}"#;
const BALL: &str = r#""sphere": {"radius": 5, "center": [0, 0, 5.6]}"#;
const EDGE: &str = r#""sheet.x_min""#;

#[test]
fn short_forms_mean_the_long_ones() {
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/assets");
    let long_friction = r#", "friction": {"coulomb": {"mu": 0.2}}"#;
    let table = r#"{"table": [[0, 0], [1, 0.2]]}"#;
    let pairs = [
        (
            sheet(PLATE, BALL, r#", "friction": 0.2"#, EDGE),
            sheet(PLATE, BALL, long_friction, EDGE),
        ),
        (
            sheet(PLATE, BALL, r#", "friction": {"coulomb": 0.2}"#, EDGE),
            sheet(PLATE, BALL, long_friction, EDGE),
        ),
        (
            sheet(PLATE, BALL, r#", "friction": "0.1*t""#, EDGE),
            sheet(
                PLATE,
                BALL,
                r#", "friction": {"coulomb": {"mu": "0.1*t"}}"#,
                EDGE,
            ),
        ),
        (
            sheet(
                PLATE,
                BALL,
                r#", "initial_overclosure": {"shrink": 1}"#,
                EDGE,
            ),
            sheet(
                PLATE,
                BALL,
                r#", "initial_overclosure": {"shrink": {"until": 1}}"#,
                EDGE,
            ),
        ),
        (
            sheet(PLATE, &format!(r#""cad": "{assets}/sphere.igs""#), "", EDGE),
            sheet(
                PLATE,
                &format!(r#""cad": {{"file": "{assets}/sphere.igs"}}"#),
                "",
                EDGE,
            ),
        ),
        (
            sheet(&format!(r#""{assets}/mesh/plate.msh""#), BALL, "", EDGE),
            sheet(
                &format!(r#"{{"file": {{"path": "{assets}/mesh/plate.msh"}}}}"#),
                BALL,
                "",
                EDGE,
            ),
        ),
        (
            sheet(
                &format!(r#"{{"file": "{assets}/mesh/plate.msh"}}"#),
                BALL,
                "",
                EDGE,
            ),
            sheet(
                &format!(r#"{{"file": {{"path": "{assets}/mesh/plate.msh"}}}}"#),
                BALL,
                "",
                EDGE,
            ),
        ),
        (
            sheet(
                r#"{"plate": {"size": [4, 2], "thickness": 1, "elements": [4, 2], "center": [2, 1, 0]}}"#,
                BALL,
                "",
                EDGE,
            ),
            sheet(
                r#"{"plate": {"size": [4, 2], "thickness": 1, "elements": [4, 2], "origin": [0, 0, 0]}}"#,
                BALL,
                "",
                EDGE,
            ),
        ),
        (
            sheet(
                r#"{"block": {"size": [4, 2, 1], "center": [2, 0, -1], "elements": [4, 2, 1]}}"#,
                BALL,
                "",
                EDGE,
            ),
            sheet(
                r#"{"block": {"min": [0, -1, -1.5], "max": [4, 1, -0.5], "elements": [4, 2, 1]}}"#,
                BALL,
                "",
                EDGE,
            ),
        ),
        (
            sheet(
                r#"{"block": {"size": [4, 2, 1], "origin": [1, 0, -1], "elements": [4, 2, 1]}}"#,
                BALL,
                "",
                EDGE,
            ),
            sheet(
                r#"{"block": {"min": [1, 0, -1], "max": [5, 2, 0], "elements": [4, 2, 1]}}"#,
                BALL,
                "",
                EDGE,
            ),
        ),
        (
            sheet(
                PLATE,
                r#""sphere": {"radius": 5, "origin": [0, 0, 5.6]}"#,
                "",
                EDGE,
            ),
            sheet(PLATE, BALL, "", EDGE),
        ),
    ];
    for (short, long) in pairs {
        assert_eq!(loaded(&short).scene, loaded(&long).scene, "{short}");
    }
    // What is no short form stays what it is.
    let scene = loaded(&sheet(
        PLATE,
        BALL,
        &format!(r#", "friction": {{"coulomb": {{"mu": {table}}}}}"#),
        EDGE,
    ));
    assert!(scene.scene.contacts["press"].friction.is_some());
}

#[test]
fn a_short_form_that_is_wrong_is_told_in_its_place() {
    for (mesh, contact, part) in [
        (
            PLATE,
            r#", "friction": "colomb""#,
            "did you mean `coulomb`?",
        ),
        (PLATE, r#", "friction": "0.2*x""#, "unknown variable `x`"),
        (
            PLATE,
            r#", "friction": -0.2"#,
            "the coefficient of friction is -0.2",
        ),
        (PLATE, r#", "friction": true"#, "expected one of"),
        (r#""no.msh""#, "", "there is no file `./no.msh`"),
        (
            r#"{"block": {"size": [1, 1, 1], "max": [1, 1, 1], "elements": [1, 1, 1]}}"#,
            "",
            "a box is given by `min` and `max`, or by `size` with one of `origin`",
        ),
        (
            r#"{"plate": {"size": [4, 2], "thickness": 1, "elements": [4, 2], "center": [0, 0, 0], "origin": [0, 0, 0]}}"#,
            "",
            "`origin` and `center` are both given",
        ),
    ] {
        let text = sheet(mesh, BALL, contact, EDGE);
        let problems = problems(&text);
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert!(problems[0].contains(part), "{problems:?}");
        assert!(!problems[0].starts_with("1:1"), "{problems:?}");
    }
}

#[test]
fn comments_and_trailing_commas_are_read() {
    let text = sheet(PLATE, BALL, "", EDGE);
    let commented = text
        .replace(
            "{\n  \"covact\"",
            "// head\n{ /* before\n the first */\n  \"covact\"",
        )
        .replace("[4, 2]}}", "[4, 2,],},}")
        .replace("true}}", "true},},// no more\n");
    assert_ne!(text, commented);
    assert_eq!(loaded(&text).scene, loaded(&commented).scene);
    // Places count comments.
    let wrong = commented.replace("\"radius\": 5", "\"radius\": -5");
    assert_eq!(problems(&wrong).len(), 1);
    assert!(
        problems(&wrong)[0].starts_with("7:46: the radius is -5"),
        "{:?}",
        problems(&wrong)
    );
    assert!(problems("{ /* open")[0].contains("1:3: a comment that does not end"));
}

#[test]
fn sets_in_a_list_count_as_one() {
    let both = loaded(&sheet(PLATE, BALL, "", r#"["sheet.x_min", "sheet.x_max"]"#));
    let model = build(&both).unwrap();
    let one = build(&loaded(&sheet(PLATE, BALL, "", EDGE))).unwrap();
    assert_eq!(model.prescribed.len(), 2 * one.prescribed.len());
    // A corner belongs to two of them, and is held once.
    let corner = build(&loaded(&sheet(
        PLATE,
        BALL,
        "",
        r#"["sheet.x_min", "sheet.y_min"]"#,
    )))
    .unwrap();
    assert_eq!(corner.prescribed.len(), 3 * (6 + 10 - 2));
    assert!(problems(&sheet(PLATE, BALL, "", "[]"))[0].contains("the list of sets is empty"));
    let wrong = problems(&sheet(PLATE, BALL, "", r#"["sheet.x_min", "sheet.x_mx"]"#));
    assert!(
        wrong[0].contains("no set `x_mx` (did you mean `x_max`?"),
        "{wrong:?}"
    );
}

/// Faces of both sides of the only contact, and slave points.
fn sides(slave: &str) -> (usize, usize) {
    let text = sheet(PLATE, BALL, "", EDGE).replace("\"sheet.top\"", slave);
    let model = build(&loaded(&text)).unwrap();
    (model.pairs[0].faces.len(), model.pairs[0].points.len())
}

#[test]
fn a_side_of_a_contact_is_a_set_several_or_a_body() {
    assert_eq!(sides(r#""sheet.top""#), (8, 15));
    // Each face once, and each node.
    assert_eq!(sides(r#"["sheet.top", "sheet.x_max"]"#), (10, 18));
    assert_eq!(
        sides(r#"["sheet.top", "sheet.x_max", "sheet.top"]"#),
        (10, 18)
    );
    assert_eq!(sides(r#""sheet""#), (8 + 8 + 2 * 4 + 2 * 2, 30));
}

#[test]
fn a_placement_turns_about_its_centre() {
    let placed = |placement: &str| {
        let surface = format!("{BALL}, \"placement\": {placement}");
        let model = build(&loaded(&sheet(PLATE, &surface, "", EDGE))).unwrap();
        let pose = model.surfaces[0].motion.pose(0.0).unwrap();
        pose.transform_vector(&Vec3::x()) + 100.0 * pose.translation.vector
    };
    // A quarter of a turn about z at (1, 0): the origin goes to (1, -1).
    let about = placed(
        r#"{"rotation": {"axis": [0, 0, 2], "angle": 90, "center": [1, 0, 7]}, "translation": [0, 0, 0.1]}"#,
    );
    let other = placed(r#"{"axis": [0, 0, 1], "angle": 90, "translation": [1, -1, 0.1]}"#);
    assert!((about - other).norm() < 1e-12, "{about} {other}");
    assert!(
        (about - Vec3::new(100.0, -99.0, 10.0)).norm() < 1e-12,
        "{about}"
    );
}

/// A total force on a list of faces is spread over the area of all of them, each counted once.
#[test]
fn a_force_on_a_list_is_spread_over_all_of_it() {
    use covact::model::loads::DeadLoad;
    let with = |on: &str| {
        let load = format!(r#", "loads": {{"f": {{"on": {on}, "force": [0, 0, -6]}}}}"#);
        let text = sheet(PLATE, BALL, "", EDGE);
        let end = text.rfind('}').unwrap();
        let model = build(&loaded(&format!("{}{load}}}", &text[..end]))).unwrap();
        let [(_, DeadLoad::Force { shares, .. })] = model.dead_loads.as_slice() else {
            panic!("one force");
        };
        let mut shares = shares.clone();
        shares.sort_by_key(|s| s.0);
        shares
    };
    let sum = |shares: &[(u32, f64)]| shares.iter().map(|s| s.1).sum::<f64>();
    let list = with(r#"["sheet.top", "sheet.bottom", "sheet.top"]"#);
    assert!((sum(&list) - 1.0).abs() < 1e-12);
    assert_eq!(list.len(), 2 * with(r#""sheet.top""#).len());
}

/// The signed distance of a far point from the surface once its side is decided.
fn distance(surface: &str) -> f64 {
    let model = build(&loaded(&sheet(PLATE, surface, "", EDGE))).unwrap();
    let far = Vec3::new(0.0, 0.0, 1e4);
    let foot = model.surfaces[0].set.project(&far, None, f64::INFINITY);
    foot.unwrap().signed_distance
}

/// A tool of either shape above the sheet, and one that is large enough to have the sheet in it.
#[test]
fn outward_is_away_from_what_is_enclosed() {
    let cad = concat!(
        r#""cad": ""#,
        env!("CARGO_MANIFEST_DIR"),
        r#"/assets/sphere.igs""#
    );
    for (pin, bore) in [
        (BALL, r#""sphere": {"radius": 50}"#),
        (
            r#""cylinder": {"radius": 3, "length": 20, "center": [0, 0, 4]}"#,
            r#""cylinder": {"radius": 50, "length": 200}"#,
        ),
        (
            &format!(r#"{cad}, "placement": {{"translation": [0, 0, 100]}}"#),
            &format!(r#"{cad}, "placement": {{"scale": 100}}"#),
        ),
    ] {
        let outside = distance(&format!(r#"{pin}, "side": "outward""#));
        assert!(outside > 0.0, "{pin}: {outside}");
        let outside = distance(&format!(r#"{bore}, "side": "inward""#));
        assert!(outside < 0.0, "{bore}: {outside}");
    }
    // Nothing is enclosed by a plane.
    let plane = r#""plane": {"size": [10, 10], "center": [0, 0, 1]}, "side": "outward""#;
    let error = build(&loaded(&sheet(PLATE, plane, "", EDGE))).unwrap_err();
    assert_eq!(error.pointer, "/surfaces/ball/side");
    assert!(error.to_string().contains("no outward side"), "{error}");
}

#[test]
fn materials_by_name_are_taken_in_the_units_of_the_scene() {
    use covact::scene::Material;
    let with = |material: &str, units: &str| {
        sheet(PLATE, BALL, "", EDGE)
            .replace(r#"{"neo_hooke": {"E": 10, "nu": 0.3}}"#, material)
            .replace("\"covact\": 1,", &format!("\"covact\": 1, {units}"))
    };
    let law = |material: &str, units: &str| {
        build(&loaded(&with(material, units))).unwrap().bodies[0].material
    };
    let close = |law: Material, e: f64| {
        let found = law.elastic().e;
        assert!((found / e - 1.0).abs() < 1e-3, "{found} for {e}");
    };
    let newton = r#""units": {"length": "mm", "force": "N"},"#;
    close(law(r#""steel""#, newton), 210e3);
    close(
        law(r#""steel""#, r#""units": {"length": "m", "force": "kN"},"#),
        210e6,
    );
    close(law(r#""rubber_50""#, newton), 2.4553);
    assert!(matches!(
        law(r#""rubber_50""#, newton),
        Material::NeoHooke(_)
    ));
    for units in [
        "",
        r#""units": {"length": "mm"},"#,
        r#""units": {"force": "N"},"#,
    ] {
        let said = problems(&with(r#""steel""#, units));
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(
            said[0]
                .contains("the constants of `steel` are not known in the scene's units (say them"),
            "{said:?}"
        );
    }
    let said = problems(&with(r#""stel""#, newton));
    assert!(
        said[0].contains("unknown name `stel` (did you mean `steel`?"),
        "{said:?}"
    );
}

/// The note where an elastic metal is stressed beyond its strength, and none where the law is written out.
#[test]
fn a_metal_beyond_its_yield_strength_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let run = |material: &str| {
        let text = format!(
            r#"{{
  "covact": 1,
  "units": {{"length": "mm", "force": "N"}},
  "materials": {{"m": {material}}},
  "bodies": {{"bar": {{"mesh": {{"block": {{"size": [2, 1, 1], "elements": [2, 1, 1]}}}}, "material": "m"}}}},
  "supports": {{
    "left": {{"on": "bar.x_min", "fixed": true}},
    "right": {{"on": "bar.x_max", "displacement": {{"x": "0.01*t"}}}}
  }},
  "solution": {{"step": {{"initial": 0.5, "max": 0.5}}}},
  "output": {{"every": 0}}
}}"#
        );
        said_by_run(folder.path(), &text)
    };
    // 0.5 % of strain, 1000 MPa.
    let said = run(r#""steel""#);
    assert_parts(
        &said,
        &[
            "note: body `bar`: its von Mises stress of ",
            " at step 2 passes the yield strength 235 of `steel`",
        ],
    );
    assert!(!run(r#""rubber_40""#).contains("yield"));
    assert!(!run(r#"{"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}"#).contains("yield"));
}

/// What a run of a scene says, which ends.
fn said_by_run(folder: &Path, scene: &str) -> String {
    std::fs::write(folder.join("scene.json"), scene).unwrap();
    let run = covact(folder, &["run", "scene.json", "-o", "out", "--force"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    stderr(&run)
}

/// The note where strains leave the range of a law: of 30 % the one for small strains, of a stretch of 2.2 the one that is linear in
/// logarithmic strains.
#[test]
fn strains_beyond_the_range_of_a_law_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let run = |law: &str, pull: f64| {
        let text = format!(
            r#"{{
  "covact": 1,
  "materials": {{"m": {{"{law}": {{"E": 1, "nu": 0}}}}}},
  "bodies": {{"bar": {{"mesh": {{"block": {{"size": [1, 1, 1], "elements": [1, 1, 1]}}}}, "material": "m"}}}},
  "supports": {{
    "left": {{"on": "bar.x_min", "fixed": true}},
    "right": {{"on": "bar.x_max", "displacement": ["{pull}*t", 0, 0]}}
  }},
  "output": {{"every": 0}}
}}"#
        );
        said_by_run(folder.path(), &text)
    };
    let told = "principal logarithmic strain is ";
    let said = run("st_venant_kirchhoff", 0.3);
    assert_parts(
        &said,
        &[
            "note: body `bar`: a principal logarithmic strain is 0.262364 at the end",
            "`neo_hooke` or `hencky`",
        ],
    );
    assert!(!run("st_venant_kirchhoff", 0.1).contains(told));
    assert!(!run("hencky", 0.3).contains(told));
    assert_parts(
        &run("hencky", 1.2),
        &[
            "a principal logarithmic strain is 0.788457 at the end",
            "up to 0.693147",
        ],
    );
    assert!(!run("neo_hooke", 1.2).contains(told));
}
