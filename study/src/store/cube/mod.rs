//! The cube of a study: every history and every result in one HDF5 file, as arrays over points and time. The layout
//! is that of netCDF-4 (dimension scales), so that `xarray.open_dataset(path, engine="h5netcdf")` opens it.
//!
//! ```text
//! /            format, version, program_version, commit, physics_version, study_name, question,
//!              study (the text of study.json), complete (written last)
//! /point       row of the summary table, a dimension scale              [point]
//! /time        s, a dimension scale                                     [time]
//! /N, …        parameters: coordinates of the points                    [point]
//! /status, …   columns of the summary table: f64, or texts              [point]
//! /z_rim, …    columns of the histories: f64                            [point, time]
//! ```
//!
//! - Every variable has `units` (SI, powers as in "m^3"; "1" for a pure number, empty for a text) and `long_name`; its attribute
//!   `coordinates` names the parameters. `set_index(point=["N", …]).unstack("point")` of xarray gives arrays over the
//!   axes of a grid.
//! - The time axis is the union of the sample times of all jobs. Only done jobs have values over time. Other points,
//!   and times after the end of a job, are NaN; a result that a point does not have is NaN or an empty text; `status`
//!   says why. True is 1, false 0.
//! - A name that a parameter has already ends in `_history` for a column of the histories, and in `_of_job` for a
//!   column of the table that the histories, or a parameter, have as well.
//!
//! The file is written job by job: memory holds one history, one column of the table, and the chunks that HDF5
//! has not written yet.

use std::collections::BTreeSet;
use std::path::Path;

use crate::input::value::Value;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, disk_error};
use crate::platform::nearest::did_you_mean;
use crate::store::history_file::StoredHistory;
use crate::store::stored::Stored;
use crate::store::table::Table;

mod file;

use file::{CubeFile, Variable};

/// Largest number of values over time, 16 GiB. Chosen: one file that a workstation still handles; 100,000
/// jobs of 700 samples have as many with all columns.
const MAX_VALUES: u128 = 1 << 31;
/// Times whose relative difference is smaller are one: a product of interval and number may differ from the end time in
/// its last bit.
const SAME_TIME: f64 = 1e-9;

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// Number of points.
    pub points: usize,
    /// Number of times.
    pub times: usize,
    /// Number of variables, without the coordinates.
    pub variables: usize,
    /// Number of points that have a history.
    pub histories: usize,
}

/// Writes the cube of a study. `columns` names the columns of the histories; all of them if it is empty.
///
/// # Errors
/// [`Error::Input`] for an unknown column, and for a cube that is too large; [`Error::Disk`] without a done job, for a
/// history that cannot be read, and for a file that cannot be written. The file is complete or not written at all.
pub fn write(stored: &Stored<'_>, columns: &[String], path: &Path) -> Result<Written> {
    let table = stored.table();
    let done = done(stored, &table)?;
    let series = Series::of(stored, &done, columns)?;
    check_size(table.rows(), &series)?;
    let study_path = stored.results.study_path();
    let disk = stored.results.files();
    let study = disk.read(&study_path).map_err(|error| disk_error(&study_path, &error))?;
    let study = String::from_utf8_lossy(&study);
    let variables = files::build_output(disk, path, &mut |temporary| {
        let cube = CubeFile::create(temporary, path, table.rows(), &series.times)?;
        cube.describe(stored, &study)?;
        build(cube, stored, &table, &series, &done)
    })?;
    let times = series.times.len();
    Ok(Written { points: table.rows(), times, variables, histories: done.len() })
}

/// The rows of done jobs.
fn done(stored: &Stored<'_>, table: &Table) -> Result<Vec<(usize, JobId)>> {
    let of_row = |(row, id): (usize, &Value)| match id {
        Value::Text(id) if table.status(row) == Some(Status::Done) => {
            Some((row, JobId::from_digits(id)?))
        }
        _ => None,
    };
    let ids = table.column("job").into_iter().flat_map(|column| column.cells.iter());
    let done: Vec<(usize, JobId)> = ids.enumerate().filter_map(of_row).collect();
    if done.is_empty() {
        let path = stored.results.root().to_owned();
        let problem = "no job is done, so there is no history to export\n  next: run `billow run` of the study";
        return Err(Error::Disk { path, problem: problem.to_owned() });
    }
    Ok(done)
}

/// Refuses a cube with too many values.
fn check_size(points: usize, series: &Series) -> Result<()> {
    let (times, columns) = (series.times.len(), series.columns.len());
    let values = [points, times, columns].iter().map(|length| *length as u128).product();
    if values <= MAX_VALUES {
        return Ok(());
    }
    let gibibytes = |values: u128| (values * 8).div_ceil(1 << 30);
    Err(Error::invalid_option(
        "--out",
        "",
        format!(
            "would hold {values} values over time ({} GiB): {points} points, {times} times, {columns} columns",
            gibibytes(values)
        ),
        format!("up to {MAX_VALUES} values ({} GiB)", gibibytes(MAX_VALUES)),
        "choose columns with --columns z_rim,pressure; a study with a larger outputs.sample_interval has a smaller cube",
    ))
}

/// Fills the file. Returns the number of variables.
fn build(
    mut cube: CubeFile,
    stored: &Stored<'_>,
    table: &Table,
    series: &Series,
    done: &[(usize, JobId)],
) -> Result<usize> {
    let mut names = BTreeSet::from(["point".to_owned(), "time".to_owned()]);
    for column in table.parameters() {
        cube.coordinate(&unused(&mut names, &column.name, "_parameter"), column)?;
    }
    for variable in &series.columns {
        cube.over_time(&unused(&mut names, &variable.name, "_history"), variable)?;
    }
    let parameters = table.parameters().count();
    let is_result = |index: usize| index == 0 || index > parameters;
    let mut results = 0;
    for (_, column) in table.columns.iter().enumerate().filter(|(index, _)| is_result(*index)) {
        cube.over_points(&unused(&mut names, &column.name, "_of_job"), column)?;
        results += 1;
    }
    for (row, id) in done {
        let history = stored.results.read_history(id, stored.record(id))?;
        let times = history.history.column("time");
        for (number, column) in series.columns.iter().enumerate() {
            let mut found = columns_of(&history).filter(|(name, ..)| *name == column.name);
            if let Some((.., values)) = found.next() {
                cube.write(number, *row, &series.placed(times, values))?;
            }
        }
    }
    cube.finish()?;
    Ok(series.columns.len() + results)
}

/// A name that no variable has: this one, or the same with an ending. HDF5 takes a slash for a path.
fn unused(names: &mut BTreeSet<String>, name: &str, ending: &str) -> String {
    let mut name = name.replace('/', "_");
    while !names.insert(name.clone()) {
        name.push_str(ending);
    }
    name
}

/// The columns of a history but `time`: name, unit, meaning and values.
fn columns_of(stored: &StoredHistory) -> impl Iterator<Item = (&str, &str, &str, &[f64])> {
    let columns = stored
        .history
        .iter()
        .map(|(column, values)| (column.name, column.unit, column.meaning, values));
    let tracks = stored.tracks.iter().map(|(name, values)| {
        let label = stored.labels.get(name);
        let (unit, meaning) = label.map_or(("", ""), |(unit, meaning)| (unit, meaning));
        (name.as_str(), unit, meaning, values.as_slice())
    });
    columns.chain(tracks).filter(|(name, ..)| *name != "time")
}

/// Time axis and columns of the histories.
struct Series {
    /// Times, s, ascending.
    times: Vec<f64>,
    /// The chosen columns.
    columns: Vec<Variable>,
}

impl Series {
    /// Those of some jobs; `wanted` names the columns, all of them if it is empty.
    fn of(stored: &Stored<'_>, done: &[(usize, JobId)], wanted: &[String]) -> Result<Self> {
        let (mut times, mut columns) = (Vec::new(), Vec::<Variable>::new());
        for (_, id) in done {
            let history = stored.results.read_history(id, stored.record(id))?;
            times = union(&times, history.history.column("time"));
            for (name, unit, meaning, _) in columns_of(&history) {
                if !columns.iter().any(|known| known.name == name) {
                    let [name, unit, meaning] = [name, unit, meaning].map(str::to_owned);
                    columns.push(Variable { name, unit, meaning });
                }
            }
        }
        Ok(Self { times, columns: chosen(columns, wanted)? })
    }

    /// The values of a job on the time axis: NaN where it has no sample.
    fn placed(&self, times: &[f64], values: &[f64]) -> Vec<f64> {
        let mut placed = vec![f64::NAN; self.times.len()];
        let mut next = 0;
        for (time, value) in times.iter().zip(values) {
            while self.times.get(next).is_some_and(|known| is_later(*time, *known)) {
                next += 1;
            }
            if let Some(place) = placed.get_mut(next) {
                *place = *value;
            }
        }
        placed
    }
}

/// Whether a time is later than another one, and not the same.
fn is_later(time: f64, other: f64) -> bool {
    time - other > SAME_TIME * time.abs()
}

/// All times of two ascending lists.
fn union(known: &[f64], new: &[f64]) -> Vec<f64> {
    if known == new {
        return known.to_vec();
    }
    let mut all = [known, new].concat();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|time, before| !is_later(*time, *before));
    all
}

/// The columns that are asked for, in the order asked for.
fn chosen(columns: Vec<Variable>, wanted: &[String]) -> Result<Vec<Variable>> {
    if wanted.is_empty() {
        return Ok(columns);
    }
    let mut found: Vec<Variable> = Vec::with_capacity(wanted.len());
    for name in wanted.iter().map(|name| name.trim()) {
        let names = || columns.iter().map(|column| column.name.as_str());
        let column = columns.iter().find(|column| column.name == name).ok_or_else(|| {
            Error::invalid_option(
                "--columns",
                name,
                "no history has this column",
                names().collect::<Vec<_>>().join(", "),
                did_you_mean(name, names()).unwrap_or_default(),
            )
        })?;
        if !found.contains(column) {
            found.push(column.clone());
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests;
