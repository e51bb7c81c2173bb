//! The time axis and the history columns of a cube.
//!
//! The time axis is the union of the sample times of all jobs. Samples are taken at multiples of
//! `outputs.sample_interval`, and at the end of a run.

use std::collections::{BTreeMap, HashMap};

use super::Done;
use crate::input::value::short_number;
use crate::job::JobId;
use crate::job::point::Point;
use crate::platform::error::{Error, InputError, Result};
use crate::platform::nearest::did_you_mean;
use crate::store::history_file::{self, ColumnOutline};
use crate::store::stored::Stored;

/// Times closer than this, in sample intervals, are one. The solver takes no sample closer to the end than
/// that, and a product of interval and number may differ from the end time in its last bit.
const SAME_TIME: f64 = 1e-6;

/// The key that must have one value.
const SAMPLE_INTERVAL: &str = "outputs.sample_interval";

/// Time axis and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Times, s, ascending.
    pub times: Vec<f64>,
    /// The chosen columns.
    pub columns: Vec<ColumnOutline>,
    /// Times closer than this are one, s.
    tolerance: f64,
}

impl Series {
    /// Those of some jobs; `wanted` names the columns, all of them if it is empty.
    ///
    /// # Errors
    /// [`Error::Input`] for different sample intervals or an unknown column; [`Error::Disk`] for a history that
    /// cannot be read.
    pub fn of(stored: &Stored<'_>, done: &[Done], wanted: &[String]) -> Result<Self> {
        let interval = sample_interval(stored, done)?;
        let tolerance = SAME_TIME * interval;
        let mut times: Vec<f64> = Vec::new();
        let mut last: Vec<f64> = Vec::new();
        let mut columns: Vec<ColumnOutline> = Vec::new();
        for Done { id, .. } in done {
            let outline = history_file::outline(&stored.results.job_path(id))?;
            if outline.times != last {
                times = union(&times, &outline.times, tolerance);
                last = outline.times;
            }
            for column in outline.columns {
                if !columns.iter().any(|known| known.name == column.name) {
                    columns.push(column);
                }
            }
        }
        let columns = chosen(columns, wanted)?;
        Ok(Self { times, columns, tolerance })
    }

    /// The values of a job on the time axis: NaN where it has no sample.
    pub fn placed(&self, times: &[f64], values: &[f64]) -> Vec<f64> {
        let mut placed = vec![f64::NAN; self.times.len()];
        let mut next = 0;
        for (time, value) in times.iter().zip(values) {
            while self.times.get(next).is_some_and(|known| *known < time - self.tolerance) {
                next += 1;
            }
            if let Some(place) = placed.get_mut(next) {
                *place = *value;
            }
        }
        placed
    }
}

/// The sample interval of all jobs, s.
fn sample_interval(stored: &Stored<'_>, done: &[Done]) -> Result<f64> {
    let scenes: HashMap<&JobId, &Point> =
        stored.points.iter().map(|point| (&point.job.id, point)).collect();
    let mut intervals: BTreeMap<u64, f64> = BTreeMap::new();
    for point in done.iter().filter_map(|Done { id, .. }| scenes.get(id)) {
        let interval = point.job.scene.outputs.sample_interval;
        intervals.insert(interval.to_bits(), interval);
    }
    let intervals: Vec<f64> = intervals.into_values().collect();
    match intervals.as_slice() {
        [] => Ok(0.0),
        [interval] => Ok(*interval),
        several => {
            let texts: Vec<String> =
                several.iter().map(|interval| format!("{} s", short_number(*interval))).collect();
            Err(InputError {
                file: stored.results.study_path().display().to_string(),
                key: SAMPLE_INTERVAL.to_owned(),
                value: String::new(),
                problem: format!(
                    "its jobs have several values: {}; a cube has one time axis",
                    texts.join(", ")
                ),
                allowed: "one value in all jobs".to_owned(),
                hint: format!(
                    "run the study with --set {SAMPLE_INTERVAL}=VALUE, then export again"
                ),
            }
            .into())
        }
    }
}

/// All times of two ascending lists; times closer than the tolerance are one.
fn union(a: &[f64], b: &[f64], tolerance: f64) -> Vec<f64> {
    let mut all: Vec<f64> = [a, b].concat();
    all.sort_by(f64::total_cmp);
    let mut times: Vec<f64> = Vec::with_capacity(all.len());
    for time in all {
        if times.last().is_none_or(|last| time - last > tolerance) {
            times.push(time);
        }
    }
    times
}

/// The columns that are asked for, in the order asked for.
fn chosen(columns: Vec<ColumnOutline>, wanted: &[String]) -> Result<Vec<ColumnOutline>> {
    if wanted.is_empty() {
        return Ok(columns);
    }
    let find = |name: &String| {
        let name = name.trim();
        columns.iter().find(|column| column.name == name).cloned().ok_or_else(|| {
            let names = || columns.iter().map(|column| column.name.as_str());
            Error::invalid_option(
                "--columns",
                name,
                "no history has this column",
                names().collect::<Vec<_>>().join(", "),
                did_you_mean(name, names()).unwrap_or_default(),
            )
        })
    };
    let mut found: Vec<ColumnOutline> = Vec::with_capacity(wanted.len());
    for name in wanted {
        let column = find(name)?;
        if !found.contains(&column) {
            found.push(column);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(times: Vec<f64>) -> Series {
        Series { times, columns: Vec::new(), tolerance: 1e-9 }
    }

    #[test]
    fn the_time_axis_has_every_sample_once() {
        // 3 * 0.1 is larger than 0.3 by one bit.
        let (long, short) = ([0.0, 0.1, 0.2, 3.0 * 0.1, 0.4], [0.0, 0.1, 0.2, 0.3]);
        let times = union(&long, &short, 1e-7);
        assert_eq!(times, [0.0, 0.1, 0.2, 0.3, 0.4]);
        assert_eq!(union(&times, &[0.0, 0.1, 0.25], 1e-7), [0.0, 0.1, 0.2, 0.25, 0.3, 0.4]);
    }

    #[test]
    fn values_stand_at_their_times_and_the_rest_is_nan() {
        let axis = series(vec![0.0, 0.1, 0.2, 0.25, 0.3, 0.4]);
        let placed = axis.placed(&[0.0, 0.1, 0.2, 3.0 * 0.1], &[1.0, 2.0, 3.0, 4.0]);
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&placed), bits(&[1.0, 2.0, 3.0, f64::NAN, 4.0, f64::NAN]));
    }

    #[test]
    fn an_unknown_column_is_refused_with_the_nearest_name() {
        let column = |name: &str| ColumnOutline {
            name: name.to_owned(),
            unit: "m".to_owned(),
            meaning: String::new(),
        };
        let known = vec![column("z_rim"), column("z_max")];
        let found = chosen(known.clone(), &["z_max".to_owned(), "z_max".to_owned()]).unwrap();
        assert_eq!(found, [column("z_max")]);
        let error = chosen(known, &["z_rin".to_owned()]).unwrap_err().to_string();
        assert!(error.contains("--columns") && error.contains("did you mean z_rim?"), "{error}");
    }
}
