//! The columns that a printed table reads, from a stored table of which it need not read the others.

use super::Args;
use super::columns::{MARGIN, any_main_measures};
use crate::cli::Format;
use crate::cli::needed_columns::{Measures, is_judging};
use crate::cli::opened::{Opened, open_indexed};
use crate::cli::study_keys::names_in;
use crate::job::row::{ColumnId, DERIVED_COLUMNS, HEADLINE, current_column_name};
use crate::store::table::corrected::RUN_MESH;

/// The results with the columns that the table reads; `None` where the index of the results cannot serve them, and for
/// rows of several runs, whose columns follow from all columns of the runs. `asked`: the columns that the options name.
pub(super) fn open(args: &Args, asked: &[String]) -> Option<Opened> {
    let mut keys = asked.to_vec();
    keys.extend(names_in(args.condition.as_deref()));
    let mut names: Vec<String> =
        keys.iter().map(|name| current_column_name(name).0.to_owned()).collect();
    let main = any_main_measures().chain(HEADLINE);
    names.extend(main.map(|column| column.name().to_owned()));
    let measures = Measures::new(&names);
    let all = args.columns.as_slice() == ["all"]
        || (args.columns.is_empty() && args.output.format() != Format::Table);
    let states = [ColumnId::PhysicsVersion, ColumnId::Remedy];
    let wanted = |name: &str, names: &[&str]| {
        all || is_judging(name)
            || name == RUN_MESH
            || states.iter().any(|column| column.name() == name)
            || DERIVED_COLUMNS.iter().any(|column| column.name == name)
            || measures.need(name)
            || name.starts_with(MARGIN)
            || names.iter().any(|other| other.strip_prefix(MARGIN) == Some(name))
    };
    let found = open_indexed(&args.study, &args.set.set, &args.units, &keys, &wanted)?;
    (args.runs || found.stored.study.replicates().is_empty()).then_some(found)
}
