//! Texts that must fit: line breaks, ellipses, XML escapes.

use crate::render::font;

/// Breaks a text at its spaces into lines of at most `width`; a wider word has its own line. A number stays
/// with the word after it, its unit.
pub fn wrapped(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match words.last_mut() {
            Some(last) if is_number(last) => {
                last.push(' ');
                last.push_str(word);
            }
            _ => words.push(word.to_owned()),
        }
    }
    in_lines(&words, " ", size, width)
}

/// Breaks a text into lines at its commas, and a part that is wider than a line at its spaces.
pub fn wrapped_at_commas(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut parts: Vec<String> = text.split(", ").map(|part| format!("{part}, ")).collect();
    if let Some(last) = parts.last_mut() {
        last.truncate(last.len() - 2);
    }
    let lines = in_lines(&parts, "", size, width).into_iter();
    lines.flat_map(|line| wrapped(line.trim_end(), size, width)).collect()
}

fn is_number(word: &str) -> bool {
    word.starts_with(|letter: char| letter.is_ascii_digit() || letter == '−')
        && word.chars().all(|letter| letter.is_ascii_digit() || "−.e".contains(letter))
}

/// Joins pieces with a separator to lines of at most `width`.
fn in_lines(pieces: &[String], between: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in pieces {
        match lines.last_mut() {
            Some(line)
                if font::width(format!("{line}{between}{word}").trim_end(), size) <= width =>
            {
                line.push_str(between);
                line.push_str(word);
            }
            _ => lines.push(word.clone()),
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

    #[test]
    fn a_number_keeps_its_unit_and_lines_break_at_commas() {
        assert_eq!(wrapped("gas mass 0.05 g", 3.0, 24.0), ["gas mass", "0.05 g"]);
        let title = "Mass flow rate 1 g/s, residual gas mass 0.05 g";
        let lines = ["Mass flow rate 1 g/s,", "residual gas mass 0.05 g"];
        assert_eq!(wrapped_at_commas(title, 3.0, 60.0), lines);
        assert_eq!(wrapped_at_commas(title, 3.0, 200.0), [title]);
        assert!(wrapped_at_commas("", 3.0, 20.0).is_empty());
    }

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
