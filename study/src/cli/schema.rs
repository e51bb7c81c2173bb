//! `billow schema`.

use std::io::Write;

use super::output_error;
use crate::input::schema;
use crate::platform::error::Result;

/// Arguments of `billow schema`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Of which file.
    #[arg(value_enum, default_value_t = Of::Study)]
    pub of: Of,
    /// The same as `billow schema scene`.
    #[arg(long)]
    pub scene: bool,
}

/// A file that has a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Of {
    /// The study file of `billow run`.
    Study,
    /// The scene file of `billow solve`.
    Scene,
}

/// Runs `billow schema`: the JSON Schema of the study file or the scene file, indented.
///
/// # Errors
/// When the output cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let schema = match args.of {
        Of::Study if !args.scene => schema::study_schema(),
        Of::Study | Of::Scene => schema::scene_schema(),
    };
    writeln!(out, "{schema:#}").map_err(output_error)
}
