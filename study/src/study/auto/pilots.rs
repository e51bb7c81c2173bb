//! The choice of the pilots: points far from each other.
//!
//! ```text
//! d² = Σ over the varied keys of ((x − x')/(x_max − x_min))²      0 or 1 for words; keys of replicates do not count
//! first pilot: nearest to the mean;  next: the point with the largest distance from all pilots that can be paid
//! ```

use super::{COARSER, LADDER, MAX_PILOTS, PILOT_SHARE};
use crate::input::value::Value;
use crate::job::JobId;
use crate::study::point::StudyPoint;
use std::collections::BTreeSet;

/// Estimated cost of a point on the reference mesh, up to a factor that all points share.
pub(crate) fn cost(point: &StudyPoint) -> f64 {
    let scene = &point.scene;
    f64::from(scene.design.panels) * f64::from(scene.design.storeys) * scene.solver.end_time
}

/// Cost of a mesh over that of the reference mesh.
pub(super) fn relative_cost(subdivisions: u32, reference: u32) -> f64 {
    let ratio = f64::from(subdivisions) / f64::from(reference);
    ratio * ratio * ratio
}

/// The meshes that may replace the reference mesh.
pub(super) fn rungs(reference: u32) -> Vec<u32> {
    LADDER.iter().copied().filter(|n| n * COARSER <= reference).collect()
}

/// Positions of the pilots. `repeats` are the names of the keys that repeat a point.
pub(super) fn choose(
    points: &[StudyPoint],
    rungs: &[u32],
    reference: u32,
    repeats: &[String],
) -> Vec<usize> {
    let mut seen = BTreeSet::new();
    let is_new = |index: &usize| {
        let point = &points[*index];
        point.infeasible.is_none() && seen.insert(JobId::of(&point.scene))
    };
    let candidates: Vec<usize> = (0..points.len()).filter(is_new).collect();
    let all: f64 = candidates.iter().map(|index| cost(&points[*index])).sum();
    let on_rungs: f64 = rungs.iter().map(|n| relative_cost(*n, reference)).sum();
    let mut budget = PILOT_SHARE * all / (1.0 + on_rungs);
    let places = Places::of(points, &candidates, repeats);
    let mut pilots: Vec<usize> = Vec::new();
    // Distance of each candidate from the nearest pilot; at first how near it is to the mean.
    let mut far: Vec<f64> =
        places.rows.iter().map(|place| -places.distance_from_mean(place)).collect();
    while pilots.len() < MAX_PILOTS {
        let free = |index: &usize| {
            !pilots.contains(&candidates[*index]) && cost(&points[candidates[*index]]) <= budget
        };
        // Of equally far points the first one.
        let farthest =
            (0..candidates.len()).rev().filter(free).max_by(|a, b| far[*a].total_cmp(&far[*b]));
        let Some(next) = farthest else { break };
        for (index, distance) in far.iter_mut().enumerate() {
            let to_next = places.distance(index, next);
            *distance = if pilots.is_empty() { to_next } else { distance.min(to_next) };
        }
        budget -= cost(&points[candidates[next]]);
        pilots.push(candidates[next]);
    }
    pilots.sort_unstable();
    pilots
}

/// The varied keys of each point, scaled to 0 to 1.
struct Places {
    rows: Vec<Vec<f64>>,
    /// Whether a column holds words, of which each has a number.
    words: Vec<bool>,
}

impl Places {
    fn of(points: &[StudyPoint], candidates: &[usize], repeats: &[String]) -> Self {
        let mut places = Self { rows: vec![Vec::new(); candidates.len()], words: Vec::new() };
        let columns = points.first().map_or(0, |point| point.parameters.len());
        for column in 0..columns {
            if repeats.contains(&points[0].parameters[column].0) {
                continue;
            }
            let mut known: Vec<&Value> = Vec::new();
            let mut is_word = false;
            let mut values: Vec<f64> = Vec::with_capacity(candidates.len());
            for index in candidates {
                values.push(match &points[*index].parameters[column].1 {
                    Value::Number(number) => *number,
                    Value::Integer(number) => *number as f64,
                    word => {
                        is_word = true;
                        let position = known.iter().position(|other| *other == word);
                        let position = position.unwrap_or(known.len());
                        if position == known.len() {
                            known.push(word);
                        }
                        position as f64
                    }
                });
            }
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let width = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least;
            for (row, value) in places.rows.iter_mut().zip(values) {
                let scaled = if width > 0.0 { (value - least) / width } else { 0.0 };
                row.push(scaled);
            }
            places.words.push(is_word);
        }
        places
    }

    fn distance(&self, a: usize, b: usize) -> f64 {
        let pairs = self.rows[a].iter().zip(&self.rows[b]).zip(&self.words);
        pairs
            .map(|((a, b), word)| match word {
                true => f64::from(u8::from(a.total_cmp(b).is_ne())),
                false => (a - b) * (a - b),
            })
            .sum()
    }

    /// Squared distance from the mean; words do not count.
    fn distance_from_mean(&self, place: &[f64]) -> f64 {
        let count = self.rows.len() as f64;
        let columns = self.words.iter().enumerate().filter(|(_, word)| !**word);
        columns
            .map(|(column, _)| {
                let mean = self.rows.iter().map(|row| row[column]).sum::<f64>() / count;
                (place[column] - mean) * (place[column] - mean)
            })
            .sum()
    }
}
