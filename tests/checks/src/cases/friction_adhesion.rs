//! Friction and adhesion between film and film.
//!
//! ```text
//! friction:  speed loss = μ g t while it slides
//! adhesion:  the sheets separate above the pull-off pressure
//! ```

use super::prelude::*;

/// Contact distance, and initial height of the upper sheet, m.
const DISTANCE: f64 = 1e-3;

/// A held sheet and a free one above it; and the first node of the upper one.
fn two_sheets(low: Shell, high: Shell) -> (FilmScene, usize) {
    let nodes = low.positions.len();
    let count = u32::try_from(nodes).expect("under 2^32 nodes");
    let scene = FilmScene {
        supports: vec![held((0..count).collect(), "xyz")],
        ..free_film(joined(&[low, high]), Film { numerical_damping: 0.1, ..Film::PAPER_ELASTIC })
    };
    (scene, nodes)
}

/// A sheet that slides on another one under its weight.
pub fn friction(rig: &Rig) -> Outcome {
    let (mu, band) = (number("friction/coefficient"), number("friction/band"));
    let (gravity, speed, time) = (9.81, 0.5, 0.06);
    let low = moved(sheet(8, 4, 1.0, 0.4), |x| x - Vector3::new(0.2, 0.05, 0.0));
    let high = moved(sheet(3, 2, 0.2, 0.15), |x| x + Vector3::new(0.0, 0.05, DISTANCE));
    let (scene, split) = two_sheets(low, high);
    let nodes = scene.shell.positions.len();
    let scene = FilmScene {
        velocities: (0..nodes)
            .map(|n| Vector3::x() * if n < split { 0.0 } else { speed })
            .collect(),
        gravity: Vector3::new(0.0, 0.0, -gravity),
        contact: Some(FilmContact { friction: mu, ..monitored_contact(DISTANCE) }),
        ..scene
    };
    let mut film = rig.start(&scene)?;
    let record = run_recorded(&mut film, time, 20, &Phase::default())?;
    let sum = |of: &dyn Fn(usize) -> f64| -> f64 { (split..nodes).map(of).sum() };
    let mass = sum(&|node| film.view().system.model.mass[node]);
    let momentum =
        sum(&|node| film.view().system.model.mass[node] * film.view().state.velocities.x[node]);
    let lost = speed - momentum / mass;
    let dissipated = film.view().ledger().contact_dissipation;
    let mut judged = vec![
        Row::new("speed loss, m/s", lost, mu * gravity * time, band),
        Row::at_least("energy dissipated by friction, J", dissipated, 0.0),
    ];
    judged.extend(record.rows("", number("contact/ledger_band")));
    Ok(judged)
}

/// Heights of the lowest and the highest node of the upper sheet, m, after a pull (Pa) against this
/// pull-off pressure (Pa).
fn pulled(rig: &Rig, pull: f64, pressure: f64) -> Result<[f64; 2]> {
    let low = sheet(16, 16, 0.4, 0.4);
    let high = moved(sheet(4, 4, 0.2, 0.2), |x| x + Vector3::new(0.104, 0.109, DISTANCE));
    let (scene, split) = two_sheets(low, high);
    // The pull is an upward weight per area.
    let density = scene.film.density * scene.film.thickness;
    let mut scene = FilmScene {
        gravity: Vector3::new(0.0, 0.0, pull / density),
        contact: Some(FilmContact {
            adhesion: pressure,
            distance: Some(DISTANCE),
            ..FilmContact::default()
        }),
        ..scene
    };
    scene.solver.mass_damping = 200.0;
    let mut film = rig.start(&scene)?;
    run_recorded(&mut film, 0.05, 10, &Phase::default())?;
    let heights = &film.view().state.positions.z[split..];
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    Ok([lowest, heights.iter().copied().fold(0.0, worse)])
}

/// Adhesive sheets, pulled below and above the pull-off pressure.
pub fn adhesion(rig: &Rig) -> Outcome {
    let [pressure, below, above, parted] =
        entry("adhesion", ["pressure", "below", "above", "parted"]);
    let [_, highest] = pulled(rig, below * pressure, pressure)?;
    let [lowest, _] = pulled(rig, above * pressure, pressure)?;
    Ok(vec![
        Row::at_most(
            &format!("{below} of the pull-off pressure: highest node, m"),
            highest,
            parted,
        ),
        Row::at_least(&format!("{above} of the pull-off pressure: lowest node, m"), lowest, parted),
    ])
}
