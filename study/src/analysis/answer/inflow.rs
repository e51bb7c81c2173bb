//! Measures that a parameter cannot change, because their peaks come before the inflow that it changes.
//!
//! ```text
//! t_peak < t_change in every run      t_change: first time at which the inflow of two runs of a set differs
//! ```
//! A set holds the runs that are equal in all other parameters. All else in their scenes must be equal too: only then
//! do they move alike until `t_change`.

use std::collections::{BTreeMap, HashMap};

use billow_solver::scene::Scene;
use billow_solver::scene::inflow::Schedule;

use crate::analysis::compare;
use crate::analysis::replicates::point_key;
use crate::job::row::ColumnId;
use crate::store::table::{Column, Table};

/// Measures that are peaks, and the times of these.
const PEAKS: [[ColumnId; 2]; 2] =
    [[ColumnId::PeakVz, ColumnId::TPeakVz], [ColumnId::FilmStress99, ColumnId::TFilmStress99]];

/// The measures that a parameter cannot change. `scenes` are those of the jobs.
pub(super) fn peaks_before(
    table: &Table,
    by: &str,
    scenes: &HashMap<&str, &Scene>,
) -> Vec<ColumnId> {
    let others: Vec<&Column> = table.parameters().filter(|column| column.name != by).collect();
    let mut sets: BTreeMap<Vec<String>, Vec<usize>> = BTreeMap::new();
    for row in 0..table.rows() {
        sets.entry(point_key(&others, row)).or_default().push(row);
    }
    let change = |rows: &Vec<usize>| {
        let job = |row: &usize| scenes.get(table.column("job")?.cells[*row].to_string().as_str());
        let (first, others) = rows.split_first()?;
        let first = job(first)?;
        let times = others.iter().map(|row| first_difference(first, job(row)?));
        times.reduce(|a, b| Some(a?.min(b?)))?
    };
    let sets: Vec<_> = sets.values().filter(|rows| rows.len() > 1).collect();
    let changes: Vec<Option<f64>> = sets.iter().map(|rows| change(rows)).collect();
    let is_before = |[_, time]: &&[ColumnId; 2]| {
        let Some(column) = table.column(time.name()) else { return false };
        let before = |(rows, change): (&&Vec<usize>, &Option<f64>)| {
            let peak = |row: &usize| compare::measured(table, column, *row).zip(*change);
            rows.iter().all(|row| peak(row).is_some_and(|(peak, change)| peak < change))
        };
        changes.iter().flatten().any(|time| time.is_finite())
            && sets.iter().zip(&changes).all(before)
    };
    PEAKS.iter().filter(is_before).map(|[measure, _]| *measure).collect()
}

/// The first time at which the inflow of two scenes differs, s; infinite for equal ones, `None` where more differs.
fn first_difference(a: &Scene, b: &Scene) -> Option<f64> {
    let rest = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.gas.windows.clear();
        scene
    };
    if rest(a) != rest(b) {
        return None;
    }
    let [a, b] = [a, b].map(|scene| Schedule::new(&scene.gas.windows));
    let mut times = [a.change_times(), b.change_times()].concat();
    times.sort_by(f64::total_cmp);
    let differs = |pair: &&[f64]| a.between(pair[0], pair[1]) != b.between(pair[0], pair[1]);
    Some(times.windows(2).find(differs).map_or(f64::INFINITY, |pair| pair[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::fixture;
    use crate::study::{MAX_POINTS, Study};

    /// The measures that a mass flow rate cannot change that flows from 0.1 s on; peaks at these times.
    fn unchanged(times: [&str; 4], sets: &[&str]) -> Vec<ColumnId> {
        let text = r#"{
            "design": {"N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1},
            "gas": {"residual_gas": "stored", "residual_gas_mass": 1e-4},
            "strategies": {"late": {"inflow": [{"from": 0.1}]}}, "strategy": "late",
            "solver": {"end_time": 0.5},
            "grid": {"mass_flow_rate": [0.001, 0.005], "seed": [1, 2]}
        }"#;
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let study = Study::from_text(text, "test.json", "test", &sets, MAX_POINTS).unwrap();
        let points = study.points();
        let scenes = points.iter().map(|point| (point.job.id.as_str(), &*point.job.scene));
        let row = |(point, time): (&crate::job::point::Point, &str)| {
            let values: Vec<String> =
                point.job.parameters.iter().map(|(_, value)| value.to_string()).collect();
            format!("{} {} done {time} 0.2", point.job.id.as_str(), values.join(" "))
        };
        let table = fixture::table_of(
            "job mass_flow_rate seed status t_peak_vz t_film_stress_99",
            points.iter().zip(times).map(row),
        );
        peaks_before(&table, "mass_flow_rate", &scenes.collect())
    }

    #[test]
    fn a_peak_before_the_inflow_does_not_depend_on_it() {
        let early = ["0.02", "0.03", "0.02", "0.03"];
        assert_eq!(unchanged(early, &[]), [ColumnId::PeakVz]);
        // One later peak, or one unknown, and nothing is certain.
        assert_eq!(unchanged(["0.02", "0.03", "0.02", "0.1"], &[]), []);
        assert_eq!(unchanged(["0.02", "0.03", "0.02", "-"], &[]), []);
        // Equal inflow is one job, and gas at the release comes before any peak.
        assert_eq!(unchanged(early, &["strategies.late.inflow=[]"]), []);
        assert_eq!(unchanged(early, &["strategies.late.inflow=[{\"from\": 0}]"]), []);
    }
}
