//! The parts of an expression: variables, errors, the tree as written and the tree as checked.

use crate::input::units::{Dimension, Powers};

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
    pub span: (usize, usize),
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

/// Largest nesting depth of an expression (chosen: far beyond any condition a user writes, and within
/// the stack of a thread).
pub(super) const MAX_DEPTH: usize = 200;

/// Length of the longest expression read, bytes (chosen: a list of hundreds of cases fits).
pub(super) const MAX_LENGTH: usize = 10_000;

/// A range of bytes in the text.
pub(super) type Span = (usize, usize);

/// An error at a range of the text.
pub(super) fn error_at(
    text: &str,
    span: Span,
    problem: impl Into<String>,
    allowed: &str,
) -> ExpressionError {
    ExpressionError {
        text: text.to_owned(),
        span,
        problem: problem.into(),
        allowed: allowed.to_owned(),
    }
}

/// An expression as written.
#[derive(Debug)]
pub(super) struct Tree {
    pub span: Span,
    pub depth: usize,
    pub kind: TreeKind,
}

/// What a tree is.
#[derive(Debug)]
pub(super) enum TreeKind {
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
        !matches!(
            self,
            Self::Or | Self::And | Self::Add | Self::Subtract | Self::Multiply | Self::Divide
        )
    }
}

/// An expression as checked: every operand has the type its operator needs.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    Number(f64),
    /// A quantity variable, by position; the words it may hold stand for numbers.
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
    /// Whether a value is unknown (where the flag is true) or known (where it is false).
    IsNull(Box<Node>, ValueKind, bool),
}

/// Type of a checked node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ValueKind {
    /// `None` is a bare number: any dimension.
    Number(Option<Powers>),
    Text,
    Bool,
    Null,
}
