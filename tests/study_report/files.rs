//! What is written: pages and pictures that are well-formed and small, whatever the record.
use crate::markup::tags;
use crate::records;
use covact::study::record::Record;
use covact::study::report::write;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

fn written(record: &Record) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(record, &folder.path().join("new/folder")).unwrap();
    folder
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join("new/folder").join(name)).unwrap()
}

fn pictures(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder.join("new/folder"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".svg"))
        .collect();
    names.sort();
    names
}

/// Records with what is written of them, once for all tests.
static ALL: LazyLock<Vec<(&str, Record, tempfile::TempDir)>> = LazyLock::new(|| {
    let written = |(name, record)| {
        let folder = written(&record);
        (name, record, folder)
    };
    all().into_iter().map(written).collect()
});

fn all() -> Vec<(&'static str, Record)> {
    vec![
        ("forty", records::forty()),
        ("two hundred", records::two_hundred()),
        ("many series", records::many_series()),
        ("nasty", records::nasty()),
        ("no reference", records::no_reference()),
        ("swing only", records::swing_only()),
        ("single", records::single()),
        ("all failed", records::all_failed()),
        ("no logarithm", records::no_logarithm()),
        ("nothing", records::empty(&[], Vec::new())),
        (
            "no runs",
            records::empty(&["master"], vec![records::force(None)]),
        ),
    ]
}

#[test]
fn pages_are_whole_and_refer_to_nothing_outside() {
    for (name, record, folder) in ALL.iter() {
        let page = read(folder.path(), "report.html");
        let tags = tags(&page).unwrap_or_else(|e| panic!("{name}: {e}"));
        for outside in ["http://", "https://", "src=", "@import", "url("] {
            assert!(!page.contains(outside), "{name}: {outside}");
        }
        // Links lead to files that are there, or that the study itself writes.
        for (_, link) in tags
            .iter()
            .flat_map(|t| &t.attributes)
            .filter(|a| a.0 == "href")
        {
            let there = folder.path().join("new/folder").join(link).is_file();
            assert!(there || link == "study.json", "{name}: {link}");
        }
        assert_eq!(tags.iter().filter(|t| t.name == "script").count(), 1);
        assert!(page.len() < 2_000_000, "{name}: {} bytes", page.len());
        // A row per run.
        let rows = tags.iter().filter(|t| t.name == "tr").count();
        assert_eq!(rows, record.runs.len() + 1, "{name}");
    }
}

#[test]
fn names_are_escaped() {
    let folder = written(&records::nasty());
    let page = read(folder.path(), "report.html");
    assert!(page.contains("A &lt;b&gt;title&lt;/b&gt; &amp; &quot;more&quot; &lt;/script&gt;"));
    assert!(!page.contains("<b>") && !page.contains("<i>") && !page.contains("alert('x')"));
    assert!(page.contains("alert(&apos;x&apos;)"));
}

#[test]
fn pictures_are_xml_with_finite_numbers() {
    let mut count = 0;
    for (name, _, folder) in ALL.iter() {
        for picture in pictures(folder.path()) {
            let text = read(folder.path(), &picture);
            let tags = tags(&text).unwrap_or_else(|e| panic!("{name}, {picture}: {e}"));
            assert_eq!(tags[0].name, "svg");
            assert!(text.contains("xmlns=\"http://www.w3.org/2000/svg\""));
            assert!(!text.contains("var("), "{name}, {picture}");
            for (key, value) in tags.iter().flat_map(|t| &t.attributes) {
                let geometry = ["d", "x", "y", "width", "height", "rx", "viewBox"];
                if !geometry.contains(&key.as_str()) {
                    continue;
                }
                let numbers = value.split(|c: char| " MLazZ".contains(c));
                for number in numbers.filter(|n| !n.is_empty()) {
                    let number: f64 = number
                        .parse()
                        .unwrap_or_else(|_| panic!("{name}, {picture}: {key}={value}"));
                    assert!(
                        number.is_finite() && number.abs() < 5000.0,
                        "{name}, {picture}"
                    );
                }
            }
            count += 1;
        }
    }
    assert!(count > 60, "{count}");
}

#[test]
fn pictures_of_a_study_with_everything() {
    let folder = written(&records::forty());
    assert_eq!(
        pictures(folder.path()),
        [
            "force-noise-master.svg",
            "force-noise-shell.svg",
            "force-over-travel-curves.svg",
            "force-over-travel-error-dofs.svg",
            "force-over-travel-error-master.svg",
            "force-over-travel-error-shell.svg",
            "force-over-travel-error-time.svg",
            "iterations-master.svg",
            "iterations-shell.svg",
            "iterations.svg",
            "punch-force-error-dofs.svg",
            "punch-force-error-master.svg",
            "punch-force-error-shell.svg",
            "punch-force-error-time.svg",
            "time-phases.svg",
        ]
    );
    // The picture says the rate that the made-up law has: 1.9 with a floor of 0.0001 and some scatter.
    let text = read(folder.path(), "punch-force-error-shell.svg");
    assert!(text.contains("NURBS (order 1.9)"), "{text}");
}

#[test]
fn a_page_that_would_be_too_large_says_what_it_leaves_out() {
    let mut record = records::two_hundred();
    for k in 0..12 {
        let mut more = record.quantities[0].clone();
        more.name = format!("more {k}");
        record.quantities.push(more);
        for run in &mut record.runs {
            let first = run.measured[0].clone();
            run.measured.push(first);
        }
    }
    let folder = written(&record);
    let page = read(folder.path(), "report.html");
    assert!(page.len() < 2_000_000, "{}", page.len());
    assert!(page.contains("Left out to keep this page small"));
    assert!(page.contains("<a href=\"more-11-error-time.svg\">"));
    assert!(pictures(folder.path()).contains(&"more-11-error-time.svg".to_string()));
}

/// Pictures of an earlier report are removed, files of the user are not.
#[test]
fn pictures_that_no_page_shows_any_more() {
    let folder = written(&records::forty());
    let before = pictures(folder.path());
    assert!(!before.is_empty());
    let out = folder.path().join("new/folder");
    fs::write(out.join("mine.svg"), "<svg/>").unwrap();
    write(&records::all_failed(), &out).unwrap();
    let fresh = pictures(written(&records::all_failed()).path());
    let mut expected = [fresh, vec!["mine.svg".to_owned()]].concat();
    expected.sort();
    assert_eq!(pictures(folder.path()), expected);
    assert!(before.iter().any(|name| !expected.contains(name)));
}
