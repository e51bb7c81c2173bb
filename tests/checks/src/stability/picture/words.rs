//! Audits, times and borders in few letters.

use billow_solver::output::audit_kind::AuditKind;

use crate::stability::cell::Cell;
use crate::stability::file::Map;
use crate::stability::map::Border;
use billow_study::input::value::{brief_number, short_number};

/// The letter of an audit; empty for one without a letter.
pub(super) fn letter(audit: &str) -> &'static str {
    let kind = AuditKind::ALL.into_iter().find(|kind| kind.name() == audit);
    match (kind, audit) {
        (Some(AuditKind::FiniteMotion), _) => "M",
        (Some(AuditKind::EnergySource), _) => "S",
        (Some(AuditKind::Stretch), _) => "X",
        (Some(AuditKind::EnergyLedger), _) => "L",
        (Some(AuditKind::GasBalance), _) => "G",
        (Some(AuditKind::Volume), _) => "V",
        (Some(AuditKind::StepLimit), _) => "N",
        (Some(AuditKind::Motion), _) => "W",
        (Some(AuditKind::Mass), _) => "A",
        (Some(AuditKind::Pressure), _) => "U",
        (Some(AuditKind::Contact), _) => "C",
        (Some(AuditKind::Passages), _) => "P",
        (Some(AuditKind::Intersections), _) => "I",
        (None, "scene_check") => "R",
        (None, "panic") => "!",
        (None, "iteration_limit") => "K",
        (None, "stalled") => "T",
        (None, "not_finite") => "Q",
        _ => "",
    }
}

/// A number to two digits.
pub(super) fn two_digits(number: f64) -> f64 {
    format!("{number:.1e}").parse().unwrap_or(f64::NAN)
}

/// A time with two digits and its unit.
pub(super) fn short_time(seconds: f64) -> String {
    let units = [(1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns")];
    let rounded = |factor: f64| two_digits(seconds * factor);
    let fits = |(factor, _): &&(f64, &str)| rounded(*factor) >= 1.0;
    match units.iter().find(fits) {
        Some((factor, unit)) => format!("{} {unit}", short_number(rounded(*factor))),
        None => "0 s".to_owned(),
    }
}

/// A number with one digit.
pub(super) fn rough(number: f64) -> String {
    let rounded: f64 = format!("{number:.0e}").parse().unwrap_or(f64::NAN);
    if rounded == 0.0 { "0".to_owned() } else { format!("{rounded:e}") }
}

/// What stands below the shape of a cell: time of the failure, residual of a run that is done, Newton steps.
pub(super) fn below(cell: &Cell, is_static: bool) -> String {
    if is_static {
        cell.steps.to_string()
    } else if cell.is_done() {
        cell.residual.map_or(String::new(), rough)
    } else {
        short_time(cell.time)
    }
}

/// A border in words; `None` where the outcome does not change.
pub fn border_text(map: &Map, border: &Border) -> Option<String> {
    let search = map.search?;
    let name = map.axes[search.axis].parameter.name;
    let value = border.value?;
    let at = border.at.map_or(String::new(), |at| {
        format!(", {} {}", map.axes[1 - search.axis].parameter.name, brief_number(at))
    });
    let theory =
        border.of_theory.map_or(String::new(), |ratio| format!(", {ratio:.4} of 2/omega_max"));
    let method = border.method.name();
    Some(format!("border {method}{at}: {name} {} ({}){theory}", brief_number(value), border.status))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_two_digits_and_a_unit() {
        let times = [
            (0.0, "0 s"),
            (3.433e-6, "3.4 µs"),
            (0.020_4, "20 ms"),
            (1.5, "1.5 s"),
            (4e-9, "4 ns"),
        ];
        for (seconds, text) in times {
            assert_eq!(short_time(seconds), text);
        }
        assert_eq!(short_time(9.99e-4), "1 ms");
        assert_eq!([rough(2.4e-5), rough(0.0), rough(0.16)], ["2e-5", "0", "2e-1"]);
    }

    #[test]
    fn every_audit_has_a_letter_and_letters_differ() {
        let letters: std::collections::BTreeSet<&str> =
            AuditKind::ALL.iter().map(|kind| letter(kind.name())).collect();
        assert_eq!(letters.len(), AuditKind::ALL.len());
        assert!(!letters.contains(""));
        assert_eq!(letter("none"), "");
    }
}
