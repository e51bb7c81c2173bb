//! The audit sees what a faulty contact lets through, in the scene of the case it judges.

use billow_solver::collision::contact::ContactModel;
use billow_solver::integrators::explicit::Explicit;
use billow_solver::models::run::{self, Unobserved};
use billow_solver::output::audit::Audit;
use billow_solver::output::outcome::{FailureKind, Stop};
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::paper;
use billow_solver::scene::timeline::Timeline;
use billow_study::cases::contact_capsule::stowed;
use billow_study::cases::contact_rig::unrecovered_contact_energy;
use billow_study::cases::reference::number;

/// What is done to contact.
type Fault = fn(&mut ContactModel);

/// The capsule of `capsule_deployed` for 30 ms, its contact changed; how it ended, what was counted,
/// and the share of its kinetic energy contact did not return.
fn deploy(fault: Fault) -> (Stop, Audit, f64) {
    let scene = paper::capsule(5, 0.03);
    let mut run = stowed(&scene, FilmContact::default()).expect("a capsule");
    let Explicit { model, mut setting, state, .. } = run.film;
    fault(setting.contact.as_mut().expect("contact"));
    run.film = Explicit::new(model, setting, state.places, state.velocities, state.gas);
    let deployment = run::run(&mut run, &Timeline::new(&scene), &mut Unobserved);
    let kinetic = deployment.history.column("kinetic_energy");
    let peak = kinetic.iter().copied().fold(0.0, f64::max);
    (deployment.stop, deployment.audit, unrecovered_contact_energy(&run.film) / peak)
}

#[test]
fn every_fault_of_contact_is_counted() {
    let faults: [(&str, Fault); 3] = [
        ("edges do not meet", |law| law.edges = false),
        ("bounds ten times too wide", |law| law.bounds = 10.0),
        ("film is drawn together and nothing guards it", |law| {
            law.stiffness = -law.stiffness;
            law.bounds = f64::INFINITY;
        }),
    ];
    for (name, fault) in faults {
        let (stop, audit, _) = deploy(fault);
        let Stop::Failed(failure) = stop else { panic!("{name}: {stop:?}") };
        assert_eq!(failure.kind, FailureKind::Interpenetrated, "{name}");
        // Counted by the audit, not given up by contact itself.
        let counted = audit.passages > Some(0) || audit.intersections > Some(0);
        println!("{name}: {audit:?}, {failure:?}");
        assert!(counted, "{name}: {failure:?}");
    }
}

/// The guard lets nothing through film that is drawn together; the energy shows it.
#[test]
fn a_force_of_the_wrong_sign_is_noticed() {
    let (stop, audit, share) = deploy(|law| law.stiffness = -law.stiffness);
    println!("{stop:?}, {audit:?}, not returned {share:e}");
    assert!(stop != Stop::Done || share > number("contact/not_returned_band"), "{share}");
}

#[test]
fn nothing_is_counted_where_there_is_no_fault() {
    let (stop, audit, share) = deploy(|_| ());
    assert_eq!(stop, Stop::Done);
    assert!(share < number("contact/not_returned_band"), "{share}");
    assert_eq!((audit.passages, audit.intersections), (Some(0), Some(0)));
}
