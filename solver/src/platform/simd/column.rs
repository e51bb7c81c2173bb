//! Columns of `f64` values that start on a cache line.
//!
//! The first value of a [`Column`] is aligned to 64 bytes, so that a group of eight values never
//! spans two cache lines.

use core::fmt;
use core::ops::{Deref, DerefMut};

use serde::{Deserialize, Serialize};

use super::{Lanes, WIDTH, Wide};

/// A column of values; it dereferences to a slice.
#[derive(Clone, Default, Serialize, Deserialize)]
#[serde(from = "Vec<f64>", into = "Vec<f64>")]
pub struct Column {
    /// The values in groups of eight; values from `length` on are padding.
    lanes: Vec<Lanes>,
    length: usize,
}

impl Column {
    /// `length` copies of one value.
    pub fn repeat(value: f64, length: usize) -> Self {
        Self { lanes: vec![Lanes::splat(value); length.div_ceil(WIDTH)], length }
    }
}

impl Deref for Column {
    type Target = [f64];

    #[inline]
    #[expect(unsafe_code, reason = "a slice of `Lanes` is viewed as a slice of `f64`")]
    fn deref(&self) -> &[f64] {
        // SAFETY: `Lanes` is `repr(C)` and holds eight `f64` without padding (64 bytes, align 64), all
        // initialised. Every constructor stores at least `length` values, and neither field changes
        // afterwards.
        unsafe { core::slice::from_raw_parts(self.lanes.as_ptr().cast(), self.length) }
    }
}

impl DerefMut for Column {
    #[inline]
    #[expect(unsafe_code, reason = "a slice of `Lanes` is viewed as a slice of `f64`")]
    fn deref_mut(&mut self) -> &mut [f64] {
        // SAFETY: memory and length are valid as in `deref`; `&mut self` makes the access exclusive, and
        // every bit pattern is a valid `f64`.
        unsafe { core::slice::from_raw_parts_mut(self.lanes.as_mut_ptr().cast(), self.length) }
    }
}

impl From<Vec<f64>> for Column {
    fn from(values: Vec<f64>) -> Self {
        let mut column = Self::repeat(0.0, values.len());
        column.copy_from_slice(&values);
        column
    }
}

impl From<Column> for Vec<f64> {
    fn from(column: Column) -> Self {
        column.to_vec()
    }
}

impl FromIterator<f64> for Column {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        values.into_iter().collect::<Vec<_>>().into()
    }
}

impl PartialEq for Column {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl fmt::Debug for Column {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(formatter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_aligned_and_keeps_its_values() {
        for length in [0, 1, 7, 8, 9, 800] {
            let values: Vec<f64> = (0..length).map(|k| f64::from(k) - 0.5).collect();
            let mut column = Column::from(values.clone());
            assert_eq!(*column, *values);
            assert_eq!(column.as_ptr() as usize % 64, 0);
            column.iter_mut().for_each(|value| *value *= 2.0);
            assert_eq!(
                Vec::from(column.clone()),
                values.iter().map(|x| x * 2.0).collect::<Vec<_>>()
            );
            let text = serde_json::to_string(&column).expect("numbers");
            assert_eq!(serde_json::from_str::<Column>(&text).expect("a list"), column);
        }
    }
}
