//! Lines of the answer on the searches of a border.

use crate::analysis::answer::Searches;
use crate::input::value::Value;
use crate::print::count;
use crate::store::table::Column;
use crate::study::SearchResult;

/// Most searches that the answer names.
const MAX_SEARCHES: usize = 12;

/// One line per search.
pub(super) fn lines(searches: &Searches) -> Vec<String> {
    let mut lines: Vec<String> =
        (0..searches.found.len().min(MAX_SEARCHES)).map(|index| line(searches, index)).collect();
    let more = searches.found.len() - lines.len();
    if more > 0 {
        let open = searches.found.iter().filter(|found| found.border.outcome == SearchResult::Open);
        let open = match open.count() {
            0 => String::new(),
            open => format!(" ({open} of all are open)"),
        };
        lines.push(format!("and {more} more{open}: billow table --borders lists all"));
    }
    lines
}

fn line(searches: &Searches, index: usize) -> String {
    let found = &searches.found[index];
    let (name, what) = (&searches.parameter, &searches.criterion);
    let interval = |[low, high]: [f64; 2]| {
        let (unit, high) = (&searches.shown, Value::Number(high));
        format!("{} to {}", unit.text(&Value::Number(low)), unit.quantity(&high))
    };
    let text = match &found.border.outcome {
        SearchResult::Open => {
            let open = found.sum(|level| level.open);
            format!("{name}: open: {} not run", count(open, "job"))
        }
        SearchResult::Border { low, high, met_below } => {
            let sides = if *met_below { ("below", "above") } else { ("above", "below") };
            let open = match found.undecided_inside(searches.replicates) {
                0 => String::new(),
                values => format!("; not decided at {} between", count(values, "value")),
            };
            format!("{name} {}: {what} {}, not {}{open}", interval([*low, *high]), sides.0, sides.1)
        }
        SearchResult::NotMonotone(changes) => {
            let changes: Vec<String> = changes.iter().map(|change| interval(*change)).collect();
            format!("{name}: {what}: not monotone: changes in {}", changes.join(" and in "))
        }
        SearchResult::NoChange { met } => {
            let range = found.decided(searches.replicates).map(interval).unwrap_or_default();
            let value = if *met { "every decided" } else { "no decided" };
            let open = found.undecided(searches.replicates);
            let open: Vec<String> =
                open.iter().map(|v| searches.shown.text(&Value::Number(*v))).collect();
            let unit = searches.shown.symbol();
            let open = match open.as_slice() {
                [] => String::new(),
                values => {
                    format!(", not decided at {} {unit}", values.join(", ")).trim_end().to_owned()
                }
            };
            format!("{name}: {what} at {value} value from {range}{open}")
        }
        SearchResult::Undecided => format!("{name}: {what}: not decided at any value"),
    };
    let varies = |column: &&Column| column.cells.iter().any(|cell| *cell != column.cells[0]);
    let parameters: Vec<String> = searches
        .parameters
        .iter()
        .filter(varies)
        .map(|column| format!("{}={}", column.name, column.shown.quantity(&column.cells[index])))
        .collect();
    let parameters =
        if parameters.is_empty() { String::new() } else { format!(" ({})", parameters.join(", ")) };
    let not_judged = match found.sum(|level| level.not_judged) {
        0 => String::new(),
        runs => format!("; {} not judged", count(runs, "run")),
    };
    let uncertain = match found.sum(|level| level.uncertain) {
        0 => String::new(),
        runs => format!("; {} within the uncertainty", count(runs, "run")),
    };
    let filtered =
        if found.border.filtered { "; the filter of the study ends this search" } else { "" };
    format!("{text}{parameters}{uncertain}{not_judged}{filtered}")
}
