//! What a mistyped name was meant to be.

/// Letters of a name by which one that begins so is meant, at least.
const BEGINNING: usize = 4;

/// The known name nearest to a mistyped one, if any is near.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > 64 {
        return None;
    }
    let name = name.to_lowercase();
    let furthest = 1 + name.chars().count() / 4;
    known
        .map(|known| {
            let own = known.to_lowercase();
            // Who stops early means what begins so.
            let begun = name.len() >= BEGINNING && own.starts_with(&name);
            let edits = distance(&name, &own);
            (if begun { edits.min(furthest) } else { edits }, known)
        })
        .filter(|(distance, _)| *distance <= furthest)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, known)| known)
}

/// Edits (insert, delete, replace) from one word to another.
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
