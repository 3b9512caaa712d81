//! What helps where the path of equilibria jumps.
use crate::model::Model;

/// What helps where the path jumps in a step that starts at `start`: only what the scene does not have already.
pub(super) fn smoother(model: &Model, start: f64) -> String {
    let mut remedies = vec!["take smaller steps"];
    if model.loaded() {
        remedies.push("drive by displacements what is driven by forces");
    }
    remedies.push(match &model.stabilization {
        None if model.small.is_some() => "make the displacements large (`solution.kinematics`)",
        None => "ask for `solution.stabilization`",
        Some(now) if now.acts(start) => "take a larger `factor` of `solution.stabilization`",
        Some(_) => "let `solution.stabilization` act for longer (`until`)",
    });
    let last = remedies.pop().unwrap_or_default();
    let text = format!("{} or {last}", remedies.join(", "));
    text[..1].to_uppercase() + &text[1..]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::build::build;
    use crate::run::watch::{Watch, Work};
    use crate::scene;
    use serde_json::{Value, json};

    /// A block that a plane goes into: slowly, then 60 times as fast.
    fn pressed(changes: &[(&str, Value)]) -> Model {
        let mut scene = json!({
            "covact": 1,
            "materials": {"m": {"st_venant_kirchhoff": {"E": 1e4, "nu": 0.3}}},
            "bodies": {"block": {
                "mesh": {"block": {"min": [0, 0, 0], "max": [1, 1, 1], "elements": [1, 1, 1]}}, "material": "m"
            }},
            "surfaces": {"plane": {
                "plane": {"center": [0.5, 0.5, 0], "size": [4, 4]},
                "motion": {"translation": [0, 0, {"table": [[0, 0], [1, 0.001], [2, 0.061]]}]}
            }},
            "contacts": {"press": {"slave": "block.bottom", "master": "plane"}},
            "supports": {"held": {"on": "block.top", "fixed": true}},
            "solution": {"end_time": 2}
        });
        for (pointer, value) in changes {
            let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
            scene.pointer_mut(parent).expect("an object")[key] = value.clone();
        }
        let loaded =
            scene::parse(&scene.to_string(), "scene.json").unwrap_or_else(|e| panic!("{e}"));
        build(&loaded).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Only what the scene does not have is asked for, and forces are named where there are any.
    #[test]
    fn remedies_are_those_that_the_scene_lacks() {
        let plain = smoother(&pressed(&[]), 0.0);
        assert!(
            plain.starts_with("Take smaller steps")
                && plain.contains("ask for `solution.stabilization`")
        );
        assert!(!plain.contains("forces"), "{plain}");
        let viscous = (
            "/solution/stabilization",
            json!({"viscous": {"until": 1.0}}),
        );
        let load = (
            "/loads",
            json!({"weight": {"on": "block.bottom", "force": [0, 0, -1]}}),
        );
        let model = pressed(&[viscous, load]);
        for (start, words) in [
            (0.0, "take a larger `factor`"),
            (1.0, "act for longer (`until`)"),
        ] {
            let text = smoother(&model, start);
            assert!(text.contains(words) && !text.contains("ask for"), "{text}");
            assert!(text.contains("driven by forces"), "{text}");
        }
    }

    /// A step from a softened penalty that moves much faster than the one before is suspect, but not where what is prescribed
    /// goes as much faster.
    #[test]
    fn speed_is_judged_by_the_pace_of_the_tables() {
        let model = pressed(&[]);
        let told = |before: [f64; 2], now: [f64; 2]| {
            let mut watch = Watch::new(&model);
            (watch.speed, watch.span) = ([52.0, 1.0], before);
            let told = watch.close(&model, (2, now), Work::default(), &[0.0], [0.0; 2], true);
            told.map(|(text, _)| text)
        };
        assert_eq!(told([0.5, 1.0], [1.0, 1.5]), None);
        let text = told([0.25, 0.5], [0.5, 1.0]).expect("a warning");
        assert!(text.contains("moved 52 times as fast"), "{text}");
        assert!(text.contains("another equilibrium"), "{text}");
        let quickened = model.quickened([0.5, 1.0], [1.0, 1.5]);
        assert!((quickened - 60.0).abs() < 1e-9, "{quickened}");
        // What begins to move explains any speed.
        assert_eq!(model.quickened([2.0, 2.5], [1.0, 1.5]), f64::INFINITY);
        assert_eq!(model.quickened([0.5, 1.0], [2.0, 2.5]), 0.0);
    }
}
