//! The nearest feasible value of a key, when a design is infeasible.

use super::{Fit, FoldDesign, FoldPattern, fit};

/// A single change that makes an infeasible design feasible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Key of [`crate::fold::FoldDesign`], as in JSON.
    pub key: &'static str,
    /// Nearest feasible value, SI.
    pub value: f64,
}

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
                fit::check(&changed).is_ok() && fit::obstacle(&changed).is_none()
            };
            let value =
                if knob.whole { whole(start, feasible) } else { real(start, &BOTH_WAYS, feasible) };
            value.map(|value| (knob, Nearest { key: knob.key, value }))
        })
        // A pattern that closes may still not pack to the stowed height asked for.
        .filter(|(knob, near)| {
            let mut changed = design.clone();
            (knob.set)(&mut changed, near.value);
            FoldPattern::new(&changed).is_ok()
        })
        .map(|(_, near)| near)
        .collect()
}

fn whole(start: f64, feasible: impl Fn(f64) -> bool) -> Option<f64> {
    (1..64).find_map(|step| {
        let step = f64::from(step);
        [start + step, start - step].into_iter().find(|value| *value > 0.0 && feasible(*value))
    })
}

/// The largest feasible value below one that is not; `None` if there is none within a factor of a
/// million.
pub(super) fn below(start: f64, feasible: impl Fn(f64) -> bool) -> Option<f64> {
    real(start, &[false], feasible)
}

/// Upward first.
const BOTH_WAYS: [bool; 2] = [true, false];

fn real(start: f64, ways: &[bool], feasible: impl Fn(f64) -> bool) -> Option<f64> {
    let mut factor = 1.0;
    while factor < 1e6 {
        let previous = factor;
        // Near, a narrow range must not be stepped over; far off the edge alone is looked for.
        factor *= if factor < 50.0 { 1.02 } else { 1.5 };
        for up in ways.iter().copied() {
            let at = |factor: f64| if up { start * factor } else { start / factor };
            if !feasible(at(factor)) {
                continue;
            }
            let (mut outside, mut inside) = (previous, factor);
            for _ in 0..40 {
                let middle = 0.5 * (outside + inside);
                if feasible(at(middle)) { inside = middle } else { outside = middle }
            }
            return Some(rounded(at(inside), up, &feasible).unwrap_or_else(|| at(inside)));
        }
    }
    None
}

/// The edge of the feasible range rounded into it, to the fewest digits (3 or more) that stay near.
fn rounded(edge: f64, up: bool, feasible: impl Fn(f64) -> bool) -> Option<f64> {
    let magnitude = libm::floor(libm::log10(edge));
    (3_u8..9).find_map(|digits| {
        let unit = libm::pow(10.0, magnitude - f64::from(digits - 1));
        let whole = if up { libm::ceil(edge / unit) } else { libm::floor(edge / unit) };
        // Through text, so that the value prints with those digits.
        let value: f64 = format!("{:.*e}", usize::from(digits - 1), whole * unit).parse().ok()?;
        feasible(value).then_some(value)
    })
}
