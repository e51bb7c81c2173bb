//! Values outside the plausible range of their key: probably a forgotten or mistaken unit. Such a value is
//! used; a warning says what it means in SI and what to write.

use crate::input::json::Json;
use crate::input::keys::{Key, KeyKind, Quantity};
use crate::input::syntax::parse;
use crate::input::units::{self, Dimension, DisplayUnit, written_unit};
use crate::input::value::{Value, short_number};

/// Why a value is not plausible.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Implausible {
    /// What is wrong, with the plausible range.
    pub problem: String,
    /// What to write.
    pub next: String,
}

/// The warning about a value of a key; `None` for a plausible one.
pub(crate) fn check(key: &Key, json: &Json, value: &Value) -> Option<Implausible> {
    let (KeyKind::Quantity(quantity), Value::Number(number)) = (key.kind, value) else {
        return None;
    };
    if quantity.is_plausible(*number) {
        return None;
    }
    let si = quantity.dimension.si();
    if let Json::Text(text) = json {
        let unit = written_unit(text).and_then(|unit| DisplayUnit::new(unit, si).ok());
        let unit = unit.unwrap_or_else(|| DisplayUnit::si(si));
        let [low, high] = quantity.plausible?.map(|bound| short_number(unit.number(bound)));
        return Some(Implausible {
            problem: format!("is outside the plausible range, {low} to {high} {}", unit.symbol()),
            next: "check number and unit; the run uses the value as written".to_owned(),
        });
    }
    Some(Implausible {
        problem: format!(
            "is {} {si}, outside the plausible range, {}: is a unit missing?",
            short_number(*number),
            quantity.plausible_range()?
        ),
        next: match with_unit(key, &quantity, *number) {
            Some(text) => format!("if {text} is meant, write {text:?}"),
            None => format!("write the unit with the number, as in {}", key.sample()),
        },
    })
}

/// What a number without a unit probably means that the key refuses, as in "25 um" for a thickness of
/// 25; `None` for any other value.
pub(crate) fn meant(key: &Key, json: &Json) -> Option<String> {
    let KeyKind::Quantity(quantity) = key.kind else { return None };
    let number = match json {
        Json::Integer(number) => *number as f64,
        Json::Number(number) => *number,
        _ => return None,
    };
    with_unit(key, &quantity, number)
}

/// The number with the unit that makes it plausible, as in "0.05 g"; of several units the one whose
/// value is nearest to the example of the key. `None` if no unit does.
fn with_unit(key: &Key, quantity: &Quantity, number: f64) -> Option<String> {
    let dimension = quantity.dimension;
    let example = parse(key.example, "example").map(|json| quantity.read(&json));
    let Ok(Ok(Value::Number(typical))) = example else { return None };
    let distance = |si: f64| (libm::log(si.abs()) - libm::log(typical.abs())).abs();
    let texts = dimension.units().iter().skip(usize::from(dimension != Dimension::Number));
    let candidates = texts.filter_map(|unit| {
        let text = format!("{} {unit}", short_number(number));
        let si = units::parse(&text, dimension).ok()?;
        (si != 0.0 && quantity.is_plausible(si)).then(|| (distance(si), text))
    });
    let nearest = candidates.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map(|(_, text)| text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::keys::{KEYS, named};

    #[test]
    fn a_value_outside_the_plausible_range_has_a_warning_with_what_is_meant() {
        for (path, json, meant) in [
            ("gas.residual_gas_mass", "0.05", "\"0.05 g\""),
            ("gas.mass_flow_rate", "1", "\"1 g/s\""),
            ("solver.end_time", "500", "\"500 ms\""),
            ("film.density", "1.4", "\"1.4 g/cm3\""),
            ("film.temperature", "20", "\"20 degC\""),
            ("design.height", "100", "\"100 cm\""),
            // A written unit is not called missing.
            ("gas.residual_gas_mass", "\"50 g\"", "check number and unit"),
            ("gas.residual_gas_mass", "5e-5", ""),
            ("gas.residual_gas_mass", "0", ""),
            ("gas.mass_flow_rate", "\"5 g/s\"", ""),
            ("gas.heat_transfer", "\"isothermal\"", ""),
            ("film.loss_factor", "0.5", ""),
        ] {
            let key = KEYS.iter().find(|key| key.path == path).unwrap();
            let json = parse(json, "test").unwrap();
            let warning = check(key, &json, &key.read(&json).unwrap());
            let next = warning.map(|warning| warning.next).unwrap_or_default();
            assert!(next.contains(meant) && next.is_empty() == meant.is_empty(), "{path}: {next}");
        }
    }

    #[test]
    fn a_refused_number_gets_a_unit_as_well() {
        const THICKNESS: &Key = named(KEYS, "film.thickness");
        assert_eq!(meant(THICKNESS, &Json::Integer(25)), Some("25 um".to_owned()));
        assert_eq!(meant(THICKNESS, &Json::Integer(0)), None);
    }
}
