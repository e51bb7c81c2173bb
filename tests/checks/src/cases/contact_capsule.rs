//! Deployment of the paper's folded capsule with contact.
//!
//! ```text
//! passages = intersections = 0      residual as in the ledger      z_centre(t), max vz, max ½ Σ m v², V
//! ```
//!
//! It runs as in a study: packed pattern, gas, contact, tunnelling monitor.

use billow_solver::geometry::fold::Chirality;
use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{self, Unobserved};
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::scene::DEFAULT_CFL;
use billow_solver::scene::Scene;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::monitor_settings::MonitorSettings;
use billow_solver::scene::paper;
use billow_solver::scene::timeline::Timeline;

use super::contact_rig::unrecovered_contact_energy;
use super::reference::number;
use super::row::worse;
use super::{Outcome, Rig, Row};

/// The run of a stowed capsule with this contact.
///
/// # Errors
/// What is invalid in the scene.
pub fn stowed(rig: &Rig, scene: &Scene, contact: FilmContact) -> Result<FilmRun, String> {
    FilmRun::from_scene(rig.instruction_set, scene, DEFAULT_CFL, Some(contact))
        .map_err(|e| e.to_string())
}

/// Runs a scene with this contact to its end.
fn deploy(rig: &Rig, scene: &Scene, contact: FilmContact) -> Result<(FilmRun, Deployment), String> {
    let mut run = stowed(rig, scene, contact)?;
    run.film = rig.faulty(run.film);
    let deployment = run::run(&mut run, &Timeline::new(scene), &mut Unobserved);
    match &deployment.stop {
        Stop::Done => Ok((run, deployment)),
        Stop::Cancelled => Err("cancelled".to_owned()),
        Stop::Failed(failure) => {
            Err(format!("{} at {} s: {}", failure.kind.name(), failure.time, failure.place))
        }
    }
}

/// Rows of every run of a capsule.
fn common_rows(run: &FilmRun, deployment: &Deployment, name: &str, ledger_band: f64) -> Vec<Row> {
    let audit = &deployment.audit;
    let count = |counted: Option<u64>| counted.map_or(f64::NAN, |counted| counted as f64);
    let peak = deployment.history.column("kinetic_energy").iter().copied().fold(0.0, worse);
    let accounting = run.view().accounting();
    let note = format!(
        "{} elements, {} steps, {} broad-phase rebuilds, {} collision impulses",
        deployment.elements,
        deployment.steps,
        accounting.broad_phase_rebuilds,
        accounting.collision_impulses
    );
    vec![
        Row::at_most(&format!("{name}passages"), count(audit.passages), 0.0).with_note(&note),
        Row::at_most(&format!("{name}intersections"), count(audit.intersections), 0.0),
        Row::at_most(&format!("{name}film energy residual"), audit.ledger_residual, ledger_band),
        Row::at_most(
            &format!("{name}unrecovered contact energy"),
            unrecovered_contact_energy(&run.film.view()) / peak,
            number("contact/not_returned_band"),
        ),
    ]
}

/// The coarsest capsule, every step monitored: tension field and full membrane stiffness, both
/// chiralities.
pub(super) fn capsule_every_step(rig: &Rig) -> Outcome {
    let monitor = MonitorSettings::EVERY_STEP;
    let mut judged = Vec::new();
    for (compression, key) in [(0.0, "ledger_band"), (1.0, "compressed_ledger_band")] {
        for (chirality, name) in [(Chirality::Same, "same"), (Chirality::Alternate, "alternate")] {
            let mut scene = paper::capsule(2, 0.1);
            scene.film.compression = compression;
            scene.design.chirality = chirality;
            let contact = FilmContact { monitor, ..FilmContact::default() };
            let (run, deployment) = deploy(rig, &scene, contact)?;
            let name = format!("c {compression}, {name} chirality: ");
            judged.extend(common_rows(&run, &deployment, &name, number(&format!("contact/{key}"))));
        }
    }
    Ok(judged)
}

/// When a series first reaches a level, linear between samples; NaN if it never does.
fn first_time_at(time: &[f64], series: &[f64], level: f64) -> f64 {
    let Some(next) = series.iter().position(|value| *value >= level) else { return f64::NAN };
    let Some(last) = next.checked_sub(1) else { return time[0] };
    let fraction = (level - series[last]) / (series[next] - series[last]);
    time[last] + fraction * (time[next] - time[last])
}

/// A row whose value must lie between the reference numbers `entry/from` and `entry/to`.
fn between(quantity: &str, value: f64, entry: &str) -> Row {
    let [from, to] = ["from", "to"].map(|key| number(&format!("capsule_deployed/{entry}/{key}")));
    Row::within(quantity, value, from, to)
}

/// 5 g/s for 0.3 s on this mesh.
fn deployed(rig: &Rig, subdivisions: u32) -> Outcome {
    let scene = paper::capsule(subdivisions, 0.3);
    let (run, deployment) = deploy(rig, &scene, FilmContact::default())?;
    let column = |name: &str| deployment.history.column(name);
    let largest = |name: &str| column(name).iter().copied().fold(0.0, worse);
    let mut judged = Vec::new();
    for entry in ["half_way", "far"] {
        let level = number(&format!("capsule_deployed/{entry}/height"));
        let time = first_time_at(column("time"), column("z_centre"), level);
        judged.push(between(&format!("time when z_centre reaches {level} m, s"), time, entry));
    }
    judged.push(between("peak vz of the top ring, m/s", largest("vz"), "peak_speed"));
    let energy = largest("kinetic_energy");
    judged.push(between("peak kinetic energy, J", energy, "peak_kinetic_energy"));
    let least = number("capsule_deployed/volume");
    judged.push(Row::at_least("V at the end, m3", run.volume(), least));
    judged.extend(common_rows(&run, &deployment, "", number("contact/ledger_band")));
    Ok(judged)
}

/// The deployed capsule on a coarse mesh.
pub(super) fn capsule_deployed(rig: &Rig) -> Outcome {
    deployed(rig, 5)
}

/// The same on a finer mesh.
pub(super) fn capsule_deployed_fine(rig: &Rig) -> Outcome {
    deployed(rig, 8)
}

/// The volume at the end, with half and with twice the contact distance.
pub(super) fn contact_distance(rig: &Rig) -> Outcome {
    let scene = paper::capsule(5, 0.3);
    let (run, _) = deploy(rig, &scene, FilmContact::default())?;
    let distance = run.film.view().system.contact.as_ref().ok_or("no contact")?.distance;
    let expected = run.volume();
    let mut judged = Vec::new();
    for factor in [0.5, 2.0] {
        let contact = FilmContact { distance: Some(factor * distance), ..FilmContact::default() };
        let (run, deployment) = deploy(rig, &scene, contact)?;
        let name = format!("distance {:.3} mm: ", 1e3 * factor * distance);
        let band = number("contact_distance/band");
        judged.push(Row::new(&format!("{name}V at the end, m3"), run.volume(), expected, band));
        judged.extend(common_rows(&run, &deployment, &name, number("contact/ledger_band")));
    }
    Ok(judged)
}
