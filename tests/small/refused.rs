//! What does not go with small displacements is refused where the scene says it.
use covact::scene::{check, parse};

const SCENE: &str = r#"{
  "covact": 1,
  "materials": {"m": {"st_venant_kirchhoff": {"E": 100, "nu": 0.3}}},
  "bodies": {
    "a": {"mesh": {"plate": {"size": [10, 10], "thickness": 1, "elements": [4, 4]}}, "material": "m"},
    "b": {"mesh": {"plate": {"size": [10, 10], "thickness": 1, "elements": [4, 4]}}, "material": "m"}
  },
  "surfaces": {
    "ball": {"sphere": {"radius": 5, "center": [5, 5, 6]}, "motion": {"translation": [0, 0, "-t"]}}
  },
  "contacts": {"c": {"slave": "a.top", "master": "ball"}, "d": {"slave": "b.top", "master": "a.bottom"}},
  "supports": {"edge": {"on": "a.x_min", "fixed": true}, "other": {"on": "b.x_min", "fixed": true}},
  "solution": {"kinematics": "small"}
}
"#;

fn problems(text: &str) -> Vec<String> {
    let loaded = parse(text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
    check(&loaded).iter().map(|p| p.to_string()).collect()
}

#[test]
fn by_key_with_place() {
    assert_eq!(problems(SCENE), Vec::<String>::new());
    let rigid = r#""master": "ball""#;
    let body = r#""master": "a.bottom""#;
    let solution = r#""kinematics": "small""#;
    for (from, more, place, what) in [
        (rigid, r#""augmentation": {}"#, "11:", "augmentation"),
        (
            rigid,
            r#""points": {"gauss": 3}, "gap": "averaged""#,
            "11:",
            "an averaged gap",
        ),
        (body, r#""points": {"segments": 2}"#, "11:", "segments"),
        (body, r#""passes": "two_half""#, "11:", "two half passes"),
        (
            rigid,
            r#""tangent": {"published": {}}"#,
            "11:",
            "the published tangent",
        ),
        (
            solution,
            r#""stabilization": {"viscous": {}}"#,
            "13:",
            "stabilization",
        ),
        (
            r#""translation": [0, 0, "-t"]"#,
            r#""translation": [0, 0, 0], "free": {"force": {"z": -1}}"#,
            "9:",
            "a surface driven by force",
        ),
    ] {
        let text = match more.contains("free") {
            true => SCENE.replacen(from, more, 1),
            false => SCENE.replacen(from, &format!("{from}, {more}"), 1),
        };
        let found = problems(&text);
        let message = format!("`\"kinematics\": \"small\"` does not go with {what}");
        assert!(
            found.len() == 1 && found[0].starts_with(place) && found[0].contains(&message),
            "{what}: {found:?}"
        );
        // It is nothing but the kinematics.
        let large = text.replace("\"kinematics\": \"small\"", "\"kinematics\": \"large\"");
        assert_eq!(problems(&large), Vec::<String>::new(), "{what}");
    }
    let own = SCENE.replacen("a.bottom", "b.top", 1);
    let message = "does not go with contact of a body with itself";
    assert!(
        problems(&own).iter().any(|p| p.contains(message)),
        "{:?}",
        problems(&own)
    );
}

#[test]
fn other_words() {
    let text = SCENE.replacen("\"small\"", "\"tiny\"", 1);
    let error = parse(&text, "scene.json").unwrap_err().to_string();
    assert!(error.contains("tiny") && error.contains("small"), "{error}");
}
