//! Texts that must fit: line breaks, ellipses, XML escapes.

use crate::render::font;

/// Breaks a text at its spaces into lines of at most `width`; a wider word has its own line.
pub fn wrapped(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if font::width(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A text cut to a width, with an ellipsis if it was longer.
pub fn cut(text: &str, size: f64, width: f64) -> String {
    if font::width(text, size) <= width {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    loop {
        kept.pop();
        let shorter = format!("{}…", kept.iter().collect::<String>().trim_end());
        if kept.is_empty() || font::width(&shorter, size) <= width {
            return shorter;
        }
    }
}

/// A text with XML escapes; tabs and line feeds become spaces, and characters that XML does not allow are
/// removed.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\t' | '\n' | '\r' => safe.push(' '),
            '\u{fffe}' | '\u{ffff}' => {}
            letter if letter.is_control() => {}
            letter => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn wrapped_lines_fit_and_keep_every_word(
            words in prop::collection::vec("[a-z]{1,12}", 1..30), width in 20.0..60.0,
        ) {
            let text = words.join(" ");
            let lines = wrapped(&text, 3.0, width);
            prop_assert_eq!(lines.join(" "), text);
            for line in &lines {
                prop_assert!(!line.contains(' ') || font::width(line, 3.0) <= width);
            }
        }

        #[test]
        fn a_cut_text_fits(text in "[ -~]{0,60}", width in 5.0..80.0) {
            let shorter = cut(&text, 3.0, width);
            prop_assert!(font::width(&shorter, 3.0) <= width);
            prop_assert!(shorter == text || shorter.ends_with('…'));
        }
    }
}
