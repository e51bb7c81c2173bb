//! The answer of a study, as lines of text and as JSON keys.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use billow_solver::output::audit::MAX_LEDGER_RESIDUAL;
use billow_solver::output::measures::Verdict;

use crate::analysis::answer::{Answer, Extreme, Trust};
use crate::analysis::ranking::Ranking;
use crate::input::units::{self, Dimension, DisplayUnit};
use crate::input::value::{Value, brief_number};
use crate::job::Status;
use crate::job::row::ColumnId;
use crate::platform::quote;
use crate::print::{count, wrapped};
use crate::store::table::Column;

mod border;
mod comparisons;
mod headline;
mod json;
mod optimum;
mod safe;
mod tolerances;

pub use headline::choice;
pub use json::json;

/// Characters before the text of a line: two spaces, the topic, a space.
const TOPIC_WIDTH: usize = 11;

/// Film stress over Young's modulus above which a note asks for a missing unit. Chosen: no film is linear
/// up to there, and short peaks of film that is pulled taut reach half of it.
const MAX_PLAUSIBLE_STRAIN: f64 = 0.1;

/// Lines of an answer about one thing.
pub struct Topic {
    /// What they are about, one word or two.
    pub name: &'static str,
    /// The lines, not wrapped.
    pub lines: Vec<String>,
    /// Whether long lines are wrapped in print.
    wraps: bool,
}

/// The answer: the assumptions, the deployed jobs, the safe points, each search of a border, the jobs with the extreme
/// values, the audit, and which value of every parameter is better. No topic is empty.
pub fn topics(answer: &Answer) -> Vec<Topic> {
    let deployed = match &answer.points {
        Some(points) => safe::deployed(points, &answer.counts),
        None => deployed(answer),
    };
    let wrapped = |name, lines| Topic { name, lines, wraps: true };
    let whole = |name, lines| Topic { name, lines, wraps: false };
    let strain = (answer.largest_strain > MAX_PLAUSIBLE_STRAIN).then(|| {
        format!(
            "film_stress is up to {} % of Young's modulus; the linear film model holds for a few per cent: check the \
             unit of film.youngs_modulus, or read these jobs with care",
            brief_number(100.0 * answer.largest_strain)
        )
    });
    let samples = !answer.tolerances.is_empty();
    let mut topics = vec![
        wrapped("answer", headline::headline(answer).into_iter().collect()),
        wrapped("assumed", vec![answer.assumptions.join("; ")]),
        wrapped("deployed", vec![deployed]),
        wrapped("moving", moving(answer.still_moving).into_iter().collect()),
        wrapped("depends", answer.sensitivity.iter().map(safe::sensitivity).collect()),
        wrapped("safe", answer.safety.iter().map(safe::safe).collect()),
        // Samples say it better.
        wrapped("mixed", if samples { Vec::new() } else { safe::mixed(&answer.mixed) }),
        wrapped("optimum", answer.optimum.iter().flat_map(optimum::lines).collect()),
        wrapped("samples", tolerances::lines(&answer.tolerances)),
        wrapped("matters", tolerances::of_grid(&answer.importance)),
        // The border is what a study with a search asks for, so it stands before the single jobs.
        wrapped("border", answer.searches.iter().flat_map(border::lines).collect()),
    ];
    topics.extend(extremes(answer).into_iter().map(|(name, lines)| whole(name, lines)));
    topics.push(whole("trust", answer.trust.iter().map(audit).collect()));
    topics.push(whole("strain", strain.into_iter().collect()));
    topics.push(wrapped("compared", comparisons::lines(answer)));
    topics.push(wrapped("left out", comparisons::left_out(answer)));
    topics.retain(|topic| !topic.lines.is_empty());
    topics
}

/// Prints the question and the topics of the answer.
pub fn print(answer: &Answer, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out)?;
    if !answer.question.is_empty() {
        writeln!(out, "{}", quote::printable(&answer.question))?;
    }
    for Topic { mut name, lines, wraps } in topics(answer) {
        let split = |line: String| if wraps { wrapped(&line, TOPIC_WIDTH) } else { vec![line] };
        for line in lines.into_iter().flat_map(split) {
            writeln!(out, "  {name:<8} {line}")?;
            name = "";
        }
    }
    Ok(())
}

/// The worst values of what is limited, the fastest job, and the highest kinetic energy and velocity. Values of one job
/// stand in one line; those of a single job are neither best nor worst.
fn extremes(answer: &Answer) -> Vec<(&'static str, Vec<String>)> {
    let is_shown = |extreme: &&Extreme| answer.worst.iter().all(|w| w.measure != extreme.measure);
    let hardest = answer.most_energy.iter().chain(&answer.hardest).filter(is_shown);
    if answer.counts.jobs() == 1 {
        let fastest = answer.fastest.iter().filter(is_shown);
        let all: Vec<&Extreme> = answer.worst.iter().chain(fastest).chain(hardest).collect();
        let values: Vec<String> = all.iter().map(|extreme| value_text(extreme)).collect();
        let line = all.first().map(|first| format!("{}: {}", values.join(", "), job_text(first)));
        return vec![("measured", line.into_iter().collect())];
    }
    [
        ("worst", answer.worst.iter().collect::<Vec<_>>()),
        ("fastest", answer.fastest.iter().filter(is_shown).collect()),
        ("hardest", hardest.collect()),
    ]
    .map(|(topic, extremes): (&str, Vec<&Extreme>)| {
        let line = |same: &[&Extreme]| {
            let values: Vec<String> = same.iter().map(|extreme| value_text(extreme)).collect();
            format!("{}: {}", values.join(", "), job_text(same[0]))
        };
        (topic, extremes.chunk_by(|a, b| a.job == b.job).map(line).collect())
    })
    .to_vec()
}

/// Prints the commands that show more.
pub fn print_next(answer: &Answer, root: &Path, out: &mut dyn Write) -> io::Result<()> {
    let root = quote::path(root);
    writeln!(out, "  next     billow table {root}")?;
    writeln!(out, "           billow chart {root}")?;
    if answer.safety.is_some() && answer.optimum.is_none() {
        writeln!(out, "           billow compare {root} --rank")?;
    }
    if answer.searches.is_some() {
        writeln!(out, "           billow table {root} --borders")?;
    }
    // The table of mesh errors names a method only where it reaches.
    let trust = answer.trust.as_ref();
    let in_table = trust.is_some_and(|t| t.no_error_reason.is_none() && t.pilots.is_none());
    if answer.safety.as_ref().is_some_and(|safety| safety.counts.uncertain > 0) {
        if answer.searches.is_some() {
            // A search judges single runs: it has no values from two meshes.
            writeln!(out, "           billow plan {root}/study.json --set design.subdivisions=8")?;
        } else if !answer.is_from_mesh && in_table {
            // It names methods with smaller errors.
            writeln!(out, "           billow plan {root}/study.json --accuracy \"15 %\"")?;
        }
    }
    // Compare a named choice (a strategy) first, then a quantity with a unit.
    let ranked = answer.comparisons.iter().filter_map(|(_, ranking)| ranking.as_ref().ok());
    let ranked: Vec<&Ranking> = ranked.collect();
    let first_with = |unit: fn(&str) -> bool| {
        ranked.iter().find(|ranking| ranking.by.iter().all(|column| unit(&column.unit)))
    };
    let ranking = first_with(str::is_empty).or_else(|| first_with(|unit| unit != "1"));
    if let Some(ranking) = ranking.or(ranked.first())
        && let (Some(by), Some(best)) = (ranking.by.first(), ranking.candidates.first())
    {
        let base = match &best.values[0] {
            Value::Number(number) => exact(by, *number),
            other => other.to_string(),
        };
        writeln!(
            out,
            "           billow compare {root} --by {} --base {}",
            by.name,
            quote::word(&base)
        )?;
    }
    Ok(())
}

/// A value of a parameter with its unit, if the text gives the number to the last bit; in SI otherwise.
fn exact(by: &Column, si: f64) -> String {
    let unit = &by.shown;
    let text = format!("{} {}", unit.number(si), unit.symbol());
    let dimension = Dimension::all().find(|known| known.si() == by.unit);
    let read = dimension.and_then(|dimension| units::parse(&text, dimension).ok());
    if read == Some(si) && unit.symbol() != by.unit { text } else { si.to_string() }
}

/// What to do about runs that ended too early.
pub fn moving(runs: usize) -> Option<String> {
    (runs > 0).then(|| {
        format!(
            "{} did not deploy and still moved at the end: a longer solver.end_time may change the verdict and \
             what a search finds",
            count(runs, "run")
        )
    })
}

fn deployed(answer: &Answer) -> String {
    let counts = &answer.counts;
    let jobs = counts.jobs();
    let mut text = format!("{} of {}", counts.with(Verdict::Deployed), count(jobs, "job"));
    for (number, noun) in [
        (counts.with(Verdict::Partial), Verdict::Partial.name()),
        (counts.with(Verdict::Stalled), Verdict::Stalled.name()),
        (counts.failed(), "failed"),
        (counts.of(Status::Pending), Status::Pending.name()),
    ] {
        if number > 0 {
            let _ = write!(text, ", {number} {noun}");
        }
    }
    if counts.near_threshold > 0 {
        let _ = write!(text, ", {} near a threshold", counts.near_threshold);
    }
    let infeasible = counts.of(Status::Infeasible);
    if infeasible > 0 {
        let _ = write!(text, "; {} infeasible", count(infeasible, "point"));
    }
    text
}

/// A measure with its value, and what is to be known about it.
fn value_text(extreme: &Extreme) -> String {
    let mut notes = Vec::new();
    if ColumnId::from_name(&extreme.measure).is_some_and(ColumnId::is_noisy) {
        notes.push("noisy".to_owned());
    }
    if extreme.extrapolated {
        notes.push("extrapolated".to_owned());
    }
    if !extreme.trusted {
        notes.push("not trusted".to_owned());
    }
    if extreme.within_mesh_error > 0 {
        let points = count(extreme.within_mesh_error, "other point");
        notes.push(format!("{points} within the mesh error"));
    }
    let notes = if notes.is_empty() { String::new() } else { format!(" ({})", notes.join(", ")) };
    format!("{} {}{notes}", extreme.measure, extreme.shown.brief(extreme.value))
}

fn job_text(extreme: &Extreme) -> String {
    let others = match extreme.others {
        0 => String::new(),
        others => format!(" (and {} with the same value)", count(others, "job")),
    };
    let parameters = parameters_text(&extreme.parameters);
    format!("job {} {parameters}{others}", short_id(&extreme.job))
}

/// The first digits of a job id.
fn short_id(job: &str) -> &str {
    &job[..8.min(job.len())]
}

fn parameters_text(parameters: &[(String, Value, DisplayUnit)]) -> String {
    let text = |(name, value, unit): &(String, Value, DisplayUnit)| {
        format!("{name}={}", unit.quantity(value))
    };
    parameters.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// The audit of all done jobs.
fn audit(trust: &Trust) -> String {
    let film = match (trust.passages, trust.intersections) {
        (None, None) => "passages and intersections: not counted by this model".to_owned(),
        (passages, intersections) => {
            let number = |counted: Option<i64>| {
                counted.map_or_else(|| "not counted".to_owned(), |n| n.to_string())
            };
            let jobs = if trust.counted < trust.jobs {
                format!(" ({} counted)", count(trust.counted, "job"))
            } else {
                String::new()
            };
            format!("passages {}, intersections {}{jobs}", number(passages), number(intersections))
        }
    };
    let damped = match trust.numerically_damped {
        0 => String::new(),
        jobs => format!("; {} numerically_damped", count(jobs, "job")),
    };
    let not_trusted = match trust.not_trusted {
        0 => String::new(),
        jobs if jobs == trust.jobs => "; no job can be trusted".to_owned(),
        jobs => {
            format!("; fastest and hardest ignore {} that cannot be trusted", count(jobs, "job"))
        }
    };
    let without_error = trust.no_error_reason.as_ref().map_or_else(String::new, |reason| {
        format!("; mesh error of {} not known: {reason}", count(trust.without_error, "job"))
    });
    let of_pilots =
        trust.pilots.as_ref().map_or_else(String::new, |text| format!("; mesh error: {text}"));
    format!(
        "{} done; ledger residual at most {} (allowed: {MAX_LEDGER_RESIDUAL}); \
         {film}{damped}{not_trusted}{without_error}{of_pilots}",
        count(trust.jobs, "job"),
        brief_number(trust.ledger_residual)
    )
}
