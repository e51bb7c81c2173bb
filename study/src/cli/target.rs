//! Which results a command means, and which rows of their table.

use std::path::{Path, PathBuf};

use super::Global;
use super::run::results_folder;
use crate::input::expression::{Expression, Type, Variable};
use crate::input::keys;
use crate::input::units::Dimension;
use crate::input::value::Value;
use crate::job::id::common_prefix_length;
use crate::job::row::{CellType, RENAMED_TABLE_COLUMNS, current_column_name, note};
use crate::job::status::RENAMED_STATUSES;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::{Disk, Files};
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};
use crate::study::Study;

/// Results of a study, and their table.
pub struct Target {
    /// Their folder.
    pub results: Results<'static>,
    /// The table.
    pub table: Table,
}

/// Opens the results meant, as [`folder`] finds them; rows of jobs that have not run yet are pending.
/// Says on stderr where a study file given is not the one they were run for.
///
/// # Errors
/// Where there are none, or their table cannot be read.
pub fn open(given: Option<&Path>, global: &Global) -> Result<Target> {
    let results = Results::new(&Disk, &folder(given, global)?);
    // A run that has not written its table yet, or was killed before, has plan and journal.
    let table = if !results.table_path().exists() && results.owner()?.is_some() {
        Stored::read(results.clone())?.table()
    } else {
        results.read_table()?
    };
    if let Some(path) = given.filter(|path| path.is_file()) {
        let study = Study::load(path, &global.set)?;
        if !results.holds(&study.name, &study.resolved())? {
            eprintln!(
                "billow: {} says another study than the one these rows were run for; `billow run` \
                 brings them up to date",
                path.display()
            );
        }
    }
    Ok(Target { results, table })
}

/// The results folder meant: a folder, or that of a study file, or the only one there is.
///
/// # Errors
/// [`Error::Disk`] or [`Error::Input`] when there is none, or several.
pub fn folder(study: Option<&Path>, global: &Global) -> Result<PathBuf> {
    if let Some(results) = &global.results {
        return Ok(results.clone());
    }
    let Some(given) = study else { return only_folder() };
    let named = Path::new("results").join(given);
    if given.is_dir() {
        Ok(given.to_owned())
    } else if !given.exists() && named.is_dir() {
        Ok(named)
    } else if !given.exists() {
        Err(Error::Disk {
            path: given.to_owned(),
            problem: "neither a study file nor a folder of results\n  next: name a study file, or \
                      the folder of its results"
                .to_owned(),
        })
    } else {
        Ok(results_folder(global, &Study::load(given, &global.set)?))
    }
}

/// The results folder a job is in, for commands that take a job first.
///
/// # Errors
/// As [`folder`]; and where results are given in place of the job.
pub fn folder_of_job(job: &str, study: Option<&Path>, global: &Global) -> Result<PathBuf> {
    let path = Path::new(job);
    let is_results = path.is_dir() || Path::new("results").join(path).is_dir();
    if study.is_none() && (is_results || path.is_file()) && !job.is_empty() {
        return Err(InputError {
            file: "job".to_owned(),
            key: String::new(),
            value: job.to_owned(),
            problem: "names results, and no job of theirs".to_owned(),
            allowed: "the first digits of a job's id, then the results".to_owned(),
            hint: format!("billow table {job} --columns job,status lists the ids"),
        }
        .into());
    }
    folder(study, global)
}

fn only_folder() -> Result<PathBuf> {
    let results = Path::new("results");
    let mut folders = Disk.list(results).unwrap_or_default();
    folders
        .retain(|path| path.join("summary.parquet").is_file() || path.join("study.json").is_file());
    match folders.as_slice() {
        [one] => Ok(one.clone()),
        several => {
            let names: Vec<String> =
                several.iter().map(|path| path.display().to_string()).collect();
            Err(InputError {
                file: "results".to_owned(),
                key: String::new(),
                value: String::new(),
                problem: if names.is_empty() {
                    "no results under the current folder".to_owned()
                } else {
                    "results of several studies under the current folder".to_owned()
                },
                allowed: if names.is_empty() {
                    "a study file, or a folder of results".to_owned()
                } else {
                    names.join(", ")
                },
                hint: "name one".to_owned(),
            }
            .into())
        }
    }
}

/// The current name of a column; an old one, given with this flag, gives a note on stderr.
pub fn current_name<'a>(flag: &str, name: &'a str) -> &'a str {
    let (current, note) = current_column_name(name);
    if let Some(note) = note {
        eprintln!("billow: {flag}: {note}");
    }
    current
}

/// The column of that name, asked for by a flag.
///
/// # Errors
/// Where there is none; the nearest name is told. An old name is found, with a note on stderr.
pub fn find<'a>(table: &'a Table, flag: &str, name: &str) -> Result<&'a Column> {
    let names = || table.columns.iter().map(|column| column.name.as_str());
    if let Some(column) = table.column(name) {
        return Ok(column);
    }
    table.column(current_name(flag, name)).ok_or_else(|| {
        let hint = keys::nearest(name, names()).map(|near| format!("did you mean {near}?"));
        Error::from(InputError {
            file: flag.to_owned(),
            key: String::new(),
            value: name.to_owned(),
            problem: "no such column".to_owned(),
            allowed: names().collect::<Vec<_>>().join(", "),
            hint: hint.unwrap_or_default(),
        })
    })
}

/// Rows of which the condition holds (`--where`), in plan order.
///
/// # Errors
/// A condition that is none, or of columns there are not.
pub fn filtered(table: &Table, condition: Option<&str>) -> Result<Vec<usize>> {
    let Some(text) = condition else { return Ok((0..table.rows()).collect()) };
    let text = &with_current_names(text, table);
    let variables: Vec<Variable> = table
        .columns
        .iter()
        .map(|column| Variable { name: column.name.clone(), kind: kind(column) })
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

/// A condition with the current names of columns and statuses; each old name gives a note on stderr.
fn with_current_names(text: &str, table: &Table) -> String {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut current_text = String::with_capacity(text.len());
    let mut quote = None;
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = rest.find(|c| !is_name(c)).unwrap_or(rest.len()).max(first.len_utf8());
        let (word, after) = rest.split_at(length);
        let renamed: &[(&str, &str)] =
            if quote.is_some() { &RENAMED_STATUSES } else { &RENAMED_TABLE_COLUMNS };
        // A parameter of the study may have the old name, or the old text as a value.
        let known = if quote.is_some() {
            let mut values = table.parameters().flat_map(|column| &column.cells);
            values.any(|value| matches!(value, Value::Text(text) if text == word))
        } else {
            table.column(word).is_some()
        };
        match renamed.iter().find(|(old, _)| *old == word && !known) {
            Some((old, current)) => {
                eprintln!("billow: --where: {}", note(old, current));
                current_text.push_str(current);
            }
            None => current_text.push_str(word),
        }
        if matches!(first, '\'' | '"') {
            quote = if quote == Some(first) { None } else { quote.or(Some(first)) };
        }
        rest = after;
    }
    current_text
}

/// What a column is to an expression.
fn kind(column: &Column) -> Type {
    match column.cell_type {
        CellType::Bool => Type::Bool,
        CellType::Text => Type::Text(None),
        CellType::Integer | CellType::Number => {
            let known = Dimension::ALL.into_iter().find(|known| known.si() == column.unit);
            Type::Quantity(known.unwrap_or(Dimension::Number), &[])
        }
    }
}

/// Rows of the jobs whose ids begin so (`--jobs`), in the order given.
///
/// # Errors
/// A beginning that no job has, or several; the nearest, or those, are told.
pub fn jobs(table: &Table, beginnings: &[String]) -> Result<Vec<usize>> {
    let ids: Vec<&str> = table
        .column("job")
        .into_iter()
        .flat_map(|column| &column.cells)
        .map(|cell| if let Value::Text(id) = cell { id.as_str() } else { "" })
        .collect();
    let mut rows = Vec::with_capacity(beginnings.len());
    for beginning in beginnings.iter().map(|beginning| beginning.trim()) {
        let found: Vec<usize> =
            (0..ids.len()).filter(|row| ids[*row].starts_with(beginning)).collect();
        match found.as_slice() {
            [row] if !rows.contains(row) => rows.push(*row),
            [_] => {}
            several => {
                return Err(InputError {
                    file: "--jobs".to_owned(),
                    key: String::new(),
                    value: beginning.to_owned(),
                    problem: if several.is_empty() {
                        "no job's id begins so".to_owned()
                    } else {
                        format!("{} jobs' ids begin so", several.len())
                    },
                    allowed: near(&ids, beginning),
                    hint: "billow table --columns job,status lists them".to_owned(),
                }
                .into());
            }
        }
    }
    Ok(rows)
}

/// Ids that share the longest beginning with this one, a few of them.
fn near(ids: &[&str], beginning: &str) -> String {
    let shared = |id: &str| common_prefix_length(id, beginning);
    let longest = ids.iter().map(|id| shared(id)).max().unwrap_or(0);
    let mut nearest: Vec<&str> = ids
        .iter()
        .filter(|id| shared(id) == longest)
        .map(|id| id.get(..12).unwrap_or(id))
        .collect();
    nearest.sort_unstable();
    nearest.dedup();
    let more = if nearest.len() > 6 { ", …" } else { "" };
    format!("{}{more}", nearest[..nearest.len().min(6)].join(", "))
}
