//! The options of the command.

use std::num::NonZero;
use std::path::PathBuf;

use clap::Parser;
use clap::builder::PossibleValuesParser;

use crate::kinds;

/// Torture billow: kills, signals, full disks, changed files, little memory, mutated input.
#[derive(Debug, Clone, Parser)]
pub struct Options {
    /// Only these kinds, comma-separated.
    #[arg(long, value_delimiter = ',', value_parser = PossibleValuesParser::new(kinds::NAMES))]
    pub only: Vec<String>,
    /// Share of the trials of each kind, above 0 up to 1.
    #[arg(long = "trials", value_name = "SHARE", default_value_t = 1.0, value_parser = share)]
    pub share: f64,
    /// Only this trial of one kind.
    #[arg(long, requires = "only")]
    pub number: Option<usize>,
    /// Seed of all random choices.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Number of trials at the same time [default: number of cores].
    #[arg(long)]
    pub threads: Option<NonZero<usize>>,
    /// Folder of the trials.
    #[arg(long, default_value = concat!(env!("CARGO_TARGET_TMPDIR"), "/torture"))]
    pub folder: PathBuf,
    /// Keep the folders of good trials, too.
    #[arg(long)]
    pub keep: bool,
}

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| *share > 0.0 && *share <= 1.0);
    share.ok_or_else(|| "a number above 0 and up to 1 is needed".to_owned())
}
