//! The ranges of what is assumed: material and heat transfer, of which no measurement decides.

use super::MeshErrors;
use crate::input::keys::{KEYS, position};
use crate::input::value::Value;

/// The keys that are assumed, in the order of the documentation.
pub const ASSUMED_KEYS: [&str; 2] = ["film.loss_factor", "gas.heat_transfer"];

/// The range of each of [`ASSUMED_KEYS`], SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssumedRanges(pub [[f64; 2]; ASSUMED_KEYS.len()]);

impl Default for AssumedRanges {
    /// The ranges of the table of mesh errors.
    fn default() -> Self {
        Self(core::array::from_fn(of_table))
    }
}

impl AssumedRanges {
    /// Leaves out what is not assumed: such a key keeps its value.
    pub fn leave_out(&mut self, is_known: impl Fn(&str) -> bool) {
        for (index, (key, range)) in ASSUMED_KEYS.iter().zip(&mut self.0).enumerate() {
            if is_known(key) {
                *range = [assumed_value(index); 2];
            }
        }
    }
}

/// Their positions among the keys: a row asks many times.
const POSITIONS: [usize; ASSUMED_KEYS.len()] =
    [position(KEYS, ASSUMED_KEYS[0]), position(KEYS, ASSUMED_KEYS[1])];

/// The value of one of [`ASSUMED_KEYS`] that the runs of the table have: the default of the key.
pub fn assumed_value(index: usize) -> f64 {
    match KEYS[POSITIONS[index]].default_value() {
        Value::Number(number) => number,
        _ => f64::NAN,
    }
}

/// Key and value of the name of a change, as in `film.loss_factor 0.003`.
fn key_and_value(name: &str) -> Option<(&str, f64)> {
    let (key, value) = name.split_once(' ')?;
    Some((key, value.parse().ok()?))
}

/// Smallest and largest value of a key for which the table has a change.
fn of_table(index: usize) -> [f64; 2] {
    let key = ASSUMED_KEYS[index];
    let values = MeshErrors::shipped().assumed.values().flat_map(|changes| changes.keys());
    let values = values.filter_map(|name| key_and_value(name).filter(|(of, _)| *of == key));
    let base = assumed_value(index);
    values.fold([base; 2], |[low, high], (_, value)| [low.min(value), high.max(value)])
}

impl AssumedRanges {
    /// The part of a change in the table that its range keeps, 0 to 1; with the key. Changes are even in ln of the value.
    pub fn part<'n>(&self, name: &'n str) -> Option<(&'n str, f64)> {
        let (key, value) = key_and_value(name)?;
        let index = ASSUMED_KEYS.iter().position(|known| *known == key)?;
        let ([low, high], base) = (self.0[index], assumed_value(index));
        let end = if value < base { low } else { high };
        Some((key, libm::log(end / base) / libm::log(value / base)))
    }
}
