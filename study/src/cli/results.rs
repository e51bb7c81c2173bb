//! Opens the results of a study: the one way for every command.

use std::path::{Path, PathBuf};

use super::changes;
use super::options::{ResultsOption, SetOption, UnitsOption};
use crate::input::expression;
use crate::input::units::DisplayUnits;
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, Disk, Files};
use crate::platform::quote;
use crate::print::count;
use crate::store::journal::Fault;
use crate::store::results::Results;
use crate::store::stored::{Stored, other_physics};
use crate::store::table::{Column, ColumnCells, Table};
use crate::study::{Study, StudyKey};

/// Journal lines that are named, at most.
const MAX_SHOWN: usize = 3;

/// Which results a command reads.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct StudyArgs {
    /// Study file, or folder of its results [default: the only folder under results].
    pub study: Option<PathBuf>,
    /// Where the results are.
    #[command(flatten)]
    pub results: ResultsOption,
}

/// Results of a study, and their table in the units to show.
pub struct Opened {
    /// Study, plan and records.
    pub stored: Stored<'static>,
    /// One row for each run.
    pub table: Table,
}

/// Opens the results that [`folder`] finds, with the table of [`Stored::first_rows`]. Jobs that have not run yet are
/// pending rows. The limits and units of a given study file hold; a message on stderr says in which keys it differs else.
///
/// # Errors
/// When there are no results, or they cannot be read; units that do not fit.
pub fn open(
    given: &StudyArgs,
    set: &[String],
    units: &UnitsOption,
    rows: Option<usize>,
) -> Result<Opened> {
    let (root, asked) = locate(given, set)?;
    let mut stored = read(&root)?;
    if let (Some(asked), Some(path)) = (asked, &given.study) {
        let units = asked.display_units().clone();
        if let Some(study) = changes::other_limits(&stored, asked, path)? {
            let finished = |of: &Stored<'_>| {
                of.points.iter().filter(|point| of.record(&point.job.id).is_some()).count()
            };
            let all = finished(&stored);
            stored = stored.asked(study);
            let hidden = all.saturating_sub(finished(&stored));
            if hidden > 0 {
                let runs = count(hidden, "finished run");
                eprintln!("note: {runs} of the last run answered other limits and are not shown");
            }
        }
        stored.units = units;
    }
    let versions = other_physics(&stored.points, &stored.journal.records);
    if let Some(note) = changes::other_physics(&versions) {
        eprintln!("note: {note}");
    }
    let table = stored.first_rows(rows);
    stored.units = units.of_table(&table, &stored.units)?;
    let table = table.shown_in(&stored.units);
    Ok(Opened { stored, table })
}

impl Opened {
    /// Adds a column for every key of the study that these names, or those of a condition, name.
    pub fn add_keys(&mut self, names: &[String], condition: Option<&str>) {
        let Self { stored, table } = self;
        add_keys(&stored.study, table, &stored.units, names, condition);
    }
}

/// The study to run, and its results folder: of a study file, or of a results folder or its study.json.
///
/// # Errors
/// An invalid study file; [`Error::Disk`] for a damaged study.json.
pub fn study_of(path: &Path, set: &SetOption, option: &ResultsOption) -> Result<(Study, PathBuf)> {
    let is_stored = path.file_name().is_some_and(|name| name == "study.json");
    let folder = if path.is_dir() { Some(path) } else { path.parent().filter(|_| is_stored) };
    if let Some(folder) = folder {
        let results = Results::new(&Disk, folder);
        if results.journal_path().is_dir() && results.owner()?.is_some() {
            let study = Study::load(&results.study_path(), &set.set)?;
            return Ok((study, option.results.clone().unwrap_or_else(|| folder.to_owned())));
        }
    }
    let study = Study::load(path, &set.set)?;
    let root = results_folder(option, &study);
    Ok((study, root))
}

/// Reads a results folder. Says on stderr what of it is damaged.
///
/// # Errors
/// As [`Stored::read`].
pub fn read(root: &Path) -> Result<Stored<'static>> {
    let stored = Stored::read(Results::new(&Disk, root))?;
    note_faults(&stored);
    Ok(stored)
}

/// Names the lines of the journal that are not valid. A torn last line is what a running process writes.
fn note_faults(stored: &Stored<'_>) {
    let Stored { journal, results, .. } = stored;
    let running = results.is_running().unwrap_or(false);
    let shown: Vec<&Fault> =
        journal.faults.iter().filter(|fault| !(fault.torn && running)).collect();
    let mut faults = shown.iter();
    for fault in faults.by_ref().take(MAX_SHOWN) {
        eprintln!("billow: damaged: {fault}");
    }
    let more = faults.count();
    if more > 0 {
        eprintln!("billow: damaged: {more} more lines of the journal");
    }
    let root = quote::path(results.root());
    if journal.is_empty() && results.table_path().exists() {
        eprintln!(
            "billow: {root}: no journal: no job counts as finished\n  next: billow doctor {root}"
        );
    }
    if !shown.is_empty() {
        eprintln!(
            "  next: run `billow run` of the study: it runs these jobs again; `billow doctor {root}`"
        );
    }
}

/// The results folder: the given folder, or the folder of the given study file, or the only folder under
/// `results`.
///
/// # Errors
/// [`Error::Disk`] or [`Error::Input`] when there is none, or several.
pub fn folder(given: &StudyArgs) -> Result<PathBuf> {
    Ok(locate(given, &[])?.0)
}

/// The results folder, and the study of the file that is given, with its overrides.
fn locate(given: &StudyArgs, set: &[String]) -> Result<(PathBuf, Option<Study>)> {
    let file = given.study.as_deref().filter(|path| path.is_file());
    let study = file.map(|path| Study::load(path, set)).transpose()?;
    let root = match (&given.results.results, &study) {
        (Some(root), _) => root.clone(),
        (None, Some(study)) => results_folder(&given.results, study),
        (None, None) => folder_of(given.study.as_deref())?,
    };
    if let Some(study) = &study {
        changes::find_elsewhere(&Results::new(&Disk, &root), study)?;
    }
    Ok((root, study))
}

/// The results folder of this name, or the only one.
fn folder_of(study: Option<&Path>) -> Result<PathBuf> {
    let Some(study) = study else { return only_folder() };
    let under_results = Path::new("results").join(study);
    if study.is_dir() {
        let inside = results_in(study);
        if inside.is_empty() || is_results(study) {
            return Ok(study.to_owned());
        }
        let problem = "holds folders of results and is none itself";
        let names: Vec<String> = inside.iter().map(|path| path.display().to_string()).collect();
        let file = "results folder";
        let value = study.display().to_string();
        Err(Error::invalid_option(file, &value, problem, names.join(", "), "name one of these"))
    } else if under_results.is_dir() {
        Ok(under_results)
    } else {
        let near = files::nearest_name(study).or_else(|| {
            let near = PathBuf::from(files::nearest_name(&under_results)?);
            Some(near.file_name()?.to_string_lossy().into_owned())
        });
        let near = near.map_or_else(String::new, |near| format!("did you mean {near}? Otherwise "));
        Err(Error::Disk {
            path: study.to_owned(),
            problem: format!(
                "neither a study file nor a results folder\n  next: {near}name a study file, or its \
                 results folder"
            ),
        })
    }
}

/// The results folder of a study: the one asked for, or `results/STUDY`.
pub fn results_folder(option: &ResultsOption, study: &Study) -> PathBuf {
    option.results.clone().unwrap_or_else(|| Path::new("results").join(&study.name))
}

/// The results folder that holds a job, for commands whose first argument is a job.
///
/// # Errors
/// As [`folder`]; and when the job argument names results.
pub fn folder_of_job(job: &str, given: &StudyArgs) -> Result<PathBuf> {
    let path = Path::new(job);
    let is_results = path.is_dir() || Path::new("results").join(path).is_dir();
    if given.study.is_none() && (is_results || path.is_file()) && !job.is_empty() {
        return Err(Error::invalid_option(
            "job",
            job,
            "is a results folder or study file, not a job",
            "the first digits of a job id, then the results",
            format!("billow table {job} --runs --columns job,status lists the ids"),
        ));
    }
    folder(given)
}

/// Whether a folder is that of a study's results.
fn is_results(path: &Path) -> bool {
    path.join("summary.parquet").is_file() || path.join("study.json").is_file()
}

/// The results folders in a folder.
fn results_in(folder: &Path) -> Vec<PathBuf> {
    let mut folders = Disk.list(folder).unwrap_or_default();
    folders.retain(|path| is_results(path));
    folders
}

fn only_folder() -> Result<PathBuf> {
    let results = Path::new("results");
    let folders = results_in(results);
    match folders.as_slice() {
        [only] => Ok(only.clone()),
        [] => {
            let problem = "no results under the current folder";
            let allowed = "a study file, or a results folder";
            Err(Error::invalid_option(
                "results",
                "",
                problem,
                allowed,
                "run `billow run STUDY`, or name one",
            ))
        }
        several => {
            let names: Vec<String> =
                several.iter().map(|path| path.display().to_string()).collect();
            let problem = "results of several studies under the current folder";
            Err(Error::invalid_option("results", "", problem, names.join(", "), "name one"))
        }
    }
}

/// Adds a column for every key of the study that `names`, or those of a condition, name and the table does not have:
/// `film.loss_factor`, `design.N`. A key that the study does not vary has one value in every row.
pub fn add_keys(
    study: &Study,
    table: &mut Table,
    units: &DisplayUnits,
    names: &[String],
    condition: Option<&str>,
) {
    for name in names.iter().chain(&condition.map(expression::names).unwrap_or_default()) {
        if table.column(name).is_some() {
            continue;
        }
        let Some(key) = study.key(name) else { continue };
        let column = match table.parameters().find(|column| column.name == key.name) {
            Some(parameter) => Column { name: name.clone(), ..parameter.clone() },
            None => constant(name, key, table.rows(), units),
        };
        table.columns.push(column);
    }
}

/// A column with the same value in every row.
fn constant(name: &str, key: StudyKey, rows: usize, units: &DisplayUnits) -> Column {
    let unit = key.key.unit();
    Column {
        name: name.to_owned(),
        cell_type: match key.value {
            Value::Bool(_) => CellType::Bool,
            Value::Integer(_) => CellType::Integer,
            Value::Number(_) => CellType::Number,
            Value::Null if !unit.is_empty() => CellType::Number,
            Value::Null | Value::Text(_) => CellType::Text,
        },
        unit: unit.to_owned(),
        shown: units.of(&key.name, unit),
        meaning: key.key.doc.to_owned(),
        cells: ColumnCells::Same(key.value, rows),
    }
}
