//! Contact distance and imperfection of a capsule are the same on every mesh of its design.

use billow_solver::models::film::capsule;
use billow_solver::models::film::reference_gap::reference_gap;
use billow_solver::scene::paper;

use crate::film_rig::stowed;
use crate::prelude::*;

/// The paper's capsule, and one of another fit with a higher stack that turns in alternate directions.
fn scenes(subdivisions: u32) -> [Scene; 2] {
    let paper = paper::capsule(subdivisions, 0.1);
    let design = FoldDesign {
        fit: Fit::Height,
        panels: 8,
        storeys: 4,
        top_radius: None,
        alpha1_over_phi: Some(1.0),
        chirality: Chirality::Alternate,
        stowed_height: 0.06,
        ..paper.design.folded().unwrap().clone()
    };
    [paper.clone(), Scene { design: design.into(), ..paper }]
}

/// The stowed capsule of a scene with contact.
fn with_contact(scene: &Scene) -> FilmRun {
    let contact = Some(FilmContact::of(&scene.contact));
    FilmRun::from_scene(InstructionSet::detect(), scene, DEFAULT_CFL, contact).unwrap()
}

fn contact_distance(scene: &Scene) -> f64 {
    with_contact(scene).view().system.contact.as_ref().unwrap().distance
}

/// Positions of the nodes at the start, m.
fn start(scene: &Scene) -> Vec<Vector3<f64>> {
    stowed(InstructionSet::detect(), scene, DEFAULT_CFL).shell.positions
}

/// Displacements of the imperfection: position without it (m), displacement (m).
fn imperfection(scene: &Scene) -> Vec<(Vector3<f64>, f64)> {
    let perfect = start(&Scene { seed: 0, ..scene.clone() });
    let nodes = perfect.iter().zip(start(scene));
    nodes.map(|(perfect, node)| (*perfect, node.z - perfect.z)).collect()
}

/// The default is 0.4 of the smallest gap of the mesh of 16 subdivisions.
#[test]
fn the_default_contact_distance_is_the_same_on_every_mesh() {
    for (index, fine) in scenes(16).into_iter().enumerate() {
        let mut film = stowed(InstructionSet::detect(), &fine, DEFAULT_CFL);
        film.contact = Some(FilmContact::default());
        let film = capsule::start(&film, &[]).unwrap();
        let expected = film.view().system.contact.as_ref().unwrap().distance;
        let gap = reference_gap(fine.design.folded().unwrap()).unwrap();
        assert!((expected - 0.4 * gap).abs() < 1e-9 * gap, "{expected} {gap}");
        let [first, rest @ ..] = [3, 5, 8, 12].map(|n| contact_distance(&scenes(n)[index]));
        assert!((first - 0.4 * gap).abs() < 1e-15, "{first} {gap}");
        assert!(rest.iter().all(|distance| (distance - first).abs() < 1e-15), "{rest:?}");
    }
    let paper = reference_gap(scenes(3)[0].design.folded().unwrap()).unwrap();
    assert!((paper - 0.791_899_699e-3).abs() < 2.5e-12, "{paper}");
}

#[test]
fn the_imperfection_is_the_same_on_every_mesh() {
    for index in [0, 1] {
        let scene = |n: u32| Scene { seed: 3, ..scenes(n)[index].clone() };
        let amplitude = 0.2 * reference_gap(scene(8).design.folded().unwrap()).unwrap();
        let largest =
            imperfection(&scene(8)).iter().fold(0.0_f64, |most, (_, x)| most.max(x.abs()));
        assert!((largest - amplitude).abs() < 1e-15, "{largest} {amplitude}");
        let coarse = imperfection(&scene(3));
        let mut compared = 0;
        for n in [5, 8, 12] {
            for (position, moved) in imperfection(&scene(n)) {
                let same = coarse.iter().find(|(other, _)| (other - position).norm() < 1e-12);
                let Some((_, expected)) = same else { continue };
                assert!((moved - expected).abs() < 1e-15, "n {n}: {moved} {expected}");
                compared += 1;
            }
        }
        // At least the corners of the facets are nodes of every mesh.
        assert!(compared > 60, "{compared}");
    }
}

#[test]
fn a_given_distance_and_a_given_amplitude_are_used() {
    for n in [3, 8] {
        let mut scene = scenes(n)[0].clone();
        scene.contact.distance = Some(2e-4);
        scene.imperfection_amplitude = Some(5e-5);
        scene.seed = 1;
        assert_eq!(contact_distance(&scene).to_bits(), 2e-4_f64.to_bits());
        let largest = imperfection(&scene).iter().fold(0.0_f64, |most, (_, x)| most.max(x.abs()));
        assert!(largest > 4e-5 && largest < 5.000_001e-5, "{largest}");
        scene.imperfection_amplitude = Some(-1e-5);
        assert!(scene.validate().is_err());
    }
}

/// An erected capsule has the lengths of its design as well; it has no imperfection.
#[test]
fn an_erected_capsule_has_the_contact_distance_of_its_design() {
    let scene = Scene { seed: 1, ..scenes(4)[0].clone() };
    let contact =
        capsule::resolved_contact(FilmContact::default(), scene.design.folded().unwrap()).unwrap();
    assert_eq!(contact.distance, Some(contact_distance(&scene)));
    let erected = |seed: u64| {
        let scene = Scene { seed, ..scene.clone() };
        let instruction_set = InstructionSet::detect();
        capsule::film_scene(instruction_set, &scene, Shape::Erected, DEFAULT_CFL).unwrap().1
    };
    assert_eq!(erected(1), erected(0));
}

/// Layers of a fine mesh start closer than the contact distance. Such pairs are no contact at the start.
#[test]
fn film_that_starts_closer_than_the_contact_distance_starts_without_contact() {
    let scene = Scene { seed: 1, ..scenes(48)[0].clone() };
    let mut run = with_contact(&scene);
    run.advance(5e-5, &Phase::default()).unwrap();
    let ledger = run.film.view().ledger();
    assert!(ledger.contact.abs() < 1e-6, "{ledger:?}");
    assert_eq!(run.passages(), 0);
}
