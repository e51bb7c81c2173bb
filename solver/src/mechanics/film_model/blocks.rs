//! Constants of the elements, eight kites a block, in the layout the element loop reads.
//!
//! ```text
//! (Exx, Eyy, 2 Exy) = G m − (1/2, 1/2, 0)           m = (p·p/2, p·q, q·q/2)
//!
//!     | a²    0    0  |
//! G = | b²    bd   d² |        Dm⁻¹ = [[a, b], [0, d]]
//!     | 2ab   ad   0  |
//! ```
//!
//! The Green strain E is linear in the metric m of the element's edges p and q. The film is isotropic,
//! so each element has its own axes, the first along its first edge in the reference. With P, Q the
//! reference edges, a = 1/|P|, d = |P|/(P × Q), b = −a P·Q/(P × Q).

use super::FilmModel;
use super::kites::{ElementCorner, Kite};
use crate::platform::simd::{Lanes, WIDTH};

/// Constants of eight elements; zero in a lane without an element.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementBlock {
    /// Entries a, b and d of Dm⁻¹, 1/m.
    pub inverse_shape: [Lanes; 3],
    /// −A t, m³: factor from a stress to a force density.
    pub minus_volume: Lanes,
    /// `2ζ/ω_e`, s: factor from a stress rate to the numerical damping stress.
    pub damping_time: Lanes,
}

impl ElementBlock {
    /// The constants of all kites: for each block, the first elements of its kites, then the second.
    pub(super) fn all(model: &FilmModel, kites: &[Kite]) -> Vec<[Self; 2]> {
        let mut blocks = vec![[Self::default(); 2]; kites.len().div_ceil(WIDTH)];
        for (index, kite) in kites.iter().enumerate() {
            let halves = [Some(kite.first), kite.second];
            for (block, half) in blocks[index / WIDTH].iter_mut().zip(halves) {
                if let Some(half) = half {
                    block.set(index % WIDTH, model, half);
                }
            }
        }
        blocks
    }

    /// Sets a lane to the constants of an element, its edges counted from `corner`.
    fn set(
        &mut self,
        lane: usize,
        model: &FilmModel,
        ElementCorner { element, corner }: ElementCorner,
    ) {
        let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
        let determinant = 1.0 / (a * d - b * c);
        // Reference corners relative to corner 0: Dm = [[d, −b], [−c, a]] det Dm.
        let corners = [[0.0, 0.0], [d, -c], [-b, a]].map(|x| x.map(|entry| entry * determinant));
        let edge_to = |step: usize| {
            let (from, to) = (corners[corner], corners[(corner + step) % 3]);
            [to[0] - from[0], to[1] - from[1]]
        };
        let (p, q) = (edge_to(1), edge_to(2));
        let (pp, pq) = (p[0] * p[0] + p[1] * p[1], p[0] * q[0] + p[1] * q[1]);
        let length = pp.sqrt();
        self.inverse_shape[0].0[lane] = 1.0 / length;
        self.inverse_shape[1].0[lane] = -pq / (length * determinant);
        self.inverse_shape[2].0[lane] = length / determinant;
        let volume = model.volume[element];
        self.minus_volume.0[lane] = -volume;
        self.damping_time.0[lane] = model.damping_time[element];
    }
}
