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

mod lexer;
mod node;
mod parser;

use crate::input::units::Dimension;
use crate::input::value::Value;
use node::Known;

/// A range of bytes in the text.
type Span = (usize, usize);

/// Type of a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Type {
    /// A quantity of a dimension, SI. Words stand for numbers, as in `("isothermal", ∞)`.
    Quantity(Dimension, &'static [(&'static str, f64)]),
    /// A text, with its possible values where they are known.
    Text(Option<Vec<String>>),
    /// True or false.
    Bool,
}

/// A name an expression may use.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name: letters, digits, `_`, dots between parts.
    pub name: String,
    /// Type.
    pub kind: Type,
}

/// What is wrong with an expression, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExpressionError {
    /// The expression.
    pub text: String,
    /// The faulty part, as a range of bytes.
    pub span: Span,
    /// What is wrong.
    pub problem: String,
    /// What is allowed there.
    pub allowed: String,
}

impl std::fmt::Display for ExpressionError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}\n{}", self.problem, self.pointer("    "))
    }
}

impl ExpressionError {
    fn new(text: &str, span: Span, problem: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self { text: text.to_owned(), span, problem: problem.into(), allowed: allowed.into() }
    }

    /// The expression with carets under the faulty part, both indented; a long expression is cut
    /// around it.
    pub fn pointer(&self, indent: &str) -> String {
        /// Characters shown before the faulty part, and half of those from there on (chosen: one
        /// line of a terminal).
        const AROUND: usize = 60;
        let plain = |text: &str| -> Vec<char> {
            text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
        };
        let before = plain(&self.text[..self.span.0]);
        let faulty = plain(&self.text[self.span.0..self.span.1]);
        let after = plain(&self.text[self.span.1..]);
        let cut = before.len().saturating_sub(AROUND);
        let mut line: String = if cut > 0 { "…".to_owned() } else { String::new() };
        line.extend(&before[cut..]);
        let column = line.chars().count();
        line.extend(faulty.iter().chain(&after).take(2 * AROUND));
        let carets = "^".repeat(faulty.len().clamp(1, 2 * AROUND));
        format!("{indent}{line}\n{indent}{}{carets}", " ".repeat(column))
    }
}

/// A condition, checked against its variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    text: String,
    root: node::Node,
}

impl Expression {
    /// Reads a condition and checks it against the variables it may use.
    ///
    /// # Errors
    /// When it is not a condition, names an unknown variable, or compares values of different types.
    pub fn condition(text: &str, variables: &[Variable]) -> Result<Self, ExpressionError> {
        Ok(Self { text: text.to_owned(), root: parser::condition(text, variables)? })
    }

    /// The text it was read from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it is true for a row: the values of the variables, in the order of the variables. A
    /// value that is missing or has another type is unknown.
    pub fn holds(&self, row: &[Value]) -> bool {
        self.root.known(row) == Some(Known::Bool(true))
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
