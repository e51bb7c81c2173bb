//! The fold pattern of a design, solved once for all points that share it.

use billow_solver::geometry::fold::{FoldDesign, FoldError, FoldPattern};

use crate::job::point::Infeasible;

/// The pattern of a design, or why it has none.
#[derive(Debug)]
pub(super) enum Fold {
    Solved(Box<FoldPattern>),
    Infeasible(Infeasible),
    /// The design contradicts itself.
    Invalid {
        key: &'static str,
        problem: String,
    },
}

/// Solves a design.
pub(super) fn solve(design: &FoldDesign) -> Fold {
    match FoldPattern::new(design) {
        Ok(pattern) => Fold::Solved(Box::new(pattern)),
        Err(FoldError::Infeasible { reason, nearest }) => {
            Fold::Infeasible(Infeasible { reason, nearest })
        }
        Err(FoldError::Invalid { key, problem }) => Fold::Invalid { key, problem },
    }
}

/// The bits of a design, to find its fold again.
pub(super) type DesignKey = [u64; 12];

/// The bits of a design.
pub(super) fn design_key(design: &FoldDesign) -> DesignKey {
    // No key allows NaN, so its bits stand for an absent value.
    let bits = |value: Option<f64>| value.unwrap_or(f64::NAN).to_bits();
    [
        design.fit as u64,
        design.panels.into(),
        design.storeys.into(),
        design.bottom_radius.to_bits(),
        bits(design.top_radius),
        bits(design.height),
        bits(design.half_angle),
        bits(design.alpha1_over_phi),
        design.chirality as u64,
        design.stowed_height.to_bits(),
        design.subdivisions.into(),
        design.caps as u64,
    ]
}
