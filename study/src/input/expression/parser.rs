//! From tokens to a tree, by operator precedence.

use super::lexer::{Token, tokens};
use super::tree::{
    ExpressionError, MAX_DEPTH, MAX_LENGTH, Operator, Span, Tree, TreeKind, error_at,
};

/// Reads an expression.
pub(super) fn parse(text: &str) -> Result<Tree, ExpressionError> {
    if text.len() > MAX_LENGTH {
        let mut end = MAX_LENGTH;
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        return Err(error_at(
            &text[..end],
            (end, end),
            format!("longer than {MAX_LENGTH} bytes"),
            "a shorter expression",
        ));
    }
    let mut parser = Parser { text, tokens: tokens(text)?, position: 0, depth: 0 };
    let tree = parser.binary(0)?;
    match parser.peek() {
        (Token::End, _) => Ok(tree),
        (Token::Close, span) => Err(parser.refuse(span, "`)` without its `(`")),
        (_, span) => Err(parser.refuse(span, "an operator is missing before this")),
    }
}

struct Parser<'a> {
    text: &'a str,
    tokens: Vec<(Token, Span)>,
    position: usize,
    depth: usize,
}

/// Precedence of an operator.
fn precedence(operator: Operator) -> u8 {
    match operator {
        Operator::Or => 1,
        Operator::And => 2,
        operator if operator.compares() => 4,
        Operator::Add | Operator::Subtract => 5,
        _ => 6,
    }
}

/// Precedence of `not`: between `and` and a comparison.
const NOT: u8 = 3;

impl Parser<'_> {
    fn peek(&self) -> (&Token, Span) {
        // The list ends with `End`, and the position stays within it.
        let (token, span) = &self.tokens[self.position.min(self.tokens.len() - 1)];
        (token, *span)
    }

    fn refuse(&self, span: Span, problem: &str) -> ExpressionError {
        error_at(
            self.text,
            span,
            problem,
            "a condition, as in N == 6 and mass_flow_rate >= '1 g/s'",
        )
    }

    fn node(&self, span: Span, depth: usize, kind: TreeKind) -> Result<Tree, ExpressionError> {
        if depth > MAX_DEPTH {
            return Err(self.refuse(span, "nested too deeply"));
        }
        Ok(Tree { span, depth, kind })
    }

    /// An expression of operators with at least this precedence.
    fn binary(&mut self, min_precedence: u8) -> Result<Tree, ExpressionError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.refuse(self.peek().1, "nested too deeply"));
        }
        let mut left = self.operand()?;
        while let (&Token::Operator(operator), span) = self.peek() {
            let precedence = precedence(operator);
            if precedence < min_precedence {
                break;
            }
            if operator.compares()
                && matches!(&left.kind, TreeKind::Binary(inner, ..) if inner.compares())
                && !self.closed_before()
            {
                return Err(self.refuse(span, "comparisons do not chain; write a < b and b < c"));
            }
            self.position += 1;
            let right = self.binary(precedence + 1)?;
            let depth = 1 + left.depth.max(right.depth);
            let span = (left.span.0, right.span.1);
            let kind = TreeKind::Binary(operator, Box::new(left), Box::new(right));
            left = self.node(span, depth, kind)?;
        }
        self.depth -= 1;
        Ok(left)
    }

    /// Whether the token before the current one is `)`.
    fn closed_before(&self) -> bool {
        self.position > 0 && self.tokens[self.position - 1].0 == Token::Close
    }

    fn operand(&mut self) -> Result<Tree, ExpressionError> {
        let (token, span) = self.peek();
        let token = token.clone();
        self.position += 1;
        let leaf = match token {
            Token::Number(number) => TreeKind::Number(number),
            Token::Text(text) => TreeKind::Text(text),
            Token::Name(name) => match name.as_str() {
                "true" => TreeKind::Bool(true),
                "false" => TreeKind::Bool(false),
                "null" => TreeKind::Null,
                _ => TreeKind::Name(name),
            },
            Token::Not => {
                let inner = self.binary(NOT)?;
                let (depth, end) = (1 + inner.depth, inner.span.1);
                return self.node((span.0, end), depth, TreeKind::Not(Box::new(inner)));
            }
            Token::Operator(Operator::Subtract) => {
                let inner = self.binary(precedence(Operator::Divide) + 1)?;
                let (depth, end) = (1 + inner.depth, inner.span.1);
                return self.node((span.0, end), depth, TreeKind::Negate(Box::new(inner)));
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
        self.node(span, 1, leaf)
    }
}
