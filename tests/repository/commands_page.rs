//! Reference pages that are generated from the definitions of the commands and exit codes.

use std::fmt::Write;

use billow_study::cli::Cli;
use billow_study::cli::options::HEADING;
use billow_study::platform::exit_code::EXIT_CODES;
use clap::{Arg, Command, CommandFactory};

/// First lines of a generated page.
const GENERATED: &str = "Generated from the program. To update: `BILLOW_UPDATE_REFERENCE=1 cargo test --release -p \
     billow-study --test repository reference`.";

/// docs/reference/commands.md: every command with its usage, arguments and options.
pub fn commands() -> String {
    let mut cli = Cli::command();
    cli.build();
    let mut page = format!("# Commands\n\n{GENERATED}\n\n");
    let shown = |command: &&Command| command.get_name() != "help";
    let names: Vec<String> = cli
        .get_subcommands()
        .filter(shown)
        .map(|command| {
            let name = command.get_name();
            format!("| [`{name}`](#billow-{name}) | {} |\n", about(command))
        })
        .collect();
    let _ = write!(page, "| command | purpose |\n|---|---|\n{}", names.concat());
    let _ = write!(
        page,
        "\n`billow COMMAND --help` prints the same. Exit codes: [exit-codes.md](exit-codes.md).\n"
    );
    for command in cli.get_subcommands().filter(shown) {
        section(&mut page, command);
    }
    page
}

/// docs/reference/exit-codes.md.
pub fn exit_codes() -> String {
    let mut page =
        format!("# Exit codes\n\n{GENERATED}\n\n| code | name | meaning |\n|---|---|---|\n");
    for code in EXIT_CODES {
        let _ = writeln!(page, "| {} | {} | {} |", code.number, code.name, code.meaning);
    }
    page
}

fn about(command: &Command) -> String {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    cell(&about)
}

/// One command: purpose, usage, then a table each of arguments, options of the command and global options.
fn section(page: &mut String, command: &Command) {
    let usage = command.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ");
    let _ = write!(
        page,
        "\n## billow {}\n\n{}\n\n```text\n{usage}\n```\n",
        command.get_name(),
        about(command)
    );
    let is_global = |arg: &Arg| arg.get_help_heading() == Some(HEADING);
    let builtin = |arg: &Arg| matches!(arg.get_id().as_str(), "help" | "version");
    let arguments: Vec<&Arg> =
        command.get_arguments().filter(|arg| !arg.is_hide_set() && !builtin(arg)).collect();
    for (heading, chosen) in [
        ("argument", arguments.iter().filter(|arg| arg.is_positional()).collect::<Vec<_>>()),
        (
            "option",
            arguments.iter().filter(|arg| !arg.is_positional() && !is_global(arg)).collect(),
        ),
        ("global option", arguments.iter().filter(|arg| is_global(arg)).collect()),
    ] {
        if chosen.is_empty() {
            continue;
        }
        let _ = write!(page, "\n| {heading} | meaning |\n|---|---|\n");
        for arg in chosen {
            let _ = writeln!(page, "| {} | {} |", signature(arg), meaning(arg));
        }
    }
}

/// An argument as it is typed: `-q, --quiet` or `--set <KEY=VALUE>`.
fn signature(arg: &Arg) -> String {
    let takes_value = arg.get_action().takes_values();
    let values: Vec<String> = match arg.get_value_names() {
        Some(names) if takes_value => names.iter().map(|name| format!("<{name}>")).collect(),
        _ => Vec::new(),
    };
    let mut names: Vec<String> = Vec::new();
    names.extend(arg.get_short().map(|short| format!("-{short}")));
    names.extend(arg.get_long().map(|long| format!("--{long}")));
    names.extend(
        arg.get_visible_aliases().unwrap_or_default().iter().map(|alias| format!("--{alias}")),
    );
    let mut text = names.join(", ");
    if !values.is_empty() {
        if !text.is_empty() {
            text.push(' ');
        }
        text.push_str(&values.join(" "));
    }
    format!("`{}`", text.replace('|', "\\|"))
}

/// Help text, whether the argument is required, default and possible values.
fn meaning(arg: &Arg) -> String {
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    let mut text = cell(&help);
    if arg.is_required_set() {
        text.push_str(" Required.");
    }
    let takes_value = arg.get_action().takes_values();
    let defaults = arg.get_default_values();
    if takes_value && !defaults.is_empty() && !arg.is_hide_default_value_set() {
        let defaults: Vec<_> = defaults.iter().map(|value| value.to_string_lossy()).collect();
        let _ = write!(text, " Default: `{}`.", defaults.join(","));
    }
    let possible: Vec<String> = arg
        .get_possible_values()
        .iter()
        .filter(|_| takes_value)
        .map(|value| match value.get_help() {
            Some(help) => format!("`{}`: {help}", value.get_name()),
            None => format!("`{}`", value.get_name()),
        })
        .collect();
    if !possible.is_empty() {
        let separator = if possible.iter().any(|value| value.contains(':')) { "; " } else { ", " };
        let _ = write!(text, " Values: {}.", possible.join(separator));
    }
    text
}

/// A text as a cell of a Markdown table, with a full stop.
fn cell(text: &str) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
    // clap removes the last full stop of a doc comment.
    if text.is_empty() || text.ends_with(['.', ']', '?', '!']) { text } else { format!("{text}.") }
}
