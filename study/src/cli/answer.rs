//! The answer of a study as lines of text and as JSON keys.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use billow_solver::output::audit::MAX_LEDGER_RESIDUAL;
use serde_json::{Map, json};

use super::print::count;
use crate::analysis::answer::{Answer, Effect, Extreme, MEDIANS, Trust};
use crate::input::value::{Value, brief_number, json_value, short_number};
use crate::job::Status;

/// Characters a line of medians may have.
const WIDTH: usize = 120;

/// Film stress over Young's modulus above which no film bears it linearly; where film that opens at speed
/// is pulled taut, it reaches half of that for a moment.
const STRETCHED: f64 = 0.1;

/// Prints the answer: about a line each for what deployed, the fastest job, the hardest, the trust,
/// and every parameter of a few values.
pub fn print(answer: &Answer, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out)?;
    if !answer.question.is_empty() {
        writeln!(out, "{}", answer.question)?;
    }
    writeln!(out, "  deployed {}", deployed(answer))?;
    if let Some(fastest) = &answer.fastest {
        let value = format!("t_90_z_rim {} s", brief_number(fastest.value));
        writeln!(out, "  fastest  {value}: {}", of_job(fastest))?;
    }
    if let Some(hardest) = &answer.hardest {
        let mut value = format!("peak_vz {} m/s", brief_number(hardest.value));
        let energy = answer.most_energy.as_ref();
        if let Some(same) = energy.filter(|energy| energy.job == hardest.job) {
            let _ = write!(value, ", peak_kinetic_energy {} J", brief_number(same.value));
        }
        writeln!(out, "  hardest  {value}: {}", of_job(hardest))?;
        if let Some(other) = energy.filter(|energy| energy.job != hardest.job) {
            let value = format!("peak_kinetic_energy {} J", brief_number(other.value));
            writeln!(out, "           {value}: {}", of_job(other))?;
        }
    }
    if let Some(trust) = &answer.trust {
        writeln!(out, "  trust    {}", trusted(trust))?;
    }
    if answer.stretch > STRETCHED {
        writeln!(
            out,
            "  stretch  film_stress is up to {} % of Young's modulus, where the linear law of the film \
             holds for a few: is there a unit missing?",
            brief_number(100.0 * answer.stretch)
        )?;
    }
    if !answer.effects.is_empty() {
        writeln!(
            out,
            "  medians  t_90_z_rim (s), peak_vz (m/s) by value, over jobs equal in all else"
        )?;
    }
    let indent = answer.effects.iter().map(|own| name(own).chars().count()).max().unwrap_or(0);
    for effect in &answer.effects {
        for line in lines(effect, indent) {
            writeln!(out, "{line}")?;
        }
    }
    Ok(())
}

/// What to look at next.
pub fn print_next(answer: &Answer, root: &Path, out: &mut dyn Write) -> io::Result<()> {
    let root = root.display();
    writeln!(out, "  next     billow table {root}")?;
    writeln!(out, "           billow chart {root}")?;
    // A choice, as of a strategy, asks to be compared first, then a quantity.
    let of = |unit: fn(&str) -> bool| answer.effects.iter().find(|effect| unit(&effect.unit));
    let named = of(str::is_empty).or_else(|| of(|unit| unit != "1"));
    if let Some(effect) = named.or(answer.effects.first())
        && let Some((base, _)) = effect.values.first()
    {
        let base = word(base);
        writeln!(out, "           billow compare {root} --by {} --base {base}", effect.parameter)?;
    }
    Ok(())
}

/// A value as a shell takes it.
pub fn word(value: &Value) -> String {
    let text = match value {
        Value::Number(number) => number.to_string(),
        other => other.to_string(),
    };
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_' | '+');
    if !text.is_empty() && text.chars().all(plain) { text } else { format!("{text:?}") }
}

fn deployed(answer: &Answer) -> String {
    let counts = &answer.counts;
    let of = |verdict: &str| counts.verdict.get(verdict).copied().unwrap_or(0);
    let jobs = counts.jobs();
    let mut text = format!("{} of {}", of("deployed"), count(jobs, "job"));
    for (number, word) in [
        (of("partial"), "partial"),
        (of("stalled"), "stalled"),
        (counts.failed(), "failed"),
        (counts.of(Status::Pending), "pending"),
    ] {
        if number > 0 {
            let _ = write!(text, ", {number} {word}");
        }
    }
    if counts.near_threshold > 0 {
        let _ = write!(text, ", {} close to a threshold", counts.near_threshold);
    }
    let infeasible = counts.of(Status::Infeasible);
    if infeasible > 0 {
        let _ = write!(text, "; {} infeasible", count(infeasible, "point"));
    }
    text
}

fn of_job(extreme: &Extreme) -> String {
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
        others => format!(" (and {} with it)", count(others, "job")),
    };
    format!("job {} {}{others}", &extreme.job[..8.min(extreme.job.len())], parameters.join(" "))
}

fn trusted(trust: &Trust) -> String {
    let film = match (trust.passages, trust.intersections) {
        (None, None) => "passages and intersections: not counted by this model".to_owned(),
        (passages, intersections) => {
            let number =
                |own: Option<i64>| own.map_or_else(|| "not counted".to_owned(), |n| n.to_string());
            let of = if trust.counted < trust.jobs {
                format!(" ({} counted)", count(trust.counted, "job"))
            } else {
                String::new()
            };
            format!("passages {}, intersections {}{of}", number(passages), number(intersections))
        }
    };
    format!(
        "{} done; ledger residual at most {} (energy_drift above {MAX_LEDGER_RESIDUAL}); {film}",
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

/// One parameter: its values with both medians, broken where the line would be too long.
fn lines(effect: &Effect, indent: usize) -> Vec<String> {
    let mut parts: Vec<String> = effect
        .values
        .iter()
        .map(|(value, medians)| {
            let value = match value {
                Value::Number(number) => short_number(*number),
                other => other.to_string(),
            };
            let medians = medians.map(|own| own.map_or_else(|| "-".to_owned(), brief_number));
            format!("{value}: {}", medians.join(", "))
        })
        .collect();
    let with = if effect.carried.is_empty() {
        String::new()
    } else {
        format!(", {} with it", effect.carried.join(", "))
    };
    parts.push(format!("({}{with})", count(effect.sets, "set")));
    let mut lines = vec![format!("{:<indent$}", name(effect))];
    for part in parts {
        let length = lines.last().map_or(0, |line| line.chars().count());
        if length + 2 + part.chars().count() > WIDTH {
            lines.push(" ".repeat(indent));
        }
        if let Some(line) = lines.last_mut() {
            let _ = write!(line, "  {part}");
        }
    }
    lines
}

/// The same as keys.
pub fn json(answer: &Answer) -> serde_json::Value {
    let parameters = |extreme: &Extreme| {
        let own = extreme.parameters.iter();
        own.map(|(name, value)| (name.clone(), json_value(value))).collect::<Map<_, _>>()
    };
    let extreme = |own: &Option<Extreme>, measure: &str| {
        own.as_ref().map(|own| {
            let mut keys = Map::new();
            keys.insert("job".to_owned(), own.job.as_str().into());
            keys.insert("parameters".to_owned(), parameters(own).into());
            keys.insert(measure.to_owned(), own.value.into());
            keys.insert("others".to_owned(), own.others.into());
            keys
        })
    };
    let effects = answer.effects.iter().map(|effect| {
        let values = effect.values.iter().map(|(value, medians)| {
            let mut keys = Map::new();
            keys.insert("value".to_owned(), json_value(value));
            for (measure, median) in MEDIANS.iter().zip(medians) {
                keys.insert(measure.name().to_owned(), json!(median));
            }
            serde_json::Value::from(keys)
        });
        json!({
            "parameter": effect.parameter,
            "unit": effect.unit,
            "with_it": effect.carried,
            "sets": effect.sets,
            "values": values.collect::<Vec<_>>(),
        })
    });
    let trust = answer.trust.map(|trust| {
        json!({
            "jobs": trust.jobs,
            "ledger_residual": trust.ledger_residual,
            "gas_residual": trust.gas_residual,
            "passages": trust.passages,
            "intersections": trust.intersections,
            "counted": trust.counted,
            "film_stress_over_modulus": answer.stretch,
        })
    });
    json!({
        "question": answer.question,
        "jobs": answer.counts.jobs(),
        "near_threshold": answer.counts.near_threshold,
        "fastest": extreme(&answer.fastest, "t_90_z_rim"),
        "hardest": extreme(&answer.hardest, "peak_vz"),
        "most_energy": extreme(&answer.most_energy, "peak_kinetic_energy"),
        "trust": trust,
        "medians": effects.collect::<Vec<_>>(),
    })
}
