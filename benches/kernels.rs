//! The step of the film alone, on every instruction set and as plain loops: `cargo bench`.
//!
//! The paper's capsule at n 5, 8 and 16, stowed and set in motion; an element a step is the unit.

use std::hint::black_box;

use billow_solver::geometry::fold::FoldPattern;
use billow_solver::integrators::explicit::reference_step::{FilmMotion, vector_step, reference_step};
use billow_solver::integrators::explicit::update::KickParameters;
use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::scene::{Film, paper};
use billow_solver::geometry::shell::Shell;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::geometry::field::Field;
use billow_solver::mechanics::supports::FreeComponents;
use criterion::{Criterion, Throughput};
use nalgebra::Vector3;

/// The paper's capsule, stowed, of film at rest.
fn capsule(subdivisions: u32) -> (FilmModel, Field) {
    let pattern = FoldPattern::new(&paper::design(subdivisions)).expect("a pattern");
    let mesh = Mesh::new(&pattern, subdivisions, Shape::Stowed(paper::STOWED_HEIGHT)).expect("a mesh");
    let shell = Shell::of_mesh(&mesh);
    let model = FilmModel::of_shell(&Film::PAPER, &shell).expect("a film");
    (model, Field::of(&shell.positions))
}

fn steps(criterion: &mut Criterion) {
    for subdivisions in [5, 8, 16] {
        let (model, places) = capsule(subdivisions);
        let nodes = model.nodes();
        let free = FreeComponents::all(nodes);
        let length = 0.4 / model.largest_frequency();
        let push = KickParameters {
            overpressure: 100.0,
            gravity: Vector3::zeros(),
            weight_factor: 1.0,
            velocity_factor: 1.0,
            acceleration_factor: length,
            contact_active: false,
        };
        let start = FilmMotion::new(InstructionSet::detect(), &model, places, Field::zeros(nodes));
        let mut group = criterion.benchmark_group(format!("film n {subdivisions}"));
        group.throughput(Throughput::Elements(model.elements() as u64));
        let mut film = start.clone();
        group.bench_function("plain loops", |bencher| {
            bencher.iter(|| black_box(reference_step(&model, &push, &free, length, &mut film)));
        });
        for path in InstructionSet::ALL.into_iter().filter(|path| path.available()) {
            let mut film = start.clone();
            group.bench_function(path.name(), |bencher| {
                bencher
                    .iter(|| black_box(vector_step(path, &model, &push, &free, length, &mut film)));
            });
        }
        group.finish();
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    steps(&mut criterion);
    criterion.final_summary();
}
