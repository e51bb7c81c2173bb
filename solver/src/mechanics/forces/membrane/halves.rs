//! The pass over the elements in two halves at once, with the bits of one pass.
//!
//! ```text
//! blocks   0 ............ middle ............ end
//!          into slots of   into slots of the nodes they alone touch,
//!          their nodes     and one slot a corner of nodes both touch
//! nodes    slot [+ slots of the later half's corners, one by one]
//! ```
//!
//! One pass adds what kites give to a node in their order, corner by corner. Here a node of both halves gets
//! the sum of the first half, then the second half's corners in that order: the same additions. Volumes
//! and works are sums over all elements lane by lane, block after block: those of the second half are
//! kept a block, and added to the sums of the first when these are known. A slot begins with +0, so none
//! is ever −0, and adding what stayed +0 changes no bit.

use core::ops::Range;

use super::{LaneSums, NodeForces, Share, Sums, ViscousHistory, element_pass, element_pass_kept};
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{Corners, InstructionSet, Lanes, NodeSum, WIDTH};
use crate::platform::workers::Workers;

/// What two halves of a model's blocks add to, and how that becomes sums of nodes.
#[derive(Debug, Clone)]
pub struct Halves {
    /// Where the corners of each half add to, in slots of its own.
    targets: [Corners; 2],
    /// Slots of the first half.
    first_slots: usize,
    /// Slot of each node, those of the second half after those of the first.
    slot: Vec<u32>,
    /// Slots of the corners the second half has at nodes of both, by node.
    joints: Vec<Joint>,
    /// The first node of the second half's landing.
    middle: usize,
    /// The first of `joints` from there on.
    middle_joint: usize,
    sums: Vec<NodeSum>,
    terms: Vec<[Lanes; 2]>,
}

/// A node both halves touch, and its corners in the second.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Joint {
    node: usize,
    corners: Range<usize>,
}

impl Halves {
    /// For the blocks of a model.
    ///
    /// # Panics
    /// Above 2^31 corners.
    pub fn new(model: &FilmModel) -> Self {
        let (nodes, blocks) = (model.nodes(), model.blocks.blocks());
        let early = (blocks / 2 * WIDTH).min(model.kites.len());
        let (first, second) = model.kites.split_at(early);
        // Nodes of no element are the first half's: somebody has to land them.
        let mut of_second = vec![false; nodes];
        second.iter().flatten().for_each(|node| of_second[*node as usize] = true);
        first.iter().flatten().for_each(|node| of_second[*node as usize] = false);

        let first_slots = of_second.iter().filter(|own| !**own).count();
        let (mut next, mut next_second) = (0, slot_number(first_slots));
        let mut slot = Vec::with_capacity(nodes);
        for own in &of_second {
            let counter = if *own { &mut next_second } else { &mut next };
            slot.push(*counter);
            *counter += 1;
        }

        let mut corners = Vec::new();
        for (kite, nodes) in second.iter().enumerate() {
            for (corner, node) in nodes.iter().enumerate() {
                if !of_second[*node as usize] {
                    corners.push((*node as usize, kite, corner));
                }
            }
        }
        // By node, then in the order in which kites add.
        corners.sort_unstable();
        let mut own: Vec<[u32; 4]> =
            second.iter().map(|kite| kite.map(|node| slot[node as usize])).collect();
        let mut joints: Vec<Joint> = Vec::new();
        for (index, (node, kite, corner)) in corners.iter().enumerate() {
            own[*kite][*corner] = slot_number(nodes + index);
            match joints.last_mut().filter(|joint| joint.node == *node) {
                Some(joint) => joint.corners.end += 1,
                None => {
                    joints.push(Joint { node: *node, corners: nodes + index..nodes + index + 1 });
                }
            }
        }
        own.iter_mut().flatten().for_each(|own| *own -= slot_number(first_slots));
        let first: Vec<[u32; 4]> =
            first.iter().map(|kite| kite.map(|node| slot[node as usize])).collect();

        let slots = nodes + corners.len();
        let targets = [Corners::new(&first, first_slots), Corners::new(&own, slots - first_slots)];
        let middle = nodes / 2 / WIDTH * WIDTH;
        Self {
            first_slots,
            slot,
            middle,
            middle_joint: joints.partition_point(|joint| joint.node < middle),
            joints,
            sums: vec![NodeSum::default(); slots],
            terms: vec![[Lanes::default(); 2]; targets[1].blocks()],
            targets,
        }
    }

    /// [`super::assemble_membrane`], shared: the same bits.
    #[expect(clippy::too_many_arguments, reason = "those of the pass, and who does it")]
    pub fn assemble_membrane(
        &mut self,
        workers: &mut Workers,
        path: InstructionSet,
        model: &FilmModel,
        positions: &Field,
        step: f64,
        past: &mut [[ViscousHistory; 2]],
        out: &mut NodeForces,
    ) -> Sums {
        let early = self.targets[0].blocks();
        let [first, second] = {
            let (past, later_past) = past.split_at_mut(early);
            let (sums, later_sums) = self.sums.split_at_mut(self.first_slots);
            let [targets, later_targets] = &self.targets;
            let terms = &mut self.terms;
            [
                Share { first: 0, targets, past, sums, terms: &mut [] },
                Share {
                    first: early,
                    targets: later_targets,
                    past: later_past,
                    sums: later_sums,
                    terms,
                },
            ]
        };
        let (early_sums, later_sums) = workers.both(
            || element_pass(path, model, positions, step, first),
            || element_pass_kept(path, model, positions, step, second),
        );

        let (nodes, later_nodes) = out.sums.split_at_mut(self.middle);
        let whole = &*self;
        let ((), sums) = workers.both(
            || whole.land(0, &whole.joints[..whole.middle_joint], nodes),
            || {
                let later = &whole.joints[whole.middle_joint..];
                whole.land(whole.middle, later, later_nodes);
                // Here, where the terms were made: they are many and far from the other thread.
                whole.sum(early_sums, later_sums)
            },
        );
        sums
    }

    /// Writes the sums of the nodes from `from` on.
    fn land(&self, from: usize, joints: &[Joint], nodes: &mut [NodeSum]) {
        let slots = &self.slot[from..from + nodes.len()];
        for (slot, node) in slots.iter().zip(nodes.iter_mut()) {
            *node = self.sums[*slot as usize];
        }
        for joint in joints {
            for corner in &self.sums[joint.corners.clone()] {
                nodes[joint.node - from].add(corner);
            }
        }
    }

    /// The sums over all elements.
    fn sum(&self, early: LaneSums, later: LaneSums) -> Sums {
        let LaneSums { mut volumes, mut works, largest } = early;
        for [volume, taken] in &self.terms {
            volumes += *volume;
            works += *taken;
        }
        // The larger of two does not ask in which order; a stress that is no number ends the run.
        LaneSums { volumes, works, largest: largest.max(later.largest) }.sums()
    }
}

fn slot_number(slot: usize) -> u32 {
    u32::try_from(slot).expect("at most 2^31 corners")
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};
    use proptest::prelude::*;

    use super::*;
    use crate::mechanics::forces::membrane::assemble_membrane;
    use crate::scene::Film;

    const FILM: Film = Film { compression: 0.3, ..Film::PAPER };

    /// Triangles between any nodes at all, so that most nodes are touched by both halves.
    fn tangle(triangles: &[[u32; 3]]) -> FilmModel {
        let corner = |x: f64, y: f64| Vector2::new(x, y);
        let reference = [corner(0.0, 0.0), corner(0.1, 0.0), corner(0.03, 0.08)];
        let nodes = 1 + triangles.iter().flatten().max().map_or(0, |last| *last as usize);
        let all: Vec<[u32; 3]> = triangles.to_vec();
        FilmModel::new(&FILM, nodes, &all, &vec![reference; all.len()]).expect("a film")
    }

    fn bits(out: &NodeForces, past: &[[ViscousHistory; 2]], sums: &Sums) -> Vec<u64> {
        let (films, areas) = (out.films(), out.areas());
        let nodes = films.iter().chain(areas.iter()).flat_map(|own| [own.x, own.y, own.z]);
        let past = past.iter().flatten().flat_map(|own| [own.strain, own.drag]).flatten();
        let past = past.flat_map(|lanes| lanes.0);
        let own = [sums.six_volumes, sums.viscous_work, sums.largest_stress];
        nodes.chain(past).chain(own).map(f64::to_bits).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn two_halves_have_the_bits_of_the_whole(
            triples in prop::collection::vec(prop::array::uniform3(0_u32..30), 1..90),
            numbers in prop::collection::vec(prop::array::uniform6(-1.0..1.0_f64), 30),
        ) {
            // Every node has an element: the nodes that are named, numbered anew.
            let mut named: Vec<u32> = triples.iter().flatten().copied().collect();
            named.sort_unstable();
            named.dedup();
            let number = |node: &u32| u32::try_from(named.partition_point(|own| own < node)).unwrap();
            let triangles: Vec<[u32; 3]> =
                triples.iter().map(|triple| triple.each_ref().map(number)).collect();
            let model = tangle(&triangles);
            let of = |pick: &dyn Fn(&[f64; 6]) -> Vector3<f64>| {
                Field::of(&numbers[..model.nodes()].iter().map(pick).collect::<Vec<_>>())
            };
            let places = of(&|n| Vector3::new(n[0], n[1], n[2]) * 0.1);
            let later = of(&|n| Vector3::new(n[3], n[4], n[5]) * 0.1);
            let (mut past, mut out) = (ViscousHistory::at_rest(&model), NodeForces::new(&model));
            let mut told = Vec::new();
            for (x, step) in [(&places, 0.0), (&later, 1e-3), (&places, 2e-3), (&places, 0.0)] {
                let sums = assemble_membrane(InstructionSet::Scalar, &model, x, step, &mut past, &mut out);
                told.push((x, step, bits(&out, &past, &sums)));
            }
            for path in InstructionSet::ALL {
                for threads in [1, 2] {
                    let (mut past, mut out) = (ViscousHistory::at_rest(&model), NodeForces::new(&model));
                    let (mut workers, mut halves) = (Workers::of(threads), Halves::new(&model));
                    for (x, step, told) in &told {
                        let sums = halves.assemble_membrane(
                            &mut workers, path, &model, x, *step, &mut past, &mut out,
                        );
                        prop_assert!(bits(&out, &past, &sums) == *told, "{} {threads}", path.name());
                    }
                }
            }
        }
    }
}
