//! `billow fold`.

use std::io::Write;

use super::Global;
use crate::error::Result;

/// Arguments of `billow fold`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs `billow fold`.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let _ = (args, global, out);
    todo!()
}
