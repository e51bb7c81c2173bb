//! What changes while film moves.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// One vector a node (or corner), a `Vec` a component.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    /// x components.
    pub x: Vec<f64>,
    /// y components.
    pub y: Vec<f64>,
    /// z components.
    pub z: Vec<f64>,
}

impl Field {
    /// `length` zero vectors.
    pub fn zeros(length: usize) -> Self {
        Self { x: vec![0.0; length], y: vec![0.0; length], z: vec![0.0; length] }
    }

    /// The field of these vectors.
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

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Vector `index`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "inside the element loop")]
    pub fn get(&self, index: usize) -> Vector3<f64> {
        Vector3::new(self.x[index], self.y[index], self.z[index])
    }

    /// Sets vector `index`.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "inside the element loop")]
    pub fn set(&mut self, index: usize, vector: Vector3<f64>) {
        self.x[index] = vector.x;
        self.y[index] = vector.y;
        self.z[index] = vector.z;
    }

    /// All vectors.
    pub fn iter(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }
}
