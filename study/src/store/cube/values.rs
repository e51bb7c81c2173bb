//! Cells of the table, or steps of an axis, as an array of one type; and the name of an array.

use crate::input::value::Value;

/// The name of an array: HDF5 takes a slash for a path.
pub fn link_name(name: &str) -> String {
    name.replace('/', "_")
}

/// An array of one type.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers; NaN for a missing one. True is 1, false 0.
    Numbers(Vec<f64>),
    /// Whole numbers, none missing.
    Integers(Vec<i64>),
    /// Texts; empty for a missing one.
    Texts(Vec<String>),
}

impl Values {
    /// Cells as numbers; a text is missing.
    pub fn numbers(cells: &[&Value]) -> Self {
        let number = |cell: &&Value| match cell {
            Value::Integer(value) => *value as f64,
            Value::Number(value) => *value,
            Value::Bool(value) => f64::from(u8::from(*value)),
            Value::Null | Value::Text(_) => f64::NAN,
        };
        Self::Numbers(cells.iter().map(number).collect())
    }

    /// Cells as texts.
    pub fn texts(cells: &[&Value]) -> Self {
        let text = |cell: &&Value| match cell {
            Value::Null => String::new(),
            other => other.to_string(),
        };
        Self::Texts(cells.iter().map(text).collect())
    }

    /// Values of a parameter: whole numbers, else numbers, else texts ("true" and "false" are texts).
    pub fn of_parameter(cells: &[&Value]) -> Self {
        let is_text = |cell: &&&Value| matches!(cell, Value::Text(_) | Value::Bool(_));
        if cells.iter().any(|cell| is_text(&cell)) {
            return Self::texts(cells);
        }
        let integer = |cell: &&Value| match cell {
            Value::Integer(value) => Some(*value),
            _ => None,
        };
        let integers: Option<Vec<i64>> = cells.iter().map(integer).collect();
        integers.map_or_else(|| Self::numbers(cells), Self::Integers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_type_of_a_parameter_holds_all_its_values() {
        let [one, half, word] =
            [Value::Integer(1), Value::Number(0.5), Value::Text("rapid".to_owned())];
        assert_eq!(Values::of_parameter(&[&one, &one]), Values::Integers(vec![1, 1]));
        assert_eq!(Values::of_parameter(&[&one, &half]), Values::Numbers(vec![1.0, 0.5]));
        let texts = Values::Texts(vec!["1".to_owned(), "rapid".to_owned()]);
        assert_eq!(Values::of_parameter(&[&one, &word]), texts);
        let Values::Numbers(missing) = Values::of_parameter(&[&one, &Value::Null]) else {
            panic!("numbers, of which one is missing");
        };
        assert!(missing[1].is_nan());
        let flags = Values::texts(&[&Value::Bool(true), &Value::Null]);
        assert_eq!(flags, Values::Texts(vec!["true".to_owned(), String::new()]));
    }
}
