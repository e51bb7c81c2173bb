//! To what a measure tends on finer meshes, from scenes with several runs on several meshes.
//!
//! ```text
//! change = mean of m_∞/m_ref − 1 over the scenes;  U² = mean of their squared uncertainties + (largest distance from it)²
//! noise of a median of k runs = half their range/√k
//! ```
//! m_∞: [`super::fit`].

use std::collections::BTreeMap;

use billow_solver::scene::ModelKind;

use super::fit::{Level, fit};
use super::runs::SceneRuns;
use billow_study::accuracy::Limit;
use billow_study::analysis::statistics::Spread;
use billow_study::job::row::ColumnId;

/// Runs on a mesh from which a limit may follow, at least; and number of such meshes.
const LIMIT_RUNS: usize = 4;
const LIMIT_MESHES: usize = 4;
/// Coarser meshes have no part in a limit where enough others are there. Chosen: on n 2 and 3 a panel is not yet round.
const COARSEST_OF_LIMIT: u32 = 4;

/// To what a measure tends, from the scenes with several runs on several meshes: the mean of their limits, with an
/// uncertainty that holds them all.
pub(super) fn limit(scenes: &[&SceneRuns], measure: ColumnId, reference: u32) -> Limit {
    let of_scene = |scene: &&SceneRuns| {
        let levels = levels(scene, measure);
        if levels.iter().filter(|level| level.runs >= LIMIT_RUNS).count() < LIMIT_MESHES {
            return None;
        }
        let finest = levels.iter().find(|level| level.subdivisions == reference)?.value;
        let fit = fit(&levels).filter(|_| finest != 0.0)?;
        Some(Limit {
            known: fit.has_limit(&levels),
            change: fit.limit / finest - 1.0,
            uncertainty: (fit.uncertainty / finest).abs(),
            order: fit.order,
        })
    };
    let limits: Vec<Limit> = scenes.iter().filter_map(of_scene).collect();
    let count = limits.len().max(1) as f64;
    let mean = |of: fn(&Limit) -> f64| limits.iter().map(of).sum::<f64>() / count;
    let change = mean(|limit| limit.change);
    let away = limits.iter().map(|limit| (limit.change - change).abs()).fold(0.0, f64::max);
    let squares = mean(|limit| limit.uncertainty * limit.uncertainty);
    Limit {
        known: !limits.is_empty() && limits.iter().all(|limit| limit.known),
        change,
        uncertainty: (squares + away * away).sqrt(),
        order: limits.iter().map(|limit| limit.order).reduce(f64::min).unwrap_or(0.0),
    }
}

/// The medians of a measure by mesh, coarsest first: those of which a limit can follow.
pub(super) fn levels(scene: &SceneRuns, measure: ColumnId) -> Vec<Level> {
    let mut values: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for run in &scene.runs {
        if let ((ModelKind::Film, n), Some(value)) = (run.mesh(), run.measure(measure)) {
            values.entry(n).or_default().push(value);
        }
    }
    // Where a mesh has one run, the spread is that of the meshes with several.
    let spreads: Vec<(u32, Spread)> =
        values.into_iter().filter_map(|(n, values)| Some((n, Spread::of(values)?))).collect();
    let half_range = |spread: &Spread| 0.5 * (spread.largest - spread.least);
    let several = spreads.iter().map(|(_, spread)| spread).filter(|spread| spread.count > 1);
    let typical = Spread::of(several.map(half_range)).map_or(0.0, |spread| spread.median);
    let mut levels: Vec<Level> = Vec::new();
    for (subdivisions, spread) in &spreads {
        let half_range = if spread.count > 1 { half_range(spread) } else { typical };
        let noise = half_range / (spread.count as f64).sqrt();
        let (value, runs) = (spread.median, spread.count);
        levels.push(Level { subdivisions: *subdivisions, value, noise, runs });
    }
    let fine = levels.iter().filter(|level| level.subdivisions >= COARSEST_OF_LIMIT).count();
    if fine >= LIMIT_MESHES {
        levels.retain(|level| level.subdivisions >= COARSEST_OF_LIMIT);
    }
    levels
}
