//! What is handed out: archives of the program with their checksums.
#![cfg(unix)]
use std::path::Path;
use std::process::{Command, Output};

fn run(program: &str, arguments: &[&str], folder: &Path) -> Output {
    Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap_or_else(|e| panic!("{program}: {e}"))
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&[&*output.stdout, &*output.stderr].concat()).into_owned()
}

#[test]
fn an_archive_holds_the_program_and_fits_its_checksum() {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/build_release.sh");
    let program = env!("CARGO_BIN_EXE_covact");
    let folder = tempfile::tempdir().expect("a folder");
    let made = run(script, &["--binary", program, "out"], folder.path());
    assert!(made.status.success(), "{}", said(&made));
    let out = folder.path().join("out");

    let checked = run("sha256sum", &["--check", "--strict", "SHA256SUMS"], &out);
    assert!(checked.status.success(), "{}", said(&checked));
    let sums = std::fs::read_to_string(out.join("SHA256SUMS")).expect("checksums");
    let archive = sums.split_whitespace().nth(1).expect("a name");
    let name = archive.strip_suffix(".tar.gz").expect("an archive");
    let version = env!("CARGO_PKG_VERSION");
    assert!(name.starts_with(&format!("covact-{version}-")), "{name}");

    let unpacked = run("tar", &["-xzf", archive], &out);
    assert!(unpacked.status.success(), "{}", said(&unpacked));
    let inside = out.join(name);
    for file in [
        "README.md",
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "changelog.md",
        "man1/covact.1",
        "man1/covact-run.1",
        "completions/covact.bash",
    ] {
        assert!(inside.join(file).is_file(), "{file}");
    }
    let program = inside.join("covact");
    let asked = run(program.to_str().expect("text"), &["--version"], &inside);
    assert_eq!(said(&asked).trim(), format!("covact {version}"));

    // A changed archive does not fit.
    std::fs::write(out.join(archive), "something else").expect("written");
    let checked = run("sha256sum", &["--check", "--strict", "SHA256SUMS"], &out);
    assert!(!checked.status.success());
}

#[test]
fn the_script_says_how_it_is_called() {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/build_release.sh");
    let folder = tempfile::tempdir().expect("a folder");
    let asked = run(script, &[], folder.path());
    assert_eq!(asked.status.code(), Some(2));
    assert!(
        said(&asked).contains("build_release.sh FOLDER [TARGET ...]"),
        "{}",
        said(&asked)
    );
}

/// Versions of both crates and of the wheel go together, and the files that name one know it.
#[test]
fn versions_go_together() {
    let version = env!("CARGO_PKG_VERSION");
    let read = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    for (file, line) in [
        ("python/Cargo.toml", format!("version = \"{version}\"")),
        ("docs/CITATION.cff", format!("version: {version}")),
    ] {
        let text = read(file);
        assert!(text.lines().any(|l| l == line), "{file} lacks `{line}`");
    }
    let changes = read("docs/changelog.md");
    let newest = (changes.lines()).find_map(|l| l.strip_prefix("## "));
    let newest = newest.expect("a version");
    assert!(newest.split([',', ' ']).next() == Some(version), "{newest}");
    for part in ["### Lib", "### CLI", "### Py"] {
        assert!(changes.contains(part), "docs/changelog.md lacks {part}");
    }
    assert!(read("Cargo.toml").contains(&format!("covact-geometry = {{ version = \"{version}\"")));
}

/// The package of Python is a workspace of its own: it shares builds with this one only where both leave the same crates unoptimised.
#[test]
fn crates_of_the_compiler_are_unoptimised_in_both_workspaces() {
    let read = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    let unoptimised = |text: &str| -> Vec<String> {
        let lines = text.lines().filter(|l| l.ends_with(" = { opt-level = 0 }"));
        lines.map(str::to_owned).collect()
    };
    let lock = read("python/Cargo.lock");
    let mut expected = unoptimised(&read("Cargo.toml"));
    assert!(expected.len() > 20);
    expected.retain(|line| {
        let name = line.split(' ').next().unwrap_or_default();
        lock.lines().any(|l| l == format!("name = \"{name}\""))
    });
    assert_eq!(unoptimised(&read("python/Cargo.toml")), expected);
}
