//! Nearest feasible values of an infeasible design, one for each key that can help.

use super::scan::{BOTH, nearest_real, nearest_whole};
use super::{Fit, FoldDesign, FoldPattern, Nearest, fit};

/// A key of a design that the search may change.
struct AdjustableKey {
    key: &'static str,
    /// Whether its value is a whole number.
    whole: bool,
    get: fn(&FoldDesign) -> Option<f64>,
    set: fn(&mut FoldDesign, f64),
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, 1 to 1000")]
const ADJUSTABLE_KEYS: [AdjustableKey; 6] = [
    AdjustableKey {
        key: "M",
        whole: true,
        get: |d| Some(f64::from(d.storeys)),
        set: |d, value| d.storeys = value as u32,
    },
    AdjustableKey {
        key: "N",
        whole: true,
        get: |d| Some(f64::from(d.panels)),
        set: |d, value| d.panels = value as u32,
    },
    AdjustableKey {
        key: "height",
        whole: false,
        get: |d| d.height,
        set: |d, value| d.height = Some(value),
    },
    AdjustableKey {
        key: "top_radius",
        whole: false,
        get: |d| d.top_radius,
        set: |d, value| d.top_radius = Some(value),
    },
    AdjustableKey {
        key: "bottom_radius",
        whole: false,
        get: |d| Some(d.bottom_radius),
        set: |d, value| d.bottom_radius = value,
    },
    AdjustableKey {
        key: "alpha1_over_phi",
        whole: false,
        get: |d| d.alpha1_over_phi,
        set: |d, value| d.alpha1_over_phi = Some(value),
    },
];

/// Nearest feasible values of an infeasible design, at most one for each key, each for a change of that
/// key alone. A key without a feasible value in the range of [`super::scan`] is omitted.
pub(super) fn feasible_values(design: &FoldDesign) -> Vec<Nearest> {
    ADJUSTABLE_KEYS
        .iter()
        // Another bottom radius means another cone, so it helps only where the fit solves the cone.
        .filter(|adjustable| design.fit == Fit::Height || adjustable.key != "bottom_radius")
        .filter_map(|adjustable| {
            let start = (adjustable.get)(design)?;
            let feasible = |value: f64| {
                let mut changed = design.clone();
                (adjustable.set)(&mut changed, value);
                fit::check(&changed).is_ok() && fit::height_shortfall(&changed).is_none()
            };
            let value = if adjustable.whole {
                nearest_whole(start, feasible)
            } else {
                nearest_real(start, &BOTH, feasible)
            };
            value.map(|value| (adjustable, Nearest { key: adjustable.key, value }))
        })
        // A pattern that closes may still not fold to the requested stowed height.
        .filter(|(adjustable, nearest)| {
            let mut changed = design.clone();
            (adjustable.set)(&mut changed, nearest.value);
            FoldPattern::close(&changed).is_ok()
        })
        .map(|(_, nearest)| nearest)
        .collect()
}
