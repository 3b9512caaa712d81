//! How large results and pages are, and a part that comes from CAD.
use crate::support::{covact, stderr};
use serde_json::json;
use std::fs;
use std::path::Path;

/// Bytes of a numeric type of VTK.
fn width(kind: &str) -> usize {
    match kind {
        "Float64" | "UInt64" | "Int64" => 8,
        "Float32" | "UInt32" | "Int32" => 4,
        "UInt8" | "Int8" => 1,
        other => panic!("{other}"),
    }
}

/// What the fields of a file would take as plain files had them: inline in base64, uncompressed, in double precision, without
/// resultants and reactions. Sizes of arrays are those that stand in front of their blocks.
fn plain(bytes: &[u8]) -> usize {
    let text = String::from_utf8_lossy(bytes);
    let start = b"<AppendedData encoding=\"raw\">_";
    let at = bytes.windows(start.len()).position(|w| w == start).unwrap();
    let data = &bytes[at + start.len()..];
    let mut sum = 0;
    for tag in text.split("<DataArray ").skip(1) {
        let tag = tag.split('>').next().unwrap();
        let value = |name: &str| {
            let at = format!(" {name}=\"");
            let tag = format!(" {tag}");
            tag.split_once(&at)
                .unwrap()
                .1
                .split('"')
                .next()
                .unwrap()
                .to_owned()
        };
        let offset: usize = value("offset").parse().unwrap();
        let number = |k: usize| {
            let own = &data[offset + 8 * k..][..8];
            u64::from_le_bytes(own.try_into().unwrap()) as usize
        };
        // Blocks, their size, that of a shorter last one.
        let [blocks, size, last] = [0, 1, 2].map(number);
        let raw = if last > 0 {
            (blocks - 1) * size + last
        } else {
            blocks * size
        };
        let later = [
            "membrane_force",
            "bending_moment",
            "shear_force",
            "reaction",
        ];
        let kind = value("type");
        if later
            .iter()
            .any(|name| tag.contains(&format!("Name=\"{name}\"")))
        {
            continue;
        }
        let width = if kind == "Float32" { 2.0 } else { 1.0 };
        assert_eq!(raw % self::width(&kind), 0);
        sum += (raw as f64 * width * 4.0 / 3.0) as usize;
    }
    sum
}

/// Field files of a folder: their bytes, and those of plain ones that have every tool in every step.
fn fields(out: &Path) -> [usize; 2] {
    let mut sums = [0; 2];
    for name in ["results.pvd", "results_tessellated.pvd"] {
        let collection = fs::read_to_string(out.join(name)).unwrap();
        let mut seen = Vec::new();
        for entry in collection.split(" file=\"").skip(1) {
            let file = entry.split('"').next().unwrap();
            // Bodies are in both collections.
            if name != "results.pvd" && !file.contains("tessellated") {
                continue;
            }
            let bytes = fs::read(out.join(file)).unwrap();
            sums[1] += plain(&bytes);
            if !seen.contains(&file) {
                sums[0] += bytes.len();
                seen.push(file);
            }
        }
    }
    sums
}

/// Results take about a fifth of plain ones (no more digits than they are worth, compression, tools that stand still written once, no
/// code of text), and the page, beside its scripts, a twenty-fifth; benches/outputs.py measures all shipped scenes, which take a fifth.
fn bounded(name: &str) {
    let folder = tempfile::tempdir().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scenes/{name}.json"));
    let scene = scene.display().to_string();
    let run = covact(folder.path(), &["run", &scene, "-o", "out", "--quiet"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let out = folder.path().join("out");
    let [written, plain] = fields(&out);
    let share = written as f64 / plain as f64;
    let page = fs::metadata(out.join("report.html")).unwrap().len() as usize;
    println!("{name}: {written} of {plain} bytes, {share:.3}; page {page}");
    assert!(plain > 1_000_000, "{name}: {plain}");
    assert!(
        share < 0.22,
        "{name}: {written} of {plain} bytes, {share:.3}"
    );
    assert!(
        page < 60_000 + plain / 25 && page < 3_000_000,
        "{name}: {page} of {plain}"
    );
}

#[test]
fn results_of_a_sheet_take_about_a_fifth_of_plain_ones() {
    bounded("hat_pressed");
}

#[test]
fn results_of_a_strip_take_about_a_fifth_of_plain_ones() {
    bounded("strip_over_cylinder");
}

/// A part that a CAD kernel wrote and gmsh meshed, with bends and holes, is pressed by a CAD tool with nothing chosen: it ends
/// without a warning, and forces and moments of punch and foot are in balance.
#[test]
fn a_part_of_a_cad_file_is_pressed_at_defaults() {
    let folder = tempfile::tempdir().unwrap();
    let asset = |name: &str| {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("assets")
            .join(name)
    };
    let scene = json!({
        "covact": 1,
        "units": { "length": "mm", "force": "N" },
        "materials": { "sheet": "steel" },
        "bodies": { "bracket": {
            "mesh": { "file": { "path": asset("mesh/bracket.msh"), "thickness": 1 } },
            "material": "sheet"
        } },
        "surfaces": { "punch": {
            "cad": { "file": asset("sphere.igs") },
            "placement": { "scale": 4, "translation": [64, 30, 45.7] },
            "motion": { "translation": [0, 0, "-4*t"] }
        } },
        "contacts": { "press": { "slave": "bracket.flange_top", "master": "punch", "friction": 0.15 } },
        "supports": { "foot": { "on": "bracket.foot_bottom", "fixed": true } }
    });
    fs::write(folder.path().join("scene.json"), scene.to_string()).unwrap();
    let run = covact(
        folder.path(),
        &["run", "scene.json", "-o", "out", "--quiet"],
    );
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(run.stderr.is_empty(), "{}", stderr(&run));
    let table = covact::output::read_csv(&folder.path().join("out/history.csv")).unwrap();
    let last = |name: &str| *table.column(name).unwrap().last().unwrap();
    let force = last("force.punch.z");
    for axis in ["x", "y", "z"] {
        for kind in ["force", "moment"] {
            let [punch, foot] = ["punch", "foot"].map(|n| last(&format!("{kind}.{n}.{axis}")));
            let scale = if kind == "force" { 1.0 } else { 100.0 };
            assert!(
                (punch + foot).abs() < 1e-5 * scale * force.abs(),
                "{kind} {axis}: {punch} {foot}"
            );
        }
    }
    assert!(force < -50.0, "{force}");
}
