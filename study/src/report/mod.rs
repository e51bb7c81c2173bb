//! One file that answers: a page with the question and its answer, limits, table, parallel coordinates, curves, shapes in
//! motion, and how to repeat it. It opens without network, and is made from what is stored alone.
//!
//! The page is `page/page.html` with its style, its scripts and two libraries put in, and one block of JSON. The scripts
//! set every text of a study as text, never as HTML, so whatever a name holds is inert.

use std::collections::BTreeSet;

use serde_json::{Value as Json, json};

use crate::analysis::answer::Answer;
use crate::job::{JobId, Status};
use crate::platform::error::{Error, Result};
use crate::platform::provenance;
use crate::print::answer::{choice, topics};
use crate::store::stored::Stored;
use crate::store::table::Table;

mod before;
mod curves;
mod packed;
mod shapes;
mod table;

pub use before::Before;

/// The page, with `{{name}}` where a part goes.
const PAGE: &str = include_str!("page/page.html");
/// What goes into the page, in this order.
const PARTS: [(&str, &str); 10] = [
    ("style", include_str!("page/page.css")),
    ("licences", include_str!("vendor/LICENSES.txt")),
    ("d3", include_str!("vendor/d3.min.js")),
    ("three", include_str!("vendor/three.min.js")),
    ("base", include_str!("page/base.js")),
    ("table", include_str!("page/table.js")),
    ("parallel", include_str!("page/parallel.js")),
    ("curves", include_str!("page/curves.js")),
    ("playback", include_str!("page/playback.js")),
    ("main", include_str!("page/main.js")),
];
/// Size of a report if none is asked for, bytes.
pub const DEFAULT_SIZE: f64 = 40e6;

/// What a report is made of.
pub struct Report<'a> {
    /// The results.
    pub stored: &'a Stored<'a>,
    /// Their table, in the units to show.
    pub table: &'a Table,
    /// Their answer.
    pub answer: &'a Answer,
    /// Charts of the answer: name and SVG.
    pub charts: Vec<(String, String)>,
    /// The run before, where that was of another form of the study.
    pub before: Option<Before>,
    /// Size that the file should not exceed, bytes.
    pub size: f64,
    /// Whether a run of the study goes on.
    pub is_running: bool,
}

/// Bytes of the file that are free.
pub(crate) struct Budget {
    free: f64,
}

impl Budget {
    fn free(&self) -> f64 {
        self.free.max(0.0)
    }

    fn use_up(&mut self, bytes: f64) {
        self.free -= bytes;
    }
}

impl Report<'_> {
    /// The page, and what it leaves out for its size.
    ///
    /// # Errors
    /// study.json cannot be read. A history that cannot be read leaves its job without curve and shape.
    pub fn html(&self) -> Result<(String, Vec<String>)> {
        let Self { stored, table, answer, before, .. } = self;
        let study = &stored.study;
        let jobs = self.with_history();
        let mut topics: Vec<Json> =
            topics(answer).iter().map(|t| json!([t.name, t.lines])).collect();
        topics.extend(before.iter().map(|before| json!(["run before", before.lines(table)])));
        let mut data = json!({
            "study": study.name,
            "question": answer.question,
            "topics": topics,
            "before": before.as_ref().map(|before| before.columns(study.result_limits())),
            "choice": choice(answer),
            "borders": answer.searches.as_ref().map(|searches| {
                let found = searches.table();
                json!({
                    "parameter": searches.parameter, "criterion": searches.criterion,
                    "rows": found.rows(), "columns": table::columns(&found, &[]),
                })
            }),
            "running": self.is_running,
            "rows": table.rows(),
            "columns": table::columns(table, study.result_limits()),
            "replicates": study.replicates(),
            "points": table::points(table, &study.replicates()),
            "limits": table::limits(study.result_limits()),
            "charts": self.charts,
            "provenance": self.provenance()?,
        });
        let parts: usize = PARTS.iter().map(|(_, text)| text.len()).sum();
        let mut budget =
            Budget { free: self.size - (parts + PAGE.len() + data.to_string().len()) as f64 };
        data["curves"] = curves::curves(stored, &jobs, &mut budget);
        data["shapes"] = shapes::shapes(stored, &jobs, &self.named(), &mut budget);
        let notes = notes(&data);
        data["notes"] = json!(notes);
        // No text can end the block, or begin another one.
        let data = data.to_string().replace('<', "\\u003c");
        let mut page = PAGE.to_owned();
        for (name, text) in PARTS {
            page = page.replacen(&format!("{{{{{name}}}}}"), text, 1);
        }
        Ok((page.replacen("{{data}}", &data, 1), notes))
    }

    /// The rows whose job has a history, each job once.
    fn with_history(&self) -> Vec<(usize, JobId)> {
        let Some(jobs) = self.table.column("job") else { return Vec::new() };
        let mut known = BTreeSet::new();
        let ended = |row: &usize| {
            !matches!(self.table.status(*row), None | Some(Status::Pending | Status::Infeasible))
        };
        let job = |row: usize| {
            let id = JobId::from_digits(&jobs.cells[row].to_string())?;
            let recorded = self.stored.record(&id)?.file_hash.is_some();
            (recorded && known.insert(id.clone())).then_some((row, id))
        };
        (0..self.table.rows()).filter(ended).filter_map(job).collect()
    }

    /// Rows that the answer names.
    fn named(&self) -> Vec<usize> {
        let Self { answer, table, .. } = self;
        let extremes = answer.worst.iter().chain(&answer.fastest).chain(&answer.hardest);
        let extremes = extremes.chain(&answer.most_energy);
        let Some(jobs) = table.column("job") else { return Vec::new() };
        let row = |job: &String| jobs.cells.iter().position(|cell| cell.to_string() == *job);
        extremes.filter_map(|extreme| row(&extreme.job)).collect()
    }

    /// How to repeat the study.
    fn provenance(&self) -> Result<Json> {
        let path = self.stored.results.study_path();
        let bytes = self.stored.results.files().read(&path);
        let bytes = bytes.map_err(|error| Error::Disk { path, problem: error.to_string() })?;
        let study: Json = serde_json::from_slice(&bytes).unwrap_or_default();
        Ok(json!({
            "program": provenance::PROGRAM_VERSION,
            "commit": provenance::COMMIT,
            "physics": provenance::PHYSICS_VERSION,
            "study": serde_json::to_string_pretty(&study).unwrap_or_default(),
        }))
    }
}

/// Up to `most` of some items, equally far apart.
fn spread<T: Clone>(items: &[T], most: usize) -> Vec<T> {
    let count = most.min(items.len());
    (0..count).map(|k| items[k * items.len() / count].clone()).collect()
}

/// What the page leaves out.
fn notes(data: &Json) -> Vec<String> {
    let number = |part: &str, name: &str| data[part][name].as_u64().unwrap_or(0);
    let mut notes = Vec::new();
    let jobs = |part: &str| data[part]["jobs"].as_array().map_or(0, Vec::len);
    for (part, what) in [("curves", "curves"), ("shapes", "shapes in motion")] {
        let (with, without) = (jobs(part), number(part, "without"));
        if with > 0 && without > 0 {
            notes.push(format!("{what} of {with} jobs; {without} others have none here"));
        }
    }
    let every = number("shapes", "every");
    if every > 1 {
        notes.push(format!("one of {every} stored frames, for the size of the file"));
    }
    notes
}
