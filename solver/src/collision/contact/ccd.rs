//! Continuous collision detection: how much of a straight motion two primitives can make without
//! touching, by conservative advancement.
//!
//! ```text
//! t ← t + (d(t) − g)/l      l: upper bound of the relative displacement of two points of the pair
//! ```
//!
//! At distance d the pair cannot come closer than g within (d − g)/l of the motion. The repeated
//! advances add up to a safe time (M. Li, D. Kaufman, C. Jiang, "Codimensional incremental potential
//! contact", ACM Trans. Graph. 40, 2021, "additive continuous collision detection"). The mean
//! displacement of the pair is subtracted first, because a common motion does not change d.

use nalgebra::Vector3;

use super::distance::Closest;

/// Largest number of advances. Chosen: a pair that needs more is reported as unsafe after the time
/// reached so far, which is still a lower bound.
const MAX_ADVANCES: u32 = 2000;

/// Smallest advance, as a share of the motion; a smaller one counts as touching. Chosen: far
/// above rounding, and too small to reach the end of the motion.
const MIN_ADVANCE: f64 = 1e-9;

/// Share of the motion, 0 to 1, during which the pair certainly stays farther apart than `min_gap`
/// (m). The result is 1 if that holds for the whole motion.
///
/// `x`: positions of the four nodes at the start, m. `displacements`: of the four nodes, m.
/// `nodes_of_first`: number of nodes of the first primitive.
pub fn safe_time(
    x: &[Vector3<f64>; 4],
    displacements: &[Vector3<f64>; 4],
    nodes_of_first: usize,
    min_gap: f64,
    closest: impl Fn(&[Vector3<f64>; 4]) -> Closest,
) -> f64 {
    let (relative, max_approach) = relative_motion(displacements, nodes_of_first);
    if max_approach == 0.0 {
        return 1.0;
    }
    let mut time = 0.0;
    let mut positions = *x;
    for _ in 0..MAX_ADVANCES {
        let gap = closest(&positions).squared.sqrt();
        let advance = (gap - min_gap) / max_approach;
        // Written so that NaN counts as touching.
        let is_clear = advance > MIN_ADVANCE;
        if !is_clear {
            return time;
        }
        time += advance;
        if time >= 1.0 {
            return 1.0;
        }
        positions = core::array::from_fn(|k| x[k] + relative[k] * time);
    }
    time
}

/// Displacements of four nodes relative to their mean, and the upper bound l of how far the two
/// primitives can approach each other, m.
pub fn relative_motion(
    displacements: &[Vector3<f64>; 4],
    nodes_of_first: usize,
) -> ([Vector3<f64>; 4], f64) {
    let [a, b, c, d] = displacements;
    let mean = (a + b + c + d) * 0.25;
    let relative = displacements.map(|u| u - mean);
    let largest =
        |nodes: &[Vector3<f64>]| nodes.iter().map(Vector3::norm_squared).fold(0.0, f64::max).sqrt();
    let (first, second) = relative.split_at(nodes_of_first);
    (relative, largest(first) + largest(second))
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
    fn a_node_through_a_triangle_is_safe_only_until_it_is_close() {
        let x = node_at(0.2, 0.3, 0.1);
        let down =
            [Vector3::new(0.0, 0.0, -10.0), Vector3::zeros(), Vector3::zeros(), Vector3::zeros()];
        let time = safe_time(&x, &down, 1, 0.01, point_triangle);
        assert!(time <= 0.009 + 1e-12 && time > 0.008, "{time}");
    }

    #[test]
    fn sliding_and_common_motion_are_safe() {
        let x = node_at(0.2, 0.3, 0.1);
        let common = [Vector3::new(5.0, 5.0, -30.0); 4];
        assert_eq!(safe_time(&x, &common, 1, 0.01, point_triangle).to_bits(), 1.0_f64.to_bits());
        let sliding =
            [Vector3::new(0.5, 0.1, 0.0), Vector3::zeros(), Vector3::zeros(), Vector3::zeros()];
        assert!(safe_time(&x, &sliding, 1, 0.01, point_triangle) > 0.999);
    }

    #[test]
    fn crossing_edges_are_safe_only_until_they_are_close() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let x = [v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, -1.0, 0.2), v(0.0, 1.0, 0.2)];
        let down = [v(0.0, 0.0, 0.0), v(0.0, 0.0, 0.0), v(0.0, 0.0, -1.0), v(0.0, 0.0, -1.0)];
        let time = safe_time(&x, &down, 2, 0.02, segment_segment);
        assert!(time <= 0.18 + 1e-12 && time > 0.17, "{time}");
    }
}
