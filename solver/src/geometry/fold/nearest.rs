//! Nearest feasible values of an infeasible design, one for each key that can help.

use super::scan::{BOTH, nearest_real, nearest_whole};
use super::{Fit, FoldDesign, FoldPattern, Nearest, fit};

/// Keys of a design that the search may change.
const KEYS: [&str; 6] = ["M", "N", "height", "top_radius", "bottom_radius", "alpha1_over_phi"];

/// The value of a key; `None` where the design has none.
fn value(design: &FoldDesign, key: &str) -> Option<f64> {
    match key {
        "M" => Some(f64::from(design.storeys)),
        "N" => Some(f64::from(design.panels)),
        "height" => design.height,
        "top_radius" => design.top_radius,
        "bottom_radius" => Some(design.bottom_radius),
        _ => design.alpha1_over_phi,
    }
}

/// The design with another value of a key.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, 1 to 1000")]
fn with(design: &FoldDesign, key: &str, value: f64) -> FoldDesign {
    let mut changed = design.clone();
    match key {
        "M" => changed.storeys = value as u32,
        "N" => changed.panels = value as u32,
        "height" => changed.height = Some(value),
        "top_radius" => changed.top_radius = Some(value),
        "bottom_radius" => changed.bottom_radius = value,
        _ => changed.alpha1_over_phi = Some(value),
    }
    changed
}

/// Nearest feasible values of an infeasible design, at most one for each key, each for a change of that
/// key alone. A key without a feasible value in the range of [`super::scan`] is omitted.
pub(super) fn feasible_values(design: &FoldDesign) -> Vec<Nearest> {
    let nearest = |key: &'static str| {
        let start = value(design, key)?;
        let feasible = |value: f64| {
            let changed = with(design, key, value);
            fit::check(&changed).is_ok() && fit::height_shortfall(&changed).is_none()
        };
        let value = match key {
            "M" | "N" => nearest_whole(start, feasible),
            // Another bottom radius means another cone, so it helps only where the fit solves the cone.
            "bottom_radius" if design.fit != Fit::Height => None,
            _ => nearest_real(start, &BOTH, feasible),
        }?;
        // A pattern that closes may still not fold to the requested stowed height.
        FoldPattern::close(&with(design, key, value)).is_ok().then_some(Nearest { key, value })
    };
    KEYS.into_iter().filter_map(nearest).collect()
}
