//! `billow rank`: orders strategies, or the values of other parameters, by limits and measures.

use std::io::Write;

use super::Format;
use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::points::chosen_runs;
use super::results::{self, StudyArgs};
use crate::analysis::compare::{self, measures_with};
use crate::analysis::ranking::{DEFAULT_MEASURES, Question, Ranking};
use crate::job::row::{BetterSide, ColumnId};
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::store::table::{Column, Table};

mod print;

/// Arguments of `billow rank`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Parameters whose values are ranked, comma-separated [default: strategy if it varies, otherwise
    /// every parameter].
    #[arg(long, value_name = "PARAMS", value_delimiter = ',')]
    by: Vec<String>,
    /// Measures after the limits, comma-separated, the most important one first [default:
    /// `peak_vz,peak_kinetic_energy,t_90_z_rim_since_release`].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    measures: Vec<String>,
    /// Only rows for which this condition holds, as in `mass_flow_rate >= '2 g/s'`.
    #[arg(long = "where", value_name = "CONDITION")]
    condition: Option<String>,
    /// Print the first N candidates only.
    #[arg(long, value_name = "N")]
    top: Option<usize>,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// What is printed.
struct Printed<'a> {
    table: &'a Table,
    by: Vec<String>,
    measures: Vec<ColumnId>,
    ranking: Ranking,
    limits: Vec<String>,
    with_runs: bool,
}

/// Runs `billow rank`: one row per candidate, the best one first.
///
/// # Errors
/// An unknown parameter, measure or column; results that cannot be read, or of which nothing can be ranked.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let condition = args.condition.as_deref();
    let mut opened = results::open(&args.study, &args.set.set, &args.units)?;
    opened.add_keys(&[], condition);
    let results::Opened { stored, table } = opened;
    if args.top == Some(0) {
        return Err(Error::invalid_option("--top", "0", "prints nothing", "1 or more", ""));
    }
    let replicates = stored.study.replicates();
    let rows = rows(&table, args.condition.as_deref(), &args.by, &replicates)?;
    let by = parameters(&table, &rows, &args.by, &replicates)?;
    let measures = measures(&args.measures)?;
    let question = Question {
        table: &table,
        rows: &rows,
        by: &by,
        replicates: &replicates,
        limits: stored.study.result_limits(),
        measures: &measures,
        zipped: &|name| stored.study.zipped_with(name),
    };
    let ranking = Ranking::of(&question).map_err(|problem| {
        let allowed = "parameters of which two values have ended points that are equal in all else";
        let next = "finish the run, or rank by other parameters";
        Error::invalid_option("--by", &by.join(","), problem, allowed, next)
    })?;
    let limits = stored.study.result_limits().iter().map(ToString::to_string).collect();
    let with_runs = replicates.iter().any(|name| !by.contains(name));
    let printed = Printed { table: &table, by, measures, ranking, limits, with_runs };
    printed.print(args.top, args.output.format(), out)?;
    if !args.quiet.quiet && args.output.format() == Format::Table {
        printed.notes(args.top, &stored.study).iter().for_each(|note| eprintln!("{note}"));
    }
    Ok(())
}

/// The rows that `--where` chooses: in a study with replicates a condition on results chooses points, unless the
/// replicate itself is ranked.
///
/// # Errors
/// An invalid condition, an unknown column in it, or one that no row fulfils.
fn rows(
    table: &Table,
    condition: Option<&str>,
    by: &[String],
    replicates: &[String],
) -> Result<Vec<usize>> {
    let ranked = |name: &String| by.iter().any(|by| by.trim() == name);
    let replicates: Vec<String> = replicates.iter().filter(|name| !ranked(name)).cloned().collect();
    let rows = chosen_runs(table, condition, &replicates)?;
    match condition.filter(|_| rows.is_empty()) {
        Some(condition) => {
            let allowed = "a condition that at least one row fulfils; a number without a unit is SI, a unit \
                           is written as in mass_flow_rate == '5 g/s'";
            let problem = "no row fulfils this condition";
            Err(Error::invalid_option("--where", condition, problem, allowed, ""))
        }
        None => Ok(rows),
    }
}

/// The ranked parameters.
fn parameters(
    table: &Table,
    rows: &[usize],
    given: &[String],
    replicates: &[String],
) -> Result<Vec<String>> {
    let names: Vec<&str> = table.parameters().map(|column| column.name.as_str()).collect();
    if given.is_empty() {
        let varies = |column: &&Column| compare::values(column, rows).len() > 1;
        let strategy = table.parameters().find(|column| column.name == "strategy").filter(varies);
        if strategy.is_some() {
            return Ok(vec!["strategy".to_owned()]);
        }
        let points = names.iter().filter(|name| !replicates.iter().any(|known| known == *name));
        return Ok(points.map(|name| (*name).to_owned()).collect());
    }
    let mut by: Vec<String> = Vec::new();
    for name in given.iter().map(|name| name.trim()) {
        if !names.contains(&name) {
            let near = did_you_mean(name, names.iter().copied());
            let allowed = match names.as_slice() {
                [] => "none: the study varies no parameter".to_owned(),
                names => names.join(", "),
            };
            let problem = "not a parameter the study varies";
            return Err(Error::invalid_option(
                "--by",
                name,
                problem,
                allowed,
                near.unwrap_or_default(),
            ));
        }
        if !by.iter().any(|known| known == name) {
            by.push(name.to_owned());
        }
    }
    Ok(by)
}

/// The measures, each with a better side.
fn measures(given: &[String]) -> Result<Vec<ColumnId>> {
    if given.is_empty() {
        return Ok(DEFAULT_MEASURES.to_vec());
    }
    let mut measures = Vec::new();
    for name in given.iter().map(|name| name.trim()) {
        let id = ColumnId::from_name(name);
        let id = id.filter(|id| id.column().better != BetterSide::Neither).ok_or_else(|| {
            let known =
                [measures_with(BetterSide::Smaller), measures_with(BetterSide::Larger)].concat();
            let near = did_you_mean(name, known.iter().copied()).unwrap_or_default();
            let problem = "not a measure of which smaller or larger is better";
            Error::invalid_option("--measures", name, problem, known.join(", "), near)
        })?;
        if !measures.contains(&id) {
            measures.push(id);
        }
    }
    Ok(measures)
}

#[cfg(test)]
mod tests;
