//! Job ids of every shipped study: a change of names must not change them.
//!
//! The list was written by version 0.1.0. An id changes only with the physics version or with a study file;
//! then the list is written again: `BILLOW_UPDATE_REFERENCE=1 cargo test --release --workspace --locked job_ids`.

use std::collections::BTreeMap;
use std::process::Command;

use crate::reference::is_update;
use crate::sources::{files, root, text};

const LIST: &str = "tests/reference/job_ids.json";

/// Ids in plan order by study; `null` for a point without a job.
type Ids = BTreeMap<String, Vec<Option<String>>>;

fn planned() -> Ids {
    let mut all = Ids::new();
    let page = text("studies/README.md".as_ref());
    for path in files("studies", ".json") {
        // A study of the user's beside the shipped ones is not looked at.
        if !page.contains(path.file_name().expect("a name").to_string_lossy().as_ref()) {
            continue;
        }
        // A file of maps (`make stability`) is no study.
        if path.ends_with("stability.json") {
            continue;
        }
        let output = Command::new(env!("CARGO_BIN_EXE_billow"))
            .args(["plan", &path.to_string_lossy(), "--json", "--results", "target/no-results"])
            .current_dir(root())
            .output()
            .expect("billow runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !said.contains("warning"), "{}: {said}", path.display());
        let rows: Vec<serde_json::Value> =
            serde_json::from_slice(&output.stdout).expect("JSON rows");
        let id = |row: &serde_json::Value| row["job"].as_str().map(str::to_owned);
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        all.insert(name, rows.iter().map(id).collect());
    }
    all
}

#[test]
fn job_ids_of_shipped_studies_are_those_of_the_list() {
    let planned = planned();
    if is_update() {
        let text = serde_json::to_string_pretty(&planned).expect("JSON") + "\n";
        std::fs::write(root().join(LIST), text).expect("the list is written");
        return;
    }
    let listed: Ids = serde_json::from_str(&text(LIST.as_ref())).expect("JSON");
    assert!(listed.values().flatten().count() > 100, "the list has the shipped studies");
    for (study, ids) in &planned {
        assert_eq!(listed.get(study), Some(ids), "{study}");
    }
    assert_eq!(listed.len(), planned.len(), "{:?}", planned.keys());
}
