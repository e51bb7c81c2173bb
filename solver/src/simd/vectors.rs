//! Vectors of eight elements, component by component.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use core::ops::{Add, Neg, Sub};

use super::Lanes;

/// One vector of each of eight elements.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vectors {
    /// x components.
    pub x: Lanes,
    /// y components.
    pub y: Lanes,
    /// z components.
    pub z: Lanes,
}

impl Vectors {
    /// Scalar products.
    #[inline(always)]
    pub fn dot(self, other: Self) -> Lanes {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Vector products.
    #[must_use]
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Each vector times its own number.
    #[must_use]
    #[inline(always)]
    pub fn scale(self, factor: Lanes) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl Add for Vectors {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Vectors {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Neg for Vectors {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}
