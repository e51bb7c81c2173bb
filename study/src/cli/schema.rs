//! `billow schema`.

use std::io::Write;

use super::{Global, output_error};
use crate::error::Result;
use crate::schema;

/// Arguments of `billow schema`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs `billow schema`: the JSON Schema of the study file, indented.
///
/// # Errors
/// When the output cannot be written.
pub fn run(_: &Args, _: &Global, out: &mut dyn Write) -> Result<()> {
    writeln!(out, "{:#}", schema::study_schema()).map_err(output_error)
}
