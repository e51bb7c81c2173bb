//! The tunnelling monitor detects passages of film through film when contact is faulty.

use billow_checks::cases::Rig;
use billow_checks::cases::contact_capsule::stowed;
use billow_checks::cases::contact_rig::unrecovered_contact_energy;
use billow_checks::cases::reference::number;
use billow_solver::collision::contact::{BroadPhaseFault, ContactModel};
use billow_solver::integrators::FilmSimulation;
use billow_solver::models::run::{self, Unobserved};
use billow_solver::output::audit::Audit;
use billow_solver::output::outcome::{FailureKind, Stop};
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::paper;
use billow_solver::scene::timeline::Timeline;

/// A change of the contact model.
type Fault = fn(&mut ContactModel);

/// The capsule of `capsule_deployed` until this time (s) with a fault in contact: how it ended, its audit,
/// and the unrecovered contact energy over the peak kinetic energy.
fn deploy(end_time: f64, fault: Fault) -> (Stop, Audit, f64) {
    let scene = paper::capsule(5, end_time);
    // Far enough for contact to store energy worth a fault.
    let contact = FilmContact { distance: Some(1e-3), ..FilmContact::default() };
    let mut run = stowed(&Rig::default(), &scene, contact).expect("a capsule");
    let (mut system, state, settings) = run.film.into_parts();
    fault(system.contact.as_mut().expect("contact"));
    let (positions, velocities) = (state.positions, state.velocities);
    run.film = FilmSimulation::new(system, settings, positions, velocities, state.gas);
    let deployment = run::run(&mut run, &Timeline::new(&scene), &mut Unobserved);
    let kinetic = deployment.history.column("kinetic_energy");
    let peak = kinetic.iter().copied().fold(0.0, f64::max);
    (deployment.stop, deployment.audit, unrecovered_contact_energy(&run.view()) / peak)
}

#[test]
fn faults_of_contact_cause_counted_passages() {
    let faults: [(&str, Fault); 3] = [
        ("edges have no contact", |model| {
            model.broad_phase_fault = Some(BroadPhaseFault::NoEdgeContacts);
        }),
        ("motion bounds are ten times too wide", |model| {
            model.broad_phase_fault = Some(BroadPhaseFault::ScaledBounds(10.0));
        }),
        ("contact attracts film and no impulse stops it", |model| {
            model.stiffness_per_mass = -model.stiffness_per_mass;
            model.broad_phase_fault = Some(BroadPhaseFault::ScaledBounds(f64::INFINITY));
        }),
    ];
    for (name, fault) in faults {
        let (stop, audit, _) = deploy(0.03, fault);
        let Stop::Failed(failure) = stop else { panic!("{name}: {stop:?}") };
        assert_eq!(failure.kind, FailureKind::Interpenetrated, "{name}");
        // Counted by the monitor, not a failure of contact.
        let counted = audit.passages > Some(0) || audit.intersections > Some(0);
        println!("{name}: {audit:?}, {failure:?}");
        assert!(counted, "{name}: {failure:?}");
    }
}

/// With an attractive force, collision impulses still prevent passages; the energy shows the fault.
#[test]
fn a_contact_force_of_the_wrong_sign_is_detected() {
    let (stop, audit, unrecovered) =
        deploy(0.012, |model| model.stiffness_per_mass = -model.stiffness_per_mass);
    println!("{stop:?}, {audit:?}, unrecovered {unrecovered:e}");
    assert!(
        stop != Stop::Done || unrecovered > number("contact/not_returned_band"),
        "{unrecovered}"
    );
}

#[test]
fn contact_without_a_fault_has_no_passages() {
    let (stop, audit, unrecovered) = deploy(0.03, |_| ());
    assert_eq!(stop, Stop::Done);
    assert!(unrecovered < number("contact/not_returned_band"), "{unrecovered}");
    assert_eq!((audit.passages, audit.intersections), (Some(0), Some(0)));
}
