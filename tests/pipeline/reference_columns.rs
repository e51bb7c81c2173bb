//! docs/reference/columns.md is generated from the tables of columns.

use std::fs;
use std::path::Path;

use billow_study::job::row::reference;

/// Fails when a reference page is not current. `BILLOW_UPDATE_REFERENCE=1` writes it again.
fn assert_current(path: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    if std::env::var_os("BILLOW_UPDATE_REFERENCE").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
    }
    let stored = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        stored == text,
        "{} is not current; run the tests once with BILLOW_UPDATE_REFERENCE=1",
        path.display()
    );
}

#[test]
fn the_page_of_columns_is_current() {
    assert_current("docs/reference/columns.md", &reference::page());
}
