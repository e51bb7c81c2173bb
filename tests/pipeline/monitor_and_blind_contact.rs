//! Contact that does not see some film: the tunnelling monitor reports passages exactly in the steps in
//! which a test of all pairs, without any search, finds them. In the shipped scenes of capsules.

use std::path::Path;

use billow_solver::collision::contact::BroadPhaseFault;
use billow_solver::collision::monitor::passages::Passage;
use billow_solver::geometry::field::Field;
use billow_solver::geometry::topology::Topology;
use billow_solver::integrators::FilmSimulation;
use billow_solver::models::film::FilmRun;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::monitor_settings::MonitorSettings;
use billow_solver::scene::timeline::Timeline;
use billow_study::scene::file::SceneFile;

/// Length of each run, s: until the first storeys have risen.
const END_TIME: f64 = 0.03;

/// Contact distance, m: far enough for film to meet often.
const DISTANCE: f64 = 1e-3;

/// The monitor tests every step with the list of near pairs that it keeps from step to step; no block is
/// tested step by step from its positions alone.
const MONITOR: MonitorSettings =
    MonitorSettings { block: 1, dense_block_period: u64::MAX, seed: 1 };

/// Faults of contact. The number of the part is chosen: without it, film passes in these scenes. The path
/// length after which queues stop, m, is a part of that of a run.
const FAULTS: [BroadPhaseFault; 4] = [
    BroadPhaseFault::NoEdgeContacts,
    BroadPhaseFault::ScaledBounds(10.0),
    BroadPhaseFault::SkippedPart(8),
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

/// Shipped scenes of capsules on a mesh of two subdivisions: every fault lets film through.
#[test]
fn passages_in_capsule_scenes_with_blind_contact_are_reported() {
    let sets = ["design.subdivisions=2".to_owned(), "solver.end_time=\"30 ms\"".to_owned()];
    for file in ["scenes/capsule.json", "scenes/residual_gas.json"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
        let text = std::fs::read_to_string(&path).expect("a shipped file");
        let scene = SceneFile::from_text(&text, &path, &sets, InstructionSet::detect());
        let mut scene = scene.expect("valid");
        let contact = scene.film.contact.as_mut().expect("contact");
        (contact.distance, contact.monitor) = (Some(DISTANCE), MONITOR);
        let timeline = Timeline::of_film(&scene.film);
        for fault in FAULTS {
            let run = FilmRun::of(&scene.film, scene.rings.clone()).expect("valid");
            assert!(run_blind(file, run, &timeline, fault) > 0, "{file}, {fault:?}");
        }
    }
}
