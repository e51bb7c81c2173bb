//! Tokens of an expression.

use super::node::Operator;
use super::{ExpressionError, Span};
use crate::input::units::{is_unit, number_length};

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Text(String),
    Name(String),
    Operator(Operator),
    Not,
    Open,
    Close,
    End,
}

/// Operators and brackets; of two that begin alike the longer one is first.
const SIGNS: [(&str, Token); 13] = [
    ("==", Token::Operator(Operator::Equal)),
    ("=", Token::Operator(Operator::Equal)),
    ("!=", Token::Operator(Operator::Unequal)),
    ("<=", Token::Operator(Operator::LessEqual)),
    ("<", Token::Operator(Operator::Less)),
    (">=", Token::Operator(Operator::GreaterEqual)),
    (">", Token::Operator(Operator::Greater)),
    ("+", Token::Operator(Operator::Add)),
    ("-", Token::Operator(Operator::Subtract)),
    ("*", Token::Operator(Operator::Multiply)),
    ("/", Token::Operator(Operator::Divide)),
    ("(", Token::Open),
    (")", Token::Close),
];

/// Splits an expression into tokens with their places; the last is [`Token::End`].
pub(super) fn tokens(text: &str) -> Result<Vec<(Token, Span)>, ExpressionError> {
    let mut tokens = Vec::new();
    let mut start = 0;
    while let Some(first) = text[start..].chars().next() {
        let rest = &text[start..];
        let (token, end) = if first.is_whitespace() {
            start += first.len_utf8();
            continue;
        } else if let Some((sign, token)) = SIGNS.iter().find(|(sign, _)| rest.starts_with(sign)) {
            (token.clone(), start + sign.len())
        } else if matches!(first, '0'..='9' | '.') {
            number(text, start)?
        } else if matches!(first, '\'' | '"') {
            let Some(length) = rest[1..].find(first) else {
                let problem = "a text without its closing quote";
                let allowed = "text in single or double quotes";
                return Err(ExpressionError::new(text, (start, text.len()), problem, allowed));
            };
            (Token::Text(rest[1..=length].to_owned()), start + length + 2)
        } else if first.is_alphabetic() || first == '_' {
            let in_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '[' | ']');
            let name = &rest[..rest.find(|c| !in_name(c)).unwrap_or(rest.len())];
            let token = match name {
                "and" => Token::Operator(Operator::And),
                "or" => Token::Operator(Operator::Or),
                "not" => Token::Not,
                name => Token::Name(name.to_owned()),
            };
            (token, start + name.len())
        } else {
            let allowed =
                "and, or, not, == != < <= > >=, + - * /, ( ), numbers, quoted text, names";
            let problem = match first {
                '&' => "`&` is written `and`".to_owned(),
                '|' => "`|` is written `or`".to_owned(),
                '!' => "`!` alone is written `not`".to_owned(),
                other => format!("`{}` does not belong in an expression", other.escape_debug()),
            };
            let span = (start, start + first.len_utf8());
            return Err(ExpressionError::new(text, span, problem, allowed));
        };
        tokens.push((token, (start, end)));
        start = end;
    }
    tokens.push((Token::End, (text.len(), text.len())));
    Ok(tokens)
}

/// The number at a place, and its end. A percentage is a pure number: it must not be compared with a length.
fn number(text: &str, start: usize) -> Result<(Token, usize), ExpressionError> {
    let end = start + number_length(&text[start..]).unwrap_or(1);
    let (digits, unit) = (&text[start..end], after_number(&text[end..]));
    let end_of_unit = text[end..].find(unit).map_or(end, |space| end + space + unit.len());
    let refuse = |end: usize, problem: &str, allowed: String| {
        Err(ExpressionError::new(text, (start, end), problem, allowed))
    };
    match digits.parse::<f64>() {
        Ok(number) if unit.is_empty() && number.is_finite() => Ok((Token::Number(number), end)),
        Ok(_) if unit == "%" => Ok((Token::Text(format!("{digits} %")), end_of_unit)),
        Ok(_) if !unit.is_empty() => {
            let allowed = format!("'{digits} {unit}', or a number in SI");
            refuse(end_of_unit, "a number with a unit is written in quotes", allowed)
        }
        _ => {
            let allowed = "a number in SI, or a quantity in quotes ('5 g/s')".to_owned();
            refuse(end, "not a number", allowed)
        }
    }
}

/// What follows a number: `%`, a unit, or nothing that belongs to it.
fn after_number(rest: &str) -> &str {
    let rest = rest.trim_start();
    if rest.starts_with('%') {
        return &rest[..1];
    }
    if !rest.starts_with(|c: char| c.is_alphabetic() || c == '°') {
        return "";
    }
    let in_unit = |c: char| c.is_alphanumeric() || matches!(c, '/' | '^' | '°' | '²' | '³' | '_');
    let unit = &rest[..rest.find(|c| !in_unit(c)).unwrap_or(rest.len())];
    let unit = unit.trim_end_matches('/');
    if is_unit(unit) { unit } else { "" }
}
