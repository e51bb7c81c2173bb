//! The command line: one file a command, each with its own arguments and a function that writes its
//! result to a given `Write`. Results go to stdout, progress and errors to stderr.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand, ValueEnum};

use crate::platform::error::{Error, Result};

mod answer;
pub mod bench;
mod chart;
mod compare;
mod completions;
mod doctor;
mod fold;
mod frames;
mod instruction_set;
mod keys;
mod memory;
mod notes;
mod picture;
mod plan;
pub mod print;
mod rerun;
mod run;
mod schema;
mod show;
mod solve;
mod status;
mod table;
mod target;
pub mod validate;
mod why;

/// Parameter studies of inflatable capsules: fold, inflate, compare.
#[derive(Debug, Parser)]
#[command(name = "billow", version, propagate_version = true, max_term_width = 100)]
pub struct Cli {
    /// Options every command takes.
    #[command(flatten)]
    pub global: Global,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// Options every command takes.
#[derive(Debug, Clone, clap::Args)]
pub struct Global {
    /// Folder of the results [default: `results/STUDY` under the current folder].
    #[arg(long, global = true, value_name = "DIR")]
    pub results: Option<PathBuf>,
    /// Threads [default: one a core]. Each runs one job at a time; `solve` uses one. No result
    /// depends on them.
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<usize>,
    /// Override a key of the study or scene, as in --set film.thickness="30 um".
    #[arg(long, global = true, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Same as --format json.
    #[arg(long, global = true, conflicts_with = "format")]
    pub json: bool,
    /// How a table is printed.
    #[arg(long, global = true, value_enum)]
    pub format: Option<Format>,
    /// No progress.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// More progress.
    #[arg(short, long, global = true)]
    pub verbose: bool,
}

impl Global {
    /// The format asked for.
    pub fn format(&self) -> Format {
        if self.json { Format::Json } else { self.format.unwrap_or(Format::Table) }
    }
}

/// How a table is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Aligned columns.
    Table,
    /// Comma-separated values (RFC 4180).
    Csv,
    /// A JSON array of rows.
    Json,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// One fold design: its angles and lengths, and its crease pattern as files.
    Fold(fold::Args),
    /// List the jobs of a study; run nothing.
    Plan(plan::Args),
    /// Run what is missing of a study.
    Run(run::Args),
    /// Run jobs again that are finished, and say whether they give the same bits.
    Rerun(rerun::Args),
    /// Say how far a study is, while it runs and afterwards.
    Status(status::Args),
    /// Say why a job ended as it did.
    Why(why::Args),
    /// Show everything stored of one job: parameters, scene, row, history.
    Show(show::Args),
    /// Compare the values of one parameter, all else equal.
    Compare(compare::Args),
    /// Check a results folder; change nothing. Exit code 1 if something is broken.
    Doctor(doctor::Args),
    /// Draw the shapes of one job side by side, as SVG and PNG.
    Frames(frames::Args),
    /// Solve one scene, a capsule or any mesh, without a study.
    Solve(solve::Args),
    /// Print the summary table of a study's results.
    Table(table::Args),
    /// Draw charts of a study's results.
    Chart(chart::Args),
    /// List the keys of a study or scene file, with unit, default, range and meaning.
    Keys(keys::Args),
    /// Print the JSON Schema of the study file or the scene file.
    Schema(schema::Args),
    /// Run the reference cases and judge them; exit code 1 if one is out of band.
    Validate(validate::Args),
    /// Measure what billow costs on this machine, stage by stage, and what is asked of it.
    Bench(bench::Args),
    /// Print the completions of a shell.
    Completions(completions::Args),
}

/// Runs the program.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // --help and --version are answers; everything else is bad input, exit code 2.
            let code = if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
            let _ = error.print();
            return code;
        }
    };
    let mut out = io::BufWriter::new(io::stdout().lock());
    let result = dispatch(&cli, &mut out).and_then(|()| out.flush().map_err(output_error));
    match result {
        Ok(()) | Err(Error::OutputClosed) => ExitCode::SUCCESS,
        Err(error) => {
            // What was printed before the error still belongs to the reader.
            let _ = out.flush();
            eprintln!("billow: {error}");
            error.exit_code()
        }
    }
}

fn dispatch(cli: &Cli, out: &mut dyn Write) -> Result<()> {
    match &cli.command {
        Command::Fold(args) => fold::run(args, &cli.global, out),
        Command::Plan(args) => plan::run(args, &cli.global, out),
        Command::Run(args) => run::run(args, &cli.global, out),
        Command::Rerun(args) => rerun::run(args, &cli.global, out),
        Command::Status(args) => status::run(args, &cli.global, out),
        Command::Why(args) => why::run(args, &cli.global, out),
        Command::Show(args) => show::run(args, &cli.global, out),
        Command::Compare(args) => compare::run(args, &cli.global, out),
        Command::Doctor(args) => doctor::run(args, &cli.global, out),
        Command::Frames(args) => frames::run(args, &cli.global, out),
        Command::Solve(args) => solve::run(args, &cli.global, out),
        Command::Table(args) => table::run(args, &cli.global, out),
        Command::Chart(args) => chart::run(args, &cli.global, out),
        Command::Keys(args) => keys::run(args, &cli.global, out),
        Command::Schema(args) => schema::run(args, &cli.global, out),
        Command::Validate(args) => validate::run(args, &cli.global, out),
        Command::Bench(args) => bench::run(args, &cli.global, out),
        Command::Completions(args) => completions::run(args, out),
    }
}

/// A failed write to stdout: quiet when the reader went away (`billow … | head`).
#[expect(clippy::needless_pass_by_value, reason = "the shape map_err takes")]
pub fn output_error(error: io::Error) -> Error {
    if error.kind() == io::ErrorKind::BrokenPipe {
        Error::OutputClosed
    } else {
        Error::Disk { path: PathBuf::from("stdout"), problem: error.to_string() }
    }
}
