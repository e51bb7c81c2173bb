//! Time of one step of the film without contact, on every instruction set and by plain loops:
//! `cargo bench` in this folder.
//!
//! The paper's capsule with n = 5, 8 and 16 subdivisions, stowed, under 100 Pa. The unit of work is one
//! element and step.

use std::hint::black_box;

use billow_solver::geometry::field::Field;
use billow_solver::geometry::fold::{Caps, Chirality, Fit, FoldDesign, FoldPattern};
use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::geometry::shell::Shell;
use billow_solver::integrators::explicit::reference_step::{
    FilmMotion, reference_step, vector_step,
};
use billow_solver::integrators::explicit::update::KickParameters;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::supports::FreeComponents;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::Film;
use criterion::{Criterion, Throughput};
use nalgebra::Vector3;

/// The paper's capsule, stowed: its film and the positions of its nodes (m).
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

/// Step length over that of the stability limit 2/ω_max. Chosen: well inside it.
const STEP_OVER_STABLE_STEP: f64 = 0.2;

fn steps(criterion: &mut Criterion) {
    for subdivisions in [5, 8, 16] {
        let (model, positions) = capsule(subdivisions);
        let nodes = model.nodes();
        let free = FreeComponents::all(nodes);
        let length = STEP_OVER_STABLE_STEP * 2.0 / model.largest_frequency();
        let parameters = KickParameters {
            overpressure: 100.0,
            gravity: Vector3::zeros(),
            weight_factor: 1.0,
            velocity_factor: 1.0,
            acceleration_factor: length,
            contact_active: false,
        };
        let at_rest = Field::zeros(nodes);
        let start = FilmMotion::new(InstructionSet::detect(), &model, positions, at_rest);
        let mut group = criterion.benchmark_group(format!("film n {subdivisions}"));
        group.throughput(Throughput::Elements(model.elements() as u64));
        let mut film = start.clone();
        group.bench_function("plain loops", |bencher| {
            bencher
                .iter(|| black_box(reference_step(&model, &parameters, &free, length, &mut film)));
        });
        for set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
            let mut film = start.clone();
            group.bench_function(set.name(), |bencher| {
                bencher.iter(|| {
                    black_box(vector_step(set, &model, &parameters, &free, length, &mut film))
                });
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
