//! The nearest feasible value of a key, when a design is infeasible.

use super::scan::{BOTH_WAYS, real, whole};
use super::{Fit, FoldDesign, FoldPattern, Nearest, fit};

/// A key that can be changed, and how.
struct Knob {
    key: &'static str,
    whole: bool,
    get: fn(&FoldDesign) -> Option<f64>,
    set: fn(&mut FoldDesign, f64),
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole, 1 to 1000")]
const KNOBS: [Knob; 6] = [
    Knob {
        key: "M",
        whole: true,
        get: |d| Some(f64::from(d.storeys)),
        set: |d, value| d.storeys = value as u32,
    },
    Knob {
        key: "N",
        whole: true,
        get: |d| Some(f64::from(d.panels)),
        set: |d, value| d.panels = value as u32,
    },
    Knob { key: "height", whole: false, get: |d| d.height, set: |d, value| d.height = Some(value) },
    Knob {
        key: "top_radius",
        whole: false,
        get: |d| d.top_radius,
        set: |d, value| d.top_radius = Some(value),
    },
    Knob {
        key: "bottom_radius",
        whole: false,
        get: |d| Some(d.bottom_radius),
        set: |d, value| d.bottom_radius = value,
    },
    Knob {
        key: "alpha1_over_phi",
        whole: false,
        get: |d| d.alpha1_over_phi,
        set: |d, value| d.alpha1_over_phi = Some(value),
    },
];

/// Nearest feasible values of an infeasible design, one a key, each for a change of that key alone;
/// a key no change of which helps (whole numbers to 64, others within a factor of a million) is left
/// out.
pub(super) fn search(design: &FoldDesign) -> Vec<Nearest> {
    KNOBS
        .iter()
        // A cone of another bottom radius is another capsule; for `height` it is the size itself.
        .filter(|knob| design.fit == Fit::Height || knob.key != "bottom_radius")
        .filter_map(|knob| {
            let start = (knob.get)(design)?;
            let feasible = |value: f64| {
                let mut changed = design.clone();
                (knob.set)(&mut changed, value);
                fit::check(&changed).is_ok() && fit::shortfall(&changed).is_none()
            };
            let value =
                if knob.whole { whole(start, feasible) } else { real(start, &BOTH_WAYS, feasible) };
            value.map(|value| (knob, Nearest { key: knob.key, value }))
        })
        // A pattern that closes may still not pack to the stowed height asked for.
        .filter(|(knob, near)| {
            let mut changed = design.clone();
            (knob.set)(&mut changed, near.value);
            FoldPattern::close(&changed).is_ok()
        })
        .map(|(_, near)| near)
        .collect()
}
