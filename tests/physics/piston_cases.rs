//! The film of the piston at the end of its stroke. The closed forms are
//! reference cases of `billow-checks validate`.

use billow_solver::scene::paper::{BOTTOM_RADIUS, HEIGHT, TOP_RADIUS, nitrogen_supply};

use crate::prelude::*;
use crate::rig::{adaptive, fixed, tube};

/// The end film of the paper's cone, for a moving mass of 70 g.
fn end_film() -> EndFilm {
    let film = Film::PAPER;
    let modulus = (film.youngs_modulus, film.thickness);
    EndFilm::of_cone((BOTTOM_RADIUS, TOP_RADIUS), HEIGHT, modulus, film.numerical_damping, 0.07)
}

/// A driven mass that bounces on its end film.
fn on_its_end(control: Control) -> PistonRun {
    let gas = Gas::new(&nitrogen_supply(), 293.0, 1.0);
    let end = end_film();
    let piston = Piston { end, ..tube(0.6, 0.0, 0.07, gas) };
    let start = PistonState { height: 0.8, speed: 20.0, gas: gas.at_temperature(5e-5, 293.0) };
    let mut run = PistonRun::new(piston, 0.0, start, control);
    run.advance(0.05, &Phase::default()).unwrap();
    run
}

#[test]
fn the_kink_at_full_height_costs_no_accuracy() {
    let reference = on_its_end(adaptive(1e-13)).state();
    let error = |control| (on_its_end(control).state().height - reference.height).abs();
    let tolerances = [1e-6, 1e-8, 1e-10].map(|tolerance| error(adaptive(tolerance)));
    assert!(tolerances[1] < 1e-7 && tolerances[2] < 1e-9, "{tolerances:?}");
    let (coarse, fine) = (error(fixed(1e-4)), error(fixed(5e-5)));
    assert!((coarse / fine).log2() > 4.0, "{coarse:e} {fine:e}");
}

#[test]
fn strain_work_is_the_strain_energy() {
    let gas = Gas::new(&nitrogen_supply(), 293.0, 1.0);
    let end = end_film();
    let piston = Piston { end, ..tube(0.6, 0.0, 0.07, gas) };
    let start = PistonState { height: 0.9, speed: 20.0, gas: gas.at_temperature(5e-5, 293.0) };
    let mut run = PistonRun::new(piston, 0.0, start, adaptive(1e-9));
    let mut largest = 0.0_f64;
    for k in 1..200 {
        run.advance(f64::from(k) * 1e-4, &Phase::default()).unwrap();
        let energy = run.sample(&Phase::default()).ledger.strain;
        largest = largest.max(energy);
        assert!((run.strain_work() - energy).abs() < 1e-7 * 14.0, "{energy}");
    }
    assert!(largest > 5.0, "the film was stretched: {largest}");
}
