//! Ridge regression of the biases of scenes over their coordinates.
//!
//! ```text
//! minimise  Σ (y − b − Σ_f s_f z_f)² + λ Σ_f s_f²      z_f = u_f/rms(u_f)
//! ŷ: predicted from all other scenes
//! ```
//! λ is the penalty with the smallest distance |y − ŷ| that 19 of 20 scenes keep: a scene far from all others, as one
//! whose capsule rebounds below a level, decides nothing. Scenes are few and their biases scatter, so slopes
//! that other scenes do not confirm are kept small. See A. E. Hoerl and R. W. Kennard, Technometrics 12 (1970).

use nalgebra::{DMatrix, DVector};

use billow_study::accuracy::features::FEATURES;

/// Penalties λ to choose from. The last one leaves the mean alone.
const PENALTIES: [f64; 10] = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 1e6];

/// Coordinates u of a scene, and its bias y.
pub(super) type Point = ([f64; FEATURES], f64);

/// The bias as a linear function of the coordinates.
#[derive(Debug)]
pub(super) struct Regression {
    /// b: the bias at u = 0.
    pub(super) intercept: f64,
    /// Slope of each coordinate u; 0 for one that is 0 in every scene.
    pub(super) slopes: [f64; FEATURES],
    /// The bias of each scene, predicted from all others; of a single scene its own.
    pub(super) left_out: Vec<f64>,
}

/// The distance that 19 of 20 keep; of a new scene beside these, so that few scenes give a larger one.
pub(super) fn nineteen_of_twenty(mut distances: Vec<f64>, scenes: usize) -> f64 {
    distances.sort_by(f64::total_cmp);
    let index = rank_of_19_of_20(distances.len(), scenes).max(1) - 1;
    distances.get(index).copied().unwrap_or(0.0)
}

/// Rank, from the smallest distance on, of the distance that 19 of 20 runs of a new scene keep beside these.
pub(super) fn rank_of_19_of_20(runs: usize, scenes: usize) -> usize {
    let level = 0.95 * (1.0 + 1.0 / scenes as f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rank")]
    let rank = libm::ceil(level * runs as f64) as usize;
    rank.min(runs)
}

/// The regression over these scenes; `None` without any.
pub(super) fn regression(points: &[Point]) -> Option<Regression> {
    let scale: [f64; FEATURES] = core::array::from_fn(|index| {
        let squares: f64 = points.iter().map(|(u, _)| u[index] * u[index]).sum();
        (squares / points.len() as f64).sqrt()
    });
    let ratio = |a: f64, scale: f64| if scale > 0.0 { a / scale } else { 0.0 };
    // 1 and the coordinates z.
    let row = |(u, y): &Point| -> Row {
        let z = u.iter().zip(scale).map(|(u, scale)| ratio(*u, scale));
        (DVector::from_iterator(FEATURES + 1, [1.0].into_iter().chain(z)), *y)
    };
    let rows: Vec<Row> = points.iter().map(row).collect();
    let distance = |left_out: &[f64]| {
        let distances = points.iter().zip(left_out).map(|((_, y), at)| (y - at).abs());
        nineteen_of_twenty(distances.collect(), points.len())
    };
    let best = PENALTIES
        .into_iter()
        .filter_map(|penalty| Some((left_out(&rows, penalty)?, penalty)))
        .min_by(|a, b| distance(&a.0).total_cmp(&distance(&b.0)));
    let (left_out, penalty) = best?;
    let solution = solve(&rows, penalty)?;
    let slopes = core::array::from_fn(|index| ratio(solution[index + 1], scale[index]));
    Some(Regression { intercept: solution[0], slopes, left_out })
}

/// 1 and the scaled coordinates of a scene, and its bias.
type Row = (DVector<f64>, f64);

/// The bias of each scene, predicted from all others.
fn left_out(rows: &[Row], penalty: f64) -> Option<Vec<f64>> {
    if let [(_, y)] = rows {
        return Some(vec![*y]);
    }
    let predicted = |(index, (z, _)): (usize, &Row)| {
        let others = [&rows[..index], &rows[index + 1..]].concat();
        Some(solve(&others, penalty)?.dot(z))
    };
    rows.iter().enumerate().map(predicted).collect()
}

/// Intercept, and slopes of the coordinates z.
fn solve(rows: &[Row], penalty: f64) -> Option<DVector<f64>> {
    let mut matrix = DMatrix::from_diagonal_element(FEATURES + 1, FEATURES + 1, penalty);
    matrix[(0, 0)] = 0.0;
    let mut right = DVector::zeros(FEATURES + 1);
    for (z, y) in rows {
        right += z * *y;
        matrix += z * z.transpose();
    }
    Some(matrix.cholesky()?.solve(&right))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(u: [f64; 2], y: f64) -> Point {
        let mut all = [0.0; FEATURES];
        all[..2].copy_from_slice(&u);
        (all, y)
    }

    #[test]
    fn a_linear_bias_is_found_and_an_irregular_one_is_taken_as_noise() {
        let designs = [[0.0, 0.0], [0.5, 0.0], [-0.5, 0.0], [0.0, 0.4], [0.0, -0.4], [0.5, 0.4]];
        let linear = designs.map(|u| point(u, 0.02 + 0.1 * u[0] - 0.05 * u[1]));
        let found = regression(&linear).unwrap();
        assert!((found.intercept - 0.02).abs() < 1e-3, "{found:?}");
        assert!((found.slopes[0] - 0.1).abs() < 2e-3 && (found.slopes[1] + 0.05).abs() < 2e-3);
        let largest = |found: &Regression, points: &[Point]| {
            let distances = points.iter().zip(&found.left_out).map(|((_, y), at)| (y - at).abs());
            nineteen_of_twenty(distances.collect(), points.len())
        };
        assert!(largest(&found, &linear) < 4e-3 && found.slopes[2] == 0.0, "{found:?}");
        let signs = [1.0, -1.0, -1.0, 1.0, -1.0, 1.0];
        let mut sign = signs.iter();
        let noise = designs.map(|u| point(u, 0.01 * sign.next().unwrap()));
        let found = regression(&noise).unwrap();
        assert!(largest(&found, &noise) > 0.008, "{found:?}");
        let single = regression(&[point([0.3, 0.0], 0.04)]).unwrap();
        assert!((single.intercept + 0.3 * single.slopes[0] - 0.04).abs() < 1e-4, "{single:?}");
        let many: Vec<f64> = (0..39).map(f64::from).collect();
        assert_eq!(nineteen_of_twenty(many, 39).to_bits(), 37_f64.to_bits(), "38 of 39");
    }
}
