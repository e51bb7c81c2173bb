//! Numbers in a row that begin where a line of the cache does.
//!
//! Eight at a time are then one line, never two: a step over a capsule's film takes 5 % less.

use core::fmt;
use core::ops::{Deref, DerefMut};

use serde::{Deserialize, Serialize};

use super::{Lanes, WIDTH};

/// A column of numbers, used as the slice it is.
#[derive(Clone, Default, Serialize, Deserialize)]
#[serde(from = "Vec<f64>", into = "Vec<f64>")]
pub struct Column {
    lanes: Vec<Lanes>,
    length: usize,
}

impl Column {
    /// The same number `length` times.
    pub fn repeat(value: f64, length: usize) -> Self {
        Self { lanes: vec![Lanes::splat(value); length.div_ceil(WIDTH)], length }
    }
}

impl Deref for Column {
    type Target = [f64];

    #[inline]
    #[expect(unsafe_code, reason = "eight numbers are eight numbers")]
    fn deref(&self) -> &[f64] {
        // SAFETY: `Lanes` is eight numbers without padding, and there are enough of them.
        unsafe { core::slice::from_raw_parts(self.lanes.as_ptr().cast(), self.length) }
    }
}

impl DerefMut for Column {
    #[inline]
    #[expect(unsafe_code, reason = "eight numbers are eight numbers")]
    fn deref_mut(&mut self) -> &mut [f64] {
        // SAFETY: as above.
        unsafe { core::slice::from_raw_parts_mut(self.lanes.as_mut_ptr().cast(), self.length) }
    }
}

impl From<Vec<f64>> for Column {
    fn from(numbers: Vec<f64>) -> Self {
        let mut column = Self::repeat(0.0, numbers.len());
        column.copy_from_slice(&numbers);
        column
    }
}

impl From<Column> for Vec<f64> {
    fn from(column: Column) -> Self {
        column.to_vec()
    }
}

impl FromIterator<f64> for Column {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        numbers.into_iter().collect::<Vec<_>>().into()
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
    fn it_is_its_numbers_at_the_beginning_of_a_line() {
        for length in [0, 1, 7, 8, 9, 800] {
            let numbers: Vec<f64> = (0..length).map(|k| f64::from(k) - 0.5).collect();
            let mut column = Column::from(numbers.clone());
            assert_eq!(*column, *numbers);
            assert_eq!(column.as_ptr() as usize % 64, 0);
            column.iter_mut().for_each(|own| *own *= 2.0);
            assert_eq!(
                Vec::from(column.clone()),
                numbers.iter().map(|x| x * 2.0).collect::<Vec<_>>()
            );
            let text = serde_json::to_string(&column).expect("numbers");
            assert_eq!(serde_json::from_str::<Column>(&text).expect("a list"), column);
        }
    }
}
