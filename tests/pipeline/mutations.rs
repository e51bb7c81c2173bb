//! Deliberate faults: a term of the equations that lost its sign, or is one per cent off, must be
//! noticed by a judge: a ledger or a quantity of a case.

use std::collections::BTreeSet;

use billow_solver::platform::fault_injection::{Fault, Term};
use billow_study::cases::{CASES, Judged, Rig};

/// A case and the beginning of its quantity; `run` where the case comes to no end.
type Judge = (&'static str, &'static str);

const FILM_LEDGER: Judge = ("sphere_ledger", "film energy residual");
const GAS_LEDGER: Judge = ("sphere_ledger", "gas energy residual");
const SPHERE_STOPS: Judge = ("sphere_ledger", "run");
const TAUT_FORCE: Judge = ("force_energy", "film force, taut, c 0,");
const SPRING: Judge = ("gas_spring", "period");
const ALL_REGIMES: Judge = ("path_energy", "work plus change");
const PANEL: Judge = ("shear_panel", "P12");

/// Who tells that a term is one per cent off, and who that its sign is lost.
const JUDGES: [(Term, Judge, Judge); 22] = [
    (Term::Elastic, TAUT_FORCE, TAUT_FORCE),
    (Term::Viscous, ("strip_damping", "log decrement"), ("dissipation", "dissipated power")),
    (Term::ViscousWork, ("strip_damping", "dissipated energy"), FILM_LEDGER),
    (Term::PressureForce, FILM_LEDGER, SPHERE_STOPS),
    (Term::Volume, FILM_LEDGER, SPHERE_STOPS),
    (Term::Gravity, ("force_energy", "weight"), FILM_LEDGER),
    (Term::Ambient, FILM_LEDGER, FILM_LEDGER),
    (Term::Kick, SPRING, SPRING),
    (Term::Drift, SPRING, SPRING),
    (Term::MassDamping, ("free_flight_damping", "dissipated energy"), FILM_LEDGER),
    (Term::PlaneForce, SPRING, ("gas_spring", "run")),
    (Term::PlaneModulus, ALL_REGIMES, ("sphere_ledger", "run")),
    (Term::WrinkledModulus, PANEL, PANEL),
    (Term::PoissonRatio, ALL_REGIMES, ("step_limit", "sheet 4 x 3: limit")),
    (Term::Mass, ("injected_piston", "x at 50 ms"), ("injected_piston", "x at 50 ms")),
    (Term::GasWork, GAS_LEDGER, GAS_LEDGER),
    (Term::GasHeat, GAS_LEDGER, GAS_LEDGER),
    (Term::GasMassIn, GAS_LEDGER, GAS_LEDGER),
    (Term::GasEnthalpyIn, GAS_LEDGER, ("tank_filling", "T at")),
    (Term::GasMassOut, GAS_LEDGER, GAS_LEDGER),
    (Term::GasEnthalpyOut, GAS_LEDGER, GAS_LEDGER),
    (Term::GasPressure, FILM_LEDGER, SPHERE_STOPS),
];

fn judged(case: &str, fault: Option<Fault>) -> Judged {
    let case = CASES.iter().find(|own| own.name == case).expect("a case");
    case.run(&Rig { fault })
}

/// Whether a judge sees a fault.
fn sees((case, quantity): Judge, fault: Option<Fault>) -> bool {
    let rows = judged(case, fault).rows;
    rows.iter().any(|row| row.quantity.starts_with(quantity) && !row.pass)
}

#[test]
fn every_fault_is_noticed() {
    let named: Vec<Term> = JUDGES.iter().map(|(term, ..)| *term).collect();
    assert_eq!(named, Term::ALL, "a judge for every term, in their order");
    let mut survivors = Vec::new();
    for (term, slight, lost) in JUDGES {
        for (judge, factor) in [(slight, 1.01), (lost, -1.0)] {
            if !sees(judge, Some(Fault { term, factor })) {
                survivors.push(format!("{term:?} times {factor}: {judge:?} did not notice"));
            }
        }
    }
    assert!(survivors.is_empty(), "{}", survivors.join("\n"));
}

#[test]
fn judges_see_no_fault_where_there_is_none() {
    let cases: BTreeSet<&str> = JUDGES.iter().flat_map(|(_, a, b)| [a.0, b.0]).collect();
    for case in cases {
        let judged = judged(case, None);
        assert!(judged.pass(), "{case}: {:?}", judged.rows);
    }
    // A factor of one is no fault.
    let idle = Fault { term: Term::Elastic, factor: 1.0 };
    assert!(!sees(TAUT_FORCE, Some(idle)));
}
