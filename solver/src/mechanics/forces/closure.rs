//! Stiffness of a pressure on closing faces whose vertices follow a rim ([`crate::mechanics::closure`]).
//!
//! ```text
//! z = (m, B, N) = Z x,   dx_a = T_a dz,   T_a = (1, c_a 1, b_a 1)      linear but for N, which is quadratic
//! K = Zᵀ (Σ T_aᵀ K_ab T_b) Z + Zᵀ (Σ T_aᵀ K_ai) + its transpose + ½ [g]× on each edge of the rim
//! ```
//!
//! Symbols: a, b vertices that follow, i the rim; `K_ab`, `K_ai` blocks of the faces; `g = Σ b_a f_a`. Between vertices
//! of the rim the faces give their blocks themselves.

use nalgebra::{DMatrix, SMatrix, Vector3};

use super::tangent;
use crate::geometry::field::Field;
use crate::mechanics::closure::{ClosureNodes, Follower, Patch};

/// Components of (m, B, N).
const COARSE: usize = 15;

/// Computes the stiffness of each patch at these positions (m) and this pressure (Pa): a matrix over its rim.
pub fn stiffness(nodes: &ClosureNodes, positions: &Field, pressure: f64, out: &mut [DMatrix<f64>]) {
    for (patch, out) in nodes.patches.iter().zip(out) {
        of_patch(patch, positions, pressure, out);
    }
}

fn of_patch(patch: &Patch, positions: &Field, pressure: f64, out: &mut DMatrix<f64>) {
    let to_coarse = to_coarse(patch, positions);
    // Both ascend.
    let follower = |node: u32| {
        let found = patch.followers.binary_search_by_key(&node, |follower| follower.node);
        found.ok().map(|index| &patch.followers[index])
    };
    let on_rim = |node: u32| patch.rim.binary_search_by_key(&node, |rim| rim.node).ok();
    let mut between = SMatrix::<f64, COARSE, COARSE>::zeros();
    let mut across = DMatrix::<f64>::zeros(COARSE, 3 * patch.rim.len());
    let mut along_normal = Vector3::zeros();
    for face in &patch.faces {
        let block = tangent::pressure(*face, positions, pressure);
        let [a, b, c] = positions.at(*face);
        let force = (b - a).cross(&(c - a)) * (pressure / 6.0);
        for i in 0..3 {
            let Some(of_corner) = follower(face[i]) else { continue };
            along_normal += force * of_corner.normal;
            for j in (0..3).filter(|j| *j != i) {
                let of_pair = map(of_corner).transpose() * block.fixed_view::<3, 3>(3 * i, 3 * j);
                if let Some(other) = follower(face[j]) {
                    between += of_pair * map(other);
                } else if let Some(rim) = on_rim(face[j]) {
                    let mut columns = across.fixed_columns_mut::<3>(3 * rim);
                    columns += of_pair;
                }
            }
        }
    }
    let mixed = to_coarse.tr_mul(&across);
    *out = to_coarse.tr_mul(&(between * &to_coarse)) + mixed.transpose() + mixed;
    let half = (along_normal * 0.5).cross_matrix();
    for [a, b] in &patch.edges {
        let mut block = out.fixed_view_mut::<3, 3>(3 * a, 3 * b);
        block += half;
        let mut block = out.fixed_view_mut::<3, 3>(3 * b, 3 * a);
        block -= half;
    }
}

/// T of a vertex.
fn map(follower: &Follower) -> SMatrix<f64, 3, COARSE> {
    let mut map = SMatrix::<f64, 3, COARSE>::zeros();
    let Follower { affine, normal, .. } = follower;
    for (part, factor) in [1.0, affine.x, affine.y, affine.z, *normal].into_iter().enumerate() {
        map.fixed_columns_mut::<3>(3 * part).fill_diagonal(factor);
    }
    map
}

/// Z at these positions (m).
fn to_coarse(patch: &Patch, positions: &Field) -> DMatrix<f64> {
    let mut coarse = DMatrix::zeros(COARSE, 3 * patch.rim.len());
    for (index, rim) in patch.rim.iter().enumerate() {
        let factors = [1.0, rim.offset.x, rim.offset.y, rim.offset.z];
        for (part, factor) in factors.into_iter().enumerate() {
            let mut block = coarse.fixed_view_mut::<3, 3>(3 * part, 3 * index);
            block.fill_diagonal(rim.weight * factor);
        }
    }
    let position = |index: usize| positions.get(patch.rim[index].node as usize);
    let origin = position(0);
    for [a, b] in &patch.edges {
        let [x, y] = [a, b].map(|index| ((position(*index) - origin) * 0.5).cross_matrix());
        let mut block = coarse.fixed_view_mut::<3, 3>(12, 3 * a);
        block -= y;
        let mut block = coarse.fixed_view_mut::<3, 3>(12, 3 * b);
        block += x;
    }
    coarse
}
