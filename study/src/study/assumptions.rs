//! What decides the numbers of a study and is no result of it, from the values of its points.

use billow_solver::scene::{Design, HeatTransfer, Scene};

use super::ground::{pressure_at_release, stowed_volume};
use crate::accuracy::{AssumedRanges, assumed_value};
use crate::input::keys;
use crate::input::value::{brief_number, range_text, short_number};
use crate::job::point::Point;

/// Most designs whose stacks are measured. Chosen: milliseconds.
const MAX_DESIGNS: usize = 100;

/// The assumptions of these points, one short text each: a value, or its range over the points; of what is assumed with
/// the ranges over which results are judged.
pub fn assumptions(points: &[Point], ranges: &AssumedRanges) -> Vec<String> {
    let feasible = points.iter().filter(|point| point.infeasible.is_none());
    let scenes: Vec<&Scene> = feasible.map(|point| &*point.job.scene).collect();
    let range =
        |of: fn(&Scene) -> f64| range_text(scenes.iter().map(|scene| of(scene)), short_number);
    // Only a key that a model of these points reads.
    let used = |key: &str, text: String| {
        let reads = |scene: &&Scene| !keys::model(scene.solver.model).ignores.contains(&key);
        scenes.iter().any(reads).then_some(text)
    };
    let (Some(ambient), Some(gravity), Some(loss), Some(heat), Some(friction), Some(compression)) = (
        range(|scene| scene.gas.ambient_pressure),
        range(|scene| scene.gravity),
        range(|scene| scene.film.loss_factor),
        range(|scene| match scene.gas.heat_transfer {
            HeatTransfer::Coefficient(coefficient) => coefficient,
            HeatTransfer::Isothermal => f64::INFINITY,
        }),
        range(|scene| scene.contact.friction),
        range(|scene| scene.film.compression),
    ) else {
        return Vec::new();
    };
    let or = |range: &str, zero: &str, text: String| {
        if range == "0" { zero.to_owned() } else { text }
    };
    let mut texts = vec![
        or(&ambient, "vacuum", format!("ambient pressure {ambient} Pa")),
        or(&gravity, "no gravity", format!("gravity {gravity} m/s²")),
        "no floor".to_owned(),
    ];
    texts.extend(stacks(&scenes));
    let loss = format!("film loss {loss}{}", ranges_text(&loss, ranges, 0));
    texts.extend(used("film.loss_factor", loss));
    let heat = if heat.contains("inf") {
        "gas at film temperature".to_owned()
    } else {
        format!("heat transfer {heat} W/(m² K){}", ranges_text(&heat, ranges, 1))
    };
    texts.extend(used("gas.heat_transfer", heat));
    let friction = or(&friction, "no friction", format!("friction {friction}"));
    texts.extend(used("contact.friction", friction));
    texts.push("uniform gas pressure".to_owned());
    let carried = format!("compression fraction {compression}");
    let compression = or(&compression, "film bears no compression", carried);
    texts.extend(used("film.compression", compression));
    texts
}

/// The range of one of [`crate::accuracy::ASSUMED_KEYS`], where every scene has the value that is assumed.
fn ranges_text(value: &str, ranges: &AssumedRanges, index: usize) -> String {
    let [low, high] = ranges.0[index].map(short_number);
    let assumed = value == short_number(assumed_value(index));
    if assumed { format!(" (assumed: {low} to {high})") } else { String::new() }
}

/// Height and volume of the stowed stacks, and the pressure in them at the release where gas is inside before it.
fn stacks(scenes: &[&Scene]) -> Vec<String> {
    let folded = scenes.iter().filter_map(|scene| scene.design.folded().ok());
    let heights = folded.map(|design| 1e3 * design.stowed_height);
    let height = range_text(heights, short_number);
    let start = height.map_or("mesh".to_owned(), |height| format!("stack {height} mm high"));
    let mut volumes: Vec<(&Design, f64)> = Vec::new();
    let mut pressures = Vec::new();
    for scene in scenes {
        let known = volumes.iter().rev().find(|(design, _)| **design == scene.design);
        let volume = match known.map(|(_, volume)| *volume) {
            None if volumes.len() == MAX_DESIGNS => return vec![start],
            None => {
                let Some(volume) = stowed_volume(&scene.design) else { continue };
                volumes.push((&scene.design, volume));
                volume
            }
            Some(volume) => volume,
        };
        pressures.push(pressure_at_release(scene, volume));
    }
    let litres = volumes.iter().map(|(_, volume)| 1e3 * volume);
    let volume = range_text(litres, brief_number).map(|volume| format!(", {volume} litres"));
    let mut texts = vec![format!("{start}{}", volume.unwrap_or_default())];
    let pressure = range_text(pressures, brief_number).filter(|pressure| pressure != "0");
    texts.extend(pressure.map(|pressure| format!("{pressure} Pa in it before the release")));
    texts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{MAX_POINTS, Study};

    fn of(grid: &str) -> String {
        let text = format!(
            r#"{{
                "design": {{"N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1}},
                "gas": {{"mass_flow_rate": 0.005, "residual_gas": "stored"}},
                "strategies": {{"held": {{"release_time": "0.1 s", "inflow": [{{"from": 0}}]}}, "direct": {{}}}},
                "solver": {{"end_time": 0.5}}, "strategy": "direct", "grid": {grid}
            }}"#
        );
        let study = Study::from_text(&text, "test.json", "test", &[], MAX_POINTS).unwrap();
        assumptions(study.points(), study.assumed()).join("; ")
    }

    #[test]
    fn assumptions_are_the_values_of_the_points_or_their_range() {
        assert_eq!(
            of("{}"),
            "vacuum; no gravity; no floor; stack 40 mm high, 15.12 litres; film loss 0.015 (assumed: 0.003 to 0.03); \
             heat transfer 0.3 W/(m² K) (assumed: 0.1 to 1); no friction; uniform gas pressure; film bears \
             no compression"
        );
        // 0.1 g of nitrogen at 293 K, m R T/V; a capsule of 10 mm does not fold.
        assert_eq!(
            of(
                r#"{"film.loss_factor": [0.003, 0.02], "residual_gas_mass": [0, "0.1 g"], "gravity": [-1.62],
                "friction": [0.2], "compression": [0, 0.1], "height": [1, 0.01]}"#
            ),
            "vacuum; gravity -1.62 m/s²; no floor; stack 40 mm high, 15.12 litres; 0 to 575.3 Pa in it before the \
             release; film loss 0.003 to 0.02; heat transfer 0.3 W/(m² K) (assumed: 0.1 to 1); friction 0.2; uniform gas pressure; \
             compression fraction 0 to 0.1"
        );
        let piston =
            of(r#"{"model": ["piston"], "ambient_pressure": [10], "residual_gas": ["ambient"]}"#);
        assert!(piston.starts_with("ambient pressure 10 Pa; no gravity"), "{piston}");
        assert!(piston.contains("; 10 Pa in it") && !piston.contains("loss"), "{piston}");
        assert!(!piston.contains("compression"), "{piston}");
        assert_eq!(of(r#"{"height": [0.01]}"#), "");
        // 0.5 g before the release.
        let held = of(r#"{"strategy": ["held"]}"#);
        assert!(held.contains("; 2876 Pa in it before the release"), "{held}");
    }
}
