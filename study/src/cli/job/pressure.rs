//! Whether one pressure for the whole capsule held during a run.

use billow_solver::models::film::{MAX_UNIFORM, PLEAT_COLUMNS};

use super::{Inspected, percent};
use crate::input::value::brief_number;
use crate::print::TopicLine;

/// The line of a job whose history follows the gas in pleats.
pub(super) fn line(job: &Inspected) -> Option<TopicLine> {
    job.stored.record(&job.id)?.file_hash.as_ref()?;
    let stored = job.history().ok()?;
    let [fractions, differences, ..] = PLEAT_COLUMNS.map(|(name, ..)| stored.tracks.get(name));
    let (fractions, differences, time) = (fractions?, differences?, stored.history.column("time"));
    let largest = |values: &[f64]| percent(values.iter().copied().fold(0.0, f64::max));
    let (limit, needed) = (percent(MAX_UNIFORM), largest(differences));
    let pinched = fractions.iter().rposition(|fraction| *fraction > 0.0);
    let text = match pinched.map(|last| time.get(last + 1)) {
        None => {
            format!("uniform within {limit} at every sample: no pleat needs more than {needed}")
        }
        Some(from) => {
            let volume = largest(fractions);
            let held = match from {
                Some(from) => format!("from {} s on; before", brief_number(*from)),
                None => "not until the end".to_owned(),
            };
            format!(
                "uniform within {limit} {held}, pleats with up to {volume} of their volume needed differences of up to \
                 {needed} for their gas to flow"
            )
        }
    };
    Some(("pressure", text))
}
