//! Units in which quantities are shown. Inside the program every quantity is SI; tables, answers and
//! charts for readers show it in the unit that the study file writes, or in SI.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::symbol::{self, Scale};
use super::{CELSIUS, ZERO_CELSIUS, decimal, dimension, split};
use crate::input::value::{Value, brief_number};

/// Suffix of a column whose name a parameter of the study has.
const RESOLVED: &str = "_resolved";

/// The unit in which one quantity is shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DisplayUnit {
    /// As the user writes it; "1" for a pure number, empty for what has no unit.
    symbol: String,
    conversion: Conversion,
    /// Whether the study or an option asks for it.
    chosen: bool,
}

/// How an SI number becomes the shown one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum Conversion {
    /// It stays as it is.
    Identity,
    /// It is multiplied by this scale.
    Scale(Scale),
    /// The zero moves from 0 K to 0 °C.
    Celsius,
}

impl DisplayUnit {
    /// The SI unit itself; "1" for a pure number, empty for what has no unit.
    pub fn si(si: &str) -> Self {
        Self { symbol: si.to_owned(), conversion: Conversion::Identity, chosen: false }
    }

    /// A unit of the dimension that the SI unit `si` has.
    ///
    /// # Errors
    /// The problem in words: `si` has no unit, the symbol is unknown or of another dimension.
    pub fn new(symbol: &str, si: &str) -> Result<Self, String> {
        let symbol = symbol.trim();
        if symbol == si {
            return Ok(Self { chosen: true, ..Self::si(si) });
        }
        let wanted = symbol::unit(si).map_err(|_| "is a unit of what has none".to_owned())?.powers;
        if wanted == dimension::Dimension::Temperature.powers() && CELSIUS.contains(&symbol) {
            let symbol = symbol.to_owned();
            return Ok(Self { symbol, conversion: Conversion::Celsius, chosen: true });
        }
        let (scale, symbol) = (symbol::unit(symbol)?, symbol.to_owned());
        if scale.powers != wanted {
            return Err(format!(
                "is {}, not {}",
                dimension::describe(scale.powers),
                dimension::describe(wanted)
            ));
        }
        let inverse = scale.inverse().ok_or("is too large a unit")?;
        Ok(Self { symbol, conversion: Conversion::Scale(inverse), chosen: true })
    }

    /// Whether the study or an option asks for this unit. A chart takes a unit that fits its values
    /// otherwise.
    pub fn is_chosen(&self) -> bool {
        self.chosen
    }

    /// Its symbol; empty for a pure number and for what has no unit.
    pub fn symbol(&self) -> &str {
        if self.symbol == "1" { "" } else { &self.symbol }
    }

    /// An SI number in this unit. Decimal units shift the point of the shortest digits, so 0.005 kg/s
    /// is 5 g/s to the last bit.
    pub fn number(&self, si: f64) -> f64 {
        let shown = match self.conversion {
            _ if !si.is_finite() => None,
            Conversion::Identity => None,
            Conversion::Scale(scale) => decimal::scaled(&format!("{si:e}"), &scale),
            Conversion::Celsius => {
                decimal::shifted(&format!("{si:e}"), (-ZERO_CELSIUS.0, ZERO_CELSIUS.1))
            }
        };
        shown.unwrap_or(si)
    }

    /// The unit of a difference of two such quantities: a temperature in °C has its differences in K.
    #[must_use]
    pub fn of_difference(&self) -> Self {
        match self.conversion {
            Conversion::Celsius => Self::si("K"),
            _ => self.clone(),
        }
    }

    /// An SI value in this unit. Texts, flags and empty values stay, and so do whole numbers that no
    /// conversion changes.
    pub fn value(&self, si: &Value) -> Value {
        match (si, self.conversion) {
            (Value::Number(number), _) => Value::Number(self.number(*number)),
            (Value::Integer(number), Conversion::Scale(_) | Conversion::Celsius) => {
                Value::Number(self.number(*number as f64))
            }
            (other, _) => other.clone(),
        }
    }

    /// An SI value in this unit as text, without the unit: six significant digits.
    pub fn text(&self, si: &Value) -> String {
        self.value(si).short()
    }

    /// An SI value as text with its unit, as in "5 g/s".
    pub fn quantity(&self, si: &Value) -> String {
        match si {
            Value::Integer(_) | Value::Number(_) => self.after(self.text(si)),
            other => other.to_string(),
        }
    }

    /// An SI number as text with its unit and four significant digits, for a line of text.
    pub fn brief(&self, si: f64) -> String {
        self.after(brief_number(self.number(si)))
    }

    /// A name with the unit: `mass_flow_rate (g/s)`; a pure number has none.
    pub fn label(&self, name: &str) -> String {
        if self.symbol().is_empty() {
            name.to_owned()
        } else {
            format!("{name} ({})", self.symbol())
        }
    }

    /// A number as text, followed by the unit.
    fn after(&self, text: String) -> String {
        match self.symbol() {
            "" => text,
            symbol @ ("%" | "°") => format!("{text}{symbol}"),
            symbol => format!("{text} {symbol}"),
        }
    }
}

/// The units in which a study's quantities are shown, by name of parameter or column. A name without
/// an entry is shown in SI.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DisplayUnits {
    symbols: BTreeMap<String, String>,
    /// Whether SI is asked for where a name has no entry.
    all_si: bool,
}

impl DisplayUnits {
    /// Every quantity in SI, as nothing else is asked for.
    pub fn si() -> Self {
        Self::default()
    }

    /// Every quantity in SI, as asked for.
    pub fn all_si() -> Self {
        Self { all_si: true, ..Self::default() }
    }

    /// Shows the quantity of this name in a unit.
    pub fn set(&mut self, name: &str, symbol: &str) {
        self.symbols.insert(name.to_owned(), symbol.trim().to_owned());
    }

    /// Shows the quantity of this name in a unit, unless it has one already.
    pub fn suggest(&mut self, name: &str, symbol: &str) {
        let entry = self.symbols.entry(name.to_owned());
        entry.or_insert_with(|| symbol.trim().to_owned());
    }

    /// Names and symbols, in the order of the names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.symbols.iter().map(|(name, symbol)| (name.as_str(), symbol.as_str()))
    }

    /// The unit in which a parameter or column with this SI unit is shown. A key has its short name; a
    /// column that a parameter shadows (`NAME_resolved`) has the unit of NAME.
    pub fn of(&self, name: &str, si: &str) -> DisplayUnit {
        let symbol = self
            .symbols
            .get(name)
            .or_else(|| self.symbols.get(name.strip_suffix(RESOLVED).unwrap_or(name)));
        let unit = symbol.and_then(|symbol| DisplayUnit::new(symbol, si).ok());
        unit.unwrap_or_else(|| DisplayUnit { chosen: self.all_si, ..DisplayUnit::si(si) })
    }
}

/// The unit of a text with a unit, as in "g/s" of "5 g/s"; `None` for a word or a number alone.
pub fn written_unit(text: &str) -> Option<&str> {
    split(text.trim()).map(|(_, unit)| unit).filter(|unit| !unit.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_shown_in_the_unit_that_was_written() {
        for (si_unit, symbol, si, shown, text) in [
            ("kg/s", "g/s", 0.005, 5.0, "5 g/s"),
            ("kg", "g", 5e-5, 0.05, "0.05 g"),
            ("m", "um", 25.4e-6, 25.4, "25.4 um"),
            ("m", "in", 0.0762, 3.0, "3 in"),
            ("Pa", "GPa", 3.45e9, 3.45, "3.45 GPa"),
            ("rad", "deg", std::f64::consts::FRAC_PI_6, 30.0, "30 deg"),
            ("K", "degC", 293.15, 20.0, "20 degC"),
            ("s", "min", 6.0, 0.1, "0.1 min"),
            ("kg/s", "kg/h", 0.005, 18.0, "18 kg/h"),
            ("1", "%", 0.015, 1.5, "1.5%"),
            ("m/s", "m/s", 12.5, 12.5, "12.5 m/s"),
            ("N/m", "mN/m", 0.25, 250.0, "250 mN/m"),
        ] {
            let unit = DisplayUnit::new(symbol, si_unit).unwrap();
            let number = unit.number(si);
            assert!((number - shown).abs() <= 1e-15 * shown.abs(), "{si} {si_unit}: {number}");
            assert_eq!(unit.quantity(&Value::Number(si)), text);
        }
        assert_eq!(
            DisplayUnit::new("g/s", "kg/s").unwrap().number(0.005).to_bits(),
            5.0_f64.to_bits()
        );
    }

    #[test]
    fn what_has_no_such_unit_stays_si() {
        assert_eq!(DisplayUnit::new("kg", "m").unwrap_err(), "is a mass, not a length");
        assert!(DisplayUnit::new("m", "").is_err());
        let mut units = DisplayUnits::si();
        units.set("height", "mm");
        units.suggest("height", "km");
        assert_eq!(units.of("height", "m").symbol(), "mm");
        assert_eq!(units.of("height_resolved", "m").symbol(), "mm");
        assert_eq!(units.of("height", "kg"), DisplayUnit::si("kg"));
        assert!(units.of("height", "m").is_chosen() && !units.of("width", "m").is_chosen());
        assert!(DisplayUnits::all_si().of("width", "m").is_chosen());
        assert_eq!(units.of("N", "1").label("N"), "N");
        let unit = units.of("height", "m");
        assert_eq!(unit.label("height"), "height (mm)");
        assert_eq!(unit.value(&Value::Integer(1)), Value::Number(1000.0));
        assert_eq!(unit.quantity(&Value::Text("free".to_owned())), "free");
        assert_eq!(unit.quantity(&Value::Null), "null");
        assert!(unit.number(f64::NAN).is_nan());
    }

    #[test]
    fn the_written_unit_is_found() {
        for (text, unit) in
            [("5 g/s", Some("g/s")), ("25.4um", Some("um")), ("isothermal", None), ("5", None)]
        {
            assert_eq!(written_unit(text), unit, "{text}");
        }
    }
}
