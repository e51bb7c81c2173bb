//! A place in a text file: its line and column, and its line as a message shows it.

use crate::platform::quote;

/// Characters of a line that a message shows, at most (chosen: with its number it fits a terminal of
/// 80 columns).
const MAX_SHOWN: usize = 68;
/// Columns of a tab (chosen: most editors' setting for JSON is 2 or 4).
const TAB_WIDTH: usize = 4;

/// Line and column, from 1, of a byte of a text. A column is a character; a tab is one.
pub fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..text.floor_char_boundary(offset)];
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    (line, before[start..].chars().count() + 1)
}

/// The line of a byte of a text with its number, and a caret below the place:
///
/// ```text
///   3 |     "N": 6
///     |           ^
/// ```
///
/// A long line is cut on both sides of the place.
pub fn excerpt(text: &str, offset: usize) -> String {
    let offset = text.floor_char_boundary(offset);
    let (number, column) = line_and_column(text, offset);
    let start = text[..offset].rfind('\n').map_or(0, |end| end + 1);
    let line = text[start..].lines().next().unwrap_or_default();
    let length = line.chars().count();
    // The place stands in the middle of a line that is cut.
    let first = if length <= MAX_SHOWN { 0 } else { (column - 1).saturating_sub(MAX_SHOWN / 2) };
    let cell = |c: char| match c {
        '\t' => " ".repeat(TAB_WIDTH),
        c if quote::acts(c) => c.escape_unicode().to_string(),
        c => c.to_string(),
    };
    let cells = || line.chars().skip(first).take(MAX_SHOWN).map(cell);
    let [before, after] =
        [first > 0, first + MAX_SHOWN < length].map(|cut| if cut { "…" } else { "" });
    let shown = cells().collect::<String>();
    let caret: usize = cells().take(column - 1 - first).map(|cell| cell.chars().count()).sum();
    let blank = " ".repeat(number.to_string().len());
    let space = " ".repeat(before.chars().count() + caret);
    format!("  {number} | {before}{shown}{after}\n  {blank} | {space}^")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str, needle: &str) -> usize {
        text.find(needle).unwrap()
    }

    #[test]
    fn columns_are_characters_and_the_caret_stands_below_them() {
        let text = "{\r\n\t\"größe\": 6,\r\n  \"樹\": x\r\n}";
        let six = at(text, "6");
        assert_eq!(line_and_column(text, six), (2, 11));
        assert_eq!(excerpt(text, six), "  2 |     \"größe\": 6,\n    |              ^");
        let x = at(text, "x");
        assert_eq!(line_and_column(text, x), (3, 8));
        assert_eq!(excerpt(text, x), "  3 |   \"樹\": x\n    |        ^");
        // Beyond the end, and inside a character.
        assert_eq!(line_and_column(text, 1000), (4, 2));
        assert_eq!(line_and_column(text, at(text, "ö") + 1), line_and_column(text, at(text, "ö")));
    }

    #[test]
    fn a_long_line_is_cut_around_the_place() {
        for place in [0, 10, 40, 5_000, 9_990, 9_999] {
            let mut text = "é".repeat(10_000);
            let offset = 2 * place;
            text.replace_range(offset..offset + 2, "x");
            let shown = excerpt(&text, offset);
            let (line, caret) = shown.split_once('\n').unwrap();
            assert!(line.chars().count() <= MAX_SHOWN + 8, "{line}");
            let column = caret.chars().count() - 1;
            assert_eq!(line.chars().nth(column), Some('x'), "{place}\n{shown}");
        }
        let shown = excerpt("a\x1b[2J, b", 6);
        assert!(!shown.contains('\x1b') && shown.contains("\\u{1b}[2J"), "{shown}");
    }
}
