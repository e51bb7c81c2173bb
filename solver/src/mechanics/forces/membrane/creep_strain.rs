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
use crate::platform::simd::{Lanes, WIDTH};

/// Creep strain P of eight elements, each in its own axes ([`crate::mechanics::film_model::ElementBlock`]).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CreepStrain(pub(crate) [Lanes; 3]);

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
