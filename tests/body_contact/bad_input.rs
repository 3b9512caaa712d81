//! Pairs that cannot be meant are refused, with the reason and what to do.
use crate::blocks::patch;
use covact::{model, scene};
use serde_json::{Value, json};

/// The refusal of a scene: pointer, message and help.
fn refusal(scene: &Value) -> (String, String, String) {
    let text = serde_json::to_string(scene).expect("serialisable");
    let loaded = scene::parse(&text, "scene.json").expect("well formed");
    let error = model::build::build(&loaded).expect_err("a scene that cannot be meant");
    let message = error.to_string();
    (error.pointer, message, error.help.unwrap_or_default())
}

fn pair(slave: &str, master: &str) -> Value {
    let mut scene = patch(2, 2, json!("nodes"));
    scene["contacts"]["press"]["slave"] = json!(slave);
    scene["contacts"]["press"]["master"] = json!(master);
    scene
}

#[test]
fn faces_on_the_wrong_side_are_named() {
    let (at, message, help) = refusal(&pair("upper.bottom", "lower.bottom"));
    assert_eq!(at, "/contacts/press/master", "{message}");
    assert!(message.contains("look the same way") && message.contains("`lower.bottom` lies"));
    assert!(help.contains("the other side of that body"), "{help}");
    let (at, message, _) = refusal(&pair("upper.top", "lower.top"));
    assert_eq!(at, "/contacts/press/slave", "{message}");
    assert!(message.contains("`upper.top` lies"), "{message}");
}

#[test]
fn sets_that_share_some_faces_are_refused() {
    let mut scene = pair("lower.left", "lower.top");
    scene["bodies"]["lower"]["sets"] = json!({
        "left": {"faces_in_box": {"min": [-0.1, -0.1, -0.1], "max": [0.6, 1.1, 0.1]}}
    });
    let (at, message, help) = refusal(&scene);
    assert_eq!(at, "/contacts/press/master");
    assert!(
        message.contains("have 2 face(s) in common, 2 and 4 in all"),
        "{message}"
    );
    assert!(
        help.contains("the same set as slave and as master"),
        "{help}"
    );
}

#[test]
fn bodies_that_start_inside_each_other_are_refused() {
    let mut scene = pair("upper.bottom", "lower.top");
    scene["bodies"]["upper"]["placement"] = json!({"translation": [0, 0, -0.3]});
    let (at, message, _) = refusal(&scene);
    assert_eq!(at, "/contacts/press/master");
    assert!(
        message.contains("faces `lower.top` start 0.3 deep inside body `upper`"),
        "{message}"
    );
}

#[test]
fn what_belongs_to_the_other_kind_of_master_is_refused() {
    let problems = |scene: &Value| -> Vec<String> {
        let text = serde_json::to_string(scene).expect("serialisable");
        let loaded = scene::parse(&text, "scene.json").expect("well formed");
        scene::check(&loaded)
            .iter()
            .map(|p| p.to_string())
            .collect()
    };
    let good = pair("upper.bottom", "lower.top");
    assert_eq!(problems(&good), Vec::<String>::new());
    let mut rigid = good.clone();
    rigid["surfaces"] = json!({"floor": {"plane": {"size": [2, 2]}}});
    rigid["contacts"]["press"]["master"] = json!("floor");
    assert_eq!(problems(&rigid), Vec::<String>::new());
    rigid["contacts"]["press"]["master_surface"] = json!("smooth");
    rigid["contacts"]["press"]["depth"] = json!(0.1);
    let found = problems(&rigid);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(
        found
            .iter()
            .all(|p| p.contains("the master `floor` is a rigid surface"))
    );
    let mut unknown = good.clone();
    unknown["contacts"]["press"]["master"] = json!("lower.tpo");
    assert!(problems(&unknown)[0].contains("the body `lower` has no set `tpo`"));
    // All outer faces of a body; a name that nothing has is refused.
    unknown["contacts"]["press"]["master"] = json!("lower");
    assert_eq!(problems(&unknown), Vec::<String>::new());
    unknown["contacts"]["press"]["master"] = json!("lowr");
    let found = problems(&unknown);
    assert!(found[0].contains("there is no surface `lowr`") && found[0].contains("`body.set`"));
}
