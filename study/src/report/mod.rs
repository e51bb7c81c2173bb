//! One file that answers: a page with the question and its answer, limits, table, parallel coordinates, curves, shapes in
//! motion, and how to repeat it. It opens without network, and is made from what is stored alone.
//!
//! The page is `page/page.html` with its style, its scripts and two libraries put in, and one block of JSON. The scripts
//! set every text of a study as text, never as HTML, so whatever a name holds is inert.

use std::collections::BTreeSet;
use std::fmt::{self, Write as _};

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
        let data = json!({
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
            "provenance": self.provenance()?,
        });
        let mut template = PAGE.to_owned();
        for (name, text) in PARTS {
            template = template.replacen(&format!("{{{{{name}}}}}"), text, 1);
        }
        let (head, tail) = template.split_once("{{data}}").expect("the page has a place for data");
        // The page of a large study takes as much memory as its table: it is written once, part after part.
        let mut page = head.to_owned();
        push(&mut page, &data);
        drop(data);
        add(&mut page, "charts", &json!(self.charts));
        let mut budget = Budget { free: self.size - (page.len() + tail.len()) as f64 };
        let curves = curves::curves(stored, &jobs, &mut budget);
        let shapes = shapes::shapes(stored, &jobs, &self.named(), &mut budget);
        let notes = notes(&curves, &shapes);
        add(&mut page, "curves", &curves);
        add(&mut page, "shapes", &shapes);
        add(&mut page, "notes", &json!(notes));
        page.push_str(tail);
        Ok((page, notes))
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

/// JSON in a page: no text of it can end its block, or begin another one.
struct Inert<'a>(&'a mut String);

impl fmt::Write for Inert<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for part in text.split_inclusive('<') {
            let without = part.strip_suffix('<');
            self.0.push_str(without.unwrap_or(part));
            self.0.push_str(without.map_or("", |_| "\\u003c"));
        }
        Ok(())
    }
}

/// Appends JSON to a page.
fn push(page: &mut String, json: &Json) {
    write!(Inert(page), "{json}").expect("writing to a string does not fail");
}

/// Adds a member to the object, not empty, that ends a page.
fn add(page: &mut String, name: &str, json: &Json) {
    page.pop();
    page.extend([",\"", name, "\":"]);
    push(page, json);
    page.push('}');
}

/// What the page leaves out.
fn notes(curves: &Json, shapes: &Json) -> Vec<String> {
    let number = |part: &Json, name: &str| part[name].as_u64().unwrap_or(0);
    let mut notes = Vec::new();
    for (part, what) in [(curves, "curves"), (shapes, "shapes in motion")] {
        let with = part["jobs"].as_array().map_or(0, Vec::len);
        let without = number(part, "without");
        if with > 0 && without > 0 {
            notes.push(format!("{what} of {with} jobs; {without} others have none here"));
        }
    }
    let every = number(shapes, "every");
    if every > 1 {
        notes.push(format!("one of {every} stored frames, for the size of the file"));
    }
    notes
}
