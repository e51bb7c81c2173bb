//! Unit symbols: known units, prefixes, and products of them.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::dimension::Powers;

/// A unit in base units: `factor` × 10^`exponent` / `divisor` × (π/180)^`degrees`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Scale {
    pub powers: Powers,
    pub exponent: i32,
    pub factor: u64,
    pub divisor: u64,
    pub degrees: i32,
}

impl Scale {
    const ONE: Self = Self { powers: [0; 6], exponent: 0, factor: 1, divisor: 1, degrees: 0 };

    /// `value` × (π/180)^degrees.
    pub fn apply_degrees(&self, value: f64) -> f64 {
        (0..self.degrees.abs()).fold(value, |value, _| {
            if self.degrees > 0 { radians(value) } else { value * 180.0 / PI }
        })
    }

    /// One over this unit; `None` on overflow.
    pub fn inverse(&self) -> Option<Self> {
        Self::ONE.times(self, -1)
    }

    /// Multiplies by `other` to the power `power`; `None` on overflow.
    fn times(mut self, other: &Self, power: i32) -> Option<Self> {
        for (exponent, added) in self.powers.iter_mut().zip(other.powers) {
            let sum = i32::from(*exponent) + i32::from(added) * power;
            *exponent = i8::try_from(sum).ok()?;
        }
        self.exponent = self.exponent.checked_add(other.exponent.checked_mul(power)?)?;
        self.degrees += other.degrees * power;
        for _ in 0..power.abs() {
            let (numerator, denominator) = if power > 0 {
                (other.factor, other.divisor)
            } else {
                (other.divisor, other.factor)
            };
            self.factor = self.factor.checked_mul(numerator)?;
            self.divisor = self.divisor.checked_mul(denominator)?;
        }
        Some(self)
    }
}

/// Symbol, powers of m kg s K rad B, factor, power of ten, whether it may have an SI prefix.
type Known = (&'static str, Powers, u64, i32, bool);

/// Powers of a pressure.
const PRESSURE: Powers = [-1, 1, -2, 0, 0, 0];

/// Every known unit without a prefix; `kg` is `g` with a prefix.
const KNOWN: &[Known] = &[
    ("m", [1, 0, 0, 0, 0, 0], 1, 0, true),
    ("g", [0, 1, 0, 0, 0, 0], 1, -3, true),
    ("s", [0, 0, 1, 0, 0, 0], 1, 0, true),
    ("K", [0, 0, 0, 1, 0, 0], 1, 0, true),
    ("rad", [0, 0, 0, 0, 1, 0], 1, 0, true),
    ("Pa", PRESSURE, 1, 0, true),
    ("N", [1, 1, -2, 0, 0, 0], 1, 0, true),
    ("J", [2, 1, -2, 0, 0, 0], 1, 0, true),
    ("W", [2, 1, -3, 0, 0, 0], 1, 0, true),
    ("Hz", [0, 0, -1, 0, 0, 0], 1, 0, true),
    ("bar", PRESSURE, 1, 5, true),
    ("l", [3, 0, 0, 0, 0, 0], 1, -3, true),
    ("L", [3, 0, 0, 0, 0, 0], 1, -3, true),
    ("gram", [0, 1, 0, 0, 0, 0], 1, -3, false),
    ("t", [0, 1, 0, 0, 0, 0], 1, 3, false),
    ("lb", [0, 1, 0, 0, 0, 0], 45_359_237, -8, false),
    ("sec", [0, 0, 1, 0, 0, 0], 1, 0, false),
    ("min", [0, 0, 1, 0, 0, 0], 60, 0, false),
    ("h", [0, 0, 1, 0, 0, 0], 3600, 0, false),
    ("atm", PRESSURE, 101_325, 0, false),
    ("Torr", PRESSURE, 13_332_236_842_105_263, -14, false),
    ("mmHg", PRESSURE, 133_322_387_415, -9, false),
    ("psi", PRESSURE, 6_894_757_293_168_361, -12, false),
    ("ksi", PRESSURE, 6_894_757_293_168_361, -9, false),
    ("cc", [3, 0, 0, 0, 0, 0], 1, -6, false),
    ("micron", [1, 0, 0, 0, 0, 0], 1, -6, false),
    ("in", [1, 0, 0, 0, 0, 0], 254, -4, false),
    ("mil", [1, 0, 0, 0, 0, 0], 254, -7, false),
    ("ft", [1, 0, 0, 0, 0, 0], 3048, -4, false),
    ("B", [0, 0, 0, 0, 0, 1], 1, 0, false),
    ("kB", [0, 0, 0, 0, 0, 1], 1, 3, false),
    ("MB", [0, 0, 0, 0, 0, 1], 1, 6, false),
    ("GB", [0, 0, 0, 0, 0, 1], 1, 9, false),
    ("TB", [0, 0, 0, 0, 0, 1], 1, 12, false),
    ("KiB", [0, 0, 0, 0, 0, 1], 1 << 10, 0, false),
    ("MiB", [0, 0, 0, 0, 0, 1], 1 << 20, 0, false),
    ("GiB", [0, 0, 0, 0, 0, 1], 1 << 30, 0, false),
    ("TiB", [0, 0, 0, 0, 0, 1], 1 << 40, 0, false),
    ("%", [0, 0, 0, 0, 0, 0], 1, -2, false),
    ("1", [0, 0, 0, 0, 0, 0], 1, 0, false),
];

/// SI prefixes and their powers of ten.
const PREFIXES: &[(&str, i32)] = &[
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("n", -9),
    ("p", -12),
];

/// One symbol, with its prefix.
fn symbol(name: &str) -> Option<Scale> {
    if matches!(name, "deg" | "°") {
        return Some(Scale { powers: [0, 0, 0, 0, 1, 0], degrees: 1, ..Scale::ONE });
    }
    let found = |&(_, powers, factor, exponent, _): &Known, prefix: i32| Scale {
        powers,
        exponent: exponent + prefix,
        factor,
        ..Scale::ONE
    };
    if let Some(known) = KNOWN.iter().find(|known| known.0 == name) {
        return Some(found(known, 0));
    }
    if name == "kgK" {
        // A product that is often written without a space.
        return symbol("kg")?.times(&symbol("K")?, 1);
    }
    PREFIXES.iter().find_map(|&(prefix, exponent)| {
        let base = name.strip_prefix(prefix)?;
        let known = KNOWN.iter().find(|known| known.0 == base && known.4)?;
        Some(found(known, exponent))
    })
}

/// Length of the longest unit read, bytes (chosen: a unit is a few symbols).
const MAX_UNIT_LENGTH: usize = 64;

/// Reads a unit.
pub(super) fn unit(text: &str) -> Result<Scale, String> {
    let unknown = || format!("has an unknown unit {text:?}");
    if text.len() > MAX_UNIT_LENGTH {
        return Err("is not a number followed by a unit".to_owned());
    }
    let mut scale = Scale::ONE;
    let mut parts = text.split('/');
    let numerator = parts.next().unwrap_or_default();
    scale = product(scale, numerator, 1).ok_or_else(unknown)?;
    for denominator in parts {
        scale = product(scale, denominator, -1).ok_or_else(unknown)?;
    }
    Ok(scale)
}

/// Multiplies `scale` by a product of symbols, all to the power `sign`.
fn product(mut scale: Scale, text: &str, sign: i32) -> Option<Scale> {
    let text = text.trim();
    let text = match text.strip_prefix('(') {
        Some(inner) => inner.strip_suffix(')')?,
        None => text,
    };
    if text.trim().is_empty() {
        return None;
    }
    let chars: Vec<char> = text.chars().map(plain).collect();
    let mut position = 0;
    while position < chars.len() {
        if matches!(chars[position], ' ' | '·' | '⋅' | '*') {
            position += 1;
            continue;
        }
        let start = position;
        if chars[position] == '1' {
            position += 1;
        } else {
            while position < chars.len()
                && (chars[position].is_alphabetic() || matches!(chars[position], '%' | '°'))
            {
                position += 1;
            }
        }
        let name: String = chars[start..position].iter().collect();
        let known = symbol(&name)?;
        let mut power = String::new();
        if chars.get(position) == Some(&'^') {
            position += 1;
        }
        if chars.get(position) == Some(&'-') {
            power.push('-');
            position += 1;
        }
        while chars.get(position).is_some_and(char::is_ascii_digit) {
            power.push(chars[position]);
            position += 1;
        }
        let power: i32 = match power.as_str() {
            "" if chars.get(position.wrapping_sub(1)) != Some(&'^') => 1,
            digits => digits.parse().ok().filter(|power: &i32| (-9..=9).contains(power))?,
        };
        scale = scale.times(&known, sign * power)?;
    }
    Some(scale)
}

/// A plain digit for a superscript one, a plain space for any other space.
fn plain(c: char) -> char {
    match c {
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        '⁻' | '−' => '-',
        '\u{a0}' | '\u{202f}' | '\t' => ' ',
        other => other,
    }
}

/// `degrees` × π / 180 in twice the working precision, rounded once, so that 30° is π/6 to the last
/// bit.
fn radians(degrees: f64) -> f64 {
    /// π − its nearest double.
    const PI_REMAINDER: f64 = 1.224_646_799_147_353_2e-16;
    if !(1e-200..1e200).contains(&degrees.abs()) {
        // The error terms leave the range of doubles; no design has such an angle.
        return degrees * (PI / 180.0);
    }
    let (product, error) = exact_product(degrees, PI);
    let error = error + degrees * PI_REMAINDER;
    let quotient = product / 180.0;
    let (back, back_error) = exact_product(quotient, 180.0);
    quotient + ((product - back) - back_error + error) / 180.0
}

/// a × b as a rounded product and its exact error.
fn exact_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, libm::fma(a, b, -product))
}
