//! All that is wrong is told in one round.
use crate::support::{assert_parts, covact, problems, stderr};
use std::path::Path;

const PLATE: &str = r#"{"plate": {"size": [4, 2], "thickness": 1, "elements": [4, 2]}}"#;

/// Independent mistakes of the text, the form and the meaning come in one round, each once, and none that follows from
/// another.
#[test]
fn one_round_tells_of_everything() {
    let said = problems(
        r#"{
  "covact": 1,
  "units": {"length": "mm", "force": "N"},
  "material": {"st": "stel", "al": "aluminium"},
  "bodies": {
    "sheet": {"mesh": {"plate": {"size": [10, "10"], "thicknes": 1, "elements": [4, 4]}}, "material": "st"},
    "block": {"mesh": {"block": {"size": [1,1,1], "min": [0,0,0], "elements": [1,1,1]}}, "material": "all"},
    "panel": {"mesh": {"plate": {"size": [1, -1], "elements": [1, 1]}}, "material": "al"},
    "whole": {"mesh": {"plate": {"size": [1, 1], "thickness": 1, "elements": [1, 1]}}, "material": "al"}
  },
  "surfaces": {"ball": {"sphere": {"radius": -5}, "side": "outwards"}, "floor": {"plane": {"size": [1, 1]}}},
  "contacts": {
    "one": {"slave": "whole.topp", "master": "boll", "friction": "mu"},
    "two": {"slave": "whole.top", "master": "floor", "friction": 0.1, "penalty": {"value": 0}}
  },
  "supports": {"s": {"on": ["whole.x_min" "whole.x_mx"], "fixed": true}, "r": {"on": "block.what", "fixed": yes}}
}"#,
    );
    let expected = [
        "4:3: unknown key `material`",
        "4:22: unknown name `stel`",
        "6:47: expected a number",
        "6:54: unknown key `thicknes`",
        "7:33: a box is given by",
        "7:102: there is no material `all`",
        "8:33: the key `thickness` is missing",
        "8:46: a length of the plate is -1",
        "11:46: the radius is -5",
        "11:59: unknown name `outwards`",
        "13:22: the body `whole` has no set `topp`",
        "13:67: unknown variable `mu`",
        "14:92: the penalty is 0",
        "16:43: expected `,` or `]`",
        "16:43: the body `whole` has no set `x_mx`",
        "16:109: expected a value, found `yes`",
    ];
    for part in expected {
        assert_eq!(
            said.iter().filter(|s| s.starts_with(part)).count(),
            1,
            "{part} in {said:#?}"
        );
    }
    // `boll` may be `ball`, which is wrong itself; the name is told as long as it is like none that is whole.
    let others: Vec<_> = said
        .iter()
        .filter(|s| !expected.iter().any(|e| s.starts_with(e)))
        .collect();
    assert!(
        others
            .iter()
            .all(|s| s.contains("there is no surface `boll`")),
        "{others:?}"
    );
}

/// What stands against meshes, CAD files and sets of files is told together, too.
#[test]
fn one_round_tells_of_all_files() {
    let folder = tempfile::tempdir().unwrap();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    std::fs::write(folder.path().join("broken.msh"), "$MeshFormat\n").unwrap();
    std::fs::write(folder.path().join("broken.igs"), "nothing").unwrap();
    let scene = |mesh: &str| {
        format!(
            r#"{{
  "covact": 1,
  "materials": {{"m": {{"neo_hooke": {{"E": 1, "nu": 0}}}}}},
  "bodies": {{
    "plate": {{"mesh": "{}", "material": "m"}},
    "other": {{"mesh": {mesh}, "material": "m"}}
  }},
  "surfaces": {{"tool": {{"cad": "broken.igs"}}, "second": {{"cad": "broken.msh"}}}},
  "contacts": {{"c": {{"slave": "plate.no_such_set", "master": "tool"}}}},
  "supports": {{"s": {{"on": ["plate.nobody", "plate.nothing"], "fixed": true}}}}
}}"#,
            assets.join("mesh/plate.msh").display()
        )
    };
    let said = |text: &str| {
        std::fs::write(folder.path().join("scene.json"), text).unwrap();
        let check = covact(folder.path(), &["check", "scene.json"]);
        assert_eq!(check.status.code(), Some(3));
        stderr(&check)
    };
    let first = said(&scene(r#""broken.msh""#));
    assert_parts(
        &first,
        &[
            "scene.json:6:23:",
            "scene.json:8:32:",
            "scene.json:8:65:",
            "3 problems",
        ],
    );
    let sets = said(&scene(PLATE));
    assert_parts(
        &sets,
        &[
            "scene.json:8:",
            "scene.json:8:",
            "no_such_set",
            "nobody",
            "nothing",
            "5 problems",
        ],
    );
}

/// A first scene of one's own, as somebody new wrote it, with the mistakes that took five rounds: one round of messages, and
/// the scene with what they say is right.
#[test]
fn a_first_scene_takes_two_rounds() {
    let folder = tempfile::tempdir().unwrap();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    for (from, to) in [("mesh/hat.msh", "hat.msh"), ("sphere.igs", "ball.igs")] {
        std::fs::copy(assets.join(from), folder.path().join(to)).unwrap();
    }
    let first = r#"{
  // a hat profile under a ball
  "covact": 1,
  "units": { "length": "mm", "force": "N" },
  "materials": { "sheet": "aluminum" },
  "bodies": {
    "hat": { "mesh": { "file": { "path": "hat.msh", "thicknes": 2 } }, "material": "sheets" },
  },
  "surfaces": {
    "ball": {
      "cad": "ball.iges",
      "placement": { "scale": 4, "translate": [0, -8, 33.25] },
      "side": "outside",
      "motion": { "translation": [0, 0, "-0.2*time"] }
    }
  },
  "contacts": { "press": { "slave": "hat.crown_top", "master": "ball", "friction": 0.1 } },
  "supports": { "table": { "on": ["hat.feet_bottom"], "fix": true } },
  "solution": { "step": { "initial": 0.5, "maximum": 0.5 } }
}"#;
    let check = |text: &str| {
        std::fs::write(folder.path().join("own.json"), text).unwrap();
        let check = covact(folder.path(), &["check", "own.json"]);
        (check.status.code(), stderr(&check))
    };
    let (code, said) = check(first);
    assert_eq!(code, Some(3));
    // Every mistake is told at once.
    let mistakes = [
        ("aluminum", "aluminium"),
        ("thicknes\"", "thickness\""),
        ("\"sheets\"", "\"sheet\""),
        ("ball.iges", "ball.igs"),
        ("translate\"", "translation\""),
        ("outside", "outward"),
        ("*time", "*t"),
        ("\"fix\"", "\"fixed\""),
        ("maximum", "max"),
    ];
    let mut second = first.to_owned();
    for (wrong, right) in mistakes {
        assert!(
            said.contains(wrong.trim_matches(['"', '*'])),
            "{wrong} in {said}"
        );
        second = second.replacen(wrong, right, 1);
    }
    assert!(said.contains("9 problems"), "{said}");
    let (code, said) = check(&second);
    assert_eq!(code, Some(0), "{said}");
}
