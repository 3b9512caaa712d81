//! Curves of a scene's probes and of its tools, in the history and the summary.
use crate::support::{covact, stderr, stdout};
use covact::output::{Summary, Table, read_csv};
use covact::scene;
use std::path::Path;

/// A bar that is pulled, and a ball beside it that comes down and turns.
fn bar(probes: &str) -> String {
    format!(
        r#"{{
  "covact": 1,
  "materials": {{"m": {{"st_venant_kirchhoff": {{"E": 1000, "nu": 0}}}}}},
  "bodies": {{"bar": {{"mesh": {{"block": {{"size": [4, 1, 1], "elements": [4, 1, 1]}}}}, "material": "m"}}}},
  "surfaces": {{
    "ball": {{
      "sphere": {{"radius": 1, "center": [2, 0.5, 3]}},
      "motion": {{
        "translation": [0, 0, "-0.5*t"],
        "rotation": {{"center": [2, 0.5, 3], "axis": [0, 0, 1], "angle": "720*t"}}
      }}
    }},
    "floor": {{"plane": {{"size": [9, 9], "center": [2, 0.5, -1]}}}}
  }},
  "contacts": {{
    "one": {{"slave": "bar.top", "master": "ball"}}, "two": {{"slave": "bar.bottom", "master": "floor"}}
  }},
  "supports": {{
    "left": {{"on": "bar.x_min", "fixed": true}},
    "right": {{"on": "bar.x_max", "displacement": {{"x": "0.04*t", "y": 0, "z": 0}}}}
  }},
  {probes}
  "solution": {{"step": {{"initial": 0.5, "max": 0.5}}}},
  "output": {{"every": 0}}
}}"#
    )
}

fn run(folder: &Path, text: &str) -> (Table, Summary) {
    std::fs::write(folder.join("scene.json"), text).unwrap();
    let run = covact(
        folder,
        &["run", "scene.json", "-o", "out", "--force", "--quiet"],
    );
    // Nothing touches anything.
    assert_eq!(
        run.status.code(),
        Some(4),
        "{}{}",
        stderr(&run),
        stdout(&run)
    );
    let table = read_csv(&folder.join("out/history.csv")).unwrap();
    (
        table,
        Summary::read(&folder.join("out/summary.json")).unwrap(),
    )
}

#[test]
fn probes_are_columns_of_the_history() {
    let folder = tempfile::tempdir().unwrap();
    let probes = r#""probes": {
    "end": {"on": ["bar.x_max"]},
    "middle": {"near": [2.1, 0.1, 0.2]},
    "most": {"body": "bar", "take": "max"},
    "all": {"body": "bar", "take": "sum"},
    "pull": {"on": "bar.x_max", "quantity": "reaction"},
    "free": {"near": [2, 0, 0], "body": "bar", "quantity": "reaction"},
    "stress": {"body": "bar", "quantity": "von_mises", "take": "mean"}
  },"#;
    let (table, summary) = run(folder.path(), &bar(probes));
    let last = |name: &str| {
        *table
            .column(name)
            .unwrap_or_else(|| panic!("{name}"))
            .last()
            .unwrap()
    };
    let close = |name: &str, value: f64| {
        let found = last(name);
        assert!(
            (found - value).abs() < 1e-6 * value.abs().max(1e-3),
            "{name}: {found} for {value}"
        );
    };
    close("probe.end.x", 0.04);
    close("probe.end.y", 0.0);
    close("probe.middle.x", 0.02);
    close("probe.most", 0.04);
    // Five columns of four nodes from 0 to 0.04.
    close("probe.all.x", 4.0 * 0.1);
    // Stretched by 1 %: the second Piola-Kirchhoff stress E (l^2 - 1) / 2 times the stretch.
    let (l, e) = (1.01f64, 1000.0);
    let force = e * (l * l - 1.0) / 2.0 * l;
    close("probe.pull.x", force);
    close("force.right.x", force);
    close("probe.free.x", 0.0);
    // True stress, on a section that stays as it was.
    close("probe.stress", force);
    assert!(table.column("probe.stress.x").is_none());
    let pull = summary.probes["probe.pull.x"];
    assert!((pull.last - force).abs() < 1e-6 * force && pull.min < pull.max);
    assert_eq!(pull.max, pull.last);
    assert_eq!(summary.probes.len(), 3 + 3 + 1 + 3 + 3 + 3 + 1);
}

#[test]
fn tools_that_move_have_their_way() {
    let folder = tempfile::tempdir().unwrap();
    let (table, summary) = run(folder.path(), &bar(""));
    assert_eq!(table.column("way.ball.z").unwrap(), [-0.25, -0.5]);
    assert_eq!(table.column("way.ball.x").unwrap(), [0.0, 0.0]);
    assert_eq!(table.column("way.ball.angle").unwrap(), [360.0, 720.0]);
    // What rests has none, and without probes nothing is written of them.
    assert!(
        table
            .columns
            .iter()
            .all(|c| !c.starts_with("way.floor") && !c.starts_with("probe"))
    );
    assert!(summary.probes.is_empty());
}

#[test]
fn probes_that_name_nothing_are_refused() {
    let said = |probes: &str| {
        let text = bar(&format!(r#""probes": {{{probes}}},"#));
        let loaded = scene::parse(&text, "scene.json").unwrap_or_else(|e| panic!("{e}"));
        scene::check(&loaded)
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join("\n")
    };
    for (probe, part) in [
        (
            r#""p": {}"#,
            "the probe does not say what it is (exactly one of `on`, `near`, `body`)",
        ),
        (
            r#""p": {"on": "bar.x_min", "near": [0, 0, 0]}"#,
            "the probe has `on` and `near` at once",
        ),
        (
            r#""p": {"on": "bar.x_mn"}"#,
            "no set `x_mn` (did you mean `x_min`?",
        ),
        (
            r#""p": {"body": "bars"}"#,
            "there is no body `bars` (did you mean `bar`?",
        ),
        (r#""p.q": {"body": "bar"}"#, "holds the character '.'"),
    ] {
        let said = said(probe);
        assert!(said.contains(part), "{part} in {said}");
    }
}
