//! `billow schema`.

use std::io::Write;

use super::Global;
use crate::error::Result;

/// Arguments of `billow schema`.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs `billow schema`.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let _ = (args, global, out);
    todo!()
}
