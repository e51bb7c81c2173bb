//! What is constant of elements, eight kites at a time, as the pass over them wants it.
//!
//! ```text
//! (Exx, Eyy, 2 Exy) = G m − (1/2, 1/2, 0)           m = (p·p/2, p·q, q·q/2)
//!
//!     | a²    0    0  |
//! G = | b²    bd   d² |        Dm⁻¹ = [[a, b], [0, d]]
//!     | 2ab   ad   0  |
//! ```
//!
//! Strain is linear in the metric m of an element's edges p and q, and film is alike in all directions:
//! each element has axes of its own, the first along its first edge in the reference. With P, Q the
//! edges there, a = 1/|P|, d = |P|/(P × Q), b = −a P·Q/(P × Q).

use super::FilmModel;
use super::kites::Kite;
use crate::platform::simd::{Lanes, WIDTH};

/// Constants of eight elements; nought where there is none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementBlock {
    /// Of Dm⁻¹: a, b and d, 1/m.
    pub inverse: [Lanes; 3],
    /// −A t, m³: what a stress pulls back with.
    pub minus_volume: Lanes,
    /// `−A t E/(1−ν²) 2ζ/ω_e`, J s: what a strain rate does.
    pub drag: Lanes,
}

impl ElementBlock {
    /// Those of a model's kites, the first halves of eight and the second.
    pub(super) fn all(model: &FilmModel, kites: &[Kite]) -> Vec<[Self; 2]> {
        let mut blocks = vec![[Self::default(); 2]; kites.len().div_ceil(WIDTH)];
        for (index, kite) in kites.iter().enumerate() {
            let halves = [Some(kite.first), kite.second];
            for (block, half) in blocks[index / WIDTH].iter_mut().zip(halves) {
                if let Some((element, corner)) = half {
                    block.set(index % WIDTH, model, element, corner);
                }
            }
        }
        blocks
    }

    /// Those of an element whose first corner is this.
    fn set(&mut self, lane: usize, model: &FilmModel, element: usize, corner: usize) {
        let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
        let determinant = 1.0 / (a * d - b * c);
        // The corners of the reference, the first at the origin: Dm = [[d, −b], [−c, a]] det.
        let places = [[0.0, 0.0], [d, -c], [-b, a]].map(|x| x.map(|entry| entry * determinant));
        let to = |other: usize| {
            let (from, to) = (places[corner], places[(corner + other) % 3]);
            [to[0] - from[0], to[1] - from[1]]
        };
        let (p, q) = (to(1), to(2));
        let (first, along) = (p[0] * p[0] + p[1] * p[1], p[0] * q[0] + p[1] * q[1]);
        let length = first.sqrt();
        self.inverse[0].0[lane] = 1.0 / length;
        self.inverse[1].0[lane] = -along / (length * determinant);
        self.inverse[2].0[lane] = length / determinant;
        let volume = model.volume[element];
        self.minus_volume.0[lane] = -volume;
        let stiffness = volume * model.material.plane_modulus();
        self.drag.0[lane] = -stiffness * model.viscous_time[element];
    }
}
