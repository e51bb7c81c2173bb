//! The change of the gradient of the turns: ∂²u/∂x² of each hinge, by central differences.

use nalgebra::{SMatrix, Vector3};

use super::hinges::Hinges;
use crate::geometry::field::Field;
use crate::platform::simd::InstructionSet;

/// Step of the differences in [`Hinges::second_gradients`] over the edge. Chosen: between rounding and curvature.
const DIFFERENCE: f64 = 1e-5;

impl Hinges {
    /// ∂²u/∂x² of the nodes s, a, t, b of each hinge at these positions (m), 1/m²: central differences of ∂u/∂x.
    pub(super) fn second_gradients(&self, positions: &Field) -> Vec<SMatrix<f64, 12, 12>> {
        // One pass moves the same component of all hinges.
        let alone = self.separate();
        let at = |node: &u32| positions.get(*node as usize);
        let corners: Vec<Vector3<f64>> = self.nodes.iter().flatten().map(at).collect();
        let step = |hinge: usize| DIFFERENCE * (corners[4 * hinge + 2] - corners[4 * hinge]).norm();
        let mut second = vec![SMatrix::<f64, 12, 12>::zeros(); self.len()];
        let (mut blocks, mut turns) = (Vec::new(), Vec::new());
        for (row, sign) in (0..12).flat_map(|row| [(row, 1.0), (row, -1.0)]) {
            let mut moved = corners.clone();
            for hinge in 0..self.len() {
                moved[4 * hinge + row / 3][row % 3] += sign * step(hinge);
            }
            alone.measure(InstructionSet::detect(), &Field::of(&moved), &mut blocks, &mut turns);
            for (hinge, second) in second.iter_mut().enumerate() {
                let gradient = Self::gradient(&blocks, hinge);
                for column in 0..12 {
                    second[(row, column)] +=
                        sign * gradient[column / 3][column % 3] / (2.0 * step(hinge));
                }
            }
        }
        second.iter().map(|second| 0.5 * (second + second.transpose())).collect()
    }
}
