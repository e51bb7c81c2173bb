//! The estimate of a job's memory against its measured peak.

mod counting;

use std::fs;

use billow_solver::models;
use billow_solver::models::film::{FilmRun, capsule};
use billow_solver::models::run::Unobserved;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::Scene;
use billow_study::job::references::References;
use billow_study::study::Study;
use billow_study::study::plan::next_jobs;
use counting::peak;

fn scene(text: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.json");
    fs::write(&file, text).unwrap();
    let study = Study::load(&file, &[]).unwrap();
    next_jobs(&study, &[]).unwrap().points[0].job.scene.clone()
}

#[test]
fn grid() {
    let Ok(list) = std::env::var("BILLOW_MEMORY_GRID") else { return };
    for line in fs::read_to_string(list).unwrap().lines() {
        let scene = scene(line);
        let set = InstructionSet::detect();
        let (_, mesh) = peak(|| {
            let film = capsule::film_scene(
                set,
                &scene,
                billow_solver::geometry::mesh::Shape::Stowed(scene.design.stowed_height),
                0.5,
            )
            .unwrap();
            drop(film);
        });
        let (_, bare) = peak(|| FilmRun::from_scene(set, &scene, 0.5, None).map(|_| ()));
        let (run, film) = peak(|| models::solve(set, &scene, &mut Unobserved).unwrap());
        let references = References::default();
        let before = counting::used();
        let (_, statics) = peak(|| references.of(set, &scene, Some(100.0), &mut || true));
        let kept = counting::used() - before;
        let estimate = billow_study::job::memory::estimate(&scene);
        let d = &scene.design;
        println!(
            "{} {} {} el {} mesh {} bare {} film {} statics {} kB/el: {:.2} {:.2} {:.2} {:.2} samples {} kept {:.2} ratio {:.2} {:.2}",
            d.panels,
            d.storeys,
            d.subdivisions,
            d.elements(),
            mesh,
            bare,
            film,
            statics,
            mesh as f64 / d.elements() as f64 / 1e3,
            bare as f64 / d.elements() as f64 / 1e3,
            film as f64 / d.elements() as f64 / 1e3,
            statics as f64 / d.elements() as f64 / 1e3,
            run.history.column("time").len(),
            kept as f64 / d.elements() as f64 / 1e3,
            estimate.total as f64 / film.max(statics) as f64,
            estimate.statics as f64 / statics as f64,
        );
    }
}
