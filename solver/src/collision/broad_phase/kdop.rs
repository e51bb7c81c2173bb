//! Boxes round patches, cut by planes of eight directions: how far apart two are at least.
//!
//! ```text
//! separation = max over directions n and both orders of   min n·x_a − max n·x_b
//! ```
//!
//! Unit directions: the three axes, the four diagonals of a cube and one of a face. Single
//! precision, with what rounding could hide taken off: a separation is never too large.

#![allow(clippy::inline_always, reason = "inside the loop over pairs")]

use super::hierarchy::Hierarchy;
use crate::geometry::field::Field;
use crate::platform::simd::{InstructionSet, dispatch};

/// Directions of the planes.
const DIRECTIONS: usize = 8;
const D: f64 = 0.577_350_269_189_625_8;
const F: f64 = core::f64::consts::FRAC_1_SQRT_2;
/// Components of the directions, x, y, z.
const NORMALS: [[f64; DIRECTIONS]; 3] = [
    [1.0, 0.0, 0.0, D, D, -D, -D, F],
    [0.0, 1.0, 0.0, D, -D, D, -D, F],
    [0.0, 0.0, 1.0, D, D, D, D, 0.0],
];

/// Least n·x, and least −n·x, of some points in each direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
struct KDop([f32; 2 * DIRECTIONS]);

impl KDop {
    /// That of no points: apart from everything.
    const NONE: Self = Self([f32::INFINITY; 2 * DIRECTIONS]);

    #[inline]
    fn with(self, other: &Self) -> Self {
        let mut both = self;
        for (own, other) in both.0.iter_mut().zip(&other.0) {
            *own = if *other < *own { *other } else { *own };
        }
        both
    }
}

/// Boxes round the patches of a film, and round the nodes of their tree.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KDops {
    extents: Vec<KDop>,
    nodes: Vec<KDop>,
    /// What rounding can add to a separation at most, m.
    rounding: f32,
}

impl KDops {
    /// Boxes round patches at these places (m).
    pub fn new(patches: &Hierarchy, places: &Field) -> Self {
        let mut boxes = Self::default();
        boxes.fit(patches, places);
        boxes
    }

    /// Fits the boxes to places (m).
    pub fn fit(&mut self, patches: &Hierarchy, places: &Field) {
        self.extents.resize(patches.tree(), KDop::NONE);
        self.rounding = 0.0;
        self.grow(patches, places, |_| KDop::NONE);
    }

    /// Grows the boxes so that they hold these places (m) too.
    pub fn hold(&mut self, patches: &Hierarchy, places: &Field) {
        self.grow(patches, places, |own| own);
    }

    /// Fits the boxes to places (m) and what is left of each leaf's own.
    #[inline]
    fn grow(&mut self, patches: &Hierarchy, places: &Field, left: impl Fn(KDop) -> KDop) {
        self.fit_nodes(places);
        for leaf in patches.leaves()..patches.tree() {
            let corners = patches.corners(leaf).iter();
            let own = left(self.extents[leaf]);
            self.extents[leaf] =
                corners.fold(own, |all, node| all.with(&self.nodes[*node as usize]));
        }
        for node in (1..patches.leaves()).rev() {
            self.extents[node] = self.extents[2 * node].with(&self.extents[2 * node + 1]);
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "single precision is what boxes have")]
    fn fit_nodes(&mut self, places: &Field) {
        self.nodes.resize(places.len(), KDop::NONE);
        let mut largest = 0.0_f32;
        let [along_x, along_y, along_z] = &NORMALS;
        for (node, own) in self.nodes.iter_mut().enumerate() {
            let (x, y, z) = (places.x[node], places.y[node], places.z[node]);
            for direction in 0..DIRECTIONS {
                let along =
                    x * along_x[direction] + y * along_y[direction] + z * along_z[direction];
                let along = along as f32;
                own.0[direction] = along;
                own.0[DIRECTIONS + direction] = -along;
                let size = along.abs();
                largest = if size > largest { size } else { largest };
            }
        }
        // Each of two numbers is rounded once, and their difference.
        self.rounding = self.rounding.max(4.0 * f32::EPSILON * largest);
    }

    /// How far apart the boxes of two nodes of the tree are at least, m; not above 0 where they may meet.
    #[inline]
    pub fn separation(&self, a: usize, b: usize) -> f64 {
        f64::from(separation(&self.extents[a], &self.extents[b]) - self.rounding)
    }

    /// The separations (m) of pairs of nodes of the tree, in place of what `apart` held.
    pub fn separations(&self, path: InstructionSet, pairs: &[[u32; 2]], apart: &mut Vec<f32>) {
        apart.clear();
        separations(path, self, pairs, apart);
    }
}

#[inline(always)]
fn separation(KDop(a): &KDop, KDop(b): &KDop) -> f32 {
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let mut gaps = [0.0_f32; DIRECTIONS];
    for direction in 0..DIRECTIONS {
        let above = a[direction] + b[DIRECTIONS + direction];
        let below = b[direction] + a[DIRECTIONS + direction];
        gaps[direction] = larger(above, below);
    }
    let mut half = [0.0_f32; DIRECTIONS / 2];
    for at in 0..DIRECTIONS / 2 {
        half[at] = larger(gaps[at], gaps[at + DIRECTIONS / 2]);
    }
    larger(larger(half[0], half[2]), larger(half[1], half[3]))
}

#[inline(always)]
fn separations_kernel(boxes: &KDops, pairs: &[[u32; 2]], apart: &mut Vec<f32>) {
    for [a, b] in pairs {
        let (a, b) = (&boxes.extents[*a as usize], &boxes.extents[*b as usize]);
        apart.push(separation(a, b) - boxes.rounding);
    }
}

dispatch! {
    fn separations / separations_kernel(
        boxes: &KDops,
        pairs: &[[u32; 2]],
        apart: &mut Vec<f32>,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    #[test]
    fn directions_have_unit_length() {
        let [x, y, z] = NORMALS;
        for ((x, y), z) in x.into_iter().zip(y).zip(z) {
            assert!((Vector3::new(x, y, z).norm() - 1.0).abs() < 1e-15);
        }
    }

    proptest! {
        /// No two points of two patches are nearer than the separation of their boxes.
        #[test]
        fn a_separation_is_never_too_large(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12),
            shift in -3.0..3.0_f64,
        ) {
            let sides = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
            let patches = Hierarchy::new(12, &sides, &sides, 12);
            let mut places: Vec<Vector3<f64>> = places.into_iter().map(Vector3::from).collect();
            for place in &mut places[..6] {
                place.x += shift;
            }
            let boxes = KDops::new(&patches, &Field::of(&places));
            for a in patches.leaves()..patches.tree() {
                for b in a + 1..patches.tree() {
                    let apart = boxes.separation(a, b);
                    for p in patches.corners(a) {
                        for q in patches.corners(b) {
                            let real = (places[*p as usize] - places[*q as usize]).norm();
                            prop_assert!(apart <= real, "{apart} {real}");
                        }
                    }
                }
            }
        }
    }
}
