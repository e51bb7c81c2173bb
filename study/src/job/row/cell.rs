//! Conversion of values into cells.

use crate::input::value::Value;

/// Converts the types that a cell can hold into its [`Value`]; `None` becomes null.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell(Value);

impl From<Cell> for Value {
    fn from(cell: Cell) -> Self {
        cell.0
    }
}

impl From<Value> for Cell {
    fn from(value: Value) -> Self {
        Self(value)
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Self(Value::Bool(value))
    }
}

impl From<i64> for Cell {
    fn from(value: i64) -> Self {
        Self(Value::Integer(value))
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self(Value::Number(value))
    }
}

impl From<&str> for Cell {
    fn from(value: &str) -> Self {
        Self(Value::Text(value.to_owned()))
    }
}

impl From<String> for Cell {
    fn from(value: String) -> Self {
        Self(Value::Text(value))
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self(Value::Null), Into::into)
    }
}
