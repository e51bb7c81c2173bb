//! Eight 3-vectors at a time, stored component by component.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use core::ops::{Add, Neg, Sub};

use super::{Lanes, Wide};

/// Eight vectors, one a lane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vectors<L = Lanes> {
    /// x components.
    pub x: L,
    /// y components.
    pub y: L,
    /// z components.
    pub z: L,
}

impl<L: Wide> Vectors<L> {
    /// Scalar products, lane by lane.
    #[inline(always)]
    pub fn dot(self, other: Self) -> L {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Cross products, lane by lane.
    #[must_use]
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Each vector times the factor of its lane.
    #[must_use]
    #[inline(always)]
    pub fn scale(self, factor: L) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<L: Wide> Add for Vectors<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<L: Wide> Sub for Vectors<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<L: Wide> Neg for Vectors<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}
