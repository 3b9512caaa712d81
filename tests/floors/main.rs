//! The modules of `src` are floors: each uses those below it only.
//!
//! The floors are the list under `src/` in the picture of docs/architecture.md, from the ground up: `name/` or `name.rs`. Read here is every
//! path from the root of the crate (`crate::`, `super::` chains that end there, `$crate::` of macros), in `use` items,
//! re-exports, expressions and macros alike; names that `lib.rs` re-exports and exported macros count as the module that
//! defines them. Tests (`#[cfg(test)]`) may use every floor.
mod sources;

use sources::{Arrow, Sources, read_file, read_text};
use std::fs;
use std::path::Path;

/// Floors from the ground up: the names under `src/` in the picture, a line each.
fn floors(page: &str) -> Vec<String> {
    let picture = page.split("```").nth(1).expect("a picture");
    let lines = picture
        .lines()
        .skip_while(|line| !line.starts_with("src/"))
        .skip(1);
    (lines.take_while(|line| line.starts_with(' ')))
        .filter_map(|line| {
            let line = line.strip_prefix("  ")?;
            let word = line.split_whitespace().next()?;
            let name = word
                .strip_suffix('/')
                .or_else(|| word.strip_suffix(".rs"))?;
            (!line.starts_with(' ')).then(|| name.to_owned())
        })
        .collect()
}

/// Arrows from a floor to itself or one above.
fn upwards<'a>(arrows: &'a [Arrow], floors: &[String]) -> Vec<&'a Arrow> {
    let floor = |name: &str| floors.iter().position(|f| f == name);
    (arrows.iter())
        .filter(|a| floor(&a.to) >= floor(&a.from))
        .collect()
}

/// Lines of the longest file of the sources: beyond, it holds two ideas.
const LONGEST: usize = 500;

#[test]
fn no_file_of_the_sources_is_too_long() {
    fn longer(folder: &Path, found: &mut Vec<String>) -> usize {
        let mut read = 0;
        for entry in fs::read_dir(folder).expect("a folder of sources") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                read += longer(&path, found);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let lines = fs::read_to_string(&path).expect("a source").lines().count();
                if lines > LONGEST {
                    found.push(format!("{}: {lines}", path.display()));
                }
                read += 1;
            }
        }
        read
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    let read =
        longer(&root.join("src"), &mut found) + longer(&root.join("geometry/src"), &mut found);
    assert!(read > 300, "{read} files");
    assert_eq!(found, Vec::<String>::new());
}

#[test]
fn every_module_uses_lower_floors_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = Sources::default();
    read_file(
        &mut sources,
        &root.join("src/lib.rs"),
        &root.join("src"),
        &[],
    );
    let arrows = sources.arrows();
    assert_eq!(sources.unclear, Vec::<String>::new());
    let page = fs::read_to_string(root.join("docs/architecture.md")).expect("the architecture");
    let floors = floors(&page);
    let (mut listed, mut modules) = (floors.clone(), sources.modules.clone());
    listed.sort();
    modules.sort();
    assert_eq!(
        listed, modules,
        "the picture lists every module of src once, from the ground up"
    );
    assert!(
        arrows.len() > 100,
        "only {} arrows were found",
        arrows.len()
    );
    let wrong: Vec<String> = (upwards(&arrows, &floors).iter())
        .map(|a| format!("{}: {} uses crate::{}", a.place, a.from, a.path))
        .collect();
    assert!(
        wrong.is_empty(),
        "{} arrows point upwards:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// Every arrow upwards, or all with FLOORS_ALL, for whoever moves modules: `cargo test --test floors -- --ignored --nocapture`.
#[test]
#[ignore = "prints, checks nothing"]
fn print_arrows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = Sources::default();
    read_file(
        &mut sources,
        &root.join("src/lib.rs"),
        &root.join("src"),
        &[],
    );
    let arrows = sources.arrows();
    for a in &arrows {
        println!("{}\t{}\t{}\t{}", a.from, a.to, a.path, a.place);
    }
    println!("{:?}", sources.unclear);
}

/// Arrows of a module `a` with this text, beside modules `b`, `c` and `d`.
fn arrows_of(text: &str) -> Vec<String> {
    let mut sources = Sources::default();
    let root =
        "pub mod a; pub mod b; pub mod c; pub mod d; pub use c::{Thing, deep::Other as Named};";
    read_text(&mut sources, root, "lib.rs".to_owned(), None, &[]);
    let exported = "#[macro_export] macro_rules! with_d { () => {} }";
    read_text(
        &mut sources,
        exported,
        "d.rs".to_owned(),
        None,
        &["d".to_owned()],
    );
    read_text(
        &mut sources,
        text,
        "a.rs".to_owned(),
        None,
        &["a".to_owned()],
    );
    let mut found: Vec<String> = (sources.arrows().iter())
        .map(|a| format!("{} {}", a.to, a.place))
        .collect();
    found.extend(sources.unclear);
    found
}

#[test]
fn all_ways_to_another_module_are_seen() {
    for (text, found) in [
        ("use crate::b::X;", vec!["b a.rs:1"]),
        ("pub use crate::b::X as Y;", vec!["b a.rs:1"]),
        (
            "use crate::{a::Own, b, c::{X, Y}};",
            vec!["b a.rs:1", "c a.rs:1", "c a.rs:1"],
        ),
        (
            "fn f() {\n  let x = [crate::b::make()];\n}",
            vec!["b a.rs:2"],
        ),
        ("use super::b::X;", vec!["b a.rs:1"]),
        (
            "mod inner { use super::super::b; use super::c; }",
            vec!["b a.rs:1"],
        ),
        (
            "mod inner { use super::{own, super::{b::X, c}}; }",
            vec!["b a.rs:1", "c a.rs:1"],
        ),
        (
            "fn f() { println!(\"{}\", crate::b::X); }",
            vec!["b a.rs:1"],
        ),
        (
            "macro_rules! m { () => { $crate::b::X } }",
            vec!["b a.rs:1"],
        ),
        ("fn f(x: &'static crate::b::X) {}", vec!["b a.rs:1"]),
        (
            "use crate::{Thing, Named}; fn f() { crate::with_d!() }",
            vec!["c a.rs:1", "c a.rs:1", "d a.rs:1"],
        ),
        ("#[cfg(not(test))] use crate::b;", vec!["b a.rs:1"]),
        (
            "#[cfg(feature = \"cli\")] mod inner { use crate::b; }",
            vec!["b a.rs:1"],
        ),
        (
            "use crate::*;",
            vec!["a.rs:1: `crate::*` is no module of src and no name of lib.rs"],
        ),
        (
            "use crate::unknown::X;",
            vec!["a.rs:1: `crate::unknown` is no module of src and no name of lib.rs"],
        ),
        (
            "#[path = \"x.rs\"] mod x;",
            vec!["a.rs:1: the attribute `path`"],
        ),
    ] {
        assert_eq!(arrows_of(text), found, "{text}");
    }
}

#[test]
fn what_is_no_way_to_another_module_is_not() {
    for text in [
        "// use crate::b;\n/* crate::b */ /// [`crate::b`]\nfn f() {}",
        "fn f() -> &'static str { \"use crate::b;\" }",
        "use crate::a::X; use self::y::Z; use super::a::W;",
        "#[cfg(test)] mod tests { use crate::b; }",
        "#[cfg(test)] use crate::{b, c}; #[cfg(all(test, unix))] fn f() { crate::b::f() }",
        "struct S { #[cfg(test)] x: crate::b::X, y: u8 }",
        "mod tests { #![cfg(test)] use crate::b; }",
        "mod inner { use super::b; }",
        "use other_crate::b; fn f(x: b::X) {}",
    ] {
        assert_eq!(arrows_of(text), Vec::<String>::new(), "{text}");
    }
}

#[test]
fn arrows_upwards_are_found() {
    let arrow = |from: &str, to: &str| Arrow {
        from: from.to_owned(),
        to: to.to_owned(),
        path: String::new(),
        place: String::new(),
    };
    let floors = floors(
        "```\ngeometry/ x\nsrc/\n  low/   ground\n         more/ of it\n  mid.rs between\n  high/  above\ntests/ y\n```\n",
    );
    assert_eq!(floors, ["low", "mid", "high"]);
    let arrows = [arrow("high", "low"), arrow("low", "high")];
    assert_eq!(upwards(&arrows, &floors), [&arrows[1]]);
}
