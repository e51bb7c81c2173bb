//! Quantities with units: a number is SI, a text carries its unit ("5 g/s", "40 mm", "30 deg").
//!
//! A unit is a product of base units m, kg, s, K, rad, B to whole powers, times a scale. A decimal scale
//! (`mm`, `g`, `bar`, `%`, and also `atm`, `in`, `h` in the numerator) is applied to the decimal digits
//! as written, and the result is rounded once: "40 mm" is 0.04 and "25.4 um" is 25.4e-6, bit for bit.
//! `deg` is converted in twice the working precision. Only a unit in the denominator that is not a
//! power of ten needs a second rounding.
//!
//! ```text
//! quantity = number unit            unit = product [ "/" product { "/" product } ]
//! product  = "(" product ")" | symbol [ ["^"] power ] { ["·" | "*"] symbol [ ["^"] power ] }      power: s-1, s^-1, s⁻¹
//! ```
//! Everything after the first `/` is in the denominator: W/m2K, W/m2 K and W/(m2 K) are the same.

mod decimal;
mod dimension;
mod display;
mod symbol;

pub use dimension::{Dimension, Powers, describe};
pub use display::{DisplayUnit, DisplayUnits, written_unit};

/// Why a text is not a quantity of a dimension.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitError {
    /// What is wrong.
    pub problem: String,
    /// What is allowed.
    pub allowed: String,
}

/// Reads a quantity with its unit, to SI.
///
/// # Errors
/// When the text is not a number with a unit, the unit is unknown or of another dimension, or the
/// number overflows; the error names the dimension and its units.
pub fn parse(text: &str, dimension: Dimension) -> Result<f64, UnitError> {
    parse_powers(text, dimension.powers()).map_err(|problem| UnitError {
        problem,
        allowed: format!("{}, with a unit: {}", dimension.name(), dimension.units().join(", ")),
    })
}

/// Whether a text is a unit, as "g/s".
pub fn is_unit(text: &str) -> bool {
    CELSIUS.contains(&text) || symbol::unit(text).is_ok()
}

/// Reads a quantity of any dimension, given as powers of the base units.
///
/// # Errors
/// The problem in words.
pub fn parse_powers(text: &str, wanted: Powers) -> Result<f64, String> {
    let text = text.trim();
    let (number, unit) =
        split(text).ok_or_else(|| "not a number followed by a unit, as in \"5 g/s\"".to_owned())?;
    if unit.is_empty() {
        return Err("has no unit; write the number without quotes if it is SI".to_owned());
    }
    if wanted == Dimension::Temperature.powers() && CELSIUS.contains(&unit) {
        return finite(decimal::shifted(number, ZERO_CELSIUS), text);
    }
    if wanted == Dimension::Temperature.powers() && FAHRENHEIT.contains(&unit) {
        let shifted = decimal::shifted(number, ZERO_FAHRENHEIT);
        return finite(shifted.map(|kelvins| kelvins * 5.0 / 9.0), text);
    }
    if unit.starts_with([',', '\'', '’']) {
        let problem = "has a separator in its number: a decimal point is a point, and digits stand together, as in";
        return Err(format!("{problem} \"1000.5 mm\""));
    }
    if STANDARD_FLOWS.contains(&unit) {
        return Err(format!(
            "{unit} is a volume at a standard state, another mass of each gas; write a mass flow rate here: of nitrogen, 1 SLPM \
             is 0.02083 g/s and 1 sccm 0.02083 mg/s"
        ));
    }
    let scale = symbol::unit(unit)?;
    if scale.powers != wanted {
        return Err(format!(
            "is {}, not {}",
            dimension::describe(scale.powers),
            dimension::describe(wanted)
        ));
    }
    finite(decimal::scaled(number, &scale), text)
}

/// Units of temperature with their zero at 0 °C.
const CELSIUS: [&str; 4] = ["degC", "°C", "celsius", "C"];

/// Units of temperature of 5/9 K with their zero at −459.67.
const FAHRENHEIT: [&str; 3] = ["degF", "°F", "F"];

/// 0 °F in 5/9 K, 459.67.
const ZERO_FAHRENHEIT: (i128, i32) = (45_967, -2);

/// Units of a flow that is no mass flow.
pub(crate) const STANDARD_FLOWS: [&str; 5] = ["SLPM", "slpm", "slm", "SCCM", "sccm"];

/// 0 °C in K, 273.15: 27315 hundredths.
const ZERO_CELSIUS: (i128, i32) = (27_315, -2);

fn finite(value: Option<f64>, text: &str) -> Result<f64, String> {
    match value {
        Some(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{text:?} is too large a number")),
    }
}

/// Splits "5 g/s" into number and unit; `None` when it does not start with a number.
fn split(text: &str) -> Option<(&str, &str)> {
    let (number, unit) = text.split_at(number_length(text)?);
    Some((number, unit.trim()))
}

/// Length of the number at the start of a text, bytes; `None` when it does not start with one.
pub(crate) fn number_length(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let digits =
        |start: usize| bytes.iter().skip(start).take_while(|byte| byte.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let whole = digits(sign(0));
    let mut end = sign(0) + whole;
    let mut count = whole;
    if bytes.get(end) == Some(&b'.') {
        count += digits(end + 1);
        end += 1 + digits(end + 1);
    }
    if count == 0 {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let start = end + 1 + sign(end + 1);
        end = if digits(start) > 0 { start + digits(start) } else { end };
    }
    Some(end)
}

#[cfg(test)]
mod tests;
