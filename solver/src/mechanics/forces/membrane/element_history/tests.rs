use nalgebra::{Vector2, Vector3};

use super::*;
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::{
    CreepStep, MembraneSums, NodeForces, assemble_membrane, deformation_gradient, strain,
};
use crate::mechanics::material::PlaneTensor;
use crate::platform::simd::InstructionSet;
use crate::scene::Film;

/// Nine elements and eleven nodes that move at constant velocities: positions at the start and after one
/// and two steps of `length` (s).
struct MovingFilm {
    model: FilmModel,
    velocities: Field,
    positions: [Field; 3],
    length: f64,
}

/// Creep strain and histories of a film that is assembled step by step.
#[derive(Clone)]
struct Histories {
    creep: Vec<[CreepStrain; 2]>,
    of_method: Vec<[ElementHistory; 2]>,
}

impl Histories {
    fn at_rest(model: &FilmModel, positions: &Field) -> Self {
        let creep = CreepStrain::at_rest(model, positions);
        Self { creep, of_method: ElementHistory::zero(model) }
    }

    fn assemble(
        &mut self,
        model: &FilmModel,
        positions: &Field,
        length: f64,
        out: &mut NodeForces,
    ) -> MembraneSums {
        let mut next = self.creep.clone();
        let mut creep = CreepStep { last: &self.creep, next: &mut next };
        let (set, histories) = (InstructionSet::detect(), &mut self.of_method);
        let sums = assemble_membrane(set, model, positions, length, &mut creep, histories, out);
        self.creep = next;
        sums
    }

    fn numerical_forces(&self, model: &FilmModel, positions: &Field) -> Field {
        numerical_forces(model, positions, &self.of_method)
    }

    fn stored_energy(&self, model: &FilmModel) -> f64 {
        stored_energy(model, &self.creep, &self.of_method)
    }
}

fn wave(k: usize) -> f64 {
    libm::sin(1.7 * k as f64)
}

/// A film of nine elements, and its flat reference positions.
fn nine_elements(film: &Film) -> (FilmModel, Vec<Vector2<f64>>) {
    let flat: Vec<_> = (0..11_u32)
        .map(|k| Vector2::new(0.1 * f64::from(k % 4), 0.08 * f64::from(k / 4)))
        .map(|p| Vector2::new(p.x + 0.3 * p.y, p.y - 0.1 * p.x))
        .collect();
    let triangles = [[0, 1, 5], [0, 5, 4], [1, 2, 5], [2, 6, 5], [2, 3, 7], [2, 7, 6]];
    let more = [[4, 5, 9], [4, 9, 8], [5, 6, 10]];
    let triangles: Vec<[u32; 3]> = triangles.into_iter().chain(more).collect();
    let reference: Vec<_> = triangles.iter().map(|t| t.map(|node| flat[node as usize])).collect();
    (FilmModel::new(film, flat.len(), &triangles, &reference).expect("a film"), flat)
}

impl MovingFilm {
    /// Film with the full membrane stiffness, so that it stays in one regime.
    fn new(length: f64) -> Self {
        let film = Film { compression: 1.0, numerical_damping: 0.1, ..Film::PAPER_ELASTIC };
        let (model, flat) = nine_elements(&film);
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
    fn steps(&self) -> ([Histories; 2], MembraneSums) {
        let Self { model, positions: [first, second, third], length, .. } = self;
        let mut histories = Histories::at_rest(model, first);
        let mut out = NodeForces::new(model);
        let _ = histories.assemble(model, first, 0.0, &mut out);
        let _ = histories.assemble(model, second, *length, &mut out);
        let middle = histories.clone();
        let sums = histories.assemble(model, third, *length, &mut out);
        ([middle, histories], sums)
    }
}

/// Damping forces −A t F D Dm⁻ᵀ of this strain rate of each element.
fn forces_by_gradient(
    model: &FilmModel,
    positions: &Field,
    rate: impl Fn(usize) -> PlaneTensor,
) -> Field {
    let mut forces = Field::zeros(model.nodes());
    for (element, triangle) in model.triangles.iter().enumerate() {
        let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
        let [f, g] = deformation_gradient(model, positions, element);
        let PlaneTensor { xx, yy, xy } = model.material.stress(rate(element)).tensor;
        let (p, q) = (f * xx + g * xy, f * xy + g * yy);
        let factor = -model.volume[element] * model.damping_time[element];
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
fn damping_force_follows_the_change_of_stress_in_a_step() {
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
    assert_close(&histories.numerical_forces(model, third), &expected, 1e-9);
}

#[test]
fn a_step_of_no_length_keeps_numerical_forces_and_dissipates_nothing() {
    let film = MovingFilm::new(2e-6);
    let MovingFilm { model, positions: [.., third], .. } = &film;
    let ([_, mut histories], _) = film.steps();
    let before = histories.numerical_forces(model, third);
    let mut out = NodeForces::new(model);
    let sums = histories.assemble(model, third, 0.0, &mut out);
    assert_close(&histories.numerical_forces(model, third), &before, 1e-15);
    assert!(sums.numerical_dissipation.abs() <= 0.0 && sums.material_loss.abs() <= 0.0);
}

/// The dissipation equals minus the trapezoidal work of the damping forces, up to a difference of higher
/// order in the step.
#[test]
fn numerical_dissipation_is_the_trapezoidal_work_of_the_damping_forces() {
    let error = |length: f64| {
        let film = MovingFilm::new(length);
        let MovingFilm { model, velocities, positions: [_, second, third], .. } = &film;
        let ([before, after], sums) = film.steps();
        let power = |forces: &Field| -> f64 {
            forces.iter().zip(velocities.iter()).map(|(f, v)| -f.dot(&v)).sum()
        };
        let trapezoid = 0.5
            * length
            * (power(&before.numerical_forces(model, second))
                + power(&after.numerical_forces(model, third)));
        assert!(trapezoid > 0.0);
        (sums.numerical_dissipation / trapezoid - 1.0).abs()
    };
    let (whole, half) = (error(2e-6), error(1e-6));
    assert!(whole < 1e-5 && half < 0.5 * whole, "{whole} {half}");
}

/// Film that swings at 100 Hz through all regimes. What its forces take is what it stores, loses and
/// dissipates; the rest falls with the step.
#[test]
fn work_on_the_film_is_stored_lost_or_dissipated() {
    let film =
        Film { loss_factor: 0.1, loss_frequency: 100.0, numerical_damping: 0.0, ..Film::PAPER };
    let (model, flat) = nine_elements(&film);
    let at = |time: f64| {
        let swing = libm::sin(core::f64::consts::TAU * 100.0 * time);
        let position = |(k, p): (usize, &Vector2<f64>)| {
            let offset = Vector3::new(wave(k), wave(2 * k + 1), wave(3 * k)) * (1e-4 * swing);
            Vector3::new(1.0002 * p.x, 1.0001 * p.y, 0.0) + offset
        };
        Field::of(&flat.iter().enumerate().map(position).collect::<Vec<_>>())
    };
    let run = |length: f64| {
        let (mut last, mut time) = (at(0.0), 0.0);
        let mut histories = Histories::at_rest(&model, &last);
        let (mut forces, mut next) = (NodeForces::new(&model), NodeForces::new(&model));
        let _ = histories.assemble(&model, &last, 0.0, &mut forces);
        let start = histories.stored_energy(&model);
        let (mut work, mut loss, mut numerical) = (0.0, 0.0, 0.0);
        while time < 0.02 {
            time += length;
            let positions = at(time);
            let sums = histories.assemble(&model, &positions, length, &mut next);
            for node in 0..model.nodes() {
                let force = forces.film(node) + next.film(node);
                work -= 0.5 * force.dot(&(positions.get(node) - last.get(node)));
            }
            loss += sums.material_loss;
            numerical += sums.numerical_dissipation;
            last = positions;
            core::mem::swap(&mut forces, &mut next);
        }
        let stored = histories.stored_energy(&model) - start;
        (work, stored, loss, numerical)
    };
    let (work, stored, loss, numerical) = run(2e-5);
    assert!(loss > 0.0 && numerical.abs() < 0.02 * loss);
    assert!((work - stored - loss - numerical).abs() < 1e-4 * loss);
    let (_, _, fine, _) = run(5e-6);
    assert!((loss / fine - 1.0).abs() < 0.02, "{loss} {fine}");
}

#[test]
fn film_at_rest_for_long_has_the_stress_of_film_without_loss() {
    let [with, without] = [0.1, 0.0].map(|loss_factor| {
        let (model, flat) = nine_elements(&Film { loss_factor, ..Film::PAPER });
        let stretched = |p: &Vector2<f64>| Vector3::new(1.002 * p.x, 0.999 * p.y, 0.1 * p.x);
        let positions = Field::of(&flat.iter().map(stretched).collect::<Vec<_>>());
        let mut histories = Histories::at_rest(&model, &positions);
        let mut out = NodeForces::new(&model);
        let _ = histories.assemble(&model, &positions, 0.0, &mut out);
        out.films()
    });
    assert_close(&with, &without, 1e-12);
}

/// Elements of equal area in uniaxial tension, the k-th at k times the first stress.
#[test]
fn the_stress_on_a_fraction_of_the_area_is_that_of_its_element() {
    let film = Film { compression: 1.0, poisson_ratio: 0.0, ..Film::PAPER_ELASTIC };
    let flat = [Vector2::new(0.0, 0.0), Vector2::new(0.1, 0.0), Vector2::new(0.0, 0.1)];
    let count = 20_u32;
    let triangles: Vec<[u32; 3]> = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let reference = vec![flat; triangles.len()];
    let model = FilmModel::new(&film, 3 * triangles.len(), &triangles, &reference).expect("a film");
    let strain_of = |k: u32| 1e-3 * f64::from((7 * k) % count + 1);
    let positions: Vec<Vector3<f64>> = (0..count)
        .flat_map(|k| {
            let stretch = (1.0 + 2.0 * strain_of(k)).sqrt();
            flat.map(|x| Vector3::new(stretch * x.x, x.y, 0.5 * f64::from(k)))
        })
        .collect();
    let positions = Field::of(&positions);
    let mut histories = Histories::at_rest(&model, &positions);
    let mut out = NodeForces::new(&model);
    let _ = histories.assemble(&model, &positions, 0.0, &mut out);
    let modulus = film.youngs_modulus;
    for (fraction, rank) in [(0.0, 20.0), (0.049, 20.0), (0.051, 19.0), (0.249, 16.0), (0.999, 1.0)]
    {
        let stress = stress_on_fraction(&model, &histories.of_method, fraction);
        assert!((stress / (1e-3 * rank * modulus) - 1.0).abs() < 1e-9, "{fraction}: {stress}");
    }
}
