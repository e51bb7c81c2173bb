//! Readable units: values are SI in the program, but an axis shows 5 g/s, 32 ms and 1.2 kPa.

use crate::input::units::DisplayUnit;

/// The unit in which a column is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Symbol; empty for a pure number.
    pub symbol: String,
    /// Its size in the SI unit.
    size: f64,
    /// The unit that the study or an option asks for, in place of the size.
    chosen: Option<DisplayUnit>,
}

/// A unit for an SI quantity: symbol, size, and the largest value, in this unit, from which it is used.
type Choice = (&'static str, f64, f64);

/// Units by SI unit, the largest unit first.
const CHOICES: &[(&str, &[Choice])] = &[
    ("s", &[("s", 1.0, 1.0), ("ms", 1e-3, 1.0), ("µs", 1e-6, 0.0)]),
    ("m", &[("m", 1.0, 0.2), ("mm", 1e-3, 0.1), ("µm", 1e-6, 0.0)]),
    ("m2", &[("m²", 1.0, 0.1), ("cm²", 1e-4, 0.1), ("mm²", 1e-6, 0.0)]),
    ("m3", &[("m³", 1.0, 0.01), ("cm³", 1e-6, 0.0)]),
    ("kg", &[("kg", 1.0, 1.0), ("g", 1e-3, 0.01), ("mg", 1e-6, 0.0)]),
    ("kg/s", &[("kg/s", 1.0, 1.0), ("g/s", 1e-3, 0.01), ("mg/s", 1e-6, 0.0)]),
    ("m/s", &[("m/s", 1.0, 0.1), ("mm/s", 1e-3, 0.0)]),
    (
        "Pa",
        &[
            ("GPa", 1e9, 1.0),
            ("MPa", 1e6, 1.0),
            ("kPa", 1e3, 1.0),
            ("Pa", 1.0, 0.1),
            ("mPa", 1e-3, 0.0),
        ],
    ),
    ("J", &[("kJ", 1e3, 1.0), ("J", 1.0, 0.1), ("mJ", 1e-3, 0.1), ("µJ", 1e-6, 0.0)]),
    ("N", &[("kN", 1e3, 1.0), ("N", 1.0, 0.1), ("mN", 1e-3, 0.0)]),
    ("N/m", &[("kN/m", 1e3, 1.0), ("N/m", 1.0, 0.1), ("mN/m", 1e-3, 0.0)]),
    ("Hz", &[("kHz", 1e3, 1.0), ("Hz", 1.0, 0.0)]),
    ("rad", &[("°", std::f64::consts::PI / 180.0, 0.0)]),
];

impl Unit {
    /// The unit for values in an SI unit whose largest absolute value is `largest`.
    pub fn of(si: &str, largest: f64) -> Self {
        let choices = CHOICES.iter().find(|(known, _)| *known == si).map(|(_, choices)| *choices);
        let Some(choices) = choices else {
            return Self::si(si);
        };
        let chosen = if largest > 0.0 {
            // The factor allows for a rounding error.
            let fits = |(_, size, least): &&Choice| largest >= (1.0 - 1e-9) * size * least;
            choices.iter().find(fits)
        } else {
            choices.iter().find(|(_, size, _)| size.total_cmp(&1.0).is_eq())
        };
        let (symbol, size, _) = chosen.unwrap_or(&choices[choices.len() - 1]);
        Self { symbol: (*symbol).to_owned(), size: *size, chosen: None }
    }

    /// The SI unit itself.
    pub fn si(si: &str) -> Self {
        Self { symbol: raised(if si == "1" { "" } else { si }), size: 1.0, chosen: None }
    }

    /// The unit that the study or an option asks for; without one, the unit for these values.
    pub fn shown_in(
        display: &DisplayUnit,
        si: &str,
        values: impl IntoIterator<Item = f64>,
    ) -> Self {
        if !display.is_chosen() {
            return Self::fit(si, values);
        }
        let symbol = match display.symbol() {
            "um" => "µm".to_owned(),
            "deg" => "°".to_owned(),
            "degC" => "°C".to_owned(),
            symbol => raised(symbol),
        };
        Self { symbol, size: 1.0, chosen: Some(display.clone()) }
    }

    /// The unit for these values; non-finite values are ignored.
    pub fn fit(si: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let sizes = values.into_iter().filter(|value| value.is_finite()).map(f64::abs);
        Self::of(si, sizes.fold(0.0, f64::max))
    }

    /// An SI value in this unit.
    pub fn shown(&self, si: f64) -> f64 {
        if let Some(chosen) = &self.chosen {
            return chosen.number(si);
        }
        // Sizes below 1 are inexact powers of ten, but their reciprocals are exact.
        if self.size < 1e-2 && self.symbol != "°" {
            si * libm::round(1.0 / self.size)
        } else {
            si / self.size
        }
    }

    /// A number as text, followed by the unit.
    pub fn after(&self, text: &str) -> String {
        let gap = if self.symbol.is_empty() || self.symbol == "°" { "" } else { " " };
        format!("{text}{gap}{}", self.symbol)
    }

    /// A name followed by the unit: `pressure (kPa)`; a pure number has no unit.
    pub fn label(&self, name: &str) -> String {
        if self.symbol.is_empty() { name.to_owned() } else { format!("{name} ({})", self.symbol) }
    }
}

/// "kg/m3" as "kg/m³".
fn raised(si: &str) -> String {
    let mut text = String::with_capacity(si.len());
    let mut after_letter = false;
    for sign in si.chars() {
        text.push(match sign {
            '2' if after_letter => '²',
            '3' if after_letter => '³',
            other => other,
        });
        after_letter = sign.is_ascii_alphabetic();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_fit_the_values() {
        for (si, largest, symbol, shown) in [
            ("kg/s", 0.005, "g/s", 5.0),
            ("kg", 5e-5, "g", 0.05),
            ("s", 0.032, "ms", 32.0),
            ("s", 1.5, "s", 1.5),
            ("m", 0.97, "m", 0.97),
            ("m", 0.04, "mm", 40.0),
            ("m", 25.4e-6, "µm", 25.4),
            ("m3", 0.58, "m³", 0.58),
            ("Pa", 1200.0, "kPa", 1.2),
            ("Pa", 999.999_999_999_9, "kPa", 0.999_999_999_999_9),
            ("rad", std::f64::consts::PI, "°", 180.0),
            ("W/(m2 K)", 0.3, "W/(m² K)", 0.3),
            ("1", 12.0, "", 12.0),
            ("", 12.0, "", 12.0),
            ("K", 293.15, "K", 293.15),
            ("J", 0.0, "J", 0.0),
        ] {
            let unit = Unit::of(si, largest);
            assert_eq!(unit.symbol, symbol, "{si} {largest}");
            assert!((unit.shown(largest) - shown).abs() <= 1e-12 * shown, "{si} {largest}");
        }
        assert_eq!(Unit::fit("s", [f64::NAN, -0.02, 0.01]).label("t"), "t (ms)");
        assert_eq!(Unit::of("1", 1.0).label("N"), "N");
    }

    #[test]
    fn a_unit_that_is_asked_for_comes_first() {
        let unit = |symbol, si| {
            let display = DisplayUnit::new(symbol, si).unwrap();
            Unit::shown_in(&display, si, [0.0005])
        };
        assert_eq!(unit("m", "m").label("height"), "height (m)");
        assert_eq!(unit("um", "m").after("500"), "500 µm");
        assert_eq!(unit("degC", "K").label("T"), "T (°C)");
        assert!((unit("degC", "K").shown(293.15) - 20.0).abs() < 1e-12);
        let fitted = Unit::shown_in(&DisplayUnit::si("m"), "m", [0.0005]);
        assert_eq!(fitted.symbol, "mm");
    }
}
