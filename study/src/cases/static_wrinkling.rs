//! Wrinkled film in its plane: a bent strip and a twisted annulus.
//!
//! ```text
//! beam     k = E t h² κ/(2P):  2M/(P h) = k/3 for k ≤ 1, else 1 − 2/(3√k)
//! ```
//!
//! Half the beam stands between a plane of symmetry and a rigid plane tilted by κ L, pushed by P
//! along its normal; the film slides on both. P and M are what the first bears, M about the middle of
//! the section. The annulus's inner edge is turned; its torque is what it bears, its wrinkle radius
//! the outer edge of the last ring most of whose elements are wrinkled.

use billow_solver::geometry::shapes::{grid, nodes_where, revolved, ring_nodes};
use billow_solver::mechanics::material::Regime;
use billow_solver::mechanics::resultants::resultants;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
use billow_solver::scene::motion::{Motion, Profile, Turn};
use billow_solver::scene::paper::free_film;
use nalgebra::Vector3;

use super::reference::{number, rows};
use super::rig::held;
use super::row::order;
use super::static_equilibrium::equilibrium;
use super::{Outcome, Rig, Row};

/// Height and half length of the beam, m.
const BEAM: f64 = 0.2;
/// Strain of its most stretched fibre: small, so that its shape stays straight.
const STRAIN: f64 = 1e-4;

/// k and 2M/(P h) of a beam bent and pulled so that k is about `asked`.
fn bend(rows: u32, asked: f64) -> Result<[f64; 2], String> {
    let film = Film::PAPER_ELASTIC;
    let stiffness = film.youngs_modulus * film.thickness;
    // The whole section is stretched while k ≤ 1: P = E t h ε_mean, ε_max = ε_mean + κ h/2.
    let curvature = if asked > 1.0 {
        STRAIN * asked.sqrt() / BEAM
    } else {
        STRAIN / (BEAM * (0.5 / asked + 0.5))
    };
    let pull = 0.5 * stiffness * BEAM * BEAM * curvature / asked;
    let turn = curvature * BEAM;
    let reference = grid(rows, rows, BEAM, BEAM);
    let mut shell = reference.clone();
    let (sin, cos) = libm::sincos(turn);
    for place in &mut shell.positions {
        // The end on its plane, all between spread evenly.
        place.x -= place.x / BEAM * (place.y - 0.5 * BEAM) * sin / cos;
    }
    let normal = Vector3::new(cos, sin, 0.0);
    let end = nodes_where(&reference, |x| x.x >= BEAM);
    let wall = nodes_where(&reference, |x| x.x <= 0.0);
    let all = nodes_where(&reference, |_| true);
    let foot = nodes_where(&reference, |x| x.x <= 0.0 && (x.y - BEAM).abs() < 1e-9);
    let body = Hold::Body(PlaneBody { normal, mass: 1.0, velocity: 0.0, force: pull });
    let supports = vec![
        FilmSupport { name: "end".to_owned(), nodes: end, hold: body, motion: None },
        held(wall.clone(), "x"),
        held(foot, "y"),
        held(all, "z"),
    ];
    let (state, _) = equilibrium(&FilmScene { supports, ..free_film(shell, film) })?;
    let (mut force, mut moment) = (0.0, 0.0);
    for node in wall {
        let own = state.forces.x[node as usize];
        force += own;
        moment += own * (reference.positions[node as usize].y - 0.5 * BEAM);
    }
    // Stretched fibres lie where the wall is pulled inward.
    let found = 0.5 * stiffness * BEAM * BEAM * curvature / force;
    Ok([found, (2.0 * moment / (force * BEAM)).abs()])
}

/// The bent strip.
pub fn beam(_: &Rig) -> Outcome {
    let band = number("beam/band");
    let mut judged = Vec::new();
    for row in rows("beam") {
        let (asked, expected) = (row[0], row[1]);
        let values = [bend(8, asked)?, bend(16, asked)?, bend(32, asked)?];
        let errors = values.map(|[_, value]| value / expected - 1.0);
        judged.push(
            Row::new(&format!("2M/(P h) at k {asked}"), values[2][1], expected, band)
                .with_order(order(errors[1], errors[2]))
                .with_errors(errors)
                .with_note(&format!("k {:.6}", values[2][0])),
        );
    }
    Ok(judged)
}

/// Torque and wrinkle radius of an annulus turned by this angle, rad.
fn twist(rings: u32, angle: f64) -> Result<([f64; 2], String), String> {
    let [inner, outer, outward] = ["inner_radius", "outer_radius", "outward"]
        .map(|key| number(&format!("annulus_torsion/{key}")));
    let around = 6 * rings;
    let at = |k: u32| inner + (outer - inner) * f64::from(k) / f64::from(rings);
    let shell = revolved(rings, around, true, |k| [at(k), 0.0]);
    let mut pulled = shell.clone();
    for place in &mut pulled.positions {
        let r = place.norm();
        *place *= 1.0 + outward / r * (r - inner) / (outer - inner);
    }
    let motion = Motion {
        from: 0.0,
        to: 1.0,
        profile: Profile::Linear,
        translation: Vector3::zeros(),
        turn: Some(Turn { axis: Vector3::z(), centre: Vector3::zeros(), angle }),
    };
    let all: Vec<u32> = (0..(rings + 1) * around).collect();
    let hub = FilmSupport { motion: Some(motion), ..held(ring_nodes(0, around), "xyz") };
    let supports = vec![hub, held(ring_nodes(rings, around), "xyz"), held(all, "z")];
    let (state, word) =
        equilibrium(&FilmScene { supports, ..free_film(pulled, Film::PAPER_ELASTIC) })?;
    let cells = around as usize * 2;
    let last = (0..rings as usize).rev().find(|ring| {
        let own = ring * cells..(ring + 1) * cells;
        let wrinkled = own.filter(|element| {
            resultants(&state.model, &state.places, *element).regime != Regime::Taut
        });
        2 * wrinkled.count() > cells
    });
    let wrinkle = last.map_or(inner, |ring| at(u32::try_from(ring + 1).unwrap_or(rings)));
    Ok(([state.reactions[0].moment.z.abs(), wrinkle], word))
}

/// The twisted annulus at four angles.
pub fn annulus_torsion(_: &Rig) -> Outcome {
    let band = number("annulus_torsion/band");
    let [inner, outer] =
        ["inner_radius", "outer_radius"].map(|key| number(&format!("annulus_torsion/{key}")));
    let finest = 40;
    let mut judged = Vec::new();
    for row in rows("annulus_torsion") {
        let (angle, torque, radius) = (row[0], row[1], row[2]);
        let (values, word) = twist(finest, angle)?;
        let errors = [
            twist(finest / 4, angle)?.0[0] / torque - 1.0,
            twist(finest / 2, angle)?.0[0] / torque - 1.0,
            values[0] / torque - 1.0,
        ];
        judged.push(
            Row::new(&format!("torque at {angle} rad, N m"), values[0], torque, band)
                .with_order(order(errors[1], errors[2]))
                .with_errors(errors)
                .with_note(&word),
        );
        let element = (outer - inner) / f64::from(finest);
        judged.push(
            Row::at_most(
                &format!("wrinkle radius off at {angle} rad, elements"),
                (values[1] - radius).abs() / element,
                1.0,
            )
            .with_note(&format!("{:.4} m", values[1])),
        );
    }
    Ok(judged)
}
