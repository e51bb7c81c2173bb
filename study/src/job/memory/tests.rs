use super::*;
use crate::run::fixture;

fn film_of(elements: u64, storeys: u32) -> Estimate {
    film(&FilmSize {
        elements,
        stack: Some([6, storeys]),
        contact: true,
        statics: true,
        motion: true,
        bending: None,
        samples: 2.0,
        frames: 0,
        tracks: 0,
    })
}

#[test]
fn the_estimate_grows_with_mesh_layers_samples_and_frames() {
    let small = film_of(3072, 3);
    assert!((15_000_000..40_000_000).contains(&small.total), "{small:?}");
    assert!(film_of(6144, 3).total > small.total);
    assert!(film_of(3072, 100).total > small.total);
    // 12 million elements.
    assert!(film_of(12_000_000, 3).total > 60_000_000_000);
    assert!(film_of(u64::MAX, 3).total == u64::MAX);
}

#[test]
fn samples_and_frames_count() {
    let mut scene = Scene::clone(&fixture::job(0).scene);
    scene.solver.model = ModelKind::Film;
    let few = estimate(&scene);
    scene.outputs.sample_interval = scene.solver.end_time / 1e6;
    let many = estimate(&scene);
    assert!(many.total - few.total > 1_000_000_000, "{many:?}");
    scene.solver.model = ModelKind::Piston;
    assert!(estimate(&scene).total > 1_000_000_000);
}
