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
    assert!(said.iter().any(|s| s.contains("unknown key `k0`")));
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

/// Words that stand where they must not, and long names in messages and in the pointers to what is wrong.
#[test]
fn long_words_and_keys() {
    let long = "n".repeat(200_000);
    for text in [
        long.clone(),
        format!("{{{long}: 1}}"),
        format!("[1 {long}]"),
        format!("{{\"covact\": 1 {long}}}"),
    ] {
        // A key without quotes is read, and then what it names is not there.
        assert!((1..=5).contains(&problems(&text).len()));
    }
    for content in [
        format!(
            "\"s\": {{\"on\": \"b.top\", \"displacement\": {{\"x\": \"{}\"}}}}",
            &long[..4000]
        ),
        format!(
            "\"s\": {{\"on\": \"b.top\", \"displacement\": {{\"x\": \"{}(1)\"}}}}",
            &long[..4000]
        ),
        format!(
            "\"s\": {{\"on\": \"b.top\", \"displacement\": {{\"x\": \"0*{}1/0\"}}}}",
            "1*".repeat(2000)
        ),
        format!(
            "\"s\": {{\"on\": \"b.top\", \"displacement\": {{\"x\": \"1 {}\"}}}}",
            "1".repeat(4000)
        ),
    ] {
        let said = problems(&scene("supports", &content));
        assert_eq!(said.len(), 1);
        assert!(said[0].len() < 500, "{}", said[0]);
    }
    // A surface of a long name, in a message about the contact that it is the master of.
    let said = problems(&scene(
        "contacts",
        &format!(
            "\"c\": {{\"slave\": \"b.top\", \"master\": \"{long}\", \"passes\": \"two_half\"}}}},
            \"surfaces\": {{\"{long}\": {{\"sphere\": {{\"radius\": 1}}}}"
        ),
    ));
    assert!(said[0].contains("longer than 200 bytes"), "{}", said[0]);
    // Each of many problems below a key of a long name would point to it by that name.
    let many: Vec<String> = (0..200).map(|k| format!("\"k{k}\": 0")).collect();
    let text = scene("supports", &format!("\"{long}\": {{{}}}", many.join(",")));
    match scene::parse(&text, "long.json") {
        Err(SceneError::Wrong { problems, .. }) => {
            assert!(problems.len() >= 200);
            assert!(problems.iter().all(|p| p.pointer == "/supports"));
        }
        other => panic!("{other:?}"),
    }
    let sets: Vec<String> = (0..200)
        .map(|k| {
            format!(
                "\"{k},\": {{\"nodes_near_point\": {{\"point\": [0, 0, 0], \"tolerance\": -1}}}}"
            )
        })
        .collect();
    let text = scene("supports", "")
        .replace("\"b\"", &format!("\"{long}\""))
        .replace(
            "\"material\": \"m\"",
            &format!("\"material\": \"m\", \"sets\": {{{}}}", sets.join(",")),
        );
    let found = scene::check(&scene::parse(&text, "long.json").unwrap());
    let pointers: usize = found.iter().map(|p| p.pointer.len()).sum();
    assert!(pointers < 2 * text.len(), "{pointers} bytes of pointers");
}

/// Names of the same length would be compared letter by letter, in a time that grows as its square.
#[test]
fn long_names_are_not_compared_letter_by_letter() {
    let [one, other] = ["a", "b"].map(|c| c.repeat(30_000));
    let text = scene("supports", "")
        .replace("\"material\": \"m\"", &format!("\"material\": \"{one}\""))
        .replace("\"m\": {", &format!("\"{other}\": {{"));
    assert!(text.contains(&one) && text.contains(&other));
    assert!(problems(&text)[0].contains("longer than 200 bytes"));
    // Many names and as many references, of lengths that are compared and that are not, of the same letters and of others.
    for (length, letters) in [(34, ["a", "b"]), (20, ["ab", "ba"]), (196, ["a", "b"])] {
        let [known, asked] = letters.map(|c| {
            let start = c.repeat(length / c.len());
            move |k: usize| format!("{start}{k:03}")
        });
        let surfaces: Vec<String> = (0..900)
            .map(|k| format!("\"{}\": {{\"sphere\": {{\"radius\": 1}}}}", known(k)))
            .collect();
        let contacts: Vec<String> = (0..200)
            .map(|k| {
                format!(
                    "\"c{k}\": {{\"slave\": \"b.top\", \"master\": \"{}\"}}",
                    asked(k)
                )
            })
            .collect();
        let text = scene(
            "surfaces",
            &format!(
                "{}}}, \"contacts\": {{{}",
                surfaces.join(","),
                contacts.join(",")
            ),
        );
        let start = Instant::now();
        let said = problems(&text);
        assert!(said.len() >= 200, "{}", said.len());
        assert!(
            start.elapsed() < Duration::from_secs(2),
            "{:?}",
            start.elapsed()
        );
    }
}
