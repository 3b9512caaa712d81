//! Pages of runs: `run`, `view` and `compare`.
use crate::support::{assert_parts, covact, stderr, stdout, write_plate};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use serde_json::{Value, json};
use std::fs;
use std::io::Read;
use std::path::Path;

const RUN: [&str; 5] = ["run", "scene.json", "-o", "out", "--quiet"];

/// A page as its scripts find it.
struct Page {
    text: String,
    runs: Value,
    bytes: Vec<u8>,
}

impl Page {
    fn read(path: &Path) -> Page {
        let text = fs::read_to_string(path).unwrap();
        let inside = |id: &str| {
            let start = text.find(&format!(" id=\"{id}\">")).unwrap() + id.len() + 7;
            &text[start..start + text[start..].find("</script>").unwrap()]
        };
        Page {
            runs: serde_json::from_str(inside("head")).unwrap(),
            bytes: STANDARD.decode(inside("bytes")).unwrap(),
            text: text.clone(),
        }
    }

    fn chunk(&self, at: &Value) -> Vec<u8> {
        let [start, length] = [0, 1].map(|k| at[k].as_u64().unwrap() as usize);
        let mut out = Vec::new();
        (ZlibDecoder::new(&self.bytes[start..start + length]).read_to_end(&mut out)).unwrap();
        out
    }
}

#[test]
fn a_run_leaves_a_page_that_holds_its_results() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    let output = covact(folder.path(), &RUN);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let path = folder.path().join("out/report.html");
    let page = Page::read(&path);
    assert!(page.text.len() < 3_000_000);
    // Nothing is fetched: no addresses but the name of SVG.
    let addresses = page.text.matches("://").count();
    assert_eq!(
        addresses,
        page.text.matches("http://www.w3.org/2000/svg").count()
    );
    assert!(!page.text.contains("src="));
    assert_parts(
        &page.text,
        &[
            "<h1>out</h1>",
            "<p>plate under a ball</p>",
            "Done",
            "Accuracy of forces",
            "Plan",
            "contact.master.rigid",
        ],
    );
    let shapes = &page.runs[0]["shapes"];
    let [plate, ball] = [0, 1].map(|k| &shapes["parts"][k]);
    // 4 x 4 faces above and below, 4 on each side; edges of 25 columns, and 40 above and below.
    assert_eq!(plate["counts"], json!([50, 48, 96]));
    assert_eq!(
        (&plate["rigid"], &ball["rigid"]),
        (&json!(false), &json!(true))
    );
    let fields: Vec<&str> = (plate["fields"].as_array().unwrap().iter())
        .map(|f| f.as_str().unwrap())
        .collect();
    assert!(
        fields.contains(&"von_mises") && fields.contains(&"contact_pressure"),
        "{fields:?}"
    );
    let steps = shapes["steps"].as_array().unwrap();
    let times: Vec<f64> = steps.iter().map(|s| s["time"].as_f64().unwrap()).collect();
    assert_eq!(times, [0.0, 0.5, 1.0]);
    let last = &steps[2];
    for (k, v) in [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, -2.0]
        .iter()
        .enumerate()
    {
        let found = last["states"][1]["pose"][k].as_f64().unwrap();
        assert!((found - v).abs() < 1e-9, "{k}: {found}");
    }
    // The ball starts on the plate and pushes its middle down by nearly 2: it sinks in a little.
    let state = &last["states"][0];
    let largest = state["largest"].as_f64().unwrap();
    assert!(largest > 1.95 && largest < 2.0, "{largest}");
    let raw = page.chunk(&last["chunk"]);
    assert_eq!(raw.len(), 50 * (6 + fields.len()));
    // Component z behind x and y, its low bytes before its high ones; the smallest of it is where the ball presses.
    let (mut sum, mut lowest) = (0i16, 0i16);
    for i in 0..50 {
        sum = sum.wrapping_add(i16::from_le_bytes([raw[4 * 50 + i], raw[5 * 50 + i]]));
        lowest = lowest.min(sum);
    }
    let lowest = f64::from(lowest) / 32767.0 * state["scale"].as_f64().unwrap();
    assert!(
        (lowest + largest).abs() < 1e-3 * largest,
        "{lowest} {largest}"
    );
    let table: Value = serde_json::from_slice(&page.chunk(&page.runs[0]["table"])).unwrap();
    assert_eq!(table["rows"].as_array().unwrap().len(), 2);
    // Made again of the files, it is the same.
    fs::remove_file(&path).unwrap();
    let view = covact(folder.path(), &["view", "out"]);
    assert_eq!(view.status.code(), Some(0), "{}", stderr(&view));
    assert_eq!(
        stdout(&view).trim(),
        Path::new("out").join("report.html").display().to_string()
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), page.text);
}

#[test]
fn pages_are_left_out_replaced_with_their_run_and_never_written_over_files_of_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out/report.html");
    write_plate(folder.path(), &[("/output", json!({ "every": 0 }))]);
    let output = covact(folder.path(), &[&RUN[..], &["--no-report"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(!path.exists());
    // A run without fields has a page of curves.
    let view = covact(folder.path(), &["view", "out"]);
    assert_eq!(view.status.code(), Some(0), "{}", stderr(&view));
    assert_eq!(Page::read(&path).runs[0]["shapes"]["steps"], json!([]));
    let again = covact(
        folder.path(),
        &[&RUN[..], &["--no-report", "--force"]].concat(),
    );
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    assert!(
        !path.exists(),
        "the page of the run that was replaced is left"
    );
    fs::write(&path, "<!DOCTYPE html>\n<p>mine</p>").unwrap();
    for arguments in [&["view", "out"][..], &[&RUN[..], &["--force"]].concat()] {
        let refused = covact(folder.path(), arguments);
        assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
        assert_parts(
            &stderr(&refused),
            &["report.html` was not written by covact"],
        );
        assert!(fs::read_to_string(&path).unwrap().contains("mine"));
    }
}

#[test]
fn a_page_that_cannot_be_made_says_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let view = covact(folder.path(), &["view", "nothing"]);
    assert_eq!(view.status.code(), Some(5));
    assert_parts(
        &stderr(&view),
        &[
            "summary.json`: no such file",
            "does not hold the results of a run",
        ],
    );
    write_plate(folder.path(), &[]);
    covact(folder.path(), &[&RUN[..], &["--no-report"]].concat());
    // A field cut short.
    let field = folder.path().join("out/plate_0002.vtu");
    let bytes = fs::read(&field).unwrap();
    fs::write(&field, &bytes[..bytes.len() / 2]).unwrap();
    let view = covact(folder.path(), &["view", "out"]);
    assert_eq!(view.status.code(), Some(5));
    assert_parts(&stderr(&view), &["plate_0002.vtu` "]);
    assert!(!folder.path().join("out/report.html").exists());
}

#[test]
fn two_runs_stand_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(folder.path(), &[]);
    covact(folder.path(), &RUN);
    write_plate(
        folder.path(),
        &[("/materials/steel/st_venant_kirchhoff/E", json!(24000))],
    );
    covact(
        folder.path(),
        &["run", "scene.json", "-o", "st<iff", "--quiet"],
    );
    let compare = covact(
        folder.path(),
        &["compare", "out", "st<iff", "-o", "both.html"],
    );
    assert_eq!(compare.status.code(), Some(0), "{}", stderr(&compare));
    let page = Page::read(&folder.path().join("both.html"));
    assert_eq!(page.runs.as_array().unwrap().len(), 2);
    assert_eq!(page.runs[1]["name"], "st<iff");
    assert!(!page.text.contains("st<iff"), "a name that is no tag");
    // Twice the stiffness, about twice the force.
    let row = page.text.split("<tr><td>force.ball.z</td>").nth(1).unwrap();
    let change = row
        .split("<td>")
        .nth(3)
        .unwrap()
        .split("\u{a0}%")
        .next()
        .unwrap();
    let change: f64 = change.parse().unwrap();
    assert!(change > 90.0 && change < 105.0, "{change}");
    fs::write(folder.path().join("both.html"), "mine").unwrap();
    let refused = covact(
        folder.path(),
        &["compare", "out", "st<iff", "-o", "both.html"],
    );
    assert_eq!(refused.status.code(), Some(2));
}

/// A ball that starts in the plate is told with the place of the deepest of the points: the nine of each face are Gauss's, and
/// four of them are as near to the axis of the ball as any. The mark in 3-D, its text and the warning go by one number.
#[test]
fn warnings_are_marked_at_their_places() {
    let folder = tempfile::tempdir().unwrap();
    write_plate(
        folder.path(),
        &[
            ("/surfaces/ball/sphere/center", json!([10, 20, 25.5])),
            ("/contacts/press/points", json!({ "gauss": 3 })),
        ],
    );
    let output = covact(folder.path(), &RUN);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let page = Page::read(&folder.path().join("out/report.html"));
    let marks = page.runs[0]["marks"].as_array().unwrap();
    assert_eq!(marks.len(), 1, "{marks:?}");
    let at = [0, 1, 2].map(|k| marks[0]["at"][k].as_f64().unwrap());
    let aside = 5.0 * (1.0 - 0.6f64.sqrt());
    for (found, expected) in at.iter().zip([10.0, 20.0]) {
        assert!(((found - expected).abs() - aside).abs() < 1e-3, "{at:?}");
    }
    assert!((at[2] - 1.0).abs() < 1e-9, "{at:?}");
    let text = marks[0]["text"].as_str().unwrap();
    assert_parts(text, &["starts with an overclosure of", "4 point(s)"]);
    let number = marks[0]["number"].as_u64().unwrap();
    let marked = format!("<li id=\"w0-{number}\"><span class=\"mark\">{number}</span>");
    assert!(page.text.contains(&marked), "{marked}");
    // Other warnings name no place.
    let all = page.text.matches("<li id=\"w0-").count();
    assert!(all > 1);
    assert_eq!(page.text.matches("<span class=\"mark\">").count(), 1);
}
