//! A map of outcomes: the proportion of runs of each point that are safe, or that deployed.

use super::grid::Grid;
use super::outcome::Outcomes;
use super::{Source, invalid_option, outcome};
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::job::result_limit::ResultLimit;
use crate::job::row::{ColumnId, DerivedColumn};
use crate::platform::error::Result;
use crate::render::figure::legend::Sample;
use crate::render::figure::map::Cell;
use billow_solver::output::measures::Verdict;

/// Sign after a proportion that does not count every run.
const NOT_ALL: &str = "*";

/// What a map of outcomes counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judged {
    /// Runs that meet every limit.
    Safe,
    /// Runs that deployed.
    Deployed,
}

impl Judged {
    /// That of a column of the table: `safe` or `verdict`.
    pub fn of_name(name: &str) -> Option<Self> {
        [Self::Safe, Self::Deployed].into_iter().find(|judged| judged.name() == name)
    }

    /// Name of its column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Safe => DerivedColumn::Safe.name(),
            Self::Deployed => ColumnId::Verdict.name(),
        }
    }

    /// What a study is judged by: its limits, else the verdict.
    pub fn of(source: &Source<'_>) -> Self {
        if source.limits.is_empty() { Self::Deployed } else { Self::Safe }
    }

    /// Adjective of a run that is counted.
    fn word(self) -> &'static str {
        match self {
            Self::Safe => "safe",
            Self::Deployed => "deployed",
        }
    }

    /// How many runs of a row can be judged, and how many of these are counted.
    pub fn proportion(self, source: &Source<'_>, row: usize) -> Proportion {
        if let Some(runs) = source.runs_of(row) {
            return match self {
                Self::Safe => runs.safe,
                Self::Deployed => runs.deployed,
            };
        }
        let judged = match self {
            Self::Safe => match source.table.column(self.name()).map(|column| &column.cells[row]) {
                Some(Value::Bool(safe)) => Some(*safe),
                _ => None,
            },
            Self::Deployed => {
                outcome::verdict(source, row).map(|verdict| verdict == Verdict::Deployed)
            }
        };
        Proportion::count(judged)
    }
}

/// Draws the map over the parameters `axes[0]` (to the right) and `axes[1]` (upwards).
///
/// # Errors
/// A study without limits for `safe`; unknown names, one parameter on both axes, too many panels or cells.
pub fn svg(source: &Source<'_>, judged: Judged, axes: [&str; 2]) -> Result<String> {
    if source.table.column(judged.name()).is_none() {
        let problem = "the study has no limits, so no run is safe or not";
        let hint = "give the study \"limits\", as in {\"peak_vz\": \"< 25 m/s\"}";
        return Err(invalid_option("--measure", judged.name(), problem, "verdict", hint));
    }
    let mut grid = Grid::new(source, axes)?;
    let mut outcomes = Outcomes::new(source);
    let missed = Missed::new(source, judged);
    let mut used = vec![0; source.limits.len()];
    let (mut several, mut not_all) = (false, false);
    let panels = grid.panels(&mut |row, shared| {
        let proportion = judged.proportion(source, row);
        if proportion.of == 0 {
            return Cell::Letter(outcomes.letter(row));
        }
        let runs = source.single_rows(row).len().max(1);
        several |= runs > 1;
        not_all |= proportion.of < runs;
        Cell::Value {
            value: proportion.met as f64 / proportion.of as f64,
            outcome: outcomes.mark(row),
            shared,
            text: text(judged, source, row, proportion, runs),
            below: missed.letters(row, &mut used),
            missed: false,
        }
    })?;
    let mut legend = outcomes.legend(true);
    let word = judged.word();
    let counted = match judged {
        Judged::Safe => "safe: every limit is met",
        Judged::Deployed => "deployed: the verdict",
    };
    if several {
        grid.notes.insert(0, format!("k/n: k of n runs are {word}; {counted}."));
    } else {
        grid.notes.insert(0, format!("{counted}."));
    }
    if let Some(note) = source.meshes_note(None) {
        grid.notes.insert(1, note);
    }
    if not_all {
        let note = "*: a run failed, is infeasible or has not ended; it is not counted in k/n.";
        grid.notes.insert(1, note.to_owned());
    }
    if judged == Judged::Safe && !missed.named {
        let texts: Vec<String> = source.limits.iter().map(ToString::to_string).collect();
        grid.notes.insert(1, format!("Limit: {}.", texts.join(", ")));
    }
    legend.entries.extend(missed.legend(&used));
    let plain = format!("proportion of {word} runs");
    let label = format!("Proportion of {word} runs");
    Ok(grid.figure(&plain, &label, Some([0.0, 1.0]), panels, legend))
}

/// Which of several limits the runs of a point miss: one letter each.
struct Missed<'s, 'a> {
    source: &'s Source<'a>,
    /// Whether the limits have letters.
    named: bool,
}

impl<'s, 'a> Missed<'s, 'a> {
    /// Without letters for one limit, or none.
    fn new(source: &'s Source<'a>, judged: Judged) -> Self {
        Self { source, named: judged == Judged::Safe && source.limits.len() > 1 }
    }

    fn letter(index: usize) -> char {
        char::from(b'a' + u8::try_from(index % 26).unwrap_or(0))
    }

    /// The letters of a row; counts them.
    fn letters(&self, row: usize, used: &mut [usize]) -> String {
        if !self.named {
            return String::new();
        }
        let mut letters = Vec::new();
        for (index, limit) in self.source.limits.iter().enumerate() {
            if self.source.misses(limit, row) {
                used[index] += 1;
                letters.push(Self::letter(index).to_string());
            }
        }
        letters.join(" ")
    }

    fn legend(&self, used: &[usize]) -> Vec<(Sample, String)> {
        let limits = self.source.limits.iter().zip(used).enumerate().filter(|_| self.named);
        let entry = |(index, (limit, count)): (usize, (&ResultLimit, &usize))| {
            let sample = Sample::Letter(Self::letter(index).to_string());
            let misses = if limit.measure == ColumnId::Verdict { "not" } else { "misses" };
            (sample, format!("{misses} {limit} ({count})"))
        };
        limits.map(entry).collect()
    }
}

/// The text of a cell: k/n of several runs; of one run what it is.
fn text(
    judged: Judged,
    source: &Source<'_>,
    row: usize,
    proportion: Proportion,
    runs: usize,
) -> String {
    if runs > 1 {
        let sign = if proportion.of < runs { NOT_ALL } else { "" };
        return format!("{}/{}{sign}", proportion.met, proportion.of);
    }
    match (judged, proportion.met) {
        (Judged::Safe, 0) => "not safe".to_owned(),
        (Judged::Safe, _) => "safe".to_owned(),
        (Judged::Deployed, _) => outcome::verdict(source, row).map_or("", Verdict::name).to_owned(),
    }
}
