//! The paper's capsule as storeys: equal bits. Film as the measure and the similarity of times are
//! reference cases.

use billow_solver::models::storeys::StoreysRun;
use billow_solver::output::history::Sample;
use billow_solver::scene::paper;

use crate::prelude::*;
use crate::rig::run;

fn scene(end_time: f64) -> Scene {
    let mut scene = paper::capsule(8, end_time);
    scene.solver.model = ModelKind::Storeys;
    scene.solver.stepping = Stepping::Stable(0.45);
    scene.gas.heat_transfer = HeatTransfer::Coefficient(0.3);
    scene.film.loss_factor = paper::LOSS_FACTOR;
    scene.film.loss_frequency = paper::LOSS_FREQUENCY;
    scene.film.numerical_damping = paper::NUMERICAL_DAMPING;
    scene.supports = vec![Support { on: SupportLocation::BottomRing, fix: "xyz".to_owned() }];
    scene.outputs.sample_interval = 1e-3;
    scene
}

fn inflow(rate: f64) -> Phase {
    Phase {
        inflow: Inflow { mass_flow_rate: rate, temperature_flow: rate * 293.0 },
        ..Phase::default()
    }
}

fn after(scene: &Scene, set: InstructionSet, time: f64, steps: u64) -> Sample {
    let mut run = StoreysRun::from_scene(set, scene).unwrap();
    let phase = inflow(5e-3);
    for target in [0.25 * time, time] {
        while !run.advance_at_most(target, &phase, &mut steps.clone()).unwrap() {}
    }
    run.sample(&phase)
}

#[test]
fn pauses_and_instruction_sets_change_no_bit() {
    let scene = scene(0.02);
    let whole = after(&scene, InstructionSet::Scalar, 0.02, u64::MAX);
    assert!(whole.z_rim > 0.1 && whole.volume > 0.05, "{whole:?}");
    assert_eq!(after(&scene, InstructionSet::Scalar, 0.02, 7), whole);
    for set in InstructionSet::ALL {
        assert_eq!(after(&scene, set, 0.02, u64::MAX), whole, "{}", set.name());
    }
}

#[test]
fn seeds_change_a_run_and_equal_seeds_do_not() {
    let rim = |seed: u64| {
        let mut scene = scene(0.08);
        scene.seed = seed;
        run(&scene).history.column("z_rim").to_vec()
    };
    assert_eq!(rim(3), rim(3));
    assert_ne!(rim(3), rim(4));
}
