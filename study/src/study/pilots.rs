//! Pilots: the few points nearest to a limit, on two more meshes, where the table of mesh errors does not reach.
//!
//! ```text
//! distance of a point = the smallest |margin| of its runs, over the limits whose uncertainty is not known
//! pilots = the NEAREST points that meet that limit, and the NEAREST that do not
//! ```
//! Their three meshes give extrapolated values with an error; the other points take the largest error of the pilots
//! ([`crate::store::table::pilots`]). The pilots of the search of an optimum are its best point, whatever is known of its
//! error; where it does not keep the limits on the finest mesh, the next best is added. A study that gives
//! `solver.meshes` or varies the mesh has none.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::Arc;

use billow_solver::scene::{ModelKind, Scene};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use super::column::Column;
use super::finished::FinishedRow;
use super::grid::{Axis, AxisKind, Grid};
use super::meshes::{SUBDIVISIONS, features, known};
use crate::accuracy::{Features, MeshErrors, promised};
use crate::input::keys::{KEYS, short_name};
use crate::input::settings::Settings;
use crate::input::value::Value;
use crate::job::point::{Point, Searched};
use crate::job::result_limit::{Condition, Judged, ResultLimit};
use crate::job::row::ColumnId;
use crate::job::{Job, JobId, Parameters};

/// Pilots on each side of the limits, at most. Chosen: both ends of a border, and a second point to see how much the
/// error changes from point to point.
pub(super) const NEAREST: usize = 2;
/// Best points of a search that run on finer meshes at most. Chosen: where three do not keep the limits there, the mesh of
/// the search is too coarse for it.
pub const MAX_CONFIRMED: usize = 3;
/// Number of meshes of a pilot: three give an error without the table.
const MESHES: usize = 3;

/// The meshes of the pilots of a study, coarsest first: that of the study, and the two next finer ones of the table, or
/// coarser where it has none. `None` where the study needs no pilots, or says which meshes it runs on.
pub(super) fn meshes(
    settings: &Settings,
    grid: &Grid,
    limits: &[ResultLimit],
    points: &[Point],
) -> Option<[u32; MESHES]> {
    if grid.columns.iter().any(|column| column.index == SUBDIVISIONS) {
        return None;
    }
    // Where all are inside, a large study looks at each.
    let needed = match grid.optimise {
        Some(_) => points.iter().all(|point| point.job.scene.solver.model == ModelKind::Film),
        None => limits.iter().any(needs_error) && points.par_iter().any(is_outside),
    };
    if !needed {
        return None;
    }
    let Value::Integer(n) = settings.at(SUBDIVISIONS) else { return None };
    let known = known(settings);
    let position = known.iter().position(|mesh| i64::from(*mesh) == *n)?;
    let first = position.min(known.len().checked_sub(MESHES)?);
    known[first..first + MESHES].try_into().ok()
}

/// Whether a limit needs a mesh error, and pilots can give it.
fn needs_error(limit: &ResultLimit) -> bool {
    limit.measure == ColumnId::Verdict || promised::promise(limit.measure.name()).is_some()
}

/// Whether a point is of film, and outside the table of mesh errors.
fn is_outside(point: &Point) -> bool {
    let has_gap =
        |(scene, values): (&Scene, Features)| MeshErrors::shipped().gap(scene, &values).is_some();
    let scene = &point.job.scene;
    scene.solver.model == ModelKind::Film
        && (scene.design.folded().is_err() || features(point).is_some_and(has_gap))
}

/// Adds the mesh to the parameters of a study with pilots: it distinguishes the rows of several meshes.
pub(super) fn add_mesh(settings: &Settings, grid: &mut Grid, points: &mut [Point]) {
    let (name, mesh) = (short_name(SUBDIVISIONS).to_owned(), settings.at(SUBDIVISIONS).clone());
    for point in points {
        point.job.parameters = with_mesh(&point.job.parameters, &name, &mesh);
    }
    grid.columns.push(Column { name, key: &KEYS[SUBDIVISIONS], index: SUBDIVISIONS });
    let columns = vec![grid.columns.len() - 1];
    grid.axes.push(Axis { columns, rows: vec![vec![mesh]], kind: AxisKind::Meshes });
}

/// Parameters with this mesh.
fn with_mesh(parameters: &Parameters, name: &str, mesh: &Value) -> Parameters {
    let others = parameters.iter().filter(|(other, _)| other != name).cloned();
    others.chain([(name.to_owned(), mesh.clone())]).collect()
}

/// The order of distances from a limit.
fn by_distance(a: &Judged, b: &Judged) -> Ordering {
    a.margin.abs().total_cmp(&b.margin.abs())
}

/// The runs of the pilots on their other meshes, once every run of the `planned` points has ended.
pub(super) fn points(
    (settings, grid): (&Settings, &Grid),
    meshes: &[u32],
    limits: &[ResultLimit],
    planned: &[Point],
    finished: &[FinishedRow],
) -> Vec<Point> {
    let by_id: BTreeMap<&JobId, &FinishedRow> = finished.iter().map(|row| (&row.id, row)).collect();
    let key = |point: &Point| -> Vec<String> {
        let fixed = point.job.parameters.iter().enumerate();
        // A sample is a point: the errors of the few nearest to a limit stand for all.
        let fixed =
            fixed.filter(|(column, _)| !grid.is_replicate(*column) || grid.is_sampled(*column));
        fixed.map(|(_, (_, value))| value.to_string()).collect()
    };
    // A word has no distance: it counts where all limits are words.
    let nearest = |point: &Point| {
        let row = by_id.get(&point.job.id)?;
        let judged = limits.iter().zip(&row.limits).filter(|(limit, _)| needs_error(limit));
        let judged = judged.filter_map(|(limit, judged)| {
            let is_word = matches!(limit.condition, Condition::Is(_));
            Some((is_word, judged.filter(|judged| judged.uncertainty.is_none())?))
        });
        judged
            .min_by(|(a, one), (b, other)| a.cmp(b).then(by_distance(one, other)))
            .map(|(_, judged)| judged)
    };
    // Runs of one point stand together: its nearest run decides.
    let mut groups: Vec<(Vec<String>, Option<Judged>, Vec<&Point>)> = Vec::new();
    let mut positions: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    for point in planned.iter().filter(|point| is_outside(point)) {
        let key = key(point);
        let position = *positions.entry(key.clone()).or_insert(groups.len());
        if position == groups.len() {
            groups.push((key, None, Vec::new()));
        }
        let (_, judged, runs) = &mut groups[position];
        runs.push(point);
        *judged = judged.take().into_iter().chain(nearest(point)).min_by(by_distance);
    }
    let mut chosen = Vec::new();
    for met in [true, false] {
        let side = groups.iter().filter_map(|(_, judged, runs)| Some(((*judged)?, runs)));
        let mut side: Vec<_> = side.filter(|(judged, _)| judged.met == met).collect();
        side.sort_by(|(a, _), (b, _)| by_distance(a, b));
        chosen.extend(side.into_iter().take(NEAREST).flat_map(|(_, runs)| runs.iter().copied()));
    }
    on_other_meshes(settings, meshes, &chosen)
}

/// The runs of the best points of a search on their other meshes, the jobs of each a generation: of a front `all` of them,
/// otherwise one point after the other until one keeps the limits on the finest mesh.
pub(super) fn confirming(
    (settings, meshes): (&Settings, &[u32]),
    (best, all): (&[Vec<JobId>], bool),
    planned: &[Point],
    finished: &[FinishedRow],
) -> Vec<Vec<Point>> {
    let by_id: BTreeMap<&JobId, &FinishedRow> = finished.iter().map(|row| (&row.id, row)).collect();
    let finest = meshes.iter().max();
    let mut generations = Vec::new();
    for jobs in best.iter().take(MAX_CONFIRMED) {
        let of = planned.iter().filter(|point| jobs.contains(&point.job.id)).collect::<Vec<_>>();
        let runs = on_other_meshes(settings, meshes, &of);
        let keeps = |point: &Point| {
            let row = by_id.get(&point.job.id);
            let keeps = |judged: &Option<Judged>| judged.is_some_and(|judged| judged.met);
            row.is_some_and(|row| row.limits.iter().all(keeps))
        };
        let on_finest = |point: &&Point| Some(&point.job.scene.design.subdivisions()) == finest;
        let open = runs.iter().any(|run| !by_id.contains_key(&run.job.id));
        let kept = runs.iter().filter(on_finest).all(keeps);
        generations.push(runs);
        if !all && (open || kept) {
            break;
        }
    }
    generations
}

/// The runs of these points on their other meshes.
fn on_other_meshes(settings: &Settings, meshes: &[u32], points: &[&Point]) -> Vec<Point> {
    let name = short_name(SUBDIVISIONS);
    let on_mesh = |point: &&Point, n: u32| {
        let mesh = Value::Integer(i64::from(n));
        let parameters = |of: &Parameters| with_mesh(of, name, &mesh);
        let mut scene = (*point.job.scene).clone();
        scene.design = settings.on_mesh(&scene.design, n);
        Point {
            job: Job {
                id: JobId::of(&scene),
                parameters: parameters(&point.job.parameters),
                scene: Arc::new(scene),
            },
            merged: point.merged.iter().map(parameters).collect(),
            searched: Searched::No,
            ..(*point).clone()
        }
    };
    let runs = points.iter().flat_map(|point| {
        let others = meshes.iter().filter(|n| **n != point.job.scene.design.subdivisions());
        others.map(|n| on_mesh(point, *n))
    });
    runs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Status;
    use crate::study::Study;
    use crate::study::plan::next_jobs;

    /// A study of six mass flow rates, with friction: outside the table of mesh errors.
    fn study(more: &str) -> Study {
        let text = format!(
            r#"{{"design": {{"N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1.0, "subdivisions": 4}},
            "contact": {{"friction": 0.2}}, "replicates": {{"seed": 2}}, {more} "limits": {{"peak_speed": "< 20 m/s"}},
            "grid": {{"mass_flow_rate": [1, 2, 3, 4, 5, 6]}}}}"#
        );
        let text = text.replace("\"solver\": {", "\"solver\": {\"end_time\": 0.3, ");
        Study::from_text(&text, "pilots.json", "pilots", &[], 100).unwrap()
    }

    /// Every planned run ended, with a margin of its flow rate.
    fn finished(points: &[Point], margin: fn(f64) -> f64) -> Vec<FinishedRow> {
        let row = |point: &Point| {
            let Value::Number(rate) = point.job.parameters[0].1 else { panic!() };
            let margin = margin(rate);
            let judged = Judged { met: margin > 0.0, margin, uncertainty: None };
            let (id, limits) = (point.job.id.clone(), vec![Some(judged)]);
            FinishedRow { id, status: Status::Done, verdict: None, limits, minimised: vec![] }
        };
        points.iter().map(row).collect()
    }

    #[test]
    fn the_points_nearest_to_a_limit_on_both_sides_run_on_two_more_meshes() {
        let study = study(r#""solver": {},"#.replace("{}", "{\"cfl\": 0.45}").as_str());
        assert_eq!(study.meshes().list, [4, 6, 8]);
        let first = next_jobs(&study, &[]).unwrap();
        assert_eq!((first.points.len(), study.point_count()), (12, 6));
        let rows = finished(&first.points, |rate| 0.38 - 0.1 * rate);
        let pilots = next_jobs(&study, &rows).unwrap();
        let of = |point: &Point| {
            let parameters = point.job.parameters.iter().map(|(_, value)| value.to_string());
            parameters.collect::<Vec<_>>().join(" ")
        };
        let runs: Vec<String> = pilots.points.iter().map(of).collect();
        assert_eq!(runs.len(), 16);
        for run in ["3 1 6", "3 1 8", "3 2 8", "2 1 8", "4 1 6", "5 2 8"] {
            assert!(runs.iter().any(|known| known == run), "{run}: {runs:?}");
        }
        // A study of that mesh plans the same job.
        let fine = "\"solver\": {\"meshes\": [8]},";
        let fine = super::tests::study(fine);
        assert!(fine.meshes().list.is_empty());
        let same = next_jobs(&fine, &[]).unwrap();
        let id = |points: &[Point], run: &str| {
            points.iter().find(|point| of(point) == run).unwrap().job.id.clone()
        };
        assert_eq!(id(&same.points, "3 1 8"), id(&pilots.points, "3 1 8"));
        // When the pilots have ended, nothing is left.
        let all: Vec<Point> = first.points.iter().chain(pilots.points.iter()).cloned().collect();
        assert_eq!(next_jobs(&study, &finished(&all, |rate| 0.38 - 0.1 * rate)), None);
    }
}
