//! Fault injection: a term of the equations with the wrong sign, or wrong by 1 %, must be detected by a
//! quantity of a reference case.

use std::collections::BTreeSet;

use billow_checks::cases::{CASES, Judged, Rig};
use billow_solver::platform::fault_injection::{Fault, Term};

/// A case and the start of a quantity's name; `run` if the case fails to run.
type Detector = (&'static str, &'static str);

const FILM_LEDGER: Detector = ("sphere_ledger", "film energy residual");
const GAS_LEDGER: Detector = ("sphere_ledger", "gas energy residual");
const SPHERE_STOPS: Detector = ("sphere_ledger", "run");
const FILMS_STOP: Detector = ("films_at_50_m_s", "run");
const SPRING: Detector = ("gas_spring", "period");
const SPRING_STOPS: Detector = ("gas_spring", "run");
const SPHERE: Detector = ("breathing_sphere", "frequency");
const STRIP: Detector = ("strip_damping", "log decrement");
const YIELD: Detector = ("yielding_crease", "energy residual");
const PANEL: Detector = ("shear_panel", "P12");

/// For each term: the detector of an error of 1 %, and that of the wrong sign.
const DETECTORS: [(Term, Detector, Detector); 26] = [
    (Term::Elastic, PANEL, PANEL),
    (Term::Bending, ("plate_frequency", "energy residual"), ("plate_frequency", "run")),
    (Term::YieldWork, YIELD, YIELD),
    (Term::NumericalStress, STRIP, STRIP),
    (Term::NumericalWork, ("strip_damping", "dissipated energy"), FILM_LEDGER),
    (Term::Creep, ("strip_loss", "log decrement"), ("strip_loss", "run")),
    (Term::PressureForce, SPHERE_STOPS, SPHERE_STOPS),
    (Term::Volume, SPHERE_STOPS, SPHERE_STOPS),
    (Term::Contact, FILMS_STOP, FILMS_STOP),
    (Term::Gravity, ("free_flight_damping", "speed of the fall"), FILM_LEDGER),
    (Term::Ambient, FILM_LEDGER, FILM_LEDGER),
    (Term::Kick, SPRING, SPRING),
    (Term::Drift, SPRING_STOPS, SPRING_STOPS),
    (Term::MassDamping, ("free_flight_damping", "dissipated energy"), FILM_LEDGER),
    (Term::PlaneForce, SPRING, SPRING_STOPS),
    (Term::PlaneModulus, SPHERE, SPHERE_STOPS),
    (Term::WrinkledModulus, PANEL, PANEL),
    (Term::PoissonRatio, SPHERE, SPHERE),
    (Term::Mass, ("injected_piston", "x at 50 ms"), ("injected_piston", "x at 50 ms")),
    (Term::GasWork, GAS_LEDGER, GAS_LEDGER),
    (Term::GasHeat, GAS_LEDGER, GAS_LEDGER),
    (Term::GasMassIn, GAS_LEDGER, GAS_LEDGER),
    (Term::GasEnthalpyIn, GAS_LEDGER, ("tank_filling", "T at")),
    (Term::GasMassOut, GAS_LEDGER, GAS_LEDGER),
    (Term::GasEnthalpyOut, GAS_LEDGER, GAS_LEDGER),
    (Term::GasPressure, SPHERE_STOPS, SPHERE_STOPS),
];

fn judged(case: &str, fault: Option<Fault>) -> Judged {
    let case = CASES.iter().find(|known| known.name == case).expect("a case");
    case.run(&Rig { fault, ..Rig::default() })
}

/// Whether a detector is out of band.
fn detects((case, quantity): Detector, fault: Option<Fault>) -> bool {
    let rows = judged(case, fault).rows;
    rows.iter().any(|row| row.quantity.starts_with(quantity) && !row.pass)
}

#[test]
fn every_fault_is_detected() {
    let named: Vec<Term> = DETECTORS.iter().map(|(term, ..)| *term).collect();
    assert_eq!(named, Term::ALL, "detectors for every term, in their order");
    let mut undetected = Vec::new();
    for (term, of_one_per_cent, of_wrong_sign) in DETECTORS {
        for (detector, factor) in [(of_one_per_cent, 1.01), (of_wrong_sign, -1.0)] {
            if !detects(detector, Some(Fault { term, factor })) {
                undetected.push(format!("{term:?} times {factor}: {detector:?} is in band"));
            }
        }
    }
    assert!(undetected.is_empty(), "{}", undetected.join("\n"));
}

#[test]
fn no_detector_reports_a_fault_without_one() {
    let cases: BTreeSet<&str> = DETECTORS.iter().flat_map(|(_, a, b)| [a.0, b.0]).collect();
    for case in cases {
        let judged = judged(case, None);
        assert!(judged.pass(), "{case}: {:?}", judged.rows);
    }
    // A factor of 1 is not a fault.
    let idle = Fault { term: Term::Elastic, factor: 1.0 };
    assert!(!detects(PANEL, Some(idle)));
}
