//! Old names of columns. They are read for one version: every reader asks [`current_column_name`].

pub use billow_solver::output::history::RENAMED_COLUMNS;

/// Columns of the summary table that were renamed: old name, current name.
pub const RENAMED_TABLE_COLUMNS: [(&str, &str); 4] = [
    ("close", "near_threshold"),
    ("close_margin", "near_threshold_margin"),
    ("stop_place", "stop_location"),
    ("viscous_fraction", "numerical_fraction"),
];

/// The current name of a column of the table or of a history, and a note for the user when `name`
/// is an old one.
pub fn current_column_name(name: &str) -> (&str, Option<String>) {
    let renamed = RENAMED_TABLE_COLUMNS.iter().chain(RENAMED_COLUMNS);
    match renamed.copied().find(|(old, _)| *old == name) {
        Some((old, current)) => (current, Some(note(old, current))),
        None => (name, None),
    }
}

/// The name under which a history column enters a content hash: its first name. So a renamed column
/// does not change the hash of the same values.
pub fn hashed_column_name(name: &str) -> &str {
    let renamed = RENAMED_COLUMNS.iter().find(|(_, current)| *current == name);
    renamed.map_or(name, |(old, _)| old)
}

/// What to tell a user who gave an old name.
pub fn note(old: &str, current: &str) -> String {
    format!("{old:?} is now called {current:?}; the old name works in this version only")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::job::row::ColumnId;

    #[test]
    fn an_old_name_gives_the_current_one_and_a_note() {
        let (name, note) = current_column_name("close");
        assert_eq!(name, "near_threshold");
        assert!(note.unwrap().contains("\"near_threshold\""));
        assert_eq!(current_column_name("peak_vz"), ("peak_vz", None));
    }

    #[test]
    fn old_names_of_the_table_are_not_columns_and_their_current_names_are() {
        for (old, current) in RENAMED_TABLE_COLUMNS {
            assert_eq!(ColumnId::from_name(old), None);
            assert!(ColumnId::from_name(current).is_some(), "{current}");
        }
    }

    #[test]
    fn a_history_column_has_one_name_in_content_hashes() {
        let names: BTreeSet<&str> = RENAMED_COLUMNS.iter().map(|(_, current)| *current).collect();
        assert_eq!(names.len(), RENAMED_COLUMNS.len());
        assert_eq!(hashed_column_name("broad_phase_rebuilds"), "contact_searches");
        assert_eq!(hashed_column_name("z_rim"), "z_rim");
    }
}
