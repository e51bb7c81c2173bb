//! docs/reference/stability.md is generated from the table of scenes.

use std::fs;
use std::path::Path;

use billow_checks::stability::reference::page;

/// `BILLOW_UPDATE_REFERENCE=1` writes the page again.
#[test]
fn reference_page_of_stability_is_current() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/stability.md");
    if std::env::var_os("BILLOW_UPDATE_REFERENCE").is_some_and(|value| value == "1") {
        fs::write(&file, page()).unwrap();
    }
    assert_eq!(fs::read_to_string(&file).unwrap(), page(), "the page is stale");
}
