//! How far the nodes move between two frames, the mean motion of the film taken off.
//!
//! ```text
//! max over nodes of |u − ū|
//! ```
//!
//! Symbols: u displacement of a node, ū mean of all displacements, m. Two primitives that move by the
//! same ū approach each other only by what remains.

use crate::geometry::field::Field;

/// The mean displacement of all nodes between two frames, m; zero along an axis on which it is not
/// finite.
pub fn mean_displacement(from: &Field, to: &Field) -> [f64; 3] {
    let mean = |from: &[f64], to: &[f64]| {
        let mut sums = [0.0; 8];
        let ((groups, rest), (others, other_rest)) = (from.as_chunks::<8>(), to.as_chunks::<8>());
        for (x, y) in groups.iter().zip(others) {
            for lane in 0..8 {
                sums[lane] += y[lane] - x[lane];
            }
        }
        for (sum, (x, y)) in sums.iter_mut().zip(rest.iter().zip(other_rest)) {
            *sum += y - x;
        }
        let mean = sums.iter().sum::<f64>() / from.len() as f64;
        if mean.is_finite() { mean } else { 0.0 }
    };
    [mean(&from.x, &to.x), mean(&from.y, &to.y), mean(&from.z, &to.z)]
}

/// The largest displacement between two frames less the mean, m; NaN if one is NaN.
pub fn largest_motion(from: &Field, to: &Field) -> f64 {
    largest_deviation(to, 1.0, from, from)
}

/// The largest distance of a node from its place on the straight motion between two frames at time
/// `t` from 0 to 1, less the mean, m; NaN if one is NaN.
pub fn largest_deviation(frame: &Field, t: f64, from: &Field, to: &Field) -> f64 {
    let mut place = [0.0; 3];
    let chord = mean_displacement(from, to);
    for (axis, mean) in mean_displacement(from, frame).into_iter().enumerate() {
        place[axis] = mean - t * chord[axis];
    }
    let mut squares = [0.0_f64; 8];
    for node in 0..frame.len() {
        let mut squared = 0.0;
        for (mean, [x, y, z]) in place.iter().zip([
            [&frame.x, &from.x, &to.x],
            [&frame.y, &from.y, &to.y],
            [&frame.z, &from.z, &to.z],
        ]) {
            let (x, y, z) = (x[node], y[node], z[node]);
            let deviation = (x - y) - t * (z - y) - mean;
            squared += deviation * deviation;
        }
        let largest = &mut squares[node % 8];
        // A NaN stays.
        *largest = if squared > *largest || squared.is_nan() { squared } else { *largest };
    }
    let mut largest = 0.0_f64;
    for squared in squares {
        largest = if squared > largest || squared.is_nan() { squared } else { largest };
    }
    largest.sqrt()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_common_motion_is_no_motion_and_a_bend_is_one() {
        let from = Field::of(&[Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()]);
        let shifted: Vec<_> = from.iter().map(|x| x + Vector3::new(3.0, -2.0, 0.5)).collect();
        let mut to = Field::of(&shifted);
        assert!(largest_motion(&from, &to) < 1e-15);
        let mut middle = from.clone();
        middle.set(2, Vector3::new(0.0, 1.0, 0.4));
        assert!((largest_deviation(&middle, 0.5, &from, &to) - 0.3).abs() < 1e-15);
        to.set(2, to.get(2) + Vector3::new(4.0, 0.0, 0.0));
        assert!((largest_motion(&from, &to) - 3.0).abs() < 1e-14);
        to.set(3, Vector3::repeat(f64::NAN));
        assert!(largest_motion(&from, &to).is_nan());
    }
}
