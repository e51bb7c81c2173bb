//! Lines of the answer on pairs of values of a choice: which one is gentler.

use std::fmt::Write as _;

use crate::analysis::answer::{Loads, MeasureVersus, Versus};
use crate::cli::best;
use crate::cli::print::count;
use crate::input::value::brief_number;

/// One line per pair of values.
pub(super) fn lines(pairwise: &[Versus]) -> Vec<String> {
    pairwise.iter().map(line).collect()
}

fn line(versus: &Versus) -> String {
    let (value, than) = (&versus.value, &versus.than);
    let head = match versus.loads {
        Loads::Gentler => format!("{value} is gentler than {than}"),
        Loads::MostlyGentler => format!("{value} is mostly gentler than {than}"),
        Loads::Equal => format!("{value} and {than} are equally gentle"),
        Loads::Mixed => format!("mixed, neither {value} nor {than} is gentler"),
        Loads::Unknown => format!("{value} and {than}"),
    };
    let mut parts: Vec<String> = Vec::new();
    for measure in &versus.measures {
        parts.extend(part(measure, versus, parts.is_empty()));
    }
    let is_gentler = matches!(versus.loads, Loads::Gentler | Loads::MostlyGentler);
    for (only, number, but) in [
        (value, versus.only_value, ""),
        (than, versus.only_than, if is_gentler { "but " } else { "" }),
    ] {
        if number > 0 {
            parts.push(format!(
                "{but}only {only} deploys in {number} of {}",
                count(versus.pairs, "pair")
            ));
        }
    }
    if parts.is_empty() {
        parts.push(format!("no trusted measure in {}", count(versus.pairs, "pair")));
    }
    format!("{head}: {}", parts.join("; "))
}

/// One measure; `first` says what the numbers are.
fn part(measure: &MeasureVersus, versus: &Versus, first: bool) -> Option<String> {
    let name = measure.measure.name();
    let all = if first { count(measure.pairs, "pair") } else { measure.pairs.to_string() };
    let mut texts = Vec::new();
    if measure.pairs > 0 && measure.ties == measure.pairs {
        texts.push(format!("{name} equal within {} in {all}", best::within(&measure.tolerance)));
    } else if measure.pairs > 0 {
        let lower = measure.lower >= measure.higher;
        let (main, most, other, least) = if lower {
            ("lower", measure.lower, "higher", measure.higher)
        } else {
            ("higher", measure.higher, "lower", measure.lower)
        };
        let mut text = format!("{main} {name} in {most} of {all}");
        for (noun, number) in [(other, least), ("equal", measure.ties)] {
            if number > 0 {
                let _ = write!(text, ", {noun} in {number}");
            }
        }
        if let Some(ratio) = measure.ratio {
            let noun = if first { "median ratio " } else { "" };
            let _ = write!(text, " ({noun}{})", brief_number(ratio));
        }
        texts.push(text);
    }
    for (only, number) in [(&versus.value, measure.only_value), (&versus.than, measure.only_than)] {
        if number > 0 {
            texts.push(format!("only {only} has {name} in {number}"));
        }
    }
    (!texts.is_empty()).then(|| texts.join(", "))
}
