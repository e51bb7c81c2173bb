//! Monitors a run for passages of film through film, step by step or from frame to frame.
//!
//! A block is a number of steps between two frames. On the straight motion from one frame to the next
//! only pairs that may have met are tested ([`crate::collision::broad_phase::scheduler`]); a pair that
//! seems to pass is then tested in each step. Some blocks, or all where every step is asked for, are
//! tested step by step from their positions alone, without the history of the scheduler. So an error
//! in that history is found.
//!
//! The monitor does not use the contact model, its bounds or its decisions. It does use the same code
//! for the mesh, the broad phase and the distances as contact, with data of its own. An error in that
//! code could affect both.

pub mod passages;

use nalgebra::Vector3;

use crate::collision::broad_phase::collision_mesh::CollisionMesh;
use crate::collision::broad_phase::kdop::KDops;
use crate::collision::broad_phase::query::{CandidateKind, QueryKind};
use crate::collision::broad_phase::scheduler::CandidateScheduler;
use crate::collision::broad_phase::traversal::pairs_within_bounds;
use crate::collision::contact::distance_batch::{edge_edge_distances, node_element_distances};
use crate::collision::contact::intersections::IntersectionCounter;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;
use crate::scene::monitor_settings::MonitorSettings;
use passages::{Passage, candidate_passage, passages};

/// Counts the passages of film through film in a run.
#[derive(Debug, Clone, PartialEq)]
pub struct TunnellingMonitor {
    settings: MonitorSettings,
    instruction_set: InstructionSet,
    /// Number of steps of the run before the current block.
    block_start: u64,
    /// Positions at the start of the block and after each of its steps, m.
    frames: Vec<Field>,
    /// Number of frames recorded in the block.
    recorded: usize,
    /// Candidates, pending until they may have met.
    scheduler: CandidateScheduler,
    /// Intersections of the mesh.
    pub intersection_counter: IntersectionCounter,
    /// Number of passages so far.
    pub passages: u64,
    /// The first passage, and the position of its first node at the end of its block (m).
    pub first_passage: Option<(Passage, Vector3<f64>)>,
}

impl TunnellingMonitor {
    /// Starts at these positions (m), after `steps` steps of the run.
    pub fn new(
        settings: MonitorSettings,
        mesh: &CollisionMesh,
        positions: &Field,
        steps: u64,
        instruction_set: InstructionSet,
    ) -> Self {
        let frames = vec![positions.clone(); settings.block as usize + 1];
        let bin_width = mesh.bin_width(positions);
        let kind = QueryKind::Collision;
        let mut scheduler = CandidateScheduler::new(kind, mesh, bin_width, instruction_set);
        // A first query of all pairs here, so that the first block costs no more than the others.
        let distances = distances_at(&mesh.topology, positions, instruction_set);
        scheduler.query_now(mesh, positions, distances, |_, _| {});
        Self {
            settings,
            instruction_set,
            block_start: steps,
            frames,
            recorded: 1,
            scheduler,
            intersection_counter: IntersectionCounter::new(mesh, positions, instruction_set),
            passages: 0,
            first_passage: None,
        }
    }

    /// Whether every step so far is tested.
    pub fn is_block_start(&self) -> bool {
        self.recorded == 1
    }

    /// Records the positions (m) after a step. Tests the block if this was its last step.
    pub fn record_step(&mut self, mesh: &CollisionMesh, positions: &Field) {
        self.frames[self.recorded].copy_from(positions);
        self.recorded += 1;
        if self.recorded == self.frames.len() {
            self.test_block(mesh);
        }
    }

    /// Tests the steps recorded since the last test, and starts a new block.
    pub fn test_block(&mut self, mesh: &CollisionMesh) {
        let steps = self.recorded - 1;
        if steps == 0 {
            return;
        }
        let found = if self.settings.is_dense_block(self.block_start) {
            self.scheduler.advance(mesh, &self.frames[0], &self.frames[steps]);
            passages_step_by_step(mesh, &self.frames[..=steps])
        } else {
            self.passages_of_block(mesh, steps)
        };
        if self.first_passage.is_none() {
            self.first_passage = found.first().map(|passage| {
                let [node, ..] = passage.nodes(&mesh.topology);
                (*passage, self.frames[steps].get(node as usize))
            });
        }
        self.passages += found.len() as u64;
        self.block_start += steps as u64;
        self.frames.swap(0, steps);
        self.recorded = 1;
    }

    /// Passages in a block: tests the straight motion from its first to its last frame, and each step
    /// for the pairs that pass on it.
    fn passages_of_block(&mut self, mesh: &CollisionMesh, steps: usize) -> Vec<Passage> {
        let (frames, mut found) = (&self.frames, Vec::new());
        let (from, to) = (&frames[0], &frames[steps]);
        let topology = &mesh.topology;
        let distances = distances_at(topology, from, self.instruction_set);
        self.scheduler.query_swept(mesh, [from, to], distances, |kind, pair| {
            let passage = candidate_passage(kind, pair);
            let closest = passage.closest(topology, from);
            let normal = passage.separating_normal(topology, from, &closest);
            if !passage.is_separated(topology, to, &normal) && passage.occurs(topology, from, to) {
                let occurs =
                    |step: &usize| passage.occurs(topology, &frames[*step], &frames[step + 1]);
                found.extend((0..steps).filter(occurs).map(|_| passage));
            }
        });
        found.sort_unstable();
        found
    }
}

/// A function that appends the distances (m) of candidates of one kind at these positions (m).
fn distances_at<'a>(
    topology: &'a Topology,
    positions: &'a Field,
    instruction_set: InstructionSet,
) -> impl FnMut(CandidateKind, &[[u32; 2]], &mut Vec<f64>) + 'a {
    move |kind, pairs, distances| match kind {
        CandidateKind::EdgeEdge => {
            edge_edge_distances(instruction_set, topology, positions, pairs, distances);
        }
        _ => node_element_distances(instruction_set, topology, positions, pairs, distances),
    }
}

/// All passages in the steps between these frames, from the frames alone, in the order of steps.
fn passages_step_by_step(mesh: &CollisionMesh, frames: &[Field]) -> Vec<Passage> {
    if let [from, to] = frames {
        return passages(mesh, from, to);
    }
    let topology = &mesh.topology;
    let (first, mut max_displacement) = (&frames[0], 0.0_f64);
    let mut kdops = KDops::new(&mesh.hierarchy, first);
    for frame in &frames[1..] {
        kdops.extend(&mesh.hierarchy, frame);
        max_displacement = max_displacement.max(first.largest_displacement(frame));
    }
    let mut found = Vec::new();
    pairs_within_bounds(QueryKind::Collision, mesh, &kdops, 0.0, |kind, pair| {
        let passage = candidate_passage(kind, pair);
        let closest = passage.closest(topology, first);
        // Both primitives together move by at most twice the largest displacement.
        if closest.squared > 4.0 * max_displacement * max_displacement {
            return;
        }
        // Keep one separating plane for as many steps as possible.
        let mut normal = passage.separating_normal(topology, first, &closest);
        for (step, pair) in frames.windows(2).enumerate() {
            if passage.is_separated(topology, &pair[1], &normal) {
                continue;
            }
            if passage.occurs(topology, &pair[0], &pair[1]) {
                found.push((step, passage));
            }
            let closest = passage.closest(topology, &pair[1]);
            normal = passage.separating_normal(topology, &pair[1], &closest);
        }
    });
    found.sort_unstable();
    found.into_iter().map(|(_, passage)| passage).collect()
}

#[cfg(test)]
mod tests {
    use super::passages::tests::{scene, v};
    use super::*;
    use crate::collision::contact::intersections::intersections;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn several_steps_give_the_passages_of_each_step(
            positions in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 6), 2..9),
            shares in prop::array::uniform2(0.01..1.0_f64),
            parallel in prop::sample::select(vec![None, Some(0.0), Some(1e-7)]),
        ) {
            let mesh = CollisionMesh::new(6, &[[0, 1, 2], [3, 4, 5]]);
            // Large and small steps, and nearly parallel edges.
            let first: Vec<Vector3<f64>> = positions[0].iter().map(|x| Vector3::from(*x)).collect();
            let frame = |points: &Vec<[f64; 3]>| {
                let moved = |(x, y): (&Vector3<f64>, &[f64; 3])| {
                    let y = Vector3::from(*y);
                    x + (y - x).component_mul(&Vector3::new(shares[0], shares[0], shares[1]))
                };
                let mut x: Vec<Vector3<f64>> = first.iter().zip(points).map(moved).collect();
                if let Some(deviation) = parallel {
                    x[4] = x[3] + (x[1] - x[0]) * 1.1 + Vector3::new(0.0, 0.0, deviation);
                }
                Field::of(&x)
            };
            let frames: Vec<Field> = positions.iter().map(frame).collect();
            let each: Vec<Passage> =
                frames.windows(2).flat_map(|pair| passages(&mesh, &pair[0], &pair[1])).collect();
            prop_assert_eq!(passages_step_by_step(&mesh, &frames), each);
        }
    }

    #[test]
    fn a_passage_there_and_back_is_found_step_by_step_only() {
        let corner = [v(0.3, 0.3, 0.1), v(0.3, 0.8, 3.0), v(0.8, 0.3, 3.0)];
        let (mesh, from, to) = scene(&corner, v(0.0, 0.0, -0.2));
        let start = |settings: MonitorSettings| {
            TunnellingMonitor::new(settings, &mesh, &from, 0, InstructionSet::detect())
        };
        let count = |settings: MonitorSettings| {
            let mut monitor = start(settings);
            monitor.record_step(&mesh, &to);
            monitor.record_step(&mesh, &from);
            monitor.test_block(&mesh);
            monitor.passages
        };
        assert_eq!(count(MonitorSettings::EVERY_STEP), 2);
        assert_eq!(count(MonitorSettings { dense_block_period: 1, ..MonitorSettings::FRAMES }), 2);
        let mut monitor = start(MonitorSettings::FRAMES);
        assert!(!MonitorSettings::FRAMES.is_dense_block(0));
        monitor.record_step(&mesh, &to);
        monitor.test_block(&mesh);
        assert_eq!(monitor.passages, 1);
        assert!(monitor.first_passage.is_some());
    }

    #[test]
    fn about_one_block_in_a_hundred_is_tested_step_by_step() {
        let close =
            (0..100_000).filter(|block| MonitorSettings::FRAMES.is_dense_block(*block)).count();
        assert!((900..1100).contains(&close), "{close}");
    }

    proptest! {
        /// The scheduler misses no passage and no intersection, whatever the motion.
        #[test]
        fn pending_pairs_miss_no_passage_and_no_intersection(
            positions in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 18),
            motions in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(-0.2..0.2_f64), 18),
                1..12,
            ),
        ) {
            let triangles = [[0, 1, 2], [2, 1, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12], [13, 14, 15]];
            let mut triangles = triangles.to_vec();
            triangles.push([13, 16, 17]);
            let mesh = CollisionMesh::new(18, &triangles);
            let mut x: Vec<Vector3<f64>> = positions.into_iter().map(Vector3::from).collect();
            // No block is tested step by step.
            let settings = MonitorSettings { block: 1, dense_block_period: u64::MAX, seed: 1 };
            let start = Field::of(&x);
            let mut monitor =
                TunnellingMonitor::new(settings, &mesh, &start, 0, InstructionSet::detect());
            let mut expected = 0;
            for motion in motions {
                let from = Field::of(&x);
                for (x, u) in x.iter_mut().zip(motion) {
                    *x += Vector3::from(u);
                }
                let to = Field::of(&x);
                expected += passages(&mesh, &from, &to).len() as u64;
                monitor.record_step(&mesh, &to);
                prop_assert_eq!(monitor.passages, expected);
                monitor.intersection_counter.update(&mesh, &to);
                let all = intersections(&mesh, &to).len() as u64;
                prop_assert_eq!(monitor.intersection_counter.count, all);
            }
        }
    }
}
