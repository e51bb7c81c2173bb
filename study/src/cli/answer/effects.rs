//! Lines of the answer on the effect of each parameter.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::TOPIC_WIDTH;
use crate::analysis::answer::{Effect, Effects};
use crate::cli::best::{self, MAX_LINE_WIDTH, MAX_VALUES};
use crate::cli::print::count;
use crate::input::units::DisplayUnit;
use crate::input::value::brief_number;
use crate::job::row::{ColumnId, HEADLINE};

/// The medians of each parameter, its best and worst values, and what is not compared. With limits the safest values are
/// the best ones, which `billow rank` orders.
pub(super) fn print(effects: &Effects, is_asked: bool, out: &mut dyn Write) -> io::Result<()> {
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
    let best = if is_asked { Vec::new() } else { best::lines(effects) };
    for (topic, texts) in [("best", best), ("left out", best::left_out(effects))] {
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
pub(super) fn sets(effect: &Effect) -> usize {
    effect.measures.iter().map(|measure| measure.sets).max().unwrap_or(0)
}
