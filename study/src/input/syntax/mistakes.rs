//! The faults of JSON that people write, each with its place and what to do.

use super::{Checked, Kind, Walk, place};
use crate::platform::quote;

impl Walk<'_> {
    /// The rest of the line, up to a character that ends a value.
    fn word_at(&self, offset: usize) -> &str {
        let rest = &self.text[offset..];
        let end = rest.find([',', '}', ']', '{', '[', '"', ':', '\n', '\r', '#']);
        rest[..end.unwrap_or(rest.len())].trim_end()
    }

    /// Refuses a comment.
    pub(super) fn no_comment(&self) -> Checked {
        let rest = &self.text[self.at..];
        if rest.starts_with("//") || rest.starts_with("/*") || rest.starts_with('#') {
            return self.fault(
                self.at,
                "comment: JSON has none",
                "remove it; a remark fits into the key question of a study",
            );
        }
        Ok(())
    }

    /// What follows the only value of a file.
    pub(super) fn after_the_end(&self, c: char) -> Checked {
        match c {
            '}' | ']' => self.fault(
                self.at,
                format!("a closing {c} too many"),
                "remove it, or look for a bracket that closes too early above",
            ),
            ',' | '"' => self.fault(
                self.at,
                "trailing characters: the object has ended before this",
                "remove the closing bracket that comes too early, or this text",
            ),
            _ => self.fault(
                self.at,
                "trailing characters after the end of the object",
                "remove them; one file holds one object",
            ),
        }
    }

    /// A key that is given again.
    pub(super) fn twice(&self, key: &str, first: usize, second: usize) -> Checked {
        let (line, column) = place::line_and_column(self.text, first);
        self.fault(
            second,
            format!(
                "key \"{}\" is given twice, first in line {line}, column {column}",
                quote::echo(key)
            ),
            "remove one of the two",
        )
    }

    /// A bracket of the wrong kind.
    pub(super) fn other_bracket<T>(&self, found: char) -> Checked<T> {
        let Some(open) = self.open.last() else { return self.not_closed() };
        let (line, column) = place::line_and_column(self.text, open.offset);
        let bracket = char::from(open.bracket);
        self.fault(
            self.at,
            format!("{found} cannot close the {bracket} of line {line}, column {column}"),
            format!("write {} here, or before it", open.closing()),
        )
    }

    /// The end of the file inside an object or a list.
    pub(super) fn not_closed<T>(&self) -> Checked<T> {
        let Some(open) = self.suspect.or(self.open.last().copied()) else {
            return self.fault(self.at, "the file ends here, without a value", "write an object");
        };
        let mut fault = self.fault(
            open.offset,
            format!("this {} is not closed", char::from(open.bracket)),
            format!("add the missing {}", open.closing()),
        );
        if let Err(fault) = &mut fault {
            // The path is that of the end of the file, not of this bracket.
            fault.key.clear();
        }
        fault
    }

    /// Something that is not a key where a key must stand.
    pub(super) fn no_key(&self) -> Checked {
        let before = self.text[..self.at].trim_end();
        let after_comma = before.ends_with(',');
        match self.peek() {
            None => self.not_closed(),
            Some(',') => self.fault(
                self.at,
                "nothing stands before this comma",
                "remove the comma, or write the missing key and value",
            ),
            Some('0'..='9') if after_comma && self.last.1 == Kind::Number => {
                let comma = before.len() - 1;
                let whole = &self.text[self.last.0.clone()];
                let decimals = self.word_at(self.at);
                self.fault(
                    comma,
                    "a comma inside a number",
                    format!("write {whole}.{} with a point", quote::echo(decimals)),
                )
            }
            Some('\'' | '`' | '‘' | '’' | '“' | '”' | '„' | '«' | '»') => {
                self.wrong_quote()
            }
            Some(c @ ('{' | '[')) => self.fault(
                self.at,
                format!("a key is missing before this {c}"),
                "write \"key\": before it, or close the object with } first",
            ),
            Some(']') => self.other_bracket(']'),
            Some(':') => self.fault(self.at, "a key is missing before this colon", "write the key"),
            Some(c) if quote::acts(c) || c.is_whitespace() => self.strange(c),
            Some(_) => {
                let word = quote::echo(self.word_at(self.at).trim_end_matches('='));
                self.fault(
                    self.at,
                    "a key stands in double quotes",
                    format!("write \"{}\":", word.trim()),
                )
            }
        }
    }

    /// Something else than a colon after a key.
    pub(super) fn no_colon(&self) -> Checked {
        let key = &self.text[self.last.0.clone()];
        let begins_a_text = |c: char| c.is_alphanumeric() || c == '_';
        match self.peek() {
            None => self.not_closed(),
            Some(c) if key.contains([':', ',']) && begins_a_text(c) => self.fault(
                self.last.0.start,
                "this text has no closing quote",
                "write the quote after the key",
            ),
            Some('=') => {
                self.fault(self.at, "an equals sign after a key", "write a colon instead of =")
            }
            Some(',' | '}') => self.fault(
                self.last.0.end,
                "this key has no value",
                format!("write {}: and its value, or remove it", quote::echo(key)),
            ),
            Some(_) => self.fault(
                self.last.0.end,
                "a colon is missing after this key",
                format!("write {}: before its value", quote::echo(key)),
            ),
        }
    }

    /// Something else than a comma or a closing bracket after a value.
    pub(super) fn no_comma<T>(&self, closing: char) -> Checked<T> {
        let (range, kind) = &self.last;
        let value = &self.text[range.clone()];
        let same_line = !self.text[range.end..self.at].contains('\n');
        match self.peek() {
            None => self.not_closed(),
            Some(c) if *kind == Kind::Number && same_line && is_unit(c) => {
                let unit = self.word_at(self.at);
                self.fault(
                    range.start,
                    "a number with a unit is a text",
                    format!("write \"{value} {}\" in double quotes", quote::echo(unit)),
                )
            }
            Some(c) if *kind == Kind::Text && same_line && (c.is_alphanumeric() || c == '\\') => {
                let inner = value.trim_matches('"').trim_end();
                if inner.ends_with([',', ':', '{', '[']) {
                    return self.fault(
                        range.start,
                        "this text has no closing quote",
                        "write the quote at the end of the text",
                    );
                }
                self.fault(
                    range.end - 1,
                    "a text ends here, and more follows",
                    "write \\\" for a quote inside a text, or a comma after the text",
                )
            }
            Some(';') => self.fault(self.at, "a semicolon", "write a comma instead of ;"),
            Some(':') if closing == ']' => self.fault(
                self.at,
                "a colon in a list",
                "a list holds values alone; keys with values stand in { }",
            ),
            Some(':') => self.fault(
                self.at,
                "a second colon",
                "a key has one value; write a comma before the next key",
            ),
            Some('=') => self.fault(self.at, "an equals sign", "write a colon, or a comma"),
            Some('\'' | '`' | '‘' | '’' | '“' | '”' | '„' | '«' | '»') if same_line => {
                self.wrong_quote()
            }
            Some(c) if quote::acts(c) || c.is_whitespace() => self.strange(c),
            Some(_) => self.fault(
                range.end,
                "a comma is missing after this value",
                format!("write a comma here, or close with {closing}"),
            ),
        }
    }

    /// A text in double quotes.
    pub(super) fn string(&mut self) -> Checked<Kind> {
        let start = self.at;
        let bytes = self.text.as_bytes();
        self.at += 1;
        while let Some(byte) = bytes.get(self.at) {
            match byte {
                b'"' => {
                    self.at += 1;
                    return Ok(Kind::Text);
                }
                b'\\' => self.escape(start)?,
                b'\n' | b'\r' => break,
                0..0x20 => {
                    let (name, code) = match byte {
                        b'\t' => ("a tab".to_owned(), "\\t".to_owned()),
                        byte => (format!("control character {byte}"), format!("\\u{byte:04x}")),
                    };
                    return self.fault(
                        self.at,
                        format!("{name} inside a text"),
                        format!("remove it, or write {code}"),
                    );
                }
                _ => self.at += 1,
            }
        }
        self.fault(
            start,
            "this text has no closing quote in its line",
            "write the quote at the end of the text",
        )
    }

    /// A backslash and what follows it.
    fn escape(&mut self, start: usize) -> Checked {
        let rest = &self.text[self.at + 1..];
        match rest.chars().next() {
            Some('"' | '\\' | '/' | 'b' | 'f' | 'n' | 'r' | 't') => {
                self.at += 2;
                Ok(())
            }
            Some('u') => {
                let digits = rest[1..].chars().take_while(char::is_ascii_hexdigit).take(4).count();
                let read = |from: usize| {
                    rest.get(from..from + 4).and_then(|text| u32::from_str_radix(text, 16).ok())
                };
                if digits < 4 {
                    return self.fault(
                        self.at,
                        "\\u without four hexadecimal digits",
                        "write four digits, as in \\u00b5, or the character itself",
                    );
                }
                let code = read(1).unwrap_or(0);
                let low = if rest[5..].starts_with("\\u") { read(7) } else { None };
                match code {
                    0xd800..=0xdbff if low.is_some_and(|low| (0xdc00..=0xdfff).contains(&low)) => {
                        self.at += 12;
                    }
                    0xd800..=0xdfff => {
                        return self.fault(
                            self.at,
                            "half of a surrogate pair",
                            "write both halves, or the character itself",
                        );
                    }
                    _ => self.at += 6,
                }
                Ok(())
            }
            None | Some('\n' | '\r') => self.fault(
                start,
                "this text has no closing quote in its line",
                "write the quote at the end of the text",
            ),
            Some(c) => self.fault(
                self.at,
                format!("unknown escape \\{}", quote::printable(&c.to_string())),
                "write \\\\ for a backslash; / separates folders on every system",
            ),
        }
    }

    /// A number.
    pub(super) fn number(&mut self) -> Checked<Kind> {
        let start = self.at;
        let rest = &self.text[start..];
        let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || "+-._".contains(c)));
        let text = &rest[..end.unwrap_or(rest.len())];
        let digits = text.trim_start_matches('-');
        let length = number_length(text);
        let found = &text[..length];
        let after = text[length..].chars().next();
        let hint = |text: &str| format!("write {text}");
        let leading_zero =
            digits.starts_with('0') && digits[1..].starts_with(|c: char| c.is_ascii_digit());
        if leading_zero {
            let trimmed = text.trim_start_matches('-').trim_start_matches('0');
            return self.fault(start, "a number with a leading zero", hint(&quote::echo(trimmed)));
        }
        if length == 0 {
            let problem = "a minus sign without digits";
            return self.fault(start, problem, "a number has digits before and after its point");
        }
        match after {
            None => {}
            Some('.') if !found.contains('.') => {
                let whole = quote::echo(found);
                return self.fault(
                    start + length,
                    "a point without digits after it",
                    format!("write {whole} or {whole}.0"),
                );
            }
            Some('_') => {
                let plain = quote::echo(&text.replace('_', ""));
                return self.fault(start + length, "an underscore in a number", hint(&plain));
            }
            Some('x' | 'X') if digits.starts_with('0') => {
                return self.fault(start, "a hexadecimal number", "write it in decimal digits");
            }
            Some('e' | 'E')
                if text.len() == length + 1
                    || !text[length + 1..].starts_with(char::is_alphabetic) =>
            {
                let problem = "an exponent without digits";
                return self.fault(start + length, problem, "write digits after the e, as in 1e-6");
            }
            Some(c) if c.is_ascii_alphabetic() => {
                let unit = self.word_at(start + length);
                let problem = "a number with a unit is a text";
                let hint = format!("write \"{found} {}\" in double quotes", quote::echo(unit));
                return self.fault(start, problem, hint);
            }
            Some(_) => {
                return self.fault(start + length, "the number ends before this", "remove it");
            }
        }
        if found.parse::<f64>().is_ok_and(f64::is_infinite) {
            let hint = "write a number within ±1.8e308";
            return self.fault(start, "number out of range", hint);
        }
        self.at = start + length;
        Ok(Kind::Number)
    }

    /// `true`, `false`, `null`; any other beginning of a value is a fault.
    pub(super) fn word(&mut self, first: Option<char>) -> Checked<Kind> {
        let rest = &self.text[self.at..];
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_'));
        let word = &rest[..end.unwrap_or(rest.len())];
        if matches!(word, "true" | "false" | "null") {
            self.at += word.len();
            return Ok(Kind::Other);
        }
        let inside = self.open.last().map(|open| open.bracket);
        match first {
            None => self.not_closed(),
            Some(',') if inside == Some(b'[') => self.fault(
                self.at,
                "nothing stands before this comma",
                "remove the comma, or write the missing value",
            ),
            Some(']') if inside == Some(b'[') => {
                self.fault(self.at, "a value is missing before this", "write a value")
            }
            Some(',' | '}' | ']') if inside == Some(b'{') => self.fault(
                self.text[..self.at].trim_end().len(),
                "this key has no value",
                format!(
                    "write {}: and its value, or remove it",
                    quote::echo(&self.text[self.last.0.clone()])
                ),
            ),
            Some('\'' | '`' | '‘' | '’' | '“' | '”' | '„' | '«' | '»') => {
                self.wrong_quote()
            }
            Some('+') => {
                let number = self.word_at(self.at + 1);
                let hint = format!("write {}", quote::echo(number));
                self.fault(self.at, "a plus sign before a number", hint)
            }
            Some('.') => {
                let number = self.word_at(self.at);
                let hint = format!("write 0{}", quote::echo(number));
                self.fault(self.at, "a number begins with a digit", hint)
            }
            Some(c) if quote::acts(c) || c.is_whitespace() => self.strange(c),
            Some(c) if c.is_alphabetic() || c == '_' => self.plain_word(word),
            Some(c) if self.open.is_empty() => self.fault(
                self.at,
                format!("a file begins with {{, not with {}", quote::printable(&c.to_string())),
                "is it another kind of file? start from one in studies/ or scenes/",
            ),
            Some(c) => self.fault(
                self.at,
                format!("expected a value, found {}", quote::printable(&c.to_string())),
                "a value is a number, a text in double quotes, true, false, null, [ ] or { }",
            ),
        }
    }

    /// A word without quotes.
    fn plain_word<T>(&self, word: &str) -> Checked<T> {
        let lower = word.to_lowercase();
        let json = match lower.as_str() {
            "true" | "yes" | "on" => "true",
            "false" | "no" | "off" => "false",
            "none" | "null" | "nil" | "undefined" => "null",
            _ => "",
        };
        if self.open.is_empty() {
            return self.fault(
                self.at,
                "a file begins with {, not with a word",
                "is it another kind of file? start from one in studies/ or scenes/",
            );
        }
        if !json.is_empty() {
            let word = quote::echo(word);
            return self.fault(
                self.at,
                format!("{word} is not a word of JSON"),
                format!("write {json}"),
            );
        }
        if matches!(lower.as_str(), "nan" | "inf" | "infinity") {
            return self.fault(
                self.at,
                format!("expected a finite number, found {}", quote::echo(word)),
                "write a number, or remove the key",
            );
        }
        let text = quote::echo(self.word_at(self.at));
        self.fault(self.at, "a text stands in double quotes", format!("write \"{text}\""))
    }

    /// A quote that is not the straight double one.
    fn wrong_quote<T>(&self) -> Checked<T> {
        let c = self.peek().unwrap_or('\'');
        self.fault(
            self.at,
            format!("{c} is not the quote of JSON"),
            "write straight double quotes, \"",
        )
    }

    /// A character that cannot be seen, or a space of another kind.
    fn strange<T>(&self, c: char) -> Checked<T> {
        self.fault(
            self.at,
            format!("the character U+{:04X} outside a text", u32::from(c)),
            "remove it: it looks like a space or cannot be seen; copied text often has it",
        )
    }
}

/// Whether a unit may begin with this character.
fn is_unit(c: char) -> bool {
    c.is_alphabetic() || matches!(c, '°' | '%' | '/' | 'µ')
}

/// Bytes of the longest number at the start of a text.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits =
        |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut length = usize::from(text.starts_with('-'));
    let whole = digits(length);
    if whole == 0 {
        return 0;
    }
    length += whole;
    if bytes.get(length) == Some(&b'.') {
        let decimals = digits(length + 1);
        if decimals == 0 {
            return length;
        }
        length += 1 + decimals;
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let exponent = if length + 1 + sign <= bytes.len() { digits(length + 1 + sign) } else { 0 };
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}
