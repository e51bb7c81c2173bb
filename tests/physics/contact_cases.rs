//! Film against film and against plates: what must not pass does not, and nothing is created.

use billow_solver::audit::passages::Watchfulness;
use billow_solver::contact::intersections::intersections;
use billow_solver::contact::plates::Plate;
use billow_solver::contact::{Adhesion, Law};
use billow_solver::film_scene::{Motion, Profile};
use billow_solver::gas::GasState;
use billow_solver::integrate::explicit::{Explicit, Interior, Setting};
use billow_solver::state::Field;
use nalgebra::{Vector2, Vector3};

use crate::film_rig::{Piece, free, icosphere, nitrogen_gas, sheet};
use crate::rig::PAPER_FILM;

/// Several pieces as one film.
fn together(pieces: &[Piece]) -> Piece {
    let (mut nodes, mut triangles, mut reference) = (Vec::new(), Vec::new(), Vec::new());
    for piece in pieces {
        let first = nodes.len() as u32;
        nodes.extend(&piece.nodes);
        triangles.extend(piece.triangles.iter().map(|t| t.map(|node| node + first)));
        reference.extend::<Vec<[Vector2<f64>; 3]>>(piece.reference.clone());
    }
    Piece { nodes, triangles, reference }
}

fn moved(piece: &Piece, map: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Piece {
    Piece { nodes: piece.nodes.iter().map(|x| map(*x)).collect(), ..piece.clone() }
}

/// Film with contact, watched at every step.
fn film(
    piece: &Piece,
    interior: Interior,
    gas: GasState,
    distance: f64,
    adjust: impl Fn(&mut Setting),
    velocity: impl Fn(usize) -> Vector3<f64>,
) -> Explicit {
    let model = piece.model(&PAPER_FILM);
    let places = Field::of(&piece.nodes);
    let mut setting = Setting::free(interior, piece.nodes.len());
    setting.viscosity = PAPER_FILM.viscosity;
    setting.contact = Some(Law::of_film(&model, &places, Some(distance)));
    adjust(&mut setting);
    let velocities: Vec<_> = (0..piece.nodes.len()).map(velocity).collect();
    setting.watch = Some(Watchfulness::EVERY_STEP);
    Explicit::new(model, setting, places, Field::of(&velocities), gas)
}

fn topology(film: &Explicit) -> &billow_solver::contact::topology::Topology {
    &film.setting.contact.as_ref().expect("contact").topology
}

const OPEN: Interior = Interior::Overpressure(0.0);

#[test]
fn films_shot_at_each_other_do_not_pass() {
    let low = sheet(5, 4, 0.5, 0.4);
    let turned = |x: Vector3<f64>| Vector3::new(0.45 - x.y, 0.02 + x.x * 0.9, 0.02 + 0.03 * x.x);
    let high = moved(&sheet(5, 4, 0.5, 0.4), turned);
    let split = low.nodes.len();
    let piece = together(&[low, high]);
    let speed = |node: usize| Vector3::new(0.0, 0.0, if node < split { 25.0 } else { -25.0 });
    let mut film = film(&piece, OPEN, GasState::default(), 2e-3, |_| {}, speed);
    let start = film.ledger();
    film.advance(4e-3, &free()).unwrap();
    let end = film.ledger();
    assert_eq!(film.watch.as_ref().unwrap().passages, 0);
    assert!(intersections(topology(&film), &film.state.places).is_empty());
    // They met, and flew apart: what was below went up at first and is below still.
    let meeting = &film.state.meeting;
    let mean = |range: std::ops::Range<usize>| {
        let count = range.len() as f64;
        range.map(|node| film.state.velocities.z[node]).sum::<f64>() / count
    };
    println!("after: {} {}, {:?}", mean(0..split), mean(split..2 * split), meeting.impulses);
    assert!(mean(0..split) < 0.0 && mean(split..2 * split) > 0.0);
    let momentum: f64 =
        film.model.mass.iter().zip(&film.state.velocities.z).map(|(m, v)| m * v).sum();
    let mass: f64 = film.model.mass.iter().sum();
    let before: f64 = (0..2 * split).map(|node| film.model.mass[node] * speed(node).z).sum();
    assert!((momentum - before).abs() < 1e-10 * mass * 25.0, "{momentum} {before}");
    let defect = end.defect(&start).abs() / start.kinetic;
    println!("ledger {defect:e}, contact keeps {:e}", end.contact / start.kinetic);
    assert!(defect < 1e-2);
    assert!(end.contact.abs() + end.friction_work < 1e-2 * start.kinetic);
}

#[test]
fn friction_slows_a_sliding_film_as_coulomb_says() {
    let low = moved(&sheet(8, 4, 1.0, 0.4), |x| x - Vector3::new(0.2, 0.05, 0.0));
    let high = moved(&sheet(3, 2, 0.2, 0.15), |x| x + Vector3::new(0.0, 0.05, 1e-3));
    let split = low.nodes.len();
    let piece = together(&[low, high]);
    let (mu, gravity, speed) = (0.4, 9.81, 0.5);
    let adjust = |setting: &mut Setting| {
        let all: Vec<u32> = (0..split as u32).collect();
        setting.supports.hold(&all, "xyz");
        setting.gravity = Vector3::new(0.0, 0.0, -gravity);
        setting.contact.as_mut().unwrap().friction = mu;
    };
    let start_speed = |node: usize| Vector3::x() * if node < split { 0.0 } else { speed };
    let mut film = film(&piece, OPEN, GasState::default(), 1e-3, adjust, start_speed);
    let start = film.ledger();
    let time = 0.06;
    film.advance(time, &free()).unwrap();
    let end = film.ledger();
    let nodes = split..piece.nodes.len();
    let mass: f64 = nodes.clone().map(|node| film.model.mass[node]).sum();
    let momentum: f64 =
        nodes.map(|node| film.model.mass[node] * film.state.velocities.x[node]).sum();
    let slowed = speed - momentum / mass;
    println!("slowed by {slowed}, Coulomb {}", mu * gravity * time);
    assert!((slowed / (mu * gravity * time) - 1.0).abs() < 0.03);
    assert!(end.friction_work > 0.0);
    assert!(end.defect(&start).abs() < 1e-3 * start.kinetic, "{}", end.defect(&start));
}

#[test]
fn adhesion_holds_up_to_its_pull_off_pressure() {
    let low = sheet(4, 4, 0.4, 0.4);
    let high = moved(&sheet(3, 3, 0.2, 0.2), |x| x + Vector3::new(0.1, 0.1, 1e-3));
    let split = low.nodes.len();
    let piece = together(&[low, high]);
    let pressure = 2.0;
    let held = |lift: f64| {
        let adjust = |setting: &mut Setting| {
            let all: Vec<u32> = (0..split as u32).collect();
            setting.supports.hold(&all, "xyz");
            // Weight upwards: so much an area.
            let density = PAPER_FILM.density * PAPER_FILM.thickness;
            setting.gravity = Vector3::new(0.0, 0.0, lift / density);
            setting.mass_damping = 200.0;
            let law = setting.contact.as_mut().unwrap();
            law.adhere(Adhesion { pressure, range: 1e-3 });
        };
        let mut film = film(&piece, OPEN, GasState::default(), 1e-3, adjust, |_| Vector3::zeros());
        film.advance(0.05, &free()).unwrap();
        (split..piece.nodes.len()).all(|node| film.state.places.z[node] < 2e-3)
    };
    assert!(held(0.7 * pressure) && !held(1.3 * pressure));
}

fn plate(height: f64, up: bool, motion: Option<Motion>) -> Plate {
    let normal = if up { Vector3::z() } else { -Vector3::z() };
    let point = Vector3::new(0.0, 0.0, height);
    Plate { name: "plate".to_owned(), point, normal, motion, until: f64::INFINITY }
}

fn drop_by(way: f64, to: f64) -> Motion {
    let translation = Vector3::new(0.0, 0.0, way);
    Motion { from: 0.0, to, profile: Profile::Smooth, translation, turn: None }
}

#[test]
fn a_bag_squeezed_to_a_tenth_lets_nothing_through() {
    let radius = 0.2;
    let bag = icosphere(2, radius);
    let gas = nitrogen_gas();
    let time = 0.03;
    let adjust = |setting: &mut Setting| {
        let law = setting.contact.as_mut().unwrap();
        law.plates = vec![
            plate(-radius - 5e-3, true, Some(drop_by(0.9 * radius, time))),
            plate(radius + 5e-3, false, Some(drop_by(-0.9 * radius, time))),
        ];
    };
    let start = gas.at_temperature(2e-7, 293.0);
    let mut film = film(&bag, Interior::Gas(gas), start, 2e-3, adjust, |_| Vector3::zeros());
    let before = film.ledger();
    film.advance(time, &free()).unwrap();
    let after = film.ledger();
    let span = film.state.places.z.iter().fold(0.0_f64, |a, z| a.max(z.abs()));
    println!("squeezed to {span}, {} impulses, {after:?}", film.state.meeting.impulses);
    assert!(span < 0.1 * radius + 5e-3 + 1e-9);
    assert_eq!(film.watch.as_ref().unwrap().passages, 0);
    assert!(intersections(topology(&film), &film.state.places).is_empty());
    let defect = after.defect(&before).abs() / (after.kinetic + after.external());
    assert!(defect < 2e-2, "{defect}");
}

#[test]
fn a_crumpled_sheet_dropped_on_the_floor_lets_nothing_through() {
    let flat = sheet(9, 9, 0.4, 0.4);
    // A crumple that does not cut itself: shortened along x, high waves.
    let wave = |x: Vector3<f64>| {
        let height = 0.03 * (40.0 * x.x).sin() + 0.015 * (31.0 * x.y + 9.0 * x.x).cos();
        Vector3::new(0.5 * x.x, 0.7 * x.y, height + 0.06)
    };
    let crumple = moved(&flat, wave);
    let piece = Piece::relaxed(crumple.nodes, crumple.triangles);
    let adjust = |setting: &mut Setting| {
        setting.gravity = Vector3::new(0.0, 0.0, -500.0);
        setting.contact.as_mut().unwrap().plates = vec![plate(0.0, true, None)];
    };
    let mut film = film(&piece, OPEN, GasState::default(), 2e-3, adjust, |node| {
        Vector3::new(0.0, 0.0, -8.0 - 0.01 * node as f64)
    });
    let before = film.ledger();
    film.advance(0.03, &free()).unwrap();
    let after = film.ledger();
    println!("dropped: {:?} {after:?}", film.state.meeting.contacts.len());
    assert_eq!(film.watch.as_ref().unwrap().passages, 0);
    assert!(intersections(topology(&film), &film.state.places).is_empty());
    assert!(film.state.places.z.iter().all(|z| *z > 0.0));
    let defect = after.defect(&before).abs() / (before.kinetic + after.external());
    assert!(defect < 2e-2, "{defect}");
}

/// Four sheets on the floor under a pressure: every interlayer pressure is the pressure.
#[test]
fn a_stack_passes_its_pressure_on() {
    let load = 200.0;
    for distance in [0.5e-3, 1e-3, 2e-3] {
        let layers: Vec<Piece> = (0..4)
            .map(|layer| {
                let height = distance * f64::from(layer + 1);
                // Each shifted, so that nodes do not lie on nodes.
                let (dx, dy) = (0.011 * f64::from(layer), 0.007 * f64::from(layer));
                moved(&sheet(5, 5, 0.3, 0.3), |x| Vector3::new(x.x + dx, x.y + dy, height))
            })
            .collect();
        let each = layers[0].nodes.len();
        let piece = together(&layers);
        let model = piece.model(&PAPER_FILM);
        let adjust = |setting: &mut Setting| {
            let density = PAPER_FILM.density * PAPER_FILM.thickness;
            // The load as weight of all: layer k bears the weight of those above it.
            setting.gravity = Vector3::new(0.0, 0.0, -load / density);
            setting.mass_damping = 3000.0;
            setting.contact.as_mut().unwrap().plates = vec![plate(0.0, true, None)];
        };
        let mut film =
            film(&piece, OPEN, GasState::default(), distance, adjust, |_| Vector3::zeros());
        film.advance(0.05, &free()).unwrap();
        let floor = film.state.meeting.plates[0].force;
        let area: f64 = model.volume.iter().sum::<f64>() / PAPER_FILM.thickness / 4.0;
        println!("distance {distance}: floor {} of {}", floor / area, 4.0 * load);
        assert!((floor / area / (4.0 * load) - 1.0).abs() < 0.02);
        for layer in 1..4 {
            // Force handed down to all layers below.
            let handed: f64 = film
                .state
                .meeting
                .contacts
                .iter()
                .map(|contact| {
                    let nodes = contact.pair.nodes(topology(&film));
                    let x = billow_solver::contact::at(&film.state.places, nodes);
                    let closest = contact.pair.closest(&x);
                    let gap = closest.squared.sqrt();
                    let up = closest.between.z / gap * contact.force(gap);
                    let lifts = |k: usize| nodes[k] as usize >= layer * each;
                    (0..4).filter(|k| lifts(*k)).map(|k| closest.weights[k] * up).sum::<f64>()
                })
                .sum();
            let expected = load * f64::from(4 - layer as u32);
            println!("  layer {layer}: {} of {expected}", handed / area);
            assert!((handed / area / expected - 1.0).abs() < 0.02);
        }
        assert_eq!(film.watch.as_ref().unwrap().passages, 0);
    }
}
