//! Chains: configurations that differ in one parameter, from coarse to fine, and their observed order.

use super::{Configuration, Member, Point};
use crate::analysis::values::canonical;
use crate::input::keys::default_integrator;
use crate::input::value::Value;

/// Least ratio of steps that counts as a refinement of the step. Chosen: numerical damping shortens the stable step
/// by a few percent and is none.
const MIN_STEP_RATIO: f64 = 1.25;
/// Least error that has a part in an order, in uncertainties of the reference: below it the order is that of the
/// reference.
const MIN_ERROR: f64 = 2.0;

/// Members that differ in one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// The parameter.
    pub parameter: String,
    /// Members, coarse to fine.
    pub members: Vec<usize>,
    /// Whether they differ in the mesh; otherwise they differ in the step.
    pub of_meshes: bool,
    /// Resolution of each member: √elements, or steps.
    resolution: Vec<f64>,
}

/// Every chain of two or more members: those of meshes first, then the longest.
pub(super) fn of(members: &[Member]) -> Vec<Chain> {
    let parameters = members.first().map_or(0, |member| member.configuration.len());
    let mut chains: Vec<Chain> = Vec::new();
    for parameter in 0..parameters {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (index, member) in members.iter().enumerate() {
            if member.configuration[parameter].1.any_number().is_none() {
                continue;
            }
            let equal = |group: &&mut Vec<usize>| {
                let known = &members[group[0]].configuration;
                differ_only_in(parameter, known, &member.configuration)
            };
            match groups.iter_mut().find(equal) {
                Some(group) => group.push(index),
                None => groups.push(vec![index]),
            }
        }
        chains.extend(groups.into_iter().filter_map(|group| chain(members, parameter, group)));
    }
    chains.sort_by_key(|chain| (!chain.of_meshes, std::cmp::Reverse(chain.members.len())));
    chains
}

/// Whether two configurations are equal in all parameters but one.
fn differ_only_in(parameter: usize, a: &Configuration, b: &Configuration) -> bool {
    let pairs = a.iter().zip(b).enumerate().filter(|(index, _)| *index != parameter);
    pairs.map(|(_, pair)| pair).all(|(a, b)| canonical(&a.1) == canonical(&b.1))
}

/// The chain of a group; `None` unless every step of it refines mesh or step.
fn chain(members: &[Member], parameter: usize, mut group: Vec<usize>) -> Option<Chain> {
    if group.len() < 2 {
        return None;
    }
    let first = members[group[0]].elements;
    let of_meshes = group.iter().any(|index| members[*index].elements.total_cmp(&first).is_ne());
    let resolution = |index: usize| {
        let member = &members[index];
        if of_meshes { member.elements.sqrt() } else { member.steps }
    };
    group.sort_by(|a, b| resolution(*a).total_cmp(&resolution(*b)));
    let resolution: Vec<f64> = group.iter().map(|index| resolution(*index)).collect();
    let least = if of_meshes { 1.0 } else { MIN_STEP_RATIO };
    let refines = resolution.windows(2).all(|pair| pair[0] > 0.0 && pair[1] / pair[0] > least);
    let parameter = members[group[0]].configuration[parameter].0.clone();
    refines.then_some(Chain { parameter, members: group, of_meshes, resolution })
}

/// Logarithms of resolution and error of the trusted members whose error the reference can resolve.
fn resolved(
    chain: &Chain,
    points: &[Option<Point>],
    members: &[Member],
    floor: f64,
) -> Vec<(usize, [f64; 2])> {
    let trusted = chain.members.iter().zip(&chain.resolution);
    trusted
        .filter(|(index, _)| members[**index].ending.is_trusted())
        .filter_map(|(index, resolution)| {
            let point = points[*index].as_ref()?;
            let error = point.error.median;
            (!point.is_reference && error > 0.0 && error > MIN_ERROR * floor)
                .then(|| (*index, [libm::log(*resolution), libm::log(error)]))
        })
        .collect()
}

/// The order of a chain: minus the slope of its errors, least squares of the logarithms.
pub(super) fn fitted(
    chain: &Chain,
    points: &[Option<Point>],
    members: &[Member],
    floor: f64,
) -> Option<f64> {
    let found = resolved(chain, points, members, floor);
    if found.len() < 2 {
        return None;
    }
    let count = found.len() as f64;
    let mean = |of: usize| found.iter().map(|(_, pair)| pair[of]).sum::<f64>() / count;
    let [x, y] = [mean(0), mean(1)];
    let products = found.iter().map(|(_, pair)| (pair[0] - x) * (pair[1] - y)).sum::<f64>();
    let squares = found.iter().map(|(_, pair)| (pair[0] - x) * (pair[0] - x)).sum::<f64>();
    Some(-products / squares)
}

/// The order between neighbours of a chain, by the finer of them.
pub(super) fn between(
    chain: &Chain,
    points: &[Option<Point>],
    members: &[Member],
    floor: f64,
) -> Vec<(usize, f64)> {
    let found = resolved(chain, points, members, floor);
    let order = |pair: &[(usize, [f64; 2])]| {
        let [(_, coarse), (index, fine)] = pair else { return None };
        Some((*index, -(fine[1] - coarse[1]) / (fine[0] - coarse[0])))
    };
    found.windows(2).filter_map(order).collect()
}

/// Name of a parameter in a label, in words: its path without its section, as in "stepping adaptive".
pub fn words(name: &str) -> String {
    name.split_once('.').map_or(name, |(_, rest)| rest).replace(['_', '.'], " ")
}

/// The text of a configuration: "film, subdivisions 8". Parameters with these values are left out, as are ignored
/// ones.
pub fn label(configuration: &Configuration, without: &[(String, Value)]) -> String {
    let shown = configuration
        .iter()
        .filter(|pair| pair.1 != Value::Null && !without.iter().any(|known| known == *pair));
    let texts: Vec<String> = shown
        .map(|(name, value)| match value {
            Value::Text(text) => text.clone(),
            value => format!("{} {}", words(name), value.short()),
        })
        .collect();
    texts.join(", ")
}

impl super::Diagram {
    /// The value of each parameter that most configurations have, where most have one. Models and meshes are always
    /// named; an integrator is where it is not the one of a study that names none.
    pub fn usual(&self) -> Configuration {
        let Some(first) = self.members.first() else { return Vec::new() };
        let is_mesh =
            |name: &str| self.chains.iter().any(|chain| chain.of_meshes && chain.parameter == name);
        let usual = |index: usize| {
            if is_mesh(&first.configuration[index].0) {
                return None;
            }
            let values: Vec<&(String, Value)> =
                self.members.iter().map(|member| &member.configuration[index]).collect();
            let set: Vec<_> = values.iter().filter(|pair| pair.1 != Value::Null).collect();
            let count =
                |pair: &(String, Value)| set.iter().filter(|known| ***known == pair).count();
            let most = set.iter().rev().max_by_key(|pair| count(pair))?;
            let named = match &most.1 {
                Value::Text(text) => text.as_str() != default_integrator(),
                _ => false,
            };
            (!named && 2 * count(most) > set.len()).then(|| (**most).clone())
        };
        (0..first.configuration.len()).filter_map(usual).collect()
    }

    /// Every member once, in lists to join by lines: the members of a chain that no earlier chain has, then the
    /// others one by one. Each with the index of its chain.
    pub fn lines(&self) -> Vec<(Option<usize>, Vec<usize>)> {
        let mut known = vec![false; self.members.len()];
        let mut lines = Vec::new();
        for (number, chain) in self.chains.iter().enumerate() {
            let new: Vec<usize> =
                chain.members.iter().copied().filter(|index| !known[*index]).collect();
            for index in &new {
                known[*index] = true;
            }
            if !new.is_empty() {
                lines.push((Some(number), new));
            }
        }
        let alone = (0..known.len()).filter(|index| !known[*index]);
        lines.extend(alone.map(|index| (None, vec![index])));
        lines
    }
}
