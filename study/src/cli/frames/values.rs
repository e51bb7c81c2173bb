//! Sampled values below the shapes of a picture, and the quantities that its colours show.

use billow_solver::output::frames::Frame;
use billow_solver::output::history::{HEIGHT, History};

use crate::input::value::short_number;
use crate::render::figure::ticks::minus;
use crate::render::figure::unit::Unit;
use crate::render::filmstrip::Quantity;

/// Most frames with all values below them. Chosen: three lines below more shapes take their space.
pub(super) const MAX_WITH_VALUES: usize = 16;
/// Fraction of the elements whose values are within the colour scale. Chosen: a few elements at a corner of
/// the folded film would leave one colour for all others.
const WITHIN_SCALE: f64 = 0.99;

/// The lines below each frame: its time, and for at most `most` frames height and pressure at its sample; and their
/// meaning.
pub(super) fn below(
    frames: &[Frame],
    history: &History,
    most: usize,
) -> (Vec<Vec<String>>, Option<String>) {
    // The unit of most frames: the last one may be much later.
    let middle = frames.get(frames.len() / 2).map_or(0.0, |frame| frame.time);
    let seconds = Unit::of("s", middle.max(1e-3));
    let time = |frame: &Frame| seconds.after(&significant(seconds.shown(frame.time), 4));
    if frames.len() > most {
        return (frames.iter().map(|frame| vec![time(frame)]).collect(), None);
    }
    let rings = history.has_rings();
    let column = if rings { "z_rim" } else { HEIGHT };
    let times = history.column("time");
    let sample = |frame: &Frame| times.iter().position(|time| *time >= frame.time);
    let samples: Vec<Option<usize>> = frames.iter().map(sample).collect();
    let values = |name: &str| -> Vec<Option<f64>> {
        let values = history.column(name);
        samples.iter().map(|sample| values.get((*sample)?).copied()).collect()
    };
    let (heights, pressures) = (values(column), values("pressure"));
    let metre = Unit::fit("m", heights.iter().copied().flatten());
    let pascal = Unit::fit("Pa", pressures.iter().copied().flatten());
    let texts = |symbol: &str, unit: &Unit, values: &[Option<f64>]| -> Vec<Option<String>> {
        let shown = |value: &f64| unit.shown(*value);
        let largest = values.iter().flatten().map(shown).map(f64::abs).fold(0.0, f64::max);
        let decimals = decimals(largest);
        let text =
            |value: f64| format!("{symbol} = {}", unit.after(&format!("{value:.decimals$}")));
        values.iter().map(|value| value.as_ref().map(shown).map(text)).collect()
    };
    let (heights, pressures) = (texts("z", &metre, &heights), texts("p", &pascal, &pressures));
    let lines = frames.iter().zip(heights.into_iter().zip(pressures));
    let lines = lines.map(|(frame, (height, pressure))| {
        let t = Some(format!("t = {}", time(frame)));
        [t, height, pressure].into_iter().flatten().map(|text| minus(&text)).collect()
    });
    let height = if rings { "height of the top ring" } else { "height of the whole film" };
    (lines.collect(), Some(format!("t: time, z: {height} ({column}), p: gas pressure (pressure)")))
}

/// The decimals with which the largest number of a row has three significant digits.
fn decimals(largest: f64) -> usize {
    let steps = [(100.0, 0), (10.0, 1), (1.0, 2)];
    steps.iter().find(|(least, _)| largest >= *least).map_or(3, |(_, decimals)| *decimals)
}

/// A number with some significant digits.
fn significant(number: f64, digits: usize) -> String {
    let decimals = digits.saturating_sub(1);
    let rounded: f64 = format!("{number:.decimals$e}").parse().unwrap_or(number);
    short_number(rounded)
}

/// The largest principal stress of each element.
pub(super) fn stress(frames: &[Frame]) -> Quantity {
    let of_frame = |frame: &Frame| -> Vec<f64> {
        frame.stresses.iter().map(|stress| f64::from(stress[0])).collect()
    };
    let values = frames.iter().map(of_frame).collect();
    quantity("Largest principal stress", "Pa", values)
}

/// The speed of each element, the mean of its nodes.
pub(super) fn speed(frames: &[Frame], triangles: &[[u32; 3]]) -> Quantity {
    let speed = |frame: &Frame, node: u32| {
        let [x, y, z] = frame.velocities[node as usize].map(f64::from);
        (x * x + y * y + z * z).sqrt()
    };
    let of_frame = |frame: &Frame| -> Vec<f64> {
        let mean =
            |nodes: &[u32; 3]| nodes.iter().map(|node| speed(frame, *node)).sum::<f64>() / 3.0;
        triangles.iter().map(mean).collect()
    };
    quantity("Speed", "m/s", frames.iter().map(of_frame).collect())
}

/// A quantity on a scale from zero that contains [`WITHIN_SCALE`] of all values.
fn quantity(name: &str, si: &str, values: Vec<Vec<f64>>) -> Quantity {
    let mut sorted: Vec<f64> = values.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    let largest = sorted.last().copied().unwrap_or_default();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let within = (sorted.len().saturating_sub(1) as f64 * WITHIN_SCALE) as usize;
    let within = sorted.get(within).copied().unwrap_or_default();
    // Film without stress or motion still has a scale.
    let end = if within > 0.0 { within } else { largest.max(0.0) };
    let unit = Unit::fit(si, [end]);
    let end = if end > 0.0 { unit.shown(end) } else { 1.0 };
    let beyond = if unit.shown(largest) > end {
        let largest = significant(unit.shown(largest), 3);
        format!("; 1 % of the values are above the scale, up to {largest}")
    } else {
        String::new()
    };
    Quantity {
        label: format!("{}{beyond}", unit.label(name)),
        values: values
            .into_iter()
            .map(|values| values.into_iter().map(|value| unit.shown(value)).collect())
            .collect(),
        range: [0.0, end],
    }
}

#[cfg(test)]
mod tests {
    use billow_solver::mechanics::material::Regime;
    use billow_solver::output::history::COLUMNS;

    use super::*;

    fn frame(time: f64, stress: f32) -> Frame {
        Frame {
            time,
            positions: vec![[0.0; 3]; 3],
            regimes: vec![Regime::Taut],
            velocities: vec![[3.0, 0.0, 4.0]; 3],
            stresses: vec![[stress, 0.0]],
            gaps: Vec::new(),
        }
    }

    #[test]
    fn the_values_below_a_shape_are_those_of_its_sample() {
        let mut history = History::new();
        for sample in 0..3_u32 {
            let row = COLUMNS.iter().map(|column| match column.name {
                "time" => 0.01 * f64::from(sample),
                "z_rim" => 0.1 + 0.123_456 * f64::from(sample),
                "pressure" => 100.0 * f64::from(sample),
                _ => 0.0,
            });
            history.push(&row.collect::<Vec<_>>().try_into().unwrap());
        }
        let (lines, meaning) =
            below(&[frame(0.0, 0.0), frame(0.02, 0.0)], &history, MAX_WITH_VALUES);
        assert_eq!(lines[0], ["t = 0 ms", "z = 0.100 m", "p = 0 Pa"]);
        assert_eq!(lines[1], ["t = 20 ms", "z = 0.347 m", "p = 200 Pa"]);
        assert!(meaning.unwrap().contains("z_rim"));
        let without = history.without_rings();
        assert!(
            below(&[frame(0.0, 0.0)], &without, MAX_WITH_VALUES).1.unwrap().contains("(height)")
        );
        let many: Vec<Frame> = (0..20).map(|_| frame(0.01, 0.0)).collect();
        let late =
            below(&[frame(0.0, 0.0), frame(0.01, 0.0), frame(1.0, 0.0)], &without, MAX_WITH_VALUES)
                .0;
        assert_eq!(late[2][0], "t = 1000 ms");
        assert!(below(&many, &without, MAX_WITH_VALUES).0.iter().all(|lines| lines == &["10 ms"]));
    }

    #[test]
    fn a_quantity_has_one_scale_for_all_frames() {
        let frames = [frame(0.0, 1e6), frame(0.1, 5e6)];
        let stress = stress(&frames);
        assert_eq!(stress.values, [[1.0], [5.0]]);
        assert!(stress.label.starts_with("Largest principal stress (MPa)"), "{}", stress.label);
        let speed = speed(&frames, &[[0, 1, 2]]);
        assert!((speed.values[1][0] - 5.0).abs() < 1e-12 && speed.label == "Speed (m/s)");
        assert!(super::stress(&[frame(0.0, 0.0)]).range[1] > 0.0);
    }
}
