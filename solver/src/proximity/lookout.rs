//! Which pairs may have come near each other, looked at no more often than they can have moved.
//!
//! ```text
//! due = path + (d − keep)/2     two points that each moved by less than (d − keep)/2 are still keep apart
//! ```
//!
//! Symbols: path sum of the largest displacement of any node, step by step, m; d distance of a pair,
//! or a lower bound of it, m. Two patches wait as one until they are due; then they are taken apart,
//! down to pairs of primitives, which wait each for itself. Who looks says for how long.

use super::boxes::Boxes;
use crate::contact::topology::Topology;
use crate::state::Field;

/// What a lookout is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sought {
    /// Nodes and elements, edges and edges, that share no node.
    Meetings,
    /// Edges and elements that share no node.
    Piercings,
}

/// A pair of primitives that share no node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Candidate {
    /// A node and an element.
    NodeElement(u32, u32),
    /// Two edges, the lower number first.
    EdgeEdge(u32, u32),
    /// An edge and an element.
    EdgeElement(u32, u32),
}

/// What becomes of a pair that was looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Next {
    /// It waits until the path is so long, m.
    Wait(f64),
    /// Whoever looked sees to it.
    Taken,
}

/// How long pairs may wait.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rule {
    /// Distance pairs must not come nearer than unseen, m.
    pub keep: f64,
    /// What displacement bounds are multiplied by: 1 but in tests of the audit.
    pub bounds: f64,
    /// Patches that are due within so much more path are taken apart as well, m.
    pub ahead: f64,
}

/// Things waiting for the path to reach their number, in bins.
#[derive(Debug, Clone, PartialEq)]
struct Bins {
    /// Path of a bin, m.
    width: f64,
    /// First bin not taken yet, counted from path 0.
    reached: u64,
    /// A ring of bins; what is due beyond its end waits in the last.
    ring: Vec<Vec<[u32; 2]>>,
    /// What was put into a bin taken already.
    overdue: Vec<[u32; 2]>,
}

/// Bins of a ring.
const RING: usize = 1024;

impl Bins {
    fn new(width: f64, path: f64) -> Self {
        let ring = vec![Vec::new(); RING];
        let mut bins = Self { width, reached: 0, ring, overdue: Vec::new() };
        bins.reached = bins.number(path);
        bins
    }

    /// The bin of a path (m); the first where it is past, or no number.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    fn number(&self, path: f64) -> u64 {
        (path / self.width) as u64
    }

    fn put(&mut self, due: f64, pair: [u32; 2]) {
        let bin = self.number(due).min(self.reached + (RING as u64 - 1));
        if bin < self.reached {
            self.overdue.push(pair);
        } else {
            self.ring[place(bin)].push(pair);
        }
    }

    /// Moves to `due` what is due until then (m).
    fn take(&mut self, until: f64, due: &mut Vec<[u32; 2]>) {
        due.append(&mut self.overdue);
        let last = self.number(until);
        // One round empties the ring.
        for _ in 0..RING {
            if self.reached > last {
                return;
            }
            due.append(&mut self.ring[place(self.reached)]);
            self.reached += 1;
        }
        self.reached = self.reached.max(last + 1);
    }
}

#[expect(clippy::cast_possible_truncation, reason = "below the length of the ring")]
fn place(bin: u64) -> usize {
    (bin % RING as u64) as usize
}

/// Kind of a pair of primitives, in the upper bits of its first number.
const EDGES: u32 = 1 << 30;
const PIERCING: u32 = 2 << 30;
const NUMBER: u32 = EDGES - 1;

/// Every pair of a film, each waiting for its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Lookout {
    sought: Sought,
    patches: Bins,
    pairs: Bins,
    boxes: Boxes,
    /// Room for what is due.
    due: Vec<[u32; 2]>,
    later: Vec<[u32; 2]>,
}

impl Lookout {
    /// A lookout that has looked at nothing yet, at this path (m). `width`: path below which no pair is
    /// looked at twice, m.
    ///
    /// # Panics
    /// For film of 2^30 elements or more.
    pub fn new(sought: Sought, topology: &Topology, width: f64, path: f64) -> Self {
        assert!(topology.edges.len() < NUMBER as usize, "under 2^30 edges");
        let mut lookout = Self {
            sought,
            patches: Bins::new(width, path),
            pairs: Bins::new(width, path),
            boxes: Boxes::default(),
            due: Vec::new(),
            later: Vec::new(),
        };
        lookout.patches.put(path, [1, 1]);
        lookout
    }

    /// Has a pair wait until the path is `due` (m).
    pub fn wait(&mut self, candidate: Candidate, due: f64) {
        let pair = match candidate {
            Candidate::NodeElement(node, element) => [node, element],
            Candidate::EdgeEdge(edge, other) => [edge | EDGES, other],
            Candidate::EdgeElement(edge, element) => [edge | PIERCING, element],
        };
        self.pairs.put(due, pair);
    }

    /// Shows `look` every pair that could come nearer than the rule keeps while the path goes from
    /// `path` to `until` (m); the film is at these places (m) where the path is `path`.
    pub fn advance(
        &mut self,
        topology: &Topology,
        places: &Field,
        [path, until]: [f64; 2],
        rule: &Rule,
        mut look: impl FnMut(Candidate) -> Next,
    ) {
        let mut due = core::mem::take(&mut self.due);
        self.pairs.take(until, &mut due);
        for pair in due.drain(..) {
            if let Next::Wait(until) = look(candidate(pair)) {
                self.pairs.put(until, pair);
            }
        }
        if self.patches.reached <= self.patches.number(until) {
            let mut later = core::mem::take(&mut self.later);
            self.patches.take(until + rule.ahead, &mut later);
            if !later.is_empty() {
                self.boxes.fit(&topology.patches, places);
            }
            self.take_apart(topology, [path, until], rule, &mut later, &mut due);
            self.later = later;
            for pair in due.drain(..) {
                if let Next::Wait(until) = look(candidate(pair)) {
                    self.pairs.put(until, pair);
                }
            }
        }
        self.due = due;
    }

    /// Takes pairs of patches apart until each can wait; what is left as primitives goes to `due`.
    fn take_apart(
        &mut self,
        topology: &Topology,
        [path, until]: [f64; 2],
        rule: &Rule,
        later: &mut Vec<[u32; 2]>,
        due: &mut Vec<[u32; 2]>,
    ) {
        let leaves = topology.patches.leaves();
        while let Some([a, b]) = later.pop() {
            let (one, two) = (a as usize, b as usize);
            if one != two {
                let free = self.boxes.separation(one, two) - rule.keep;
                let wait = path + 0.5 * rule.bounds * free;
                // A place for patches that no patch is in is apart from everything.
                if free == f64::INFINITY {
                    continue;
                }
                // Never into a bin taken already: patches are looked at by whole bins.
                if wait > until + rule.ahead + self.patches.width {
                    self.patches.put(wait, [a, b]);
                    continue;
                }
            }
            if one >= leaves {
                primitives(self.sought, topology, one, two, due);
            } else if one == two {
                later.extend([[2 * a, 2 * a], [2 * a + 1, 2 * a + 1], [2 * a, 2 * a + 1]]);
            } else {
                for a in [2 * a, 2 * a + 1] {
                    later.extend([[a, 2 * b], [a, 2 * b + 1]]);
                }
            }
        }
    }
}

fn candidate([first, second]: [u32; 2]) -> Candidate {
    let number = first & NUMBER;
    match first & !NUMBER {
        EDGES => Candidate::EdgeEdge(number, second),
        PIERCING => Candidate::EdgeElement(number, second),
        _ => Candidate::NodeElement(number, second),
    }
}

/// Adds the pairs of primitives of two leaves that share no node.
fn primitives(
    sought: Sought,
    topology: &Topology,
    one: usize,
    two: usize,
    pairs: &mut Vec<[u32; 2]>,
) {
    let patches = &topology.patches;
    let apart = |edge: u32, element: u32| {
        let corners = topology.triangles[element as usize];
        !topology.edges[edge as usize].iter().any(|node| corners.contains(node))
    };
    let both = [(one, two), (two, one)];
    for (a, b) in both.into_iter().take(if one == two { 1 } else { 2 }) {
        for element in patches.elements(b) {
            match sought {
                Sought::Meetings => {
                    let corners = topology.triangles[*element as usize];
                    let nodes = patches.nodes(a).iter().filter(|node| !corners.contains(node));
                    pairs.extend(nodes.map(|node| [*node, *element]));
                }
                Sought::Piercings => {
                    let edges = patches.edges(a).iter().filter(|edge| apart(**edge, *element));
                    pairs.extend(edges.map(|edge| [*edge | PIERCING, *element]));
                }
            }
        }
    }
    if sought == Sought::Meetings {
        for (at, edge) in patches.edges(one).iter().enumerate() {
            let [p, q] = topology.edges[*edge as usize];
            let others =
                if one == two { &patches.edges(two)[at + 1..] } else { patches.edges(two) };
            for other in others {
                let [r, s] = topology.edges[*other as usize];
                if p != r && p != s && q != r && q != s {
                    pairs.push([(*edge).min(*other) | EDGES, (*edge).max(*other)]);
                }
            }
        }
    }
}

/// Every pair whose boxes are nearer than `radius` (m).
pub fn nearer(
    sought: Sought,
    topology: &Topology,
    boxes: &Boxes,
    radius: f64,
    mut found: impl FnMut(Candidate),
) {
    let leaves = topology.patches.leaves();
    let mut later = vec![[1_usize, 1]];
    let mut pairs = Vec::new();
    while let Some([one, two]) = later.pop() {
        if one != two && boxes.separation(one, two) > radius {
            continue;
        }
        if one >= leaves {
            primitives(sought, topology, one, two, &mut pairs);
            pairs.drain(..).for_each(|pair| found(candidate(pair)));
        } else if one == two {
            later.extend([[2 * one, 2 * one], [2 * one + 1, 2 * one + 1], [2 * one, 2 * one + 1]]);
        } else {
            for one in [2 * one, 2 * one + 1] {
                later.extend([[one, 2 * two], [one, 2 * two + 1]]);
            }
        }
    }
}
