//! Static states by Newton's method.

use std::ops::ControlFlow;
use std::time::Instant;

use billow_solver::ladder::film::capsule::film_scene;
use billow_solver::mesh::Shape;
use billow_solver::fold::Caps;
use billow_solver::model::FilmModel;
use billow_solver::simd::Path;
use billow_solver::state::Field;
use billow_solver::statics::{Iteration, Loaded, Settling, equilibrium};
use billow_solver::supports::Supports;
use nalgebra::Vector3;

use crate::film_rig::{ELASTIC, icosphere};
use crate::rig::paper_scene;

fn watch(print: bool) -> impl FnMut(&Iteration) -> ControlFlow<()> {
    let start = Instant::now();
    move |it| {
        if print { println!("{:6.2} s {:3} r {:.2e} d {:.2e} mu {:.0e} a {:.3}", start.elapsed().as_secs_f64(), it.index, it.residual, it.step, it.shift, it.share); }
        ControlFlow::Continue(())
    }
}

#[test]
fn sphere() {
    for level in [1, 2, 3] {
    for p in [100.0, 1000.0, 5000.0] {
    let piece = icosphere(level, 0.5);
    let model = piece.model(&ELASTIC);
    let supports = Supports::none(piece.nodes.len());
    let loaded = Loaded { model: &model, supports: &supports, overpressure: p, gravity: Vector3::zeros(), path: Path::best() };
    let rest = equilibrium(&loaded, Field::of(&piece.nodes), &Settling::default(), &mut watch(level == 3)).unwrap();
    let loaded: f64 = rest.places.iter().map(|x| x.norm()).sum();
    let unloaded: f64 = piece.nodes.iter().map(Vector3::norm).sum();
    println!("{level} {p} {} {}", rest.iterations, loaded / unloaded - 1.0);
    }}
}

#[test]
fn capsule() {
    let n: u32 = std::env::var("N").map_or(5, |n| n.parse().unwrap());
    let mut scene = paper_scene();
    scene.design.subdivisions = n;
    scene.design.caps = Caps::Circular;
    scene.supports.clear();
    let (scene, _) = film_scene(&scene, Shape::Erected, 0.9).unwrap();
    let model = FilmModel::of_shell(&scene.film, &scene.shell).unwrap();
    let supports = Supports::none(model.nodes());
    let mut places = Field::of(&scene.shell.positions);
    let list: Vec<f64> = std::env::var("P").map_or(vec![10.0], |p| p.split(',').map(|p| p.parse().unwrap()).collect());
    for p in list {
        let loaded = Loaded { model: &model, supports: &supports, overpressure: p, gravity: Vector3::zeros(), path: Path::best() };
        let start = Instant::now();
        match equilibrium(&loaded, places.clone(), &Settling::default(), &mut watch(true)) {
            Ok(rest) => { println!("{p}: {} V {} {:.2} s", rest.iterations, billow_solver::forces::pressure::volume(&model, &rest.places), start.elapsed().as_secs_f64()); places = rest.places; }
            Err(f) => { println!("{p}: {f}"); }
        }
    }
}
