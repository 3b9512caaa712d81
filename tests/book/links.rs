//! Every page stands in the table of contents, and every link leads to a file and a heading that exist.
use crate::page::{all, links, read, root};
use std::collections::BTreeSet;
use std::path::PathBuf;

#[test]
fn every_page_is_in_the_table_of_contents_once() {
    let docs = root().join("docs");
    let summary = read(&docs.join("SUMMARY.md"));
    let listed: Vec<PathBuf> = links(&summary).map(|link| docs.join(link)).collect();
    let set: BTreeSet<&PathBuf> = listed.iter().collect();
    assert_eq!(set.len(), listed.len(), "a page is listed twice");
    for page in all() {
        assert!(set.contains(&page), "SUMMARY.md lacks {}", page.display());
    }
    for page in &listed {
        assert!(page.is_file(), "{} does not exist", page.display());
    }
    assert!(listed.len() >= 40, "{}", listed.len());
}

/// mdBook reads nothing else from its table of contents, and fails where it finds something else.
#[test]
fn the_table_of_contents_has_the_form_that_mdbook_reads() {
    let summary = read(&root().join("docs/SUMMARY.md"));
    for line in summary.lines() {
        let item = line.trim_start().strip_prefix("- ").unwrap_or(line);
        let link = item.starts_with('[') && item.ends_with(".md)");
        assert!(
            line.is_empty() || line.starts_with("# ") || line == "---" || link,
            "{line}"
        );
    }
}

/// The identifier that GitHub and mdBook give a heading.
fn anchor(line: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    let title = line.trim_start_matches('#').trim().to_lowercase();
    title
        .chars()
        .filter(kept)
        .collect::<String>()
        .replace(' ', "-")
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut pages = all();
    pages.push(root().join("README.md"));
    pages.push(root().join("docs/SUMMARY.md"));
    let mut count = 0;
    for page in pages {
        let text = read(&page);
        for link in links(&text) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => page.clone(),
                file => page.parent().expect("a folder").join(file),
            };
            assert!(target.exists(), "{}: {link}", page.display());
            if !heading.is_empty() {
                let text = read(&target);
                let mut headings = text.lines().filter(|l| l.starts_with('#'));
                assert!(
                    headings.any(|l| anchor(l) == heading),
                    "{}: no heading {link}",
                    page.display()
                );
            }
            count += 1;
        }
    }
    assert!(count > 150, "{count}");
}

/// Folders outside of `docs` that pages link into travel with the built book.
#[test]
fn the_build_takes_along_what_pages_link_to() {
    let script = read(&root().join("assets/build_book.sh"));
    let line = script.lines().find(|l| l.contains("cp -r --parents"));
    let taken: Vec<&str> = line.expect("a copy").split_whitespace().collect();
    for page in all() {
        let text = read(&page);
        for link in links(&text) {
            let file = link.split('#').next().unwrap_or(link);
            let outside = file.trim_start_matches("../");
            let target = page.parent().expect("a folder").join(file);
            let docs = root().join("docs").canonicalize().expect("docs");
            if !file.is_empty() && !target.canonicalize().expect("a file").starts_with(docs) {
                assert!(
                    taken.iter().any(|folder| outside.starts_with(folder)),
                    "the build does not take {outside} along"
                );
            }
        }
    }
}

/// Files of the repository that pages name in backticks.
#[test]
fn files_that_pages_name_exist() {
    const FOLDERS: [&str; 8] = [
        "assets/",
        "benches/",
        "docs/",
        "examples/",
        "geometry/",
        "python/",
        "src/",
        "tests/",
    ];
    let mut count = 0;
    for page in all() {
        let text = read(&page);
        for name in text.split('`').skip(1).step_by(2) {
            let path = FOLDERS.iter().any(|folder| name.starts_with(folder));
            let plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
            // Names that stand for several (`NAME.json`, `*.rs`) are no paths.
            if path && name.chars().all(plain) && !name.contains("NAME") {
                // The page of the geometry crate names its files from that crate's folder.
                let mut folders = [root().to_path_buf(), root().join("geometry")].into_iter();
                assert!(
                    folders.any(|f| f.join(name).exists()),
                    "{}: {name}",
                    page.display()
                );
                count += 1;
            }
        }
    }
    assert!(count > 60, "{count}");
}

/// Commands that run a benchmark name tests that there are.
#[test]
fn tests_that_pages_name_exist() {
    let mut count = 0;
    for page in all() {
        let text = read(&page);
        for command in text
            .split('`')
            .filter(|t| t.starts_with("cargo test --test "))
        {
            let mut words = command.split_whitespace().skip(3);
            let folder = root().join("tests").join(words.next().expect("a test"));
            let Some(filter) = words.next() else { continue };
            assert!(folder.join("main.rs").is_file(), "{command}");
            // Modules are files or folders; the last word may be a function of one.
            let mut place = folder;
            for word in filter.split("::") {
                let file = place.with_extension("rs");
                let text = if file.is_file() {
                    file
                } else {
                    place.join("mod.rs")
                };
                let next = place.join(word);
                let function = text.is_file() && read(&text).contains(&format!("fn {word}("));
                let module = next.is_dir() || next.with_extension("rs").is_file();
                assert!(function || module, "{}: {command}", page.display());
                place = next;
            }
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

/// The equations of the published theory, in the chapters that the overview says have them.
#[test]
fn equations_are_where_the_overview_says() {
    let folder = root().join("docs/theory");
    let overview = read(&folder.join("README.md"));
    let chapters: Vec<_> = (all().into_iter())
        .filter(|page| page.parent() == Some(folder.as_path()))
        .filter(|page| !page.ends_with("README.md"))
        .collect();
    assert_eq!(chapters.len(), 9);
    let mut count = 0;
    for row in overview.lines().filter(|line| line.starts_with("| (")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let (number, chapter) = (cells[1], cells[cells.len() - 2]);
        let begins = format!("{chapter}-");
        let page = chapters.iter().find(|page| {
            (page.file_name().and_then(|n| n.to_str())).is_some_and(|n| n.starts_with(&begins))
        });
        let page = page.unwrap_or_else(|| panic!("{row}"));
        assert!(
            read(page).contains(number),
            "{} lacks {number}",
            page.display()
        );
        count += 1;
    }
    assert_eq!(count, 11);
}
