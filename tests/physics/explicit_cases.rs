//! Film in motion: momentum, the stable step, damping, supports, typed stops.

use billow_solver::deployment::FailureKind;
use billow_solver::film_scene::{FilmSupport, Hold, Motion, Profile};
use billow_solver::gas::GasState;
use billow_solver::integrate::explicit::{Explicit, Interior};
use billow_solver::ledger::Ledger;
use billow_solver::scene::Film;
use billow_solver::state::Field;
use billow_solver::supports::Supports;
use nalgebra::Vector3;

use crate::film_rig::{
    ELASTIC, Piece, at_rest, film_forces, free, icosphere, mapped, nitrogen_gas, pattern, sheet,
};
use crate::rig::PAPER_FILM;

#[test]
fn momentum_and_moment_are_kept_over_a_hundred_thousand_steps() {
    let piece = icosphere(1, 0.5);
    let gas = nitrogen_gas();
    let mut film =
        at_rest(&piece, &PAPER_FILM, Interior::Gas(gas), gas.at_temperature(5e-3, 293.0));
    let spin = Vector3::new(2.0, -3.0, 5.0);
    let kicks = pattern(piece.nodes.len(), 5);
    for (node, (place, kick)) in piece.nodes.iter().zip(kicks).enumerate() {
        film.state
            .velocities
            .set(node, spin.cross(place) + kick * 0.5 + Vector3::new(0.3, 0.1, -0.2));
    }
    let sums = |film: &Explicit| {
        let mass = &film.model.mass;
        let momentum: Vector3<f64> =
            film.state.velocities.iter().zip(mass).map(|(v, m)| v * *m).sum();
        let size: f64 = film.state.velocities.iter().zip(mass).map(|(v, m)| v.norm() * m).sum();
        // The places half a step ago, where these velocities are.
        let back = -0.5 * film.state.last_step;
        let moment: Vector3<f64> = (0..mass.len())
            .map(|i| {
                let v = film.state.velocities.get(i);
                (film.state.places.get(i) + v * back).cross(&v) * mass[i]
            })
            .sum();
        (momentum, moment, size)
    };
    let (momentum, moment, size) = sums(&film);
    let step = film.stable_step();
    film.advance(1e5 * step, &free()).unwrap();
    assert!(film.state.steps >= 100_000);
    let after = sums(&film);
    let (drift, turn) = ((after.0 - momentum).norm() / size, (after.1 - moment).norm() / size);
    println!("{} steps: momentum {drift:e}, moment {turn:e} m of sum |m v|", film.state.steps);
    assert!(drift < 1e-10 && turn < 1e-10, "{drift} {turn}");
}

/// `ω_max` by power iteration on the solver's own forces: a small push, its force.
fn measured_frequency(piece: &Piece, film: &Film) -> f64 {
    let model = piece.model(film);
    let still = Field::zeros(piece.nodes.len());
    let size = 1e-9;
    let mut mode = pattern(piece.nodes.len(), 2);
    let mut value = 0.0_f64;
    for _ in 0..3000 {
        for v in &mut mode {
            v.z = 0.0;
        }
        let norm = mode.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        let pushed = |sign: f64| {
            let mut index = 0;
            let places = mapped(piece, |x| {
                index += 1;
                x + mode[index - 1] * (sign * size / norm)
            });
            film_forces(&model, &places, &still).0.film
        };
        let (ahead, behind) = (pushed(1.0), pushed(-1.0));
        mode = (0..mode.len())
            .map(|node| (behind.get(node) - ahead.get(node)) / (2.0 * size * model.mass[node]))
            .collect();
        value = mode.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
    }
    value.sqrt()
}

#[test]
fn the_step_is_stable_up_to_the_assembled_limit_and_no_further() {
    let piece = sheet(4, 3, 0.2, 0.15);
    let linear = Film { compression: 1.0, ..ELASTIC };
    let omega = measured_frequency(&piece, &linear);
    let grows = |share: f64| {
        let mut film = at_rest(&piece, &linear, Interior::Overpressure(0.0), GasState::default());
        for (node, kick) in pattern(piece.nodes.len(), 4).iter().enumerate() {
            film.state.velocities.set(node, Vector3::new(kick.x, kick.y, 0.0) * 1e-6);
        }
        film.setting.cfl = share * film.model.largest_frequency() / omega;
        let target = 3000.0 * film.stable_step();
        let end = film.advance(target, &free());
        match end {
            Ok(()) => film.state.velocities.iter().map(|v| v.norm()).fold(0.0, f64::max) > 1e-3,
            Err(failure) => {
                assert_eq!(failure.kind, FailureKind::Unstable);
                true
            }
        }
    };
    println!(
        "assembled limit at {} of the element bound",
        omega / piece.model(&linear).largest_frequency()
    );
    assert!(!grows(0.99) && grows(1.01));
}

#[test]
fn mass_damping_slows_free_flight() {
    let piece = sheet(2, 2, 0.1, 0.1);
    let mut film = at_rest(&piece, &PAPER_FILM, Interior::Overpressure(0.0), GasState::default());
    let start = Vector3::new(3.0, -1.0, 2.0);
    film.state.velocities = Field::of(&vec![start; piece.nodes.len()]);
    film.setting.mass_damping = 40.0;
    let kinetic = film.kinetic_energy();
    film.advance(0.03, &free()).unwrap();
    let share = film.velocities().get(4).norm() / start.norm();
    assert!((share / (-1.2_f64).exp() - 1.0).abs() < 1e-3, "{share}");
    let ledger = film.ledger();
    let lost = kinetic - ledger.kinetic;
    assert!((ledger.damping_work / lost - 1.0).abs() < 1e-4, "{ledger:?}");
}

/// A standing wave along a strip of equal elements, held across: its logarithmic decrement is
/// 2π ζ ω/`ω_e`, ω its own frequency.
#[test]
fn viscosity_damps_a_strip_as_its_ratio_says() {
    let (columns, length) = (40, 1.0);
    let mut piece = sheet(columns, 1, length, 0.05);
    // Even columns, all diagonals one way: every element the same.
    piece.triangles.clear();
    for i in 0..columns {
        let (a, d) = (i, i + columns + 1);
        piece.triangles.extend([[a, a + 1, d + 1], [a, d + 1, d]]);
    }
    let piece = Piece::relaxed(piece.nodes, piece.triangles);
    let film = Film { compression: 1.0, viscosity: 0.1, ..PAPER_FILM };
    let mut strip = at_rest(&piece, &film, Interior::Overpressure(0.0), GasState::default());
    let all: Vec<u32> = (0..piece.nodes.len() as u32).collect();
    strip.setting.supports.hold(&all, "yz");
    strip.setting.supports.hold(&[0, columns, columns + 1, 2 * columns + 1], "x");
    let wave = |x: f64| (std::f64::consts::PI * x / length).sin();
    strip.state.velocities = mapped(&piece, |x| Vector3::new(1e-4 * wave(x.x), 0.0, 0.0));
    strip.setting.cfl = 0.1;
    let step = strip.stable_step();
    let centre = columns as usize / 2;
    let (mut peaks, mut last) = (Vec::<(f64, f64)>::new(), [0.0; 3]);
    while peaks.len() < 9 {
        let time = strip.state.time;
        strip.advance(time + step, &free()).unwrap();
        last = [last[1], last[2], strip.state.places.x[centre] - piece.nodes[centre].x];
        let (rise, fall) = (last[1] - last[0], last[2] - last[1]);
        if strip.state.steps > 3 && rise * fall < 0.0 {
            let shift = 0.5 * (rise + fall) / (rise - fall);
            peaks.push((time + shift * step, last[1] + 0.25 * (rise + fall) * shift));
        }
    }
    // Four periods between eight half waves.
    let omega = 8.0 * std::f64::consts::PI / (peaks[8].0 - peaks[0].0);
    let decrement = (peaks[0].1 / peaks[8].1).ln() / 4.0;
    let element = strip.model.frequency[0];
    let expected = std::f64::consts::TAU * film.viscosity * omega / element;
    println!("log decrement {decrement}, expected {expected}");
    assert!((decrement / expected - 1.0).abs() < 1e-3, "{decrement} {expected}");
}

#[test]
fn a_moving_support_does_the_work_it_should() {
    let piece = sheet(6, 3, 0.3, 0.15);
    let mut film = at_rest(&piece, &PAPER_FILM, Interior::Overpressure(0.0), GasState::default());
    let edge = |x: f64| -> Vec<u32> {
        let on = |node: &u32| (piece.nodes[*node as usize].x - x).abs() < 1e-12;
        (0..piece.nodes.len() as u32).filter(on).collect()
    };
    let (left, right) = (edge(0.0), edge(0.3));
    let start = film.ledger();
    let motion = Motion {
        from: 0.0,
        to: 1e-3,
        profile: Profile::Linear,
        translation: Vector3::new(2e-3, 0.5e-3, 1e-3),
        turn: None,
    };
    let hold = Hold::Components([true; 3]);
    let [left, right] = [(left, None), (right, Some(motion))].map(|(nodes, motion)| FilmSupport {
        name: "edge".to_owned(),
        nodes,
        hold,
        motion,
    });
    let right_node = right.nodes[0] as usize;
    film.setting.supports = Supports::new(&[left, right], &film.state.places);
    film.advance(1e-3, &free()).unwrap();
    film.advance(2e-3, &free()).unwrap();
    let end: Ledger = film.ledger();
    println!("moving support: {end:?}, defect {}", end.defect(&start));
    let moved = film.state.places.get(right_node) - piece.nodes[right_node];
    assert!((moved - Vector3::new(2e-3, 0.5e-3, 1e-3)).norm() < 1e-14);
    assert!(end.support_work > 0.09 && end.strain > 0.09 && end.viscous_work > 0.0);
    assert!(end.defect(&start).abs() < 5e-3 * end.support_work, "{}", end.defect(&start));
}

#[test]
fn weight_falls_as_it_should() {
    let piece = icosphere(0, 0.5);
    let mut film = at_rest(&piece, &PAPER_FILM, Interior::Overpressure(0.0), GasState::default());
    film.setting.gravity = Vector3::new(0.0, 0.0, -9.806_65);
    film.advance(0.1, &free()).unwrap();
    let drop = film.state.places.z[0] - piece.nodes[0].z;
    assert!((drop / (-0.5 * 9.806_65 * 0.01) - 1.0).abs() < 1e-12, "{drop}");
    let ledger = film.ledger();
    assert!((ledger.kinetic / ledger.gravity_work - 1.0).abs() < 1e-3, "{ledger:?}");
}

#[test]
fn typed_stops() {
    let piece = icosphere(1, 0.5);
    let gas = nitrogen_gas();
    let mut film =
        at_rest(&piece, &PAPER_FILM, Interior::Gas(gas), gas.at_temperature(1e-3, 293.0));
    film.setting.step_limit = 7;
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!((failure.kind, film.state.steps), (FailureKind::StepLimit, 7));

    film.setting.step_limit = u64::MAX;
    film.setting.cfl = 3.0;
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::Unstable, "{failure:?}");
    assert!(failure.place.starts_with("node ") && failure.time < 0.1, "{failure:?}");

    // Thrown through itself, turned inside out.
    let mut film = at_rest(&piece, &PAPER_FILM, Interior::Gas(gas), GasState::default());
    film.state.velocities = mapped(&piece, |x| x * -400.0);
    let failure = film.advance(1.0, &free()).unwrap_err();
    assert_eq!(failure.kind, FailureKind::InvertedVolume, "{failure:?}");
}
