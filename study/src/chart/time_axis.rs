//! The time axis of histories. It ends where the film has settled, so that a long rest does not fill the
//! figure.
//!
//! ```text
//! settled    from this time on |z − z_end| ≤ 0.02 (max z − min z)
//! axis       to the last settled time plus a fifth of it, if the runs go on much longer
//! ```
//!
//! Symbols: z height of the top ring (of the highest node without rings), m; `z_end` its mean over the last
//! tenth of the run. The same for every quantity, so figures of one study have equal time axes.

use super::invalid_option;
use crate::input::value::short_number;
use crate::platform::error::Result;
use crate::render::figure::ticks;
use crate::render::figure::unit::Unit;
use crate::store::history_file::StoredHistory;

/// Largest difference from the final height of a settled film, as a fraction of the range of heights. Chosen:
/// two widths of a line in a figure.
const SETTLED: f64 = 0.02;
/// Time after the last settled time that is shown, as a fraction of it. Chosen: the rest is visible as such.
const MARGIN: f64 = 0.2;
/// The whole run is shown if the axis would be at least this fraction of it.
const WHOLE: f64 = 0.85;

/// Columns of a history that the time axis reads.
pub const TIME_AXIS_COLUMNS: [&str; 3] = ["time", "z_rim", "z_max"];

/// The time axis: its ends, s, and the unit in which it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeAxis {
    /// Its ends, s.
    pub ends: [f64; 2],
    /// The unit in which it is shown.
    pub unit: Unit,
    /// A note if the runs go on after its end.
    pub note: Option<String>,
}

impl TimeAxis {
    /// The axis of these histories; `range` gives the ends that a user asks for, s.
    ///
    /// # Errors
    /// An empty range.
    pub fn new(histories: &[&StoredHistory], range: [Option<f64>; 2]) -> Result<Self> {
        let times = histories.iter().flat_map(|stored| stored.history.column("time"));
        let whole = times.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], time| {
            [low.min(*time), high.max(*time)]
        });
        let whole = if histories.is_empty() { [0.0, 1.0] } else { whole };
        let mut ends = whole;
        for (end, given) in ends.iter_mut().zip(range) {
            *end = given.unwrap_or(*end);
        }
        if ends[0].total_cmp(&ends[1]).is_ge() {
            if range != [None, None] {
                return Err(invalid_option(
                    "--from, --to",
                    &format!("{} s to {} s", ends[0], ends[1]),
                    "the time range is empty",
                    "--from TIME before --to TIME, both within the run",
                    "",
                ));
            }
            ends[1] = ends[0] + 1.0;
        }
        let mut note = None;
        if range[1].is_none()
            && let Some(settled) = last_settled(histories)
            && let Some(end) = shown_end(settled, whole)
            && end > ends[0]
        {
            let unit = Unit::fit("s", [whole[1]]);
            let text = |time: f64| {
                let time = unit.shown(time);
                let rounded = format!("{time:.2e}").parse().unwrap_or(time);
                unit.after(&short_number(rounded))
            };
            note = Some(format!(
                "The time axis ends after the last film has settled: from {} on the height changes by \
                 less than 2 % of its range. The runs end at {} (--to \"{}\").",
                text(settled),
                text(whole[1]),
                text(whole[1])
            ));
            ends[1] = end;
        }
        Ok(Self { ends, unit: Unit::fit("s", ends), note })
    }

    /// Its ends in its unit.
    pub fn shown(&self) -> [f64; 2] {
        self.ends.map(|end| self.unit.shown(end))
    }
}

/// The end of the axis, s, a round number; `None` if the whole run is shown.
fn shown_end(settled: f64, [start, end]: [f64; 2]) -> Option<f64> {
    let wanted = settled + MARGIN * (settled - start);
    // The first tick from there on.
    let tick = ticks::linear(start, end, 20).into_iter().map(|(time, _)| time);
    let shown = tick.into_iter().find(|time| *time >= wanted)?;
    (shown - start < WHOLE * (end - start)).then_some(shown)
}

/// The time from which every film is settled, s; `None` if one of them is not.
fn last_settled(histories: &[&StoredHistory]) -> Option<f64> {
    let times: Option<Vec<f64>> = histories.iter().map(|stored| settled(stored)).collect();
    times?.into_iter().reduce(f64::max)
}

/// The time from which a film is settled, s. A run that stopped early counts with its last time.
fn settled(stored: &StoredHistory) -> Option<f64> {
    let history = &stored.history;
    let time = history.column("time");
    let rings = history.column("z_rim");
    let height = if rings.is_empty() { history.column("z_max") } else { rings };
    let (last, count) = (*time.last()?, height.len());
    if stored.status.is_failure() {
        return Some(last);
    }
    let tail = &height[count - (count / 10).max(1)..];
    let end = tail.iter().sum::<f64>() / tail.len() as f64;
    let [low, high] = height
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(*z), high.max(*z)]);
    let near = |z: &f64| (z - end).abs() <= SETTLED * (high - low);
    let moving = height.iter().rposition(|z| !near(z));
    match moving {
        None => Some(time[0]),
        // A film that moves in the last tenth is not settled.
        Some(index) if index + tail.len() >= count => None,
        Some(index) => Some(time[index + 1]),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use billow_solver::output::history::{COLUMNS, History};

    use super::*;
    use crate::job::{JobId, Status};

    /// A film that rises to 1 m and oscillates with this decay time (s) in a run of 1 s.
    fn stored(decay: f64) -> StoredHistory {
        let mut history = History::new();
        for sample in 0..1000 {
            let time = 1e-3 * f64::from(sample);
            let height = 1.0 - libm::exp(-time / decay) * libm::cos(100.0 * time);
            let row = COLUMNS.iter().map(|column| match column.name {
                "time" => time,
                "z_rim" => height,
                _ => 0.0,
            });
            history.push(&row.collect::<Vec<_>>().try_into().unwrap());
        }
        StoredHistory {
            events: Vec::new(),
            job: JobId::from_digits(&"0".repeat(32)).unwrap(),
            scene: String::new(),
            status: Status::Done,
            content_hash: String::new(),
            history,
            tracks: BTreeMap::new(),
            labels: BTreeMap::new(),
        }
    }

    #[test]
    fn the_axis_ends_after_the_last_film_has_settled() {
        let [fast, slow, never] = [0.03, 0.06, 2.0].map(stored);
        let end = |histories: &[&StoredHistory], to: Option<f64>| {
            let axis = TimeAxis::new(histories, [None, to]).unwrap();
            (axis.ends[1], axis.note.is_some())
        };
        let (short, noted) = end(&[&fast], None);
        assert!(noted && (0.1..0.25).contains(&short), "{short}");
        let (longer, _) = end(&[&fast, &slow], None);
        assert!(longer > short && longer < 0.4, "{longer}");
        assert_eq!(end(&[&fast, &never], None), (0.999, false));
        assert_eq!(end(&[&fast], Some(0.7)), (0.7, false));
        let mut failed = stored(2.0);
        failed.status = Status::Failed(billow_solver::output::outcome::FailureKind::StepLimit);
        assert_eq!(end(&[&fast, &failed], None), (0.999, false));
    }
}
