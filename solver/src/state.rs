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

    /// Its columns from `middle` on apart from those before.
    ///
    /// # Panics
    /// When there are fewer vectors.
    pub fn split_at_mut(&mut self, middle: usize) -> [[&mut [f64]; 3]; 2] {
        let (x, x_later) = self.x.split_at_mut(middle);
        let (y, y_later) = self.y.split_at_mut(middle);
        let (z, z_later) = self.z.split_at_mut(middle);
        [[x, y, z], [x_later, y_later, z_later]]
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

    /// Takes the vectors of a field of the same length.
    pub fn copy_from(&mut self, other: &Self) {
        self.x.copy_from_slice(&other.x);
        self.y.copy_from_slice(&other.y);
        self.z.copy_from_slice(&other.z);
    }

    /// The largest length of a vector; 1 where there is none, or none that is a number.
    pub fn size(&self) -> f64 {
        let size = self.iter().map(|x| x.norm()).fold(0.0, f64::max);
        if size > 0.0 && size < f64::INFINITY { size } else { 1.0 }
    }

    /// The largest distance of a vector here from its own in another field.
    pub fn largest_way(&self, other: &Self) -> f64 {
        let way = |(a, b): (Vector3<f64>, Vector3<f64>)| (b - a).norm_squared();
        self.iter().zip(other.iter()).map(way).fold(0.0, f64::max).sqrt()
    }

    /// All vectors.
    pub fn iter(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }
}
