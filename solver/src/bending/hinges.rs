//! Hinges: edges between two elements, their turn and its gradient.
//!
//! ```text
//! kite s, a, t, b with edges p = a − s, d = t − s, q = b − s, l = |d|
//!   normals        N1 = p × d    N2 = d × q
//!   turn           u = 2 tan(θ/2) = 2 l p·N2/(|N1||N2| + N1·N2)          positive where film folds inward
//!   gradient       ∂θ/∂a = g1 = l N1/|N1|²     ∂θ/∂b = g2 = l N2/|N2|²
//!                  ∂θ/∂t = −(α1 g1 + α2 g2)    ∂θ/∂s = −((1−α1) g1 + (1−α2) g2)
//!                  α1 = p·d/l²   α2 = q·d/l²    ∂u/∂θ = 1 + u²/4
//! ```
//!
//! Beyond [`MAX_SMOOTH_TURN`] u goes on with the slope that it has there. A crease has u = θ.

#![allow(clippy::inline_always, reason = "inside the loop over hinges")]

use core::f64::consts::PI;
use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::geometry::shell::Shell;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{
    Columns, Corners, InstructionSet, Lanes, NodeSum, Vectors, WIDTH, Wide, dispatch_wide,
};
use crate::scene::Creases;

/// θ up to which u = 2 tan(θ/2), rad. Chosen: the stiffness of a hinge is at most 16 times that of flat film.
pub const MAX_SMOOTH_TURN: f64 = 2.0 * PI / 3.0;
/// Cosine of that angle.
const MIN_COSINE: f64 = -0.5;
/// Difference of the reference coordinates of a shared node over the edge at which two elements lie in one
/// reference plane. Chosen: above rounding.
const SAME_PLACE: f64 = 1e-9;

/// u at [`MAX_SMOOTH_TURN`].
fn largest_smooth() -> f64 {
    2.0 * libm::tan(0.5 * MAX_SMOOTH_TURN)
}

/// The largest ∂u/∂θ.
pub fn largest_slope() -> f64 {
    1.0 + 0.25 * largest_smooth() * largest_smooth()
}

/// Eight hinges at some positions.
#[derive(Debug, Clone, Copy, Default)]
pub struct HingeBlock {
    /// g1 and g2, 1/m.
    gradients: [Vectors; 2],
    /// α1 and α2.
    along: [Lanes; 2],
    /// ∂u/∂θ.
    slope: Lanes,
}

/// The hinges of a film, in the order of their unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Hinges {
    /// Nodes s, a, t, b.
    pub nodes: Vec<[u32; 4]>,
    /// Elements (s, a, t) and (s, t, b), each with the corner opposite to the edge.
    pub sides: Vec<[(usize, usize); 2]>,
    /// Largest |∂θ/∂x| of the nodes s, a, t, b in the reference, 1/m.
    pub leverages: Vec<[f64; 4]>,
    /// Length of the edge in the reference, m.
    pub lengths: Vec<f64>,
    /// The first crease: they come last.
    pub first_crease: usize,
    corners: Corners,
    /// ū; zero past the last hinge.
    rest: Vec<f64>,
}

impl Hinges {
    /// The hinges of a shell: inner edges that do not lie between two rigid elements. Those on a fold line are creases,
    /// or turn freely and are none.
    pub(super) fn new(
        model: &FilmModel,
        shell: &Shell,
        rigid: &[bool],
        creases: Option<Creases>,
    ) -> Self {
        let mut directed = BTreeMap::new();
        for (element, nodes) in model.triangles.iter().enumerate() {
            for corner in 0..3 {
                directed
                    .insert([nodes[(corner + 1) % 3], nodes[(corner + 2) % 3]], (element, corner));
            }
        }
        // In the order of the elements, so that facets with the same mesh have the same order.
        let all =
            (0..model.elements()).flat_map(|element| [0, 1, 2].map(|corner| (element, corner)));
        let (mut film, mut folded) = (Vec::new(), Vec::new());
        for first in all {
            let corners = model.triangles[first.0];
            let (t, s) = (corners[(first.1 + 1) % 3], corners[(first.1 + 2) % 3]);
            let Some(&second) = directed.get(&[s, t]) else { continue };
            if second.0 < first.0 || (rigid[first.0] && rigid[second.0]) {
                continue;
            }
            let fold = shell.folds.binary_search(&[s.min(t), s.max(t)]).is_ok();
            if fold { folded.push([first, second]) } else { film.push([first, second]) }
        }
        let first_crease = film.len();
        if creases.is_some() {
            film.extend(folded);
        }
        let sides = film;
        let nodes_of = |[first, second]: &[(usize, usize); 2]| {
            let of = |(element, corner): (usize, usize), step: usize| {
                model.triangles[element][(corner + step) % 3]
            };
            [of(*first, 2), of(*first, 0), of(*first, 1), of(*second, 0)]
        };
        let nodes: Vec<[u32; 4]> = sides.iter().map(nodes_of).collect();
        let leverages = sides.iter().map(|sides| leverage(shell, *sides)).collect();
        let length = |[first, _]: &[(usize, usize); 2]| {
            let [_, t, s] = reference(shell, *first);
            (t - s).norm()
        };
        let lengths = sides.iter().map(length).collect();
        let corners = Corners::new(&nodes, model.nodes());
        let rest = vec![0.0; corners.blocks() * WIDTH];
        let mut hinges = Self { nodes, sides, leverages, lengths, first_crease, corners, rest };
        let (mut blocks, mut turns) = (Vec::new(), Vec::new());
        let start = Field::of(&shell.positions);
        hinges.measure(InstructionSet::Scalar, &start, &mut blocks, &mut turns);
        for (hinge, turn) in turns.into_iter().take(hinges.len()).enumerate() {
            let flat = in_one_plane(shell, hinges.sides[hinge]);
            hinges.rest[hinge] = match creases.filter(|_| hinge >= first_crease) {
                Some(Creases { rest_angle: Some(angle), .. }) => angle.copysign(turn),
                None if flat => 0.0,
                _ => turn,
            };
        }
        hinges
    }

    /// The same hinges, each with four nodes for itself.
    pub(super) fn separate(&self) -> Self {
        let count = u32::try_from(4 * self.len()).expect("under 2^32");
        let nodes: Vec<[u32; 4]> =
            (0..count).step_by(4).map(|k| [k, k + 1, k + 2, k + 3]).collect();
        let corners = Corners::new(&nodes, count as usize);
        Self { nodes, corners, ..self.clone() }
    }

    /// Number of hinges.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Computes shape and u − ū of the hinges at these positions (m); zero past the last hinge.
    pub(super) fn measure(
        &self,
        set: InstructionSet,
        positions: &Field,
        blocks: &mut Vec<HingeBlock>,
        turns: &mut Vec<f64>,
    ) {
        blocks.resize(self.corners.blocks(), HingeBlock::default());
        turns.resize(self.rest.len(), 0.0);
        let largest = largest_smooth();
        let limits = (largest, self.first_crease);
        measure_hinges(set, &self.corners, positions, limits, &self.rest, blocks, turns);
    }

    /// Sets `sums` to the forces (N) of moments (N m) at hinges of these shapes.
    pub(super) fn add_forces(
        &self,
        set: InstructionSet,
        blocks: &[HingeBlock],
        moments: &mut Vec<f64>,
        sums: &mut [NodeSum],
    ) {
        moments.resize(self.rest.len(), 0.0);
        if self.is_empty() {
            sums.fill(NodeSum::default());
        }
        sum_forces(set, &self.corners, blocks, moments, sums);
    }

    /// ∂u/∂x of the nodes s, a, t, b of a hinge, 1/m.
    pub(super) fn gradient(blocks: &[HingeBlock], hinge: usize) -> [Vector3<f64>; 4] {
        let (block, lane) = (&blocks[hinge / WIDTH], hinge % WIDTH);
        let slope = block.slope.0[lane];
        let [a, b] =
            block.gradients.map(|v| Vector3::new(v.x.0[lane], v.y.0[lane], v.z.0[lane]) * slope);
        let t = -(a * block.along[0].0[lane] + b * block.along[1].0[lane]);
        [-(a + b + t), a, t, b]
    }
}

/// Reference corners of an element, counted from the corner opposite to an edge.
fn reference(shell: &Shell, (element, corner): (usize, usize)) -> [nalgebra::Vector2<f64>; 3] {
    [0, 1, 2].map(|step| shell.reference[element][(corner + step) % 3])
}

/// Whether the references of two elements place their common edge alike.
fn in_one_plane(shell: &Shell, sides: [(usize, usize); 2]) -> bool {
    let [[_, t, s], [_, other_s, other_t]] = sides.map(|side| reference(shell, side));
    let allowed = SAME_PLACE * (t - s).norm();
    (t - other_t).norm() <= allowed && (s - other_s).norm() <= allowed
}

/// The leverages of the nodes s, a, t, b at a hinge.
fn leverage(shell: &Shell, sides: [(usize, usize); 2]) -> [f64; 4] {
    let [first, second] = sides.map(|side| reference(shell, side));
    // Height of the opposite corner, and the share of the edge that is at its foot, from s on.
    let measures = |opposite: nalgebra::Vector2<f64>, s: nalgebra::Vector2<f64>, t| {
        let d: nalgebra::Vector2<f64> = t - s;
        let p = opposite - s;
        (1.0 / (d.perp(&p).abs() / d.norm()), p.dot(&d) / d.norm_squared())
    };
    let (a, at_a) = measures(first[0], first[2], first[1]);
    let (b, at_b) = measures(second[0], second[1], second[2]);
    [(1.0 - at_a).abs() * a + (1.0 - at_b).abs() * b, a, at_a.abs() * a + at_b.abs() * b, b]
}

/// θ-proportional u beyond [`MAX_SMOOTH_TURN`]; `sine` and `cosine` of θ up to a common factor.
fn folded_turn(largest: f64, sine: f64, cosine: f64) -> f64 {
    let beyond = libm::atan2(sine.abs(), cosine) - MAX_SMOOTH_TURN;
    let turn = largest + (1.0 + 0.25 * largest * largest) * beyond;
    if sine < 0.0 { -turn } else { turn }
}

#[inline(always)]
fn plain<L: Wide>(vectors: &Vectors<L>) -> Vectors {
    Vectors { x: vectors.x.lanes(), y: vectors.y.lanes(), z: vectors.z.lanes() }
}

#[inline(always)]
fn measure_kernel<L: Wide>(
    corners: &Corners,
    positions: &Field,
    (largest, first_crease): (f64, usize),
    rest: &[f64],
    blocks: &mut [HingeBlock],
    turns: &mut [f64],
) {
    let columns = Columns::new(corners, [&positions.x, &positions.y, &positions.z]);
    // A lane without a hinge has no area: its gradient is zero.
    let tiny = L::splat(f64::MIN_POSITIVE);
    for block in 0..corners.blocks() {
        let first = block * WIDTH;
        let [s, a, t, b] = columns.corners::<L>(block, 0);
        let (p, d, q) = (a - s, t - s, b - s);
        let (n1, n2) = (p.cross(d), d.cross(q));
        let (n1_squared, n2_squared) = (n1.dot(n1).max(tiny), n2.dot(n2).max(tiny));
        let l_squared = d.dot(d).max(tiny);
        let l = l_squared.sqrt();
        let sine = l * p.dot(n2);
        let cosine = n1.dot(n2);
        let size = (n1_squared * n2_squared).sqrt();
        let mut turn = (sine + sine).over((size + cosine).max(tiny));
        let mut slope = L::splat(1.0) + turn * turn * 0.25;
        let beyond = size * MIN_COSINE - cosine;
        if beyond.lanes().largest() > 0.0 || first + WIDTH > first_crease {
            let (sine, cosine, beyond) = (sine.lanes(), cosine.lanes(), beyond.lanes());
            let (mut lanes, mut slopes) = (turn.lanes(), slope.lanes());
            for lane in 0..WIDTH {
                if first + lane >= first_crease {
                    lanes.0[lane] = libm::atan2(sine.0[lane], cosine.0[lane]);
                    slopes.0[lane] = 1.0;
                } else if beyond.0[lane] > 0.0 {
                    lanes.0[lane] = folded_turn(largest, sine.0[lane], cosine.0[lane]);
                    slopes.0[lane] = 1.0 + 0.25 * largest * largest;
                }
            }
            (turn, slope) = (L::load(&lanes.0, 0), L::load(&slopes.0, 0));
        }
        (turn - L::load(rest, first)).store(turns, first);
        let out = &mut blocks[block];
        let scaled = [n1.scale(l.over(n1_squared)), n2.scale(l.over(n2_squared))];
        out.gradients = [plain(&scaled[0]), plain(&scaled[1])];
        out.along = [p.dot(d).over(l_squared).lanes(), q.dot(d).over(l_squared).lanes()];
        out.slope = slope.lanes();
    }
}

dispatch_wide! {
    fn measure_hinges / measure_kernel(
        corners: &Corners,
        positions: &Field,
        limits: (f64, usize),
        rest: &[f64],
        blocks: &mut [HingeBlock],
        turns: &mut [f64],
    )
}

#[inline(always)]
fn load<L: Wide>(vectors: &Vectors) -> Vectors<L> {
    let Vectors { x, y, z } = vectors;
    Vectors { x: L::load(&x.0, 0), y: L::load(&y.0, 0), z: L::load(&z.0, 0) }
}

#[inline(always)]
fn force_kernel<L: Wide>(
    corners: &Corners,
    blocks: &[HingeBlock],
    moments: &[f64],
    sums: &mut [NodeSum],
) {
    let zero = L::splat(0.0);
    let none = Vectors { x: zero, y: zero, z: zero };
    let mut cleared = 0;
    for (block, HingeBlock { gradients, along, slope }) in blocks.iter().enumerate() {
        cleared = corners.clear_sums(block, cleared, sums);
        let factor = -(L::load(moments, block * WIDTH) * L::load(&slope.0, 0));
        let a = load::<L>(&gradients[0]).scale(factor);
        let b = load::<L>(&gradients[1]).scale(factor);
        let t = -(a.scale(L::load(&along[0].0, 0)) + b.scale(L::load(&along[1].0, 0)));
        let film = [-(a + b + t), a, t, b];
        corners.scatter((block, 0), &film, &[none, none, none], sums);
    }
}

dispatch_wide! {
    fn sum_forces / force_kernel(
        corners: &Corners,
        blocks: &[HingeBlock],
        moments: &[f64],
        sums: &mut [NodeSum],
    )
}
