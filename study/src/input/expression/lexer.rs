//! Tokens of an expression.

use super::ExpressionError;
use super::node::Operator;
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

/// Splits an expression into tokens; the last is [`Token::End`].
pub(super) fn tokens(text: &str) -> Result<Vec<(Token, (usize, usize))>, ExpressionError> {
    let mut tokens = Vec::new();
    let mut position = 0;
    while let Some(first) = text[position..].chars().next() {
        let start = position;
        position += first.len_utf8();
        let token = match first {
            _ if first.is_whitespace() => continue,
            '(' => Token::Open,
            ')' => Token::Close,
            '+' => Token::Operator(Operator::Add),
            '-' => Token::Operator(Operator::Subtract),
            '*' => Token::Operator(Operator::Multiply),
            '/' => Token::Operator(Operator::Divide),
            '=' | '!' | '<' | '>' => {
                let equal = text[position..].starts_with('=');
                let length = 1 + usize::from(equal);
                position = start + length;
                let operator = match (first, equal) {
                    ('=', _) => Operator::Equal,
                    ('!', true) => Operator::Unequal,
                    ('<', true) => Operator::LessEqual,
                    ('<', false) => Operator::Less,
                    ('>', true) => Operator::GreaterEqual,
                    ('>', false) => Operator::Greater,
                    _ => {
                        return Err(ExpressionError::new(
                            text,
                            (start, position),
                            "`!` alone",
                            "`not`, or `!=`",
                        ));
                    }
                };
                Token::Operator(operator)
            }
            '\'' | '"' => {
                let Some(length) = text[position..].find(first) else {
                    return Err(ExpressionError::new(
                        text,
                        (start, text.len()),
                        "a text without its closing quote",
                        "text in single or double quotes",
                    ));
                };
                let quoted = text[position..position + length].to_owned();
                position += length + 1;
                Token::Text(quoted)
            }
            '0'..='9' | '.' => {
                position = start + number_length(&text[start..]).unwrap_or(1);
                let number = text[start..position].parse::<f64>();
                match (number, after_number(&text[position..])) {
                    (Ok(number), "") if number.is_finite() => Token::Number(number),
                    // A percentage is a pure number: it must not be compared with a length.
                    (Ok(_), unit @ "%") => {
                        let number = &text[start..position];
                        position += text[position..].find(unit).unwrap_or(0) + unit.len();
                        Token::Text(format!("{number} {unit}"))
                    }
                    (Ok(_), unit) if !unit.is_empty() => {
                        let end = position + text[position..].find(unit).unwrap_or(0) + unit.len();
                        return Err(ExpressionError::new(
                            text,
                            (start, end),
                            "a number with a unit is written in quotes",
                            format!("'{} {unit}', or a number in SI", &text[start..position]),
                        ));
                    }
                    _ => {
                        return Err(ExpressionError::new(
                            text,
                            (start, position),
                            "not a number",
                            "a number in SI, or a quantity in quotes ('5 g/s')",
                        ));
                    }
                }
            }
            _ if first.is_alphabetic() || first == '_' => {
                let rest = text[start..]
                    .find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.' | '[' | ']')));
                position = rest.map_or(text.len(), |length| start + length);
                match &text[start..position] {
                    "and" => Token::Operator(Operator::And),
                    "or" => Token::Operator(Operator::Or),
                    "not" => Token::Not,
                    name => Token::Name(name.to_owned()),
                }
            }
            _ => {
                let allowed = "and, or, not, == != < <= > >=, + - * /, ( ), numbers, quoted text, \
                               names";
                let problem = match first {
                    '&' => "`&` is written `and`".to_owned(),
                    '|' => "`|` is written `or`".to_owned(),
                    other => format!("`{}` does not belong in an expression", other.escape_debug()),
                };
                return Err(ExpressionError::new(text, (start, position), problem, allowed));
            }
        };
        tokens.push((token, (start, position)));
    }
    tokens.push((Token::End, (text.len(), text.len())));
    Ok(tokens)
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
