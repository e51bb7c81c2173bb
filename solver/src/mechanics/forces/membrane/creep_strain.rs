//! Creep strain of the elements: the history of the film's material.
//!
//! ```text
//! P = (Pxx + Pyy, Pxx − Pyy, 2 Pxy)
//! ```
//!
//! Its law: [`crate::mechanics::material_loss`]. Film without loss has no creep strain and stores none.

use serde::{Deserialize, Serialize};

use super::strain;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::material::PlaneTensor;
use crate::platform::simd::{Lanes, WIDTH};

/// Relaxation times after which film at rest has crept. Chosen: e⁻¹² is below the tolerances of a step.
const MAX_TIMES: f64 = 12.0;
/// Longest step of creep at rest, in relaxation times. Chosen: its error is of third order.
const MAX_SUBSTEP: f64 = 1.0;

/// Creep strain P of eight elements, each in its own axes ([`crate::mechanics::film_model::ElementBlock`]).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CreepStrain(pub [Lanes; 3]);

impl CreepStrain {
    /// Creep strains of a film that has been at these positions (m) for so long that its creep is over, in
    /// the layout of the element loop; empty for film without loss.
    pub fn at_rest(model: &FilmModel, positions: &Field) -> Vec<[Self; 2]> {
        if model.creep.ratio <= 0.0 {
            return Vec::new();
        }
        let mut all = vec![[Self::default(); 2]; model.constants.len()];
        for (index, kite) in model.kites.iter().enumerate() {
            let (block, lane) = (index / WIDTH, index % WIDTH);
            for (half, edges) in strain::edges_of_kite(positions, kite).into_iter().enumerate() {
                let inverse_shape = &model.constants[block][half].inverse_shape;
                let [a, b, d] = inverse_shape.each_ref().map(|lanes| lanes.0[lane]);
                let strain = strain::of_edges(edges, [[a, b], [0.0, d]]);
                let creep = model.creep.at_rest(&model.material, strain);
                for (stored, value) in all[block][half].0.iter_mut().zip(creep) {
                    stored.0[lane] = value;
                }
            }
        }
        all
    }

    /// Lets the film creep for `length` (s) while its strain goes evenly from that at the first positions (m) to that
    /// at the second ones: Ṗ = (C⁻¹:S − P)/τ by the midpoint rule with the exact decay of a constant stress. Of a longer
    /// time the last twelve τ count.
    pub fn relax(
        model: &FilmModel,
        (from, to): (&Field, &Field),
        length: f64,
        all: &mut [[Self; 2]],
    ) {
        let creep = &model.creep;
        let times = (length / creep.time).min(MAX_TIMES);
        if all.is_empty() || times <= 0.0 {
            return;
        }
        let count = (times / MAX_SUBSTEP).ceil();
        let shares = [0.5, 1.0].map(|part| creep.share(part * times / count * creep.time));
        // Share of the way at the start of the time that counts, and of a substep.
        let first = 1.0 - times * creep.time / length;
        let part = (1.0 - first) / count;
        for (index, kite) in model.kites.iter().enumerate() {
            let (block, lane) = (index / WIDTH, index % WIDTH);
            let ends = [from, to].map(|positions| strain::edges_of_kite(positions, kite));
            for half in [0, 1] {
                let inverse_shape = &model.constants[block][half].inverse_shape;
                let [a, b, d] = inverse_shape.each_ref().map(|lanes| lanes.0[lane]);
                let [start, end] =
                    ends.map(|edges| strain::of_edges(edges[half], [[a, b], [0.0, d]]));
                let towards =
                    |from: [f64; 3], at: [f64; 3], progress: f64, share: f64| -> [f64; 3] {
                        let [sum, difference, shear] = at;
                        let mix = |from: f64, to: f64| from + progress * (to - from);
                        let strain = PlaneTensor {
                            xx: mix(start.xx, end.xx),
                            yy: mix(start.yy, end.yy),
                            xy: mix(start.xy, end.xy),
                        };
                        let elastic = PlaneTensor {
                            xx: strain.xx + creep.ratio * (strain.xx - 0.5 * (sum + difference)),
                            yy: strain.yy + creep.ratio * (strain.yy - 0.5 * (sum - difference)),
                            xy: strain.xy + creep.ratio * (strain.xy - 0.5 * shear),
                        };
                        let rest = creep.at_rest(&model.material, elastic);
                        core::array::from_fn(|k| from[k] + share * (rest[k] - from[k]))
                    };
                let mut value = all[block][half].lane(lane);
                let mut done = 0.0;
                while done < count {
                    let [start, middle] = [0.0, 0.5].map(|half| first + (done + half) * part);
                    let halfway = towards(value, value, start, shares[0]);
                    value = towards(value, halfway, middle, shares[1]);
                    done += 1.0;
                }
                for (stored, value) in all[block][half].0.iter_mut().zip(value) {
                    stored.0[lane] = value;
                }
            }
        }
    }

    /// The creep strain this share of the way from `self` to another one.
    #[must_use]
    pub fn between(&self, other: &Self, share: f64) -> Self {
        let mut mean = *self;
        for (lanes, other) in mean.0.iter_mut().zip(&other.0) {
            for (value, other) in lanes.0.iter_mut().zip(&other.0) {
                *value += share * (other - *value);
            }
        }
        mean
    }

    /// P of one lane.
    pub fn lane(&self, lane: usize) -> [f64; 3] {
        self.0.each_ref().map(|lanes| lanes.0[lane])
    }
}

/// Creep strains before a step and, beside them, after it. Both are empty for film without loss.
#[derive(Debug)]
pub struct CreepStep<'a> {
    /// Before the step.
    pub last: &'a [[CreepStrain; 2]],
    /// After the step; written only if the step has a length.
    pub next: &'a mut [[CreepStrain; 2]],
}

impl CreepStep<'_> {
    /// The step of film without loss.
    pub fn none() -> Self {
        Self { last: &[], next: &mut [] }
    }
}
