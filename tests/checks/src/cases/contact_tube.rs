//! An inextensible tube squeezed between plates.
//!
//! ```text
//! b = π (R − g/2)        A = b g + π g²/4        force per length = p b,  p = p0 (A0/A)^γ
//! ```
//!
//! Symbols: R radius of the tube, g gap between the flat films, b width of the contact, A area of the
//! section, A0 at the start; m and m². The mesh is a slice between two symmetry planes; end fans close
//! its volume. The pressure is so low that the film hardly stretches.

use billow_solver::geometry::shapes::tube;
use nalgebra::Matrix3;

use super::prelude::*;

/// Elements around the tube.
const AROUND: u32 = 64;
/// Pressure at the start, Pa.
const PRESSURE: f64 = 200.0;
/// Temperature of the gas, K.
const TEMPERATURE: f64 = 293.0;
/// Contact distance, m.
const DISTANCE: f64 = 5e-4;
/// Time at which the plates stop, s.
const CLOSED: f64 = 0.03;
/// Time at which the tube is at rest, s.
const REST: f64 = 0.08;

/// Width of the slice, m: that of one element.
fn width(radius: f64) -> f64 {
    core::f64::consts::TAU * radius / f64::from(AROUND)
}

/// The slice about z between two plates that close to `gap` (m) between the films.
fn slice(radius: f64, gap: f64) -> FilmScene {
    let mut shell: Shell = tube(AROUND, 1, radius, width(radius));
    let tips = shell.close(|_| Matrix3::identity());
    let volume = shell.volume(|node| shell.positions[node as usize]);
    let gas_constant = nitrogen_supply().species.gas_constant;
    let mass = PRESSURE * volume / (gas_constant * TEMPERATURE);
    // The plates start one contact distance off the tube and end one off the film.
    let (start, end) = (radius + DISTANCE, 0.5 * gap + DISTANCE);
    let half = |sign: f64| {
        let up = Vector3::y() * sign;
        plate(up * start, -up, Some((up * (end - start), CLOSED)))
    };
    let mut scene = FilmScene {
        filling: nitrogen_filling(mass, TEMPERATURE),
        supports: vec![held((0..2 * AROUND).collect(), "z"), held(tips, "xyz")],
        contact: Some(FilmContact {
            plates: vec![half(1.0), half(-1.0)],
            ..monitored_contact(DISTANCE)
        }),
        ..free_film(shell, Film { numerical_damping: 0.1, ..Film::PAPER_ELASTIC })
    };
    scene.solver.mass_damping = 300.0;
    scene
}

/// Force and area of the section at both gaps.
pub fn tube_between_plates(rig: &Rig) -> Outcome {
    let radius = number("tube_between_plates/radius");
    let [force_band, area_band] = entry("tube_between_plates", ["force_band", "area_band"]);
    let mut judged = Vec::new();
    for row in rows("tube_between_plates") {
        let (gap, area, force) = (row[0], row[2], row[3]);
        let mut film = rig.start(&slice(radius, gap))?;
        let start = film.view().state.volume;
        let record = run_recorded(&mut film, REST, 8, &Phase::default())?;
        let force_on_plates: f64 =
            film.view().state.contact.plates.iter().map(|plate| 0.5 * plate.force).sum();
        let run = format!("g {gap} m: ");
        let quantity = format!("{run}force per length over p0, N/m/Pa");
        let of_plates = force_on_plates / width(radius) / PRESSURE;
        judged.push(Row::new(&quantity, of_plates, force, force_band));
        let share = film.view().state.volume / start;
        judged.push(Row::new(&format!("{run}A/A0"), share, area, area_band));
        judged.extend(record.rows(&run, number("contact/ledger_band")));
    }
    Ok(judged)
}
