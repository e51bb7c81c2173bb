//! A value of a parameter or a table cell.

use std::fmt;

/// One value: what an axis takes and what a table cell holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Nothing: not given, or never happened.
    Null,
    /// True or false.
    Bool(bool),
    /// Whole number.
    Integer(i64),
    /// Number, SI.
    Number(f64),
    /// Text.
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Number(value) => write!(f, "{value}"),
            Self::Text(value) => f.write_str(value),
        }
    }
}
