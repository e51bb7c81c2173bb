//! The charts drawn where none is asked for: those that answer most studies' first questions.

use super::history::has_history;
use super::vary;
use super::{Source, number};

/// Jobs whose histories are drawn together, at most.
const JOBS: usize = 12;
/// Quantities over time.
const HISTORIES: [&str; 3] = ["z_rim", "vz", "pressure"];
/// Measures over the first parameter.
const MEASURES: [&str; 3] = ["t_90_z_rim", "peak_vz", "peak_kinetic_energy"];

/// A chart to draw.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    /// Histories of these columns.
    History(Vec<String>),
    /// A measure over a parameter; parameters that tell lines apart.
    Over(String, String, Vec<String>),
    /// A measure over two parameters.
    Map(String, [String; 2]),
}

impl Kind {
    /// Name of its file, without an ending.
    pub fn file_name(&self) -> String {
        let name = match self {
            Self::History(columns) => format!("history-{}", columns.join("-")),
            Self::Over(measure, over, by) if by.is_empty() => format!("{measure}-over-{over}"),
            Self::Over(measure, over, by) => format!("{measure}-over-{over}-by-{}", by.join("-")),
            Self::Map(measure, [x, y]) => format!("{measure}-map-{x}-{y}"),
        };
        // Names of parameters may be dotted paths; nothing in them is a path of the disk.
        name.chars()
            .map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' })
            .collect()
    }
}

/// The charts fit for a study, and what is left out and why.
pub fn kinds(source: &Source<'_>) -> (Vec<Kind>, Vec<String>) {
    let mut kinds = Vec::new();
    let mut notes = Vec::new();
    let stored = source.rows.iter().filter(|row| has_history(source, **row)).count();
    if stored > JOBS {
        notes.push(format!(
            "no histories: {stored} jobs are too many for one figure (12 at most); choose some: \
             billow chart --history z_rim --where CONDITION"
        ));
    } else if stored > 0 {
        kinds.extend(HISTORIES.map(|column| Kind::History(vec![column.to_owned()])));
    }
    let (parameters, _) = vary::varying(source.table, &source.rows, &[]);
    let is_number = |each: &&vary::Parameter<'_>| each.is_number(&source.rows);
    // Quantities before whole numbers: a trend along an inflow says more than one along panels.
    let (quantities, counts): (Vec<_>, Vec<_>) =
        parameters.iter().filter(is_number).partition(|each| each.is_quantity());
    let numeric: Vec<String> =
        quantities.into_iter().chain(counts).map(|each| each.name().to_owned()).collect();
    let first =
        numeric.first().cloned().or_else(|| parameters.first().map(|p| p.name().to_owned()));
    let Some(first) = first else {
        notes.push("no chart of measures: no parameter varies".to_owned());
        return (kinds, notes);
    };
    let measured: Vec<String> = MEASURES
        .into_iter()
        .filter(|name| {
            let column = source.table.column(name);
            column.is_some_and(|column| {
                source.rows.iter().any(|row| number(&column.cells[*row]).is_some())
            })
        })
        .map(str::to_owned)
        .collect();
    if measured.is_empty() {
        notes.push("no chart of measures: no job has any".to_owned());
    }
    let over = |measure: &String| Kind::Over(measure.clone(), first.clone(), Vec::new());
    kinds.extend(measured.iter().map(over));
    if let [x, y, ..] = numeric.as_slice() {
        let map = |measure: &String| Kind::Map(measure.clone(), [x.clone(), y.clone()]);
        kinds.extend(measured.iter().take(1).map(map));
    }
    (kinds, notes)
}
