//! What is wrong with a text that is not JSON, and where: the place that a reader would point at, and
//! what to do. Also the place of a value in a text that is JSON.
//!
//! The reader of files ([`crate::input::study_file::parse`]) decides whether a text is JSON. This walk
//! explains a refusal, and finds nothing in a text without a fault.

mod mistakes;
pub mod place;

use std::fmt::Write as _;
use std::ops::Range;

/// Objects and lists inside each other, at most: the limit of the reader of files.
const MAX_DEPTH: usize = 128;

/// A fault of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Its place, a byte of the text.
    pub offset: usize,
    /// The key that the place belongs to, as in `design.N`; empty at the top.
    pub key: String,
    /// What is wrong.
    pub problem: String,
    /// What to do.
    pub hint: String,
}

/// The first fault of a text; `None` where this walk finds none.
pub fn fault(text: &str) -> Option<Fault> {
    Walk::new(text, None).file().err().map(|fault| *fault)
}

/// The place of the value of a key, as in `grid.N[2]`, in a text without a fault.
pub fn locate(text: &str, key: &str) -> Option<usize> {
    let mut walk = Walk::new(text, Some(key));
    walk.file().ok()?;
    walk.found
}

type Checked<T = ()> = Result<T, Box<Fault>>;

/// An object or list that is open.
#[derive(Debug, Clone, Copy)]
struct Open {
    offset: usize,
    /// Columns before the first character of its line.
    indent: usize,
    bracket: u8,
}

impl Open {
    fn closing(self) -> char {
        if self.bracket == b'{' { '}' } else { ']' }
    }
}

/// What a value was.
#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Text,
    Number,
    Other,
}

/// A walk over a text.
struct Walk<'a> {
    text: &'a str,
    /// The next byte.
    at: usize,
    /// The key of the current value.
    path: String,
    open: Vec<Open>,
    /// The innermost bracket that was open where a closing bracket stood at the indent of another one:
    /// most likely it is the one that was not closed.
    suspect: Option<Open>,
    /// The last value or key.
    last: (Range<usize>, Kind),
    wanted: Option<&'a str>,
    found: Option<usize>,
}

impl<'a> Walk<'a> {
    fn new(text: &'a str, wanted: Option<&'a str>) -> Self {
        Self {
            text,
            at: 0,
            path: String::new(),
            open: Vec::new(),
            suspect: None,
            last: (0..0, Kind::Other),
            wanted,
            found: None,
        }
    }

    fn peek(&self) -> Option<char> {
        self.text[self.at..].chars().next()
    }

    fn fault<T>(
        &self,
        offset: usize,
        problem: impl Into<String>,
        hint: impl Into<String>,
    ) -> Checked<T> {
        let (problem, hint) = (problem.into(), hint.into());
        Err(Box::new(Fault { offset, key: self.path.clone(), problem, hint }))
    }

    /// The whole file: one value.
    fn file(&mut self) -> Checked {
        self.skip()?;
        self.value()?;
        self.skip()?;
        match self.peek() {
            None => Ok(()),
            Some(c) => self.after_the_end(c),
        }
    }

    /// Skips white space. A comment is a fault.
    fn skip(&mut self) -> Checked {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start_matches([' ', '\t', '\r', '\n']).len();
        self.no_comment()
    }

    fn value(&mut self) -> Checked {
        if self.wanted == Some(self.path.as_str()) {
            self.found = Some(self.at);
        }
        let start = self.at;
        let kind = match self.peek() {
            Some('{') => self.nested(b'{')?,
            Some('[') => self.nested(b'[')?,
            Some('"') => self.string()?,
            Some('-' | '0'..='9') => self.number()?,
            other => self.word(other)?,
        };
        self.last = (start..self.at, kind);
        Ok(())
    }

    /// An object or a list.
    fn nested(&mut self, bracket: u8) -> Checked<Kind> {
        if self.open.len() + 1 >= MAX_DEPTH {
            return self.fault(
                self.at,
                format!("recursion limit: more than {MAX_DEPTH} brackets inside each other"),
                "a study and a scene need fewer than ten",
            );
        }
        let open = Open { offset: self.at, indent: self.indent(self.at), bracket };
        self.open.push(open);
        self.at += 1;
        if bracket == b'{' {
            self.members()?;
        } else {
            self.items()?;
        }
        self.open.pop();
        Ok(Kind::Other)
    }

    /// The members of an object and its closing brace.
    fn members(&mut self) -> Checked {
        let mut keys: Vec<(String, usize)> = Vec::new();
        let length = self.path.len();
        self.skip()?;
        if self.closes('}')? {
            return Ok(());
        }
        loop {
            let start = self.at;
            if self.peek() != Some('"') {
                return self.no_key();
            }
            self.string()?;
            let raw = &self.text[start..self.at];
            let key: String = serde_json::from_str(raw).unwrap_or_else(|_| raw.to_owned());
            self.last = (start..self.at, Kind::Text);
            if let Some((_, first)) = keys.iter().find(|(known, _)| *known == key) {
                return self.twice(&key, *first, start);
            }
            if !self.path.is_empty() {
                self.path.push('.');
            }
            self.path.push_str(&key);
            keys.push((key, start));
            self.skip()?;
            if self.peek() != Some(':') {
                self.path.truncate(length);
                return self.no_colon();
            }
            self.at += 1;
            self.skip()?;
            self.value()?;
            self.path.truncate(length);
            if !self.next('}')? {
                return Ok(());
            }
        }
    }

    /// The items of a list and its closing bracket.
    fn items(&mut self) -> Checked {
        let length = self.path.len();
        self.skip()?;
        if self.closes(']')? {
            return Ok(());
        }
        for index in 0.. {
            let _ = write!(self.path, "[{index}]");
            self.value()?;
            self.path.truncate(length);
            if !self.next(']')? {
                return Ok(());
            }
        }
        Ok(())
    }

    /// After a value: whether another one follows.
    fn next(&mut self, closing: char) -> Checked<bool> {
        self.skip()?;
        if self.closes(closing)? {
            return Ok(false);
        }
        if self.peek() != Some(',') {
            return self.no_comma(closing);
        }
        let comma = self.at;
        self.at += 1;
        self.skip()?;
        if self.peek() == Some(closing) {
            return self.fault(
                comma,
                "trailing comma",
                format!("remove it, or add a value before {closing}"),
            );
        }
        Ok(true)
    }

    /// Whether the closing bracket stands here; it is passed then.
    fn closes(&mut self, closing: char) -> Checked<bool> {
        match self.peek() {
            Some(c) if c == closing => {
                self.suspect_indent();
                self.at += 1;
                Ok(true)
            }
            Some(c @ ('}' | ']')) => self.other_bracket(c),
            None => self.not_closed(),
            _ => Ok(false),
        }
    }

    /// Columns before the first character of a line; a tab counts as one.
    fn indent(&self, offset: usize) -> usize {
        let start = self.text[..offset].rfind('\n').map_or(0, |end| end + 1);
        let line = &self.text[start..];
        line.len() - line.trim_start_matches([' ', '\t']).len()
    }

    /// Notes the open bracket where a closing bracket begins a line with the indent of an outer one.
    fn suspect_indent(&mut self) {
        let start = self.text[..self.at].rfind('\n').map_or(0, |end| end + 1);
        let alone = self.text[start..self.at].trim().is_empty();
        let indent = self.at - start;
        if let (true, None, [outer @ .., inner]) = (alone, self.suspect, self.open.as_slice())
            && indent < inner.indent
            && outer.iter().any(|open| open.indent == indent)
        {
            self.suspect = Some(*inner);
        }
    }
}

#[cfg(test)]
mod tests;
