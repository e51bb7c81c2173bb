//! The model storeys: the paper's capsule against recorded film, and its only time scale.

use billow_solver::models;
use billow_solver::output::outcome::{Deployment, Stop};

use super::prelude::*;

/// CFL number of film, the default of a study.
const CFL: f64 = 0.45;

/// The paper's capsule at 5 g/s until `end_time` (s).
fn scene(end_time: f64) -> Scene {
    let mut scene = paper::capsule(8, end_time);
    scene.film = Film::PAPER;
    scene.solver.model = ModelKind::Storeys;
    scene.solver.stepping = Stepping::Stable(CFL);
    scene.outputs.sample_interval = 1e-3;
    scene
}

fn run(rig: &Rig, scene: &Scene) -> Result<Deployment> {
    let deployment = models::solve(rig.instruction_set, scene, &mut Unobserved)?;
    match deployment.stop {
        Stop::Done => Ok(deployment),
        stop => Err(format!("{stop:?}").into()),
    }
}

/// Times, speed, energy and volume of the paper's capsule.
pub fn capsule(rig: &Rig) -> Outcome {
    let deployment = run(rig, &scene(0.5))?;
    let m = &deployment.measures;
    let rows = [
        ("t_50_z_rim, s", "t_50", m.t_50_z_rim),
        ("t_90_z_rim, s", "t_90", m.t_90_z_rim),
        ("peak_vz, m/s", "peak_vz", m.peak_vz),
        ("peak_kinetic_energy, J", "peak_kinetic_energy", m.peak_kinetic_energy),
        ("first_peak_z_rim, m", "first_peak", m.first_peak_z_rim),
        ("final_volume, m3", "final_volume", m.final_volume),
    ];
    let mut judged: Vec<Row> = rows
        .into_iter()
        .map(|(name, key, value)| {
            let expected = number(&format!("storeys_model/{key}"));
            let band = number(&format!("storeys_model/{key}_band"));
            Row::new(name, value.unwrap_or(f64::NAN), expected, band)
        })
        .collect();
    let residuals = deployment.history.column("ledger_residual");
    let largest = residuals.iter().copied().fold(0.0, f64::max);
    judged.push(Row::at_most("ledger residual", largest, number("storeys_model/ledger_band")));
    Ok(judged)
}

/// Inextensible film without loss and heat has one time scale, (m H²/(ṁ cp T))^(1/3): eight times the rate
/// halves the times.
pub fn similarity(rig: &Rig) -> Outcome {
    let time = |rate: f64, end: f64| -> Result<f64> {
        let mut scene = scene(end);
        scene.film = Film::PAPER.elastic();
        scene.gas.heat_transfer = HeatTransfer::Coefficient(0.0);
        scene.gas.windows = vec![window(0.0, end, rate)];
        scene.outputs.sample_interval = end / 100.0;
        let time = run(rig, &scene)?.measures.t_50_z_rim;
        Ok(time.ok_or("half the height is not reached")?)
    };
    let ratio = time(2e-3, 0.1)? / time(16e-3, 0.05)?;
    let band = number("storeys_model/similarity_band");
    Ok(vec![Row::new("ratio of t_50_z_rim at 2 and 16 g/s", ratio, 2.0, band)])
}
