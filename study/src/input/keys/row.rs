//! How the rows of the tables of keys are written, and found at compile time.

use super::key::{Default, Key, KeyKind};
use super::quantity::Quantity;
use crate::input::units::Dimension;

/// A row of a table.
pub(super) const fn key(
    path: &'static str,
    kind: KeyKind,
    default: Default,
    example: &'static str,
    doc: &'static str,
) -> Key {
    Key { path, kind, default, doc, example, study_only: false, excludes: &[] }
}

/// A quantity from `min` to `max`, both allowed.
pub(super) const fn from(dimension: Dimension, min: f64, max: f64) -> KeyKind {
    KeyKind::Quantity(Quantity { dimension, min, above: false, max, plausible: None, words: &[] })
}

/// A quantity above `min`, up to and including `max`.
pub(super) const fn above(dimension: Dimension, min: f64, max: f64) -> KeyKind {
    KeyKind::Quantity(Quantity { dimension, min, above: true, max, plausible: None, words: &[] })
}

/// Three quantities, each from −`max` to `max`.
pub(super) const fn vector(dimension: Dimension, max: f64) -> KeyKind {
    KeyKind::Vector(Quantity {
        dimension,
        min: -max,
        above: false,
        max,
        plausible: None,
        words: &[],
    })
}

/// The same quantity, with its plausible range.
pub(super) const fn likely(kind: KeyKind, low: f64, high: f64) -> KeyKind {
    let plausible = Some([low, high]);
    match kind {
        KeyKind::Quantity(quantity) => KeyKind::Quantity(Quantity { plausible, ..quantity }),
        other => other,
    }
}

/// Position of a key in a table. In a `const` block, a name that the table does not have is a compile
/// error.
///
/// # Panics
/// When no key of the table has this path.
pub const fn position(keys: &[Key], path: &str) -> usize {
    let mut index = 0;
    while index < keys.len() {
        if same_text(keys[index].path, path) {
            return index;
        }
        index += 1;
    }
    panic!("no key of this table has this path")
}

/// The key of a table with this path. In a `const` block, a name that the table does not have is a
/// compile error.
///
/// # Panics
/// When no key of the table has this path.
pub const fn named(keys: &'static [Key], path: &str) -> &'static Key {
    &keys[position(keys, path)]
}

/// Whether two texts are equal, at compile time.
pub(super) const fn same_text(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut index = 0;
    while index < a.len() {
        if a[index] != b[index] {
            return false;
        }
        index += 1;
    }
    true
}

impl Key {
    /// The same key, for study files only.
    pub(super) const fn study_only(self) -> Self {
        Self { study_only: true, ..self }
    }

    /// The same key; setting it removes the values of these.
    pub(super) const fn excludes(self, excludes: &'static [&'static str]) -> Self {
        Self { excludes, ..self }
    }
}
