//! Contact that does not see some film: the tunnelling monitor reports passages exactly in the steps in
//! which a test of all pairs, without any search, finds them. In every shipped scene with contact.

use std::path::Path;

use billow_solver::collision::contact::BroadPhaseFault;
use billow_solver::collision::monitor::passages::Passage;
use billow_solver::geometry::field::Field;
use billow_solver::geometry::topology::Topology;
use billow_solver::integrators::FilmSimulation;
use billow_solver::models::film::FilmRun;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::DEFAULT_CFL;
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::monitor_settings::MonitorSettings;
use billow_solver::scene::timeline::Timeline;
use billow_solver::scene::{ModelKind, Scene};
use billow_study::scene::file::SceneFile;
use billow_study::study::plan::next_jobs;
use billow_study::study::{MAX_POINTS, Study};

/// Length of each run, s: until the first storeys have risen.
const END_TIME: f64 = 0.03;

/// Contact distance, m: far enough for film to meet often.
const DISTANCE: f64 = 1e-3;

/// The monitor tests every step with the list of near pairs that it keeps from step to step; no block is
/// tested step by step from its positions alone.
const MONITOR: MonitorSettings =
    MonitorSettings { block: 1, dense_block_period: u64::MAX, seed: 1 };

/// Faults of contact. The number of the motion cluster is chosen: without it, film passes in most scenes. The path
/// length after which queues stop, m, is a part of that of a run.
const FAULTS: [BroadPhaseFault; 4] = [
    BroadPhaseFault::NoEdgeContacts,
    BroadPhaseFault::ScaledBounds(10.0),
    BroadPhaseFault::SkippedCluster(8),
    BroadPhaseFault::StoppedQueues(0.05),
];

/// Lowest and highest coordinates of nodes in two frames, m.
fn bounds(frames: [&Field; 2], nodes: &[u32]) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for frame in frames {
        for node in nodes {
            let x = frame.get(*node as usize);
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(x[axis]);
                bounds[1][axis] = bounds[1][axis].max(x[axis]);
            }
        }
    }
    bounds
}

/// Number of passages on the straight motion between two frames: a test of all pairs.
fn count_passages(topology: &Topology, from: &Field, to: &Field) -> u64 {
    let frames = [from, to];
    let overlap = |a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]| {
        (0..3).all(|axis| a[0][axis] <= b[1][axis] && b[0][axis] <= a[1][axis])
    };
    let (mut found, count) = (0, |passage: Passage| u64::from(passage.occurs(topology, from, to)));
    let elements: Vec<_> = topology.triangles.iter().map(|nodes| bounds(frames, nodes)).collect();
    let edges: Vec<_> = topology.edges.iter().map(|nodes| bounds(frames, nodes)).collect();
    for node in 0..u32::try_from(topology.nodes()).unwrap() {
        let of_node = bounds(frames, &[node]);
        for (element, of_element) in (0_u32..).zip(&elements) {
            let corners = topology.triangles[element as usize];
            if overlap(&of_node, of_element) && !corners.contains(&node) {
                found += count(Passage::Node { node, element });
            }
        }
    }
    for (edge, of_edge) in (0_u32..).zip(&edges) {
        let ends = topology.edges[edge as usize];
        for (other, of_other) in (0_u32..).zip(&edges).skip(edge as usize + 1) {
            let shared = topology.edges[other as usize].iter().any(|node| ends.contains(node));
            if overlap(of_edge, of_other) && !shared {
                found += count(Passage::Edge { edge, other });
            }
        }
    }
    found
}

/// The film of a run with a fault of contact.
fn blinded(run: FilmRun, fault: BroadPhaseFault) -> FilmSimulation {
    let (mut system, state, settings) = run.film.into_parts();
    system.contact.as_mut().expect("contact").broad_phase_fault = Some(fault);
    FilmSimulation::new(system, settings, state.positions, state.velocities, state.gas)
}

fn topology_of(film: &FilmSimulation) -> Topology {
    film.view().system.contact.as_ref().expect("contact").mesh.topology.clone()
}

/// Runs film with a fault until the monitor finds passages or to its end, and compares the monitor with
/// the test of all pairs after every step. Returns the number of passages.
fn run_blind(name: &str, film: FilmRun, timeline: &Timeline, fault: BroadPhaseFault) -> u64 {
    let mut film = blinded(film, fault);
    let topology = topology_of(&film);
    let mut breakpoints = timeline.breakpoints();
    breakpoints.retain(|time| (0.0..END_TIME).contains(time) && *time > 0.0);
    breakpoints.push(END_TIME);
    for to in breakpoints {
        let phase = timeline.phase(film.view().state.time, to);
        loop {
            let from = film.view().state.positions.clone();
            let (before, mut steps) = (film.view().steps(), 1);
            let end = film.advance_at_most(to, &phase, &mut steps);
            let found = count_passages(&topology, &from, &film.view().state.positions);
            let reported = film.view().passages();
            assert_eq!(reported, Some(found), "{name}, {fault:?}: step {before}, {end:?}");
            match end {
                Ok(true) => break,
                Ok(false) => {}
                Err(failure) => {
                    println!("{name}, {fault:?}: {found} passages, {failure:?}");
                    return found;
                }
            }
        }
    }
    println!("{name}, {fault:?}: no passage in {} steps", film.view().steps());
    0
}

/// Runs a scene with every fault; at least this number of them must let film through.
fn every_fault(name: &str, timeline: &Timeline, start: impl Fn() -> FilmRun, least: usize) {
    let passes = |fault: &BroadPhaseFault| run_blind(name, start(), timeline, *fault) > 0;
    let faults = FAULTS.iter().filter(|fault| passes(fault)).count();
    assert!(faults >= least, "{name}: {faults} faults let film through, not {least}");
}

fn contact() -> FilmContact {
    FilmContact { distance: Some(DISTANCE), monitor: MONITOR, ..FilmContact::default() }
}

fn shipped(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::fs::read_to_string(root.join(path)).expect("a shipped file")
}

/// A shipped capsule scene on a mesh of two subdivisions.
fn check_scene(file: &str) {
    let sets = ["design.subdivisions=2".to_owned(), "solver.end_time=\"30 ms\"".to_owned()];
    let set = InstructionSet::detect();
    let mut scene =
        SceneFile::from_text(&shipped(file), Path::new(file), &sets, set).expect("valid");
    scene.film.contact = Some(FilmContact {
        distance: Some(DISTANCE),
        monitor: MONITOR,
        ..scene.film.contact.clone().expect("contact")
    });
    let timeline = Timeline::of_film(&scene.film);
    let start = || FilmRun::of(&scene.film, scene.rings.clone()).expect("valid");
    every_fault(file, &timeline, start, FAULTS.len());
}

/// The first film capsule of a study that has gas at the start, on a mesh of two subdivisions.
fn capsule_of(study: &str) -> Option<Scene> {
    let text = shipped(&format!("studies/{study}.json"));
    let study = Study::from_text(&text, "study.json", study, &[], MAX_POINTS).expect("valid");
    let mut points = next_jobs(&study, &[])?.points.into_iter();
    let has_gas = |scene: &Scene| {
        let early = scene.gas.windows.iter().any(|window| window.from < 0.1 * END_TIME);
        early || scene.gas.initial_mass > 0.0
    };
    let point = points.find(|point| {
        let scene = &point.job.scene;
        point.infeasible.is_none() && scene.solver.model == ModelKind::Film && has_gas(scene)
    })?;
    let mut scene = Scene::clone(&point.job.scene);
    scene.design.subdivisions = 2;
    scene.solver.end_time = END_TIME;
    Some(scene)
}

fn check_study(study: &str) {
    let scene = capsule_of(study).unwrap_or_else(|| panic!("{study}: no film with gas"));
    let timeline = Timeline::new(&scene);
    let set = InstructionSet::detect();
    let start = || FilmRun::from_scene(set, &scene, DEFAULT_CFL, Some(contact())).expect("valid");
    every_fault(study, &timeline, start, 2);
}

#[test]
fn passages_in_capsule_scenes_with_blind_contact_are_reported() {
    check_scene("scenes/capsule.json");
    check_scene("scenes/residual_gas.json");
}

/// Every study but `designs.json`, which has no film.
#[test]
fn passages_in_all_studies_with_blind_contact_are_reported() {
    let studies = [
        "convergence",
        "first",
        "folds",
        "ground",
        "held-back",
        "mass-flow",
        "mesh-error",
        "paper",
        "paper-ensemble",
        "paper-mesh",
        "pareto",
        "strategies",
        "why-adhesion-locks",
        "why-it-locks",
    ];
    for study in studies {
        check_study(study);
    }
}

/// `airbag.json` and `sphere.json` are static equilibria, without steps. The flat ring of `twist.json`
/// turns by 0.005 rad in its plane: no part of it comes near another one, whatever contact does not see.
#[test]
fn other_scenes_cannot_pass_film_through_film() {
    let set = InstructionSet::detect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let scene = |file: &str| {
        SceneFile::from_text(&shipped(file), &root.join(file), &[], set).expect("valid")
    };
    for file in ["scenes/airbag.json", "scenes/sphere.json"] {
        assert!(scene(file).film.solver.statics, "{file}");
    }
    let twist = scene("scenes/twist.json");
    let timeline = Timeline::of_film(&twist.film);
    let run = FilmRun::of(&twist.film, twist.rings.clone()).expect("valid");
    let mut film = blinded(run, BroadPhaseFault::ScaledBounds(f64::INFINITY));
    let (topology, start) = (topology_of(&film), film.view().state.positions.clone());
    let end = twist.film.solver.end_time;
    film.advance(end, &timeline.phase(0.0, end)).expect("no passage");
    assert!(film.view().steps() > 100);
    assert_eq!(film.view().passages(), Some(0));
    assert_eq!(count_passages(&topology, &start, &film.view().state.positions), 0);
}
