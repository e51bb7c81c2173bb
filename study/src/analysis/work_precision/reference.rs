//! What errors refer to: an exact value, or the finest trusted configuration with its uncertainty.

use std::sync::Arc;

use super::{Chain, Course, Member, Outcome, Quantity, Reference};
use crate::analysis::statistics::Spread;

/// Part of the difference from the next coarser mesh (or step) that counts as uncertainty. Chosen: it is the error of a method
/// for which r^p = 3 (meshes that halve: order 1.6; from n 16 to 24: 2.7); an order below has a larger one.
const MESH_PART: f64 = 0.5;

/// The reference of a quantity, and the value or course that results are compared with.
pub(super) fn of(
    quantity: &Quantity,
    outcomes: &[Vec<Outcome>],
    mesh_errors: &[Option<f64>],
    members: &[Member],
    chains: &[Chain],
) -> Option<(Reference, Outcome)> {
    if let Some(exact) = quantity.exact {
        let reference = Reference { value: Some(exact), member: None, uncertainty: Some(0.0) };
        return Some((reference, Outcome::Number(exact)));
    }
    let usable =
        |index: &usize| members[*index].ending.is_trusted() && !outcomes[*index].is_empty();
    let finest = (0..members.len()).filter(usable).max_by(|a, b| {
        let [a, b] = [a, b].map(|index| &members[*index]);
        a.elements.total_cmp(&b.elements).then(a.steps.total_cmp(&b.steps))
    })?;
    let target = centre(&outcomes[finest])?;
    let mesh = members[finest].elements;
    // The error of the mesh is then that of every run: it has no part in their differences.
    let one_mesh =
        mesh > 0.0 && members.iter().all(|member| member.elements.total_cmp(&mesh).is_eq());
    let estimated = uncertainty(finest, &target, outcomes, (members, chains), one_mesh);
    let uncertainty = of_parts(estimated, mesh_errors[finest].filter(|_| !one_mesh));
    let value = median(&outcomes[finest]);
    Some((Reference { value, member: Some(finest), uncertainty }, target))
}

/// The relative uncertainty from its parts: spread over the runs, and mesh, which is no less than the known mesh error;
/// `None` without any.
fn of_parts([spread, mesh]: [Option<f64>; 2], mesh_error: Option<f64>) -> Option<f64> {
    let mesh = mesh.into_iter().chain(mesh_error).reduce(f64::max);
    if spread.is_none() && mesh.is_none() {
        return None;
    }
    let (spread, mesh) = (spread.unwrap_or(0.0), mesh.unwrap_or(0.0));
    Some((spread * spread + mesh * mesh).sqrt())
}

/// The parts of the relative uncertainty of the reference that follow from the runs of the scene: spread, mesh. On one
/// mesh the step takes the place of the mesh.
fn uncertainty(
    finest: usize,
    target: &Outcome,
    outcomes: &[Vec<Outcome>],
    (members, chains): (&[Member], &[Chain]),
    one_mesh: bool,
) -> [Option<f64>; 2] {
    let refined = |chain: &&Chain| chain.of_meshes != one_mesh && chain.members.contains(&finest);
    // Coarse to fine, without the reference.
    let coarser: Vec<usize> = chains
        .iter()
        .find(refined)
        .into_iter()
        .flat_map(|chain| chain.members.iter().copied())
        .take_while(|index| *index != finest)
        .filter(|index| members[*index].ending.is_trusted() && !outcomes[*index].is_empty())
        .collect();
    let with_runs = |index: &&usize| outcomes[**index].len() > 1;
    let spread = std::iter::once(&finest).chain(coarser.iter().rev()).find(with_runs);
    let spread = spread.and_then(|index| half_range(&outcomes[*index], target));
    let mesh = coarser.last().and_then(|index| error(&centre(&outcomes[*index])?, target));
    [spread, mesh.map(|difference| MESH_PART * difference)]
}

/// Half the range over runs, over the reference. For courses: the largest distance of a run from their mean.
fn half_range(runs: &[Outcome], target: &Outcome) -> Option<f64> {
    match target {
        Outcome::Number(reference) => {
            let spread = Spread::of(numbers(runs))?;
            Some((0.5 * (spread.largest - spread.least) / reference).abs())
        }
        Outcome::Course(_) => {
            let mean = centre(runs)?;
            runs.iter().filter_map(|run| error(run, &mean)).reduce(f64::max)
        }
    }
}

/// Relative error of an outcome; `None` where the reference is zero or of another kind.
pub(super) fn error(outcome: &Outcome, target: &Outcome) -> Option<f64> {
    match (outcome, target) {
        (Outcome::Number(value), Outcome::Number(reference)) if *reference != 0.0 => {
            Some((value / reference - 1.0).abs())
        }
        (Outcome::Course(course), Outcome::Course(reference)) => course.distance(reference),
        _ => None,
    }
}

/// Median of the numbers of some runs; `None` for courses.
pub(super) fn median(runs: &[Outcome]) -> Option<f64> {
    Spread::of(numbers(runs)).map(|spread| spread.median)
}

fn numbers(runs: &[Outcome]) -> impl Iterator<Item = f64> {
    runs.iter().filter_map(|run| match run {
        Outcome::Number(number) => Some(*number),
        Outcome::Course(_) => None,
    })
}

/// Median of numbers, mean of courses.
fn centre(runs: &[Outcome]) -> Option<Outcome> {
    let courses: Vec<&Course> = runs
        .iter()
        .filter_map(|run| match run {
            Outcome::Course(course) => Some(course.as_ref()),
            Outcome::Number(_) => None,
        })
        .collect();
    match Course::mean(&courses) {
        Some(mean) => Some(Outcome::Course(Arc::new(mean))),
        None => median(runs).map(Outcome::Number),
    }
}
