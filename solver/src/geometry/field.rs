//! Vector fields over nodes.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::platform::simd::Column;

/// One vector for each node (or corner), stored as one column for each component.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    /// x components.
    pub x: Column,
    /// y components.
    pub y: Column,
    /// z components.
    pub z: Column,
}

impl Field {
    /// `length` zero vectors.
    pub fn zeros(length: usize) -> Self {
        Self::repeat(0.0, length)
    }

    /// `length` vectors with all components equal to `component`.
    pub fn repeat(component: f64, length: usize) -> Self {
        let column = Column::repeat(component, length);
        Self { x: column.clone(), y: column.clone(), z: column }
    }

    /// The field with these vectors.
    pub fn of(vectors: &[Vector3<f64>]) -> Self {
        Self {
            x: vectors.iter().map(|v| v.x).collect(),
            y: vectors.iter().map(|v| v.y).collect(),
            z: vectors.iter().map(|v| v.z).collect(),
        }
    }

    /// Number of vectors.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether the field is empty.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Vector `index`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "inside the element loop")]
    pub fn get(&self, index: usize) -> Vector3<f64> {
        Vector3::new(self.x[index], self.y[index], self.z[index])
    }

    /// The vectors of some nodes.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "inside loops over faces and pairs")]
    pub fn at<const N: usize>(&self, nodes: [u32; N]) -> [Vector3<f64>; N] {
        // A plain loop: `array::map` is not always inlined.
        let mut vectors = [Vector3::zeros(); N];
        for (vector, node) in vectors.iter_mut().zip(nodes) {
            *vector = self.get(node as usize);
        }
        vectors
    }

    /// Sets vector `index`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "inside the element loop")]
    pub fn set(&mut self, index: usize, vector: Vector3<f64>) {
        self.x[index] = vector.x;
        self.y[index] = vector.y;
        self.z[index] = vector.z;
    }

    /// Copies the vectors of a field of the same length.
    pub fn copy_from(&mut self, other: &Self) {
        self.x.copy_from_slice(&other.x);
        self.y.copy_from_slice(&other.y);
        self.z.copy_from_slice(&other.z);
    }

    /// The largest norm of a vector; 1 where that is zero or not finite. NaN vectors are ignored.
    pub fn size(&self) -> f64 {
        let size = self.iter().map(|x| x.norm()).fold(0.0, f64::max);
        if size > 0.0 && size < f64::INFINITY { size } else { 1.0 }
    }

    /// The largest distance between the vectors of the same index in two fields.
    pub fn largest_displacement(&self, other: &Self) -> f64 {
        let squared = |(a, b): (Vector3<f64>, Vector3<f64>)| (b - a).norm_squared();
        self.iter().zip(other.iter()).map(squared).fold(0.0, f64::max).sqrt()
    }

    /// All vectors.
    pub fn iter(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }
}
