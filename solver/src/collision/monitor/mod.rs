//! Monitors a run for passages of film through film, step by step or from frame to frame.
//!
//! ```text
//! |x − x₀ − mean(x − x₀)| ≤ r for every node        then the near list of x₀ has every pair that can pass
//! ```
//!
//! Symbols: x position of a node, x₀ that in the reference frame, m; r reach of the list, m.
//!
//! A block is a number of steps between two frames. On the straight motion from one frame to the next
//! only pairs that may pass are tested; a pair that passes on it is then tested in each step. In film
//! that hardly moves these pairs come from a near list, found once around a reference frame
//! (`near_list`); else from a search of the two frames ([`search`]). Some blocks, or all where every
//! step is asked for, are tested step by step from their positions alone, without the near list. So an
//! error in that list is found.
//!
//! The monitor shares nothing with contact but the mesh connectivity, the fields and the vector types:
//! no broad phase, no distance, no bound, no decision.

mod apart;
pub mod boxes;
pub mod intersections;
pub mod motion;
mod near_list;
pub mod passages;
mod paths;
pub mod primitives;
pub mod query;
pub mod search;
pub mod separation;
pub mod tracking;

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;
use crate::scene::monitor_settings::MonitorSettings;
use intersections::IntersectionCounter;
use motion::largest_deviation;
use passages::{Passage, each_passage};
use query::{Pairs, QueryKind};
use search::{clear, motion_between};
use tracking::PairTracker;

/// Counts the passages of film through film in a run.
#[derive(Debug, Clone, PartialEq)]
pub struct TunnellingMonitor {
    settings: MonitorSettings,
    /// Number of steps of the run before the current block.
    block_start: u64,
    /// Positions at the start of the block and after each of its steps, m.
    frames: Vec<Field>,
    /// Number of frames recorded in the block.
    recorded: usize,
    tracker: PairTracker,
    // Scratch memory: pairs that may pass in a dense block, and those that no plane separates.
    pairs: Pairs,
    close: Pairs,
    /// Scratch memory: the passages of a block, with their steps.
    found: Vec<(usize, Passage)>,
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
        topology: &Topology,
        positions: &Field,
        steps: u64,
        instruction_set: InstructionSet,
    ) -> Self {
        let frames = vec![positions.clone(); settings.block as usize + 1];
        let kind = QueryKind::Passages;
        let mut tracker = PairTracker::new(kind, topology, positions, instruction_set);
        // Every pair is due here, so that the first block costs no more than the others.
        let mut close = Pairs::default();
        tracker.find(topology, [positions; 2], &mut close);
        let intersection_counter =
            IntersectionCounter::new(topology, positions, &tracker.elements, instruction_set);
        Self {
            settings,
            block_start: steps,
            frames,
            recorded: 1,
            tracker,
            pairs: Pairs::default(),
            close,
            found: Vec::new(),
            intersection_counter,
            passages: 0,
            first_passage: None,
        }
    }

    /// Number of steps of the run that are tested, or were taken before the monitor started.
    pub fn tested_steps(&self) -> u64 {
        self.block_start
    }

    /// Whether every step so far is tested.
    pub fn is_block_start(&self) -> bool {
        self.recorded == 1
    }

    /// Records the positions (m) after a step. Tests the block if this was its last step.
    pub fn record_step(&mut self, topology: &Topology, positions: &Field) {
        self.frames[self.recorded].copy_from(positions);
        self.recorded += 1;
        if self.recorded == self.frames.len() {
            self.test_block(topology);
        }
    }

    /// Tests the steps recorded since the last test, and starts a new block.
    pub fn test_block(&mut self, topology: &Topology) {
        let steps = self.recorded - 1;
        if steps == 0 {
            return;
        }
        self.found.clear();
        self.tracker.advance(topology, &self.frames[0], &self.frames[steps]);
        if self.settings.is_dense_block(self.block_start) {
            self.test_each_step(topology, steps);
            // By step, then by passage.
            self.found.sort_unstable();
        } else {
            self.test_motion(topology, steps);
            self.found.sort_unstable_by_key(|(step, passage)| (*passage, *step));
        }
        if self.first_passage.is_none() {
            self.first_passage = self.found.first().map(|(_, passage)| {
                let [node, ..] = passage.nodes(topology);
                (*passage, self.frames[steps].get(node as usize))
            });
        }
        self.passages += self.found.len() as u64;
        self.block_start += steps as u64;
        self.frames.swap(0, steps);
        self.recorded = 1;
    }

    /// Tests the steps recorded since the last test, and counts the intersections after the last of them.
    pub fn test_to_sample(&mut self, topology: &Topology) {
        self.test_block(topology);
        let Self { frames, tracker, intersection_counter, .. } = self;
        intersection_counter.update_among(topology, &frames[0], &tracker.elements);
    }

    /// Passages in a block: tests the straight motion from its first to its last frame, and each step
    /// for the pairs that pass on it.
    fn test_motion(&mut self, topology: &Topology, steps: usize) {
        let Self { frames, tracker, close, found, .. } = self;
        let ends = [&frames[0], &frames[steps]];
        tracker.find(topology, ends, close);
        each_passage(close, |passage| {
            if passage.occurs(topology, ends[0], ends[1]) {
                let occurs =
                    |step: &usize| passage.occurs(topology, &frames[*step], &frames[step + 1]);
                found.extend((0..steps).filter(occurs).map(|step| (step, passage)));
            }
        });
    }

    /// Passages in a block, from all its frames alone. Pairs that may pass come from one search: every
    /// node stays within the largest deviation from the straight motion of the block.
    fn test_each_step(&mut self, topology: &Topology, steps: usize) {
        let Self { frames, tracker, pairs, close, found, .. } = self;
        let frames = &frames[..=steps];
        let ends = [&frames[0], &frames[steps]];
        let mut deviation = 0.0_f64;
        for (step, frame) in frames.iter().enumerate().take(steps).skip(1) {
            let t = step as f64 / steps as f64;
            let of_frame = largest_deviation(frame, t, ends[0], ends[1]);
            // NaN has no bound.
            deviation = if of_frame.is_nan() { f64::INFINITY } else { deviation.max(of_frame) };
        }
        tracker.find_without_history(topology, ends, deviation, pairs);
        let (kind, set) = (tracker.search.kind, tracker.search.instruction_set);
        for (step, ends) in frames.windows(2).enumerate() {
            let ends = [&ends[0], &ends[1]];
            clear(close);
            let motion = motion_between(ends[0], ends[1], 0.0);
            kind.filter(set, topology, pairs, &motion, close);
            each_passage(close, |passage| {
                if passage.occurs(topology, ends[0], ends[1]) {
                    found.push((step, passage));
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::intersections::tests::all_intersections;
    use super::passages::tests::{all_passages, scene, v};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn several_steps_give_the_passages_of_each_step(
            positions in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 6), 2..9),
            shares in prop::array::uniform2(0.01..1.0_f64),
            parallel in prop::sample::select(vec![None, Some(0.0), Some(1e-7)]),
        ) {
            let topology = Topology::new(6, &[[0, 1, 2], [3, 4, 5]]);
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
            let each = |(step, pair): (usize, &[Field])| {
                all_passages(&topology, &pair[0], &pair[1]).into_iter().map(move |found| (step, found))
            };
            let each: Vec<(usize, Passage)> = frames.windows(2).enumerate().flat_map(each).collect();
            let block = u32::try_from(frames.len()).unwrap();
            let settings = MonitorSettings { block, ..MonitorSettings::EVERY_STEP };
            let mut monitor =
                TunnellingMonitor::new(settings, &topology, &frames[0], 0, InstructionSet::detect());
            for frame in &frames[1..] {
                monitor.record_step(&topology, frame);
            }
            monitor.test_block(&topology);
            prop_assert_eq!(monitor.passages, each.len() as u64);
            prop_assert_eq!(&monitor.found, &each);
            prop_assert_eq!(monitor.first_passage.map(|first| first.0), each.first().map(|first| first.1));
        }
    }

    #[test]
    fn a_passage_there_and_back_is_found_step_by_step_only() {
        let corner = [v(0.3, 0.3, 0.1), v(0.3, 0.8, 3.0), v(0.8, 0.3, 3.0)];
        let (topology, from, to) = scene(&corner, v(0.0, 0.0, -0.2));
        let start = |settings: MonitorSettings| {
            TunnellingMonitor::new(settings, &topology, &from, 0, InstructionSet::detect())
        };
        let count = |settings: MonitorSettings| {
            let mut monitor = start(settings);
            monitor.record_step(&topology, &to);
            monitor.record_step(&topology, &from);
            monitor.test_block(&topology);
            monitor.passages
        };
        assert_eq!(count(MonitorSettings::EVERY_STEP), 2);
        assert_eq!(count(MonitorSettings { dense_block_period: 1, ..MonitorSettings::FRAMES }), 2);
        let mut monitor = start(MonitorSettings::FRAMES);
        assert!(!MonitorSettings::FRAMES.is_dense_block(0));
        monitor.record_step(&topology, &to);
        monitor.test_block(&topology);
        assert_eq!(monitor.passages, 1);
        assert!(monitor.first_passage.is_some());
    }

    #[test]
    fn an_edge_that_stays_in_an_element_is_counted_at_every_sample() {
        // The nodes and edges of both elements stay apart, so no pair of them is due again.
        let through = [v(0.2, 0.2, -1.0), v(0.2, 0.2, 1.0), v(0.3, 0.3, 1.0)];
        let (topology, at_rest, moved) = scene(&through, v(1e-4, 0.0, 0.0));
        let set = InstructionSet::detect();
        let mut monitor =
            TunnellingMonitor::new(MonitorSettings::FRAMES, &topology, &at_rest, 0, set);
        let mut count = |frame: &Field| {
            monitor.record_step(&topology, frame);
            monitor.test_to_sample(&topology);
            monitor.intersection_counter.count
        };
        let there = all_intersections(&topology, &at_rest).len() as u64;
        assert!(there > 0);
        for step in 0..40 {
            assert_eq!(count(if step % 2 == 0 { &moved } else { &at_rest }), there, "step {step}");
        }
        // It leaves the element, and comes back.
        let (_, _, away) = scene(&through, v(3.0, 0.0, 0.0));
        assert_eq!((count(&away), count(&at_rest)), (0, there));
    }

    #[test]
    fn about_one_block_in_a_hundred_is_tested_step_by_step() {
        let close =
            (0..100_000).filter(|block| MonitorSettings::FRAMES.is_dense_block(*block)).count();
        assert!((900..1100).contains(&close), "{close}");
    }

    proptest! {
        /// Neither the near list nor the search misses a passage or an intersection, whatever the motion.
        #[test]
        fn a_run_misses_no_passage_and_no_intersection(
            positions in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 18),
            motions in prop::collection::vec(
                (prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 18), 0_usize..4, 0..3),
                1..20,
            ),
            block in 1..4_u32,
            dense_block_period in prop::sample::select(vec![2, u64::MAX]),
        ) {
            let triangles =
                [[0, 1, 2], [2, 1, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12], [13, 14, 15], [13, 16, 17]];
            let topology = Topology::new(18, &triangles);
            let mut x: Vec<Vector3<f64>> = positions.into_iter().map(Vector3::from).collect();
            let settings = MonitorSettings { block, dense_block_period, seed: 1 };
            // Each step is a block, and none is tested step by step.
            let each = MonitorSettings { block: 1, dense_block_period: u64::MAX, seed: 1 };
            let start = Field::of(&x);
            let mut monitor =
                TunnellingMonitor::new(settings, &topology, &start, 0, InstructionSet::detect());
            let mut each =
                TunnellingMonitor::new(each, &topology, &start, 0, InstructionSet::detect());
            let mut searched = monitor.intersection_counter.clone();
            prop_assert_eq!(searched.count, all_intersections(&topology, &start).len() as u64);
            let mut expected = 0;
            for (motion, size, look) in motions {
                let from = Field::of(&x);
                // From film that hardly moves, which has a near list, to film that moves far; with drift.
                let size = [0.2, 0.02, 0.004, 0.001][size];
                for (x, u) in x.iter_mut().zip(motion) {
                    *x += Vector3::from(u) * size + v(0.3, 0.0, -0.1);
                }
                let to = Field::of(&x);
                expected += all_passages(&topology, &from, &to).len() as u64;
                each.record_step(&topology, &to);
                prop_assert_eq!(each.passages, expected);
                let all = all_intersections(&topology, &to).len() as u64;
                searched.update(&topology, &to);
                prop_assert_eq!(searched.count, all);
                // Some frames are samples, and some of these lie within an implicit step.
                monitor.record_step(&topology, &to);
                match look {
                    0 => monitor.test_to_sample(&topology),
                    1 => monitor.intersection_counter.update(&topology, &to),
                    _ => continue,
                }
                prop_assert_eq!(monitor.intersection_counter.count, all);
            }
        }
    }

    #[test]
    fn positions_that_are_not_numbers_end_in_no_panic_and_no_loop() {
        let corner = [v(0.3, 0.3, 0.1), v(0.3, 0.8, 3.0), v(0.8, 0.3, 3.0)];
        let (topology, from, to) = scene(&corner, v(0.0, 0.0, -0.2));
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
            for settings in [MonitorSettings::EVERY_STEP, MonitorSettings::FRAMES] {
                let mut broken = to.clone();
                broken.set(5, v(value, 0.1, 0.2));
                let set = InstructionSet::detect();
                let mut monitor = TunnellingMonitor::new(settings, &topology, &broken, 0, set);
                for frame in [&from, &broken, &from, &broken, &broken] {
                    monitor.record_step(&topology, frame);
                }
                monitor.test_block(&topology);
                monitor.test_to_sample(&topology);
                monitor.intersection_counter.update(&topology, &broken);
                // Film with numbers is tested again.
                let before = monitor.passages;
                for frame in [&from, &from, &to] {
                    monitor.record_step(&topology, frame);
                    monitor.test_block(&topology);
                }
                assert!(monitor.passages > before);
            }
        }
    }
}
