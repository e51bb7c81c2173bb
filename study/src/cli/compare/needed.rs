//! The columns that the summary of a comparison reads, from a table of which it need not read the others.

use super::{Args, DEFAULT_MEASURES};
use crate::analysis::compare::{is_margin, measures_with};
use crate::cli::Format;
use crate::cli::needed_columns::{Measures, is_judging};
use crate::cli::opened::{Opened, open_indexed};
use crate::cli::study_keys::names_in;
use crate::job::row::{BetterSide, DERIVED_COLUMNS, current_column_name};

/// The results with the columns that the comparison reads; `None` where the index of the results cannot serve them.
pub(super) fn open(args: &Args) -> Option<Opened> {
    let keys = names_in(args.condition.as_deref());
    let mut names: Vec<String> = measures(args);
    names.extend(keys.iter().map(|name| current_column_name(name).0.to_owned()));
    let measures = Measures::new(&names);
    let wanted = |name: &str, _: &[&str]| {
        is_judging(name)
            || DERIVED_COLUMNS.iter().any(|column| column.name == name)
            || measures.need(name)
            || (args.measures.is_empty() && is_margin(name))
    };
    open_indexed(&args.study, &args.set.set, &args.units, &keys, &wanted)
}

/// The measures to compare: those asked for, or those of the format.
fn measures(args: &Args) -> Vec<String> {
    let names: Vec<&str> = match (args.measures.as_slice(), args.output.format()) {
        ([], Format::Table) => DEFAULT_MEASURES.to_vec(),
        ([], _) => [BetterSide::Smaller, BetterSide::Larger].map(measures_with).concat(),
        (names, _) => names.iter().map(|name| current_column_name(name.trim()).0).collect(),
    };
    names.into_iter().map(str::to_owned).collect()
}
