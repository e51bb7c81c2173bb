//! `billow export`: writes all results of a study into one file, or the film of a job as a deck, for other programs.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::options::{OutputOptions, ResultsOption};
use super::results::{self, StudyArgs};
use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::print::print_rows;
use crate::store::cube::{self, Written};

mod deck;

/// Extensions of the file.
const EXTENSIONS: [&str; 2] = ["nc", "h5"];

/// Arguments of `billow export`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// With --deck the job: the first digits of its id. Else the study.
    #[arg(value_name = "JOB|STUDY")]
    pub of: Option<String>,
    /// Study file, or folder of its results [default: the only folder under results].
    pub study: Option<String>,
    #[command(flatten)]
    results: ResultsOption,
    /// Write the cube of the study: every history over points and time, and every column of the table over
    /// the points, as one file that xarray opens (netCDF-4 in HDF5). FILE ends in .nc or .h5.
    #[arg(long, value_name = "FILE", required_unless_present = "deck")]
    pub out: Option<PathBuf>,
    /// Only these columns of the histories, comma-separated [default: all].
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',', conflicts_with = "deck")]
    pub columns: Vec<String>,
    /// Write the stowed film of a job as the input of another explicit finite element code, in kg, m, s: `radioss DIR`
    /// writes two files into a folder, `dyna FILE.k` one for LS-DYNA. What it leaves out is said in its first lines.
    #[arg(long, value_names = ["CODE", "PATH"], num_args = 2, conflicts_with = "out")]
    pub deck: Option<Vec<String>>,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs `billow export`: prints one row for each file.
///
/// # Errors
/// As [`cube::write`]; a file name with another extension; a job that has no deck.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    match (&args.deck, &args.out) {
        (Some(of), _) => deck::write(args, of, out),
        (None, Some(path)) => cubes(args, path, out),
        (None, None) => unreachable!("clap asks for one of them"),
    }
}

fn study(args: &Args, path: Option<&String>) -> StudyArgs {
    StudyArgs { study: path.map(PathBuf::from), results: args.results.clone() }
}

fn cubes(args: &Args, path: &Path, out: &mut dyn Write) -> Result<()> {
    check_extension(path)?;
    if let Some(second) = &args.study {
        let allowed = "one study; a job with --deck";
        return Err(Error::invalid_option("STUDY", second, "a second argument", allowed, ""));
    }
    let stored = results::read(&results::folder(&study(args, args.of.as_ref()))?)?;
    let written = cube::write(&stored, &args.columns, path)?;
    let Written { points, times, variables, histories } = written;
    let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
    let mut row = vec![Value::Text(path.display().to_string())];
    row.extend([points, times, variables, histories].map(number));
    let names = ["file", "points", "times", "variables", "histories"];
    print_rows(&names, &[row], args.output.format(), out)
}

fn check_extension(path: &Path) -> Result<()> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    if extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str())) {
        return Ok(());
    }
    let value = path.display().to_string();
    let allowed = "a file name that ends in .nc or .h5";
    Err(Error::invalid_option("--out", &value, "not a format of cubes", allowed, ""))
}
