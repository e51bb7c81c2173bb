//! Words of an expression.

use super::{ExpressionError, Operator, Span, error_at};

/// A word.
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

/// Splits an expression into words; the last is [`Token::End`].
pub(super) fn tokens(text: &str) -> Result<Vec<(Token, Span)>, ExpressionError> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let start = at;
        at += first.len_utf8();
        let token = match first {
            _ if first.is_whitespace() => continue,
            '(' => Token::Open,
            ')' => Token::Close,
            '+' => Token::Operator(Operator::Add),
            '-' => Token::Operator(Operator::Subtract),
            '*' => Token::Operator(Operator::Multiply),
            '/' => Token::Operator(Operator::Divide),
            '=' | '!' | '<' | '>' => {
                let equal = text[at..].starts_with('=');
                let length = 1 + usize::from(equal);
                at = start + length;
                let operator = match (first, equal) {
                    ('=', _) => Operator::Equal,
                    ('!', true) => Operator::Unequal,
                    ('<', true) => Operator::LessEqual,
                    ('<', false) => Operator::Less,
                    ('>', true) => Operator::GreaterEqual,
                    ('>', false) => Operator::Greater,
                    _ => return Err(error_at(text, (start, at), "`!` alone", "`not`, or `!=`")),
                };
                Token::Operator(operator)
            }
            '\'' | '"' => {
                let Some(length) = text[at..].find(first) else {
                    return Err(error_at(
                        text,
                        (start, text.len()),
                        "a text without its closing quote",
                        "text in single or double quotes",
                    ));
                };
                let quoted = text[at..at + length].to_owned();
                at += length + 1;
                Token::Text(quoted)
            }
            '0'..='9' | '.' => {
                at = start + number_length(&text[start..]);
                let number = text[start..at.max(start + 1)].parse::<f64>();
                at = at.max(start + 1);
                match number {
                    Ok(number) if number.is_finite() => Token::Number(number),
                    _ => {
                        return Err(error_at(
                            text,
                            (start, at),
                            "not a number",
                            "a number in SI, or a quantity in quotes ('5 g/s')",
                        ));
                    }
                }
            }
            _ if first.is_alphabetic() || first == '_' => {
                let rest = text[start..]
                    .find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.' | '[' | ']')));
                at = rest.map_or(text.len(), |length| start + length);
                word(&text[start..at])
            }
            _ => {
                let allowed = "and, or, not, == != < <= > >=, + - * /, ( ), numbers, quoted text, \
                               names";
                let problem = match first {
                    '&' => "`&` is written `and`".to_owned(),
                    '|' => "`|` is written `or`".to_owned(),
                    other => format!("`{}` is no part of an expression", other.escape_debug()),
                };
                return Err(error_at(text, (start, at), problem, allowed));
            }
        };
        tokens.push((token, (start, at)));
    }
    tokens.push((Token::End, (text.len(), text.len())));
    Ok(tokens)
}

fn word(word: &str) -> Token {
    match word {
        "and" => Token::Operator(Operator::And),
        "or" => Token::Operator(Operator::Or),
        "not" => Token::Not,
        _ => Token::Name(word.to_owned()),
    }
}

/// Bytes of the number a text opens with.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let mut at = digits(0);
    if bytes.get(at) == Some(&b'.') {
        at = digits(at + 1);
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        let exponent = digits(at + 1 + sign);
        if exponent > at + 1 + sign {
            at = exponent;
        }
    }
    at
}
