//! Pauses and checkpoints of whole runs: the same bits as without them, at any step.

use billow_solver::models;
use billow_solver::models::run::run;
use billow_solver::platform::seal;
use billow_solver::scene::paper;

use crate::prelude::*;

/// Pauses every few steps; stores the state after some of them and ends.
struct Pausing {
    every: u64,
    /// Steps of this call after which the state is stored; `None` for never.
    store_after: Option<u64>,
    paused: u64,
    stored: Option<String>,
}

impl Pausing {
    fn new(every: u64, store_after: Option<u64>) -> Self {
        Self { every, store_after, paused: 0, stored: None }
    }
}

impl Observer for Pausing {
    fn sample(&mut self, _: Progress) -> bool {
        true
    }

    fn steps(&mut self) -> u64 {
        self.every
    }

    fn pause(&mut self, _: u64) -> Answer {
        self.paused += self.every;
        let due = self.store_after.is_some_and(|steps| self.paused >= steps);
        if due { Answer::Store } else { Answer::Continue }
    }

    fn store(&mut self, pause: &Pause<'_>) -> bool {
        self.stored = (pause.text)("scene").map(Result::unwrap);
        assert!(pause.steps >= self.paused);
        false
    }
}

/// Every bit of a result.
fn bits(deployment: &Deployment) -> String {
    format!("{deployment:?}")
}

/// The paper's capsule at n 2: packed until 8 ms, inflow windows, frames, contact with friction, bending, creases and
/// yield.
fn film() -> Scene {
    let mut scene = paper::capsule(2, 0.03);
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = Stepping::Stable(DEFAULT_CFL);
    scene.release_time = 0.008;
    scene.film.compression = 1.0;
    scene.film.bending = true;
    scene.film.creases = Some(Creases { length_scale: 0.02, rest_angle: None });
    scene.film.yield_moment = Some(1e-6);
    scene.contact.friction = 0.2;
    scene.outputs.sample_interval = 1e-3;
    scene.outputs.frames = 4;
    scene
}

fn solve(scene: &Scene, observer: &mut dyn Observer) -> Deployment {
    models::solve(InstructionSet::detect(), scene, observer).unwrap()
}

fn resume(scene: &Scene, text: &str, observer: &mut dyn Observer) -> Deployment {
    let stored = Stored { fingerprint: "scene", text };
    models::resume(InstructionSet::detect(), scene, &stored, observer).unwrap()
}

#[test]
fn a_pause_changes_no_bit_of_any_model() {
    for model in ModelKind::ALL {
        let mut scene = film();
        scene.solver.model = model;
        if model == ModelKind::Piston {
            scene.solver.stepping = Stepping::Adaptive(1e-9);
        }
        let whole = solve(&scene, &mut Unobserved);
        assert_eq!(whole.stop, Stop::Done);
        for every in [1, 7, 1000] {
            let mut pausing = Pausing::new(every, None);
            assert_eq!(bits(&solve(&scene, &mut pausing)), bits(&whole), "every {every}");
            assert!(every == 1000 || pausing.paused > 100, "{} steps", pausing.paused);
        }
    }
}

#[test]
fn a_run_stopped_anywhere_and_resumed_gives_the_same_bits() {
    let scene = film();
    let whole = solve(&scene, &mut Unobserved);
    assert!(whole.history.column("contact_energy").iter().any(|energy| *energy > 0.0));
    let mut elastic = scene.clone();
    elastic.film.yield_moment = None;
    assert!(bits(&solve(&elastic, &mut Unobserved)) != bits(&whole), "nothing yields");
    // Packed, within an interval, during inflow, near the end.
    for after in [1, 37, whole.steps / 4, whole.steps / 2 + 3, whole.steps - 60] {
        let mut first = Pausing::new(1, Some(after));
        let stopped = solve(&scene, &mut first);
        assert_eq!(stopped.stop, Stop::Cancelled);
        let text = first.stored.unwrap();
        assert_eq!(bits(&resume(&scene, &text, &mut Unobserved)), bits(&whole), "at {after}");
    }
    // Stopped again and again.
    let mut text = None::<String>;
    let mut stops = 0;
    let last = loop {
        let mut pausing = Pausing::new(113, Some(1));
        let ended = match &text {
            None => solve(&scene, &mut pausing),
            Some(text) => resume(&scene, text, &mut pausing),
        };
        if ended.stop != Stop::Cancelled {
            break ended;
        }
        stops += 1;
        text = pausing.stored;
    };
    assert!(stops > 3, "{stops} stops");
    assert_eq!(bits(&last), bits(&whole));
}

#[test]
fn a_checkpoint_of_another_model_is_refused() {
    let mut scene = film();
    let mut pausing = Pausing::new(10, Some(1));
    solve(&scene, &mut pausing);
    let text = &pausing.stored.unwrap();
    scene.solver.model = ModelKind::Piston;
    let stored = Stored { fingerprint: "scene", text };
    let refused = models::resume(InstructionSet::detect(), &scene, &stored, &mut Unobserved);
    assert!(refused.unwrap_err().to_string().contains("has no checkpoints"));
}

/// Every sample has a value of each track: here one is gone, and the checksum is that of the changed text.
#[test]
fn a_checkpoint_without_a_value_of_a_sample_is_refused() {
    let scene = film();
    let mut pausing = Pausing::new(10, Some(1));
    solve(&scene, &mut pausing);
    let text = seal::open(&pausing.stored.unwrap()).unwrap();
    let mut changed: serde_json::Value = serde_json::from_str(&text).unwrap();
    changed["run"]["tracks"][0].as_array_mut().unwrap().pop().unwrap();
    let text = &seal::seal(&changed.to_string());
    let stored = Stored { fingerprint: "scene", text };
    let refused = models::resume(InstructionSet::detect(), &scene, &stored, &mut Unobserved);
    assert!(refused.unwrap_err().to_string().contains("belongs to another film"));
}

/// A failure keeps its step and its place, too: the monitor tests blocks of steps.
#[test]
fn a_passage_is_found_at_the_same_step_with_and_without_pauses() {
    let scene = paper::capsule(3, 0.03);
    let contact = FilmContact { distance: Some(1e-3), ..FilmContact::default() };
    let faulty = |stored: Option<StoredFilm>| {
        let set = InstructionSet::detect();
        let mut run = FilmRun::from_scene(set, &scene, DEFAULT_CFL, Some(contact.clone())).unwrap();
        let (mut system, start, settings) = run.film.into_parts();
        let fault = Some(BroadPhaseFault::NoEdgeContacts);
        system.contact.as_mut().unwrap().broad_phase_fault = fault;
        run.film = match stored {
            None => {
                let (positions, velocities) = (start.positions, start.velocities);
                FilmSimulation::new(system, settings, positions, velocities, start.gas)
            }
            Some(stored) => FilmSimulation::resume(system, settings, stored).unwrap(),
        };
        run
    };
    let timeline = Timeline::new(&scene);
    let whole = run(&mut faulty(None), &timeline, &mut Unobserved);
    let Stop::Failed(failure) = &whole.stop else { panic!("{:?}", whole.stop) };
    assert_eq!(failure.kind, FailureKind::Interpenetrated);
    let paused = run(&mut faulty(None), &timeline, &mut Pausing::new(7, None));
    assert_eq!(bits(&paused), bits(&whole));
    for before in [55, 77, 120] {
        let mut pausing = Pausing::new(1, Some(whole.steps - before));
        run(&mut faulty(None), &timeline, &mut pausing);
        let text = pausing.stored.unwrap();
        let checkpoint = Checkpoint::<StoredFilm, Run>::from_text(&text, "scene").unwrap();
        let mut model = faulty(Some(checkpoint.state));
        let resumed = checkpoint.run.complete(&mut model, &timeline, &mut Unobserved);
        assert_eq!(bits(&resumed), bits(&whole), "{before} steps before");
    }
}
