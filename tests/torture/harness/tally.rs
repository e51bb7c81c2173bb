//! The table at the end.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Duration;

use super::trial::{Fault, Trial};

/// Sums of one kind.
#[derive(Debug)]
pub struct Tally {
    /// Name of the kind.
    pub kind: String,
    /// Limit of its commands.
    pub limit: Duration,
    /// What the table says about the kind.
    pub note: String,
    trials: usize,
    detected: usize,
    survived: usize,
    skipped: BTreeMap<String, usize>,
    faults: [usize; Fault::ALL.len()],
    counts: BTreeMap<&'static str, usize>,
    longest: Duration,
}

impl Tally {
    /// Nothing yet.
    pub fn new(kind: &str, limit: Duration) -> Self {
        Self {
            kind: kind.to_owned(),
            limit,
            note: String::new(),
            trials: 0,
            detected: 0,
            survived: 0,
            skipped: BTreeMap::new(),
            faults: [0; Fault::ALL.len()],
            counts: BTreeMap::new(),
            longest: Duration::ZERO,
        }
    }

    /// Adds a trial.
    pub fn add(&mut self, trial: &Trial) {
        if let Some(reason) = &trial.skipped {
            *self.skipped.entry(reason.clone()).or_default() += 1;
            return;
        }
        self.trials += 1;
        if trial.faults.is_empty() {
            let sum = if trial.detected { &mut self.detected } else { &mut self.survived };
            *sum += 1;
        }
        // A trial counts once in each column.
        for (sum, fault) in self.faults.iter_mut().zip(Fault::ALL) {
            *sum += usize::from(trial.faults.iter().any(|(found, _)| *found == fault));
        }
        for (name, number) in &trial.counts {
            *self.counts.entry(name).or_default() += number;
        }
        self.longest = self.longest.max(trial.longest);
    }

    /// Number of trials with a fault, by columns.
    pub fn bad(&self) -> usize {
        self.faults.iter().sum()
    }

    fn cells(&self) -> Vec<String> {
        let mut cells = vec![
            self.kind.clone(),
            self.trials.to_string(),
            self.detected.to_string(),
            self.survived.to_string(),
        ];
        cells.extend(self.faults.iter().map(ToString::to_string));
        let longest = match self.longest {
            Duration::ZERO => "-".to_owned(),
            longest => format!("{:.2}", longest.as_secs_f64()),
        };
        cells.extend([longest, format!("{:.0}", self.limit.as_secs_f64()), self.notes()]);
        cells
    }

    fn notes(&self) -> String {
        let mut notes = Vec::new();
        if !self.note.is_empty() {
            notes.push(self.note.clone());
        }
        notes.extend(self.counts.iter().map(|(name, number)| format!("{number} {name}")));
        notes.extend(self.skipped.iter().map(|(why, number)| format!("{number} skipped: {why}")));
        notes.join("; ")
    }
}

/// The table as Markdown with aligned columns.
pub fn table(tallies: &[Tally]) -> String {
    let mut rows = vec![head()];
    rows.extend(tallies.iter().map(Tally::cells));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<usize> = (0..rows[0].len()).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for (number, row) in rows.iter().enumerate() {
        for (cell, width) in row.iter().zip(&widths) {
            let _ = write!(text, "| {cell:<width$} ");
        }
        text += "|\n";
        if number == 0 {
            for width in &widths {
                let _ = write!(text, "|{}", "-".repeat(width + 2));
            }
            text += "|\n";
        }
    }
    text
}

fn head() -> Vec<String> {
    let mut head: Vec<&str> = vec!["kind", "trials", "detected", "survived"];
    head.extend(Fault::ALL.map(Fault::name));
    head.extend(["longest (s)", "limit (s)", "notes"]);
    head.into_iter().map(ToOwned::to_owned).collect()
}
