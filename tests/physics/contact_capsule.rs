//! The folded capsule deployed with contact: nothing passes, and the audit would see it if it did.

use billow_solver::audit::passages::Watchfulness;
use billow_solver::contact::Law;
use billow_solver::contact::intersections::intersections;
use billow_solver::course::Phase;
use billow_solver::deployment::{Failure, FailureKind};
use billow_solver::film_scene::FilmContact;
use billow_solver::fold::Chirality;
use billow_solver::gas::Inflow;
use billow_solver::integrate::explicit::Explicit;
use billow_solver::ladder::film::capsule;
use billow_solver::mesh::Shape;
use billow_solver::state::Field;

use crate::geometry::paper_design;
use crate::rig::paper_scene;

const INFLOW: Phase =
    Phase { packed: false, inflow: Inflow { mass: 5e-3, mass_temperature: 5e-3 * 293.0 } };

struct Case {
    subdivisions: u32,
    compression: f64,
    chirality: Chirality,
    watch: Watchfulness,
}

/// The paper's capsule, stowed, with contact; `adjust` its law.
fn capsule(case: &Case, adjust: impl Fn(&mut Law)) -> Explicit {
    let mut scene = paper_scene();
    scene.design.subdivisions = case.subdivisions;
    scene.design.chirality = case.chirality;
    scene.film.compression = case.compression;
    let stowed = Shape::Stowed(paper_design().stowed_height);
    let (mut film, _) = capsule::film_scene(&scene, stowed, 0.45).unwrap();
    film.contact = Some(FilmContact { watch: case.watch, ..FilmContact::default() });
    let (model, mut setting, gas) = capsule::constants(&film).unwrap();
    let places = Field::of(&film.shell.positions);
    setting.contact.as_mut().map(adjust);
    let still = Field::zeros(places.len());
    Explicit::new(model, setting, places, still, gas)
}

fn deploy(film: &mut Explicit, end: f64) -> Result<f64, Failure> {
    let start = film.ledger();
    let (mut peak, mut worst) = (0.0_f64, 0.0_f64);
    while film.state.time < end {
        let target = film.state.time + 2e-3;
        film.advance(target, &INFLOW)?;
        let ledger = film.ledger();
        peak = peak.max(ledger.kinetic);
        worst = worst.max(ledger.defect(&start).abs() / (peak + ledger.external()));
        let topology = &film.setting.contact.as_ref().unwrap().topology;
        assert!(intersections(topology, &film.state.places).is_empty(), "at {target} s");
    }
    let stored: f64 = film.state.meeting.contacts.iter().map(|contact| contact.energy).sum();
    let kept = film.ledger().contact - stored + film.state.meeting.taken;
    println!("ledger {worst:e}, contact keeps {:e} of {peak} J", kept / peak);
    assert!(kept.abs() < 1e-2 * peak, "{kept} of {peak}");
    Ok(worst)
}

#[test]
fn nothing_passes_at_any_step() {
    for (compression, bound) in [(0.0, 5e-3), (1.0, 2e-2)] {
        for chirality in [Chirality::Same, Chirality::Alternate] {
            let watch = Watchfulness::EVERY_STEP;
            let case = Case { subdivisions: 2, compression, chirality, watch };
            let worst = deploy(&mut capsule(&case, |_| {}), 0.1).unwrap();
            assert!(worst < bound, "{worst}");
        }
    }
}

#[test]
fn a_finer_capsule_deploys_without_a_passage() {
    let watch = Watchfulness::FRAMES;
    let case = Case { subdivisions: 5, compression: 0.0, chirality: Chirality::Same, watch };
    let mut film = capsule(&case, |_| {});
    let worst = deploy(&mut film, 0.06).unwrap();
    assert!(worst < 5e-3, "{worst}");
    assert!(film.state.meeting.searches > 100 && film.state.volume > 0.5);
}

/// Each fault lets film through, and the audit says so.
#[test]
fn the_audit_sees_what_a_fault_lets_through() {
    type Fault = (&'static str, fn(&mut Law));
    let faults: [Fault; 3] = [
        ("edges do not meet", |law| law.edges = false),
        ("bounds ten times too wide", |law| law.bounds = 10.0),
        ("film is drawn together", |law| {
            law.stiffness = -law.stiffness;
            law.bounds = 10.0;
        }),
    ];
    for (name, fault) in faults {
        let watch = Watchfulness::FRAMES;
        let case = Case { subdivisions: 5, compression: 0.0, chirality: Chirality::Same, watch };
        let end = capsule(&case, fault).advance(0.03, &INFLOW);
        let kind = end.map_err(|failure| failure.kind);
        assert_eq!(kind, Err(FailureKind::Interpenetrated), "{name}");
    }
}

#[test]
fn contact_goes_on_bit_for_bit_from_any_step() {
    let watch = Watchfulness::FRAMES;
    let case = Case { subdivisions: 3, compression: 1.0, chirality: Chirality::Same, watch };
    let text = |film: &Explicit| serde_json::to_string(&film.state).unwrap();
    let mut whole = capsule(&case, |_| {});
    whole.advance(0.02, &INFLOW).unwrap();
    assert!(whole.state.meeting.searches > 10);
    for pause in [1, 100, 777, 1500] {
        let mut film = capsule(&case, |_| {});
        let mut steps = pause;
        assert!(!film.advance_at_most(0.02, &INFLOW, &mut steps).unwrap());
        let state = serde_json::from_str(&text(&film)).unwrap();
        let mut film = Explicit::resume(film.model, film.setting, state);
        film.advance(0.02, &INFLOW).unwrap();
        assert!(text(&film) == text(&whole), "paused after {pause} steps");
    }
}
