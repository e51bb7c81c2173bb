//! The results folder that a command reads, and the rows of its table.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::options::{ResultsOption, UnitsOption};
use super::{changes, stored, study_keys};
use crate::input::expression::{Expression, Type, Variable};
use crate::input::units::{Dimension, DisplayUnits};
use crate::input::value::Value;
use crate::job::JobId;
use crate::job::id::common_prefix_length;
use crate::job::row::CellType;
use crate::job::status::Status;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::{self, Disk, Files};
use crate::platform::nearest::did_you_mean;
use crate::store::journal::Record;
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};
use crate::study::Study;

/// Which results a command reads.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct StudyArgs {
    /// Study file, or folder of its results [default: the only folder under results].
    pub study: Option<PathBuf>,
    /// Where the results are.
    #[command(flatten)]
    pub results: ResultsOption,
}

/// Results of a study, and their table.
pub struct Target {
    /// The folder.
    pub results: Results<'static>,
    /// The study whose questions it answers; `None` for results without one.
    pub study: Option<Study>,
    /// The table.
    pub table: Table,
    /// The units in which it is shown.
    pub units: DisplayUnits,
    /// Records of the journal.
    pub records: BTreeMap<JobId, Record>,
}

impl Target {
    /// Adds a column for every key of the study that these names, or those of a condition, name.
    ///
    /// # Errors
    /// A study.json that cannot be read.
    pub fn add_keys(&mut self, names: &[String], condition: Option<&str>) -> Result<()> {
        let mut names = names.to_vec();
        names.extend(study_keys::names_in(condition));
        study_keys::add_from(&self.results, &mut self.table, &self.units, &names)
    }
}

/// Opens the results that [`folder`] finds. Rows of jobs that have not run yet are pending. A message on
/// stderr says when the given study file, with its overrides `set`, differs from the study of the
/// results; its limits judge the rows where nothing else differs. The table is shown in the units of the given
/// study file, or in those of the results.
///
/// # Errors
/// When there are no results, or their table cannot be read; units that do not fit.
pub fn open(given: &StudyArgs, set: &[String], units: &UnitsOption) -> Result<Target> {
    let results = Results::new(&Disk, &folder(given, set)?);
    let journal = results.journal()?;
    stored::note_faults(&journal, &results);
    let stored_study = match results.owner()? {
        Some(_) => Some(Study::load(&results.study_path(), &[])?),
        None => None,
    };
    let other = match &stored_study {
        Some(study) => changes::other_limits(&results, study, given.study.as_deref(), set)?,
        None => None,
    };
    let table = match &other {
        Some(study) => Stored::read(results.clone())?.asked(study.clone()).table(),
        None => stored::table(&results, &journal)?,
    };
    let study = other.or(stored_study);
    changes::note_other_physics(&table);
    let display = match given.study.as_deref().filter(|path| path.is_file()) {
        Some(path) => Study::load(path, set)?.display_units().clone(),
        None => results.display_units()?,
    };
    let units = units.of_table(&table, &display)?;
    let table = table.shown_in(&units);
    Ok(Target { results, study, table, units, records: journal.records })
}

/// The results folder: the given folder, or the folder of the given study file, or the only folder under
/// `results`.
///
/// # Errors
/// [`Error::Disk`] or [`Error::Input`] when there is none, or several.
pub fn folder(given: &StudyArgs, set: &[String]) -> Result<PathBuf> {
    if let Some(results) = &given.results.results {
        return Ok(results.clone());
    }
    let Some(study) = &given.study else { return only_folder() };
    let under_results = Path::new("results").join(study);
    if study.is_dir() {
        let inside = results_in(study);
        if inside.is_empty() || is_results(study) {
            return Ok(study.clone());
        }
        let problem = "holds folders of results and is none itself";
        let names: Vec<String> = inside.iter().map(|path| path.display().to_string()).collect();
        let file = "results folder";
        let value = study.display().to_string();
        Err(Error::invalid_option(file, &value, problem, names.join(", "), "name one of these"))
    } else if !study.exists() && under_results.is_dir() {
        Ok(under_results)
    } else if !study.exists() {
        let near = files::nearest_name(study).or_else(|| {
            let near = PathBuf::from(files::nearest_name(&under_results)?);
            Some(near.file_name()?.to_string_lossy().into_owned())
        });
        let near = near.map_or_else(String::new, |near| format!("did you mean {near}? Otherwise "));
        Err(Error::Disk {
            path: study.clone(),
            problem: format!(
                "neither a study file nor a results folder\n  next: {near}name a study file, or its \
                 results folder"
            ),
        })
    } else {
        Ok(results_folder(&given.results, &Study::load(study, set)?))
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
            format!("billow table {job} --columns job,status lists the ids"),
        ));
    }
    folder(given, &[])
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

/// The column with that name, which `option` asks for.
///
/// # Errors
/// When there is none; the error gives the nearest name.
pub fn find<'a>(table: &'a Table, option: &str, name: &str) -> Result<&'a Column> {
    let names = || table.columns.iter().map(|column| column.name.as_str());
    table.column(name).ok_or_else(|| {
        let hint = did_you_mean(name, names());
        let allowed = names().collect::<Vec<_>>().join(", ");
        Error::invalid_option(option, name, "no such column", allowed, hint.unwrap_or_default())
    })
}

/// Rows for which the condition (`--where`) holds, in plan order.
///
/// # Errors
/// An invalid condition, or an unknown column in it.
pub fn filtered(table: &Table, condition: Option<&str>) -> Result<Vec<usize>> {
    let Some(text) = condition else { return Ok((0..table.rows()).collect()) };
    let variables: Vec<Variable> = table
        .columns
        .iter()
        .map(|column| Variable { name: column.name.clone(), kind: variable_type(table, column) })
        .collect();
    let condition = Expression::condition(text, &variables).map_err(|error| InputError {
        file: "--where".to_owned(),
        key: String::new(),
        value: String::new(),
        problem: error.to_string(),
        allowed: error.allowed,
        hint: String::new(),
    })?;
    let holds = |row: &usize| {
        let values: Vec<Value> =
            table.columns.iter().map(|column| column.cells[*row].clone()).collect();
        condition.holds(&values)
    };
    Ok((0..table.rows()).filter(holds).collect())
}

/// The type of a column in an expression.
fn variable_type(table: &Table, column: &Column) -> Type {
    match column.cell_type {
        CellType::Bool => Type::Bool,
        // A parameter holds the words of its study; another text may be one that no row has yet.
        CellType::Text if table.parameters().any(|known| known.name == column.name) => {
            let texts = column.cells.iter().filter_map(|cell| match cell {
                Value::Text(text) => Some(text.clone()),
                _ => None,
            });
            let words: BTreeSet<String> = texts.collect();
            Type::Text((!words.is_empty()).then(|| words.into_iter().collect()))
        }
        CellType::Text if column.name == "status" => {
            Type::Text(Some(Status::all().map(|status| status.name().to_owned()).collect()))
        }
        CellType::Text => Type::Text(None),
        CellType::Integer | CellType::Number => {
            let known = Dimension::ALL.into_iter().find(|known| known.si() == column.unit);
            Type::Quantity(known.unwrap_or(Dimension::Number), &[])
        }
    }
}

/// Rows of the jobs whose ids start with these prefixes (`--jobs`), in the order given: every point of
/// each job.
///
/// # Errors
/// A prefix of no job, or of several; the error gives the nearest ids.
pub fn jobs(table: &Table, prefixes: &[String]) -> Result<Vec<usize>> {
    let ids: Vec<&str> = table
        .column("job")
        .into_iter()
        .flat_map(|column| &column.cells)
        .map(|cell| if let Value::Text(id) = cell { id.as_str() } else { "" })
        .collect();
    let mut rows = Vec::with_capacity(prefixes.len());
    for prefix in prefixes.iter().map(|prefix| prefix.trim()) {
        let found: Vec<usize> =
            (0..ids.len()).filter(|row| ids[*row].starts_with(prefix)).collect();
        match table.one_row_per_job(&found).len() {
            1 => {
                let new: Vec<usize> = found.into_iter().filter(|row| !rows.contains(row)).collect();
                rows.extend(new);
            }
            several => {
                let problem = if several == 0 {
                    "no job id starts with this".to_owned()
                } else {
                    format!("{several} job ids start with this")
                };
                let hint = "billow table --columns job,status lists them";
                let allowed = nearest_ids(&ids, prefix);
                return Err(Error::invalid_option("--jobs", prefix, problem, allowed, hint));
            }
        }
    }
    Ok(rows)
}

/// Ids that share the longest prefix with this one, at most six.
fn nearest_ids(ids: &[&str], prefix: &str) -> String {
    const MAX_SHOWN: usize = 6;
    let shared = |id: &str| common_prefix_length(id, prefix);
    let longest = ids.iter().map(|id| shared(id)).max().unwrap_or(0);
    let mut nearest: Vec<&str> = ids
        .iter()
        .filter(|id| shared(id) == longest)
        .map(|id| id.get(..12).unwrap_or(id))
        .collect();
    nearest.sort_unstable();
    nearest.dedup();
    let more = if nearest.len() > MAX_SHOWN { ", …" } else { "" };
    format!("{}{more}", nearest[..nearest.len().min(MAX_SHOWN)].join(", "))
}
