//! The answer of a study, as lines of text and as JSON keys.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use billow_solver::output::audit::MAX_LEDGER_RESIDUAL;
use billow_solver::output::measures::Verdict;

use super::best::{self, MAX_LINE_WIDTH, MAX_VALUES};
use super::print::count;
use crate::analysis::answer::{Answer, Effect, Effects, Extreme, Trust};
use crate::input::units::{self, Dimension, DisplayUnit};
use crate::input::value::{Value, brief_number};
use crate::job::Status;
use crate::job::row::{ColumnId, HEADLINE};

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
        writeln!(out, "{}", crate::platform::quote::printable(&answer.question))?;
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
             a few per cent: check the unit of film.youngs_modulus, or read these jobs with care",
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
            "  medians  {} per value, all other parameters being equal",
            HEADLINE.map(|measure| headline(effects, measure)).join(", ")
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

/// A headline measure with the unit of its medians.
fn headline(effects: &Effects, measure: ColumnId) -> String {
    let measures = effects.effects.iter().flat_map(|effect| &effect.measures);
    let mut shown = measures.filter(|effect| effect.measure == measure).map(|effect| &effect.shown);
    let si = DisplayUnit::si(measure.column().unit);
    shown.next().unwrap_or(&si).label(measure.name())
}

/// The fastest job, and the jobs with the highest velocity and kinetic energy.
fn print_extremes(answer: &Answer, out: &mut dyn Write) -> io::Result<()> {
    if let Some(fastest) = &answer.fastest {
        let value = format!("{} {}", HEADLINE[0].name(), fastest.shown.brief(fastest.value));
        writeln!(out, "  fastest  {value}: {}", job_text(fastest))?;
    }
    let Some(energy) = &answer.most_energy else { return Ok(()) };
    let mut value = format!("peak_kinetic_energy {}", energy.shown.brief(energy.value));
    let speed = answer.hardest.as_ref();
    if let Some(same) = speed.filter(|speed| speed.job == energy.job) {
        let _ = write!(value, ", peak_vz {}", same.shown.brief(same.value));
    }
    writeln!(out, "  hardest  {value}: {}", job_text(energy))?;
    if let Some(other) = speed.filter(|speed| speed.job != energy.job) {
        let value = format!("peak_vz {} (noisy)", other.shown.brief(other.value));
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
        let base = match base {
            Value::Number(number) => shell_word(&Value::Text(exact(effect, *number))),
            other => shell_word(other),
        };
        writeln!(out, "           billow compare {root} --by {} --base {base}", effect.parameter)?;
    }
    Ok(())
}

/// A value of a parameter with its unit, if the text gives the number to the last bit; in SI otherwise.
fn exact(effect: &Effect, si: f64) -> String {
    let unit = &effect.shown;
    let text = format!("{} {}", unit.number(si), unit.symbol());
    let dimension = Dimension::ALL.into_iter().find(|known| known.si() == effect.unit);
    let read = dimension.and_then(|dimension| units::parse(&text, dimension).ok());
    if read == Some(si) && unit.symbol() != effect.unit { text } else { si.to_string() }
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
        .map(|(name, value, unit)| format!("{name}={}", unit.quantity(value)))
        .collect();
    let others = match extreme.others {
        0 => String::new(),
        others => format!(" (and {} with the same value)", count(others, "job")),
    };
    format!("job {} {}{others}", &extreme.job[..8.min(extreme.job.len())], parameters.join(", "))
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
    format!("    {}", effect.shown.label(&effect.parameter))
}

/// One parameter: its values with both medians, on as many lines as needed.
fn lines(effect: &Effect, indent: usize) -> Vec<String> {
    let listed = effect.values.len() <= MAX_VALUES;
    let median = |measure, index: usize| {
        let effect = effect.measures.iter().find(|effect| effect.measure == measure)?;
        effect.medians[index].map(|median| effect.shown.number(median))
    };
    let mut parts: Vec<String> = effect
        .values
        .iter()
        .enumerate()
        .filter(|(index, _)| listed && HEADLINE.iter().any(|id| median(*id, *index).is_some()))
        .map(|(index, value)| {
            let medians = HEADLINE
                .map(|measure| median(measure, index).map_or_else(|| "-".to_owned(), brief_number));
            format!("{}: {}", effect.shown.text(value), medians.join(", "))
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
