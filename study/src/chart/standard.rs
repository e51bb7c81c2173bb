//! The standard charts, which `billow chart` draws without options: they answer the first questions of most
//! studies. A study with limits, replicates or a search has the charts of its question (`question`).

mod middle;
mod question;

pub use middle::reduced;
pub use question::outcome_axes;

use super::history::{MAX_JOBS, has_history};
use super::parameters::{self, Parameter};
use super::{Source, number};

/// Quantities over time.
const HISTORIES: [&str; 3] = ["z_rim", "vz", "pressure"];
/// Measures over the first parameter.
const MEASURES: [&str; 3] = ["t_90_z_rim", "peak_vz", "peak_kinetic_energy"];

/// A chart to draw.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChartKind {
    /// Histories of these columns.
    History(Vec<String>),
    /// A measure over a parameter; the parameters that give the lines.
    Over(String, String, Vec<String>),
    /// A measure over two parameters; `safe` and `verdict` are proportions of runs.
    Map(String, [String; 2]),
    /// The borders of a search over a parameter; the parameters that give the lines.
    Borders(Option<String>, Vec<String>),
    /// Another chart of some rows, and how they were chosen.
    At(Box<ChartKind>, Vec<usize>, String),
}

impl ChartKind {
    /// File name, without the extension.
    pub fn file_name(&self) -> String {
        let name = match self {
            Self::History(columns) => format!("history-{}", columns.join("-")),
            Self::Over(measure, over, by) if by.is_empty() => format!("{measure}-over-{over}"),
            Self::Over(measure, over, by) => format!("{measure}-over-{over}-by-{}", by.join("-")),
            Self::Map(measure, [x, y]) => format!("{measure}-map-{x}-{y}"),
            Self::Borders(over, by) => {
                let over = over.as_ref().map(|over| format!("-over-{over}"));
                let by = (!by.is_empty()).then(|| format!("-by-{}", by.join("-")));
                format!("borders{}{}", over.unwrap_or_default(), by.unwrap_or_default())
            }
            Self::At(kind, _, _) => kind.file_name(),
        };
        // A parameter name can hold any character; a file name must not hold a path separator.
        name.chars()
            .map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' })
            .collect()
    }
}

/// The standard charts of a study, and messages about charts that are not drawn.
pub fn kinds(source: &Source<'_>) -> (Vec<ChartKind>, Vec<String>) {
    if source.runs.is_some() || source.search.is_some() || !source.limits.is_empty() {
        return question::kinds(source);
    }
    let mut kinds = Vec::new();
    let mut notes = Vec::new();
    let jobs = source.table.one_row_per_job(&source.rows);
    let stored = jobs.iter().filter(|row| has_history(source, **row)).count();
    if stored > MAX_JOBS {
        notes.push(format!(
            "no histories: {stored} jobs are too many for one figure ({MAX_JOBS} at most); choose \
             some: billow chart --history z_rim --where CONDITION"
        ));
    } else if stored == 0 {
        notes.push("no histories: no job has one".to_owned());
    } else {
        kinds.extend(HISTORIES.map(|column| ChartKind::History(vec![column.to_owned()])));
    }
    let axes = axes(source);
    let Some(first) = axes.first().cloned() else {
        notes.push("no chart of measures and no map: no parameter varies".to_owned());
        return (kinds, notes);
    };
    let measured = measured(source, &MEASURES);
    if measured.is_empty() {
        let names = MEASURES.join(", ");
        notes.push(format!("no chart of measures and no map: no job has a value of {names}"));
    }
    let over = |measure: &String| ChartKind::Over(measure.clone(), first.clone(), Vec::new());
    kinds.extend(measured.iter().map(over));
    match axes.as_slice() {
        [x, y, ..] => {
            let map = |measure: &String| ChartKind::Map(measure.clone(), [x.clone(), y.clone()]);
            kinds.extend(measured.iter().take(1).map(map));
        }
        _ => {
            notes.push(format!("no map: it needs two parameters that vary, and only {first} does"));
        }
    }
    (kinds, notes)
}

/// Parameters that vary and can be axes: quantities, whole numbers, then those without numbers.
fn axes(source: &Source<'_>) -> Vec<String> {
    let (parameters, _) = parameters::varying(source.table, &source.rows, &[]);
    let is_number = |parameter: &&Parameter<'_>| parameter.is_number(&source.rows);
    // Quantities come before whole numbers: a trend over an inflow shows more than one over N.
    let (quantities, counts): (Vec<_>, Vec<_>) =
        parameters.iter().filter(is_number).partition(|parameter| parameter.is_quantity());
    // A map needs two axes, and parameters without numbers have places too.
    let texts = parameters.iter().filter(|parameter| !is_number(parameter));
    let all = quantities.into_iter().chain(counts).chain(texts);
    all.map(|parameter| parameter.name().to_owned()).collect()
}

/// Those of these measures of which a row has a value.
fn measured(source: &Source<'_>, measures: &[&str]) -> Vec<String> {
    let has_value = |name: &&&str| {
        let column = source.table.column(name);
        column.is_some_and(|column| {
            source.rows.iter().any(|row| number(&column.cells[*row]).is_some())
        })
    };
    measures.iter().filter(has_value).map(|name| (*name).to_owned()).collect()
}
