//! `billow table --borders`: what the searches of a study found.

use std::io::Write;

use super::Args;
use crate::analysis::answer::{Searches, still_moves};
use crate::cli::Format;
use crate::cli::results::{self, Opened};
use crate::platform::error::{Error, Result};
use crate::print::answer::moving;
use crate::print::{count, print_table};
use crate::store::table::Column;
use crate::store::table::select::filtered;

/// Columns that a table has only where a search needs them.
const OPTIONAL: [&str; 5] = ["changes", "limit", "not_decided", "not_judged", "open"];

/// Prints one row per search.
///
/// # Errors
/// Results that cannot be read; a study without a search; an invalid condition.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let Opened { stored, table } = results::open(&args.study, &args.set.set, &args.units, None)?;
    let Some(searches) = Searches::of(&stored, &table) else {
        let name = stored.study.name.as_str();
        let allowed = "an axis of the grid as {\"bisect\": [low, high], \"on\": \"verdict\", \"safe\" or a limit}";
        return Err(Error::invalid_option("--borders", name, "searches no border", allowed, ""));
    };
    let mut borders = searches.table();
    let found = borders.columns.len();
    let condition = args.condition.as_deref();
    results::add_keys(&stored.study, &mut borders, &stored.units, &[], condition);
    let rows = filtered(&borders, condition)?;
    let format = args.output.format();
    let is_printed = |column: &&Column| {
        let optional = OPTIONAL.contains(&column.name.as_str());
        let inner = ["search", "status"].contains(&column.name.as_str());
        !(inner || optional && format == Format::Table && column.is_empty())
    };
    let columns: Vec<&Column> = borders.columns[..found].iter().filter(is_printed).collect();
    print_table(&borders, &columns, &rows, format, out)?;
    if format == Format::Table && !args.quiet.quiet {
        eprintln!(
            "{}: {}; low, high: nearest values at which the outcome is decided",
            searches.parameter, searches.criterion
        );
        let jobs = table.one_row_per_job(&(0..table.rows()).collect::<Vec<_>>());
        let still_moving = jobs.iter().filter(|row| still_moves(&table, **row)).count();
        if let Some(note) = moving(still_moving) {
            eprintln!("note: {note}");
        }
        let wide = searches.found.iter();
        let wide = wide.filter(|found| found.undecided_inside(searches.replicates) > 0).count();
        if wide > 0 {
            eprintln!(
                "{}: runs disagree, or are within their uncertainty, between low and high (not_decided), so the border is \
                 wider than the tolerance; more replicates or a finer mesh make it narrower",
                count(wide, "search")
            );
        }
    }
    Ok(())
}
