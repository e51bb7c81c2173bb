//! Whether a job still moved at the end of its run.

use super::percent;
use crate::input::value::brief_number;
use crate::job::JobId;
use crate::store::history_file;
use crate::store::stored::Stored;

/// Relative change of the volume over the last tenth of a run above which the film still moves. Chosen:
/// well above the ringing of a deployed capsule.
const MIN_GROWTH: f64 = 0.02;
/// Mean kinetic energy of the last tenth of a run, over the largest one of the run, above which the film
/// still moves. Chosen as [`MIN_GROWTH`].
const MIN_MOTION: f64 = 0.05;

/// How a job moved in the last tenth of its run; `None` when it did not, or has no history.
pub(super) fn at_the_end(stored: &Stored<'_>, id: &JobId) -> Option<String> {
    stored.record(id)?.file_hash.as_ref()?;
    let read = stored.history_path(id).and_then(|path| history_file::read(&path));
    let history = match read {
        Ok(stored) => stored.history,
        Err(error) => return Some(format!("unknown: {error}").replace("\n  next: ", "; next: ")),
    };
    let column = |name: &str| history.column(name);
    let (time, volume, energy) = (column("time"), column("volume"), column("kinetic_energy"));
    let end = time.last()?;
    let start = time.partition_point(|sample| *sample < 0.9 * end);
    let growth = 1.0 - volume.get(start)? / volume.last()?;
    let largest = energy.iter().copied().fold(0.0, f64::max);
    let tenth = &energy[start..];
    let motion = tenth.iter().sum::<f64>() / (tenth.len() as f64 * largest);
    (growth.abs() > MIN_GROWTH || motion > MIN_MOTION).then(|| {
        format!(
            "in the last tenth the volume changed by {} %; mean kinetic energy {} of its largest value",
            brief_number(100.0 * growth),
            percent(motion)
        )
    })
}
