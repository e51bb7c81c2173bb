//! The known name nearest to a mistyped one.

/// Shortest beginning of a name that is taken for the whole name, letters (chosen: shorter ones fit
/// too many names).
const MIN_BEGINNING: usize = 4;

/// Longest name that is compared, bytes (chosen: no known name is as long).
const MAX_LENGTH: usize = 64;

/// The known name nearest to a mistyped one: at most one edit, and one more for every four letters.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > MAX_LENGTH {
        return None;
    }
    let name = name.to_lowercase();
    let max_distance = 1 + name.chars().count() / 4;
    known
        .map(|known| {
            let candidate = known.to_lowercase();
            // The beginning of a name stands for the whole name.
            let begins = name.len() >= MIN_BEGINNING && candidate.starts_with(&name);
            let edits = distance(&name, &candidate);
            (if begins { edits.min(max_distance) } else { edits }, known)
        })
        .filter(|(distance, _)| *distance <= max_distance)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, known)| known)
}

/// Number of edits (insert, delete, replace) from one word to another: the Levenshtein distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, c) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, d) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(c != *d);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
