//! Closest points: point and triangle, segment and segment.
//!
//! ```text
//! point p, triangle (a, b, c):   min over u + v + w = 1, u, v, w ≥ 0 of |p − (u a + v b + w c)|
//! segments (a, b), (c, d):       min over s, t in [0, 1] of |a + s (b − a) − c − t (d − c)|
//! ```
//!
//! The closest region is found as in C. Ericson, "Real-Time Collision Detection", 2005, ch. 5. A
//! weight is exactly zero if its node does not belong to the closest feature.

use nalgebra::Vector3;

/// Squared sine of the angle of two segments below which they count as parallel. Chosen: far above
/// the rounding error of the determinant relative to its terms, about 1e-16.
pub(super) const PARALLEL_TOLERANCE: f64 = 1e-12;

/// Closest points of a pair of primitives. The vector between them is Σ w x over the four nodes.
/// Weights of the first primitive sum to 1 and are not negative; those of the second sum to −1 and
/// are not positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// Weights of the four nodes.
    pub weights: [f64; 4],
    /// Σ w x, m.
    pub between: Vector3<f64>,
    /// Squared length of that vector: the squared distance, m².
    pub squared: f64,
}

impl Closest {
    fn of(weights: [f64; 4], x: &[Vector3<f64>; 4]) -> Self {
        let between = x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2] + x[3] * weights[3];
        Self { weights, between, squared: between.norm_squared() }
    }
}

/// Closest points of a point (first node) and a triangle (the other nodes).
pub fn point_triangle(x: &[Vector3<f64>; 4]) -> Closest {
    let [p, a, b, c] = *x;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    let with_weights = |u: f64, v: f64, w: f64| Closest::of([1.0, -u, -v, -w], x);
    if d1 <= 0.0 && d2 <= 0.0 {
        return with_weights(1.0, 0.0, 0.0);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return with_weights(0.0, 1.0, 0.0);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return with_weights(1.0 - v, v, 0.0);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return with_weights(0.0, 0.0, 1.0);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return with_weights(1.0 - w, 0.0, w);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return with_weights(0.0, 1.0 - w, w);
    }
    let sum = va + vb + vc;
    if sum <= 0.0 {
        // A triangle without area: take the closest of its edges.
        let edge = |i: usize, j: usize| {
            let e = x[j] - x[i];
            let ee = e.norm_squared();
            let t = if ee > 0.0 { (e.dot(&(p - x[i])) / ee).clamp(0.0, 1.0) } else { 0.0 };
            let mut weights = [1.0, 0.0, 0.0, 0.0];
            weights[i] -= 1.0 - t;
            weights[j] -= t;
            Closest::of(weights, x)
        };
        let edges = [edge(1, 2), edge(2, 3), edge(3, 1)];
        return edges.into_iter().fold(edges[0], |a, b| if b.squared < a.squared { b } else { a });
    }
    let (v, w) = (vb / sum, vc / sum);
    with_weights(1.0 - v - w, v, w)
}

/// Closest points of two segments: the first two nodes, and the last two.
pub fn segment_segment(x: &[Vector3<f64>; 4]) -> Closest {
    let [a, b, c, d] = *x;
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv, uv) = (u.norm_squared(), v.norm_squared(), u.dot(&v));
    let (ur, vr) = (u.dot(&r), v.dot(&r));
    let clamped_ratio = |numerator: f64, denominator: f64| {
        if denominator > 0.0 { (numerator / denominator).clamp(0.0, 1.0) } else { 0.0 }
    };
    let determinant = uu * vv - uv * uv;
    // Parallel segments: all points of the overlap are equally close; start from the first end.
    let mut s = if determinant > PARALLEL_TOLERANCE * uu * vv {
        clamped_ratio(uv * vr - ur * vv, determinant)
    } else {
        0.0
    };
    let t_free = if vv > 0.0 { (uv * s + vr) / vv } else { 0.0 };
    let t = t_free.clamp(0.0, 1.0);
    if !(0.0..=1.0).contains(&t_free) || vv <= 0.0 {
        s = clamped_ratio(uv * t - ur, uu);
    }
    Closest::of([1.0 - s, s, t - 1.0, -t], x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from)
    }

    fn four_points() -> impl Strategy<Value = [Vector3<f64>; 4]> {
        prop::array::uniform4(point())
    }

    proptest! {
        #[test]
        fn no_point_of_a_triangle_is_closer(x in four_points(), u in 0.0..1.0_f64, v in 0.0..1.0_f64) {
            let closest = point_triangle(&x);
            prop_assert!((closest.weights.iter().sum::<f64>()).abs() < 1e-12);
            prop_assert!(closest.weights[1..].iter().all(|w| *w <= 1e-15));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let other = x[0] - (x[1] * (1.0 - u - v) + x[2] * u + x[3] * v);
            prop_assert!(closest.squared.sqrt() <= other.norm() + 1e-12);
        }

        #[test]
        fn no_points_of_two_segments_are_closer(x in four_points(), s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
            let closest = segment_segment(&x);
            prop_assert!(closest.weights[..2].iter().all(|w| *w >= 0.0));
            prop_assert!(closest.weights[2..].iter().all(|w| *w <= 0.0));
            let other = x[0] * (1.0 - s) + x[1] * s - x[2] * (1.0 - t) - x[3] * t;
            prop_assert!(closest.squared.sqrt() <= other.norm() + 1e-9);
        }
    }

    #[test]
    fn parallel_and_degenerate_pairs_have_the_correct_distance() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let parallel = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.5, 1.0, 0.0), v(3.0, 1.0, 0.0)];
        assert!((segment_segment(&parallel).squared - 1.0).abs() < 1e-15);
        let separate = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(3.0, 0.0, 0.0), v(4.0, 0.0, 0.0)];
        assert!((segment_segment(&separate).squared - 4.0).abs() < 1e-15);
        let points = [v(0.0, 0.0, 0.0), v(0.0, 0.0, 0.0), v(0.0, 2.0, 0.0), v(0.0, 2.0, 0.0)];
        assert!((segment_segment(&points).squared - 4.0).abs() < 1e-15);
        let line = [v(0.0, 1.0, 0.0), v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(2.0, 0.0, 0.0)];
        assert!((point_triangle(&line).squared - 1.0).abs() < 1e-12);
    }
}
