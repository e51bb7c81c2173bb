//! `billow export`: writes all results of a study into one file, for other programs.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::options::OutputOptions;
use super::results::{self, StudyArgs};
use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::print::print_rows;
use crate::store::cube::{self, Written};

/// Extensions of the file.
const EXTENSIONS: [&str; 2] = ["nc", "h5"];

/// Arguments of `billow export`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Write the cube of the study: every history over points and time, and every column of the table over
    /// the points, as one file that xarray opens (netCDF-4 in HDF5). FILE ends in .nc or .h5.
    #[arg(long, value_name = "FILE", required = true)]
    pub out: PathBuf,
    /// Only these columns of the histories, comma-separated [default: all].
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',')]
    pub columns: Vec<String>,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs `billow export`: prints one row for the file.
///
/// # Errors
/// As [`cube::write`]; a file name with another extension.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    check_extension(&args.out)?;
    let stored = results::read(&results::folder(&args.study)?)?;
    let written = cube::write(&stored, &args.columns, &args.out)?;
    let Written { points, times, variables, histories } = written;
    let number = |number: usize| Value::Integer(i64::try_from(number).unwrap_or(i64::MAX));
    let mut row = vec![Value::Text(args.out.display().to_string())];
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
