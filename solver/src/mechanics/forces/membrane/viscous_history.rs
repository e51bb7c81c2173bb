//! Strain and viscous stress of the elements at the end of a step, stored for the next one.
//!
//! ```text
//! e = (Exx + Eyy, Exx − Eyy, 2 Exy)        s = ((Sxx + Syy)/2, (Sxx − Syy)/2, Sxy)        S:E = s·e
//! −A t s_v = η ((1 + ν)/2 Δe1, (1 − ν)/2 Δe2, (1 − ν)/2 Δe3)/Δt        η = −A t E/(1−ν²) 2ζ/ω_e
//! ```
//!
//! Symbols: Δe change of the strain e in the step Δt, `s_v` viscous stress. The viscous stress depends on
//! the positions at two times; a state holds the positions at one, so it must store the stress.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{Lanes, WIDTH};

/// Stored values of eight elements, each in its own axes
/// ([`crate::mechanics::film_model::ElementBlock`]).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscousHistory {
    /// Strain e.
    pub(crate) strain: [Lanes; 3],
    /// −A t `s_v`, J.
    pub(crate) minus_weighted_stress: [Lanes; 3],
}

impl ViscousHistory {
    /// Histories of a film at rest, without viscous stress: the first and the second elements of each
    /// block of eight kites.
    pub fn at_rest(model: &FilmModel) -> Vec<[Self; 2]> {
        vec![[Self::default(); 2]; model.constants.len()]
    }

    /// Histories of a film at these positions (m) with these velocities (m/s): `S_v` of Ė = sym(FᵀḞ).
    /// The first call of [`super::assemble_membrane`] sets the strains.
    pub fn in_motion(model: &FilmModel, positions: &Field, velocities: &Field) -> Vec<[Self; 2]> {
        let mut histories = Self::at_rest(model);
        let nu = model.material.poisson_ratio;
        for (index, kite) in model.kites.iter().enumerate() {
            let (block, lane) = (index / WIDTH, index % WIDTH);
            let [edges_of, rates_of] = [edges(positions, kite), edges(velocities, kite)];
            for half in 0..2 {
                let ([p, q], [u, w]) = (edges_of[half], rates_of[half]);
                let constants = &model.constants[block][half];
                let [a, b, d] = constants.inverse_shape.each_ref().map(|lanes| lanes.0[lane]);
                // Rate of the metric, then of the strain.
                let (m1, m2, m3) = (p.dot(&u), p.dot(&w) + q.dot(&u), q.dot(&w));
                let b_m1_d_m2 = b * m1 + d * m2;
                let (xx, yy) = (a * a * m1, b * b_m1_d_m2 + d * d * m3);
                let shear = a * (b * m1 + b_m1_d_m2);
                let viscosity = 0.5 * constants.minus_viscosity.0[lane];
                let (mean_factor, shear_factor) = (viscosity * (1.0 + nu), viscosity * (1.0 - nu));
                let stress =
                    [mean_factor * (xx + yy), shear_factor * (xx - yy), shear_factor * shear];
                let stored = &mut histories[block][half].minus_weighted_stress;
                for (stored, stress) in stored.iter_mut().zip(stress) {
                    stored.0[lane] = stress;
                }
            }
        }
        histories
    }
}

/// Edges p and q of the two elements of a kite, or their rates.
fn edges(field: &Field, kite: &[u32; 4]) -> [[Vector3<f64>; 2]; 2] {
    let [s, a, t, b] = kite.map(|node| field.get(node as usize));
    [[a - s, t - s], [t - s, b - s]]
}

/// Viscous forces on the nodes (N) at these positions (m): the part of the membrane forces that comes
/// from the stored `S_v`.
pub fn viscous_forces(
    model: &FilmModel,
    positions: &Field,
    histories: &[[ViscousHistory; 2]],
) -> Field {
    let mut forces = Field::zeros(model.nodes());
    for (index, kite) in model.kites.iter().enumerate() {
        let (block, lane) = (index / WIDTH, index % WIDTH);
        let [s, a, t, b] = *kite;
        let nodes = [[s, a, t], [s, t, b]];
        for (half, [p, q]) in edges(positions, kite).into_iter().enumerate() {
            let inverse_shape = &model.constants[block][half].inverse_shape;
            let [a, b, d] = inverse_shape.each_ref().map(|lanes| lanes.0[lane]);
            let stress = &histories[block][half].minus_weighted_stress;
            let [mean, half_difference, xy] = stress.each_ref().map(|lanes| lanes.0[lane]);
            let (xx, yy) = (mean + half_difference, mean - half_difference);
            // Force densities −r of the edges: Gᵀ of the stress.
            let b_yy_a_xy = b * yy + a * xy;
            let r = [a * a * xx + b * (b_yy_a_xy + a * xy), d * b_yy_a_xy, d * d * yy];
            let (first, second) = (p * r[0] + q * r[1], p * r[1] + q * r[2]);
            for (node, force) in nodes[half].into_iter().zip([-(first + second), first, second]) {
                forces.set(node as usize, forces.get(node as usize) + force);
            }
        }
    }
    forces
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::mechanics::forces::membrane::{
        MembraneSums, NodeForces, assemble_membrane, deformation_gradient, strain,
    };
    use crate::mechanics::material::PlaneTensor;
    use crate::platform::simd::InstructionSet;
    use crate::scene::Film;

    /// Nine elements and eleven nodes that move at constant velocities: positions at the start and
    /// after one and two steps of `length` (s).
    struct MovingFilm {
        model: FilmModel,
        velocities: Field,
        positions: [Field; 3],
        length: f64,
    }

    impl MovingFilm {
        fn new(length: f64) -> Self {
            let film = Film::PAPER;
            let flat: Vec<_> = (0..11_u32)
                .map(|k| Vector2::new(0.1 * f64::from(k % 4), 0.08 * f64::from(k / 4)))
                .map(|p| Vector2::new(p.x + 0.3 * p.y, p.y - 0.1 * p.x))
                .collect();
            let triangles = [[0, 1, 5], [0, 5, 4], [1, 2, 5], [2, 6, 5], [2, 3, 7], [2, 7, 6]];
            let more = [[4, 5, 9], [4, 9, 8], [5, 6, 10]];
            let triangles: Vec<[u32; 3]> = triangles.into_iter().chain(more).collect();
            let reference: Vec<_> =
                triangles.iter().map(|t| t.map(|node| flat[node as usize])).collect();
            let model = FilmModel::new(&film, flat.len(), &triangles, &reference).expect("a film");
            let wave = |k: usize| libm::sin(1.7 * k as f64);
            let velocity = |k: usize| Vector3::new(wave(k), wave(2 * k + 1), wave(3 * k)) * 20.0;
            let velocities: Vec<_> = (0..flat.len()).map(velocity).collect();
            let positions = [0.0, 1.0, 2.0].map(|steps| {
                let position = |(p, v): (&Vector2<f64>, &Vector3<f64>)| {
                    Vector3::new(1.001 * p.x, p.y, 0.02 * p.x) + v * (steps * length)
                };
                Field::of(&flat.iter().zip(&velocities).map(position).collect::<Vec<_>>())
            });
            Self { model, velocities: Field::of(&velocities), positions, length }
        }

        /// The histories after one and two steps, and the sums of the second step.
        fn steps(&self) -> ([Vec<[ViscousHistory; 2]>; 2], MembraneSums) {
            let Self { model, positions: [first, second, third], length, .. } = self;
            let (mut histories, mut out) = (ViscousHistory::at_rest(model), NodeForces::new(model));
            let set = InstructionSet::detect();
            let _ = assemble_membrane(set, model, first, 0.0, &mut histories, &mut out);
            let _ = assemble_membrane(set, model, second, *length, &mut histories, &mut out);
            let middle = histories.clone();
            let sums = assemble_membrane(set, model, third, *length, &mut histories, &mut out);
            ([middle, histories], sums)
        }
    }

    /// Viscous forces −A t F `S_v` Dm⁻ᵀ of this strain rate of each element.
    fn forces_by_gradient(
        model: &FilmModel,
        positions: &Field,
        rate: impl Fn(usize) -> PlaneTensor,
    ) -> Field {
        let mut forces = Field::zeros(model.nodes());
        for (element, triangle) in model.triangles.iter().enumerate() {
            let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
            let [f, g] = deformation_gradient(model, positions, element);
            let PlaneTensor { xx, yy, xy } = model.material.full_stress(rate(element));
            let (p, q) = (f * xx + g * xy, f * xy + g * yy);
            let factor = -model.volume[element] * model.viscous_time[element];
            let (first, second) = ((p * a + q * b) * factor, (p * c + q * d) * factor);
            for (node, force) in triangle.iter().zip([-(first + second), first, second]) {
                forces.set(*node as usize, forces.get(*node as usize) + force);
            }
        }
        forces
    }

    /// Asserts that two fields agree within `tolerance` times the largest vector of the second.
    fn assert_close(left: &Field, right: &Field, tolerance: f64) {
        let size = right.iter().map(|force| force.norm()).fold(0.0, f64::max);
        assert!(size > 0.0);
        for (left, right) in left.iter().zip(right.iter()) {
            assert!((left - right).norm() < tolerance * size, "{left} {right}");
        }
    }

    #[test]
    fn viscous_force_follows_the_change_of_strain_in_a_step() {
        let film = MovingFilm::new(2e-6);
        let MovingFilm { model, positions: [_, second, third], length, .. } = &film;
        let ([_, histories], _) = film.steps();
        let rate = |element: usize| {
            let [before, after] = [second, third].map(|x| strain(model, x, element));
            let rate = |before: f64, after: f64| (after - before) / length;
            PlaneTensor {
                xx: rate(before.xx, after.xx),
                yy: rate(before.yy, after.yy),
                xy: rate(before.xy, after.xy),
            }
        };
        let expected = forces_by_gradient(model, third, rate);
        assert_close(&viscous_forces(model, third, &histories), &expected, 1e-9);
    }

    #[test]
    fn viscous_force_at_the_start_follows_the_velocities_and_a_zero_step_keeps_it() {
        let MovingFilm { model, velocities, positions: [positions, ..], .. } =
            &MovingFilm::new(2e-6);
        let rate = |element: usize| {
            let [f, g] = deformation_gradient(model, positions, element);
            let [f_rate, g_rate] = deformation_gradient(model, velocities, element);
            let xy = (f.dot(&g_rate) + g.dot(&f_rate)) * 0.5;
            PlaneTensor { xx: f.dot(&f_rate), yy: g.dot(&g_rate), xy }
        };
        let expected = forces_by_gradient(model, positions, rate);
        let mut histories = ViscousHistory::in_motion(model, positions, velocities);
        assert_close(&viscous_forces(model, positions, &histories), &expected, 1e-12);

        let set = InstructionSet::detect();
        let (mut at_rest, mut out) = (ViscousHistory::at_rest(model), NodeForces::new(model));
        let _ = assemble_membrane(set, model, positions, 0.0, &mut at_rest, &mut out);
        let elastic = out.films();
        let sums = assemble_membrane(set, model, positions, 0.0, &mut histories, &mut out);
        let viscous: Vec<_> = out.films().iter().zip(elastic.iter()).map(|(f, g)| f - g).collect();
        assert_close(&Field::of(&viscous), &expected, 1e-9);
        assert!(sums.viscous_work.abs() <= 0.0);
    }

    /// The viscous work equals minus the trapezoidal work of the viscous forces, up to a difference of
    /// higher order in the step.
    #[test]
    fn viscous_work_is_the_trapezoidal_work_of_the_viscous_forces() {
        let error = |length: f64| {
            let film = MovingFilm::new(length);
            let MovingFilm { model, velocities, positions: [_, second, third], .. } = &film;
            let ([before, after], sums) = film.steps();
            let power = |forces: &Field| -> f64 {
                forces.iter().zip(velocities.iter()).map(|(f, v)| -f.dot(&v)).sum()
            };
            let trapezoid = 0.5
                * length
                * (power(&viscous_forces(model, second, &before))
                    + power(&viscous_forces(model, third, &after)));
            assert!(trapezoid > 0.0);
            (sums.viscous_work / trapezoid - 1.0).abs()
        };
        let (whole, half) = (error(2e-6), error(1e-6));
        assert!(whole < 1e-5 && half < 0.5 * whole, "{whole} {half}");
    }
}
