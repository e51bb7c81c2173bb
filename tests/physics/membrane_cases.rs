//! Invalid films, film of several moduli, and the factors of damping. Rigid motions and momentum are reference cases of
//! `billow-checks validate`, the stable step is a map of `billow-checks stability`.

use billow_solver::geometry::shapes::sheet;
use billow_solver::mechanics::film_model::FilmError;
use billow_solver::mechanics::forces::damping;
use billow_solver::mechanics::forces::membrane::strain_energy;

use crate::film_rig::{film_forces, mapped, model};
use crate::prelude::*;

#[test]
fn invalid_films_are_refused() {
    let piece = sheet(2, 2, 0.1, 0.1);
    let model = |piece: &Shell, nodes| {
        FilmModel::new(&Film::PAPER_ELASTIC, nodes, &piece.triangles, &piece.reference).unwrap_err()
    };
    assert_eq!(model(&piece, 10), FilmError::LooseNode { node: 9 });
    assert!(matches!(model(&piece, 8), FilmError::UnknownNode { nodes: 8, .. }));
    let mut turned = piece.clone();
    turned.reference[3].swap(0, 1);
    assert!(matches!(model(&turned, 9), FilmError::DegenerateElement { element: 3, .. }));
}

#[test]
fn damping_factors_match_their_closed_forms() {
    assert_eq!(damping::kick_factors(0.0, 1e-3), (1.0, 1e-3));
    let (keep, gain) = damping::kick_factors(2.0, 0.5);
    assert!((keep - 1.0 / 3.0).abs() < 1e-15 && (gain - 1.0 / 3.0).abs() < 1e-15);
    assert!((damping::stable_share(0.1) - 0.904_987_562_112_089).abs() < 1e-14);
}

#[test]
fn an_element_of_a_factor_is_film_of_that_modulus() {
    let shell = sheet(3, 2, 0.3, 0.2);
    let stiff = Film { numerical_damping: 0.1, ..Film::PAPER_ELASTIC };
    let soft = Film { youngs_modulus: 1e-3 * stiff.youngs_modulus, ..stiff };
    let (whole, expected) = (model(&shell, &stiff), model(&shell, &soft));
    let found = whole.clone().with_stiffness(&vec![1e-3; shell.triangles.len()]);
    assert_eq!(found.mass, expected.mass);
    let stretched = mapped(&shell, |x| Vector3::new(1.01 * x.x, 1.004 * x.y + 0.002 * x.x, 0.0));
    let forces = [&found, &expected].map(|model| film_forces(model, &stretched));
    // Forces of inner nodes cancel: the largest one is the measure.
    let nodes = 0..shell.positions.len();
    let largest = nodes.clone().map(|node| forces[1].film(node).norm()).fold(0.0, f64::max);
    for node in nodes {
        let [found, expected] = forces.each_ref().map(|forces| forces.film(node));
        assert!((found - expected).norm() <= 1e-13 * largest, "{found} {expected}");
    }
    for element in 0..shell.triangles.len() {
        let ratio = |column: fn(&FilmModel) -> &Vec<f64>| {
            column(&found)[element] / column(&expected)[element] - 1.0
        };
        assert!(ratio(|model| &model.frequency).abs() < 1e-14);
        assert!(ratio(|model| &model.damping_time).abs() < 1e-14);
    }
    // Half soft: the stiff elements bound the step.
    let factors: Vec<f64> =
        (0..shell.triangles.len()).map(|element| if element < 4 { 1e-3 } else { 1.0 }).collect();
    let mixed = whole.clone().with_stiffness(&factors);
    assert!(mixed.largest_frequency() > 0.5 * whole.largest_frequency());
    let energy = |model: &FilmModel| strain_energy(model, &stretched);
    assert!(energy(&found) < energy(&mixed) && energy(&mixed) < energy(&whole));
}
