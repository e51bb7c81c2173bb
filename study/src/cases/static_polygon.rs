//! The end state of the capsule as every run of its design ends: caps of the design's own N-gons, the
//! bottom ring on its stowed N-gon.
//!
//! No outside reference is known. The numbers are billow's own, by the path every run's static
//! references take ([`billow_solver::models::film::static_states`]); the band is wide enough for
//! another minimum of wrinkled film near by, and narrow enough for a change of physics of a percent.

use billow_solver::models::film::static_states;
use billow_solver::scene::paper;

use super::reference::{numbers, rows};
use super::{Outcome, Rig, Row};

/// Volume, rim height and strain energy on this mesh.
fn on_mesh(subdivisions: u32) -> Outcome {
    let bands = numbers("end_state_polygon/bands");
    let scene = paper::capsule(subdivisions, 0.3);
    // The table tells pressures rising; falling ones settle soonest.
    let mut rows = rows("end_state_polygon");
    rows.retain(|row| (row[0] - f64::from(subdivisions)).abs() < 0.5);
    rows.sort_by(|a, b| b[1].total_cmp(&a[1]));
    let pressures: Vec<f64> = rows.iter().map(|row| row[1]).collect();
    let states = static_states(&scene, &pressures).map_err(|error| error.to_string())?;
    let mut judged = Vec::new();
    for (row, state) in rows.iter().zip(states) {
        let values = [
            ("volume, m3", state.volume),
            ("rim height, m", state.z_rim),
            ("strain energy, J", state.strain_energy),
        ];
        for (at, (name, value)) in values.into_iter().enumerate() {
            let name = format!("{name}, at {} Pa, n {subdivisions}", row[1]);
            judged.push(Row::new(&name, value, row[2 + at], bands[at]).with_note(&format!(
                "{} Newton steps, residual {:.1e}",
                state.iterations, state.residual
            )));
        }
    }
    Ok(judged)
}

/// The coarser mesh.
pub fn coarse(_: &Rig) -> Outcome {
    on_mesh(5)
}

/// The finer mesh.
pub fn fine(_: &Rig) -> Outcome {
    on_mesh(8)
}

/// The finest mesh.
pub fn finest(_: &Rig) -> Outcome {
    on_mesh(16)
}
