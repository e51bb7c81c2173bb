//! What every model of the paper's capsule does.

use billow_solver::scene::paper;

use crate::prelude::*;
use crate::rig::run;

/// The capsule at n 2 by a model, sampled every millisecond.
fn scene(model: ModelKind, end_time: f64) -> Scene {
    let mut scene = paper::capsule(2, end_time);
    scene.solver.model = model;
    if model != ModelKind::Piston {
        scene.solver.stepping = Stepping::Stable(DEFAULT_CFL);
    }
    scene.outputs.sample_interval = 1e-3;
    scene
}

#[test]
fn a_packed_capsule_stays_and_presses_on_its_lid() {
    for model in ModelKind::ALL {
        let mut scene = scene(model, 0.03);
        scene.release_time = 0.01;
        let deployment = run(&scene);
        assert_eq!(deployment.stop, Stop::Done, "{model:?}");
        let column = |name: &str| deployment.history.column(name);
        let (lid, pressure, z) = (column("lid_force"), column("pressure"), column("z_rim"));
        if model == ModelKind::Film {
            // Layers in contact move a little under the lid.
            let near = |height: &f64| (height / z[0] - 1.0).abs() < 0.03;
            assert!(z[..=10].iter().all(near), "{z:?}");
            assert!(lid[..10].iter().any(|force| *force > 1.0), "{lid:?}");
        } else {
            assert!(z[..=10].iter().all(|height| *height == z[0]), "{model:?}: {z:?}");
            // p dV/dz for a uniform stretch; V is nearly linear in the height.
            let expected = pressure[10] * column("volume")[0] / scene.design.stowed_height;
            assert!((lid[10] / expected - 1.0).abs() < 0.1, "{model:?}: {} {expected}", lid[10]);
        }
        assert!(lid[11..].iter().all(|force| *force == 0.0), "{model:?}: {lid:?}");
        let largest = lid.iter().copied().fold(0.0, f64::max);
        assert_eq!(deployment.measures.peak_lid_force, Some(largest), "{model:?}");
        assert!(z[30] > 0.09, "{model:?}: {}", z[30]);
    }
}

/// Without gas, gravity pulls the top through the stowed stack.
#[test]
fn gravity_presses_an_empty_capsule_shut() {
    for model in [ModelKind::Piston, ModelKind::Storeys] {
        let mut scene = scene(model, 1.0);
        scene.gas.windows = Vec::new();
        scene.gravity = -9.806_65;
        match run(&scene).stop {
            Stop::Failed(failure) => assert_eq!(failure.kind, FailureKind::InvertedVolume),
            stop => panic!("{model:?}: {stop:?}"),
        }
    }
}
