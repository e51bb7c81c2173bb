//! Watches a run for passages, step by step or from frame to frame.
//!
//! Frames of the audit lie a block of steps apart. On the straight way from one to the next only pairs
//! of film that could have come together are looked at ([`crate::collision::broad_phase::scheduler`]); a pair that
//! seems to pass is then looked at at each of its steps. Now and then, and always where every step is
//! asked for, a block is looked at step by step and from nothing but its places: so nothing that waits
//! is trusted for long.

pub mod passages;

use nalgebra::Vector3;

use crate::collision::broad_phase::kdop::KDops;
use crate::collision::broad_phase::scheduler::{
    CandidateKind, CandidateScheduler, QueryKind, nearer,
};
use crate::collision::contact::distance_batch::{edge_gaps, element_gaps};
use crate::collision::contact::intersections::IntersectionCounter;
use crate::collision::contact::topology::Topology;
use crate::geometry::field::Field;
use crate::platform::simd::InstructionSet;
use crate::scene::monitor_settings::MonitorSettings;
use passages::{Passage, passage, passages};

/// Path of a bin of the lookout, as a share of the film's size.
const BIN: f64 = 2e-3;

/// Watches a run step by step.
#[derive(Debug, Clone, PartialEq)]
pub struct TunnellingMonitor {
    how: MonitorSettings,
    /// Steps of the run before the audit frame.
    start: u64,
    /// Places at the audit frame and after each step since.
    frames: Vec<Field>,
    used: usize,
    /// Patches of film waiting to come near each other.
    lookout: CandidateScheduler,
    /// Intersections of the mesh.
    pub piercings: IntersectionCounter,
    /// Passages so far.
    pub passages: u64,
    /// The first, and where its first node was (m).
    pub first: Option<(Passage, Vector3<f64>)>,
}

impl TunnellingMonitor {
    /// Starts at these places (m), after so many steps of the run.
    pub fn new(how: MonitorSettings, topology: &Topology, places: &Field, steps: u64) -> Self {
        let frames = vec![places.clone(); how.block as usize + 1];
        let mut lookout =
            CandidateScheduler::new(QueryKind::Collision, topology, BIN * places.size());
        // Every pair once, here: no block is dearer than others for being the first.
        lookout.now(topology, places, gaps_at(topology, places), |_, _| {});
        Self {
            how,
            start: steps,
            frames,
            used: 1,
            lookout,
            piercings: IntersectionCounter::new(topology, places),
            passages: 0,
            first: None,
        }
    }

    /// Takes note of the places (m) after a step; looks at a block when it is full.
    pub fn step(&mut self, topology: &Topology, places: &Field) {
        self.frames[self.used].copy_from(places);
        self.used += 1;
        if self.used == self.frames.len() {
            self.look(topology);
        }
    }

    /// Looks at what has not been looked at yet.
    pub fn look(&mut self, topology: &Topology) {
        let steps = self.used - 1;
        if steps == 0 {
            return;
        }
        let found = if self.how.closely(self.start) {
            self.lookout.travel(topology, &self.frames[0], &self.frames[steps]);
            passages_step_by_step(topology, &self.frames[..=steps])
        } else {
            self.passages_of_block(topology, steps)
        };
        if self.first.is_none() {
            self.first = found.first().map(|passage| {
                let [node, ..] = passage.nodes(topology);
                (*passage, self.frames[steps].get(node as usize))
            });
        }
        self.passages += found.len() as u64;
        self.start += steps as u64;
        self.frames.swap(0, steps);
        self.used = 1;
    }

    /// Looks at the straight way from the first to the last place of a block, and at each step where a
    /// pair seems to pass on it.
    fn passages_of_block(&mut self, topology: &Topology, steps: usize) -> Vec<Passage> {
        let (frames, mut found) = (&self.frames, Vec::new());
        let (from, to) = (&frames[0], &frames[steps]);
        self.lookout.pass(topology, [from, to], gaps_at(topology, from), |couple, pair| {
            let own = passage(couple, pair);
            let between = own.parting(topology, from, &own.closest(topology, from));
            if !own.stays_apart(topology, to, &between) && own.happens(topology, from, to) {
                let happens =
                    |step: &usize| own.happens(topology, &frames[*step], &frames[step + 1]);
                found.extend((0..steps).filter(happens).map(|_| own));
            }
        });
        found.sort_unstable();
        found
    }
}

/// Distances of pairs of one kind at these places (m), m.
fn gaps_at<'a>(
    topology: &'a Topology,
    places: &'a Field,
) -> impl FnMut(CandidateKind, &[[u32; 2]], &mut Vec<f64>) + 'a {
    |couple, pairs, gaps| match couple {
        CandidateKind::EdgeEdge => {
            edge_gaps(InstructionSet::detect(), topology, places, pairs, gaps);
        }
        _ => element_gaps(InstructionSet::detect(), topology, places, pairs, gaps),
    }
}

/// Every passage of some steps, told from nothing but their places.
fn passages_step_by_step(topology: &Topology, frames: &[Field]) -> Vec<Passage> {
    if let [from, to] = frames {
        return passages(topology, from, to);
    }
    let (first, mut way) = (&frames[0], 0.0_f64);
    let mut boxes = KDops::new(&topology.patches, first);
    for frame in &frames[1..] {
        boxes.hold(&topology.patches, frame);
        way = way.max(first.largest_way(frame));
    }
    let mut found = Vec::new();
    nearer(QueryKind::Collision, topology, &boxes, 0.0, |couple, pair| {
        let own = passage(couple, pair);
        let closest = own.closest(topology, first);
        // Farther apart than both can have come towards each other.
        if closest.squared > 4.0 * way * way {
            return;
        }
        // A plane that parts the pair before each step: the last that still does.
        let mut between = own.parting(topology, first, &closest);
        for (step, pair) in frames.windows(2).enumerate() {
            if own.stays_apart(topology, &pair[1], &between) {
                continue;
            }
            if own.happens(topology, &pair[0], &pair[1]) {
                found.push((step, own));
            }
            between = own.parting(topology, &pair[1], &own.closest(topology, &pair[1]));
        }
    });
    found.sort_unstable();
    found.into_iter().map(|(_, own)| own).collect()
}

#[cfg(test)]
mod tests {
    use super::passages::tests::{scene, v};
    use super::*;
    use crate::collision::contact::intersections::intersections;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn steps_at_once_tell_what_each_tells(
            places in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 6), 2..9),
            shares in prop::array::uniform2(0.01..1.0_f64),
            nearly in prop::sample::select(vec![None, Some(0.0), Some(1e-7)]),
        ) {
            let topology = Topology::new(6, &[[0, 1, 2], [3, 4, 5]]);
            // From steps far apart to such as film takes, and edges as good as parallel.
            let first: Vec<Vector3<f64>> = places[0].iter().map(|x| Vector3::from(*x)).collect();
            let frame = |own: &Vec<[f64; 3]>| {
                let to = |(x, y): (&Vector3<f64>, &[f64; 3])| {
                    let y = Vector3::from(*y);
                    x + (y - x).component_mul(&Vector3::new(shares[0], shares[0], shares[1]))
                };
                let mut x: Vec<Vector3<f64>> = first.iter().zip(own).map(to).collect();
                if let Some(lean) = nearly {
                    x[4] = x[3] + (x[1] - x[0]) * 1.1 + Vector3::new(0.0, 0.0, lean);
                }
                Field::of(&x)
            };
            let frames: Vec<Field> = places.iter().map(frame).collect();
            let each: Vec<Passage> =
                frames.windows(2).flat_map(|two| passages(&topology, &two[0], &two[1])).collect();
            prop_assert_eq!(passages_step_by_step(&topology, &frames), each);
        }
    }

    #[test]
    fn a_way_there_and_back_is_found_step_by_step_only() {
        let corner = [v(0.3, 0.3, 0.1), v(0.3, 0.8, 3.0), v(0.8, 0.3, 3.0)];
        let (topology, from, to) = scene(&corner, v(0.0, 0.0, -0.2));
        let count = |how: MonitorSettings| {
            let mut watch = TunnellingMonitor::new(how, &topology, &from, 0);
            watch.step(&topology, &to);
            watch.step(&topology, &from);
            watch.look(&topology);
            watch.passages
        };
        assert_eq!(count(MonitorSettings::EVERY_STEP), 2);
        assert_eq!(
            count(MonitorSettings { every_step_of_one_in: 1, ..MonitorSettings::FRAMES }),
            2
        );
        let mut watch = TunnellingMonitor::new(MonitorSettings::FRAMES, &topology, &from, 0);
        assert!(!MonitorSettings::FRAMES.closely(0));
        watch.step(&topology, &to);
        watch.look(&topology);
        assert_eq!(watch.passages, 1);
        assert!(watch.first.is_some());
    }

    #[test]
    fn about_one_block_in_a_hundred_is_looked_at_closely() {
        let close = (0..100_000).filter(|block| MonitorSettings::FRAMES.closely(*block)).count();
        assert!((900..1100).contains(&close), "{close}");
    }

    proptest! {
        /// Pairs that wait are counted when they pass, whatever the film does, and so are intersections.
        #[test]
        fn waiting_misses_nothing(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 18),
            ways in prop::collection::vec(
                prop::collection::vec(prop::array::uniform3(-0.2..0.2_f64), 18),
                1..12,
            ),
        ) {
            let triangles = [[0, 1, 2], [2, 1, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12], [13, 14, 15]];
            let mut triangles = triangles.to_vec();
            triangles.push([13, 16, 17]);
            let topology = Topology::new(18, &triangles);
            let mut x: Vec<Vector3<f64>> = places.into_iter().map(Vector3::from).collect();
            // No block is ever looked at step by step.
            let how = MonitorSettings { block: 1, every_step_of_one_in: u64::MAX, seed: 1 };
            let mut watch = TunnellingMonitor::new(how, &topology, &Field::of(&x), 0);
            let mut counted = 0;
            for way in ways {
                let from = Field::of(&x);
                for (x, way) in x.iter_mut().zip(way) {
                    *x += Vector3::from(way);
                }
                let to = Field::of(&x);
                counted += passages(&topology, &from, &to).len() as u64;
                watch.step(&topology, &to);
                prop_assert_eq!(watch.passages, counted);
                watch.piercings.look(&topology, &to);
                let all = intersections(&topology, &to).len() as u64;
                prop_assert_eq!(watch.piercings.count, all);
            }
        }
    }
}
