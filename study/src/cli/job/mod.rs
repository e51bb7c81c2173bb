//! `billow job`: why a job ended as it did, and everything that is stored of it.

use std::fmt::Write as _;
use std::io::Write;

use billow_solver::output::audit::{MAX_LEDGER_RESIDUAL, MAX_NUMERICAL_FRACTION};
use billow_solver::output::history;
use serde_json::{Map, json};

use super::limits;
use super::options::{OutputOptions, QuietOption, UnitsOption};
use super::results::{self, StudyArgs, folder_of_job};
use super::{Format, output_error};
use crate::accuracy::PROMISED;
use crate::input::value::{Value, brief_number, json_value};
use crate::job::row::{COLUMNS, Cells, ColumnId};
use crate::job::suggestions::{Suggestion, suggestions};
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::platform::quote;
use crate::print::{TopicLine, print_rows};
use crate::scene::summary;
use crate::store::stored::Stored;

mod failure;
mod history_table;
mod pressure;
mod quantities;
mod verdict;

/// Arguments of `billow job`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The job: the first digits of its id.
    pub job: String,
    #[command(flatten)]
    study: StudyArgs,
    /// Print its row of the table, one line per quantity, and its events.
    #[arg(long, conflicts_with_all = ["scene", "history"])]
    pub all: bool,
    /// Print the scene, as JSON.
    #[arg(long, conflicts_with = "history")]
    pub scene: bool,
    /// Print the history: one row per sample.
    #[arg(long)]
    pub history: bool,
    /// Columns of the history, comma-separated, or "all" [default: the main columns; all for csv
    /// and json].
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "history")]
    pub columns: Vec<String>,
    /// Print every N-th sample of the history, and the last one [default: 1].
    #[arg(long, value_name = "N", requires = "history", value_parser = clap::value_parser!(u32).range(1..))]
    pub every: Option<u32>,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// A job with all that its results folder has of it.
struct Inspected {
    stored: Stored<'static>,
    id: JobId,
    cells: Cells,
}

/// Runs `billow job`.
///
/// # Errors
/// An unknown job; a history or results that cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let root = folder_of_job(&args.job, &args.study)?;
    let mut stored = results::read(&root)?;
    let id = stored.job(&args.job)?;
    stored.units = args.units.apply(&stored.units, &|name| si_unit(&stored, name))?;
    let cells = stored.cells_of_job(&id);
    let job = Inspected { stored, id, cells };
    let format = args.output.format();
    if args.scene {
        writeln!(out, "{:#}", job.stored.scene(&job.id)?).map_err(output_error)
    } else if args.history {
        history_table::print(&job, args, format, out)
    } else if args.all {
        let rows = quantities::rows(&job, format == Format::Table);
        print_rows(&["name", "value", "unit", "meaning"], &rows, format, out)
    } else {
        job.explain(format, out)
    }
}

/// SI unit of a parameter, of a column of the table or of a column of a history.
fn si_unit(stored: &Stored<'_>, name: &str) -> Option<String> {
    let of_row = COLUMNS.iter().find(|column| column.name == name).map(|column| column.unit);
    let error = PROMISED.iter().find(|promised| promised.error_columns.contains(&name));
    let of_error = error.map(|promised| promised.measure.column().unit);
    let of_history = history::COLUMNS.iter().find(|column| column.name == name);
    let is_parameter = stored.study.parameter_names().iter().any(|parameter| parameter == name);
    let of_parameter = is_parameter.then(|| stored.study.unit(name));
    let unit = of_parameter.or(of_row).or(of_error).or(of_history.map(|column| column.unit));
    unit.map(str::to_owned)
}

impl Inspected {
    /// Prints why the job ended as it did.
    fn explain(&self, format: Format, out: &mut dyn Write) -> Result<()> {
        let lines = self.explanation()?;
        if format != Format::Table {
            let json = self.json(&lines);
            return match format {
                Format::Json => writeln!(out, "{json}").map_err(output_error),
                _ => print_rows(&["quantity", "value"], &summary::rows(&json), format, out),
            };
        }
        let mut text = format!("job {}: {}", self.stored.label(&self.id), self.cells.status());
        match self.cells.text(ColumnId::Verdict) {
            "" => {}
            verdict if verdict::is_near_threshold(&self.cells) => {
                let _ = write!(text, ", {verdict}, near a threshold");
            }
            verdict => text.extend([", ", verdict]),
        }
        for (topic, line) in &lines {
            let _ = write!(text, "\n  {topic:<9} {line}");
        }
        writeln!(out, "{text}").map_err(output_error)
    }

    /// Every line of the explanation; the last one is the next step.
    fn explanation(&self) -> Result<Vec<TopicLine>> {
        let Self { stored, id, cells } = self;
        let root = quote::path(stored.results.root());
        let (mut lines, next) = match cells.status() {
            Status::Done => verdict::explanation(self),
            Status::Pending => {
                let invalidated = stored.journal.invalidated.contains_key(id);
                let status =
                    if invalidated { "invalidated, not run again yet" } else { "not run yet" };
                (vec![("status", status.to_owned())], format!("billow run {root}"))
            }
            _ => failure::explanation(self),
        };
        lines.extend(pressure::line(self));
        lines.extend(limits::lines(stored, id));
        lines.extend(audit(cells));
        lines.extend(damping(cells));
        lines.extend(self.suggestions().into_iter().map(|text| ("try", text)));
        let point = stored.point(id);
        if point.is_none() {
            lines.push(("study", "this job is no longer in the study".to_owned()));
        }
        if let Some(record) = stored.journal.records.get(id)
            && let Some(damage) = stored.results.damage(record)?
        {
            let next = format!("{damage} by the next `billow run`; see billow doctor {root}");
            lines.push(("file", next));
        }
        lines.push(("next", next));
        Ok(lines)
    }

    /// What to try about the run: a command that can be copied, or what only its user can decide.
    fn suggestions(&self) -> Vec<String> {
        let Some(point) = self.stored.point(&self.id) else { return Vec::new() };
        let (id, root) = (self.id.short(), self.stored.results.root().display());
        let text = |suggestion: Suggestion| match suggestion.set {
            Some(set) => {
                format!("billow run {root} --again {id} --set {set}: {}", suggestion.text)
            }
            None => suggestion.text.to_owned(),
        };
        suggestions(&self.cells, &point.job.scene.solver).into_iter().map(text).collect()
    }

    /// The explanation as JSON: parameters, limits, the cells of the row, and the lines as `why`.
    fn json(&self, lines: &[TopicLine]) -> serde_json::Value {
        let Self { stored, id, cells } = self;
        let point = stored.point(id);
        let parameters = point.map(|point| {
            let parameters = point.job.parameters.iter();
            parameters.map(|(name, value)| (name.clone(), json_value(value))).collect::<Map<_, _>>()
        });
        let why: Vec<String> =
            lines.iter().map(|(topic, text)| format!("{topic}: {text}")).collect();
        let mut keys = json!({
            "job": id.as_str(),
            "parameters": parameters,
            "why": why,
            "suggestions": self.suggestions(),
        });
        for (name, value) in limits::keys(stored, id) {
            keys[name] = value;
        }
        for (column, value) in cells.iter() {
            keys[column.name] = json_value(value);
        }
        keys
    }
}

/// Lines of the audit: energy ledger, passages and intersections.
fn audit(cells: &Cells) -> Vec<TopicLine> {
    let Some(residual) = cells.number(ColumnId::LedgerResidual) else { return Vec::new() };
    let sign = if residual <= MAX_LEDGER_RESIDUAL { "≤" } else { ">" };
    let residual = brief_number(residual);
    let mut ledger = format!("largest residual {residual} {sign} {MAX_LEDGER_RESIDUAL}");
    if let Some(gas) = cells.number(ColumnId::GasResidual) {
        let _ = write!(ledger, "; gas balance {}", brief_number(gas));
    }
    let film = match (cells.get(ColumnId::Passages), cells.get(ColumnId::Intersections)) {
        (Value::Null, Value::Null) => {
            "passages and intersections are not counted by this model".to_owned()
        }
        (passages, intersections) => {
            format!("passages {passages}, intersections {intersections}")
        }
    };
    vec![("ledger", ledger), ("film", film)]
}

/// The work of the gas that the film's material and the method dissipated, where it matters.
fn damping(cells: &Cells) -> Vec<TopicLine> {
    let large = |column| {
        let fraction = cells.number(column)?;
        (fraction.abs() > MAX_NUMERICAL_FRACTION).then_some(fraction)
    };
    let mut lines = Vec::new();
    if let Some(fraction) = large(ColumnId::MaterialLossFraction) {
        let taken = percent(fraction);
        lines.push(format!(
            "the film's material took {taken} of the work of the gas (material_loss_fraction): film.loss_factor"
        ));
    }
    if let Some(fraction) = large(ColumnId::NumericalFraction) {
        let (verb, part) = (if fraction > 0.0 { "took" } else { "added" }, percent(fraction));
        lines.push(format!(
            "the method {verb} {part} of the work of the gas until the first peak (numerical_fraction): kinetic \
             energies and rebounds are wrong by about as much"
        ));
    }
    lines.into_iter().map(|line| ("damping", line)).collect()
}

/// A fraction as a percentage, without its sign.
fn percent(fraction: f64) -> String {
    format!("{} %", brief_number((100.0 * fraction).abs()))
}
