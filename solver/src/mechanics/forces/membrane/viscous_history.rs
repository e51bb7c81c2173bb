//! What elements remember from one pass to the next, for viscosity.
//!
//! ```text
//! e = (Exx + Eyy, Exx − Eyy, 2 Exy)        s = ((Sxx + Syy)/2, (Sxx − Syy)/2, Sxy)        S:E = s·e
//! −A t s_v = drag ((1 + ν)/2 e1, (1 − ν)/2 e2, (1 − ν)/2 e3)/Δt        over the change of e in the step
//! ```
//!
//! Viscosity is part of the state: its stress follows from two places, and a state has one.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{Lanes, WIDTH};

/// What is remembered of eight elements, in their own axes ([`crate::mechanics::film_model::ElementBlock`]).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscousHistory {
    /// e of the module's equations.
    pub(crate) strain: [Lanes; 3],
    /// −A t `s_v`, J.
    pub(crate) drag: [Lanes; 3],
}

impl ViscousHistory {
    /// Of film that has not moved: the halves of a model's kites, eight by eight.
    pub fn at_rest(model: &FilmModel) -> Vec<[Self; 2]> {
        vec![[Self::default(); 2]; model.constants.len()]
    }

    /// Of film that came to these places (m) with these velocities (m/s): `S_v` of Ė = sym(FᵀḞ). The
    /// strains are known after the first pass.
    pub fn in_motion(model: &FilmModel, places: &Field, velocities: &Field) -> Vec<[Self; 2]> {
        let mut past = Self::at_rest(model);
        let nu = model.material.poisson_ratio;
        for (index, kite) in model.kites.iter().enumerate() {
            let (block, lane) = (index / WIDTH, index % WIDTH);
            let [places, speeds] = [edges(places, kite), edges(velocities, kite)];
            for half in 0..2 {
                let ([p, q], [u, w]) = (places[half], speeds[half]);
                let constants = &model.constants[block][half];
                let [a, b, d] = constants.inverse.each_ref().map(|lanes| lanes.0[lane]);
                let (pp, pq, qq) = (p.dot(&u), p.dot(&w) + q.dot(&u), q.dot(&w));
                let lean = b * pp + d * pq;
                let (xx, yy) = (a * a * pp, b * lean + d * d * qq);
                let shear = a * (b * pp + lean);
                let drag = 0.5 * constants.drag.0[lane];
                let (both, apart) = (drag * (1.0 + nu), drag * (1.0 - nu));
                let stress = [both * (xx + yy), apart * (xx - yy), apart * shear];
                for (own, stress) in past[block][half].drag.iter_mut().zip(stress) {
                    own.0[lane] = stress;
                }
            }
        }
        past
    }
}

/// First and last edge of the halves of a kite.
fn edges(field: &Field, kite: &[u32; 4]) -> [[Vector3<f64>; 2]; 2] {
    let [s, a, t, b] = kite.map(|node| field.get(node as usize));
    [[a - s, t - s], [t - s, b - s]]
}

/// Forces on nodes (N) of the `S_v` remembered: the part of [`super::assemble_membrane`]'s that it has there.
pub fn viscous_forces(model: &FilmModel, places: &Field, past: &[[ViscousHistory; 2]]) -> Field {
    let mut sum = Field::zeros(model.nodes());
    for (index, kite) in model.kites.iter().enumerate() {
        let (block, lane) = (index / WIDTH, index % WIDTH);
        let [s, a, t, b] = *kite;
        let ends = [[s, a, t], [s, t, b]];
        for (half, [p, q]) in edges(places, kite).into_iter().enumerate() {
            let inverse = &model.constants[block][half].inverse;
            let [a, b, d] = inverse.each_ref().map(|lanes| lanes.0[lane]);
            let [mean, apart, xy] = past[block][half].drag.each_ref().map(|lanes| lanes.0[lane]);
            let (xx, yy) = (mean + apart, mean - apart);
            let lean = b * yy + a * xy;
            let pull = [a * a * xx + b * (lean + a * xy), d * lean, d * d * yy];
            let (first, second) = (p * pull[0] + q * pull[1], p * pull[1] + q * pull[2]);
            for (node, force) in ends[half].into_iter().zip([-(first + second), first, second]) {
                sum.set(node as usize, sum.get(node as usize) + force);
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::mechanics::forces::membrane::{NodeForces, Sums, assemble_membrane, strain};
    use crate::mechanics::material::PlaneTensor;
    use crate::platform::simd::InstructionSet;
    use crate::scene::Film;

    /// Nine elements and eleven nodes, shaken: their places at 0, h and 2h.
    struct Shaken {
        model: FilmModel,
        velocities: Field,
        places: [Field; 3],
        length: f64,
    }

    impl Shaken {
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
            let moving = |k: usize| Vector3::new(wave(k), wave(2 * k + 1), wave(3 * k)) * 20.0;
            let velocities: Vec<_> = (0..flat.len()).map(moving).collect();
            let places = [0.0, 1.0, 2.0].map(|steps| {
                let place = |(p, v): (&Vector2<f64>, &Vector3<f64>)| {
                    Vector3::new(1.001 * p.x, p.y, 0.02 * p.x) + v * (steps * length)
                };
                Field::of(&flat.iter().zip(&velocities).map(place).collect::<Vec<_>>())
            });
            Self { model, velocities: Field::of(&velocities), places, length }
        }

        /// What is remembered at h and at 2h, and the sums of the second step.
        fn steps(&self) -> ([Vec<[ViscousHistory; 2]>; 2], Sums) {
            let Self { model, places: [first, second, third], length, .. } = self;
            let (mut past, mut out) = (ViscousHistory::at_rest(model), NodeForces::new(model));
            let path = InstructionSet::detect();
            let _ = assemble_membrane(path, model, first, 0.0, &mut past, &mut out);
            let _ = assemble_membrane(path, model, second, *length, &mut past, &mut out);
            let middle = past.clone();
            let sums = assemble_membrane(path, model, third, *length, &mut past, &mut out);
            ([middle, past], sums)
        }
    }

    /// −A t F `S_v` Dm⁻ᵀ of this strain rate, in axes of the reference.
    fn by_gradient(
        model: &FilmModel,
        places: &Field,
        rate: impl Fn(usize) -> PlaneTensor,
    ) -> Field {
        let mut sum = Field::zeros(model.nodes());
        for (element, triangle) in model.triangles.iter().enumerate() {
            let [x0, x1, x2] = triangle.map(|node| places.get(node as usize));
            let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
            let (p, q) = (x1 - x0, x2 - x0);
            let (f, g) = (p * a + q * c, p * b + q * d);
            let PlaneTensor { xx, yy, xy } = model.material.full_stress(rate(element));
            let (p, q) = (f * xx + g * xy, f * xy + g * yy);
            let loss = -model.volume[element] * model.viscous_time[element];
            let (first, second) = ((p * a + q * b) * loss, (p * c + q * d) * loss);
            for (node, force) in triangle.iter().zip([-(first + second), first, second]) {
                sum.set(*node as usize, sum.get(*node as usize) + force);
            }
        }
        sum
    }

    fn assert_same(one: &Field, other: &Field, share: f64) {
        let size = other.iter().map(|force| force.norm()).fold(0.0, f64::max);
        assert!(size > 0.0);
        for (one, other) in one.iter().zip(other.iter()) {
            assert!((one - other).norm() < share * size, "{one} {other}");
        }
    }

    #[test]
    fn viscosity_resists_the_change_of_strain() {
        let shaken = Shaken::new(2e-6);
        let Shaken { model, places: [_, second, third], length, .. } = &shaken;
        let ([_, past], _) = shaken.steps();
        let rate = |element: usize| {
            let [then, now] = [second, third].map(|places| strain(model, places, element));
            let rate = |then: f64, now: f64| (now - then) / length;
            PlaneTensor {
                xx: rate(then.xx, now.xx),
                yy: rate(then.yy, now.yy),
                xy: rate(then.xy, now.xy),
            }
        };
        let by_gradient = by_gradient(model, third, rate);
        assert_same(&viscous_forces(model, third, &past), &by_gradient, 1e-9);
    }

    /// At the start, of the velocities there; a pass of no length keeps it.
    #[test]
    fn what_is_in_motion_resists_from_the_start() {
        let Shaken { model, velocities, places: [places, ..], .. } = &Shaken::new(2e-6);
        let gradients = |field: &Field, element: usize| {
            let [x0, x1, x2] = model.triangles[element].map(|node| field.get(node as usize));
            let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
            let (p, q) = (x1 - x0, x2 - x0);
            [p * a + q * c, p * b + q * d]
        };
        let rate = |element: usize| {
            let ([f, g], [fr, gr]) = (gradients(places, element), gradients(velocities, element));
            let xy = (f.dot(&gr) + g.dot(&fr)) * 0.5;
            PlaneTensor { xx: f.dot(&fr), yy: g.dot(&gr), xy }
        };
        let by_gradient = by_gradient(model, places, rate);
        let mut past = ViscousHistory::in_motion(model, places, velocities);
        assert_same(&viscous_forces(model, places, &past), &by_gradient, 1e-12);

        let (mut still, mut out) = (ViscousHistory::at_rest(model), NodeForces::new(model));
        let _ =
            assemble_membrane(InstructionSet::detect(), model, places, 0.0, &mut still, &mut out);
        let elastic = out.films();
        let sums =
            assemble_membrane(InstructionSet::detect(), model, places, 0.0, &mut past, &mut out);
        let viscous: Vec<_> = out.films().iter().zip(elastic.iter()).map(|(f, g)| f - g).collect();
        assert_same(&Field::of(&viscous), &by_gradient, 1e-9);
        assert!(sums.viscous_work.abs() <= 0.0);
    }

    /// The work told is minus the trapezoid of the viscous forces along the way, but for what is of a higher
    /// order in the step.
    #[test]
    fn the_work_told_is_the_trapezoid_of_the_forces() {
        let off = |length: f64| {
            let shaken = Shaken::new(length);
            let Shaken { model, velocities, places: [_, second, third], .. } = &shaken;
            let ([before, after], sums) = shaken.steps();
            let along = |forces: &Field| -> f64 {
                forces.iter().zip(velocities.iter()).map(|(f, v)| -f.dot(&v)).sum()
            };
            let trapezoid = 0.5
                * length
                * (along(&viscous_forces(model, second, &before))
                    + along(&viscous_forces(model, third, &after)));
            assert!(trapezoid > 0.0);
            (sums.viscous_work / trapezoid - 1.0).abs()
        };
        let (whole, half) = (off(2e-6), off(1e-6));
        assert!(whole < 1e-5 && half < 0.5 * whole, "{whole} {half}");
    }
}
