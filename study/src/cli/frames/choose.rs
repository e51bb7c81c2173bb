//! Which of the stored frames a filmstrip shows.

use crate::cli::picture::{self, refused};
use crate::platform::error::Result;

/// Most frames in one picture. Chosen: more are too small to see.
const MAX_FRAMES: usize = 64;

/// Fraction of a time by which the nearest frame may differ without a message.
const MAX_TIME_ERROR: f64 = 0.02;
/// Weight of equal numbers of frames against equal displacements in [`by_displacement`]. Chosen: a film at
/// rest still gets a few frames.
const UNIFORM_WEIGHT: f64 = 0.1;

/// Numbers of `count` frames, with the first and the last among them and about equal displacement between
/// them; one frame is the last. `displacements` are those to each frame but the first, m.
pub(super) fn by_displacement(count: usize, displacements: &[f64]) -> Result<Vec<usize>> {
    if count == 0 || count > MAX_FRAMES {
        let allowed = format!("1 to {MAX_FRAMES}");
        return Err(refused("--count", &count.to_string(), "not a number of frames", &allowed));
    }
    let last = displacements.len();
    if count == 1 {
        return Ok(vec![last]);
    }
    if count > last {
        return Ok((0..=last).collect());
    }
    // Each frame adds a part of the mean displacement, which also avoids a division by zero.
    let total: f64 = displacements.iter().sum();
    let uniform = if total > 0.0 { UNIFORM_WEIGHT * total / last as f64 } else { 1.0 };
    let mut reached = vec![0.0];
    for displacement in displacements {
        reached.push(reached[reached.len() - 1] + displacement + uniform);
    }
    let mut numbers = vec![0];
    for k in 1..count - 1 {
        let wanted = reached[last] * k as f64 / (count - 1) as f64;
        let distance = |number: &usize| (reached[*number] - wanted).abs();
        // Leave enough frames for the next numbers.
        let first = numbers[k - 1] + 1;
        let nearest =
            (first..=last - (count - 1 - k)).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        numbers.push(nearest.unwrap_or(first));
    }
    numbers.push(last);
    Ok(numbers)
}

/// Numbers of the frames nearest to these times, in order, without repetition.
pub(super) fn nearest(texts: &[String], stored: &[f64], quiet: bool) -> Result<Vec<usize>> {
    let (first, last) = (stored[0], stored[stored.len() - 1]);
    let mut numbers = Vec::with_capacity(texts.len());
    for text in texts.iter().map(|text| text.trim()) {
        let time = picture::seconds("--times", text)?;
        // A printed time is rounded and may be slightly after the last frame.
        let slack = 1e-6 * (last - first);
        if !(first - slack..=last + slack).contains(&time) {
            let allowed = format!("{first} to {last} s ({} frames)", stored.len());
            return Err(refused("--times", text, "no frame at this time", &allowed));
        }
        let distance = |number: &usize| (stored[*number] - time).abs();
        let nearest =
            (0..stored.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        let error = (stored[nearest] - time).abs();
        if error > MAX_TIME_ERROR * time.abs().max(1e-9) && !quiet {
            eprintln!(
                "billow: --times {text}: the nearest stored frame is at {} s",
                crate::input::value::short_number(stored[nearest])
            );
        }
        numbers.push(nearest);
    }
    let asked = numbers.len();
    numbers.sort_unstable();
    numbers.dedup();
    if numbers.len() > MAX_FRAMES {
        let problem = "too many frames for one picture";
        let allowed = format!("at most {MAX_FRAMES}");
        return Err(refused("--times", &asked.to_string(), problem, &allowed));
    }
    if numbers.len() < asked && !quiet {
        eprintln!(
            "billow: {} of these {asked} times have the frame of another time; {} frames are stored (outputs.frames)",
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
        fn chosen_frames_increase_from_the_first_to_the_last(
            count in 1_usize..=MAX_FRAMES, displacements in prop::collection::vec(0.0..1.0_f64, 0..300),
        ) {
            let numbers = by_displacement(count, &displacements).unwrap();
            prop_assert_eq!(numbers.len(), count.min(displacements.len() + 1));
            prop_assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert_eq!(*numbers.last().unwrap(), displacements.len());
            prop_assert!(count == 1 || numbers[0] == 0);
        }
    }

    #[test]
    fn most_frames_are_where_the_film_moves() {
        // Ten frames of motion, then ninety of rest.
        let displacements: Vec<f64> = (0..99).map(|k| if k < 10 { 0.1 } else { 0.0 }).collect();
        let numbers = by_displacement(8, &displacements).unwrap();
        assert!(numbers.iter().filter(|number| **number <= 10).count() >= 6, "{numbers:?}");
        // Film that never moves: equal intervals.
        assert_eq!(by_displacement(5, &[0.0; 8]).unwrap(), [0, 2, 4, 6, 8]);
        assert!(by_displacement(0, &displacements).is_err());
        assert!(by_displacement(MAX_FRAMES + 1, &displacements).is_err());
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
