//! A checked expression, and its value for one row.

use crate::input::value::Value;

/// A binary operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operator {
    Or,
    And,
    Equal,
    Unequal,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
}

impl Operator {
    /// Whether it compares two values.
    pub fn compares(self) -> bool {
        self.precedence() == 4
    }

    /// Precedence; `not` has 3.
    pub fn precedence(self) -> u8 {
        match self {
            Self::Or => 1,
            Self::And => 2,
            Self::Add | Self::Subtract => 5,
            Self::Multiply | Self::Divide => 6,
            _ => 4,
        }
    }
}

/// An expression in which every operand has the type its operator needs.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    /// A variable by position; of a quantity, the words that stand for numbers.
    Variable(usize, Option<&'static [(&'static str, f64)]>),
    Not(Box<Node>),
    Negate(Box<Node>),
    Binary(Operator, Box<Node>, Box<Node>),
    /// Whether a value is unknown (where the flag is true) or known (where it is false).
    IsNull(Box<Node>, bool),
}

/// A value that is known.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub(super) enum Known<'a> {
    Bool(bool),
    Number(f64),
    Text(&'a str),
}

impl Known<'_> {
    /// NaN is unknown.
    fn number(number: f64) -> Option<Self> {
        (!number.is_nan()).then_some(Self::Number(number))
    }
}

impl Node {
    /// The value for a row; `None` is unknown.
    pub fn known<'a>(&'a self, row: &'a [Value]) -> Option<Known<'a>> {
        match self {
            Self::Null => None,
            Self::Bool(flag) => Some(Known::Bool(*flag)),
            Self::Number(number) => Known::number(*number),
            Self::Text(text) => Some(Known::Text(text)),
            Self::Variable(index, words) => match (row.get(*index)?, words) {
                (Value::Number(number), Some(_)) => Known::number(*number),
                (Value::Integer(number), Some(_)) => Known::number(*number as f64),
                (Value::Text(text), Some(words)) => {
                    words.iter().find(|(word, _)| word == text).map(|word| Known::Number(word.1))
                }
                (Value::Text(text), None) => Some(Known::Text(text)),
                (Value::Bool(flag), None) => Some(Known::Bool(*flag)),
                _ => None,
            },
            Self::Not(inner) => match inner.known(row)? {
                Known::Bool(flag) => Some(Known::Bool(!flag)),
                _ => None,
            },
            Self::Negate(inner) => match inner.known(row)? {
                Known::Number(number) => Known::number(-number),
                _ => None,
            },
            Self::IsNull(inner, wanted) => Some(Known::Bool(inner.known(row).is_none() == *wanted)),
            Self::Binary(operator, left, right) => {
                combined(*operator, left.known(row), right.known(row))
            }
        }
    }
}

fn combined<'a>(
    operator: Operator,
    left: Option<Known<'a>>,
    right: Option<Known<'a>>,
) -> Option<Known<'a>> {
    if let Operator::Or | Operator::And = operator {
        // The value that decides the result, whatever the other operand is.
        let decisive = Some(Known::Bool(operator == Operator::Or));
        return if left == decisive || right == decisive { decisive } else { left.and(right) };
    }
    let (left, right) = (left?, right?);
    if let (Known::Number(a), Known::Number(b)) = (left, right) {
        match operator {
            Operator::Add => return Known::number(a + b),
            Operator::Subtract => return Known::number(a - b),
            Operator::Multiply => return Known::number(a * b),
            // A ratio to nothing is no value, as an empty cell is.
            Operator::Divide if b == 0.0 => return None,
            Operator::Divide => return Known::number(a / b),
            _ => {}
        }
    }
    Some(Known::Bool(match operator {
        Operator::Equal => left == right,
        Operator::Unequal => left != right,
        Operator::Less => left < right,
        Operator::LessEqual => left <= right,
        Operator::Greater => left > right,
        _ => left >= right,
    }))
}
