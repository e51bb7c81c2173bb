//! `billow compare --rank`: orders strategies, or the values of other parameters, by limits and measures.

use std::fmt::Write as _;
use std::io::Write;

use super::Args;
use crate::analysis::compare::{self, measures_with};
use crate::analysis::ranking::{Basis, Ranking, RankingInput, default_measures};
use crate::cli::Format;
use crate::job::row::{BetterSide, DerivedColumn};
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::print::points::chosen_runs;
use crate::print::{MAX_VALUES, count};
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};
use crate::study::Study;

/// Prints one row per candidate, the best one first.
///
/// # Errors
/// An unknown parameter, measure or column; results of which nothing can be ranked.
pub(super) fn run(
    args: &Args,
    stored: &Stored<'_>,
    table: &Table,
    out: &mut dyn Write,
) -> Result<()> {
    let (study, replicates) = (&stored.study, stored.study.replicates_of_samples());
    let rows = rows(table, args.condition.as_deref(), &args.by, &replicates)?;
    let by = parameters(table, &rows, &args.by, &study.replicates())?;
    let measures = measures(&args.measures, table, study)?;
    let input = RankingInput {
        table,
        rows: &rows,
        by: &by,
        replicates: &replicates,
        limits: study.result_limits(),
        measures: &measures,
        zipped: &|name| study.zipped_with(name),
    };
    let ranking = Ranking::of(&input).map_err(|problem| {
        let allowed = "parameters of which two values have ended points that are equal in all else";
        let next = "finish the run, or rank by other parameters";
        Error::invalid_option("--by", &by.join(","), problem, allowed, next)
    })?;
    let format = args.output.format();
    let with_runs = replicates.iter().any(|name| !by.contains(name));
    let is_shown = |column: &Column| match column.name.as_str() {
        "safe_runs" | "deployed_runs" => with_runs && !column.is_empty(),
        "safe" => ranking.basis == Basis::Limits,
        "failed" | "smallest_margin" | "smallest_margin_of" => !column.is_empty(),
        _ => true,
    };
    super::print(&ranking.table(), &is_shown, format, out)?;
    if !args.quiet.quiet && format == Format::Table {
        let varies = |name: &&String| {
            let column = table.column(name);
            column.is_some_and(|column| compare::values(column, &rows).len() > 1)
        };
        let matched: Vec<String> = ranking.matched.iter().filter(varies).cloned().collect();
        for note in notes(&ranking, &measures.join(", "), &matched, study, with_runs) {
            eprintln!("{note}");
        }
    }
    Ok(())
}

/// How the candidates are ordered, over which points, and what is left out.
fn notes(
    ranking: &Ranking,
    measures: &str,
    matched: &[String],
    study: &Study,
    with_runs: bool,
) -> Vec<String> {
    let limits: Vec<String> = study.result_limits().iter().map(ToString::to_string).collect();
    let runs = |missed: &str| if with_runs { format!(", {missed}") } else { String::new() };
    let order = match ranking.basis {
        Basis::Limits => {
            format!("points not safe ({}){}, {measures}", limits.join(", "), runs("runs not safe"))
        }
        Basis::Verdicts => format!(
            "points not deployed{}, {measures} (the study has no limits)",
            runs("runs not deployed")
        ),
        Basis::Measures => format!("{measures} alone: no limits and no verdict"),
    };
    let mut notes = vec![format!("order: {order}")];
    if !matched.is_empty() {
        let mut names = matched.join(", ");
        if let Some((searched, _)) =
            study.searched().filter(|(name, _)| matched.iter().any(|n| n == name))
        {
            let _ = write!(names, " (of {searched} the values that every candidate has)");
        }
        let sets = count(ranking.sets, "set");
        notes.push(format!("over {sets} of points that are equal in {names}"));
    }
    if !ranking.carried.is_empty() {
        let by: Vec<&str> = ranking.by.iter().map(|column| column.name.as_str()).collect();
        let carried = ranking.carried.join(", ");
        notes.push(format!("note: {carried} changes with {}, so it is not matched", by.join(", ")));
    }
    for (values, reason) in ranking.left_out.iter().take(MAX_VALUES) {
        notes.push(format!("left out: {}: {reason}", ranking.label(values)));
    }
    let more = ranking.left_out.len().saturating_sub(MAX_VALUES);
    for (number, noun, why) in [
        (more, "more candidate", ""),
        (ranking.outside, "point", " without a partner at every candidate"),
        (ranking.not_ended, "point", " not ended, or infeasible"),
    ] {
        if number > 0 {
            notes.push(format!("left out: {}{why}", count(number, noun)));
        }
    }
    if ranking.not_trusted > 0 {
        notes.push(format!(
            "note: {} with a passage, an intersection or numerically_damped: the measures do not count",
            count(ranking.not_trusted, "point")
        ));
    }
    for measure in ranking.measures.iter().filter(|measure| measure.sets < ranking.sets) {
        let (name, sets) = (&measure.column.name, measure.sets);
        notes.push(format!(
            "note: {name} over {sets} of {} sets: the others lack it, or are the same jobs",
            ranking.sets
        ));
    }
    notes
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
    let replicates: Vec<String> =
        replicates.iter().filter(|name| !by.contains(name)).cloned().collect();
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
    for name in given.iter().map(String::as_str) {
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

/// The measures, each with a better side; in a study with limits `smallest_margin` too.
fn measures(given: &[String], table: &Table, study: &Study) -> Result<Vec<&'static str>> {
    if given.is_empty() {
        return Ok(default_measures(table, study.result_limits()));
    }
    let mut known =
        [measures_with(BetterSide::Smaller), measures_with(BetterSide::Larger)].concat();
    known.extend(study.result_limits().first().map(|_| DerivedColumn::SmallestMargin.name()));
    let mut measures = Vec::new();
    for name in given.iter().map(|name| name.trim()) {
        let found = known.iter().find(|known| **known == name).ok_or_else(|| {
            let near = did_you_mean(name, known.iter().copied()).unwrap_or_default();
            let problem = "not a measure of which smaller or larger is better";
            Error::invalid_option("--measures", name, problem, known.join(", "), near)
        })?;
        if !measures.contains(found) {
            measures.push(*found);
        }
    }
    Ok(measures)
}

#[cfg(test)]
#[path = "rank_tests.rs"]
mod tests;
