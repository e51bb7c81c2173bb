//! Whether two primitives that move in straight lines touch on the way: additive continuous
//! collision detection.
//!
//! ```text
//! t ← t + (d(t) − g)/l      l: largest relative speed of any two points of the pair
//! ```
//!
//! Starting d apart, the pair cannot come closer than g before (d − g)/l; repeated, the steps add up
//! to a time until which it certainly has not (M. Li, D. Kaufman, C. Jiang, "Codimensional
//! incremental potential contact", 2021). Common motion is taken out first.

use nalgebra::Vector3;

use super::distance::Closest;

/// Most steps of one sweep; at the last the time reached still holds.
const MOST: u32 = 2000;

/// Part of the motion, 0 to 1, until which the pair certainly stays farther apart than `gap` (m):
/// 1 for all of it. `left` nodes are of the one side.
pub fn clear_until(
    x: &[Vector3<f64>; 4],
    moves: &[Vector3<f64>; 4],
    left: usize,
    gap: f64,
    closest: impl Fn(&[Vector3<f64>; 4]) -> Closest,
) -> f64 {
    let mean = (moves[0] + moves[1] + moves[2] + moves[3]) * 0.25;
    let own = moves.map(|u| u - mean);
    let largest =
        |side: &[Vector3<f64>]| side.iter().map(Vector3::norm_squared).fold(0.0, f64::max).sqrt();
    let speed = largest(&own[..left]) + largest(&own[left..]);
    if speed == 0.0 {
        return 1.0;
    }
    let mut time = 0.0;
    let mut places = *x;
    for _ in 0..MOST {
        let apart = closest(&places).squared.sqrt();
        let step = (apart - gap) / speed;
        // Written so that what is no number counts as touching.
        let clear = step > 1e-9;
        if !clear {
            return time;
        }
        time += step;
        if time >= 1.0 {
            return 1.0;
        }
        places = core::array::from_fn(|k| x[k] + own[k] * time);
    }
    time
}

#[cfg(test)]
mod tests {
    use super::super::distance::{point_triangle, segment_segment};
    use super::*;

    const TRIANGLE: [Vector3<f64>; 3] =
        [Vector3::new(0.0, 0.0, 0.0), Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0)];

    fn node_at(x: f64, y: f64, z: f64) -> [Vector3<f64>; 4] {
        [Vector3::new(x, y, z), TRIANGLE[0], TRIANGLE[1], TRIANGLE[2]]
    }

    #[test]
    fn a_node_shot_through_is_stopped_before() {
        let x = node_at(0.2, 0.3, 0.1);
        let down =
            [Vector3::new(0.0, 0.0, -10.0), Vector3::zeros(), Vector3::zeros(), Vector3::zeros()];
        let time = clear_until(&x, &down, 1, 0.01, point_triangle);
        assert!(time <= 0.009 + 1e-12 && time > 0.008, "{time}");
    }

    #[test]
    fn sliding_along_and_common_motion_are_free() {
        let x = node_at(0.2, 0.3, 0.1);
        let all = [Vector3::new(5.0, 5.0, -30.0); 4];
        assert_eq!(clear_until(&x, &all, 1, 0.01, point_triangle).to_bits(), 1.0_f64.to_bits());
        let along =
            [Vector3::new(0.5, 0.1, 0.0), Vector3::zeros(), Vector3::zeros(), Vector3::zeros()];
        assert!(clear_until(&x, &along, 1, 0.01, point_triangle) > 0.999);
    }

    #[test]
    fn edges_that_cross_are_stopped_before() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let x = [v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, -1.0, 0.2), v(0.0, 1.0, 0.2)];
        let down = [v(0.0, 0.0, 0.0), v(0.0, 0.0, 0.0), v(0.0, 0.0, -1.0), v(0.0, 0.0, -1.0)];
        let time = clear_until(&x, &down, 2, 0.02, segment_segment);
        assert!(time <= 0.18 + 1e-12 && time > 0.17, "{time}");
    }
}
