//! `billow completions`: the completion script of a shell.

use std::io::Write;

use clap::CommandFactory;

use super::{Cli, output_error};
use crate::platform::error::Result;

/// Arguments of `billow completions`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The shell.
    pub shell: clap_complete::Shell,
}

/// Runs `billow completions`.
///
/// # Errors
/// When the output cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    // The generator panics when a write fails; a write to memory cannot fail.
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "billow", &mut script);
    out.write_all(&script).map_err(output_error)
}
