//! Wrinkled film in its plane: a strip in bending and an annulus in torsion.
//!
//! ```text
//! beam     k = E t h² κ/(2P):  2M/(P h) = k/3 for k ≤ 1, else 1 − 2/(3√k)
//! ```
//!
//! Half the beam lies between a plane of symmetry and a rigid plane that is tilted by κ L and loaded by
//! P along its normal. The film slides on both. P and M are the reactions of the plane of symmetry, M
//! about the middle of the section. The inner edge of the annulus is rotated; the torque is its
//! reaction. The wrinkle radius is the outer radius of the last ring in which most elements are
//! wrinkled.

use billow_solver::geometry::shapes::{grid, nodes_where, revolved};
use billow_solver::mechanics::material::Regime;

use super::prelude::*;

/// Height and half length of the beam, m.
const BEAM: f64 = 0.2;
/// Strain of its most stretched fibre. Chosen: small, so that the geometry hardly changes.
const STRAIN: f64 = 1e-4;

/// 2M/(P h) of a beam whose curvature and force give about the requested k.
fn bend(rig: &Rig, rows: u32, requested: f64) -> Result<f64> {
    let film = Film::PAPER_ELASTIC;
    let stiffness = film.youngs_modulus * film.thickness;
    // The whole section is stretched while k ≤ 1: P = E t h ε_mean, ε_max = ε_mean + κ h/2.
    let curvature = if requested > 1.0 {
        STRAIN * requested.sqrt() / BEAM
    } else {
        STRAIN / (BEAM * (0.5 / requested + 0.5))
    };
    let pull = 0.5 * stiffness * BEAM * BEAM * curvature / requested;
    let turn = curvature * BEAM;
    let reference = grid(rows, rows, BEAM, BEAM);
    let mut shell = reference.clone();
    let (sin, cos) = libm::sincos(turn);
    for position in &mut shell.positions {
        // The end lies on its plane; the displacement between is linear.
        position.x -= position.x / BEAM * (position.y - 0.5 * BEAM) * sin / cos;
    }
    let normal = Vector3::new(cos, sin, 0.0);
    let end = nodes_where(&reference, |x| x.x >= BEAM);
    let wall = nodes_where(&reference, |x| x.x <= 0.0);
    let all = nodes_where(&reference, |_| true);
    let foot = nodes_where(&reference, |x| x.x <= 0.0 && (x.y - BEAM).abs() < 1e-9);
    let plane = PlaneBody { normal, mass: 1.0, velocity: 0.0, force: pull };
    let supports =
        vec![on_plane(end, plane), held(wall.clone(), "x"), held(foot, "y"), held(all, "z")];
    let state = equilibrium(rig, &FilmScene { supports, ..free_film(shell, film) }, None)?;
    let (mut force, mut moment) = (0.0, 0.0);
    for node in wall {
        let reaction = state.forces.x[node as usize];
        force += reaction;
        moment += reaction * (reference.positions[node as usize].y - 0.5 * BEAM);
    }
    Ok((2.0 * moment / (force * BEAM)).abs())
}

/// The strip in bending.
pub fn beam(rig: &Rig) -> Outcome {
    let band = number("beam/band");
    each("beam", |row| {
        let (requested, expected) = (row[0], row[1]);
        let quantity = format!("2M/(P h) at k {requested}");
        refined([8, 16, 32], [(quantity, expected, band)], None, |rows| {
            bend(rig, rows, requested).map(|moment| [moment])
        })
    })
}

/// Torque and wrinkle radius of an annulus in torsion by this angle, rad.
fn twist(rig: &Rig, rings: u32, angle: f64) -> Result<[f64; 2]> {
    let [inner, outer, outward] =
        entry("annulus_torsion", ["inner_radius", "outer_radius", "outward"]);
    let around = 6 * rings;
    let radius = |k: u32| inner + (outer - inner) * f64::from(k) / f64::from(rings);
    let shell = revolved(rings, around, true, |k| [radius(k), 0.0]);
    let mut pulled = shell.clone();
    for position in &mut pulled.positions {
        let r = position.norm();
        *position *= 1.0 + outward / r * (r - inner) / (outer - inner);
    }
    let motion = Motion {
        from: 0.0,
        to: 1.0,
        profile: Profile::Linear,
        translation: Vector3::zeros(),
        rotation: Some(Rotation { axis: Vector3::z(), centre: Vector3::zeros(), angle }),
    };
    let all: Vec<u32> = (0..(rings + 1) * around).collect();
    let hub = FilmSupport { motion: Some(motion), ..held(ring_nodes(0, around), "xyz") };
    let supports = vec![hub, held(ring_nodes(rings, around), "xyz"), held(all, "z")];
    let scene = FilmScene { supports, ..free_film(pulled, Film::PAPER_ELASTIC) };
    let state = equilibrium(rig, &scene, None)?;
    let cells = around as usize * 2;
    let last = (0..rings as usize).rev().find(|ring| {
        let elements = ring * cells..(ring + 1) * cells;
        let wrinkled = elements.filter(|element| {
            resultants(&state.model, &state.positions, *element).regime != Regime::Taut
        });
        2 * wrinkled.count() > cells
    });
    let wrinkle = last.map_or(inner, |ring| radius(u32::try_from(ring + 1).unwrap_or(rings)));
    Ok([state.reactions[0].moment.z.abs(), wrinkle])
}

/// The annulus at four angles.
pub fn annulus_torsion(rig: &Rig) -> Outcome {
    let band = number("annulus_torsion/band");
    let [inner, outer] = entry("annulus_torsion", ["inner_radius", "outer_radius"]);
    let finest = 40;
    let mut judged = Vec::new();
    for row in rows("annulus_torsion") {
        let (angle, torque, radius) = (row[0], row[1], row[2]);
        let quantity = format!("torque at {angle} rad, N m");
        let mut wrinkle = f64::NAN;
        let meshes = [finest / 4, finest / 2, finest];
        judged.extend(refined(meshes, [(quantity, torque, band)], None, |rings| {
            let [torque, found] = twist(rig, rings, angle)?;
            wrinkle = found;
            Ok([torque])
        })?);
        let element = (outer - inner) / f64::from(finest);
        let quantity = format!("error of the wrinkle radius at {angle} rad, elements");
        judged.push(Row::at_most(&quantity, (wrinkle - radius).abs() / element, 1.0));
    }
    Ok(judged)
}
