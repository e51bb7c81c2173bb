//! Changes of an OBJ file.

use super::bytes;
use crate::harness::random::Random;

/// Changes of one file, at most.
const MAX_CHANGES: usize = 4;
/// Words that take the place of a number.
const WORDS: [&str; 14] = [
    "0", "-1", "-9999", "1e308", "-1e308", "1e-308", "1e400", "nan", "inf", "", "x", "1//1",
    "1/2/3", "\u{1}",
];
/// Whole lines that are put in.
const LINES: [&str; 10] =
    ["v", "f", "f 1", "f 1 2", "f 1 1 1", "v 0 0 0", "f 1 2 3 4 5 6", "g a\\", "#", "vn 0 0 1"];
/// Vertices of a long face.
const LONG_FACE: usize = 2_000;

/// The text with a few changes.
pub fn mutated(text: &[u8], random: &mut Random) -> Vec<u8> {
    if random.below(6) == 0 {
        return bytes::mutated(text, random);
    }
    let text = String::from_utf8_lossy(text);
    let mut lines: Vec<String> = text.lines().map(ToOwned::to_owned).collect();
    for _ in 0..=random.below(MAX_CHANGES) {
        change(&mut lines, random);
    }
    lines.join("\n").into_bytes()
}

fn change(lines: &mut Vec<String>, random: &mut Random) {
    if lines.is_empty() {
        return lines.push("v 0 0 0".to_owned());
    }
    let (a, b) = (random.below(lines.len()), random.below(lines.len()));
    match random.below(8) {
        0 => drop(lines.remove(a)),
        1 => lines.insert(b, lines[a].clone()),
        2 => lines.swap(a, b),
        3 => lines.truncate(a),
        4 => lines.insert(a, (*random.pick(&LINES)).to_owned()),
        5 => {
            let vertices: Vec<String> = (1..=LONG_FACE).map(|number| number.to_string()).collect();
            lines.insert(a, format!("f {}", vertices.join(" ")));
        }
        _ => {
            let mut words: Vec<&str> = lines[a].split(' ').collect();
            let word = random.below(words.len());
            words[word] = WORDS[random.below(WORDS.len())];
            lines[a] = words.join(" ");
        }
    }
}
