//! Random scenes of the piston: energy and gas balance, and the same scene gives the same bits.

use billow_solver::scene::paper::window;
use proptest::prelude::*;

use crate::geometry::paper_design;
use crate::prelude::*;
use crate::rig::{paper_scene, run};

fn designs() -> impl Strategy<Value = FoldDesign> {
    prop_oneof![
        Just(paper_design()),
        Just(FoldDesign { chirality: Chirality::Alternate, ..paper_design() }),
        Just(FoldDesign { top_radius: Some(0.5), ..paper_design() }),
        Just(FoldDesign {
            fit: Fit::Height,
            storeys: 4,
            top_radius: None,
            alpha1_over_phi: Some(1.0),
            ..paper_design()
        }),
    ]
}

fn scenes() -> impl Strategy<Value = Scene> {
    let film = (1e8..1e10_f64, 1e-5..1e-4_f64, 200.0..350.0_f64);
    let windows = prop::collection::vec((0.0..0.2_f64, 0.005..0.3_f64, 0.0..0.01_f64), 0..4);
    let heat = prop_oneof![
        Just(HeatTransfer::Coefficient(0.0)),
        (0.0..10.0_f64).prop_map(HeatTransfer::Coefficient),
        Just(HeatTransfer::Isothermal),
    ];
    let gas = (prop_oneof![Just(0.0), 1e-6..1e-3_f64], windows, heat, 0.0..2e-4_f64);
    let rest = (0.0..0.1_f64, prop_oneof![Just(0.0), -10.0..0.0_f64]);
    (designs(), film, gas, rest).prop_map(|(design, film, gas, rest)| {
        let mut scene = paper_scene();
        scene.design = design.into();
        scene.film.youngs_modulus = film.0;
        scene.film.thickness = film.1;
        scene.film.temperature = film.2;
        scene.gas.initial_mass = gas.0;
        scene.gas.windows = gas.1.iter().map(|w| window(w.0, w.0 + w.1, w.2)).collect();
        scene.gas.heat_transfer = gas.2;
        scene.gas.leak_area = gas.3;
        (scene.release_time, scene.gravity) = rest;
        scene.outputs.sample_interval = 1e-3;
        scene
    })
}

/// Never falls by more than the integration error, 1e-9 of the largest value.
fn never_falls(values: &[f64]) -> bool {
    let slack = 1e-9 * values.iter().copied().fold(0.0, f64::max);
    values.windows(2).all(|pair| pair[1] >= pair[0] - slack)
}

/// Fast heat exchange into an empty capsule that hardly fills, and a bounce whose recoil ends as the
/// film goes slack. The property tests below found both.
#[test]
fn energy_balances_in_hard_starts_and_bounces() {
    let mut barely = paper_scene();
    barely.film.thickness = 1e-5;
    barely.gas.windows = vec![window(0.0, 0.005, 1.09e-4)];
    barely.gas.heat_transfer = HeatTransfer::Coefficient(6.17);
    let mut bounces = paper_scene();
    bounces.design = crate::geometry::paper_height(4).into();
    bounces.film.youngs_modulus = 4.78e9;
    bounces.film.thickness = 9.575e-5;
    bounces.gas.initial_mass = 5.844e-5;
    bounces.gas.windows = vec![
        window(0.0677, 0.256, 0.00845),
        window(0.1232, 0.173, 0.00555),
        window(0.069, 0.137, 0.00742),
    ];
    bounces.gas.heat_transfer = HeatTransfer::Isothermal;
    bounces.gas.leak_area = 8.0e-5;
    bounces.gravity = -3.126;
    bounces.release_time = 0.0528;
    for scene in [barely, bounces] {
        let deployment = run(&scene);
        assert_eq!(deployment.stop, Stop::Done);
        assert!(deployment.audit.ledger_residual < 1e-6, "{:?}", deployment.audit);
        assert!(deployment.audit.gas_residual < 1e-6, "{:?}", deployment.audit);
        assert!(deployment.steps < 20_000, "{}", deployment.steps);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(96) })]

    #[test]
    fn energy_and_gas_balance(scene in scenes()) {
        let deployment = run(&scene);
        // In debug form, every bit of a number.
        prop_assert_eq!(format!("{:?}", run(&scene)), format!("{deployment:?}"));
        let stopped = match &deployment.stop {
            Stop::Done => false,
            // Under gravity and without gas the top falls through the stowed stack.
            Stop::Failed(failure) => {
                prop_assert_eq!(failure.kind.name(), "inverted_volume");
                prop_assert!(scene.gravity < 0.0);
                true
            }
            Stop::Cancelled => unreachable!("no observer cancels"),
        };
        prop_assert_eq!(deployment.measures.verdict.is_none(), stopped);
        let history = &deployment.history;
        for (column, values) in history.iter() {
            prop_assert!(values.iter().all(|v| v.is_finite()), "{}", column.name);
        }
        prop_assert!(deployment.audit.ledger_residual < 1e-6, "{:?}", deployment.audit);
        prop_assert!(deployment.audit.gas_residual < 1e-6, "{:?}", deployment.audit);
        prop_assert!(never_falls(history.column("enthalpy_in")));
        prop_assert!(never_falls(history.column("enthalpy_out")));
        prop_assert!(never_falls(history.column("material_loss")), "the damper produced energy");
        prop_assert!(history.column("volume").iter().all(|v| *v > 0.0));
        prop_assert!(history.column("pressure").iter().all(|p| *p >= 0.0));
        if scene.gas.leak_area == 0.0 {
            let mass = history.column("gas_mass").last().unwrap();
            let expected = scene.gas.initial_mass
                + billow_solver::scene::inflow::Schedule::new(&scene.gas.windows)
                    .mass_until(*history.column("time").last().unwrap());
            prop_assert!((mass - expected).abs() <= 1e-14 * expected);
        }
    }
}

#[test]
fn a_leaking_capsule_that_collapses_has_an_inverted_volume() {
    let mut scene = paper_scene();
    scene.film.thickness = 7.3e-5;
    scene.film.temperature = 200.0;
    scene.gas.windows = vec![window(0.0, 0.005, 1.4e-6)];
    scene.gas.heat_transfer = HeatTransfer::Coefficient(7.8);
    scene.gas.leak_area = 1.9e-4;
    scene.gas.discharge_coefficient = 0.6;
    scene.gravity = -7.3;
    scene.solver.end_time = 0.5;
    let deployment = run(&scene);
    let Stop::Failed(failure) = &deployment.stop else { panic!("{:?}", deployment.stop) };
    assert_eq!(failure.kind.name(), "inverted_volume");
    assert!(deployment.steps < 100_000, "{} steps", deployment.steps);
}
