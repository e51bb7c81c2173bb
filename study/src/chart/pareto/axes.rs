//! The axes of work-precision diagrams: whole decades that hold every point.

use crate::analysis::work_precision::peer::Peer;
use crate::analysis::work_precision::{Cost, Diagram, Errors};
use crate::input::value::short_number;
use crate::render::figure::plot::Axis;
use crate::render::figure::scale::Spread;
use crate::render::figure::ticks::{Tick, minus};

/// Label of the y axis.
pub(super) const ERROR: &str = "Relative error";
/// Least error that is drawn. Chosen: rounding.
const MIN_ERROR: f64 = 1e-15;
/// Distance of the crosses of failed configurations from the upper end of an axis, as a part of its length.
const TOP_SHARE: f64 = 0.04;
/// Part of a decade that stays free at the ends of an axis.
const PADDING: f64 = 0.12;

/// Ranges of both axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axes {
    /// Cost.
    cost: [f64; 2],
    /// Error.
    pub(super) error: [f64; 2],
}

/// The label of the x axis.
pub(super) fn label_of(per_simulated_second: bool, cost: Cost) -> String {
    match (cost, per_simulated_second) {
        (Cost::Work, _) => "Work, element-steps".to_owned(),
        (Cost::Seconds, true) => "Wall time a simulated second on one thread, s".to_owned(),
        (Cost::Seconds, false) => "Wall time on one thread, s".to_owned(),
    }
}

impl Axes {
    /// The axes of some errors of some diagrams.
    pub(super) fn of(
        diagrams: &[(&Diagram, Vec<&Errors>)],
        cost: Cost,
        peer: Option<&Peer>,
    ) -> Self {
        let (mut costs, mut errors) = (Vec::new(), Vec::new());
        for (diagram, list) in diagrams {
            for one in list {
                let points = one.points.iter().zip(&diagram.members);
                for (point, member) in points {
                    let Some(cost) = member.cost(cost) else { continue };
                    if let Some(point) = point {
                        costs.push(cost);
                        errors.extend([point.error.median, point.error.largest]);
                    } else if member.ending.is_failure() {
                        costs.push(cost);
                    }
                }
                errors.push(one.uncertainty());
            }
            let points = peer.map(|peer| peer.points(diagram)).unwrap_or_default();
            costs.extend(points.iter().flat_map(|point| point.seconds));
        }
        Self { cost: padded(&costs, 0.0), error: padded(&errors, MIN_ERROR) }
    }

    /// The x axis.
    pub(super) fn x(&self, label: &str) -> Axis {
        Axis {
            label: label.to_owned(),
            spread: Spread::Logarithmic,
            range: self.cost,
            ticks: decades(self.cost),
            names: false,
        }
    }

    /// The same axis of cost, with the errors of another one.
    pub(super) fn with_errors_of(self, other: &Self) -> Self {
        Self { error: other.error, ..self }
    }

    /// Where configurations without a result stand: just below the upper end of the axis of errors.
    pub(super) fn top(&self) -> f64 {
        let [low, high] = self.error;
        high * libm::pow(low / high, TOP_SHARE)
    }

    /// An error within the axis.
    pub(super) fn inside(&self, error: f64) -> f64 {
        error.clamp(self.error[0], self.error[1])
    }
}

/// A tick at every decade, or at every few: at most four.
fn decades([low, high]: [f64; 2]) -> Vec<Tick> {
    let (first, last) = (libm::ceil(libm::log10(low)), libm::floor(libm::log10(high)));
    let stride = libm::ceil((last - first + 1.0) / 4.0).max(1.0);
    let mut ticks = Vec::new();
    let mut exponent = first;
    while exponent <= last {
        let value = libm::pow(10.0, exponent);
        let plain = (-2.0..=3.0).contains(&exponent);
        let text = if plain { short_number(value) } else { minus(&format!("1e{exponent}")) };
        ticks.push((value, text));
        exponent += stride;
    }
    ticks
}

/// The range of the positive values above a least one, with padding; a decade if there are none.
fn padded(values: &[f64], least: f64) -> [f64; 2] {
    let used = values.iter().copied().filter(|value| value.is_finite() && *value > least);
    let (low, high) = used.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return [0.1, 1.0];
    }
    let [low, high] = [libm::log10(low), libm::log10(high)];
    let free = PADDING.max(0.06 * (high - low));
    // At least a decade, so that its ticks are numbers of one digit.
    let missing = (1.0 - (high - low)).max(0.0);
    [libm::pow(10.0, low - free - 0.5 * missing), libm::pow(10.0, high + free + 0.5 * missing)]
}

/// Why a panel has no points.
pub(super) fn nothing(errors: &Errors) -> &'static str {
    if errors.reference.is_none() {
        "no trusted configuration has run"
    } else {
        "nothing to compare with the reference"
    }
}
