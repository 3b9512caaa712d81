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

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let made = covact(folder.path(), &["man", "-o", "share/man/man1"]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let page = |name: &str| {
        std::fs::read_to_string(folder.path().join("share/man/man1").join(name)).expect(name)
    };
    let program = page("covact.1");
    assert!(
        program.contains(".TH covact 1") && program.contains("Exit codes"),
        "{program}"
    );
    let help = stdout(&covact(folder.path(), &["--help"]));
    let (_, commands) = help.split_once("Commands:\n").unwrap();
    let commands: Vec<&str> = commands
        .lines()
        .take_while(|l| l.starts_with("  "))
        .filter_map(|l| l.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(commands.len() > 12, "{commands:?}");
    for name in commands {
        assert!(
            page(&format!("covact-{name}.1")).contains(".SH SYNOPSIS"),
            "{name}"
        );
    }
    assert!(page("covact-run.1").contains("without"));
    // A file in the way.
    std::fs::write(folder.path().join("taken"), "").unwrap();
    let taken = covact(folder.path(), &["man", "-o", "taken"]);
    assert_eq!(taken.status.code(), Some(5));
    assert!(stderr(&taken).contains("cannot write manual pages to taken"));
}

/// What is printed of the shipped scenes, CAD files and cases fits in 80 columns; words that are longer, as names of files,
/// stand alone.
#[test]
fn listings_fit_a_terminal() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let of = |folder: &str, endings: &[&str]| -> Vec<String> {
        let files = std::fs::read_dir(root.join(folder)).unwrap();
        let paths = files.map(|f| f.unwrap().path());
        let wanted = |p: &std::path::PathBuf| {
            let ending = p.extension().and_then(|e| e.to_str()).unwrap_or("");
            endings.contains(&ending) && !p.ends_with("schema.json")
        };
        paths
            .filter(wanted)
            .map(|p| p.display().to_string())
            .collect()
    };
    let scenes = of("examples/scenes", &["json"]);
    let tools = of("assets/cad", &["igs", "stp", "step", "stl"]);
    assert!(scenes.len() > 10 && tools.len() > 3, "{scenes:?} {tools:?}");
    let plans = (scenes.iter()).flat_map(|scene| [vec!["plan", scene], vec!["check", scene]]);
    let inspections = tools.iter().map(|tool| vec!["inspect", tool]);
    for arguments in plans.chain(inspections).chain([vec!["gauntlet", "--list"]]) {
        let shown = covact(root, &arguments);
        assert_eq!(
            shown.status.code(),
            Some(0),
            "{arguments:?}: {}",
            stderr(&shown)
        );
        let text = stdout(&shown);
        assert!(text.lines().count() > 5);
        for line in text.lines().filter(|l| l.trim().contains(' ')) {
            assert!(line.chars().count() <= 80, "{arguments:?}: {line}");
        }
    }
}
