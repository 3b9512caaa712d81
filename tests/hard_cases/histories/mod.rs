//! Histories of the shipped scenes, committed as data: a change that is not meant to change results shows here.
//!
//! Every shipped scene runs, most of them on a coarser mesh or for a part of their time ([`scenes`]), and its history is
//! compared with `NAME.csv` beside this file: the same columns and rows, the same counts (iterations, cuts, points in
//! contact), and every other number to 1e-9 of the largest of its kind ([`table::scale`]). A change that is meant writes
//! the files anew, which tells per scene which columns and rows moved; histories that are within the tolerance stay:
//!
//! ```sh
//! COVACT_WRITE_HISTORIES=1 cargo test --test hard_cases histories
//! ```
mod scenes;
mod table;

use crate::support::{scene_json, solve};
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::PathBuf;
use table::Record;

/// What writes the histories anew.
const COMMAND: &str = "COVACT_WRITE_HISTORIES=1 cargo test --test hard_cases histories";

fn path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/hard_cases/histories");
    folder.join(format!("{name}.csv"))
}

/// Whether histories are to be written anew.
fn writing() -> bool {
    std::env::var_os("COVACT_WRITE_HISTORIES").is_some()
}

/// Runs a scene and compares its history with the committed one, or replaces that where it is asked for.
fn holds(name: &str, change: scenes::Change) {
    let mut scene = scene_json(&format!("{name}.json"));
    change(&mut scene);
    scene["solution"]["threads"] = 2.into();
    scene["output"] = serde_json::json!({ "every": 0 });
    let outcome = solve(&scene);
    println!(
        "{name}: {:.2} CPU seconds",
        outcome.summary.cpu_s.unwrap_or(f64::NAN)
    );
    let found = Record::new(&outcome.summary, &outcome.history);
    let committed = fs::read_to_string(path(name)).map_err(|e| e.to_string());
    let moved = match committed.and_then(|text| Record::read(&text)) {
        Ok(committed) => found.moved_from(&committed),
        Err(reason) => vec![format!("no committed history: {reason}")],
    };
    if moved.is_empty() {
        return;
    }
    let moved = moved.join("\n  ");
    if writing() {
        fs::write(path(name), found.text(name)).expect("writable");
        // Past the test harness, which shows nothing of a test that passes.
        let _ = writeln!(std::io::stderr(), "{name}: written anew\n  {moved}");
        return;
    }
    panic!("{name} is not what it was:\n  {moved}\nIf that is meant: {COMMAND}");
}

/// A test for each shipped scene, and the list of them.
macro_rules! histories {
    ($($name:ident),* $(,)?) => {
        $(#[test]
        fn $name() {
            holds(stringify!($name), scenes::$name);
        })*
        const NAMES: &[&str] = &[$(stringify!($name)),*];
    };
}

histories!(
    ball_by_weight,
    ball_drag,
    ball_on_plate,
    bend_and_release,
    crossed_tubes,
    deep_cup,
    draw_bead,
    drop,
    flanged_panel,
    folded_panel,
    gravity_drape,
    hat_pressed,
    hertz_block,
    ironing,
    panel_pressed,
    pinched_tube,
    press_pads,
    punch_sheet,
    q18_on_h8,
    sandwiched_shell,
    sheet_in_die,
    sheet_over_hills,
    snap_clip_nurbs,
    strip_drawn,
    strip_over_cylinder,
    tubes_crossed_nurbs,
    u_channel,
);

/// Names of the files of a folder with this ending, less the ending.
fn stems(folder: &str, ending: &str) -> BTreeSet<String> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(folder);
    (fs::read_dir(folder).expect("folder"))
        .filter_map(|entry| entry.expect("entry").file_name().into_string().ok())
        .filter_map(|file| Some(file.strip_suffix(ending)?.to_owned()))
        .collect()
}

#[test]
fn every_shipped_scene_has_a_history() {
    let tests: BTreeSet<String> = NAMES.iter().map(|name| (*name).to_owned()).collect();
    let mut shipped = stems("examples/scenes", ".json");
    shipped.remove("schema");
    assert_eq!(tests, shipped);
    // While they are written, other tests are at it.
    if !writing() {
        assert_eq!(tests, stems("tests/hard_cases/histories", ".csv"));
    }
}
