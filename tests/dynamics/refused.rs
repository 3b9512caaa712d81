//! What does not go with inertia, and what is wrong with its numbers, is told where the scene says it.
use covact::scene::{check, parse};

const SCENE: &str = r#"{
  "covact": 1,
  "materials": {"m": {"st_venant_kirchhoff": {"E": 100, "nu": 0.3, "density": 1}}},
  "bodies": {
    "a": {"mesh": {"plate": {"size": [10, 10], "thickness": 1, "elements": [4, 4]}}, "material": "m",
          "velocity": [0, 0, 1], "spin": {"rate": [0, 1, 0]}}
  },
  "surfaces": {"ball": {"sphere": {"radius": 5, "center": [5, 5, 6]}}},
  "contacts": {"c": {"slave": "a.top", "master": "ball"}},
  "solution": {"dynamics": {}}
}
"#;

fn problems(text: &str) -> Vec<String> {
    let loaded = match parse(text, "scene.json") {
        Ok(loaded) => loaded,
        Err(e) => return vec![e.to_string()],
    };
    check(&loaded).iter().map(|p| p.to_string()).collect()
}

#[test]
fn by_key_with_place() {
    assert_eq!(problems(SCENE), Vec::<String>::new());
    for (from, to, place, what) in [
        (
            r#""dynamics": {}"#,
            r#""dynamics": {}, "kinematics": "small""#,
            "10:",
            "`dynamics` does not go with small displacements",
        ),
        (
            r#""dynamics": {}"#,
            r#""dynamics": {}, "stabilization": {"viscous": {}}"#,
            "10:",
            "`dynamics` does not go with viscous stabilisation",
        ),
        (
            r#""master": "ball""#,
            r#""master": "ball", "augmentation": {}"#,
            "9:",
            "`dynamics` does not go with augmentation",
        ),
        (
            r#""master": "ball""#,
            r#""master": "ball", "accuracy": 1e-3"#,
            "9:",
            "a penalty that is ruled by its accuracy",
        ),
        (
            r#""center": [5, 5, 6]}"#,
            r#""center": [5, 5, 6]}, "motion": {"free": {"force": {"z": -1}}}"#,
            "8:",
            "a surface driven by force",
        ),
        (
            r#", "density": 1"#,
            "",
            "5:",
            "the material `m` of body `a` has no density, which `dynamics` needs",
        ),
        (
            r#""dynamics": {}"#,
            r#""dynamics": {"rho_inf": 1.5}"#,
            "10:",
            "`rho_inf` is 1.5",
        ),
        (
            r#""dynamics": {}"#,
            r#""dynamics": {"damping": {"mass": -1}}"#,
            "10:",
            "the damping is -1",
        ),
        (
            r#""dynamics": {}"#,
            r#""dynamics": {"damping": {"viscosity": -1e-3}}"#,
            "10:",
            "the viscosity is -0.001",
        ),
        (
            r#""dynamics": {}"#,
            r#""dynamics": {"damping": {"stiffness": 1}}"#,
            "10:",
            "`mass`",
        ),
        (
            r#""dynamics": {}"#,
            r#""dynamics": {"tolerance": 1}"#,
            "10:",
            "the tolerance is 1",
        ),
        (
            r#""dynamics": {}"#,
            r#""end_time": 1"#,
            "6:",
            "a `velocity` needs inertia",
        ),
        (
            r#""dynamics": {}"#,
            r#""dynamics": {}, "end_time": 1e-3, "step": {"initial": 1}, "newton": {"max_iterations": 0}"#,
            "10:",
            "`max_iterations` is 0",
        ),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let found = problems(&SCENE.replacen(from, to, 1));
        let told = found.iter().find(|p| p.contains(what));
        let told = told.unwrap_or_else(|| panic!("{what}: {found:?}"));
        assert!(told.contains(place), "{told}");
    }
}

/// A support that is elsewhere than the body at time 0 would need an infinite force.
#[test]
fn supports_start_where_the_body_is() {
    let text = SCENE.replacen(
        r#""solution""#,
        r#""supports": {"s": {"on": "a.x_min", "displacement": {"z": "0.1 + t"}}}, "solution""#,
        1,
    );
    let loaded = parse(&text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
    let error = covact::model::build::build(&loaded)
        .expect_err("refused")
        .to_string();
    assert!(error.contains("no inertia follows a jump"), "{error}");
}
