//! Interpolation between two static shapes.

use crate::output::measures::{DESIGN_LOAD, StaticShape};

/// λ at which ln λ and λ/0.006 rise at the same rate. Chosen: between wrinkled film, whose volume rises with
/// ln λ, and stretched film, whose volume rises with λ.
const STRETCH_LOAD: f64 = 6e-3;

/// The shape at an overpressure (Pa) between two shapes, linear in q. `design_overpressure` (Pa) is that at
/// which p r/(E t) is [`DESIGN_LOAD`].
pub(super) fn between(
    design_overpressure: f64,
    [low, high]: [StaticShape; 2],
    overpressure: f64,
) -> StaticShape {
    let coordinate = |overpressure: f64| {
        let load = DESIGN_LOAD * overpressure / design_overpressure;
        libm::log(load) + load / STRETCH_LOAD
    };
    let [from, at, to] = [low.overpressure, overpressure, high.overpressure].map(coordinate);
    let fraction = (at - from) / (to - from);
    StaticShape {
        overpressure,
        volume: low.volume + fraction * (high.volume - low.volume),
        height: low.height + fraction * (high.height - low.height),
    }
}

/// The larger relative error of volume and height.
pub(super) fn relative_error(found: StaticShape, exact: StaticShape) -> f64 {
    let volume = (found.volume / exact.volume - 1.0).abs();
    volume.max((found.height / exact.height - 1.0).abs())
}
