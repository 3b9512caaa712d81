//! Commands that pages name exist, with the options they are given.
use crate::page::{all, blocks, read, root};
use std::collections::BTreeMap;
use std::process::Command;

fn help(command: &str) -> String {
    let mut program = Command::new(env!("CARGO_BIN_EXE_covact"));
    if !command.is_empty() {
        program.arg(command);
    }
    let output = program.arg("--help").output().expect("the program");
    assert!(output.status.success(), "covact {command} --help");
    String::from_utf8(output.stdout).expect("text")
}

/// The options that a line names, `--resume` of `(--resume, --force)` as well.
fn options(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| !c.is_ascii_alphanumeric() && c != '-')
        .filter(|word| word.starts_with("--") && word.len() > 2)
}

#[test]
fn commands_and_options_exist() {
    let mut pages = all();
    pages.push(root().join("README.md"));
    let mut known: BTreeMap<String, String> = BTreeMap::new();
    let mut count = 0;
    for page in pages {
        let text = read(&page);
        let shell = blocks(&text).into_iter().filter(|b| b.language == "sh");
        let shell: Vec<String> = shell.map(|b| b.text).collect();
        // In the text, what stands in backticks.
        let inline = text.split('`').skip(1).step_by(2);
        let all = shell.iter().flat_map(|text| text.lines()).chain(inline);
        for line in all.filter(|line| line.starts_with("covact ")) {
            let mut words = line.split_whitespace().skip(1);
            let command = words.next().expect("a command");
            if !command.chars().all(|c| c.is_ascii_lowercase()) {
                continue;
            }
            let help = (known.entry(command.to_owned())).or_insert_with(|| help(command));
            for option in options(line) {
                assert!(help.contains(option), "{}: {line}", page.display());
            }
            count += 1;
        }
    }
    assert!(count > 60 && known.len() >= 12, "{count} {known:?}");
}

/// The page of the commands lists every command, and ends with what `--help` says of each.
#[test]
fn the_page_of_commands_has_all_arguments() {
    let path = root().join("docs/commands.md");
    let page = read(&path);
    let reference = covact::cli::reference();
    let commands = (reference.lines()).filter_map(|line| line.strip_prefix("### "));
    let first = &blocks(&page)[0].text;
    let mut count = 0;
    for command in commands {
        let listed = first.lines().any(|line| line.starts_with(command));
        assert!(listed, "the list at the top of the page lacks {command}");
        count += 1;
    }
    assert!(count > 12, "{count}");
    const HEADING: &str = "## Arguments\n\n";
    let (before, after) = page.split_once(HEADING).expect("the arguments");
    if after.trim_end() != reference.trim_end() {
        let right = format!("{before}{HEADING}{}\n", reference.trim_end());
        let wanted = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("commands.md");
        std::fs::write(&wanted, right).expect("written");
        panic!(
            "docs/commands.md is behind the program: replace it by {}",
            wanted.display()
        );
    }
}
