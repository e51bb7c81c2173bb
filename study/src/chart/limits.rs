//! The limit of a measure in a chart: its line, the side that is not allowed, the cells that miss it.

use std::cmp::Ordering;

use super::{Source, number};
use crate::input::value::{Value, short_number};
use crate::job::result_limit::{Condition, ResultLimit, Safety};
use crate::job::row::{ColumnId, DerivedColumn};
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Direction, Rule};
use crate::render::figure::ticks::minus;
use crate::render::figure::unit::Unit;
use crate::store::table::{Column, Table, row_column_name};

/// A limit farther from the values than this many times their range is not on the axis. Chosen: the values
/// still take a fourth of it.
const MAX_DISTANCE: f64 = 3.0;

/// A bound of the drawn measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// Its value, SI.
    value: f64,
    /// Whether values must be above it.
    above: bool,
    /// Whether the bound itself is allowed; `None` where the runs say it: of all limits together.
    or_equal: Option<bool>,
    /// Its meaning, as `peak_vz < 25 m/s`.
    text: String,
    /// Whether the measure is a margin, which is 0 at its limit.
    margin: bool,
}

/// Measures that are extremes of a history column of another name, and the signs with which a limit of them is one of
/// the column.
const SERIES: [(ColumnId, &str, &[f64]); 10] = [
    (ColumnId::LargestHeight, "height", &[1.0]),
    (ColumnId::PeakVz, "vz", &[1.0]),
    (ColumnId::PeakDownwardVz, "vz", &[-1.0]),
    (ColumnId::PeakSpeed, "vz", &[1.0, -1.0]),
    (ColumnId::PeakFilmSpeed, "film_speed", &[1.0]),
    (ColumnId::PeakPressure, "pressure", &[1.0]),
    (ColumnId::LargestZRim, "z_rim", &[1.0]),
    (ColumnId::LowestZRim, "z_rim", &[1.0]),
    (ColumnId::PeakKineticEnergy, "kinetic_energy", &[1.0]),
    (ColumnId::PeakLidForce, "lid_force", &[1.0]),
];

/// The history column of which a measure is an extreme, and the signs of its limits there.
pub fn series_of(measure: ColumnId) -> Option<(&'static str, &'static [f64])> {
    let known = SERIES.iter().find(|(id, ..)| *id == measure)?;
    Some((known.1, known.2))
}

impl<'a> Source<'a> {
    /// The bounds of a history column.
    pub(super) fn bounds_of_history(&self, column: &str) -> Vec<Bound> {
        let bounds = self.limits.iter().flat_map(|limit| {
            let known = series_of(limit.measure).filter(|(name, _)| *name == column);
            let same: &[f64] = if limit.measure.name() == column { &[1.0] } else { &[] };
            let signs = known.map_or(same, |(_, signs)| signs);
            signs.iter().filter_map(|sign| {
                let bound = Bound::of(limit)?;
                Some(Bound { value: sign * bound.value, ..bound })
            })
        });
        bounds.collect()
    }

    /// The bound of a measure; that of a margin is 0.
    pub(super) fn bound(&self, measure: &Column) -> Option<Bound> {
        let name = row_column_name(&measure.name);
        let margin =
            |or_equal, text| Bound { value: 0.0, above: true, or_equal, text, margin: true };
        if name == DerivedColumn::SmallestMargin.name() {
            return Some(margin(None, "every limit is met".to_owned()));
        }
        if let Some(limit) = self.limits.iter().find(|limit| limit.column_name() == name) {
            let strict = matches!(limit.condition, Condition::Bound { or_equal: false, .. });
            return Some(margin(Some(!strict), limit.to_string()));
        }
        let limit = self.limits.iter().find(|limit| limit.measure.name() == name)?;
        Bound::of(limit)
    }

    /// Whether a run of a row does not meet a limit.
    pub(super) fn misses(&self, limit: &ResultLimit, row: usize) -> bool {
        let (table, rows) = self.judged_rows(row);
        rows.iter().any(|row| table.judge(limit, *row).is_some_and(|judged| !judged.met))
    }

    /// The table of the single runs, and the runs of a row.
    fn judged_rows(&self, row: usize) -> (&'a Table, Vec<usize>) {
        match (self.runs, self.runs_of(row)) {
            (Some(runs), Some(of_row)) => (runs.single, of_row.rows.clone()),
            _ => (self.table, vec![row]),
        }
    }
}

impl Bound {
    /// The bound of a limit of a number.
    fn of(limit: &ResultLimit) -> Option<Self> {
        let Condition::Bound { bound, above, or_equal } = limit.condition else { return None };
        let (or_equal, text) = (Some(or_equal), limit.to_string());
        Some(Self { value: bound, above, or_equal, text, margin: false })
    }

    /// Whether a row with this value (SI) misses the limit.
    pub fn is_missed(&self, source: &Source<'_>, row: usize, value: f64) -> bool {
        match (value.partial_cmp(&self.value), self.or_equal) {
            (Some(Ordering::Less), _) => self.above,
            (Some(Ordering::Greater), _) => !self.above,
            (Some(Ordering::Equal), Some(allowed)) => !allowed,
            // A run with a smallest margin of 0 that is not safe lies at a bound that is not allowed.
            (Some(Ordering::Equal), None) => {
                let (table, rows) = source.judged_rows(row);
                let cell = |name: DerivedColumn, row: usize| {
                    table.column(name.name()).map_or(&Value::Null, |column| &column.cells[row])
                };
                rows.iter().any(|row| {
                    number(cell(DerivedColumn::SmallestMargin, *row)) == Some(0.0)
                        && table.safety(*row).is_some_and(|safety| safety != Safety::Safe)
                })
            }
            (None, _) => true,
        }
    }

    /// Text of the legend.
    pub fn text(&self) -> String {
        if self.margin {
            format!("missed by its value; above 0: {}, uncertainty not counted", self.text)
        } else {
            format!("misses the limit ({})", self.text)
        }
    }

    /// The legend of the side that misses it.
    pub fn legend(&self) -> Legend {
        let entries = vec![(Sample::Closed, self.text())];
        Legend { heading: "Limit".to_owned(), entries }
    }

    /// A note on margins that are not distances.
    pub fn note(&self, source: &Source<'_>) -> Option<String> {
        let words =
            source.limits.iter().filter(|limit| matches!(limit.condition, Condition::Is(_)));
        let names: Vec<&str> = words.map(|limit| limit.measure.name()).collect();
        (self.margin && !names.is_empty()).then(|| {
            format!("The margin of {} is 1 if the limit is met, −1 if not.", names.join(", "))
        })
    }

    /// The line of the limit in a history, of which a part may lie beyond it.
    pub fn line(&self, unit: &Unit) -> Rule {
        Rule { value: unit.shown(self.value), text: self.text.clone(), closed: None }
    }

    /// The line of the limit, with the side that misses it.
    pub fn rule(&self, unit: &Unit) -> Rule {
        let closed = if self.above { Direction::Down } else { Direction::Up };
        Rule { value: unit.shown(self.value), text: self.label(unit), closed: Some(closed) }
    }

    fn label(&self, unit: &Unit) -> String {
        if self.margin {
            return "limit".to_owned();
        }
        let number = unit.shown(self.value);
        let near: f64 = format!("{number:.5e}").parse().unwrap_or(number);
        format!("limit {}", unit.after(&minus(&short_number(near))))
    }

    /// The ends of the values with the limit; a note in its place if it is far from them.
    pub fn extended(&self, [low, high]: [f64; 2], unit: &Unit) -> ([f64; 2], Option<String>) {
        let value = unit.shown(self.value);
        // Zero is an end of the axis where it is near.
        let span = high - low.min(0.0).min(high);
        if (low - value).max(value - high) <= MAX_DISTANCE * span {
            return ([low.min(value), high.max(value)], None);
        }
        let side = if value > high { "above" } else { "below" };
        let label = self.label(unit);
        ([low, high], Some(format!("The {label} lies far {side} the vertical axis.")))
    }
}
