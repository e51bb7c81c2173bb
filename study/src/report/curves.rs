//! The histories of a report: few samples of each job, its extremes among them.

use std::collections::BTreeSet;

use billow_solver::output::history::COLUMNS;
use serde_json::{Value as Json, json};

use super::Budget;
use super::packed::{self, FINE};
use crate::job::JobId;
use crate::store::history_file::StoredHistory;
use crate::store::stored::Stored;

/// Columns of the histories that a report has, as far as a job has them.
const SHOWN: [&str; 10] = [
    "z_rim",
    "height",
    "vz",
    "volume",
    "pressure",
    "temperature",
    "gas_mass",
    "kinetic_energy",
    "lid_force",
    "support_impulse",
];
/// Samples of a job beside its extremes. Chosen: a line on a wide screen has no more.
const SAMPLES: usize = 600;
/// Columns whose motion says where samples are close together.
const MOVING: [&str; 3] = ["z_rim", "height", "vz"];
/// Most jobs with curves. Chosen: a reader chooses from no more.
const MAX_JOBS: usize = 1000;
/// Share of the size of a report that curves may take.
const PART: f64 = 0.3;

/// Columns, and the curves of the jobs at these rows of the table; and how many of them have none for lack of room.
pub fn curves(stored: &Stored<'_>, jobs: &[(usize, JobId)], budget: &mut Budget) -> Json {
    let mut all = Vec::new();
    let mut used = BTreeSet::new();
    let allowed = PART * budget.free();
    let mut taken = 0.0;
    let read = |(row, id): &(usize, JobId), used: &mut _| {
        // A damaged history is named by `billow doctor`; its job is one without curves.
        let history = stored.results.read_history(id, stored.record(id)).ok()?;
        Some(curve(*row, &history, used))
    };
    // The first job says how many there is room for.
    let first = jobs.iter().find_map(|job| read(job, &mut BTreeSet::new()));
    let size = first.map_or(1.0, |curve| curve.to_string().len() as f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
    let most = (allowed / size) as usize;
    for job in super::spread(jobs, most.clamp(1, MAX_JOBS)) {
        let Some(curve) = read(&job, &mut used) else { continue };
        taken += curve.to_string().len() as f64;
        all.push(curve);
    }
    budget.use_up(taken);
    let columns = COLUMNS.iter().filter(|column| used.contains(column.name)).map(|column| {
        let unit = stored.units.of(column.name, column.unit);
        let [zero, one] = [0.0, 1.0].map(|si| unit.number(si));
        json!({
            "name": column.name, "unit": unit.symbol(), "meaning": column.meaning,
            "scale": one - zero, "offset": zero,
        })
    });
    let columns: Vec<Json> = columns.collect();
    let without = jobs.len() - all.len();
    json!({"columns": columns, "jobs": all, "without": without})
}

fn curve(row: usize, history: &StoredHistory, used: &mut BTreeSet<&'static str>) -> Json {
    let time = history.history.column("time");
    let has = |name: &&&str| history.history.has(name);
    let columns: Vec<(&'static str, &[f64])> = SHOWN
        .iter()
        .filter(has)
        .map(|name| (*name, history.history.column(name)))
        .filter(|(_, values)| values.iter().any(|value| value.abs() > 0.0))
        .collect();
    let kept = kept(time.len(), &columns);
    let chosen = |values: &[f64]| -> Vec<f64> { kept.iter().map(|index| values[*index]).collect() };
    let mut json =
        json!({"row": row, "samples": kept.len(), "time": packed::steps(&chosen(time), 1, FINE)});
    for (name, values) in columns {
        used.insert(name);
        json[name] = packed::steps(&chosen(values), 1, FINE);
    }
    json
}

/// The samples that are kept, in order: equally far apart, half in time and half in how far the film has moved, and those
/// with the least and largest value of each column.
fn kept(samples: usize, columns: &[(&str, &[f64])]) -> Vec<usize> {
    let last = samples.saturating_sub(1);
    let mut travelled = vec![0.0; samples];
    for (_, values) in columns.iter().filter(|(name, _)| MOVING.contains(name)) {
        let length: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        let mut sum = 0.0;
        for (index, pair) in values.windows(2).enumerate() {
            sum += (pair[1] - pair[0]).abs() / length.max(f64::MIN_POSITIVE);
            travelled[index + 1] += sum;
        }
    }
    let whole = travelled.last().copied().unwrap_or(0.0);
    let mut kept: BTreeSet<usize> = BTreeSet::new();
    let parts = (SAMPLES / 2).min(samples).max(1);
    for part in 0..=parts {
        kept.insert(part * last / parts);
        let wanted = whole * part as f64 / parts as f64;
        kept.insert(travelled.partition_point(|travelled| *travelled < wanted));
    }
    for (_, values) in columns {
        let largest = |sign: f64| {
            (0..samples).max_by(|a, b| (sign * values[*a]).total_cmp(&(sign * values[*b])))
        };
        kept.extend([1.0, -1.0].into_iter().filter_map(largest));
    }
    kept.retain(|index| *index < samples);
    kept.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kept_samples_have_both_ends_and_every_extreme() {
        let mut values = vec![0.0; 5000];
        (values[1234], values[4321]) = (5.0, -3.0);
        let found = kept(5000, &[("vz", &values)]);
        assert!([0, 1234, 4321, 4999].iter().all(|index| found.contains(index)));
        assert!(found.len() <= SAMPLES + 5 && found.is_sorted());
        // Motion in a fiftieth of the time has half of the samples.
        let moving: Vec<f64> = (0..5000).map(|k| f64::from(u32::min(k, 100))).collect();
        let early = kept(5000, &[("z_rim", &moving)]).iter().filter(|k| **k <= 100).count();
        assert!(early >= 100, "{early}");
        assert_eq!(kept(3, &[]), [0, 1, 2]);
        assert_eq!((kept(1, &[]), kept(0, &[])), (vec![0], vec![]));
    }
}
