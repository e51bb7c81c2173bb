//! The limits that a study sets on its results: what "safe" means.
//!
//! ```text
//! value < bound:   margin = (bound − value)/|bound|        bound 0: margin = −value  (SI)
//! value > bound:   margin = (value − bound)/|bound|        bound 0: margin = value   (SI)
//! word, true or false, or a time that was never reached:  margin = 1 met, −1 not met
//! smallest margin = min over the limits;  safe: every limit is met
//! ```
//! A margin of 0.2 says that the value is a fifth of the bound away from it, on the safe side.

use std::cmp::Ordering;
use std::fmt;

use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::ColumnId;

/// Margin of a limit without a number that is met; not met, its negative.
const WITHOUT_NUMBER: f64 = 1.0;

/// One limit: a measure and what it must be.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultLimit {
    /// The measure.
    pub measure: ColumnId,
    /// What it must be.
    pub condition: Condition,
    /// The condition as the study file writes it, as in `< 25 m/s`.
    pub text: String,
}

/// What a measure must be.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// Below a bound (SI), or above it.
    Bound {
        /// The bound, SI.
        bound: f64,
        /// Whether the measure must be above it.
        above: bool,
        /// Whether the bound itself is allowed.
        or_equal: bool,
    },
    /// This word, or this truth value.
    Is(Value),
}

/// What a limit says of one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Whether the limit is met.
    pub met: bool,
    /// The margin: positive where it is met.
    pub margin: f64,
}

impl ResultLimit {
    /// Name of its column of margins in the table.
    pub fn column_name(&self) -> String {
        format!("margin_{}", self.measure.name())
    }

    /// Meaning of that column.
    pub fn margin_meaning(&self) -> String {
        format!(
            "distance of {} from its limit ({}) over the limit; negative beyond it",
            self.measure.name(),
            self.text
        )
    }

    /// Whether the limit is met, and by which margin. `value` gives the cell of a column. `None` unless
    /// the job is done and has the measure. A time without a value was never reached: it is not met
    /// below a bound.
    pub fn judge(&self, status: Status, value: &Value) -> Option<Judged> {
        if status != Status::Done {
            return None;
        }
        let without_number =
            |met| Judged { met, margin: if met { WITHOUT_NUMBER } else { -WITHOUT_NUMBER } };
        match (&self.condition, number(value)) {
            (Condition::Is(_), _) if *value == Value::Null => None,
            (Condition::Is(word), _) => Some(without_number(word == value)),
            (Condition::Bound { above, .. }, None) => {
                self.is_first_passage().then(|| without_number(*above))
            }
            (Condition::Bound { bound, above, or_equal }, Some(number)) => {
                let distance = if *above { number - bound } else { bound - number };
                let margin = if *bound == 0.0 { distance } else { distance / bound.abs() };
                let met = match number.partial_cmp(bound)? {
                    Ordering::Less => !above,
                    Ordering::Equal => *or_equal,
                    Ordering::Greater => *above,
                };
                Some(Judged { met, margin })
            }
        }
    }

    /// Whether the measure is the time at which a level is first reached: null if it never was.
    fn is_first_passage(&self) -> bool {
        let name = self.measure.name();
        ["t_50_", "t_90_", "t_deployed", "t_settled"].iter().any(|start| name.starts_with(start))
    }
}

/// Measure and condition, as in `peak_vz < 25 m/s`. The verdict is its word: `deployed`.
impl fmt::Display for ResultLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.condition {
            Condition::Is(Value::Text(word)) if self.measure == ColumnId::Verdict => {
                f.write_str(word)
            }
            _ => write!(f, "{} {}", self.measure.name(), self.text),
        }
    }
}

/// All limits of a study together, for one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Safety {
    /// Whether every limit is met.
    pub safe: bool,
    /// The smallest margin.
    pub smallest_margin: f64,
    /// The position of the limit that has it.
    pub limit: usize,
}

impl Safety {
    /// The safety of a row; `value` gives the cell of a column. `None` without limits, for a job that is not
    /// done, and where a measure has no value unless another limit is missed: nothing is known then.
    pub fn of<'v>(
        limits: &[ResultLimit],
        status: Status,
        value: impl Fn(ColumnId) -> &'v Value,
    ) -> Option<Self> {
        let mut safety: Option<Self> = None;
        let mut unknown = false;
        for (limit, result_limit) in limits.iter().enumerate() {
            let judged = result_limit.judge(status, value(result_limit.measure));
            let Some(Judged { met, margin }) = judged else {
                unknown = true;
                continue;
            };
            safety = Some(match safety {
                None => Self { safe: met, smallest_margin: margin, limit },
                Some(known) => {
                    let smaller = margin < known.smallest_margin;
                    Self {
                        safe: known.safe && met,
                        smallest_margin: known.smallest_margin.min(margin),
                        limit: if smaller { limit } else { known.limit },
                    }
                }
            });
        }
        safety.filter(|known| !unknown || !known.safe)
    }
}

/// The number of a cell.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) if !number.is_nan() => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn below(measure: ColumnId, bound: f64) -> ResultLimit {
        let condition = Condition::Bound { bound, above: false, or_equal: false };
        ResultLimit { measure, condition, text: String::new() }
    }

    #[test]
    fn margins_are_relative_distances_on_the_safe_side() {
        let judge = |limit: &ResultLimit, value| {
            limit.judge(Status::Done, &value).map(|judged| (judged.met, judged.margin))
        };
        let speed = below(ColumnId::PeakVz, 25.0);
        assert_eq!(judge(&speed, Value::Number(20.0)), Some((true, 0.2)));
        assert_eq!(judge(&speed, Value::Number(50.0)), Some((false, -1.0)));
        assert_eq!(judge(&speed, Value::Number(25.0)), Some((false, 0.0)), "not below");
        assert_eq!(judge(&speed, Value::Null), None);
        assert_eq!(judge(&speed, Value::Number(f64::NAN)), None);
        assert_eq!(speed.judge(Status::Panicked, &Value::Number(1.0)), None);
        // A time that is never reached is later than any bound.
        assert_eq!(judge(&below(ColumnId::TDeployed, 1.0), Value::Null), Some((false, -1.0)));
        // A height below zero.
        let rising = Condition::Bound { bound: -0.5, above: true, or_equal: true };
        let rising = ResultLimit { condition: rising, ..below(ColumnId::Overshoot, 0.0) };
        assert_eq!(judge(&rising, Value::Number(-0.5)), Some((true, 0.0)));
        assert_eq!(judge(&rising, Value::Number(-1.0)), Some((false, -1.0)));
        assert_eq!(judge(&below(ColumnId::Overshoot, 0.0), Value::Number(-0.1)), Some((true, 0.1)));
    }

    #[test]
    fn the_text_of_a_limit_names_its_measure_but_not_the_verdict() {
        let limit = |measure, condition, text: &str| {
            ResultLimit { measure, condition, text: text.to_owned() }.to_string()
        };
        let speed = below(ColumnId::PeakVz, 25.0).condition;
        assert_eq!(limit(ColumnId::PeakVz, speed, "< 25 m/s"), "peak_vz < 25 m/s");
        let word = Condition::Is(Value::Text("deployed".to_owned()));
        assert_eq!(limit(ColumnId::Verdict, word, "deployed"), "deployed");
    }

    #[test]
    fn a_row_is_safe_if_every_limit_is_met_and_unknown_without_a_measure() {
        let word = Condition::Is(Value::Text("deployed".to_owned()));
        let verdict = ResultLimit { condition: word, ..below(ColumnId::Verdict, 0.0) };
        let limits = [below(ColumnId::PeakVz, 25.0), verdict];
        let safety = |speed: Value, verdict: &str| {
            let verdict = Value::Text(verdict.to_owned());
            Safety::of(&limits, Status::Done, |column| {
                if column == ColumnId::PeakVz { &speed } else { &verdict }
            })
        };
        let safe = safety(Value::Number(20.0), "deployed").unwrap();
        assert_eq!(safe, Safety { safe: true, smallest_margin: 0.2, limit: 0 });
        let stalled = safety(Value::Number(20.0), "stalled").unwrap();
        assert_eq!(stalled, Safety { safe: false, smallest_margin: -1.0, limit: 1 });
        assert_eq!(safety(Value::Null, "deployed"), None);
        assert!(!safety(Value::Null, "stalled").unwrap().safe, "one limit is missed for certain");
        assert_eq!(Safety::of(&[], Status::Done, |_| &Value::Null), None);
    }
}
