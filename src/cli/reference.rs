//! The options of all commands, for the page of the book.
use super::Cli;
use clap::{Arg, Command, CommandFactory};

/// Every command with its arguments, as Markdown: what `--help` says, but for `--help` itself.
pub fn reference() -> String {
    let mut program = Cli::command();
    program.build();
    let mut text = String::new();
    for command in program.get_subcommands() {
        if command.get_name() != "help" {
            section(command, &mut text);
        }
    }
    text
}

fn section(command: &Command, text: &mut String) {
    let about = command.get_about().map(ToString::to_string);
    text.push_str(&format!(
        "### covact {}\n\n{}.\n\n| argument | meaning |\n|---|---|\n",
        command.get_name(),
        about.unwrap_or_default()
    ));
    for arg in command.get_arguments() {
        if !arg.is_hide_set() && arg.get_id() != "help" {
            text.push_str(&row(arg));
        }
    }
    text.push('\n');
}

fn row(arg: &Arg) -> String {
    let mut names: Vec<String> = Vec::new();
    names.extend(arg.get_short().map(|c| format!("-{c}")));
    names.extend(arg.get_long().map(|name| format!("--{name}")));
    let takes = arg.get_action().takes_values();
    let value = arg.get_value_names().and_then(<[_]>::first);
    let value = value.filter(|_| takes).map(|name| match names.is_empty() {
        true => format!("`{}`", name.as_str()),
        false => format!(" {}", name.as_str()),
    });
    let value = value.unwrap_or_default();
    let name = match names.is_empty() {
        true => value,
        false => format!("`{}{value}`", names.join("`, `")),
    };
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let default: Vec<_> = (arg.get_default_values().iter())
        .map(|v| v.to_string_lossy().into_owned())
        .collect();
    let default = match takes && !default.is_empty() {
        true => format!(" (default: `{}`)", default.join(" ")),
        false => String::new(),
    };
    let choices: Vec<String> = (arg.get_possible_values().iter())
        .filter(|_| takes)
        .map(|v| format!("`{}`", v.get_name()))
        .collect();
    let choices = match choices.is_empty() {
        true => String::new(),
        false => format!("; one of {}", choices.join(", ")),
    };
    let help = help.replace('\n', " ").replace('|', "\\|");
    format!("| {name} | {help}{choices}{default} |\n")
}
