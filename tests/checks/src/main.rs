//! The program `billow-checks`: the command line of the checks of the solver.

use std::io::{self, Write};
use std::process::ExitCode;

use billow_checks::{bench, cases, convergence, exact, stability};
use billow_study::cli::refused_line;
use billow_study::platform::error::Result;
use billow_study::platform::exit_code::Exit;
use billow_study::platform::output::{self, Output};
use billow_study::print::output_error;
use clap::{Parser, Subcommand};

/// Checks of the solver of billow: is it right, how exact, how fast, and where does it fail?
#[derive(Debug, Parser)]
#[command(name = "billow-checks", version, max_term_width = 100)]
struct Cli {
    /// The command.
    #[command(subcommand)]
    command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
enum Command {
    /// Run the reference cases and check their errors. Exit code 1 if one is out of tolerance.
    Validate(cases::command::Args),
    /// Map where each method of integration fails, by real runs of small scenes.
    Stability(stability::command::Args),
    /// Measure the speed of billow on this machine, stage by stage.
    Bench(bench::Args),
    /// Draw work-precision diagrams of scenes with an exact answer.
    Pareto(exact::Args),
    /// Show to what each measure of a study tends as the mesh is refined.
    Converge(convergence::command::Args),
    /// Compare the table of mesh errors with scenes that its regressions were not made from.
    HeldBack(convergence::held_back::Args),
}

fn main() -> ExitCode {
    let mut out = io::BufWriter::new(Output::new(io::stdout().lock()));
    let result = run(&mut out).and_then(|()| out.flush().map_err(output_error));
    let Err(error) = result else { return Exit::Success.into() };
    // The reader still gets what was printed before the error.
    let _ = out.flush();
    output::message(format_args!("billow-checks: {error}"));
    error.exit().into()
}

/// Runs the command of the command line.
fn run(out: &mut dyn Write) -> Result<()> {
    match Cli::try_parse() {
        Ok(cli) => match &cli.command {
            Command::Validate(args) => cases::command::run(args, out),
            Command::Stability(args) => stability::command::run(args, out),
            Command::Bench(args) => bench::run(args, out),
            Command::Pareto(args) => exact::run(args, out),
            Command::Converge(args) => convergence::command::run(args, out),
            Command::HeldBack(args) => convergence::held_back::run(args, out),
        },
        Err(error) if !error.use_stderr() => {
            write!(out, "{}", error.render()).map_err(output_error)
        }
        Err(error) => Err(refused_line(&error)),
    }
}
