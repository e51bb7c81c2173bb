//! The answer of `billow fold`: one list of quantities, as JSON and as rows.

use billow_solver::geometry::fold::{FoldDesign, FoldPattern, Nearest};
use serde_json::{Map, Value as Json, json};

use crate::input::value::Value;

/// A quantity of a pattern: name, SI unit, value. Lengths of edges are those of the lowest storey.
type Quantity = (&'static str, &'static str, fn(&FoldPattern) -> f64);

const QUANTITIES: [Quantity; 28] = [
    ("phi", "rad", |pattern| pattern.angles.phi),
    ("alpha1", "rad", |pattern| pattern.angles.alpha1),
    ("alpha2", "rad", |pattern| pattern.angles.alpha2),
    ("beta1", "rad", |pattern| pattern.angles.beta1),
    ("beta2", "rad", |pattern| pattern.angles.beta2),
    ("gamma1", "rad", |pattern| pattern.angles.gamma1),
    ("gamma2", "rad", |pattern| pattern.angles.gamma2),
    ("theta1", "rad", |pattern| pattern.angles.theta1),
    ("theta2", "rad", |pattern| pattern.angles.theta2),
    ("half_angle", "rad", |pattern| pattern.half_angle),
    ("flat_twist", "rad", FoldPattern::flat_twist),
    ("erected_twist", "rad", FoldPattern::erected_twist),
    ("alpha1_over_phi", "1", |pattern| pattern.angles.alpha1 / pattern.angles.phi),
    ("ring_ratio", "1", |pattern| pattern.angles.ring_ratio),
    ("closure_defect", "1", FoldPattern::closure_defect),
    ("bottom_radius", "m", |pattern| pattern.bottom_radius),
    ("top_radius", "m", |pattern| pattern.top_radius),
    ("height", "m", |pattern| pattern.height),
    ("AB", "m", |pattern| pattern.lengths(0).ab),
    ("DE", "m", |pattern| pattern.lengths(0).de),
    ("AD", "m", |pattern| pattern.lengths(0).ad),
    ("AE", "m", |pattern| pattern.lengths(0).ae),
    ("opening_radius", "m", |pattern| pattern.opening_radius(pattern.design.storeys - 1)),
    ("stowed_height", "m", |pattern| pattern.design.stowed_height),
    ("stowed_volume", "m3", |pattern| pattern.stowed_volume(pattern.design.stowed_height)),
    ("stowed_strain", "1", |pattern| pattern.stowed_strain(pattern.design.stowed_height)),
    ("erected_volume", "m3", FoldPattern::erected_volume),
    ("film_area", "m2", FoldPattern::film_area),
];

/// A pattern, or why there is none and the nearest feasible values.
pub(super) type Answer = std::result::Result<FoldPattern, (String, Vec<Nearest>)>;

/// One JSON object in SI, with the same keys for every design: an infeasible one has its given values, and null for
/// what needs a pattern.
pub(super) fn json(design: &FoldDesign, answer: &Answer) -> Json {
    let mut json = json!({
        "feasible": answer.is_ok(),
        "reason": null,
        "nearest": null,
        "fit": design.fit,
        "N": design.panels,
        "M": design.storeys,
        "chirality": design.chirality,
        "caps": design.caps,
        "storeys": null,
    });
    for (name, _, value) in QUANTITIES {
        json[name] = answer.as_ref().ok().map(value).into();
    }
    match answer {
        Ok(pattern) => {
            json["storeys"] = (0..design.storeys).map(|at| storey(pattern, at)).collect();
        }
        Err((reason, nearest)) => {
            json["reason"] = reason.as_str().into();
            let nearest = nearest.iter().map(|near| (near.key.to_owned(), whole(near.value)));
            json["nearest"] = Json::Object(nearest.collect::<Map<_, _>>());
            json["bottom_radius"] = design.bottom_radius.into();
            json["top_radius"] = design.top_radius.into();
            json["height"] = design.height.into();
            json["half_angle"] = design.half_angle.into();
            json["alpha1_over_phi"] = design.alpha1_over_phi.into();
            json["stowed_height"] = design.stowed_height.into();
        }
    }
    json
}

fn storey(pattern: &FoldPattern, storey: u32) -> Json {
    let lengths = pattern.lengths(storey);
    json!({
        "bottom_radius": pattern.ring_radius(storey),
        "polygon_radius": pattern.polygon_radius(storey),
        "opening_radius": pattern.opening_radius(storey),
        "lengths": { "AB": lengths.ab, "DE": lengths.de, "AD": lengths.ad, "AE": lengths.ae },
    })
}

/// A whole number without its ".0".
fn whole(value: f64) -> Json {
    #[expect(clippy::cast_possible_truncation, reason = "whole and small, as checked")]
    if value.fract().abs() > 0.0 || value.abs() >= 1e9 { json!(value) } else { json!(value as i64) }
}

/// Rows of quantity, value and unit: angles in degrees.
pub(super) fn rows(answer: &Answer) -> Vec<Vec<Value>> {
    let text = |text: &str| Value::Text(text.to_owned());
    let mut rows = vec![vec![text("feasible"), Value::Bool(answer.is_ok()), Value::Null]];
    match answer {
        Ok(pattern) => rows.extend(QUANTITIES.map(|(name, unit, value)| match unit {
            "rad" => vec![text(name), Value::Number(value(pattern).to_degrees()), text("deg")],
            _ => vec![text(name), Value::Number(value(pattern)), text(unit)],
        })),
        Err((reason, nearest)) => {
            rows.push(vec![text("reason"), text(reason), Value::Null]);
            rows.extend(nearest.iter().map(|near| {
                let is_length = near.key.ends_with("radius") || near.key.ends_with("height");
                let unit = if is_length { "m" } else { "1" };
                vec![text(&format!("nearest {}", near.key)), Value::Number(near.value), text(unit)]
            }));
        }
    }
    rows
}
