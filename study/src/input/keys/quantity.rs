//! The numbers that keys may hold: quantities with a unit, and whole numbers.

use std::fmt::Write as _;

use crate::input::units::Dimension;
use crate::input::value::short_number;

/// The numbers a quantity may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Dimension.
    pub dimension: Dimension,
    /// Lower bound, SI.
    pub min: f64,
    /// Whether `min` itself is refused.
    pub above: bool,
    /// Upper bound, SI; allowed.
    pub max: f64,
    /// Range outside of which a unit is probably missing, SI; 0 is always plausible. `None` where no
    /// range is.
    pub plausible: Option<[f64; 2]>,
    /// Words that stand for a number.
    pub words: &'static [(&'static str, f64)],
}

impl Quantity {
    /// The range with its SI unit, as in "above 0 to 100 m".
    pub fn range(&self) -> String {
        let unit = if self.dimension == Dimension::Number { "" } else { self.dimension.si() };
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let from = if self.above { "above " } else { "from " };
        format!("{from}{} to {}{unit}", short_number(self.min), short_number(self.max))
    }

    /// The plausible range with its SI unit, as in "0 to 0.02 kg".
    pub fn plausible_range(&self) -> Option<String> {
        let [low, high] = self.plausible?.map(short_number);
        Some(format!("{low} to {high} {}", self.dimension.si()))
    }

    /// Whether a number is in the plausible range.
    pub fn is_plausible(&self, number: f64) -> bool {
        let within = |[low, high]: [f64; 2]| (low..=high).contains(&number);
        number == 0.0 || self.plausible.is_none_or(within)
    }

    /// What the quantity allows, in words.
    pub(super) fn allowed(&self) -> String {
        let mut text = format!("{} {}", self.dimension.name(), self.range());
        if self.dimension != Dimension::Number {
            let _ = write!(
                text,
                ", as a number in {} or a text with a unit ({})",
                self.dimension.si(),
                self.dimension.units().join(", ")
            );
        }
        for (word, _) in self.words {
            let _ = write!(text, ", or {word:?}");
        }
        text
    }
}
