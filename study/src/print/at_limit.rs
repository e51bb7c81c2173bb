//! A limit in words: the value with its uncertainty and the parts of it, and how far it is from the limit.

use std::fmt::Write as _;

use crate::analysis::at_limit::AtLimit;
use crate::input::value::{Value, brief_number};
use crate::job::result_limit::{Condition, Judged, Safety};
use crate::print::range;

/// The value, as in `peak_vz 18.6 −2.1 +0.8 m/s (mesh −2.1 +0.7, assumed −0.3 +0.4), 7 % below 20 m/s`; with the least and the
/// largest value over the `seeds`, SI, as in a table: `18.6 [18.1 to 18.9] −2.1 +0.8 m/s`.
pub fn at_limit(one: &AtLimit, seeds: Option<[f64; 2]>) -> String {
    let name = one.limit.measure.name();
    let Value::Number(value) = one.value else {
        return match (&one.value, one.judged) {
            (Value::Null, _) => format!("{name} has no value, asked {}", one.limit.text),
            (word, judged) => format!("{name} {word}, asked {}{}", one.limit.text, doubt(judged)),
        };
    };
    let (unit, difference) = (&one.shown, one.shown.of_difference());
    let ends = seeds.map(|[least, largest]| (least, largest));
    let mut text =
        format!("{name} {} {}", range::text(value, ends, one.uncertainty, unit), unit.symbol());
    text.truncate(text.trim_end().len());
    if let (Some(mesh), Some(assumed)) = (one.mesh_error, one.assumed) {
        let sides = |sides: [f64; 2]| {
            let [below, above] = sides.map(|side| brief_number(difference.number(side)));
            if below == above { below } else { format!("−{below} +{above}") }
        };
        let _ = write!(text, " (mesh {}, assumed {})", sides(mesh), sides(assumed));
    }
    if let (Condition::Bound { bound, .. }, Some(judged)) = (&one.limit.condition, one.judged) {
        let side = if value < *bound { "below" } else { "above" };
        let limit = unit.brief(*bound);
        let distance = if *bound == 0.0 {
            difference.brief(value.abs())
        } else {
            format!("{} %", brief_number(100.0 * judged.margin.abs()))
        };
        let _ = write!(text, ", {distance} {side} {limit}{}", doubt(one.judged));
    }
    text
}

/// What is to be known of a value that is near its limit, or whose error is not known.
fn doubt(judged: Option<Judged>) -> &'static str {
    match judged {
        Some(Judged { uncertainty: None, .. }) => "; its error is not known",
        Some(judged) if judged.safety() == Safety::Uncertain => "; within its uncertainty",
        _ => "",
    }
}
