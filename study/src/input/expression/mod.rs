//! The one expression language: a condition on a row, as in
//! `feasible and M >= 3 and (strategy == 'direct' or mass_flow_rate > '1 g/s')`.
//!
//! ```text
//! condition  = or            or  = and { "or" and }        and = not { "and" not }
//! not        = "not" not | comparison
//! comparison = sum [ ("==" | "=" | "!=" | "<" | "<=" | ">" | ">=") sum ]
//! sum        = term { ("+" | "-") term }      term = factor { ("*" | "/") factor }
//! factor     = "-" factor | number | text | name | "true" | "false" | "null" | "(" or ")"
//! ```
//!
//! Text is written in single or double quotes. Types are checked once, before any row is read: a
//! quantity keeps its dimension through arithmetic, a bare number takes the dimension of the other
//! operand (SI), and a quoted text compared with a quantity is read with its unit. `null` is unknown:
//! arithmetic and order with it are unknown, `and` and `or` follow three-valued logic (Kleene), and
//! `x == null` and `x != null` test for it. A condition holds where it is true.

mod check;
mod evaluate;
mod lexer;
mod parser;
mod tree;

use crate::input::value::Value;

pub use tree::{ExpressionError, Type, Variable};

/// A condition, checked against its variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    text: String,
    root: tree::Node,
}

impl Expression {
    /// Reads a condition and checks it against the variables it may use.
    ///
    /// # Errors
    /// When it is not a condition, names an unknown variable, or compares values of different types.
    pub fn condition(text: &str, variables: &[Variable]) -> Result<Self, ExpressionError> {
        let tree = parser::parse(text)?;
        let root = check::condition(text, &tree, variables)?;
        Ok(Self { text: text.to_owned(), root })
    }

    /// The text it was read from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it is true for a row: the values of the variables, in the order of the variables. A
    /// value that is missing or has another type is unknown.
    pub fn holds(&self, row: &[Value]) -> bool {
        evaluate::truth(&self.root, row) == Some(true)
    }
}

/// The names in a text, in order; none where it is not an expression.
pub(crate) fn names(text: &str) -> Vec<String> {
    let tokens = lexer::tokens(text).unwrap_or_default();
    let name = |(token, _)| match token {
        lexer::Token::Name(name) => Some(name),
        _ => None,
    };
    tokens.into_iter().filter_map(name).collect()
}

#[cfg(test)]
mod tests;
