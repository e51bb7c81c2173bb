//! How far elements have moved and deformed so far, as lengths of paths.
//!
//! ```text
//! P_e = Σ max |u_i − ū|             nodes i of element e
//! S_e = Σ max |u_i − u_j|           nodes i, j of element e
//! ```
//!
//! Symbols: u displacement of a node from one frame to the next, ū mean of all displacements, m; the sums are over
//! the motions so far. Points of two elements a and b approach each other by at most the growth of `P_a + P_b`. If
//! the elements share a node, also by at most that of `S_a + S_b`: relative to that node.

#![allow(clippy::inline_always, reason = "inside the loop over elements")]
#![allow(clippy::needless_range_loop, reason = "an iterator is not inlined into a target feature")]

use super::motion::mean_displacement;
use crate::geometry::field::Field;
use crate::platform::simd::{
    InstructionSet, Vectors, WIDTH, Wide, dispatch_wide, nodes_of, vectors_at,
};

/// Factor on a path that covers rounding. Chosen: far above the relative error of a norm and of the sums (about
/// 1e-13), far below any effect on cost.
const ROUNDING_FACTOR: f64 = 1.0 + 1e-9;

/// Paths of one kind, of all elements, m. NaN stays NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct Paths {
    /// Path of each element.
    pub of: Vec<f64>,
    /// Bound of all paths: no path grows by more than it.
    pub bound: f64,
}

impl Paths {
    fn new(elements: usize) -> Self {
        Self { of: vec![0.0; elements], bound: 0.0 }
    }
}

/// Paths of all elements.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementPaths {
    /// P of each element.
    pub position: Paths,
    /// S of each element.
    pub shape: Paths,
}

impl ElementPaths {
    /// Paths of length 0.
    pub fn new(elements: usize) -> Self {
        Self { position: Paths::new(elements), shape: Paths::new(elements) }
    }

    /// Adds the motion from one frame to the next.
    pub fn add(
        &mut self,
        instruction_set: InstructionSet,
        triangles: &[[u32; 3]],
        from: &Field,
        to: &Field,
    ) {
        let mean = mean_displacement(from, to);
        let [position, shape] = add_motion(instruction_set, triangles, from, to, mean, self);
        self.position.bound += position;
        self.shape.bound += shape;
    }
}

/// Adds a motion to the paths. Returns bounds of what it adds to any position path and any shape path.
#[inline(always)]
fn add_motion_kernel<L: Wide>(
    triangles: &[[u32; 3]],
    from: &Field,
    to: &Field,
    mean: [f64; 3],
    paths: &mut ElementPaths,
) -> [f64; 2] {
    let mean = Vectors { x: L::splat(mean[0]), y: L::splat(mean[1]), z: L::splat(mean[2]) };
    let from: [&[f64]; 3] = [&from.x, &from.y, &from.z];
    let to: [&[f64]; 3] = [&to.x, &to.y, &to.z];
    let factor = L::splat(ROUNDING_FACTOR);
    let (mut most_position, mut most_shape) = (L::splat(0.0), L::splat(0.0));
    let mut start = 0;
    while start < triangles.len() {
        let (nodes, count) = nodes_of(triangles, start);
        let a = vectors_at::<L>(to, &nodes[0]) - vectors_at::<L>(from, &nodes[0]);
        let b = vectors_at::<L>(to, &nodes[1]) - vectors_at::<L>(from, &nodes[1]);
        let c = vectors_at::<L>(to, &nodes[2]) - vectors_at::<L>(from, &nodes[2]);
        let position = largest(a - mean, b - mean, c - mean) * factor;
        let shape = largest(b - a, c - b, a - c) * factor;
        most_position = larger(most_position, position);
        most_shape = larger(most_shape, shape);
        let (position, shape) = (position.lanes(), shape.lanes());
        for lane in 0..count {
            paths.position.of[start + lane] += position.0[lane];
            paths.shape.of[start + lane] += shape.0[lane];
        }
        start += WIDTH;
    }
    [largest_lane(most_position), largest_lane(most_shape)]
}

/// The larger of each pair of lanes; not finite if one is not.
#[inline(always)]
fn larger<L: Wide>(a: L, b: L) -> L {
    // A maximum may lose NaN, a sum does not.
    a.max(b) + (a + b) * 0.0
}

/// The largest length of three vectors, lane by lane; NaN if one is not finite.
#[inline(always)]
fn largest<L: Wide>(a: Vectors<L>, b: Vectors<L>, c: Vectors<L>) -> L {
    larger(larger(a.dot(a), b.dot(b)), c.dot(c)).sqrt()
}

/// The largest lane; NaN if one is.
#[inline(always)]
fn largest_lane<L: Wide>(values: L) -> f64 {
    let values = values.lanes().0;
    let mut largest = 0.0;
    for lane in 0..WIDTH {
        let value = values[lane];
        largest = if value > largest || value.is_nan() { value } else { largest };
    }
    largest
}

dispatch_wide! {
    fn add_motion / add_motion_kernel(
        triangles: &[[u32; 3]],
        from: &Field,
        to: &Field,
        mean: [f64; 3],
        paths: &mut ElementPaths,
    ) -> [f64; 2]
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// No two nodes of two elements approach each other by more than the growth of their paths, on every
        /// instruction set.
        #[test]
        fn approach_is_never_underestimated(
            frames in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 9), 2..5),
            drift in prop::array::uniform3(-9.0..9.0_f64),
        ) {
            // Two elements that share a node, and one more.
            let triangles = [[0, 1, 2], [2, 3, 4], [5, 6, 7]];
            let frame = |(k, x): (usize, &Vec<[f64; 3]>)| {
                let shift = Vector3::from(drift) * k as f64;
                Field::of(&x.iter().map(|x| Vector3::from(*x) + shift).collect::<Vec<_>>())
            };
            let frames: Vec<Field> = frames.iter().enumerate().map(frame).collect();
            for set in InstructionSet::ALL {
                let mut paths = ElementPaths::new(3);
                for pair in frames.windows(2) {
                    let before = paths.clone();
                    paths.add(set, &triangles, &pair[0], &pair[1]);
                    for element in 0..3 {
                        for (now, before) in
                            [(&paths.position, &before.position), (&paths.shape, &before.shape)]
                        {
                            let growth = now.of[element] - before.of[element];
                            prop_assert!(growth <= (now.bound - before.bound) * (1.0 + 1e-12));
                        }
                    }
                }
                let (first, last) = (&frames[0], &frames[frames.len() - 1]);
                let u = |node: u32| last.get(node as usize) - first.get(node as usize);
                for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                    for p in triangles[a] {
                        for q in triangles[b] {
                            let approach = (u(p) - u(q)).norm();
                            prop_assert!(approach <= paths.position.of[a] + paths.position.of[b]);
                            let share_a_node = b == 1;
                            prop_assert!(
                                !share_a_node || approach <= paths.shape.of[a] + paths.shape.of[b]
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_path_without_meaning_stays_so() {
        let triangles = [[0, 1, 2], [3, 4, 5]];
        let still = Field::repeat(0.5, 6);
        for value in [f64::NAN, f64::INFINITY, f64::MAX] {
            let mut broken = still.clone();
            broken.set(1, Vector3::new(value, 0.0, 0.0));
            for set in InstructionSet::ALL {
                let mut paths = ElementPaths::new(2);
                paths.add(set, &triangles, &still, &broken);
                paths.add(set, &triangles, &broken, &still);
                paths.add(set, &triangles, &still, &still);
                let never_below = |path: &f64| path.is_nan() || *path >= f64::MAX;
                assert!(
                    never_below(&paths.shape.of[0]) && never_below(&paths.position.of[0]),
                    "{paths:?}"
                );
                assert!(never_below(&paths.shape.bound) && never_below(&paths.position.bound));
                assert!(paths.shape.of[1].abs() < 1e-12, "{paths:?}");
            }
        }
    }
}
