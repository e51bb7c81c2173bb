//! The limits that a study sets on its results: what "safe" means.
//!
//! ```text
//! value < bound:   margin = (bound − value)/|bound|        bound 0: margin = −value  (SI)
//! value > bound:   margin = (value − bound)/|bound|        bound 0: margin = value   (SI)
//! word, true or false, or a time that was never reached:  margin = 1 met, −1 not met
//! smallest margin = min over the limits
//! met for certain: margin > u,  missed for certain: −margin ≥ u      u: uncertainty of the value towards the limit
//! ```
//! A margin of 0.2 says that the value is a fifth of the bound away from it, on the safe side. Where u is not known, a
//! limit is never met for certain. A row is safe if every limit is met for certain, unsafe if one is missed for certain,
//! and within its uncertainty otherwise.

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
    /// Whether the value meets the limit, whatever its uncertainty.
    pub met: bool,
    /// The margin: positive where it is met.
    pub margin: f64,
    /// Uncertainty of the margin towards 0; `None` where it is not known.
    pub uncertainty: Option<f64>,
}

/// What is known of a limit, or of all limits together; the worst is the largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Safety {
    /// Met for certain.
    Safe,
    /// The uncertainty of the value reaches across the limit, or is not known.
    Uncertain,
    /// Missed for certain, or missed with an uncertainty that is not known.
    Unsafe,
}

impl Safety {
    /// All of them, the best first.
    pub const ALL: [Self; 3] = [Self::Safe, Self::Uncertain, Self::Unsafe];

    /// The word of a cell.
    pub fn name(self) -> &'static str {
        match self {
            Self::Safe => "safe",
            Self::Uncertain => "uncertain",
            Self::Unsafe => "unsafe",
        }
    }

    /// That of a cell; `None` for another word.
    pub fn of_cell(cell: &Value) -> Option<Self> {
        let is = |safety: &Self| matches!(cell, Value::Text(text) if text == safety.name());
        Self::ALL.into_iter().find(is)
    }
}

impl From<Safety> for Value {
    fn from(safety: Safety) -> Self {
        Self::Text(safety.name().to_owned())
    }
}

impl Judged {
    /// What is known of the limit.
    pub fn safety(&self) -> Safety {
        match (self.met, self.uncertainty) {
            // Words are met or not; a margin of 0 is that of a bound which is allowed.
            (true, Some(u)) if u == 0.0 || self.margin > u => Safety::Safe,
            (false, Some(u)) if -self.margin >= u => Safety::Unsafe,
            (false, None) => Safety::Unsafe,
            _ => Safety::Uncertain,
        }
    }

    /// The same, with an uncertainty that is not known taken as none: what a search goes by.
    pub fn as_far_as_known(&self) -> Safety {
        Self { uncertainty: Some(self.uncertainty.unwrap_or(0.0)), ..*self }.safety()
    }
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

    /// Whether the limit is met, and by which margin. `uncertainty` is that of the value below and above it, SI; of a word
    /// 0, or infinite where it may be another; `None` where it is not known. `None` unless the job is done and has the
    /// measure. A time without a value was never reached: it is not met below a bound.
    pub fn judge(
        &self,
        status: Status,
        value: &Value,
        uncertainty: Option<[f64; 2]>,
    ) -> Option<Judged> {
        if status != Status::Done {
            return None;
        }
        let without_number = |met| {
            let margin = if met { WITHOUT_NUMBER } else { -WITHOUT_NUMBER };
            let uncertainty = uncertainty.map(|[below, above]| below.max(above));
            Judged { met, margin, uncertainty }
        };
        match (&self.condition, number(value)) {
            (Condition::Is(_), _) if *value == Value::Null => None,
            (Condition::Is(word), _) => Some(without_number(word == value)),
            (Condition::Bound { above, .. }, None) => {
                self.is_first_passage().then(|| without_number(*above))
            }
            (Condition::Bound { bound, above, or_equal }, Some(number)) => {
                let distance = if *above { number - bound } else { bound - number };
                let over = |number: f64| if *bound == 0.0 { number } else { number / bound.abs() };
                let side = number.partial_cmp(bound)?;
                let met = match side {
                    Ordering::Less => !above,
                    Ordering::Equal => *or_equal,
                    Ordering::Greater => *above,
                };
                let towards = |[below, above]: [f64; 2]| match side {
                    Ordering::Less => above,
                    Ordering::Equal => below.max(above),
                    Ordering::Greater => below,
                };
                let uncertainty = uncertainty.map(|sides| over(towards(sides)));
                Some(Judged { met, margin: over(distance), uncertainty })
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
pub struct AllJudged {
    /// What is known of all of them.
    pub safety: Safety,
    /// The smallest margin.
    pub smallest_margin: f64,
    /// The position of the limit that has it.
    pub limit: usize,
}

impl AllJudged {
    /// The safety of a row; `value` gives the cell of a column, `uncertainty` that of its value. `None` without limits,
    /// for a job that is not done, and where a measure has no value unless another limit is missed.
    pub fn of<'v>(
        limits: &[ResultLimit],
        status: Status,
        value: impl Fn(ColumnId) -> &'v Value,
        uncertainty: impl Fn(ColumnId) -> Option<[f64; 2]>,
    ) -> Option<Self> {
        let mut all: Option<Self> = None;
        let mut unknown = false;
        for (limit, result_limit) in limits.iter().enumerate() {
            let measure = result_limit.measure;
            let judged = result_limit.judge(status, value(measure), uncertainty(measure));
            let Some(judged) = judged else {
                unknown = true;
                continue;
            };
            let (safety, margin) = (judged.safety(), judged.margin);
            all = Some(match all {
                None => Self { safety, smallest_margin: margin, limit },
                Some(known) => {
                    let smaller = margin < known.smallest_margin;
                    Self {
                        safety: safety.max(known.safety),
                        smallest_margin: known.smallest_margin.min(margin),
                        limit: if smaller { limit } else { known.limit },
                    }
                }
            });
        }
        all.filter(|known| !unknown || known.safety == Safety::Unsafe)
    }
}

/// The number of a cell.
fn number(value: &Value) -> Option<f64> {
    value.any_number().filter(|number| !number.is_nan())
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
            limit
                .judge(Status::Done, &value, Some([0.0; 2]))
                .map(|judged| (judged.met, judged.margin))
        };
        let speed = below(ColumnId::PeakVz, 25.0);
        assert_eq!(judge(&speed, Value::Number(20.0)), Some((true, 0.2)));
        assert_eq!(judge(&speed, Value::Number(50.0)), Some((false, -1.0)));
        assert_eq!(judge(&speed, Value::Number(25.0)), Some((false, 0.0)), "not below");
        assert_eq!(judge(&speed, Value::Null), None);
        assert_eq!(judge(&speed, Value::Number(f64::NAN)), None);
        assert_eq!(speed.judge(Status::Panicked, &Value::Number(1.0), None), None);
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
        let safety = |speed: Value, verdict: &str, u: Option<f64>| {
            let verdict = Value::Text(verdict.to_owned());
            let value = |column| if column == ColumnId::PeakVz { &speed } else { &verdict };
            AllJudged::of(&limits, Status::Done, value, |_| u.map(|u| [u; 2]))
        };
        let of = |speed: f64, u| safety(Value::Number(speed), "deployed", u).unwrap().safety;
        let safe = safety(Value::Number(20.0), "deployed", Some(0.0)).unwrap();
        let expected = AllJudged { safety: Safety::Safe, smallest_margin: 0.2, limit: 0 };
        assert_eq!(safe, expected);
        let stalled = safety(Value::Number(20.0), "stalled", Some(0.0)).unwrap();
        let expected = AllJudged { safety: Safety::Unsafe, smallest_margin: -1.0, limit: 1 };
        assert_eq!(stalled, expected);
        assert_eq!(safety(Value::Null, "deployed", Some(0.0)), None);
        let missed = safety(Value::Null, "stalled", Some(0.0)).unwrap();
        assert_eq!(missed.safety, Safety::Unsafe, "one limit is missed for certain");
        assert_eq!(AllJudged::of(&[], Status::Done, |_| &Value::Null, |_| None), None);
        // The speed may be half a metre a second less, or a whole one more.
        let speed = |number: f64| {
            let sides = Some([0.5, 1.0]);
            limits[0].judge(Status::Done, &Value::Number(number), sides).unwrap().safety()
        };
        let found = [23.9, 24.1, 25.4, 25.6].map(speed);
        let uncertain = Safety::Uncertain;
        assert_eq!(found, [Safety::Safe, uncertain, uncertain, Safety::Unsafe]);
        let above = Condition::Bound { bound: 25.0, above: true, or_equal: false };
        let above = ResultLimit { condition: above, ..below(ColumnId::FinalVolume, 25.0) };
        let height = |number: f64| {
            let sides = Some([0.5, 1.0]);
            above.judge(Status::Done, &Value::Number(number), sides).unwrap().safety()
        };
        let found = [23.9, 24.1, 25.4, 25.6].map(height);
        assert_eq!(found, [Safety::Unsafe, uncertain, uncertain, Safety::Safe]);
        assert_eq!([of(1.0, None), of(30.0, None)], [uncertain, Safety::Unsafe], "not known");
    }
}
