//! The known name nearest to a mistyped one, for every message that suggests a name.

/// Shortest beginning of a name that is taken for the whole name, letters (chosen: shorter ones fit
/// too many names).
const MIN_BEGINNING: usize = 4;

/// Longest name that is compared, bytes (chosen: no known name and few file names are as long).
const MAX_LENGTH: usize = 120;

/// The known name nearest to a mistyped one: at most one edit, and one more for every four letters.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    if name.is_empty() || name.len() > MAX_LENGTH {
        return None;
    }
    let name = name.to_lowercase();
    let max_distance = 1 + name.chars().count() / 4;
    known
        .filter(|known| known.len() <= MAX_LENGTH)
        .map(|known| {
            let candidate = known.to_lowercase();
            // The beginning of a name stands for the whole name.
            let begins = name.len() >= MIN_BEGINNING && candidate.starts_with(&name);
            let edits = strsim::osa_distance(&name, &candidate);
            // A name of one or two letters with every letter replaced is another name.
            let kept = edits < name.chars().count().max(candidate.chars().count());
            (if begins { edits.min(max_distance) } else { edits }, kept, known)
        })
        .filter(|(distance, kept, _)| *distance <= max_distance && *kept)
        .min_by_key(|(distance, ..)| *distance)
        .map(|(.., known)| known)
}

/// The question that suggests the nearest name: "did you mean thickness?"; `None` where no name is near.
pub fn did_you_mean<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    nearest(name, known).map(|near| format!("did you mean {near}?"))
}

/// What a problem says of the nearest name: "; did you mean thickness?", or nothing.
pub fn or_nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    did_you_mean(name, known).map_or_else(String::new, |question| format!("; {question}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_name_finds_the_nearest() {
        let known = ["run", "rerun", "table", "frames", "direct", "delayed"];
        for (name, near) in [
            ("rnu", Some("run")),
            ("delaid", Some("delayed")),
            ("Table", Some("table")),
            ("fram", Some("frames")),
            ("xyz", None),
            ("", None),
            ("q", None),
        ] {
            assert_eq!(nearest(name, known.into_iter()), near, "{name}");
        }
        assert_eq!(did_you_mean("tabel", known.into_iter()).unwrap(), "did you mean table?");
        assert_eq!(nearest(&"x".repeat(70_000), known.into_iter()), None);
    }
}
