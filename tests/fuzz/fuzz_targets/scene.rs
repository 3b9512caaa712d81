//! Any text as a scene: reading it, and every check that needs no mesh. What is read must survive being written.
#![no_main]
use covact::scene::{self, Problem, SceneError};
use covact_fuzz::{Budget, bounded};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let read = bounded(Budget::reader(bytes.len()), || {
        let loaded = scene::parse(text, "fuzz.json");
        if let Err(e) = &loaded {
            assert!(!e.to_string().is_empty());
        }
        loaded
    });
    let loaded = match read {
        Ok(loaded) => loaded,
        Err(SceneError::Wrong { problems, .. }) => return told(&problems, text),
        Err(_) => return,
    };
    // The text, its values and the scene are there already.
    let problems = bounded(Budget::reader(bytes.len()), || scene::check(&loaded));
    told(&problems, text);
    let written = serde_json::to_string(&loaded.scene).expect("written");
    let back = scene::parse(&written, "back.json").expect("read back");
    assert_eq!(back.scene, loaded.scene);
});

/// Problems lie within the text and are no longer than a page each.
fn told(problems: &[Problem], text: &str) {
    for problem in problems {
        assert!(problem.span.start <= problem.span.end && problem.span.end <= text.len());
        assert!(!problem.message.is_empty());
        let length = problem.to_string().len();
        assert!(length < 4000, "a message of {length} bytes");
    }
}
