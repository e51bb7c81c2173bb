//! Options that several commands share. A command includes only those that apply to it, below its own
//! options in `--help`.

use std::convert::Infallible;
use std::num::NonZero;
use std::path::PathBuf;

use crate::input::keys::{self, KEYS};
use crate::input::units::{DisplayUnit, DisplayUnits};
use crate::platform::error::{Error, Result};
use crate::print::Format;
use crate::run::progress::Loudness;
use crate::store::table::Table;

/// Heading of the shared options in `--help`.
pub const HEADING: &str = "Shared options";

/// A parameter on the command line, by the dotted path of its key or its last part: the name of its column.
pub fn parameter_name(text: &str) -> std::result::Result<String, Infallible> {
    Ok(keys::shortened(text.trim()).to_owned())
}

/// Where the results are.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ResultsOption {
    /// Folder of the results [default: `results/STUDY` under the current folder].
    #[arg(long, value_name = "DIR", help_heading = HEADING)]
    pub results: Option<PathBuf>,
}

/// Number of threads.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ThreadsOption {
    /// Number of threads [default: number of cores]. A job or a case runs on one thread; no result
    /// depends on this number.
    #[arg(long, value_name = "N", help_heading = HEADING)]
    pub threads: Option<usize>,
}

impl ThreadsOption {
    /// The number asked for; `None` for one thread per core.
    ///
    /// # Errors
    /// [`Error::Input`] for zero.
    pub fn count(&self) -> Result<Option<NonZero<usize>>> {
        let Some(threads) = self.threads else { return Ok(None) };
        let zero = || {
            let allowed = "1 or more; without --threads one thread per core";
            Error::invalid_option("--threads", "0", "zero threads cannot run a job", allowed, "")
        };
        Ok(Some(NonZero::new(threads).ok_or_else(zero)?))
    }

    /// A pool of this many threads.
    ///
    /// # Errors
    /// [`Error::Input`] for zero; [`Error::Disk`] when the system starts none.
    pub fn pool(&self) -> Result<rayon::ThreadPool> {
        let threads = self.count()?.map_or(0, NonZero::get);
        let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        built.map_err(|error| Error::Disk {
            path: "threads".into(),
            problem: format!("cannot start: {error}\n  next: use fewer with --threads N"),
        })
    }
}

/// Overrides of the study or scene file.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SetOption {
    /// Override a key of the study or scene file, for example --set film.thickness="30 um"; a value for a
    /// key that the study varies, as in --set N=6, replaces its axis, samples or range; a list, as in
    /// --set 'N=[5, 6]', is another axis or range; can be repeated.
    #[arg(long, value_name = "KEY=VALUE", help_heading = HEADING)]
    pub set: Vec<String>,
}

/// Units in which quantities are shown. Outputs for programs, csv and json, are SI.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct UnitsOption {
    /// Show every quantity in SI [default: parameters in the units of the study file].
    #[arg(long, help_heading = HEADING)]
    pub si: bool,
    /// Show these parameters and columns in these units, comma-separated, for example --units
    /// `t_90_z_rim=ms,mass_flow_rate=kg/h`.
    #[arg(long, value_name = "NAME=UNIT", value_delimiter = ',', help_heading = HEADING)]
    pub units: Vec<String>,
}

impl UnitsOption {
    /// The units of the study with the options applied. `si` gives the SI unit of a name that is shown.
    ///
    /// # Errors
    /// A name without a unit, an unknown name, a unit of another dimension.
    pub fn apply(
        &self,
        study: &DisplayUnits,
        si: &dyn Fn(&str) -> Option<String>,
    ) -> Result<DisplayUnits> {
        let mut units = if self.si { DisplayUnits::all_si() } else { study.clone() };
        for text in &self.units {
            let refuse = |problem: String| {
                let allowed = "NAME=UNIT, as in t_90_z_rim=ms";
                let hint = "billow table --columns all lists the columns";
                Error::invalid_option("--units", text, problem, allowed, hint)
            };
            let (name, symbol) =
                text.split_once('=').ok_or_else(|| refuse("has no `=`".to_owned()))?;
            let name = name.trim();
            let key = keys::find(name);
            let name = keys::shortened(name);
            let of_key = || key.map(|index| KEYS[index].unit().to_owned());
            let si = si(name).or_else(of_key);
            let si = si.ok_or_else(|| refuse("names no parameter and no column".to_owned()))?;
            DisplayUnit::new(symbol, &si).map_err(refuse)?;
            units.set(name, symbol);
        }
        Ok(units)
    }

    /// The units in which a table is shown: those of the study with the options applied.
    ///
    /// # Errors
    /// As [`Self::apply`].
    pub fn of_table(&self, table: &Table, study: &DisplayUnits) -> Result<DisplayUnits> {
        self.apply(study, &|name| table.column(name).map(|column| column.unit.clone()))
    }
}

/// Format of the output.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct OutputOptions {
    /// Same as --format json.
    #[arg(long, conflicts_with = "format", help_heading = HEADING)]
    pub json: bool,
    /// Format of the output [default: table; for `solve` json].
    #[arg(long, value_enum, help_heading = HEADING)]
    pub format: Option<Format>,
}

impl OutputOptions {
    /// The format asked for, `default` otherwise.
    pub fn format_or(&self, default: Format) -> Format {
        if self.json { Format::Json } else { self.format.unwrap_or(default) }
    }

    /// The format asked for, a table otherwise.
    pub fn format(&self) -> Format {
        self.format_or(Format::Table)
    }
}

/// Whether notes are printed.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct QuietOption {
    /// Print no progress and no notes.
    #[arg(short, long, help_heading = HEADING)]
    pub quiet: bool,
}

/// How much progress is printed.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ProgressOptions {
    /// Print no progress and no notes.
    #[arg(short, long, conflicts_with = "verbose", help_heading = HEADING)]
    pub quiet: bool,
    /// Print more progress.
    #[arg(short, long, help_heading = HEADING)]
    pub verbose: bool,
}

impl ProgressOptions {
    /// The loudness of the progress reporter.
    pub fn loudness(&self) -> Loudness {
        match (self.quiet, self.verbose) {
            (true, _) => Loudness::Quiet,
            (_, true) => Loudness::Verbose,
            _ => Loudness::Normal,
        }
    }
}
