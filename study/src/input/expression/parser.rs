//! From a text to a checked expression: operators by precedence, types as soon as they are known.

use super::lexer::{Token, tokens};
use super::node::{Node, Operator};
use super::{ExpressionError, Span, Type, Variable};
use crate::input::units::{self, Powers};
use crate::platform::nearest::{did_you_mean, nearest};
use crate::platform::quote;

/// Largest nesting depth of an expression (chosen: far beyond any condition a user writes, and within
/// the stack of a thread).
const MAX_DEPTH: usize = 200;
/// Length of the longest expression read, bytes (chosen: a list of hundreds of cases fits, and a chain of this
/// length is evaluated within the stack of a thread).
const MAX_LENGTH: usize = 10_000;
/// Precedence of `not`: between `and` and a comparison.
const NOT: u8 = 3;
const CONDITION: &str = "something true or false, as in N == 6";

/// Type of a checked expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// `None` is a bare number: any dimension.
    Number(Option<Powers>),
    Text,
    Bool,
    Null,
}

impl Kind {
    fn describe(self) -> String {
        match self {
            Self::Number(None) => "a number".to_owned(),
            Self::Number(Some(powers)) => units::describe(powers),
            Self::Text => "a text".to_owned(),
            Self::Bool => "true or false".to_owned(),
            Self::Null => "null".to_owned(),
        }
    }
}

/// A part of the expression, checked.
struct Part {
    node: Node,
    kind: Kind,
    span: Span,
}

/// Reads a condition.
pub(super) fn condition(text: &str, variables: &[Variable]) -> Result<Node, ExpressionError> {
    if text.len() > MAX_LENGTH {
        let end = text.floor_char_boundary(MAX_LENGTH);
        let problem = format!("longer than {MAX_LENGTH} bytes");
        let (text, span) = (&text[..end], (end, end));
        return Err(ExpressionError::new(text, span, problem, "a shorter expression"));
    }
    let mut parser = Parser { text, variables, tokens: tokens(text)?, position: 0, depth: 0 };
    let whole = parser.binary(0)?;
    match parser.peek() {
        (Token::End, _) if whole.kind == Kind::Bool => Ok(whole.node),
        (Token::End, _) => {
            let problem = format!("is {}, not a condition", whole.kind.describe());
            Err(parser.error(whole.span, problem, CONDITION))
        }
        (Token::Close, span) => Err(parser.refuse(span, "`)` without its `(`")),
        (_, span) => Err(parser.refuse(span, "an operator is missing before this")),
    }
}

struct Parser<'a> {
    text: &'a str,
    variables: &'a [Variable],
    tokens: Vec<(Token, Span)>,
    position: usize,
    depth: usize,
}

impl Parser<'_> {
    fn peek(&self) -> (&Token, Span) {
        // The list ends with `End`, and the position stays within it.
        let (token, span) = &self.tokens[self.position.min(self.tokens.len() - 1)];
        (token, *span)
    }

    fn error(
        &self,
        span: Span,
        problem: impl Into<String>,
        allowed: impl Into<String>,
    ) -> ExpressionError {
        ExpressionError::new(self.text, span, problem, allowed)
    }

    fn refuse(&self, span: Span, problem: &str) -> ExpressionError {
        self.error(span, problem, "a condition, as in N == 6 and mass_flow_rate >= '1 g/s'")
    }

    /// An expression of operators with at least this precedence.
    fn binary(&mut self, min_precedence: u8) -> Result<Part, ExpressionError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.refuse(self.peek().1, "nested too deeply"));
        }
        let mut left = self.operand()?;
        while let (&Token::Operator(operator), span) = self.peek() {
            if operator.precedence() < min_precedence {
                break;
            }
            let in_brackets = self.position > 0 && self.tokens[self.position - 1].0 == Token::Close;
            let compares = match &left.node {
                Node::Binary(inner, ..) => inner.compares(),
                other => matches!(other, Node::IsNull(..)),
            };
            if operator.compares() && compares && !in_brackets {
                return Err(self.refuse(span, "comparisons do not chain; write a < b and b < c"));
            }
            self.position += 1;
            let right = self.binary(operator.precedence() + 1)?;
            let span = (left.span.0, right.span.1);
            let (node, kind) = self.combined(span, operator, left, right)?;
            left = Part { node, kind, span };
        }
        self.depth -= 1;
        Ok(left)
    }

    fn operand(&mut self) -> Result<Part, ExpressionError> {
        let (token, span) = self.peek();
        let token = token.clone();
        self.position += 1;
        let (node, kind) = match token {
            Token::Number(number) => (Node::Number(number), Kind::Number(None)),
            Token::Text(text) => (Node::Text(text), Kind::Text),
            Token::Name(name) => match name.as_str() {
                "true" | "false" => (Node::Bool(name == "true"), Kind::Bool),
                "null" => (Node::Null, Kind::Null),
                _ => self.variable(span, &name)?,
            },
            Token::Not => {
                let inner = self.binary(NOT)?;
                let span = (span.0, inner.span.1);
                let node = Node::Not(Box::new(self.truth(inner, "not")?));
                return Ok(Part { node, kind: Kind::Bool, span });
            }
            Token::Operator(Operator::Subtract) => {
                let inner = self.binary(Operator::Divide.precedence() + 1)?;
                let span = (span.0, inner.span.1);
                let (node, powers) = self.number(inner, "-")?;
                let (node, kind) = (Node::Negate(Box::new(node)), Kind::Number(powers));
                return Ok(Part { node, kind, span });
            }
            Token::Open => {
                let inner = self.binary(0)?;
                if !matches!(self.peek().0, Token::Close) {
                    return Err(self.refuse(span, "`(` without its `)`"));
                }
                self.position += 1;
                return Ok(inner);
            }
            Token::End => {
                self.position -= 1;
                return Err(self.refuse(span, "something is missing here"));
            }
            Token::Operator(_) | Token::Close => {
                return Err(self.refuse(span, "a number, text or name is missing before this"));
            }
        };
        Ok(Part { node, kind, span })
    }

    fn variable(&self, span: Span, name: &str) -> Result<(Node, Kind), ExpressionError> {
        let names = || self.variables.iter().map(|variable| variable.name.as_str());
        let Some(index) = names().position(|known| known == name) else {
            let near =
                did_you_mean(name, names()).map_or_else(String::new, |near| format!("; {near}"));
            let problem = format!("no variable is called {}{near}", quote::echo(name));
            let names = names().collect::<Vec<_>>().join(", ");
            return Err(self.error(span, problem, format!("{names}; a text is written in quotes")));
        };
        Ok(match &self.variables[index].kind {
            Type::Quantity(dimension, words) => {
                (Node::Variable(index, Some(words)), Kind::Number(Some(dimension.powers())))
            }
            Type::Text(_) => (Node::Variable(index, None), Kind::Text),
            Type::Bool => (Node::Variable(index, None), Kind::Bool),
        })
    }

    fn truth(&self, part: Part, word: &str) -> Result<Node, ExpressionError> {
        if part.kind == Kind::Bool {
            return Ok(part.node);
        }
        let problem = format!("`{word}` needs a condition, this is {}", part.kind.describe());
        Err(self.error(part.span, problem, CONDITION))
    }

    fn number(&self, part: Part, sign: &str) -> Result<(Node, Option<Powers>), ExpressionError> {
        let Kind::Number(powers) = part.kind else {
            let problem = format!("`{sign}` needs a number, this is {}", part.kind.describe());
            return Err(self.error(part.span, problem, "a number or a quantity"));
        };
        Ok((part.node, powers))
    }

    /// Two operands and their operator.
    fn combined(
        &self,
        span: Span,
        operator: Operator,
        left: Part,
        right: Part,
    ) -> Result<(Node, Kind), ExpressionError> {
        let node = |a, b| Node::Binary(operator, Box::new(a), Box::new(b));
        let sign = match operator {
            Operator::And => "and",
            Operator::Or => "or",
            Operator::Add => "+",
            Operator::Subtract => "-",
            Operator::Multiply => "*",
            Operator::Divide => "/",
            _ => return Ok((self.comparison(span, operator, left, right)?, Kind::Bool)),
        };
        if let Operator::And | Operator::Or = operator {
            return Ok((node(self.truth(left, sign)?, self.truth(right, sign)?), Kind::Bool));
        }
        let (a, a_powers) = self.number(left, sign)?;
        let (b, b_powers) = self.number(right, sign)?;
        let powers = match (operator, a_powers, b_powers) {
            (_, None, None) => None,
            (Operator::Add | Operator::Subtract, Some(a), Some(b)) if a != b => {
                return Err(self.mismatch(span, a, b, &format!("`{sign}`")));
            }
            (Operator::Add | Operator::Subtract, a, b) => a.or(b),
            (_, a, b) => {
                let mut powers = a.unwrap_or_default();
                for (power, other) in powers.iter_mut().zip(b.unwrap_or_default()) {
                    let sum = match operator {
                        Operator::Multiply => power.checked_add(other),
                        _ => power.checked_sub(other),
                    };
                    let too_high = || self.error(span, "has too high a power", "a simpler product");
                    *power = sum.ok_or_else(too_high)?;
                }
                Some(powers)
            }
        };
        Ok((node(a, b), Kind::Number(powers)))
    }

    fn mismatch(&self, span: Span, a: Powers, b: Powers, what: &str) -> ExpressionError {
        let problem = format!("{what} between {} and {}", units::describe(a), units::describe(b));
        self.error(span, problem, "two quantities of one dimension")
    }

    fn comparison(
        &self,
        span: Span,
        operator: Operator,
        left: Part,
        right: Part,
    ) -> Result<Node, ExpressionError> {
        let equality = matches!(operator, Operator::Equal | Operator::Unequal);
        let (a_kind, b_kind) = (left.kind, right.kind);
        let (a, b) = match (a_kind, b_kind) {
            (_, Kind::Null) | (Kind::Null, _) => {
                if !equality {
                    return Err(self.error(span, "null has no order", "x == null, x != null"));
                }
                let node = if b_kind == Kind::Null { left.node } else { right.node };
                return Ok(Node::IsNull(Box::new(node), operator == Operator::Equal));
            }
            (Kind::Number(Some(a)), Kind::Number(Some(b))) if a != b => {
                return Err(self.mismatch(span, a, b, "a comparison"));
            }
            (Kind::Number(Some(powers)), Kind::Text) => {
                let quantity = self.quantity(&right, powers, &left.node)?;
                (left.node, quantity)
            }
            (Kind::Text, Kind::Number(Some(powers))) => {
                (self.quantity(&left, powers, &right.node)?, right.node)
            }
            (Kind::Text, Kind::Text) if equality => {
                self.check_word(&left, &right)?;
                self.check_word(&right, &left)?;
                (left.node, right.node)
            }
            (Kind::Number(_), Kind::Number(_)) => (left.node, right.node),
            (Kind::Bool, Kind::Bool) if equality => (left.node, right.node),
            (Kind::Text, Kind::Text) | (Kind::Bool, Kind::Bool) => {
                let problem = format!("{} has no order", a_kind.describe());
                let allowed = "== or != between texts, or between conditions";
                return Err(self.error(span, problem, allowed));
            }
            _ => {
                let (a, b) = (a_kind.describe(), b_kind.describe());
                let problem = format!("a comparison between {a} and {b}");
                return Err(self.error(span, problem, "two values of one type"));
            }
        };
        Ok(Node::Binary(operator, Box::new(a), Box::new(b)))
    }

    /// A quoted text compared with a quantity: a word of that quantity, or a number with a unit.
    fn quantity(&self, part: &Part, powers: Powers, other: &Node) -> Result<Node, ExpressionError> {
        let name = units::describe(powers);
        let Node::Text(text) = &part.node else {
            let problem = format!("is a text, compared with {name}");
            return Err(self.error(part.span, problem, "a number or a quantity"));
        };
        if let Node::Variable(_, Some(words)) = other
            && let Some((_, number)) = words.iter().find(|(word, _)| word == text)
        {
            return Ok(Node::Number(*number));
        }
        units::parse_powers(text, powers).map(Node::Number).map_err(|problem| {
            self.error(part.span, problem, format!("{name} with its unit in the quotes"))
        })
    }

    /// Refuses a quoted text that the variable compared with it never holds.
    fn check_word(&self, other: &Part, part: &Part) -> Result<(), ExpressionError> {
        let (Node::Variable(index, _), Node::Text(text)) = (&other.node, &part.node) else {
            return Ok(());
        };
        let variable = &self.variables[*index];
        match &variable.kind {
            Type::Text(Some(words)) if !words.contains(text) => {
                let near = nearest(text, words.iter().map(String::as_str))
                    .map_or_else(String::new, |near| format!("; did you mean '{near}'?"));
                let problem = format!("{} is never '{text}'{near}", variable.name);
                Err(self.error(part.span, problem, words.join(", ")))
            }
            _ => Ok(()),
        }
    }
}
