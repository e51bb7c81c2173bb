//! `billow schema`: the JSON Schema of the study file or the scene file.

use std::io::Write;

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::PrettyFormatter;

use super::output_error;
use crate::input::schema;
use crate::platform::error::Result;

/// Arguments of `billow schema`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The file to describe.
    #[arg(value_enum, default_value_t = Of::Study)]
    pub of: Of,
    /// Same as `billow schema scene`.
    #[arg(long)]
    pub scene: bool,
}

/// A file with a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Of {
    /// The study file of `billow run`.
    Study,
    /// The scene file of `billow solve`.
    Scene,
}

/// Runs `billow schema`: prints the schema, indented.
///
/// # Errors
/// When the output cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let schema = match args.of {
        Of::Study if !args.scene => schema::study_schema(),
        Of::Study | Of::Scene => schema::scene_schema(),
    };
    // One space for each level keeps it readable and small.
    let formatter = PrettyFormatter::with_indent(b" ");
    let mut text = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut text, formatter);
    let written = schema.serialize(&mut serializer).map_err(std::io::Error::from);
    written.and_then(|()| out.write_all(&text)).and_then(|()| writeln!(out)).map_err(output_error)
}
