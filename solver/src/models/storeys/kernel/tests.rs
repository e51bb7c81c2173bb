//! Forces against the energy, and the volume.

use super::*;
use crate::geometry::fold::FoldPattern;
use crate::models::storeys::strip::stowed;
use crate::scene::{Film, paper};

const OVERPRESSURE: f64 = 50.0;

/// Film, gas and barrier: the energy whose gradient the forces are.
fn energy(strip: &Strip, positions: &Nodes) -> f64 {
    let step = ForceStep { length: 0.0, overpressure: OVERPRESSURE, creep_share: 0.0 };
    let mut states = vec![ElementState::default(); strip.elements.len()];
    let mut forces = positions.clone();
    let set = InstructionSet::Scalar;
    set_forces(set, strip, positions, step, &mut states, &mut forces);
    let mut energy = -OVERPRESSURE * volume(set, strip, positions);
    for (element, state) in strip.elements.iter().zip(&states) {
        for lane in 0..STRIPS {
            let at = |tensor: &[Lanes; 3]| tensor.map(|component| component.0[lane]);
            let stored = strip.creep.stored_energy(at(&state.strain), at(&state.stress), [0.0; 3]);
            energy -= element.minus_volume * stored;
        }
    }
    for (node, [x, y, _]) in strip.nodes.iter().zip(positions) {
        for lane in 0..STRIPS {
            let depth = (node.min_radius - libm::hypot(x.0[lane], y.0[lane])).max(0.0);
            if depth > 0.0 {
                energy += node.barrier * depth * depth * depth / (3.0 * node.min_radius);
            }
        }
    }
    energy
}

/// Strips in irregular places: folded, stretched, near the axis.
fn places(pattern: &FoldPattern) -> Nodes {
    let mut state = 7_u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let last = stowed(pattern).len() - 1;
    stowed(pattern)
        .iter()
        .enumerate()
        .map(|(index, place)| {
            let mut node = [Lanes::default(); 3];
            for lane in 0..STRIPS {
                let mut place = *place;
                place.z *= 1.0 + 20.0 * draw();
                place.turn *= draw();
                place.radius *= 0.1 + 1.0 * draw();
                let x = place.position(lane as f64);
                for (lanes, value) in node.iter_mut().zip(x.iter()) {
                    lanes.0[lane] = *value;
                }
            }
            if index == 0 || index == last {
                (node[0], node[1]) = (Lanes::default(), Lanes::default());
            }
            node
        })
        .collect()
}

#[test]
fn forces_are_the_gradient_of_the_energy() {
    let pattern = FoldPattern::new(&paper::design(8)).unwrap();
    let film = Film { youngs_modulus: 1e6, ..Film::PAPER.elastic() };
    let strip = Strip::new(&pattern, &film, 0.0);
    let positions = places(&pattern);
    let step = ForceStep { length: 0.0, overpressure: OVERPRESSURE, creep_share: 0.0 };
    let mut states = vec![ElementState::default(); strip.elements.len()];
    let mut forces = positions.clone();
    set_forces(InstructionSet::Scalar, &strip, &positions, step, &mut states, &mut forces);
    let largest = forces.iter().flatten().map(|f| f.largest()).fold(0.0, f64::max);
    let gap = 1e-6;
    let mut seen = 0;
    for (node, constants) in strip.nodes.iter().enumerate() {
        // Without the radius the energy of a node on the axis has no gradient across it.
        let axes = if constants.min_radius > 0.0 { 0..3 } else { 2..3 };
        for axis in axes {
            for lane in 0..STRIPS {
                let at = |shift: f64| {
                    let mut positions = positions.clone();
                    positions[node][axis].0[lane] += shift;
                    energy(&strip, &positions)
                };
                let slope = (at(gap) - at(-gap)) / (2.0 * gap);
                let force = forces[node][axis].0[lane];
                assert!((slope + force).abs() < 2e-5 * largest, "{node} {axis}: {slope} {force}");
                seen += 1;
            }
        }
    }
    assert_eq!(seen, (3 * (strip.nodes.len() - 2) + 2) * STRIPS);
    assert!(states.iter().any(|state| state.stress[2].largest() > 0.0));
}

#[test]
fn the_volume_of_erected_strips_is_that_of_their_cones() {
    let pattern = FoldPattern::new(&paper::design(8)).unwrap();
    let strip = Strip::new(&pattern, &Film::PAPER, 1.0);
    let places = crate::models::storeys::strip::erected(&pattern);
    let positions: Nodes = places
        .iter()
        .map(|place| place.position(0.0))
        .map(|x| [x.x, x.y, x.z].map(Lanes::splat))
        .collect();
    // The bottom ring is a circle with the mean radius of its N-gon, smaller than the cone's.
    let found = volume(InstructionSet::Scalar, &strip, &positions);
    let ratio = found / pattern.erected_volume();
    assert!(ratio > 0.97 && ratio < 1.0, "{ratio}");
}
