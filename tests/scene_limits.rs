//! Scenes that are long on purpose: read in time proportional to their length, with messages of bounded length.
use covact::scene::{self, SceneError};
use std::time::{Duration, Instant};

/// Problems of a scene, found within ten seconds (a fraction of one on an idle machine), with messages that are no longer than a page each.
fn problems(text: &str) -> Vec<String> {
    let start = Instant::now();
    let problems = match scene::parse(text, "long.json") {
        Ok(loaded) => scene::check(&loaded),
        Err(SceneError::Wrong { problems, .. }) => problems,
        Err(other) => panic!("{other}"),
    };
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
    let said: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert!(said.len() <= 202, "{}", said.len());
    for text in &said {
        assert!(
            text.len() < 4000,
            "{} bytes: {}...",
            text.len(),
            &text[..200]
        );
    }
    said
}

fn scene(section: &str, content: &str) -> String {
    format!(
        r#"{{"covact": 1, "materials": {{"m": {{"neo_hooke": {{"E": 1, "nu": 0}}}}}}, "bodies": {{"b": {{"mesh": {{"plate": {{
        "size": [1, 1], "thickness": 1, "elements": [1, 1]}}}}, "material": "m"}}}}, "{section}": {{{content}}}}}"#
    )
}

#[test]
fn many_unknown_and_repeated_keys() {
    let unknown: Vec<String> = (0..50_000).map(|k| format!("\"k{k}\": 0")).collect();
    let said = problems(&format!("{{{}}}", unknown.join(",")));
    assert!(said[0].contains("unknown key `k0`"), "{}", said[0]);
    assert!(
        said.iter()
            .any(|s| s.contains("there are more problems, which are not listed"))
    );
    let said = problems(&format!("{{{}}}", vec!["\"covact\": 1"; 50_000].join(",")));
    assert!(said[0].contains("is given twice"), "{}", said[0]);
    // Twice among many others.
    let said = problems(&format!("{{\"k7\": 0,{}}}", unknown.join(",")));
    assert!(
        said.iter()
            .any(|s| s.contains("the key `k7` is given twice"))
    );
}

#[test]
fn many_names_that_are_not_there() {
    let supports: Vec<String> = (0..20_000)
        .map(|k| format!("\"s{k}\": {{\"on\": \"nobody{k}.top\", \"fixed\": true}}"))
        .collect();
    let said = problems(&scene("supports", &supports.join(",")));
    assert!(
        said[0].contains("there is no body `nobody0`"),
        "{}",
        said[0]
    );
    assert!(said.last().unwrap().contains("more problems"));
    let sets: Vec<String> = (0..20_000).map(|k| format!("\"set{k}\": 0")).collect();
    problems(&scene("supports", &sets.join(",")));
}

#[test]
fn long_names_and_texts() {
    let long = "n".repeat(1_000_000);
    for content in [
        format!("\"{long}\": {{\"on\": \"b.top\", \"fixed\": true}}"),
        format!("\"s\": {{\"on\": \"{long}\", \"fixed\": true}}"),
        format!("\"s\": {{\"on\": \"b.{long}\", \"fixed\": true}}"),
        format!("\"s\": {{\"on\": \"{long}.top\", \"fixed\": true}}"),
        format!("\"s\": {{\"on\": \"b.top\", \"{long}\": true}}"),
        format!("\"s\": {{\"on\": \"b.top\", \"symmetry\": \"{long}\"}}"),
        format!("\"s\": {{\"on\": \"b.top\", \"displacement\": {{\"x\": \"{long}\"}}}}"),
        format!(
            "\"s\": {{\"on\": \"b.top\", \"displacement\": {{\"x\": 1{}}}}}",
            "0".repeat(500_000)
        ),
        "[".repeat(1_000_000),
    ] {
        assert!(!problems(&scene("supports", &content)).is_empty());
    }
    let said = problems(&scene("bodies2", &format!("\"{long}\": 0")));
    assert!(said[0].contains("unknown key `bodies2`"), "{}", said[0]);
}
