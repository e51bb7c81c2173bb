//! A solved fold pattern.

use super::{FoldDesign, FoldError, PanelAngles};

/// A fold design that closes: every angle and length of it.
#[derive(Debug, Clone, PartialEq)]
pub struct FoldPattern {
    /// The design asked for.
    pub design: FoldDesign,
    /// Half top angle φh, rad; negative for a capsule that widens upward.
    pub half_angle: f64,
    /// Angles of a panel.
    pub angles: PanelAngles,
    /// r2, m.
    pub bottom_radius: f64,
    /// r1, m.
    pub top_radius: f64,
    /// H, height of the erected cone, m.
    pub height: f64,
}

/// Edge lengths of a panel, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lengths {
    /// Outer ring edge.
    pub ab: f64,
    /// Inner ring edge.
    pub de: f64,
    /// Panel side.
    pub ad: f64,
    /// Diagonal.
    pub ae: f64,
}

impl FoldPattern {
    /// Solves a design.
    ///
    /// # Errors
    /// [`FoldError::Invalid`] for a request out of range or contradicting itself,
    /// [`FoldError::Infeasible`] for one no pattern meets.
    pub fn new(design: &FoldDesign) -> Result<Self, FoldError> {
        todo!("{design:?}")
    }

    /// Edge lengths of the panels of storey `storey` (0 is the lowest).
    pub fn lengths(&self, storey: u32) -> Lengths {
        todo!("{storey}")
    }

    /// How far the flat-folded ring misses closing on itself, relative to |AB| (a pure number).
    pub fn closure_defect(&self) -> f64 {
        todo!()
    }

    /// Fraction of the capsule's height at which ring `ring` sits when erected: 0 at the bottom
    /// ring, 1 at the top ring.
    pub fn height_fraction(&self, ring: u32) -> f64 {
        todo!("{ring}")
    }

    /// Turn of ring `storey + 1` against ring `storey` when flat folded, rad, counter-clockwise.
    pub fn flat_twist(&self) -> f64 {
        todo!()
    }

    /// The same, erected.
    pub fn erected_twist(&self) -> f64 {
        todo!()
    }

    /// Radius of the clear opening of a flat-folded storey, m.
    pub fn opening_radius(&self, storey: u32) -> f64 {
        todo!("{storey}")
    }

    /// Area of the two facets (ABE, AED) of one panel of a storey, m².
    pub fn facet_areas(&self, storey: u32) -> [f64; 2] {
        todo!("{storey}")
    }

    /// Developed area of the lateral film, m².
    pub fn lateral_area(&self) -> f64 {
        todo!()
    }

    /// Area of the N-gon spanned by ring `ring`, m².
    pub fn cap_area(&self, ring: u32) -> f64 {
        todo!("{ring}")
    }

    /// Volume enclosed by the stowed shape at stack height `height`, m³.
    pub fn stowed_volume(&self, height: f64) -> f64 {
        todo!("{height}")
    }

    /// Volume of the erected cone, m³.
    pub fn erected_volume(&self) -> f64 {
        todo!()
    }
}
