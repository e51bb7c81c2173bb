//! Reads the journal of a results folder as plain JSON lines.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::place;

/// The journal files of a results folder, in order.
pub fn paths(results: &Path) -> Vec<PathBuf> {
    let mut paths = place::files(&results.join("journal"));
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "jsonl"));
    paths
}

/// The job of a line that records the end of a job.
pub fn ended_job(line: &str) -> Option<String> {
    let line: Value = serde_json::from_str(line).ok()?;
    line["cells"]["status"].as_str()?;
    Some(line["job"].as_str()?.to_owned())
}

/// Jobs that are recorded as ended, and how often since they were last asked to run again. A record
/// of a job that took the process with it is no end.
pub fn ended(results: &Path) -> BTreeMap<String, usize> {
    let mut jobs = BTreeMap::new();
    for path in paths(results) {
        let text = fs::read(path).unwrap_or_default();
        for line in text.split(|byte| *byte == b'\n') {
            let Ok(line) = serde_json::from_slice::<Value>(line) else { continue };
            let Some(job) = line["job"].as_str() else { continue };
            if line["kind"] == "invalidated" {
                jobs.remove(job);
            } else if line["cells"]["status"].as_str().is_some_and(|status| status != "crashed") {
                *jobs.entry(job.to_owned()).or_default() += 1;
            }
        }
    }
    jobs
}
