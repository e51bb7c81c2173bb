//! Deployment of the paper's folded capsule with contact.
//!
//! ```text
//! passages = intersections = 0      residual as in the ledger      z_centre(t), max vz, max ½ Σ m v², V
//! ```
//!
//! It runs as in a study: packed pattern, gas, contact, tunnelling monitor. `implicit` may give up in a burst of packed
//! film, where its steps would become too short. What it did until then counts.

use billow_solver::geometry::fold::Chirality;
use billow_solver::integrators;
use billow_solver::models::run;
use billow_solver::output::outcome::{Deployment, FailureKind, Stop};
use billow_solver::scene::DEFAULT_CFL;
use billow_solver::scene::monitor_settings::MonitorSettings;

use super::contact_rig::{ContactRecord, unrecovered_contact_energy};
use super::oscillation::when;
use super::prelude::*;
use super::rig::stopped;

/// The run of a stowed capsule with this contact.
pub fn stowed(rig: &Rig, scene: &Scene, contact: FilmContact) -> Result<FilmRun> {
    Ok(FilmRun::from_scene(rig.instruction_set, scene, DEFAULT_CFL, Some(contact))?)
}

/// Runs a scene with this contact to its end, or to the step limit of `implicit`.
fn deploy(rig: &Rig, scene: &Scene, contact: FilmContact) -> Result<(FilmRun, Deployment)> {
    let mut run = stowed(rig, scene, contact)?;
    run.film = rig.faulty(run.film);
    let deployment = run::run(&mut run, &Timeline::new(scene), &mut Unobserved);
    match &deployment.stop {
        Stop::Done => Ok((run, deployment)),
        Stop::Cancelled => Err("cancelled".into()),
        Stop::Failed(failure) => match (scene.solver.integrator, failure.kind) {
            (IntegratorKind::Implicit, FailureKind::StepLimit) => Ok((run, deployment)),
            _ => Err(stopped(failure).into()),
        },
    }
}

/// What is judged of every run of a capsule.
fn record(run: &FilmRun, deployment: &Deployment) -> ContactRecord {
    let (now, audit) = (run.view(), &deployment.audit);
    let peak = deployment.history.column("kinetic_energy").iter().copied().fold(0.0, worse);
    ContactRecord {
        passages: audit.passages,
        intersections: audit.intersections,
        residual: audit.ledger_residual,
        unrecovered: unrecovered_contact_energy(&now) / peak,
    }
}

/// Its rows, with those of its energy.
fn all_rows(record: &ContactRecord, name: &str, ledger_band: &str) -> Vec<Row> {
    let rows = record.rows(name, number(&format!("contact/{ledger_band}")));
    [rows, vec![record.unrecovered(name)]].concat()
}

/// The first tenth of a second with every step monitored, as tension field and with full membrane stiffness, with every
/// integrator; on the coarsest mesh with the other chirality too.
pub(super) fn every_step(rig: &Rig, subdivisions: u32) -> Outcome {
    let monitor = MonitorSettings::EVERY_STEP;
    let mut runs = IntegratorKind::ALL.map(|kind| (kind, Chirality::Same)).to_vec();
    if subdivisions == 2 {
        runs.insert(0, (IntegratorKind::Explicit, Chirality::Alternate));
    }
    let mut judged = Vec::new();
    for (compression, key) in [(0.0, "ledger_band"), (1.0, "compressed_ledger_band")] {
        for (kind, chirality) in runs.iter().copied() {
            let mut scene = paper::capsule(subdivisions, 0.1);
            scene.film.compression = compression;
            scene.design.folded_mut().unwrap().chirality = chirality;
            (scene.solver.model, scene.solver.integrator) = (ModelKind::Film, kind);
            let contact = FilmContact { monitor, ..FilmContact::default() };
            let (run, deployment) = deploy(rig, &scene, contact)?;
            let integrator = integrators::entry(kind).name;
            let name = format!("{integrator}, c {compression}, {chirality:?} chirality: ");
            // At least one step, or the zeros below say nothing.
            let steps = (deployment.steps as f64).max(1.0);
            let monitored = run.film.view().tested_steps().map_or(f64::NAN, |steps| steps as f64);
            judged.push(Row::at_least(&format!("{name}monitored steps"), monitored, steps));
            let record = record(&run, &deployment);
            judged.extend(match kind {
                IntegratorKind::Explicit => all_rows(&record, &name, key),
                _ => record.counts(&name),
            });
        }
    }
    Ok(judged)
}

/// Residual gas alone, with friction in film that bears compression: nodes stick and slide at several contacts at a
/// time.
pub(super) fn friction(rig: &Rig) -> Outcome {
    let mut scene = paper::capsule(5, 0.3);
    let [coefficient, mass, dissipation, band] =
        entry("capsule_friction", ["coefficient", "mass", "dissipation", "ledger_band"]);
    (scene.gas.windows, scene.gas.initial_mass) = (Vec::new(), mass);
    scene.film.compression = 1.0;
    let contact = FilmContact { friction: coefficient, ..FilmContact::default() };
    let (run, deployment) = deploy(rig, &scene, contact)?;
    let dissipated = run.film.view().accounting().friction_dissipation;
    let mut judged =
        vec![Row::at_least("energy dissipated by friction, J", dissipated, dissipation)];
    judged.extend(record(&run, &deployment).rows("", band));
    Ok(judged)
}

/// A row whose value must lie between the reference numbers `entry/from` and `entry/to`.
fn between(quantity: &str, value: f64, entry: &str) -> Row {
    let [from, to] = ["from", "to"].map(|key| number(&format!("capsule_deployed/{entry}/{key}")));
    Row::within(quantity, value, from, to)
}

/// 5 g/s for 0.3 s on this mesh.
pub(super) fn deployed(rig: &Rig, subdivisions: u32) -> Outcome {
    let scene = paper::capsule(subdivisions, 0.3);
    let (run, deployment) = deploy(rig, &scene, FilmContact::default())?;
    let column = |name: &str| deployment.history.column(name);
    let largest = |name: &str| column(name).iter().copied().fold(0.0, worse);
    let mut judged = Vec::new();
    for entry in ["half_way", "far"] {
        let level = number(&format!("capsule_deployed/{entry}/height"));
        let samples = column("z_centre").iter().copied().zip(column("time").iter().copied());
        let time = when(&samples.collect::<Vec<_>>(), level);
        judged.push(between(&format!("time when z_centre reaches {level} m, s"), time, entry));
    }
    judged.push(between("peak vz of the top ring, m/s", largest("vz"), "peak_speed"));
    let energy = largest("kinetic_energy");
    judged.push(between("peak kinetic energy, J", energy, "peak_kinetic_energy"));
    let least = number("capsule_deployed/volume");
    judged.push(Row::at_least("V at the end, m3", run.volume(), least));
    judged.extend(all_rows(&record(&run, &deployment), "", "ledger_band"));
    Ok(judged)
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
        judged.extend(all_rows(&record(&run, &deployment), &name, "ledger_band"));
    }
    Ok(judged)
}
