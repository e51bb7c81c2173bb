//! The pages of docs/reference are generated from the tables of the code.
//!
//! After a change of a table, `BILLOW_UPDATE_REFERENCE=1 cargo test --release --locked -p billow-study
//! --test repository reference` writes the pages again.

use std::fs;

use billow_study::input::keys::listing::reference_page as keys;
use billow_study::store::table::reference::page as columns;

use crate::commands_page::{commands, exit_codes};
use crate::sources::root;

/// Whether the tests write their files again: `BILLOW_UPDATE_REFERENCE=1`.
pub fn is_update() -> bool {
    std::env::var_os("BILLOW_UPDATE_REFERENCE").is_some_and(|value| value == "1")
}

/// Fails when a file is not the generated text; writes it first with the update switch. `path` is
/// relative to the root of the repository.
fn assert_current(path: &str, text: &str) {
    let file = root().join(path);
    if is_update() {
        fs::create_dir_all(file.parent().expect("a folder")).expect("the folder exists");
        fs::write(&file, text).expect("the page is written");
    }
    let stored = fs::read_to_string(&file).unwrap_or_default();
    let line = stored.lines().zip(text.lines()).position(|(stored, new)| stored != new);
    let line = line.unwrap_or_else(|| stored.lines().count().min(text.lines().count())) + 1;
    assert!(
        stored == text,
        "{path} is stale from line {line} on\n  next: BILLOW_UPDATE_REFERENCE=1 cargo test --release \
         --locked -p billow-study --test repository reference"
    );
}

#[test]
fn reference_page_of_keys_is_current() {
    assert_current("docs/reference/keys.md", &keys());
}

#[test]
fn reference_page_of_columns_is_current() {
    assert_current("docs/reference/columns.md", &columns());
}

#[test]
fn reference_page_of_commands_is_current() {
    assert_current("docs/reference/commands.md", &commands());
}

#[test]
fn reference_page_of_exit_codes_is_current() {
    assert_current("docs/reference/exit-codes.md", &exit_codes());
}
