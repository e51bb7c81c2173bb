//! Lines that turn too often to be read: there a band between the lowest and the highest value.
//!
//! A line is divided into bins of x. A bin in which it turns [`MIN_TURNS`] times or more is dense;
//! [`MIN_BINS`] dense bins in a row become a band.

use crate::render::page::Position;

/// Width of a bin, mm. Chosen: a line that turns several times within it is a solid block.
const BIN: f64 = 2.0;
/// Number of turns that make a bin dense. Chosen: with three periods in 2 mm the line covers half the paper.
const MIN_TURNS: usize = 6;
/// Change of y below which a turn does not count, mm. Chosen: a smaller change is a rough line, no block.
const MIN_CHANGE: f64 = 1.0;
/// Number of dense bins that make a band. Chosen: shorter bands look like blots.
const MIN_BINS: usize = 3;

/// A part of a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Part {
    /// A line.
    Line(Vec<Position>),
    /// The upper and the lower border of a band.
    Band {
        /// Highest positions, from left to right.
        upper: Vec<Position>,
        /// Lowest positions, from left to right.
        lower: Vec<Position>,
    },
}

/// Lines and bands of a line with increasing x. Each part starts where the one before it ends.
pub(super) fn parts(positions: &[Position]) -> Vec<Part> {
    let bin = |position: &Position| libm::floor(position[0] / BIN);
    let bins: Vec<&[Position]> =
        positions.chunk_by(|a, b| bin(a).total_cmp(&bin(b)).is_eq()).collect();
    let dense: Vec<bool> = bins.iter().map(|bin| turns(bin) >= MIN_TURNS).collect();
    let mut parts: Vec<Part> = Vec::new();
    let mut first = 0;
    let mut line: Vec<Position> = Vec::new();
    for run in dense.chunk_by(|a, b| a == b) {
        let bins = &bins[first..first + run.len()];
        first += run.len();
        if !run[0] || run.len() < MIN_BINS {
            line.extend(bins.iter().copied().flatten());
            continue;
        }
        // The line ends at the first position of the band.
        line.push(bins[0][0]);
        parts.push(Part::Line(std::mem::take(&mut line)));
        parts.push(band(bins));
        line.extend(bins[bins.len() - 1].last());
    }
    parts.push(Part::Line(line));
    parts
}

fn band(bins: &[&[Position]]) -> Part {
    let mut border = [Vec::new(), Vec::new()];
    for bin in bins {
        let ends = [bin[0][0], bin[bin.len() - 1][0]];
        let ys = || bin.iter().map(|position| position[1]);
        // On the page y grows downwards.
        let extremes = [ys().fold(f64::INFINITY, f64::min), ys().fold(f64::NEG_INFINITY, f64::max)];
        for (border, y) in border.iter_mut().zip(extremes) {
            border.push([0.5 * (ends[0] + ends[1]), y]);
        }
    }
    let [mut upper, mut lower] = border;
    let (first, last) = (bins[0][0], bins[bins.len() - 1]);
    for border in [&mut upper, &mut lower] {
        border.insert(0, first);
        border.extend(last.last());
    }
    Part::Band { upper, lower }
}

/// How often y turns by at least [`MIN_CHANGE`].
fn turns(positions: &[Position]) -> usize {
    let mut count = 0;
    let mut rising = None;
    let Some(mut extreme) = positions.first().map(|position| position[1]) else { return 0 };
    for [_, y] in positions {
        let change = y - extreme;
        if rising.is_none_or(|rising| rising == (change > 0.0)) {
            if change.abs() >= MIN_CHANGE || rising.is_some() {
                rising = Some(rising.unwrap_or(change > 0.0));
                extreme = *y;
            }
        } else if change.abs() >= MIN_CHANGE {
            count += 1;
            rising = Some(change > 0.0);
            extreme = *y;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of this period (mm) and amplitude (mm) over 100 mm.
    fn sine(period: f64, amplitude: f64) -> Vec<Position> {
        let y = |x: f64| 30.0 + amplitude * libm::sin(2.0 * std::f64::consts::PI * x / period);
        (0..10_000).map(|index| 0.01 * f64::from(index)).map(|x| [x, y(x)]).collect()
    }

    #[test]
    fn only_fast_and_large_oscillations_become_a_band() {
        for (period, amplitude, band) in [(20.0, 10.0, false), (0.5, 0.1, false), (0.5, 10.0, true)]
        {
            let parts = parts(&sine(period, amplitude));
            let bands = parts.iter().filter(|part| matches!(part, Part::Band { .. })).count();
            assert_eq!(bands > 0, band, "{period} {amplitude}");
        }
    }

    #[test]
    fn a_band_reaches_the_extremes_and_joins_its_lines() {
        // Slow, fast, slow.
        let mut positions = sine(20.0, 5.0);
        positions[4000..6000].copy_from_slice(&sine(0.4, 8.0)[4000..6000]);
        let parts = parts(&positions);
        let [Part::Line(before), Part::Band { upper, lower }, Part::Line(after)] = parts.as_slice()
        else {
            panic!("{} parts", parts.len());
        };
        let same = |a: Position, b: Position| a.map(f64::to_bits) == b.map(f64::to_bits);
        assert!(same(before[before.len() - 1], upper[0]) && same(upper[0], lower[0]));
        assert!(same(after[0], upper[upper.len() - 1]));
        let least = upper.iter().map(|position| position[1]).fold(f64::INFINITY, f64::min);
        let most = lower.iter().map(|position| position[1]).fold(f64::NEG_INFINITY, f64::max);
        assert!((least - 22.0).abs() < 0.05 && (most - 38.0).abs() < 0.05, "{least} {most}");
    }
}
