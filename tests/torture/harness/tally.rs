//! The table at the end.

use std::collections::BTreeMap;
use std::time::Duration;

use billow_study::cli::Format;
use billow_study::cli::print::print_rows;
use billow_study::input::value::Value;
use billow_study::platform::error::Result;

use super::trial::{Fault, Trial};

/// Sums of one kind.
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

    fn cells(&self) -> Vec<Value> {
        let mut cells: Vec<Value> = vec![
            self.kind.as_str().into(),
            self.trials.into(),
            self.detected.into(),
            self.survived.into(),
        ];
        cells.extend(self.faults.iter().map(|number| Value::from(*number)));
        let mut notes: Vec<String> = vec![self.note.clone()];
        notes.retain(|note| !note.is_empty());
        notes.extend(self.counts.iter().map(|(name, number)| format!("{number} {name}")));
        notes.extend(self.skipped.iter().map(|(why, number)| format!("{number} skipped: {why}")));
        let longest = format!("{:.2}", self.longest.as_secs_f64());
        cells.extend([longest.into(), self.limit.as_secs().into(), notes.join("; ").into()]);
        cells
    }
}

/// Prints one row for each kind.
pub fn print(tallies: &[Tally]) -> Result<()> {
    let mut columns = vec!["kind", "trials", "detected", "survived"];
    columns.extend(Fault::ALL.map(Fault::name));
    columns.extend(["longest (s)", "limit (s)", "notes"]);
    let rows: Vec<Vec<Value>> = tallies.iter().map(Tally::cells).collect();
    print_rows(&columns, &rows, Format::Table, &mut std::io::stdout().lock())
}
