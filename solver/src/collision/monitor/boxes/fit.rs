//! Boxes around elements, and where they are along an axis.
//!
//! ```text
//! lower = min x - r,  upper = max x + r        nodes of the element, in the first frame and in the last one less its shift
//! ```
//!
//! Symbols: x coordinate of a node, m; r reach, m. Ends are rounded to `f32`.

#![allow(clippy::inline_always, reason = "inside the loop over elements")]
#![allow(clippy::needless_range_loop, reason = "an iterator is not inlined into a target feature")]

use super::Ends;
use crate::geometry::field::Field;
use crate::platform::simd::{Vectors, WIDTH, Wide, dispatch, dispatch_wide, nodes_of, vectors_at};

/// Partial sums of widths. Chosen: the same on every instruction set.
const LANES: usize = 16;

/// Where boxes are along one axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    /// Lowest and highest end, m.
    pub(super) ends: [f32; 2],
    /// Sum of all widths, m.
    pub(super) widths: f64,
}

impl Range {
    /// Length, m.
    pub(super) fn length(&self) -> f64 {
        f64::from(self.ends[1]) - f64::from(self.ends[0])
    }
}

#[inline(always)]
fn min<L: Wide>(a: L, b: L) -> L {
    -((-a).max(-b))
}

/// The smallest and the largest of three values, lane by lane. NaN may be left out.
#[inline(always)]
fn ends_of<L: Wide>(a: L, b: L, c: L) -> [L; 2] {
    [min(min(a, b), c), a.max(b).max(c)]
}

#[inline(always)]
fn fit_kernel<L: Wide>(
    triangles: &[[u32; 3]],
    [from, to]: [&Field; 2],
    shift: [f64; 3],
    reach: f64,
    boxes: &mut [Ends; 3],
) {
    let moving = !core::ptr::eq(from, to);
    let from: [&[f64]; 3] = [&from.x, &from.y, &from.z];
    let to: [&[f64]; 3] = [&to.x, &to.y, &to.z];
    let shift = Vectors { x: L::splat(shift[0]), y: L::splat(shift[1]), z: L::splat(shift[2]) };
    let reach = L::splat(reach);
    let mut start = 0;
    while start < triangles.len() {
        let (nodes, count) = nodes_of(triangles, start);
        let a = vectors_at::<L>(from, &nodes[0]);
        let b = vectors_at::<L>(from, &nodes[1]);
        let c = vectors_at::<L>(from, &nodes[2]);
        let mut ends = [ends_of(a.x, b.x, c.x), ends_of(a.y, b.y, c.y), ends_of(a.z, b.z, c.z)];
        if moving {
            let a = vectors_at::<L>(to, &nodes[0]) - shift;
            let b = vectors_at::<L>(to, &nodes[1]) - shift;
            let c = vectors_at::<L>(to, &nodes[2]) - shift;
            let last = [ends_of(a.x, b.x, c.x), ends_of(a.y, b.y, c.y), ends_of(a.z, b.z, c.z)];
            for axis in 0..3 {
                ends[axis] = [min(ends[axis][0], last[axis][0]), ends[axis][1].max(last[axis][1])];
            }
        }
        for axis in 0..3 {
            let (lower, upper) = ((ends[axis][0] - reach).lanes(), (ends[axis][1] + reach).lanes());
            for lane in 0..count {
                boxes[axis][0][start + lane] = to_f32(lower.0[lane]);
                boxes[axis][1][start + lane] = to_f32(upper.0[lane]);
            }
        }
        start += WIDTH;
    }
}

dispatch_wide! {
    /// Fits boxes to the elements at two frames, or at one that is given twice. `shift` (m) is taken off the second.
    pub(super) fn fit_boxes / fit_kernel(
        triangles: &[[u32; 3]],
        frames: [&Field; 2],
        shift: [f64; 3],
        reach: f64,
        boxes: &mut [Ends; 3],
    )
}

/// The nearest `f32`, infinite beyond its range.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "rounding is intended")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

#[inline(always)]
fn range_kernel(lower: &[f32], upper: &[f32]) -> Range {
    let (mut lowest, mut highest) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
    let mut widths = [0.0_f64; LANES];
    for index in 0..lower.len() {
        let lane = index % LANES;
        let (low, high) = (lower[index], upper[index]);
        // NaN is left out.
        lowest[lane] = if low < lowest[lane] { low } else { lowest[lane] };
        highest[lane] = if high > highest[lane] { high } else { highest[lane] };
        widths[lane] += f64::from(high) - f64::from(low);
    }
    Range {
        ends: [
            lowest.into_iter().fold(f32::INFINITY, f32::min),
            highest.into_iter().fold(f32::NEG_INFINITY, f32::max),
        ],
        widths: widths.into_iter().sum(),
    }
}

dispatch! {
    pub(super) fn range_of / range_kernel(lower: &[f32], upper: &[f32]) -> Range
}
