//! The columns that the summary of a comparison reads, from a table of which it need not read the others.

use super::{Args, DEFAULT_MEASURES};
use crate::accuracy::{NO_ERROR_REASON, error_column};
use crate::analysis::compare::{is_margin, measures_with};
use crate::cli::Format;
use crate::cli::opened::open_indexed;
use crate::cli::study_keys::names_in;
use crate::job::row::{BetterSide, ColumnId, DERIVED_COLUMNS, SAME_JOB_AS, current_column_name};
use crate::store::stored::Stored;
use crate::store::table::{Table, extrapolated};

/// Columns that every comparison reads: how a run ended, and whether it can be trusted.
const ALWAYS: [ColumnId; 5] = [
    ColumnId::Status,
    ColumnId::Verdict,
    ColumnId::Passages,
    ColumnId::Intersections,
    ColumnId::NumericallyDamped,
];

/// The results with the columns that the comparison reads; `None` where the index of the results cannot serve them.
pub(super) fn open(args: &Args) -> Option<(Stored<'static>, Table)> {
    let condition = args.condition.as_deref();
    let mut names: Vec<String> = measures(args);
    names.extend(names_in(condition).iter().map(|name| current_column_name(name).0.to_owned()));
    let further = names.iter().flat_map(|name| {
        let errors = error_column(name).into_iter().map(str::to_owned);
        errors.chain(extrapolated::names(name)).collect::<Vec<_>>()
    });
    let further: Vec<String> = further.collect();
    names.extend(further.iter().flat_map(|name| extrapolated::names(name)));
    names.extend(further);
    let wanted = |name: &str| {
        ALWAYS.iter().any(|column| column.name() == name)
            || DERIVED_COLUMNS.iter().any(|column| column.name == name)
            || [NO_ERROR_REASON, SAME_JOB_AS].contains(&name)
            || names.iter().any(|known| known == name)
            || (args.measures.is_empty() && is_margin(name))
    };
    open_indexed(&args.study, &args.set.set, &args.units, condition, &wanted)
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
