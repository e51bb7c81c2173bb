//! Closest points: point and triangle, segment and segment.
//!
//! ```text
//! point p, triangle (a, b, c):   min over u + v + w = 1, u, v, w ≥ 0 of |p − (u a + v b + w c)|
//! segments (a, b), (c, d):       min over s, t in [0, 1] of |a + s (b − a) − c − t (d − c)|
//! ```
//!
//! By regions (C. Ericson, "Real-Time Collision Detection", 2005, ch. 5). Which feature of the
//! triangle is closest is told apart exactly where the weights are nought.

use nalgebra::Vector3;

/// Closest points of a pair, as weights of its four nodes: the vector between them is
/// Σ w x, positive weights on the one side, negative on the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// Weights of the four nodes.
    pub weights: [f64; 4],
    /// Σ w x, m.
    pub between: Vector3<f64>,
    /// Its length squared, m².
    pub squared: f64,
}

impl Closest {
    fn of(weights: [f64; 4], x: &[Vector3<f64>; 4]) -> Self {
        let between = x[0] * weights[0] + x[1] * weights[1] + x[2] * weights[2] + x[3] * weights[3];
        Self { weights, between, squared: between.norm_squared() }
    }
}

/// A point (first) and a triangle (the others).
pub fn point_triangle(x: &[Vector3<f64>; 4]) -> Closest {
    let [p, a, b, c] = *x;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    let at = |u: f64, v: f64, w: f64| Closest::of([1.0, -u, -v, -w], x);
    if d1 <= 0.0 && d2 <= 0.0 {
        return at(1.0, 0.0, 0.0);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return at(0.0, 1.0, 0.0);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return at(1.0 - v, v, 0.0);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return at(0.0, 0.0, 1.0);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return at(1.0 - w, 0.0, w);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return at(0.0, 1.0 - w, w);
    }
    let sum = va + vb + vc;
    if sum <= 0.0 {
        // A triangle without area: the nearest of its edges.
        let edge = |i: usize, j: usize| {
            let way = x[j] - x[i];
            let length = way.norm_squared();
            let t =
                if length > 0.0 { (way.dot(&(p - x[i])) / length).clamp(0.0, 1.0) } else { 0.0 };
            let mut weights = [1.0, 0.0, 0.0, 0.0];
            weights[i] -= 1.0 - t;
            weights[j] -= t;
            Closest::of(weights, x)
        };
        let edges = [edge(1, 2), edge(2, 3), edge(3, 1)];
        return edges.into_iter().fold(edges[0], |a, b| if b.squared < a.squared { b } else { a });
    }
    let (v, w) = (vb / sum, vc / sum);
    at(1.0 - v - w, v, w)
}

/// Two segments: the first two nodes, the last two.
pub fn segment_segment(x: &[Vector3<f64>; 4]) -> Closest {
    let [a, b, c, d] = *x;
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv, uv) = (u.norm_squared(), v.norm_squared(), u.dot(&v));
    let (ur, vr) = (u.dot(&r), v.dot(&r));
    let share =
        |above: f64, below: f64| if below > 0.0 { (above / below).clamp(0.0, 1.0) } else { 0.0 };
    let determinant = uu * vv - uv * uv;
    // Nearly parallel: any place along the overlap will do; start from one end.
    let mut s =
        if determinant > 1e-12 * uu * vv { share(uv * vr - ur * vv, determinant) } else { 0.0 };
    let t_free = if vv > 0.0 { (uv * s + vr) / vv } else { 0.0 };
    let t = t_free.clamp(0.0, 1.0);
    if !(0.0..=1.0).contains(&t_free) || vv <= 0.0 {
        s = share(uv * t - ur, uu);
    }
    Closest::of([1.0 - s, s, t - 1.0, -t], x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = Vector3<f64>> {
        prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from)
    }

    fn four() -> impl Strategy<Value = [Vector3<f64>; 4]> {
        prop::array::uniform4(place())
    }

    proptest! {
        #[test]
        fn no_point_of_a_triangle_is_nearer(x in four(), u in 0.0..1.0_f64, v in 0.0..1.0_f64) {
            let near = point_triangle(&x);
            prop_assert!((near.weights.iter().sum::<f64>()).abs() < 1e-12);
            prop_assert!(near.weights[1..].iter().all(|w| *w <= 1e-15));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let other = x[0] - (x[1] * (1.0 - u - v) + x[2] * u + x[3] * v);
            prop_assert!(near.squared.sqrt() <= other.norm() + 1e-12);
        }

        #[test]
        fn no_points_of_two_segments_are_nearer(x in four(), s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
            let near = segment_segment(&x);
            prop_assert!(near.weights[..2].iter().all(|w| *w >= 0.0));
            prop_assert!(near.weights[2..].iter().all(|w| *w <= 0.0));
            let other = x[0] * (1.0 - s) + x[1] * s - x[2] * (1.0 - t) - x[3] * t;
            prop_assert!(near.squared.sqrt() <= other.norm() + 1e-9);
        }
    }

    #[test]
    fn parallel_and_degenerate_pairs_have_a_distance() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let parallel = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.5, 1.0, 0.0), v(3.0, 1.0, 0.0)];
        assert!((segment_segment(&parallel).squared - 1.0).abs() < 1e-15);
        let apart = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(3.0, 0.0, 0.0), v(4.0, 0.0, 0.0)];
        assert!((segment_segment(&apart).squared - 4.0).abs() < 1e-15);
        let points = [v(0.0, 0.0, 0.0), v(0.0, 0.0, 0.0), v(0.0, 2.0, 0.0), v(0.0, 2.0, 0.0)];
        assert!((segment_segment(&points).squared - 4.0).abs() < 1e-15);
        let line = [v(0.0, 1.0, 0.0), v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(2.0, 0.0, 0.0)];
        assert!((point_triangle(&line).squared - 1.0).abs() < 1e-12);
    }
}
