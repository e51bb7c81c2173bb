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
//! Text stands in single or double quotes. Types are checked once, before any row is seen: a
//! quantity keeps its dimension through arithmetic, a bare number takes the dimension beside it
//! (SI), and a quoted text compared with a quantity is read with its unit. `null` is unknown:
//! arithmetic and order with it are unknown, `and` and `or` decide what they can (Kleene), and only
//! `x == null` and `x != null` ask for it. A condition holds where it is true.

mod check;
mod evaluate;
mod lexer;
mod parser;

use crate::input::units::{Dimension, Powers};
use crate::input::value::Value;

/// What a variable may be.
#[derive(Debug, Clone, PartialEq)]
pub enum Type {
    /// A quantity of a dimension, SI. Words stand for numbers: `("isothermal", ∞)`.
    Quantity(Dimension, &'static [(&'static str, f64)]),
    /// A text; where it can be one of a few, those.
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

/// A condition that fits its variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    text: String,
    root: Node,
}

/// What is wrong with an expression, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExpressionError {
    /// The expression.
    pub text: String,
    /// Place, as a range of bytes.
    pub at: (usize, usize),
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
    /// The expression with a caret under the place, both indented; a long one is cut around it.
    pub fn pointer(&self, indent: &str) -> String {
        const AROUND: usize = 60;
        let plain = |text: &str| -> Vec<char> {
            text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
        };
        let before = plain(&self.text[..self.at.0]);
        let place = plain(&self.text[self.at.0..self.at.1]);
        let after = plain(&self.text[self.at.1..]);
        let cut = before.len().saturating_sub(AROUND);
        let mut line: String = if cut > 0 { "…".to_owned() } else { String::new() };
        line.extend(&before[cut..]);
        let column = line.chars().count();
        line.extend(place.iter().chain(&after).take(2 * AROUND));
        let carets = "^".repeat(place.len().clamp(1, 2 * AROUND));
        format!("{indent}{line}\n{indent}{}{carets}", " ".repeat(column))
    }
}

impl Expression {
    /// Reads a condition and checks it against the variables it may use.
    ///
    /// # Errors
    /// When it is no condition, names an unknown variable, or compares what cannot be compared.
    pub fn condition(text: &str, variables: &[Variable]) -> Result<Self, ExpressionError> {
        let tree = parser::parse(text)?;
        let root = check::condition(text, &tree, variables)?;
        Ok(Self { text: text.to_owned(), root })
    }

    /// The text it was read from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it is true of a row: the values of the variables, in the order they were given. A
    /// value missing or of another type is unknown.
    pub fn holds(&self, row: &[Value]) -> bool {
        evaluate::truth(&self.root, row) == Some(true)
    }
}

/// Deepest nesting of an expression.
const DEEPEST: usize = 200;

/// Longest expression, bytes.
const LONGEST: usize = 10_000;

/// A place in the text.
type Span = (usize, usize);

/// What is wrong at a place, before the text is added.
fn error_at(text: &str, at: Span, problem: impl Into<String>, allowed: &str) -> ExpressionError {
    ExpressionError {
        text: text.to_owned(),
        at,
        problem: problem.into(),
        allowed: allowed.to_owned(),
    }
}

/// As written.
#[derive(Debug)]
struct Tree {
    span: Span,
    depth: usize,
    kind: TreeKind,
}

#[derive(Debug)]
enum TreeKind {
    Number(f64),
    Text(String),
    Bool(bool),
    Null,
    Name(String),
    Negate(Box<Tree>),
    Not(Box<Tree>),
    Binary(Operator, Box<Tree>, Box<Tree>),
}

/// A binary operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Operator {
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
    fn compares(self) -> bool {
        !matches!(
            self,
            Self::Or | Self::And | Self::Add | Self::Subtract | Self::Multiply | Self::Divide
        )
    }
}

/// Checked: every operand is of the type its operator needs.
#[derive(Debug, Clone, PartialEq)]
enum Node {
    Number(f64),
    /// A quantity variable; the words it may hold stand for numbers.
    Quantity(usize, &'static [(&'static str, f64)]),
    Negate(Box<Node>),
    Arithmetic(Operator, Box<Node>, Box<Node>),
    Text(String),
    TextVariable(usize),
    Bool(bool),
    BoolVariable(usize),
    Not(Box<Node>),
    Logic(Operator, Box<Node>, Box<Node>),
    CompareNumbers(Operator, Box<Node>, Box<Node>),
    CompareTexts(Operator, Box<Node>, Box<Node>),
    CompareBools(Operator, Box<Node>, Box<Node>),
    /// Whether a value is unknown (true) or known (false).
    IsNull(Box<Node>, Kind, bool),
}

/// Type of a checked node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// `None` is a bare number: any dimension.
    Number(Option<Powers>),
    Text,
    Bool,
    Null,
}

#[cfg(test)]
mod tests;
