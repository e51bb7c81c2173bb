//! The command line. One file per command: its arguments, and a function that writes the result to a
//! given `Write`. Results go to stdout; progress, notes and errors go to stderr.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Parser, Subcommand};

use crate::platform::error::{Error, InputError, Result};
use crate::platform::exit_code::{EXIT_CODES, Exit};
use crate::platform::memory as process_memory;
use crate::platform::output::Output;
use crate::print::{Format, output_error};

mod changes;
pub mod chart;
mod compare;
mod completions;
mod doctor;
mod export;
mod fold;
mod frames;
pub mod instruction_set;
mod job;
mod keys;
mod limits;
mod memory;
mod merge;
mod mesh_picture;
pub mod options;
pub mod picture;
mod plan;
mod report;
pub mod results;
mod run;
mod solve;
mod status;
mod submit;
mod table;

/// Parameter studies of inflatable capsules: fold, inflate, compare.
#[derive(Debug, Parser)]
#[command(
    name = "billow",
    version,
    propagate_version = true,
    max_term_width = 100,
    help_template = "{about-with-newline}\n{usage-heading} {usage}\n\n{before-help}Options:\n{options}{after-help}",
    before_help = commands_help(),
    after_help = exit_codes_help()
)]
pub struct Cli {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Compute one fold design: angles, lengths, and its crease pattern as files.
    Fold(fold::Args),
    /// List the jobs of a study, and the cheapest method that keeps an accuracy; run nothing.
    Plan(plan::Args),
    /// Run the jobs of a study that are not finished.
    Run(run::Args),
    /// Give the unfinished jobs of a study to a cluster.
    Submit(submit::Args),
    /// Join what several runs have stored: parts of a study, or tasks of a cluster.
    Merge(merge::Args),
    /// Show the progress of a study, during a run and afterwards.
    Status(status::Args),
    /// Explain why a job ended as it did, or print what is stored of it.
    Job(job::Args),
    /// Compare the values of one parameter, all other parameters being equal, or rank them.
    Compare(compare::Args),
    /// Check a results folder, or repair it. Exit code 1 if something is broken.
    Doctor(doctor::Args),
    /// Draw the shapes of one job side by side, as SVG and PNG.
    Frames(frames::Args),
    /// Solve one scene, a capsule or any mesh, without a study.
    Solve(solve::Args),
    /// Print the summary table of a study's results.
    Table(table::Args),
    /// Draw charts of a study's results, as SVG and PNG.
    Chart(chart::Args),
    /// Write one page with the answer, the table, curves and shapes in motion; it opens without network.
    Report(report::Args),
    /// Write all results of a study into one file that xarray opens.
    Export(export::Args),
    /// List the keys of a study or scene file, with unit, default, range and meaning.
    Keys(keys::Args),
    /// Print the completion script of a shell.
    Completions(completions::Args),
}

/// Runs the program.
pub fn main() -> ExitCode {
    process_memory::share_if_limited();
    let mut out = io::BufWriter::new(Output::new(io::stdout().lock()));
    let result =
        command(std::env::args_os(), &mut out).and_then(|()| out.flush().map_err(output_error));
    let Err(error) = result else { return Exit::Success.into() };
    // The reader still gets what was printed before the error.
    let _ = out.flush();
    eprintln!("billow: {error}");
    error.exit().into()
}

/// Runs the command of a command line, whose first word is the program.
///
/// # Errors
/// Those of the command.
pub fn command<W: Into<OsString> + Clone>(
    line: impl IntoIterator<Item = W>,
    out: &mut dyn Write,
) -> Result<()> {
    match Cli::try_parse_from(line) {
        Ok(cli) => dispatch(&cli.command, out),
        Err(error) if !error.use_stderr() => {
            write!(out, "{}", error.render()).map_err(output_error)
        }
        Err(error) => Err(refused_line(&error)),
    }
}

fn dispatch(command: &Command, out: &mut dyn Write) -> Result<()> {
    match command {
        Command::Fold(args) => fold::run(args, out),
        Command::Plan(args) => plan::run(args, out),
        Command::Run(args) => run::run(args, out),
        Command::Submit(args) => submit::run(args, out),
        Command::Merge(args) => merge::run(args, out),
        Command::Status(args) => status::run(args, out),
        Command::Job(args) => job::run(args, out),
        Command::Compare(args) => compare::run(args, out),
        Command::Doctor(args) => doctor::run(args, out),
        Command::Frames(args) => frames::run(args, out),
        Command::Solve(args) => solve::run(args, out),
        Command::Table(args) => table::run(args, out),
        Command::Chart(args) => chart::run(args, out),
        Command::Report(args) => report::run(args, out),
        Command::Export(args) => export::run(args, out),
        Command::Keys(args) => keys::run(args, out),
        Command::Completions(args) => completions::run(args, out),
    }
}

/// The commands in the groups in which a user thinks of them.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Design", &["fold", "solve", "keys"]),
    ("Study", &["plan", "run", "submit", "merge", "status"]),
    ("Answers", &["report", "table", "compare", "chart", "frames", "job", "export"]),
    ("Care", &["doctor", "completions"]),
];

/// The commands in `billow --help`, in [`GROUPS`].
fn commands_help() -> String {
    let program = Command::augment_subcommands(clap::Command::new("billow"));
    let mut text = String::new();
    for (group, names) in GROUPS {
        let _ = writeln!(text, "{group}:");
        for name in names {
            if let Some(about) = program.find_subcommand(name).and_then(clap::Command::get_about) {
                let _ = writeln!(text, "  {name:<12} {about}");
            }
        }
        text.push('\n');
    }
    text
}

/// The error of a command line that the parser refuses.
pub fn refused_line(refused: &clap::Error) -> Error {
    let mut text = refused.render().to_string();
    if refused.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        eprintln!("{text}");
        "no command is given".clone_into(&mut text);
    }
    let lines = text.lines().map(str::trim_end).filter(|line| !line.is_empty());
    let lines = lines.take_while(|line| !line.starts_with("For more info"));
    let elsewhere = elsewhere(refused);
    let is_tip = |line: &str| {
        line.starts_with("  tip: to pass") || elsewhere.is_some() && line.starts_with("  tip:")
    };
    let lines: Vec<&str> = lines.filter(|line| !is_tip(line)).collect();
    let problem = lines.join("\n");
    Error::Input(InputError {
        file: "command line".to_owned(),
        key: String::new(),
        value: String::new(),
        problem: problem
            .strip_prefix("error: ")
            .unwrap_or(&problem)
            .replace("Usage: ", "  usage: "),
        allowed: String::new(),
        hint: elsewhere.unwrap_or_else(|| "the same command with --help".to_owned()),
    })
}

/// Words of other programs, and the command that does what they mean.
const SYNONYMS: [(&str, &str); 5] = [
    ("rank", "compare STUDY --rank"),
    ("resume", "run STUDY"),
    ("plot", "chart STUDY"),
    ("show", "table STUDY"),
    ("check", "solve SCENE --check"),
];

/// Where a refused word or option is known: the command that it means, or those that take it.
fn elsewhere(refused: &clap::Error) -> Option<String> {
    let word = |kind| match refused.get(kind) {
        Some(ContextValue::String(word)) => Some(word.as_str()),
        _ => None,
    };
    if let Some(word) = word(ContextKind::InvalidSubcommand) {
        let (_, meant) = SYNONYMS.iter().find(|(synonym, _)| *synonym == word)?;
        return Some(format!("billow {meant}"));
    }
    if refused.kind() == ErrorKind::MissingRequiredArgument
        && refused.to_string().contains("--base <VALUE>")
    {
        return Some("give both, or --rank, which needs neither".to_owned());
    }
    let option = word(ContextKind::InvalidArg)?.strip_prefix("--")?;
    let option = option.split(['=', ' ']).next()?;
    let program = Command::augment_subcommands(clap::Command::new("billow"));
    let takes = |command: &&clap::Command| {
        command.get_arguments().any(|argument| argument.get_long() == Some(option))
    };
    let commands: Vec<&str> =
        program.get_subcommands().filter(takes).map(clap::Command::get_name).collect();
    (refused.kind() == ErrorKind::UnknownArgument && !commands.is_empty())
        .then(|| format!("--{option} is an option of {}", commands.join(", ")))
}

/// The exit codes below `billow --help`.
fn exit_codes_help() -> String {
    let mut text = "Exit codes:\n".to_owned();
    for code in EXIT_CODES {
        let _ = writeln!(text, "  {:<8} {}", code.number, code.brief);
    }
    text
}
