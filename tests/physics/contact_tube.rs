//! An inextensible tube squeezed between plates, against its closed form.
//!
//! ```text
//! b = π (R − g/2)        A = b g + π g²/4        F/length = p b,  p = p0 (A0/A)^γ
//! ```

use billow_solver::contact::plates::Plate;
use billow_solver::course::Phase;
use billow_solver::film_scene::{
    Filling, FilmContact, FilmOutputs, FilmScene, FilmSolver, FilmSupport, Hold, Motion, Profile,
};
use billow_solver::ladder::film::capsule;
use billow_solver::shell::Shell;
use billow_solver::simd::Path;
use nalgebra::Vector3;

use crate::rig::{PAPER_FILM, supply};

const RADIUS: f64 = 0.1;
const AROUND: u32 = 96;
const PI: f64 = std::f64::consts::PI;

/// A slice of the tube between two symmetry planes, its gas closed by end fans, between two plates
/// that close to `gap` (m) between them.
fn slice(gap: f64, pressure: f64, distance: f64, time: f64) -> FilmScene {
    let width = 2.0 * PI * RADIUS / f64::from(AROUND);
    let mut nodes = Vec::new();
    for z in [0.0, width] {
        for k in 0..AROUND {
            let angle = 2.0 * PI * f64::from(k) / f64::from(AROUND);
            nodes.push(Vector3::new(RADIUS * angle.cos(), RADIUS * angle.sin(), z));
        }
    }
    let mut triangles = Vec::new();
    for k in 0..AROUND {
        let [a, b] = [k, (k + 1) % AROUND];
        let [c, d] = [b + AROUND, a + AROUND];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    let mut shell = Shell::relaxed(nodes, triangles);
    let tips = shell.close();
    let supports = vec![
        FilmSupport {
            name: "symmetry".to_owned(),
            nodes: (0..2 * AROUND).collect(),
            hold: Hold::Components([false, false, true]),
            motion: None,
        },
        FilmSupport {
            name: "tips".to_owned(),
            nodes: tips,
            hold: Hold::Components([true; 3]),
            motion: None,
        },
    ];
    // The plates start just off the tube.
    let start = RADIUS + distance;
    let plate = |sign: f64| Plate {
        name: "plate".to_owned(),
        point: Vector3::new(0.0, sign * start, 0.0),
        normal: Vector3::new(0.0, -sign, 0.0),
        motion: Some(Motion {
            from: 0.0,
            to: time,
            profile: Profile::Smooth,
            translation: Vector3::new(0.0, -sign * (start - 0.5 * gap), 0.0),
            turn: None,
        }),
        until: f64::INFINITY,
    };
    let places = &shell.positions;
    let volume = shell.volume(|node| places[node as usize]);
    let mut supply = supply();
    supply.initial_mass = pressure * volume / (supply.species.gas_constant * 293.0);
    FilmScene {
        shell,
        velocities: Vec::new(),
        film: PAPER_FILM,
        filling: Filling::Gas { supply, initial_temperature: 293.0 },
        supports,
        contact: Some(FilmContact {
            distance: Some(distance),
            plates: vec![plate(1.0), plate(-1.0)],
            ..FilmContact::default()
        }),
        gravity: Vector3::zeros(),
        release_time: 0.0,
        solver: FilmSolver {
            cfl: 0.45,
            end_time: 2.0 * time,
            statics: false,
            mass_damping: 400.0,
            step_limit: u64::MAX,
            path: Path::best(),
        },
        outputs: FilmOutputs { sample_interval: time, nodes: Vec::new(), elements: Vec::new() },
    }
}

#[test]
fn a_tube_between_plates_pushes_as_it_should() {
    let pressure = 1000.0;
    for gap in [0.15, 0.1] {
        let scene = slice(gap, pressure, 5e-4, 0.05);
        let mut film = capsule::start(&scene).unwrap();
        film.advance(0.15, &Phase::default()).unwrap();
        // The gap of the closed form is that between the films where they lie flat.
        let heights = || film.state.places.y.iter().take(2 * AROUND as usize);
        let top = heights().fold(0.0_f64, |top, y| top.max(*y));
        let gap = 2.0 * top;
        // The polygon's own circumference and area, so that its facets are no error.
        let facet = 2.0 * RADIUS * (PI / f64::from(AROUND)).sin();
        let radius = f64::from(AROUND) * facet / (2.0 * PI);
        let contact = PI * (radius - 0.5 * gap);
        let area = contact * gap + PI * gap * gap / 4.0;
        let start =
            0.5 * f64::from(AROUND) * RADIUS * RADIUS * (2.0 * PI / f64::from(AROUND)).sin();
        let width = 2.0 * PI * RADIUS / f64::from(AROUND);
        let force = film.state.meeting.plates[0].force / width;
        let expected = pressure * (start / area).powf(1.4) * contact;
        let enclosed = film.state.volume / width;
        println!(
            "gap {gap}: force {force} of {expected} ({:e}), area {enclosed} of {area} ({:e})",
            force / expected - 1.0,
            enclosed / area - 1.0
        );
        assert!((force / expected - 1.0).abs() < 0.01);
        assert!((enclosed / area - 1.0).abs() < 0.002);
        assert_eq!(film.watch.as_ref().unwrap().passages, 0);
    }
}
