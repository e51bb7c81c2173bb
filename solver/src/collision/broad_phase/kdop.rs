//! Bounding volumes: discrete oriented polytopes (k-DOPs) with planes in eight directions.
//!
//! ```text
//! separation of A and B = max over directions n of   min n·a − max n·b  and  min n·b − max n·a
//! ```
//!
//! The separation is a lower bound of the distance between a point a of A and a point b of B
//! (J. Klosowski et al., "Efficient collision detection using bounding volume hierarchies of
//! k-DOPs", IEEE TVCG 4, 1998). The directions are the three axes, the four diagonals of a cube and
//! one diagonal of a face. Numbers have single precision; an upper bound of the rounding error is
//! subtracted, so a separation is never too large.

#![allow(clippy::inline_always, reason = "inside the loop over pairs")]

use super::hierarchy::Hierarchy;
use crate::geometry::field::Field;
use crate::platform::simd::{InstructionSet, dispatch};

/// Number of directions.
const DIRECTIONS: usize = 8;
/// 1/√3: component of the unit vector along a diagonal of a cube.
const CUBE_DIAGONAL: f64 = 0.577_350_269_189_625_8;
/// 1/√2: component of the unit vector along a diagonal of a face.
const FACE_DIAGONAL: f64 = core::f64::consts::FRAC_1_SQRT_2;
/// x, y and z components of the unit directions.
const NORMALS: [[f64; DIRECTIONS]; 3] = {
    const C: f64 = CUBE_DIAGONAL;
    const F: f64 = FACE_DIAGONAL;
    [
        [1.0, 0.0, 0.0, C, C, -C, -C, F],
        [0.0, 1.0, 0.0, C, -C, C, -C, F],
        [0.0, 0.0, 1.0, C, C, C, C, 0.0],
    ]
};

/// Upper bound of the rounding error of a separation, in units of the machine epsilon of `f32` times
/// the largest |n·x|. The two rounded extents contribute ½ each, their sum 1 and the subtraction of
/// this bound 1; the rest is margin.
const MAX_ROUNDING_ERROR: f32 = 4.0;

/// Smallest n·x, then smallest −n·x, of a set of points in each direction, m.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
struct KDop([f32; 2 * DIRECTIONS]);

impl KDop {
    /// The k-DOP of no points. Its separation from everything is infinite.
    const EMPTY: Self = Self([f32::INFINITY; 2 * DIRECTIONS]);

    /// The smallest k-DOP that contains both.
    #[inline]
    fn union(self, other: &Self) -> Self {
        let mut union = self;
        for (extent, other) in union.0.iter_mut().zip(&other.0) {
            *extent = if *other < *extent { *other } else { *extent };
        }
        union
    }
}

/// k-DOPs of all tree nodes of a hierarchy.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KDops {
    /// k-DOP of each tree node.
    tree: Vec<KDop>,
    /// k-DOP of each mesh node: a point.
    points: Vec<KDop>,
    /// Upper bound of the rounding error of a separation, m.
    rounding_error: f32,
}

impl KDops {
    /// The k-DOPs of a hierarchy whose mesh nodes have these positions (m).
    pub fn new(hierarchy: &Hierarchy, positions: &Field) -> Self {
        let mut kdops = Self::default();
        kdops.fit(hierarchy, positions);
        kdops
    }

    /// Fits the k-DOPs to positions (m).
    pub fn fit(&mut self, hierarchy: &Hierarchy, positions: &Field) {
        self.tree.resize(hierarchy.end(), KDop::EMPTY);
        self.update_points(positions);
        for leaf in hierarchy.leaves() {
            let corners = hierarchy.corners(leaf).iter();
            self.tree[leaf] =
                corners.fold(KDop::EMPTY, |union, node| union.union(&self.points[*node as usize]));
        }
        for parent in (1..hierarchy.first_leaf()).rev() {
            self.tree[parent] = self.tree[2 * parent].union(&self.tree[2 * parent + 1]);
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "k-DOPs have single precision")]
    fn update_points(&mut self, positions: &Field) {
        self.points.resize(positions.len(), KDop::EMPTY);
        let mut largest = 0.0_f32;
        let [normal_x, normal_y, normal_z] = &NORMALS;
        for (node, point) in self.points.iter_mut().enumerate() {
            let (x, y, z) = (positions.x[node], positions.y[node], positions.z[node]);
            for direction in 0..DIRECTIONS {
                let extent =
                    x * normal_x[direction] + y * normal_y[direction] + z * normal_z[direction];
                let extent = extent as f32;
                point.0[direction] = extent;
                point.0[DIRECTIONS + direction] = -extent;
                let size = extent.abs();
                largest = if size > largest { size } else { largest };
            }
        }
        self.rounding_error = MAX_ROUNDING_ERROR * f32::EPSILON * largest;
    }

    /// Lower bound of the distance between the points of two tree nodes, m. It is zero or negative
    /// if the k-DOPs may overlap.
    #[inline]
    pub fn separation(&self, a: usize, b: usize) -> f64 {
        f64::from(separation(&self.tree[a], &self.tree[b]) - self.rounding_error)
    }

    /// Replaces the content of `separations` with the separation (m) of each pair of tree nodes.
    pub fn separations(
        &self,
        instruction_set: InstructionSet,
        pairs: &[[u32; 2]],
        separations: &mut Vec<f32>,
    ) {
        separations.clear();
        push_separations(instruction_set, self, pairs, separations);
    }
}

#[inline(always)]
fn separation(KDop(a): &KDop, KDop(b): &KDop) -> f32 {
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let (mut above, mut below) = ([0.0_f32; DIRECTIONS], [0.0_f32; DIRECTIONS]);
    for direction in 0..DIRECTIONS {
        above[direction] = a[direction] + b[DIRECTIONS + direction];
    }
    for direction in 0..DIRECTIONS {
        below[direction] = a[DIRECTIONS + direction] + b[direction];
    }
    for direction in 0..DIRECTIONS {
        above[direction] = larger(above[direction], below[direction]);
    }
    let mut half = [0.0_f32; DIRECTIONS / 2];
    for lane in 0..DIRECTIONS / 2 {
        half[lane] = larger(above[lane], above[lane + DIRECTIONS / 2]);
    }
    larger(larger(half[0], half[2]), larger(half[1], half[3]))
}

#[inline(always)]
fn push_separations_kernel(kdops: &KDops, pairs: &[[u32; 2]], separations: &mut Vec<f32>) {
    separations.resize(pairs.len(), 0.0);
    for ([a, b], result) in pairs.iter().zip(separations) {
        let (a, b) = (&kdops.tree[*a as usize], &kdops.tree[*b as usize]);
        *result = separation(a, b) - kdops.rounding_error;
    }
}

dispatch! {
    fn push_separations / push_separations_kernel(
        kdops: &KDops,
        pairs: &[[u32; 2]],
        separations: &mut Vec<f32>,
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
        /// No two mesh nodes of two leaves are closer than the separation of the leaves.
        #[test]
        fn a_separation_is_never_too_large(
            positions in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12),
            shift in -3.0..3.0_f64,
        ) {
            let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
            let hierarchy = Hierarchy::new(12, &triangles, &triangles, 12);
            let mut positions: Vec<Vector3<f64>> =
                positions.into_iter().map(Vector3::from).collect();
            for position in &mut positions[..6] {
                position.x += shift;
            }
            let kdops = KDops::new(&hierarchy, &Field::of(&positions));
            for a in hierarchy.leaves() {
                for b in a + 1..hierarchy.end() {
                    let separation = kdops.separation(a, b);
                    for p in hierarchy.corners(a) {
                        for q in hierarchy.corners(b) {
                            let distance =
                                (positions[*p as usize] - positions[*q as usize]).norm();
                            prop_assert!(separation <= distance, "{separation} {distance}");
                        }
                    }
                }
            }
        }
    }
}
