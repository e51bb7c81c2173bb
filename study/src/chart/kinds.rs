//! The kinds of charts, and those that `billow chart` draws without options: they answer the first questions of most
//! studies. A study with limits, replicates or a search has its answer first.

use std::collections::BTreeSet;

use super::history::{MAX_JOBS, has_history};
use super::map::{Judged, MAX_VALUES};
use super::parameters::{self, Parameter, STRATEGY};
use super::tornado::{self, OneFactor};
use super::{Source, borders, history, importance, invalid_option, map, number, over, search};
use crate::analysis::compare::{canonical, values};
use crate::input::value::Value;
use crate::job::JobId;
use crate::job::row::{ColumnId, DerivedColumn};
use crate::platform::error::Result;
use crate::store::history_file::StoredHistory;
use crate::store::table::Column;

/// Quantities over time.
const HISTORIES: [&str; 3] = ["z_rim", "vz", "pressure"];
/// Those of film without rings.
const OTHER_HISTORIES: [&str; 3] = ["volume", "height", "pressure"];
/// Measures over the first parameter.
const MEASURES: [ColumnId; 3] = [ColumnId::T90ZRim, ColumnId::PeakVz, ColumnId::PeakKineticEnergy];
/// Most points whose histories are drawn together. Chosen: more lines hide each other.
const MAX_HISTORIES: usize = 8;

/// A chart to draw.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChartKind {
    /// Histories of these columns.
    History(Vec<String>),
    /// A measure over a parameter; the parameters that give the lines.
    Over(String, String, Vec<String>),
    /// Which input makes the spread of a measure.
    Importance(String),
    /// How the search of an optimum went on.
    Search,
    /// How much each factor changes a measure, of points that vary one factor at a time.
    Tornado(String),
    /// A measure over two parameters; `safe` and `verdict` are proportions of runs.
    Map(String, [String; 2]),
    /// The borders of a search over a parameter; the parameters that give the lines.
    Borders(Option<String>, Vec<String>),
}

impl ChartKind {
    /// The map of a measure over two parameters. Without them a proportion of runs is over the first two; any other
    /// measure is what its study asks of it: the search of an optimum, what makes its spread, a tornado.
    ///
    /// # Errors
    /// A study with fewer than two parameters that vary.
    pub fn map(source: &Source<'_>, measure: String, axes: Option<[String; 2]>) -> Result<Self> {
        if let Some(axes) = axes {
            return Ok(Self::Map(measure, axes));
        }
        if Judged::of_name(&measure).is_none() {
            let answer = source.answer;
            let searched = answer.and_then(|answer| answer.optimum.as_ref());
            if searched.is_some_and(|found| found.minimise.contains(&measure)) {
                return Ok(Self::Search);
            }
            let one_factor = OneFactor::of(source, 2).is_some();
            let has_parts = !one_factor
                && answer
                    .is_some_and(|answer| !importance::of_measure(answer, &measure).is_empty());
            let kind = if has_parts { Self::Importance } else { Self::Tornado };
            return Ok(kind(measure));
        }
        let axes = outcome_axes(source).ok_or_else(|| {
            let problem = "a map needs two parameters that vary";
            let allowed = "a study that varies two, without its replicates";
            invalid_option("--measure", &measure, problem, allowed, "")
        })?;
        Ok(Self::Map(measure, axes))
    }

    /// File name, without the extension.
    pub fn file_name(&self) -> String {
        let by = |by: &[String]| match by {
            [] => String::new(),
            names => format!("-by-{}", names.join("-")),
        };
        let name = match self {
            Self::History(columns) => format!("history-{}", columns.join("-")),
            Self::Over(measure, over, lines) => format!("{measure}-over-{over}{}", by(lines)),
            Self::Importance(measure) => format!("{measure}-importance"),
            Self::Search => "search".to_owned(),
            Self::Tornado(measure) => format!("{measure}-tornado"),
            Self::Map(measure, [x, y]) => format!("{measure}-map-{x}-{y}"),
            Self::Borders(over, lines) => {
                let over = over.as_ref().map(|over| format!("-over-{over}"));
                format!("borders{}{}", over.unwrap_or_default(), by(lines))
            }
        };
        file_name(&name)
    }

    /// Draws the chart. `range` gives the ends of the time axis of histories, s; `read` reads the history of a job.
    ///
    /// # Errors
    /// Unknown names; a chart that does not fit; the errors of `read`.
    pub fn svg(
        &self,
        source: &Source<'_>,
        range: [Option<f64>; 2],
        read: &dyn Fn(&JobId) -> Result<StoredHistory>,
    ) -> Result<String> {
        match self {
            Self::History(columns) => history::svg(source, columns, range, read),
            Self::Over(measure, parameter, by) => over::svg(source, measure, parameter, by),
            Self::Importance(measure) => importance::svg(source, measure),
            Self::Search => search::svg(source),
            Self::Tornado(measure) => tornado::svg(source, measure),
            Self::Map(measure, [x, y]) => map::svg(source, measure, [x, y]),
            Self::Borders(over, by) => borders::svg(source, over.as_deref(), by),
        }
    }

    /// The source with only the middle values of the parameters that are neither axes of this chart nor the inflation
    /// strategy; `None` where all points have them.
    pub fn reduced<'a>(&self, source: &Source<'a>) -> Option<Source<'a>> {
        match self {
            Self::History(_) => middle(source, &[]),
            Self::Over(_, over, _) => middle(source, &[over]),
            Self::Map(_, [x, y]) => middle(source, &[x, y]),
            // The searches are chosen, not their values; a tornado has every point.
            Self::Borders(..) | Self::Tornado(_) | Self::Importance(_) | Self::Search => None,
        }
    }
}

/// A name for a file. A parameter name can hold any character; a file name must not hold a path separator.
pub fn file_name(name: &str) -> String {
    let safe = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    name.chars().map(|c| if safe(c) { c } else { '_' }).collect()
}

/// The standard charts of a study, each with its points, and messages about charts that are not drawn.
pub fn standard<'a>(source: &Source<'a>) -> (Vec<(ChartKind, Source<'a>)>, Vec<String>) {
    let (mut kinds, mut notes) = (Vec::new(), Vec::new());
    let asks = source.runs.is_some() || source.search.is_some() || !source.limits.is_empty();
    let axes = axes(source);
    let judged = Judged::of(source);
    let one_factor = source.search.is_none() && OneFactor::of(source, 2).is_some();
    if source.answer.is_some_and(|answer| answer.optimum.is_some()) {
        return (vec![(ChartKind::Search, source.clone())], notes);
    }
    // First the answer: the borders, or the map of outcomes.
    if source.search.is_some() {
        kinds.push(ChartKind::Borders(None, Vec::new()));
    } else if asks && !one_factor {
        match outcome_axes(source) {
            None => notes.push("no map of outcomes: it needs two parameters that vary".to_owned()),
            Some(axes) if source.rows.iter().any(|row| judged.proportion(source, *row).of > 0) => {
                kinds.push(ChartKind::Map(judged.name().to_owned(), axes));
            }
            Some(_) => {
                notes.push(format!("no map of outcomes: no job has a value of {}", judged.name()));
            }
        }
    }
    let mut measures = MEASURES.map(|id| source.table.of_any_film(id).name()).to_vec();
    if asks {
        let limited = source.limits.iter().map(|limit| limit.measure.name());
        let limited = limited.filter(|name| *name != Judged::Deployed.name());
        let first = std::iter::once(DerivedColumn::SmallestMargin.name()).chain(limited);
        let first: Vec<&str> = first.collect();
        measures.retain(|name| !first.contains(name));
        measures.splice(0..0, first);
    }
    let measured = measured(source, &measures);
    let searched = source.search.map(|search| search.parameter.to_owned());
    match searched.as_ref().or(axes.first()) {
        None => notes.push("no chart of measures: no parameter varies".to_owned()),
        Some(_) if measured.is_empty() => {
            notes.push(format!(
                "no chart of measures: no job has a value of {}",
                measures.join(", ")
            ));
        }
        Some(_) if one_factor => kinds.extend(measured.iter().cloned().map(ChartKind::Tornado)),
        Some(over) => {
            let kind = |measure: &String| ChartKind::Over(measure.clone(), over.clone(), vec![]);
            kinds.extend(measured.iter().map(kind));
        }
    }
    if !asks
        && !one_factor
        && let ([x, y, ..], Some(measure)) = (axes.as_slice(), measured.first())
    {
        kinds.push(ChartKind::Map(measure.clone(), [x.clone(), y.clone()]));
    }
    if let Some(answer) = source.answer.filter(|_| !one_factor) {
        kinds.extend(importance::measures(answer).into_iter().map(ChartKind::Importance));
    }
    let mut charts: Vec<(ChartKind, Source<'a>)> =
        kinds.into_iter().map(|kind| (kind, source.clone())).collect();
    let (chosen, note) = histories(source, asks);
    notes.extend(note);
    if let Some(chosen) = chosen {
        let kind = |column: &str| ChartKind::History(vec![column.to_owned()]);
        let rings = source.table.of_any_film(ColumnId::FinalZRim) == ColumnId::FinalZRim;
        let columns = if rings { HISTORIES } else { OTHER_HISTORIES };
        charts.extend(columns.map(|column| (kind(column), chosen.clone())));
    }
    (charts, notes)
}

/// The points whose histories are drawn: all, or of a study that asks a question those at the middle values of every
/// parameter but the strategy.
fn histories<'a>(source: &Source<'a>, asks: bool) -> (Option<Source<'a>>, Option<String>) {
    let rows = source.rows.iter().copied().filter(|row| has_history(source, *row)).collect();
    let stored = Source { rows, ..source.clone() };
    let jobs = source.table.one_row_per_job(&stored.rows).len();
    if jobs == 0 {
        return (None, Some("no histories: no job has one".to_owned()));
    }
    if !asks && jobs > MAX_JOBS {
        let note = format!(
            "no histories: {jobs} jobs are too many for one figure ({MAX_JOBS} at most); choose some: billow chart \
             --history z_rim --where CONDITION"
        );
        return (None, Some(note));
    }
    let fewer = middle(&stored, &[]).filter(|_| asks && stored.rows.len() > MAX_HISTORIES);
    let Some(fewer) = fewer else { return (Some(source.clone()), None) };
    let note = format!(
        "histories of {} of {} points, {} (the middle of the values); choose others: billow chart --history z_rim \
         --where CONDITION",
        fewer.rows.len(),
        stored.rows.len(),
        fewer.choice
    );
    (Some(fewer), Some(note))
}

/// Parameters that vary and can be axes: quantities, whole numbers, then those without numbers.
fn axes(source: &Source<'_>) -> Vec<String> {
    let (parameters, _) = parameters::varying(source.table, &source.rows, &[]);
    let mut ranked: Vec<(usize, String)> = Vec::new();
    for parameter in parameters {
        // A trend over an inflow shows more than one over N.
        let rank = match parameter.is_number(&source.rows) {
            true if parameter.is_quantity() => 0,
            true => 1,
            false => 2,
        };
        ranked.push((rank, parameter.name().to_owned()));
    }
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().map(|(_, name)| name).collect()
}

/// Those of these measures of which a row has a value.
fn measured(source: &Source<'_>, measures: &[&str]) -> Vec<String> {
    let has_value = |name: &&&str| {
        source.table.column(name).is_some_and(|column| {
            source.rows.iter().any(|row| number(&column.cells[*row]).is_some())
        })
    };
    measures.iter().filter(has_value).map(|name| (*name).to_owned()).collect()
}

/// The axes of a map of outcomes: the first two parameters but the strategy; with one such parameter, that and the
/// strategy. Parameters with more values than fit are no axes, while there are others. `None` without two parameters
/// that vary.
pub(super) fn outcome_axes(source: &Source<'_>) -> Option<[String; 2]> {
    let mut all = axes(source);
    let legible: Vec<String> =
        all.iter().filter(|name| is_legible(source, name)).cloned().collect();
    if legible.len() > 1 {
        all = legible;
    }
    let (strategy, mut others): (Vec<String>, Vec<String>) =
        all.into_iter().partition(|name| name == STRATEGY);
    others.extend(strategy);
    others.truncate(2);
    others.try_into().ok()
}

/// Whether the values of a parameter fit along an axis.
fn is_legible(source: &Source<'_>, name: &str) -> bool {
    let common = source.common_values(&[name]);
    let rows = &common.as_ref().unwrap_or(source).rows;
    let column = source.table.parameters().find(|column| column.name == name);
    column.is_some_and(|column| values(column, rows).len() <= MAX_VALUES)
}

/// The source at the middle values of each parameter but these and the strategy; `None` where no other varies.
fn middle<'a>(source: &Source<'a>, keep: &[&str]) -> Option<Source<'a>> {
    let is_kept =
        |column: &&Column| keep.contains(&column.name.as_str()) || column.name == STRATEGY;
    let kept: Vec<&Column> = source.table.parameters().filter(is_kept).collect();
    let mut rows = source.rows.clone();
    let mut texts = Vec::new();
    let (others, _) = parameters::varying(source.table, &source.rows, &kept);
    for parameter in others {
        let values = parameter.values(&rows);
        if values.len() < 2 {
            continue;
        }
        // The middle of the values at which most combinations of the kept parameters have a row.
        let combinations = |value| combinations(&parameter, value, &rows, &kept);
        let most = values.iter().map(combinations).max().unwrap_or(0);
        let common: Vec<_> = values.iter().filter(|value| combinations(value) == most).collect();
        let value = common[common.len() / 2];
        rows.retain(|row| parameter.column.cells[*row] == *value);
        texts.extend(rows.first().map(|row| parameter.named(*row)));
    }
    let choice = format!("{} at {}", source.choice, texts.join(", ")).trim().to_owned();
    (!texts.is_empty()).then(|| Source { rows, choice, ..source.clone() })
}

/// Number of combinations of the kept parameters that have a row at a value.
fn combinations(
    parameter: &Parameter<'_>,
    value: &Value,
    rows: &[usize],
    kept: &[&Column],
) -> usize {
    let here = rows.iter().filter(|row| parameter.column.cells[**row] == *value);
    let key = |row: &usize| -> Vec<String> {
        kept.iter().map(|column| canonical(&column.cells[*row])).collect()
    };
    here.map(key).collect::<BTreeSet<_>>().len()
}
