//! Which of the stored frames a strip shows.

use crate::cli::picture::{self, refused};
use crate::platform::error::Result;

/// Frames on one picture, at most.
const MOST: usize = 64;

/// Numbers of `count` frames, first and last among them, between which the film moves equally far, as
/// near as those stored allow; of one, the last. `ways`: how far it moved to each frame but the first, m.
pub(super) fn by_motion(count: usize, ways: &[f64]) -> Result<Vec<usize>> {
    if count == 0 || count > MOST {
        let allowed = format!("1 to {MOST}");
        return Err(refused("--count", &count.to_string(), "no such picture", &allowed));
    }
    let last = ways.len();
    if count == 1 {
        return Ok(vec![last]);
    }
    if count > last {
        return Ok((0..=last).collect());
    }
    // A share of the number of frames too: film at rest is seen to be at rest, and nought divides nothing.
    let whole: f64 = ways.iter().sum();
    let even = if whole > 0.0 { STILL * whole / last as f64 } else { 1.0 };
    let mut reached = vec![0.0];
    for way in ways {
        reached.push(reached[reached.len() - 1] + way + even);
    }
    let mut numbers = vec![0];
    for k in 1..count - 1 {
        let wish = reached[last] * k as f64 / (count - 1) as f64;
        let distance = |number: &usize| (reached[*number] - wish).abs();
        // Enough are left for those to come.
        let from = numbers[k - 1] + 1;
        let nearest = (from..=last - (count - 1 - k))
            .min_by(|one, other| distance(one).total_cmp(&distance(other)));
        numbers.push(nearest.unwrap_or(from));
    }
    numbers.push(last);
    Ok(numbers)
}

/// Share of a time by which a frame may be off it without a word.
const NEAR: f64 = 0.02;
/// Weight of evenness over the frames beside that of motion.
const STILL: f64 = 0.1;

/// Numbers of the frames nearest to these times, in order, each once.
pub(super) fn nearest(texts: &[String], stored: &[f64], quiet: bool) -> Result<Vec<usize>> {
    let (first, last) = (stored[0], stored[stored.len() - 1]);
    let mut numbers = Vec::with_capacity(texts.len());
    for text in texts.iter().map(|text| text.trim()) {
        let time = picture::seconds("--times", text)?;
        // Written out, the last time may be a little more than it is.
        let slack = 1e-6 * (last - first);
        if !(first - slack..=last + slack).contains(&time) {
            let allowed = format!("{first} to {last} s, of which there are {}", stored.len());
            return Err(refused("--times", text, "no frame of that time", &allowed));
        }
        let distance = |number: &usize| (stored[*number] - time).abs();
        let nearest = (0..stored.len())
            .min_by(|one, other| distance(one).total_cmp(&distance(other)))
            .unwrap_or(0);
        let off = (stored[nearest] - time).abs();
        if off > NEAR * time.abs().max(1e-9) && !quiet {
            eprintln!(
                "billow: --times {text}: the nearest frame stored is that of {} s",
                crate::input::value::short_number(stored[nearest])
            );
        }
        numbers.push(nearest);
    }
    let asked = numbers.len();
    numbers.sort_unstable();
    numbers.dedup();
    if numbers.len() > MOST {
        let problem = "too many for one picture";
        return Err(refused("--times", &asked.to_string(), problem, &format!("at most {MOST}")));
    }
    if numbers.len() < asked && !quiet {
        eprintln!(
            "billow: {} of these {asked} times have a nearest frame that another has too; {} frames \
             are stored (outputs.frames)",
            asked - numbers.len(),
            stored.len()
        );
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn chosen_frames_rise_from_the_first_to_the_last(
            count in 1_usize..=MOST, ways in prop::collection::vec(0.0..1.0_f64, 0..300),
        ) {
            let numbers = by_motion(count, &ways).unwrap();
            prop_assert_eq!(numbers.len(), count.min(ways.len() + 1));
            prop_assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert_eq!(*numbers.last().unwrap(), ways.len());
            prop_assert!(count == 1 || numbers[0] == 0);
        }
    }

    #[test]
    fn frames_lie_where_film_moves() {
        // Ten frames of motion, then ninety of rest.
        let ways: Vec<f64> = (0..99).map(|k| if k < 10 { 0.1 } else { 0.0 }).collect();
        let numbers = by_motion(8, &ways).unwrap();
        assert!(numbers.iter().filter(|number| **number <= 10).count() >= 6, "{numbers:?}");
        // Film that never moves: evenly.
        assert_eq!(by_motion(5, &[0.0; 8]).unwrap(), [0, 2, 4, 6, 8]);
        assert!(by_motion(0, &ways).is_err() && by_motion(MOST + 1, &ways).is_err());
    }

    #[test]
    fn times_take_the_nearest_frame_and_carry_units() {
        let stored = [0.0, 0.01, 0.02, 0.5];
        let texts =
            |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>();
        let found = nearest(&texts(&["0.5", " 12 ms", "0", "0.011"]), &stored, true).unwrap();
        assert_eq!(found, [0, 1, 3]);
        for wrong in ["-1", "0.6", "nan", "5 kg", "soon", ""] {
            let error = nearest(&texts(&[wrong]), &stored, true).unwrap_err().to_string();
            assert!(error.starts_with("--times"), "{error}");
            assert!(error.contains("allowed: "), "{error}");
        }
    }
}
