//! The limit of a measure as the mesh is refined, with its uncertainty.
//!
//! ```text
//! noise of a median of k runs = half their range/√k
//! f(h) = f₀ + a hᵖ,  h = 1/n      weighted least squares, weights 1/h; p in [0.5, 2]
//! σ = √(Σ w r² / Σ w · m/(m − 3))  scatter of m meshes about the fit
//! U = 95 % quantile of |f₀* − f₀| over fits of f + √(σ² + s²) ξ, ξ normal, s the standard error of a mesh;
//!     their orders within 0.5 of p
//! ```
//! L. Eça and M. Hoekstra, "A procedure for the estimation of the numerical uncertainty of CFD calculations
//! based on grid refinement studies", J. Comput. Phys. 262 (2014): fit, weights, range of the order. Their
//! uncertainty covers one value; here the fit is repeated on perturbed values, because f₀ itself is asked for.
//! The perturbations are the same in each call.

use std::collections::BTreeMap;

use billow_solver::scene::ModelKind;
use billow_study::analysis::statistics::Spread;
use billow_study::job::row::ColumnId;

use super::runs::SceneRuns;

/// Smallest and largest order of a fit. Below the smallest, f₀ is not determined by meshes that differ tenfold.
const ORDERS: [f64; 2] = [0.5, 2.0];
/// Steps of the order between them.
const ORDER_STEPS: u32 = 60;
/// How far the order of a fit of perturbed values may be from that of the values. Chosen: a wider range lets noise
/// pass for slow convergence, and the uncertainty of a measure that no longer changes grows without reason.
const ORDER_RANGE: f64 = 0.5;
/// Number of fits of perturbed values. Chosen: their 95 % quantile is then known to 10 %.
const FITS: usize = 400;
/// Index of the 95 % quantile of the deviations in ascending order.
const QUANTILE: usize = FITS * 95 / 100;

/// A measure on one mesh.
pub(super) struct Level {
    pub(super) subdivisions: u32,
    /// Value: the median of its runs.
    pub(super) value: f64,
    /// Standard error of that value by the seeds.
    pub(super) noise: f64,
}

/// The limit of a measure.
pub(super) struct Fit {
    /// f₀.
    pub(super) limit: f64,
    /// Order p.
    pub(super) order: f64,
    /// U, 95 %.
    pub(super) uncertainty: f64,
}

/// Largest distance of a limit, with its uncertainty, from the finest value, relative, for which the limit
/// counts as known. Chosen: beyond it the error would be mainly that of the limit.
const MAX_DISTANCE: f64 = 0.05;

impl Fit {
    /// Whether a limit is known: together with its uncertainty it lies near the finest value. Otherwise the measure
    /// changes too slowly, or too irregularly.
    pub(super) fn has_limit(&self, levels: &[Level]) -> bool {
        let finest = levels.last().map_or(0.0, |level| level.value);
        (self.limit - finest).abs() + self.uncertainty <= MAX_DISTANCE * finest.abs()
    }
}

/// Fits the values of at least four meshes; `None` for fewer, or for a value that is not finite.
pub(super) fn fit(levels: &[Level]) -> Option<Fit> {
    let finite = levels.iter().all(|level| level.value.is_finite() && level.noise.is_finite());
    if levels.len() < 4 || !finite {
        return None;
    }
    let values: Vec<f64> = levels.iter().map(|level| level.value).collect();
    let best = best(levels, &values, ORDERS);
    let meshes = levels.len() as f64;
    let variance = best.residual * meshes / (meshes - 3.0);
    let near = [ORDERS[0].max(best.order - ORDER_RANGE), ORDERS[1].min(best.order + ORDER_RANGE)];
    let mut normal = Normal::new();
    let mut deviations: Vec<f64> = (0..FITS)
        .map(|_| {
            let perturbed: Vec<f64> = levels
                .iter()
                .map(|level| {
                    level.value + (variance + level.noise * level.noise).sqrt() * normal.next()
                })
                .collect();
            (self::best(levels, &perturbed, near).limit - best.limit).abs()
        })
        .collect();
    deviations.sort_by(f64::total_cmp);
    let uncertainty = deviations[QUANTILE];
    Some(Fit { limit: best.limit, order: best.order, uncertainty })
}

/// One least-squares fit.
struct Candidate {
    limit: f64,
    order: f64,
    /// Σ w r² / Σ w.
    residual: f64,
}

/// The fit with the order of the smallest residual, of orders in a range.
fn best(levels: &[Level], values: &[f64], [lowest, highest]: [f64; 2]) -> Candidate {
    let orders = (0..=ORDER_STEPS)
        .map(|step| lowest + (highest - lowest) * f64::from(step) / f64::from(ORDER_STEPS));
    let fits = orders.map(|order| with_order(levels, values, order));
    let first = with_order(levels, values, lowest);
    fits.fold(first, |best, fit| if fit.residual < best.residual { fit } else { best })
}

/// The fit of f₀ and a for a fixed order.
fn with_order(levels: &[Level], values: &[f64], order: f64) -> Candidate {
    let power = |level: &Level| libm::pow(1.0 / f64::from(level.subdivisions), order);
    let weight = |level: &Level| f64::from(level.subdivisions);
    let total: f64 = levels.iter().map(weight).sum();
    let mean = |of: &dyn Fn(usize) -> f64| -> f64 {
        levels.iter().enumerate().map(|(index, level)| weight(level) * of(index)).sum::<f64>()
            / total
    };
    let x = mean(&|index| power(&levels[index]));
    let y = mean(&|index| values[index]);
    let xx = mean(&|index| {
        let distance = power(&levels[index]) - x;
        distance * distance
    });
    let xy = mean(&|index| (power(&levels[index]) - x) * (values[index] - y));
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    let residual = mean(&|index| {
        let residual = values[index] - y - slope * (power(&levels[index]) - x);
        residual * residual
    });
    Candidate { limit: y - slope * x, order, residual }
}

/// Normal numbers, the same in each use: the sum of twelve uniform ones minus 6.
struct Normal {
    state: u64,
}

impl Normal {
    fn new() -> Self {
        Self { state: 0x9E37_79B9_7F4A_7C15 }
    }

    fn next(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// A number in [0, 1): splitmix64.
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Meshes of which a limit can follow, at least.
const LIMIT_MESHES: usize = 4;
/// Coarser meshes have no part in a limit where enough others are there. Chosen: on n 2 and 3 a panel is not yet round.
const COARSEST_OF_LIMIT: u32 = 4;

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
        levels.push(Level { subdivisions: *subdivisions, value: spread.median, noise });
    }
    let fine = levels.iter().filter(|level| level.subdivisions >= COARSEST_OF_LIMIT).count();
    if fine >= LIMIT_MESHES {
        levels.retain(|level| level.subdivisions >= COARSEST_OF_LIMIT);
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    const MESHES: [u32; 7] = [4, 6, 8, 12, 16, 24, 32];

    fn levels(of: impl Fn(f64) -> f64, noise: f64) -> Vec<Level> {
        let level = |n: &u32| Level { subdivisions: *n, value: of(1.0 / f64::from(*n)), noise };
        MESHES.iter().map(level).collect()
    }

    #[test]
    fn finds_limit_and_order_of_exact_series() {
        for order in [0.6, 1.0, 1.5, 2.0] {
            let fit = fit(&levels(|h| 3.0 - 0.5 * libm::pow(h, order), 0.0)).unwrap();
            assert!((fit.limit - 3.0).abs() < 1e-3, "{order}: {}", fit.limit);
            assert!((fit.order - order).abs() < 0.02, "{order}: {}", fit.order);
            assert!(fit.uncertainty < 3e-3, "{order}: {}", fit.uncertainty);
        }
    }

    /// Of noisy series of known limit, the uncertainty holds the limit in nine of ten.
    #[test]
    fn the_uncertainty_holds_the_limit() {
        let mut normal = Normal { state: 77 };
        let mut held = 0;
        for trial in 0..100 {
            let order = 0.8 + 0.3 * f64::from(trial % 5);
            let noise = 0.01 * f64::from(1 + trial % 3);
            let mut levels = levels(|h| 1.0 + 0.8 * libm::pow(h, order), noise);
            for level in &mut levels {
                level.value += noise * normal.next();
            }
            let fit = fit(&levels).unwrap();
            held += u32::from((fit.limit - 1.0).abs() <= fit.uncertainty);
        }
        assert!(held >= 90, "{held} of 100");
    }
}
