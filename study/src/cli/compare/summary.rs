//! The summary: one row per value and measure.

use std::io::Write;

use super::Comparison;
use crate::analysis::compare::{self, Better, Measure, Tally};
use crate::cli::Format;
use crate::cli::print::{Heading, print_quantities};
use crate::input::value::Value;
use crate::job::proportion::Proportion;
use crate::platform::error::Result;

/// Outcomes of a pair: column, outcome, and whether a table always shows the column.
const OUTCOMES: [(&str, Better, bool); 10] = [
    ("other_better", Better::Other, true),
    ("base_better", Better::Base, true),
    ("ties", Better::Tie, true),
    ("only_other", Better::OnlyOther, false),
    ("only_base", Better::OnlyBase, false),
    ("neither", Better::Neither, false),
    ("other_lower", Better::Lower, false),
    ("other_higher", Better::Higher, false),
    ("same_job", Better::SameJob, false),
    ("pending", Better::Pending, false),
];
/// The outcomes that have an interval, and its columns for programs.
const INTERVALS: [(Better, &str, &str); 2] = [
    (Better::Other, "other_better_low", "other_better_high"),
    (Better::Base, "base_better_low", "base_better_high"),
];

impl Comparison<'_> {
    /// Prints one row per value and measure. A table has no columns for outcomes that no pair has.
    pub(super) fn print_tallies(&self, format: Format, out: &mut dyn Write) -> Result<()> {
        let tallies = compare::tallies(self.table, &self.pairs, &self.by.name, &self.measures);
        let occurs = |outcome| tallies.iter().any(|tally| tally.count(outcome) > 0);
        let outcomes: Vec<(&str, Better)> = OUTCOMES
            .into_iter()
            .filter(|(_, outcome, always)| *always || format != Format::Table || occurs(*outcome))
            .map(|(name, outcome, _)| (name, outcome))
            .collect();
        // A table shows differences only where a measure has no ratio.
        let with_differences =
            format != Format::Table || self.measures.iter().any(Measure::is_signed);
        let differences: &[&str] = if with_differences {
            &["median_difference", "least_difference", "largest_difference"]
        } else {
            &[]
        };
        let intervals: &[(Better, &str, &str)] =
            if self.with_intervals && format != Format::Table { &INTERVALS } else { &[] };
        let by = Heading { name: self.by.name.clone(), unit: self.by.shown.clone() };
        let others = ["measure", "pairs"].into_iter();
        let others = others
            .chain(outcomes.iter().map(|(name, _)| *name))
            .chain(intervals.iter().flat_map(|(_, low, high)| [*low, *high]))
            .chain(["median_ratio", "least_ratio", "largest_ratio"])
            .chain(differences.iter().copied());
        let columns: Vec<Heading> = [by].into_iter().chain(others.map(Heading::plain)).collect();
        // Rows of the differences have the units of different measures, so a cell says its own.
        let in_unit = |measure: &str, value: f64| {
            let shown = self.measures.iter().find(|known| known.column.name == measure);
            let unit = shown.map(|known| known.column.shown.of_difference());
            match unit.filter(|_| format == Format::Table) {
                Some(unit) => Value::Text(unit.brief(value)),
                None => Value::Number(value),
            }
        };
        let row = |tally: &Tally| {
            let mut row = vec![tally.value.clone(), Value::Text(tally.measure.clone())];
            row.push(number(tally.pairs()));
            row.extend(outcomes.iter().map(|(_, outcome)| self.count(tally, *outcome, format)));
            for (outcome, ..) in intervals {
                let [low, high] = share(tally, *outcome).wilson().map(Value::Number);
                let known = tally.pairs() > 0;
                row.extend(if known { [low, high] } else { [Value::Null, Value::Null] });
            }
            row.extend(tally.ratio.map_or([const { Value::Null }; 3], |spread| {
                [spread.median, spread.least, spread.largest].map(Value::Number)
            }));
            if with_differences {
                row.extend(tally.difference.map_or([const { Value::Null }; 3], |spread| {
                    [spread.median, spread.least, spread.largest]
                        .map(|value| in_unit(&tally.measure, value))
                }));
            }
            row
        };
        let rows: Vec<Vec<Value>> = tallies.iter().map(row).collect();
        print_quantities(&columns, &rows, format, out)
    }

    /// The number of pairs with an outcome; in a table with its interval where the study asks for one.
    fn count(&self, tally: &Tally, outcome: Better, format: Format) -> Value {
        let has_interval = INTERVALS.iter().any(|(known, ..)| *known == outcome);
        let count = tally.count(outcome);
        if self.with_intervals && has_interval && format == Format::Table && tally.pairs() > 0 {
            return Value::Text(share(tally, outcome).to_string());
        }
        number(count)
    }
}

/// The pairs with an outcome, of all pairs of two jobs that have ended.
fn share(tally: &Tally, outcome: Better) -> Proportion {
    Proportion { met: tally.count(outcome), of: tally.pairs() }
}

fn number(number: usize) -> Value {
    Value::Integer(i64::try_from(number).unwrap_or(i64::MAX))
}
