//! The end state of the capsule with the caps of its design, N-gons, and the bottom ring held on its
//! stowed N-gon, as in every run.
//!
//! No independent reference exists. The numbers are recorded results of billow, computed like the
//! static references of every run ([`billow_solver::models::film::static_states`]). The band is wide
//! enough for another minimum of wrinkled film, and narrow enough to detect a change of 1 %.

use billow_solver::models::film::static_states;
use billow_solver::scene::paper;

use super::reference::{numbers, rows};
use super::{Outcome, Rig, Row};

/// Volume, rim height and strain energy on this mesh.
fn on_mesh(rig: &Rig, subdivisions: u32) -> Outcome {
    let bands = numbers("end_state_polygon/bands");
    let scene = paper::capsule(subdivisions, 0.3);
    // The table has rising pressures; falling ones converge faster.
    let mut rows = rows("end_state_polygon");
    rows.retain(|row| (row[0] - f64::from(subdivisions)).abs() < 0.5);
    rows.sort_by(|a, b| b[1].total_cmp(&a[1]));
    let pressures: Vec<f64> = rows.iter().map(|row| row[1]).collect();
    let states = static_states(rig.instruction_set, &scene, &pressures)
        .map_err(|error| error.to_string())?;
    let mut judged = Vec::new();
    for (row, state) in rows.iter().zip(states) {
        let values = [
            ("volume, m3", state.volume),
            ("rim height, m", state.z_rim),
            ("strain energy, J", state.strain_energy),
        ];
        for (index, (name, value)) in values.into_iter().enumerate() {
            let name = format!("{name}, at {} Pa, n {subdivisions}", row[1]);
            judged.push(Row::new(&name, value, row[2 + index], bands[index]).with_note(&format!(
                "{} Newton steps, residual {:.1e}",
                state.iterations, state.residual
            )));
        }
    }
    Ok(judged)
}

/// The coarser mesh.
pub fn coarse(rig: &Rig) -> Outcome {
    on_mesh(rig, 5)
}

/// The finer mesh.
pub fn fine(rig: &Rig) -> Outcome {
    on_mesh(rig, 8)
}

/// The finest mesh.
pub fn finest(rig: &Rig) -> Outcome {
    on_mesh(rig, 16)
}
