//! The film's own work of a step, on every instruction set and as plain loops: `cargo bench`.
//!
//! The paper's capsule at n 5, 8 and 16, stowed and set in motion; an element a step is the unit.

use std::hint::black_box;

use billow_solver::geometry::fold::{Caps, Chirality, Fit, FoldDesign, FoldPattern};
use billow_solver::integrators::explicit::reference_step::{FilmMotion, vector_step, reference_step};
use billow_solver::integrators::explicit::update::Push;
use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::scene::Film;
use billow_solver::geometry::shell::Shell;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::geometry::field::Field;
use billow_solver::mechanics::supports::Free;
use criterion::{Criterion, Throughput};
use nalgebra::Vector3;

/// The paper's capsule, stowed, of film at rest.
fn capsule(subdivisions: u32) -> (FilmModel, Field) {
    let design = FoldDesign {
        fit: Fit::Cone,
        panels: 6,
        storeys: 3,
        bottom_radius: 0.5,
        top_radius: Some(0.365),
        height: Some(1.0),
        half_angle: None,
        alpha1_over_phi: None,
        chirality: Chirality::Same,
        stowed_height: 0.04,
        subdivisions,
        caps: Caps::Polygon,
    };
    let film = Film {
        youngs_modulus: 3.45e9,
        poisson_ratio: 0.3,
        density: 1400.0,
        thickness: 25.4e-6,
        compression: 0.0,
        viscosity: 0.1,
        temperature: 293.0,
    };
    let pattern = FoldPattern::new(&design).expect("a pattern");
    let mesh = Mesh::new(&pattern, subdivisions, Shape::Stowed(0.04)).expect("a mesh");
    let shell = Shell::of_mesh(&mesh);
    let model = FilmModel::of_shell(&film, &shell).expect("a film");
    (model, Field::of(&shell.positions))
}

fn steps(criterion: &mut Criterion) {
    for subdivisions in [5, 8, 16] {
        let (model, places) = capsule(subdivisions);
        let nodes = model.nodes();
        let free = Free::all(nodes);
        let length = 0.4 / model.largest_frequency();
        let push = Push {
            overpressure: 100.0,
            gravity: Vector3::zeros(),
            weight: 1.0,
            keep: 1.0,
            gain: length,
            pressed: false,
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
