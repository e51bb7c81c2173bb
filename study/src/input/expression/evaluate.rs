//! The value of a checked expression for one row; `None` is unknown.

use super::tree::{Node, Operator, ValueKind};
use crate::input::value::Value;

/// The value of a condition.
#[expect(clippy::float_cmp, reason = "`==` of an expression is exact equality")]
pub(super) fn truth(node: &Node, row: &[Value]) -> Option<bool> {
    match node {
        Node::Bool(value) => Some(*value),
        Node::BoolVariable(index) => match row.get(*index)? {
            Value::Bool(value) => Some(*value),
            _ => None,
        },
        Node::Not(inner) => truth(inner, row).map(|value| !value),
        Node::Logic(operator, left, right) => {
            // The value that decides the result, whatever the other operand is.
            let decisive = *operator == Operator::Or;
            match (truth(left, row), truth(right, row)) {
                (Some(a), _) if a == decisive => Some(decisive),
                (_, Some(b)) if b == decisive => Some(decisive),
                (Some(_), Some(_)) => Some(!decisive),
                _ => None,
            }
        }
        Node::CompareNumbers(operator, left, right) => {
            let (a, b) = (number(left, row)?, number(right, row)?);
            Some(match operator {
                Operator::Equal => a == b,
                Operator::Unequal => a != b,
                Operator::Less => a < b,
                Operator::LessEqual => a <= b,
                Operator::Greater => a > b,
                _ => a >= b,
            })
        }
        Node::CompareTexts(operator, left, right) => {
            Some((text(left, row)? == text(right, row)?) == (*operator == Operator::Equal))
        }
        Node::CompareBools(operator, left, right) => {
            Some((truth(left, row)? == truth(right, row)?) == (*operator == Operator::Equal))
        }
        Node::IsNull(inner, kind, wanted) => {
            let null = match kind {
                ValueKind::Number(_) => number(inner, row).is_none(),
                ValueKind::Text => text(inner, row).is_none(),
                ValueKind::Bool => truth(inner, row).is_none(),
                ValueKind::Null => true,
            };
            Some(null == *wanted)
        }
        _ => None,
    }
}

fn number(node: &Node, row: &[Value]) -> Option<f64> {
    let value = match node {
        Node::Number(number) => *number,
        Node::Quantity(index, words) => match row.get(*index)? {
            Value::Number(number) => *number,
            Value::Integer(number) => *number as f64,
            Value::Text(text) => words.iter().find(|(word, _)| word == text)?.1,
            Value::Null | Value::Bool(_) => return None,
        },
        Node::Negate(inner) => -number(inner, row)?,
        Node::Arithmetic(operator, left, right) => {
            let (a, b) = (number(left, row)?, number(right, row)?);
            match operator {
                Operator::Add => a + b,
                Operator::Subtract => a - b,
                Operator::Multiply => a * b,
                _ => a / b,
            }
        }
        _ => return None,
    };
    (!value.is_nan()).then_some(value)
}

fn text<'a>(node: &'a Node, row: &'a [Value]) -> Option<&'a str> {
    match node {
        Node::Text(text) => Some(text),
        Node::TextVariable(index) => match row.get(*index)? {
            Value::Text(text) => Some(text),
            _ => None,
        },
        _ => None,
    }
}
