//! Text of a user in a message: cut to a length, and without characters that act on a terminal.

use std::fmt::Write as _;
use std::path::Path;

/// Characters of a name or a value in a message (chosen: two of them and their problem take one line).
pub const MAX_ECHO: usize = 60;

/// A text in at most `max` characters, its middle cut out, and printable ([`printable`]).
pub fn cut(text: &str, max: usize) -> String {
    // Text that is cut out is not looked at: a file of megabytes may be one line.
    let mut ends = text.char_indices();
    if ends.nth(max).is_none() {
        return printable(text);
    }
    let (before, after) = (2 * max / 3, max - 2 * max / 3 - 1);
    let first = text.char_indices().nth(before).map_or(text.len(), |(index, _)| index);
    let last = text.char_indices().rev().nth(after.saturating_sub(1)).map_or(0, |(index, _)| index);
    let end = if after == 0 { "" } else { &text[last..] };
    format!("{}…{}", printable(&text[..first]), printable(end))
}

/// A name or a value as a message shows it: at most [`MAX_ECHO`] characters, printable.
pub fn echo(text: &str) -> String {
    cut(text, MAX_ECHO)
}

/// A text as one word of a shell command.
pub fn word(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_' | '+' | '/');
    if !text.is_empty() && text.chars().all(plain) {
        return text.to_owned();
    }
    let text = printable(text);
    // Within double quotes these act.
    if text.contains(['"', '$', '`', '\\', '!']) {
        format!("'{}'", text.replace('\'', r"'\''"))
    } else {
        format!("\"{text}\"")
    }
}

/// A path as one word of a shell command.
pub fn path(path: &Path) -> String {
    word(&path.display().to_string())
}

/// Every line of a text cut to at most `max` characters, and printable.
pub fn cut_lines(text: &str, max: usize) -> String {
    let lines: Vec<String> = text.split('\n').map(|line| cut(line, max)).collect();
    lines.join("\n")
}

/// A text in which every character that acts on a terminal, or that cannot be seen, is written as its
/// code: control characters (escape sequences begin with one), marks of the writing direction, and
/// line separators. Line feeds stay.
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' => shown.push(c),
            '\t' => shown.push_str("\\t"),
            '\r' => shown.push_str("\\r"),
            c if acts(c) => {
                let _ = write!(shown, "\\u{{{:x}}}", u32::from(c));
            }
            c => shown.push(c),
        }
    }
    shown
}

/// Whether a character acts on a terminal or cannot be seen (Unicode 16: general categories Cc and Zl,
/// Zp, marks of direction, zero width, byte order mark).
pub fn acts(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_keeps_its_beginning_and_its_end() {
        let long = format!("begin{}end", "é".repeat(70_000));
        let shown = echo(&long);
        assert_eq!(shown.chars().count(), MAX_ECHO);
        assert!(shown.starts_with("beginé") && shown.ends_with("éend") && shown.contains('…'));
        let fits = "é".repeat(MAX_ECHO);
        assert_eq!(echo(&fits), fits);
        assert_eq!(cut("abcdef", 3), "ab…");
        assert_eq!(cut_lines("abcdefghij\nok", 6), "abcd…j\nok");
    }

    #[test]
    fn nothing_acts_on_the_terminal() {
        for (text, shown) in [
            ("a\x1b[2Jb", "a\\u{1b}[2Jb"),
            ("\u{9b}31m\u{7f}", "\\u{9b}31m\\u{7f}"),
            ("bell\x07\tand\r\n", "bell\\u{7}\\tand\\r\n"),
            ("\u{202e}evil\u{feff}", "\\u{202e}evil\\u{feff}"),
            ("µm 30° 樹", "µm 30° 樹"),
        ] {
            assert_eq!(printable(text), shown);
        }
    }
}
