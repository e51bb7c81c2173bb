//! The paper's folded capsule, deployed with contact.
//!
//! ```text
//! passages = intersections = 0      residual as in the ledger      z_centre(t), max vz, max ½ Σ m v², V
//! ```
//!
//! Through the very run a study makes: packed pattern, gas, contact, audit.

use billow_solver::geometry::fold::Chirality;
use billow_solver::integrators::explicit::DEFAULT_CFL;
use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{self, Unobserved};
use billow_solver::output::measures::Reference;
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::scene::Scene;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::monitor_settings::MonitorSettings;
use billow_solver::scene::paper;
use billow_solver::scene::timeline::Timeline;

use super::contact_rig::unrecovered_contact_energy;
use super::reference::number;
use super::row::worse;
use super::{Outcome, Rig, Row};

/// A capsule's scene, stowed, with this contact.
///
/// # Errors
/// What is wrong with it.
pub fn stowed(scene: &Scene, contact: FilmContact) -> Result<FilmRun, String> {
    // Nothing here is judged by its static states.
    let unread = Reference::new(vec![[1.0, 1.0, 1.0]]);
    FilmRun::from_scene(scene, DEFAULT_CFL, Some(contact), Some(unread)).map_err(|e| e.to_string())
}

/// Runs a scene with this contact to its end.
fn deploy(rig: &Rig, scene: &Scene, contact: FilmContact) -> Result<(FilmRun, Deployment), String> {
    let mut run = stowed(scene, contact)?;
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

/// Rows every run of a capsule has.
fn sound(run: &FilmRun, deployment: &Deployment, name: &str, ledger_band: f64) -> Vec<Row> {
    let audit = &deployment.audit;
    let count = |counted: Option<u64>| counted.map_or(f64::NAN, |counted| counted as f64);
    let peak = deployment.history.column("kinetic_energy").iter().copied().fold(0.0, worse);
    let meeting = &run.film.state.meeting;
    let word = format!(
        "{} elements, {} steps, {} searches, {} approaches taken out",
        deployment.elements, deployment.steps, meeting.searches, meeting.impulses
    );
    vec![
        Row::at_most(&format!("{name}passages"), count(audit.passages), 0.0).with_note(&word),
        Row::at_most(&format!("{name}intersections"), count(audit.intersections), 0.0),
        Row::at_most(&format!("{name}film residual"), audit.ledger_residual, ledger_band),
        Row::at_most(
            &format!("{name}unrecovered contact energy"),
            unrecovered_contact_energy(&run.film) / peak,
            number("contact/not_returned_band"),
        ),
    ]
}

/// The coarsest capsule, every step looked at: tension field and film that bears compression, both
/// chiralities.
pub(super) fn capsule_every_step(rig: &Rig) -> Outcome {
    let watch = MonitorSettings::EVERY_STEP;
    let mut judged = Vec::new();
    for (compression, key) in [(0.0, "ledger_band"), (1.0, "compressed_ledger_band")] {
        for (chirality, name) in [(Chirality::Same, "same"), (Chirality::Alternate, "alternate")] {
            let mut scene = paper::capsule(2, 0.1);
            scene.film.compression = compression;
            scene.design.chirality = chirality;
            let contact = FilmContact { watch, ..FilmContact::default() };
            let (run, deployment) = deploy(rig, &scene, contact)?;
            let name = format!("c {compression}, {name} chirality: ");
            judged.extend(sound(&run, &deployment, &name, number(&format!("contact/{key}"))));
        }
    }
    Ok(judged)
}

/// When a series first reaches a level, linear between samples; no number where it never does.
fn reaches(time: &[f64], series: &[f64], level: f64) -> f64 {
    let Some(at) = series.iter().position(|value| *value >= level) else { return f64::NAN };
    if at == 0 {
        return time[0];
    }
    let part = (level - series[at - 1]) / (series[at] - series[at - 1]);
    time[at - 1] + part * (time[at] - time[at - 1])
}

/// A row whose value should lie between two numbers, `path/from` and `path/to`.
fn between(quantity: &str, value: f64, path: &str) -> Row {
    let [from, to] = ["from", "to"].map(|key| number(&format!("capsule_deployed/{path}/{key}")));
    Row::within(quantity, value, from, to)
}

/// 5 g/s for 0.3 s, on a mesh so fine.
fn deployed(rig: &Rig, subdivisions: u32) -> Outcome {
    let scene = paper::capsule(subdivisions, 0.3);
    let (run, deployment) = deploy(rig, &scene, FilmContact::default())?;
    let column = |name: &str| deployment.history.column(name);
    let largest = |name: &str| column(name).iter().copied().fold(0.0, worse);
    let mut judged = Vec::new();
    for path in ["half_way", "far"] {
        let level = number(&format!("capsule_deployed/{path}/height"));
        let time = reaches(column("time"), column("z_centre"), level);
        judged.push(between(&format!("time z_centre passes {level} m, s"), time, path));
    }
    judged.push(between("peak vz of the top ring, m/s", largest("vz"), "peak_speed"));
    let energy = largest("kinetic_energy");
    judged.push(between("peak kinetic energy, J", energy, "peak_kinetic_energy"));
    let least = number("capsule_deployed/volume");
    judged.push(Row::at_least("V at the end, m3", run.volume(), least));
    judged.extend(sound(&run, &deployment, "", number("contact/ledger_band")));
    Ok(judged)
}

/// The deployed capsule on a coarse mesh.
pub(super) fn capsule_deployed(rig: &Rig) -> Outcome {
    deployed(rig, 5)
}

/// The same on a finer one.
pub(super) fn capsule_deployed_fine(rig: &Rig) -> Outcome {
    deployed(rig, 8)
}

/// The volume at the end, with half and with twice the contact distance.
pub(super) fn contact_distance(rig: &Rig) -> Outcome {
    let scene = paper::capsule(5, 0.3);
    let (run, _) = deploy(rig, &scene, FilmContact::default())?;
    let usual = run.film.setting.contact.as_ref().ok_or("no contact")?.distance;
    let expected = run.volume();
    let mut judged = Vec::new();
    for share in [0.5, 2.0] {
        let contact = FilmContact { distance: Some(share * usual), ..FilmContact::default() };
        let (run, deployment) = deploy(rig, &scene, contact)?;
        let name = format!("distance {:.3} mm: ", 1e3 * share * usual);
        let band = number("contact_distance/band");
        judged.push(Row::new(&format!("{name}V at the end, m3"), run.volume(), expected, band));
        judged.extend(sound(&run, &deployment, &name, number("contact/ledger_band")));
    }
    Ok(judged)
}
