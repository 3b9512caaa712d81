//! Completions of shells, what is printed and what is logged.
use crate::support::{covact, plate_scene, stderr, stdout};

#[test]
fn every_shell_has_completions() {
    let folder = tempfile::tempdir().unwrap();
    for (shell, part) in [
        ("bash", "complete -F _covact"),
        ("zsh", "#compdef covact"),
        ("fish", "complete -c covact"),
    ] {
        let made = covact(folder.path(), &["completions", shell]);
        assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
        let text = stdout(&made);
        for part in [part, "inspect", "without", "template"] {
            assert!(text.contains(part), "{shell}: no {part}");
        }
    }
    let unknown = covact(folder.path(), &["completions", "cmd"]);
    assert_eq!(unknown.status.code(), Some(2));
}

#[test]
fn the_log_tells_of_every_iteration() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.json"), plate_scene().to_string()).unwrap();
    let run = |more: &[&str]| {
        let run = covact(
            folder.path(),
            &[&["run", "scene.json", "-o", "out"], more].concat(),
        );
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        run
    };
    let quiet = run(&["--quiet"]);
    assert_eq!(
        (stderr(&quiet), stdout(&quiet)),
        (String::new(), String::new())
    );
    let log = std::fs::read_to_string(folder.path().join("out/run.log")).unwrap();
    assert!(
        log.starts_with(concat!("covact ", env!("CARGO_PKG_VERSION"), "\n")),
        "{log}"
    );
    let iterations = |text: &str| {
        text.lines()
            .filter(|l| l.contains("e-") && !l.contains("accepted"))
            .count()
    };
    let steps = log.matches("accepted").count();
    assert!(steps > 0 && iterations(&log) > steps, "{log}");
    // The log belongs to the run, and goes with it.
    let verbose = run(&["--force", "-v"]);
    let again = std::fs::read_to_string(folder.path().join("out/run.log")).unwrap();
    assert_eq!(
        again.matches("accepted").count(),
        log.matches("accepted").count()
    );
    // What is shown with -v is what the log holds; without it there is a line a step.
    assert_eq!(
        stderr(&verbose).matches("accepted").count(),
        again.matches("accepted").count()
    );
    let plain = stderr(&run(&["--force"]));
    assert_eq!(plain.matches("accepted").count(), 0);
    for line in again
        .lines()
        .chain(plain.lines())
        .filter(|l| l.starts_with("    "))
    {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

#[test]
fn a_log_of_somebody_else_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.json"), plate_scene().to_string()).unwrap();
    std::fs::create_dir(folder.path().join("out")).unwrap();
    let log = folder.path().join("out/run.log");
    std::fs::write(&log, "mine").unwrap();
    let run = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--force"],
    );
    assert_eq!(run.status.code(), Some(2), "{}", stderr(&run));
    assert_eq!(std::fs::read_to_string(&log).unwrap(), "mine");
}
