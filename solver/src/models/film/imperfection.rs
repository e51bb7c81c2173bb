//! The imperfection of a stowed capsule, or of other film: a smooth random field, determined by a seed.
//!
//! ```text
//! Δz = a z/h Σ_k c_k sin(q_k·(x, y) + φ_k)          of a capsule    a: so that max |Δz| is the amplitude
//! Δx = a Σ_k c_k sin(q_k·x + φ_k)                   of other film   c_k: vectors
//! ```
//!
//! Symbols: h height of the stack, m; q wave vectors of one to four waves over the capsule's width.
//! Nodes above each other move alike, so layers approach each other only as much as the stack is
//! compressed. The bottom ring (z = 0) does not move. Seed 0 means no imperfection. Other film is displaced in all
//! directions, except for nodes that are held: film near film moves alike.
//!
//! The largest |Δz| is that over given positions, those of the same mesh for every mesh of a design. The
//! field is then the same on all of them.

use nalgebra::Vector3;

use crate::platform::random::{hash, unit};

/// Number of waves in the field. Chosen.
const WAVES: usize = 6;
/// Most waves along the size of film that is no capsule, in one direction. Chosen: as in a capsule.
const MAX_WAVES: f64 = 4.0;

/// The numbers in [0, 1) that a seed draws, one after the other.
fn draws(seed: u64) -> impl FnMut() -> f64 {
    let mut drawn = 0;
    move || {
        drawn += 1;
        unit(hash(seed, drawn))
    }
}

/// Adds the imperfection of a seed to stowed positions (m); `amplitude`: its largest value (m) at the
/// `reference` positions (m).
pub fn imperfect(
    positions: &mut [Vector3<f64>],
    reference: &[Vector3<f64>],
    seed: u64,
    amplitude: f64,
) {
    let size = reference.iter().map(|x| x.xy().norm()).fold(0.0, f64::max);
    let height = reference.iter().map(|x| x.z).fold(0.0, f64::max);
    // Also false for NaN.
    let valid = seed != 0 && size > 0.0 && height > 0.0;
    if !valid {
        return;
    }
    let mut draw = draws(seed);
    let full_turn = 2.0 * core::f64::consts::PI;
    let waves: Vec<[f64; 4]> = (0..WAVES)
        .map(|_| {
            let (length, angle) = (1.0 + 3.0 * draw(), full_turn * draw());
            let wave = 0.5 * full_turn * length / size;
            let (sin, cos) = libm::sincos(angle);
            [wave * cos, wave * sin, full_turn * draw(), 2.0 * draw() - 1.0]
        })
        .collect();
    let field = |x: &Vector3<f64>| {
        let sum: f64 = waves.iter().map(|[p, q, r, c]| c * libm::sin(p * x.x + q * x.y + r)).sum();
        sum * x.z / height
    };
    let largest = reference.iter().map(field).fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest > 0.0 {
        for position in positions {
            position.z += amplitude * field(position) / largest;
        }
    }
}

/// Adds the imperfection of a seed, with this amplitude (m), to the positions (m) of nodes that are not held.
pub fn displace(positions: &mut [Vector3<f64>], held: &[bool], seed: u64, amplitude: f64) {
    let first = positions.first().copied().unwrap_or_default();
    let (low, high) = positions.iter().fold((first, first), |(a, b), x| (a.inf(x), b.sup(x)));
    let size = (high - low).max();
    // Also false for NaN.
    let valid = seed != 0 && size > 0.0;
    if !valid {
        return;
    }
    let mut draw = draws(seed);
    let full_turn = 2.0 * core::f64::consts::PI;
    let waves: Vec<(Vector3<f64>, f64, Vector3<f64>)> = (0..WAVES)
        .map(|_| {
            let mut vector = || Vector3::from_fn(|_, _| 2.0 * draw() - 1.0);
            let (wave, coefficient) = (vector() * full_turn * MAX_WAVES / size, vector());
            (wave, full_turn * draw(), coefficient)
        })
        .collect();
    let field = |x: &Vector3<f64>| -> Vector3<f64> {
        let wave = |(q, phase, c): &(Vector3<f64>, f64, Vector3<f64>)| {
            c * libm::sin(q.dot(&(x - low)) + phase)
        };
        waves.iter().map(wave).sum()
    };
    let largest = positions.iter().map(|x| field(x).norm()).fold(0.0, f64::max);
    if largest > 0.0 {
        for (position, _) in positions.iter_mut().zip(held).filter(|(_, held)| !**held) {
            *position += field(position) * (amplitude / largest);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_determines_a_field_of_the_given_amplitude() {
        let flat: Vec<Vector3<f64>> = (0..200)
            .map(|k| {
                let (x, y) = (f64::from(k % 20) * 0.05 - 0.5, f64::from(k / 20) * 0.1 - 0.5);
                Vector3::new(x, y, 0.04 * f64::from(k % 3))
            })
            .collect();
        let with = |seed: u64| {
            let mut positions = flat.clone();
            imperfect(&mut positions, &flat, seed, 1e-4);
            positions
        };
        assert_eq!(with(0), flat);
        assert_eq!(with(3), with(3));
        assert_ne!(with(3), with(4));
        let moved = with(3);
        let largest = moved.iter().zip(&flat).map(|(a, b)| (a.z - b.z).abs()).fold(0.0, f64::max);
        assert!((largest / 1e-4 - 1.0).abs() < 1e-12);
        assert!(
            moved.iter().zip(&flat).all(|(a, b)| a.xy() == b.xy() && (b.z > 0.0 || a.z == 0.0))
        );
    }

    #[test]
    fn other_film_is_displaced_except_where_it_is_held() {
        let start: Vec<Vector3<f64>> = (0..100)
            .map(|k| Vector3::new(f64::from(k % 10), f64::from(k / 10), f64::from(k % 7)) * 0.1)
            .collect();
        let held: Vec<bool> = (0..100).map(|k| k < 10).collect();
        let with = |seed: u64| {
            let mut positions = start.clone();
            displace(&mut positions, &held, seed, 1e-5);
            positions
        };
        assert_eq!(with(0), start);
        assert_eq!(with(2), with(2));
        assert_ne!(with(2), with(3));
        let moved = with(2);
        let distance = |k: usize| (moved[k] - start[k]).norm();
        assert!((0..10).all(|k| distance(k) == 0.0));
        assert!((10..100).all(|k| distance(k) > 0.0 && distance(k) < 1.000_001e-5));
    }
}
