use super::place::line_and_column;
use super::*;
use crate::input::study_file::Json;

/// Marks the place of a fault in a text of these tests; it is no part of the text.
const MARK: char = '¦';

fn is_json(text: &str) -> bool {
    serde_json::from_str::<Json>(text).is_ok()
}

#[test]
fn a_fault_stands_where_a_reader_would_point() {
    for (marked, key, problem, hint) in [
        ("{\"a\": {\"b\": 1¦ \"c\": 2}}", "a", "a comma is missing", "write a comma"),
        ("{\n  \"a\": 6¦\n  \"b\": 2\n}", "", "a comma is missing", "close with }"),
        ("{\n  \"a\": [1, 2¦\n  3]\n}", "a", "a comma is missing", "close with ]"),
        ("{\"a\": \"x\"¦ \"b\": 2}", "", "a comma is missing", "a comma here"),
        ("{\"a\": {}¦ \"b\": 2}", "", "a comma is missing", "a comma here"),
        ("{\"a\": 6¦,}", "", "trailing comma", "remove it"),
        ("{\"a\": [6,\n 5¦,\n ]}", "a", "trailing comma", "remove it"),
        ("{\"a\": [6,¦, 5]}", "a[1]", "nothing stands before this comma", "missing value"),
        ("{\"a\": 6,¦, \"b\": 5}", "", "nothing stands before this comma", "missing key"),
        ("{\"a\":¦ }", "a", "this key has no value", "write \"a\":"),
        ("{\"a\":¦,\"b\": 1}", "a", "this key has no value", "write \"a\":"),
        ("{\"a\"¦, \"b\": 1}", "", "this key has no value", "write \"a\":"),
        ("{\"a\"¦ 6}", "", "a colon is missing", "write \"a\":"),
        ("{\"a\" ¦= 6}", "", "an equals sign", "write a colon"),
        ("{\"a\": 6 ¦; \"b\": 1}", "", "a semicolon", "write a comma"),
        ("{\"a\": \"b\"¦: 1}", "", "a second colon", "one value"),
        ("{\"a\": [1¦: 2]}", "a", "a colon in a list", "{ }"),
        ("{¦a: 6}", "", "a key stands in double quotes", "write \"a\":"),
        ("{¦'a': 6}", "", "' is not the quote of JSON", "straight double quotes"),
        ("{\"a\": ¦“x”}", "a", "“ is not the quote of JSON", "straight double quotes"),
        ("{\"a\": ¦film}", "a", "a text stands in double quotes", "write \"film\""),
        ("{\"a\": ¦True}", "a", "True is not a word of JSON", "write true"),
        ("{\"a\": ¦None}", "a", "None is not a word of JSON", "write null"),
        ("{\"a\": ¦NaN}", "a", "a finite number", "remove the key"),
        ("{\"a\": ¦5 g/s, \"b\": 1}", "", "a number with a unit is a text", "write \"5 g/s\""),
        ("{\"a\": ¦40mm}", "a", "a number with a unit is a text", "write \"40 mm\""),
        ("{\"a\": ¦30 °}", "", "a number with a unit is a text", "write \"30 °\""),
        ("{\"a\": ¦.5}", "a", "a number begins with a digit", "write 0.5"),
        ("{\"a\": 5¦.}", "a", "a point without digits", "write 5 or 5.0"),
        ("{\"a\": ¦+5}", "a", "a plus sign", "write 5"),
        ("{\"a\": ¦007}", "a", "a leading zero", "write 7"),
        ("{\"a\": ¦0x10}", "a", "a hexadecimal number", "decimal digits"),
        ("{\"a\": 1¦_000}", "a", "an underscore in a number", "write 1000"),
        ("{\"a\": 1¦e, \"b\": 2}", "a", "an exponent without digits", "1e-6"),
        ("{\"a\": ¦-}", "a", "a minus sign without digits", "a number has digits"),
        ("{\"a\": ¦1e999}", "a", "number out of range", "1.8e308"),
        ("{\"a\": 0¦,5, \"b\": 1}", "", "a comma inside a number", "write 0.5"),
        ("{¦\"a: 6, \"b\": 3}", "", "this text has no closing quote", "after the key"),
        ("{\"a\": ¦\"x, \"b\": 3}", "", "this text has no closing quote", "end of the text"),
        ("{\"a\": ¦\"x,\n\"b\": 3}", "a", "no closing quote in its line", "end of the text"),
        ("{\"a\": ¦\"x", "a", "no closing quote", "end of the text"),
        ("{\"a\": \"say ¦\"no\" to it\"}", "", "a text ends here", "write \\\""),
        ("{\"a\": \"C:¦\\data\"}", "a", "unknown escape \\d", "write \\\\"),
        ("{\"a\": \"¦\\u00\"}", "a", "four hexadecimal digits", "\\u00b5"),
        ("{\"a\": \"¦\\ud800x\"}", "a", "half of a surrogate pair", "both halves"),
        ("{\"a\": \"x¦\ty\"}", "a", "a tab inside a text", "write \\t"),
        ("{\"a\": 6, ¦// panels\n \"b\": 3}", "", "comment", "remove it"),
        ("{¦/* panels */ \"b\": 3}", "", "comment", "remove it"),
        ("{\"a\": 6 ¦# panels\n}", "", "comment", "remove it"),
        ("{\"a\": {\"b\": 1,\n ¦\"b\": 2}}", "a", "given twice, first in line 1, column 8", "one"),
        ("{\"a\": [1, 2¦}}", "a", "} cannot close the [ of line 1, column 7", "write ]"),
        ("{\"a\": {\"b\": 1¦]}", "a", "] cannot close the { of line 1, column 7", "write }"),
        ("{\"a\": 1}¦}", "", "a closing } too many", "closes too early"),
        ("{\"a\": 1}¦, \"b\": 2}", "", "the object has ended before this", "too early"),
        ("{} ¦{}", "", "trailing characters", "one object"),
        ("¦{\"a\": 1", "", "this { is not closed", "add the missing }"),
        ("{\"a\": ¦[1, 2", "", "this [ is not closed", "add the missing ]"),
        (
            "{\n  \"a\": ¦{\n    \"b\": 1,\n  \"c\": {\n    \"d\": 2\n  }\n}\n",
            "",
            "this { is not closed",
            "add the missing }",
        ),
        ("{\"a\":¦\u{a0}1}", "a", "U+00A0", "looks like a space"),
        ("¦design:\n  N: 6\n", "", "begins with {", "another kind of file"),
        ("¦<html>", "", "begins with {, not with <", "another kind of file"),
    ] {
        let text = marked.replace(MARK, "");
        let expected = marked.find(MARK).unwrap();
        assert!(!is_json(&text), "{text}");
        let fault = fault(&text).unwrap_or_else(|| panic!("no fault in {text}"));
        let shown = format!("{marked}\n{}\n{fault:?}", place::excerpt(&text, fault.offset));
        assert_eq!(fault.offset, expected, "{shown}");
        assert!(fault.problem.contains(problem), "{shown}");
        assert!(fault.hint.contains(hint), "{shown}");
        assert_eq!(fault.key, key, "{shown}");
        // Windows line ends change no place.
        let windows = text.replace('\n', "\r\n");
        let again = super::fault(&windows).unwrap();
        let at = |text: &str, fault: &Fault| line_and_column(text, fault.offset);
        assert_eq!(at(&windows, &again), at(&text, &fault), "{shown}");
    }
}

#[test]
fn this_walk_and_the_reader_agree_on_what_is_json() {
    let sound = "{\"a\": [1, -2.5e-3, {\"é\": \"x\\u00b5\\n\\\"\", \"f\": null}],\n \"b\": true, \"c\": {}}";
    assert_eq!(fault(sound), None);
    let pieces = [
        "", ",", "\"", "{", "}", "[", "]", ":", "0", "e", "-", ".", "\\", "\n", " ", "é", "tru",
        "/",
    ];
    let starts: Vec<usize> = sound.char_indices().map(|(index, _)| index).collect();
    for &start in &starts {
        for cut in [0, 1, 2] {
            let mut end = (start + cut).min(sound.len());
            while !sound.is_char_boundary(end) {
                end += 1;
            }
            for piece in pieces {
                let text = format!("{}{piece}{}", &sound[..start], &sound[end..]);
                let fault = fault(&text);
                assert_eq!(fault.is_none(), is_json(&text), "{text}\n{fault:?}");
            }
        }
    }
}

#[test]
fn brackets_inside_each_other_are_limited_as_in_the_reader() {
    for (depth, deep) in [(MAX_DEPTH - 1, false), (MAX_DEPTH, true), (100_000, true)] {
        let text = format!("{}{}", "[".repeat(depth), "]".repeat(depth));
        assert_eq!(is_json(&text), !deep);
        let fault = fault(&text);
        assert_eq!(fault.is_some(), deep, "{depth}");
        assert!(fault.is_none_or(|fault| fault.problem.contains("recursion limit")));
    }
}

#[test]
fn a_value_is_found_by_its_key() {
    let text = "{\"a\": {\"b\": [1, {\"c\": \"x\"}]},\n \"b\": 2}";
    for (key, value) in [("a.b[1].c", "\"x\""), ("a.b[0]", "1"), ("b", "2"), ("a", "{\"b\"")] {
        let offset = locate(text, key).unwrap();
        assert!(text[offset..].starts_with(value), "{key}");
    }
    assert_eq!(locate(text, "a.c"), None);
}
