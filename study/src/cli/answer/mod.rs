//! The answer of a study, as lines of text and as JSON keys.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use billow_solver::output::audit::MAX_LEDGER_RESIDUAL;
use billow_solver::output::measures::Verdict;

use super::best::{self, MAX_LINE_WIDTH, MAX_VALUES};
use super::print::count;
use crate::analysis::answer::{Answer, Effect, Effects, Extreme, HEADLINE, Trust};
use crate::input::value::{Value, brief_number, short_number};
use crate::job::Status;

mod json;

pub use json::json;

/// Characters before the text of a line: two spaces, the topic, a space.
const TOPIC_WIDTH: usize = 11;

/// Film stress over Young's modulus above which a note asks for a missing unit. Chosen: no film is linear
/// up to there, and short peaks of film that is pulled taut reach half of it.
const MAX_PLAUSIBLE_STRAIN: f64 = 0.1;

/// Prints the answer: one or two lines each for the deployed jobs, the fastest job, the jobs with the
/// highest velocity and energy, the audit, and every parameter with a few values.
pub fn print(answer: &Answer, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out)?;
    if !answer.question.is_empty() {
        writeln!(out, "{}", answer.question)?;
    }
    writeln!(out, "  deployed {}", deployed(answer))?;
    print_extremes(answer, out)?;
    if let Some(trust) = &answer.trust {
        writeln!(out, "  trust    {}", audit(trust))?;
    }
    if answer.largest_strain > MAX_PLAUSIBLE_STRAIN {
        writeln!(
            out,
            "  strain   film_stress is up to {} % of Young's modulus; the linear film model holds for \
             a few per cent: is a unit missing?",
            brief_number(100.0 * answer.largest_strain)
        )?;
    }
    print_effects(&answer.effects, out)
}

/// The medians of each parameter, its best and worst values, and what is not compared.
fn print_effects(effects: &Effects, out: &mut dyn Write) -> io::Result<()> {
    if !effects.effects.is_empty() {
        writeln!(
            out,
            "  medians  t_90_z_rim (s), peak_vz (m/s) per value, all other parameters being equal"
        )?;
    }
    let names = effects.effects.iter().map(|effect| name(effect).chars().count());
    let indent = names.max().unwrap_or(0);
    for effect in &effects.effects {
        for line in lines(effect, indent) {
            writeln!(out, "{line}")?;
        }
    }
    for (topic, texts) in [("best", best::lines(effects)), ("left out", best::left_out(effects))] {
        let mut topic = topic;
        for text in &texts {
            for line in best::wrapped(text, TOPIC_WIDTH) {
                writeln!(out, "  {topic:<8} {line}")?;
                topic = "";
            }
        }
    }
    Ok(())
}

/// The fastest job, and the jobs with the highest velocity and kinetic energy.
fn print_extremes(answer: &Answer, out: &mut dyn Write) -> io::Result<()> {
    if let Some(fastest) = &answer.fastest {
        let value = format!("t_90_z_rim {} s", brief_number(fastest.value));
        writeln!(out, "  fastest  {value}: {}", job_text(fastest))?;
    }
    let Some(hardest) = &answer.hardest else { return Ok(()) };
    let mut value = format!("peak_vz {} m/s", brief_number(hardest.value));
    let energy = answer.most_energy.as_ref();
    if let Some(same) = energy.filter(|energy| energy.job == hardest.job) {
        let _ = write!(value, ", peak_kinetic_energy {} J", brief_number(same.value));
    }
    writeln!(out, "  hardest  {value}: {}", job_text(hardest))?;
    if let Some(other) = energy.filter(|energy| energy.job != hardest.job) {
        let value = format!("peak_kinetic_energy {} J", brief_number(other.value));
        writeln!(out, "           {value}: {}", job_text(other))?;
    }
    Ok(())
}

/// Prints the commands that show more.
pub fn print_next(answer: &Answer, root: &Path, out: &mut dyn Write) -> io::Result<()> {
    let root = root.display();
    writeln!(out, "  next     billow table {root}")?;
    writeln!(out, "           billow chart {root}")?;
    // Compare a named choice (a strategy) first, then a quantity with a unit.
    let first_with =
        |unit: fn(&str) -> bool| answer.effects.effects.iter().find(|effect| unit(&effect.unit));
    let effect = first_with(str::is_empty).or_else(|| first_with(|unit| unit != "1"));
    if let Some(effect) = effect.or(answer.effects.effects.first())
        && let Some(base) = effect.values.first()
    {
        let base = shell_word(base);
        writeln!(out, "           billow compare {root} --by {} --base {base}", effect.parameter)?;
    }
    Ok(())
}

/// A value as one word of a shell command.
pub fn shell_word(value: &Value) -> String {
    let text = match value {
        Value::Number(number) => number.to_string(),
        other => other.to_string(),
    };
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_' | '+');
    if !text.is_empty() && text.chars().all(plain) { text } else { format!("{text:?}") }
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

fn job_text(extreme: &Extreme) -> String {
    let parameters: Vec<String> = extreme
        .parameters
        .iter()
        .map(|(name, value)| match value {
            Value::Number(number) => format!("{name}={}", short_number(*number)),
            other => format!("{name}={other}"),
        })
        .collect();
    let others = match extreme.others {
        0 => String::new(),
        others => format!(" (and {} with the same value)", count(others, "job")),
    };
    format!("job {} {}{others}", &extreme.job[..8.min(extreme.job.len())], parameters.join(" "))
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
    format!(
        "{} done; ledger residual at most {} (energy_drift above {MAX_LEDGER_RESIDUAL}); \
         {film}{damped}",
        count(trust.jobs, "job"),
        brief_number(trust.ledger_residual)
    )
}

/// A parameter with its unit, indented.
fn name(effect: &Effect) -> String {
    match effect.unit.as_str() {
        "" | "1" => format!("    {}", effect.parameter),
        unit => format!("    {} ({unit})", effect.parameter),
    }
}

/// One parameter: its values with both medians, on as many lines as needed.
fn lines(effect: &Effect, indent: usize) -> Vec<String> {
    let listed = effect.values.len() <= MAX_VALUES;
    let median = |measure, index: usize| {
        let effect = effect.measures.iter().find(|effect| effect.measure == measure);
        effect.and_then(|effect| effect.medians[index])
    };
    let mut parts: Vec<String> = effect
        .values
        .iter()
        .enumerate()
        .filter(|(index, _)| listed && HEADLINE.iter().any(|id| median(*id, *index).is_some()))
        .map(|(index, value)| {
            let medians = HEADLINE
                .map(|measure| median(measure, index).map_or_else(|| "-".to_owned(), brief_number));
            format!("{}: {}", best::value_text(value, ""), medians.join(", "))
        })
        .collect();
    if !listed {
        let values = effect.values.len();
        let name = &effect.parameter;
        parts.push(format!("{values} values: billow chart --measure peak_vz --over {name}"));
    }
    let with = if effect.carried.is_empty() {
        String::new()
    } else {
        format!(", {} with it", effect.carried.join(", "))
    };
    parts.push(format!("({}{with})", count(sets(effect), "set")));
    let mut lines = vec![format!("{:<indent$}", name(effect))];
    for part in parts {
        let length = lines.last().map_or(0, |line| line.chars().count());
        if length + 2 + part.chars().count() > MAX_LINE_WIDTH {
            lines.push(" ".repeat(indent));
        }
        if let Some(line) = lines.last_mut() {
            let _ = write!(line, "  {part}");
        }
    }
    lines
}

/// Number of sets of the measure with the most.
fn sets(effect: &Effect) -> usize {
    effect.measures.iter().map(|measure| measure.sets).max().unwrap_or(0)
}
