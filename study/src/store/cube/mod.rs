//! The cube of a study: every history and every result in one HDF5 file, as arrays over the axes of its
//! grid and time. The layout is that of netCDF-4 (dimension scales), so that
//! `xarray.open_dataset(path, engine="h5netcdf")` opens it.
//!
//! ```text
//! /            format, version, program_version, commit, physics_version, study_name, question,
//!              study (the text of study.json), complete (written last)
//! /N, …        axes of the grid: numbers or texts, dimension scales     [step]
//! /time        s, a dimension scale                                     [time]
//! /z_rim, …    columns of the histories: f64                            [axes of the grid, time]
//! /status, …   columns of the summary table: f64, or texts              [axes of the grid]
//! ```
//!
//! - Every variable has `units` (SI; "1" for a pure number, empty for a text) and `long_name`. Parameters of one
//!   group of `zip` share a dimension; the attribute `coordinates` of a variable names those that are no scale.
//! - A study whose points are no product of axes ([`NoProduct`]) has one dimension `point`.
//! - Only done jobs have values over time. Other points, and times after the end of a job, are NaN; a result
//!   that a point does not have is NaN or an empty text. `status` says why, [`NOT_PLANNED`] where a filter
//!   removes the point. True is 1, false 0.
//! - A name that a parameter has already ends in `OF_HISTORY` for a column of the histories, and in
//!   `OF_JOB` for a column of the table that the histories, or a parameter, have as well.
//!
//! The file is written job by job: memory holds one history, one column of the table, and the chunks that HDF5
//! has not written yet.

use std::collections::BTreeSet;
use std::path::Path;

use crate::input::value::Value;
use crate::job::row::{CellType, ColumnId};
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, disk_error};
use crate::store::history_file::StoredHistory;
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};
use crate::study::NoProduct;

mod file;
mod layout;
mod series;
mod values;

use file::{CubeFile, Variable};
use layout::Layout;
use series::Series;
use values::{Values, link_name};

/// Name of the format, in the attribute `format`.
const FORMAT: &str = "billow-cube";
/// Version of the format.
const VERSION: u32 = 1;
/// Status of a combination of values that the filter of the study removes.
pub const NOT_PLANNED: &str = "not planned";
/// End of the name of a history column whose name a parameter has.
const OF_HISTORY: &str = "_history";
/// End of the name of a column of the table whose name a history column or a parameter has.
const OF_JOB: &str = "_of_job";
/// Largest number of values over time, 16 GiB. Chosen: one file that a workstation still handles; 100,000
/// jobs of 700 samples have as many with all columns.
const MAX_VALUES: u128 = 1 << 31;
/// Name of the time axis.
const TIME: &str = "time";

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// Name and length of each dimension, time last.
    pub dimensions: Vec<(String, usize)>,
    /// Number of variables, without the coordinates.
    pub variables: usize,
    /// Number of jobs whose histories it holds.
    pub jobs: usize,
    /// Why its points are no product of axes; `None` for a grid.
    pub no_product: Option<NoProduct>,
}

/// A done job, and where its values are.
struct Done {
    /// Position in the arrays, the last axis fastest.
    position: usize,
    id: JobId,
}

/// Writes the cube of a study. `columns` names the columns of the histories; all of them if it is empty.
///
/// # Errors
/// [`Error::Input`] for an unknown column, for jobs of different sample intervals, and for a cube that is too
/// large; [`Error::Disk`] without a done job, for a history that cannot be read, and for a file that cannot
/// be written. The file is complete or not written at all.
pub fn write(stored: &Stored<'_>, columns: &[String], path: &Path) -> Result<Written> {
    let table = stored.table();
    let layout = Layout::of(&stored.study, &table)?;
    let done = done(stored, &table, &layout)?;
    let series = Series::of(stored, &done, columns)?;
    check_size(&layout, &series)?;
    let study_path = stored.results.study_path();
    let disk = stored.results.files();
    let study = disk.read(&study_path).map_err(|error| disk_error(&study_path, &error))?;
    let study = String::from_utf8_lossy(&study);
    let variables = files::build_output(disk, path, &mut |temporary| {
        let cube = CubeFile::create(temporary, path)?;
        build(cube, stored, &study, &table, &layout, &series, &done)
    })?;
    let mut dimensions: Vec<(String, usize)> = layout.dimensions.clone();
    dimensions.push((TIME.to_owned(), series.times.len()));
    Ok(Written { dimensions, variables, jobs: done.len(), no_product: layout.no_product })
}

/// The done jobs in the order of their positions.
fn done(stored: &Stored<'_>, table: &Table, layout: &Layout) -> Result<Vec<Done>> {
    let jobs = table.column("job");
    let mut done = Vec::new();
    for (row, position) in layout.positions.iter().enumerate() {
        if table.status(row) == Some(Status::Done)
            && let Some(Value::Text(id)) = jobs.map(|column| &column.cells[row])
            && let Some(id) = JobId::from_digits(id)
        {
            done.push(Done { position: *position, id });
        }
    }
    if done.is_empty() {
        let root = stored.results.root();
        let problem = "no job is done, so there is no history to export\n  next: run `billow run` of the study";
        return Err(Error::Disk { path: root.to_owned(), problem: problem.to_owned() });
    }
    done.sort_by_key(|done| done.position);
    done.dedup_by_key(|done| done.position);
    Ok(done)
}

/// Refuses a cube with too many values.
fn check_size(layout: &Layout, series: &Series) -> Result<()> {
    let lengths = [layout.size(), series.times.len(), series.columns.len()];
    let values: u128 = lengths.iter().map(|length| *length as u128).product();
    if values <= MAX_VALUES {
        return Ok(());
    }
    let gibibytes = |values: u128| (values * 8).div_ceil(1 << 30);
    let [points, times, columns] = lengths;
    Err(Error::invalid_option(
        "--out",
        "",
        format!(
            "would hold {values} values over time ({} GiB): {points} points, {times} times, {columns} columns",
            gibibytes(values)
        ),
        format!("up to {MAX_VALUES} values ({} GiB)", gibibytes(MAX_VALUES)),
        "choose columns with --columns z_rim,pressure; a study with a larger outputs.sample_interval, or with fewer \
         values on its axes, has a smaller cube",
    ))
}

/// Fills the file. Returns the number of variables.
fn build(
    mut cube: CubeFile,
    stored: &Stored<'_>,
    study: &str,
    table: &Table,
    layout: &Layout,
    series: &Series,
    done: &[Done],
) -> Result<usize> {
    cube.describe(stored, study)?;
    let mut names: BTreeSet<String> = BTreeSet::from([TIME.to_owned()]);
    for (name, length) in &layout.dimensions {
        cube.dimension(name, *length);
    }
    for coordinate in &layout.coordinates {
        names.insert(coordinate.name.clone());
        cube.coordinate(coordinate)?;
    }
    cube.time(&series.times)?;
    let mut over_time = Vec::with_capacity(series.columns.len());
    for column in &series.columns {
        let name = unused(&mut names, &column.name, OF_HISTORY);
        over_time.push(cube.over_time(&Variable {
            name: &name,
            unit: &column.unit,
            meaning: &column.meaning,
        })?);
    }
    let variables = results(table).map(|column| {
        let name = unused(&mut names, &column.name, OF_JOB);
        cube.over_grid(
            &Variable { name: &name, unit: &column.unit, meaning: &column.meaning },
            &cells(column, layout),
        )
    });
    let results = variables.collect::<Result<Vec<()>>>()?.len();
    for Done { position, id } in done {
        let history = stored.results.read_history(id, stored.record(id))?;
        for (column, dataset) in series.columns.iter().zip(&over_time) {
            if let Some(values) = column_of(&history, &column.name) {
                let times = history.history.column("time");
                let placed = series.placed(times, values);
                cube.write(*dataset, *position, &placed)?;
            }
        }
    }
    cube.finish()?;
    Ok(over_time.len() + results)
}

/// A name that no variable has: this one, or the same with an ending.
fn unused(names: &mut BTreeSet<String>, name: &str, ending: &str) -> String {
    let mut name = link_name(name);
    while !names.insert(name.clone()) {
        name.push_str(ending);
    }
    name
}

/// The columns of the table that are no parameters.
fn results(table: &Table) -> impl Iterator<Item = &Column> {
    let parameters = table.parameters().count();
    let is_parameter = move |index: usize| (1..=parameters).contains(&index);
    let all = table.columns.iter().enumerate();
    all.filter(move |(index, _)| !is_parameter(*index)).map(|(_, column)| column)
}

/// The cells of a column, by position.
fn cells(column: &Column, layout: &Layout) -> Values {
    let missing = if column.name == ColumnId::Status.name() {
        Value::Text(NOT_PLANNED.to_owned())
    } else {
        Value::Null
    };
    let mut cells = vec![&missing; layout.size()];
    for (row, position) in layout.positions.iter().enumerate() {
        cells[*position] = &column.cells[row];
    }
    match column.cell_type {
        CellType::Text => Values::texts(&cells),
        CellType::Bool | CellType::Integer | CellType::Number => Values::numbers(&cells),
    }
}

/// The values of a history column; `None` for a history without it.
fn column_of<'a>(stored: &'a StoredHistory, name: &str) -> Option<&'a [f64]> {
    let found = stored.history.iter().find(|(column, _)| column.name == name);
    let track = || stored.tracks.get(name).map(Vec::as_slice);
    found.map(|(_, values)| values).or_else(track)
}

#[cfg(test)]
mod tests;
