use super::*;
use crate::models::film::reference_scene;
use crate::scene::paper;

fn soft(youngs_modulus: f64) -> Scene {
    let mut scene = reference_scene(&paper::capsule(2, 0.1));
    scene.film.youngs_modulus = youngs_modulus;
    scene
}

fn ladder(scene: &Scene) -> Ladder {
    Ladder::new(InstructionSet::detect(), scene).unwrap()
}

fn go_on() -> impl FnMut() -> bool {
    || true
}

#[test]
fn a_middle_starts_from_the_upper_end_of_its_interval() {
    assert_eq!(start_of(32), Some(64));
    assert_eq!(start_of(16), Some(32));
    assert_eq!(start_of(48), Some(64));
    assert_eq!(start_of(-16), Some(0));
    assert_eq!(start_of(-48), Some(-32));
    assert_eq!(start_of(0), Some(64));
    assert_eq!(start_of(LOWEST_ERECTED_RUNG * STEPS_PER_RUNG), None);
}

/// Compliant film, where the shape changes most between two rungs.
#[test]
fn interpolated_shapes_are_those_of_a_separate_search() {
    let scene = soft(1e7);
    let mut ladder = ladder(&scene);
    for overpressure in [3.0, 60.0, 432.0, 3000.0] {
        let found = ladder.at(overpressure, &mut go_on()).unwrap();
        let mut capsule = erected(InstructionSet::detect(), &scene).unwrap();
        let exact = capsule.settle(overpressure).unwrap();
        assert!((found.volume / exact.volume - 1.0).abs() < 1e-3, "{overpressure}: {found:?}");
        assert!((found.height / exact.height - 1.0).abs() < 1e-3, "{overpressure}: {found:?}");
    }
}

/// Order and forgotten positions change no bit.
#[test]
fn a_shape_depends_on_its_pressure_alone() {
    let scene = soft(3e8);
    let pressures = [200.0, 15.0, 90.0];
    let mut first = ladder(&scene);
    let forward = pressures.map(|p| first.at(p, &mut go_on()).unwrap());
    let mut second = ladder(&scene);
    let mut backward = pressures;
    backward.reverse();
    let mut backward = backward.map(|p| {
        second.forget_positions();
        second.at(p, &mut go_on()).unwrap()
    });
    backward.reverse();
    assert_eq!(forward, backward);
    assert_eq!(first.design(&mut go_on()), second.design(&mut go_on()));
}

#[test]
fn pressures_without_a_static_equilibrium_have_a_reason() {
    let mut ladder = ladder(&soft(3e8));
    let missing = ladder.at(1e12, &mut go_on()).unwrap_err();
    assert!(matches!(missing, NoReference::Overload { .. }), "{missing}");
    assert_eq!(ladder.at(10.0, &mut || false), Err(NoReference::Stopped));
    assert_eq!(ladder.states(), 0, "a stopped search leaves no state");
}

#[test]
fn a_pressure_below_the_lowest_rung_has_the_shape_of_that_rung() {
    let mut ladder = ladder(&soft(3e8));
    for overpressure in [1e-6, 0.0, -3.0] {
        let found = ladder.at(overpressure, &mut go_on()).unwrap();
        let lowest = ladder.pressure(LOWEST_RUNG * STEPS_PER_RUNG);
        assert_eq!(found.overpressure.to_bits(), lowest.to_bits());
    }
}
