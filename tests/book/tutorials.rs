//! Every tutorial is followed from an empty folder: its files are written, its commands run, and what it shows of their output
//! is looked for in what they print.
use crate::page::{Block, blocks, links, read, root};
use std::path::Path;
use std::process::{Command, Stdio};

/// Runs the commands of a block as a reader would; returns what they print.
fn shell(block: &Block, folder: &Path) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_covact"));
    let mut path = program.parent().expect("its folder").as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let output = Command::new("sh")
        .args(["-e", "-c", &block.text])
        .current_dir(folder)
        .env("PATH", path)
        .env("COVACT", root())
        .stdin(Stdio::null())
        .output()
        .expect("a shell");
    let printed = [output.stdout, output.stderr].concat();
    let printed = String::from_utf8_lossy(&printed).into_owned();
    assert!(
        output.status.success(),
        "line {}: {}\n{printed}",
        block.line,
        output.status
    );
    printed
}

/// Replaces in a file the lines of a block that begin with `-` or a space by those that begin with `+` or a space.
fn change(block: &Block, path: &Path) {
    let side = |other: char| -> String {
        let kept = block.text.lines().filter(|line| !line.starts_with(other));
        kept.map(|line| format!("{}\n", line.get(1..).unwrap_or("")))
            .collect()
    };
    let (old, new) = (side('+'), side('-'));
    let text = read(path);
    assert_eq!(
        text.matches(&old).count(),
        1,
        "line {}: in {}:\n{old}",
        block.line,
        path.display()
    );
    std::fs::write(path, text.replace(&old, &new)).expect("written");
}

/// With runs of blanks as one: tables are not compared by their columns.
fn plain(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Follows a tutorial; returns the folder that it leaves.
fn follow(name: &str) -> tempfile::TempDir {
    let page = read(
        &root()
            .join("docs/tutorials")
            .join(name)
            .with_extension("md"),
    );
    let folder = tempfile::tempdir().expect("a folder");
    let mut printed = String::new();
    let mut commands = 0;
    for block in blocks(&page) {
        let file = || {
            folder
                .path()
                .join(block.file.expect("a file's name before the block"))
        };
        match block.language {
            "json" | "text" if block.file.is_some() => {
                std::fs::write(file(), &block.text).expect("written");
            }
            "diff" => change(&block, &file()),
            "sh" => {
                printed = plain(&shell(&block, folder.path()));
                commands += block.text.lines().count();
            }
            "text" => {
                // A line `...` stands for lines that are left out.
                for line in block.text.lines().filter(|line| line.trim() != "...") {
                    assert!(
                        printed.contains(&plain(line)),
                        "line {}: `{line}` is not in {printed}",
                        block.line
                    );
                }
            }
            other => panic!("line {}: a block of `{other}`", block.line),
        }
    }
    assert!(commands >= 2, "{commands} commands");
    folder
}

/// The last number of a column of a history.
fn last(folder: &Path, run: &str, column: &str) -> f64 {
    let table = read(&folder.join(run).join("history.csv"));
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let at = head.iter().position(|name| *name == column);
    let row: Vec<&str> = lines.next_back().expect("a row").split(',').collect();
    row[at.unwrap_or_else(|| panic!("{column}: {head:?}"))]
        .parse()
        .expect("a number")
}

/// Two pages hold some 700 words; commands and scenes count as they are read.
#[test]
fn the_first_picture_comes_within_two_pages() {
    let mut count = 0;
    for entry in std::fs::read_dir(root().join("docs/tutorials")).expect("tutorials") {
        let path = entry.expect("entry").path();
        let page = read(&path);
        let before = page.split_once("\n![").expect("a picture").0;
        let words = before.split_whitespace().count();
        assert!(words <= 700, "{}: {words} words", path.display());
        for picture in links(&page).filter(|l| l.ends_with(".png")) {
            let picture = path.parent().expect("a folder").join(picture);
            let size = picture.metadata().expect("a picture").len();
            assert!(size < 150_000, "{}: {size} bytes", picture.display());
        }
        count += 1;
    }
    // Each of them is followed by a test below; that of Python by the tests of its package.
    assert_eq!(count, 8);
}

#[test]
fn first_press() {
    let folder = follow("first_press");
    let folder = folder.path();
    assert!(folder.join("out/report.html").is_file());
    assert!(folder.join("compare.html").is_file());
    // Forces that the page states.
    assert!((last(folder, "out", "force.ball.z") + 1.6).abs() < 0.05);
    assert!((last(folder, "deeper", "force.ball.z") + 3.8).abs() < 0.05);
}

#[test]
fn cad_part() {
    let folder = follow("cad_part");
    // The rim bears what the punch exerts.
    let punch = last(folder.path(), "out", "force.punch.z");
    let rim = last(folder.path(), "out", "force.rim.z");
    assert!(
        punch < -20.0 && (punch + rim).abs() < 1e-6 * punch.abs(),
        "{punch} {rim}"
    );
}

#[test]
fn mesh() {
    let folder = follow("mesh");
    assert!(last(folder.path(), "out", "force.ball.z") < -100.0);
    // A pressure on a plate of 20 x 20.
    let held = last(folder.path(), "four", "force.held.z");
    assert!((held - 0.01 * 400.0).abs() < 1e-3, "{held}");
}

/// Euler's rule for a thin belt, from the directions and sizes of the forces at its ends.
#[test]
fn friction() {
    let folder = follow("friction");
    let force = |name: &str| {
        let axis = |axis: &str| last(folder.path(), "out", &format!("force.{name}.{axis}"));
        let (x, z) = (axis("x"), axis("z"));
        (x.hypot(z), (-z).atan2(x.abs()))
    };
    let ((left, a), (right, b)) = (force("left"), force("right"));
    assert!((a + b - 48.3_f64.to_radians()).abs() < 2e-3, "{a} {b}");
    let ratio = right / left;
    assert!((ratio - 1.28).abs() < 0.005, "{ratio}");
    let euler = (0.3 * (a + b)).exp();
    assert!((ratio / euler - 1.0).abs() < 0.015, "{ratio} {euler}");
}

#[test]
fn bend_and_release() {
    let folder = follow("bend_and_release");
    let (path, run) = (folder.path(), "out");
    let released = last(path, run, "probe.tip.x");
    assert!((released + 3.0).abs() < 0.1, "{released}");
    assert_eq!(last(path, run, "force.punch.z"), 0.0);
}

#[test]
fn nurbs_shell() {
    let folder = follow("nurbs_shell");
    let force = |run: &str| last(folder.path(), run, "force.ball.z");
    let (coarse, fine) = (force("out"), force("fine"));
    assert!(
        fine < -100.0 && (coarse / fine - 1.0).abs() < 0.02,
        "{coarse} {fine}"
    );
}

#[test]
fn study() {
    let folder = follow("study");
    assert!(
        folder
            .path()
            .join("out/force-of-the-ball-error-shell.svg")
            .is_file()
    );
}
