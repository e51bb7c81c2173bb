//! The answer of `billow fold`, as JSON and as rows.

use billow_solver::geometry::fold::{FoldDesign, FoldPattern, Nearest};
use serde_json::{Value as Json, json};

use crate::input::value::Value;

/// A pattern as JSON: SI units, angles in rad, keys as in the glossary.
pub(super) fn feasible_json(pattern: &FoldPattern) -> Json {
    let angles = &pattern.angles;
    let lengths = |storey| {
        let l = pattern.lengths(storey);
        json!({ "AB": l.ab, "DE": l.de, "AD": l.ad, "AE": l.ae })
    };
    let design = &pattern.design;
    json!({
        "feasible": true,
        "reason": null,
        "nearest": null,
        "fit": design.fit,
        "N": design.panels,
        "M": design.storeys,
        "chirality": design.chirality,
        "caps": design.caps,
        "alpha1_over_phi": angles.alpha1 / angles.phi,
        "phi": angles.phi,
        "alpha1": angles.alpha1,
        "alpha2": angles.alpha2,
        "beta1": angles.beta1,
        "beta2": angles.beta2,
        "gamma1": angles.gamma1,
        "gamma2": angles.gamma2,
        "theta1": angles.theta1,
        "theta2": angles.theta2,
        "ring_ratio": angles.ring_ratio,
        "half_angle": pattern.half_angle,
        "bottom_radius": pattern.bottom_radius,
        "top_radius": pattern.top_radius,
        "height": pattern.height,
        "closure_defect": pattern.closure_defect(),
        "lengths": lengths(0),
        "storeys": (0..design.storeys).map(|storey| json!({
            "bottom_radius": pattern.ring_radius(storey),
            "polygon_radius": pattern.polygon_radius(storey),
            "opening_radius": pattern.opening_radius(storey),
            "lengths": lengths(storey),
        })).collect::<Vec<_>>(),
        "flat_twist": pattern.flat_twist(),
        "erected_twist": pattern.erected_twist(),
        "stowed_height": design.stowed_height,
        "stowed_volume": pattern.stowed_volume(design.stowed_height),
        "stowed_strain": pattern.stowed_strain(design.stowed_height),
        "erected_volume": pattern.erected_volume(),
        "film_area": pattern.film_area(),
    })
}

/// The same keys for an infeasible design: the given values, and null for everything that needs a pattern.
pub(super) fn infeasible_json(design: &FoldDesign, reason: &str, nearest: &[Nearest]) -> Json {
    let mut answer = json!({
        "feasible": false,
        "reason": reason,
        "nearest": nearest
            .iter()
            .map(|near| (near.key.to_owned(), whole(near.value)))
            .collect::<serde_json::Map<_, _>>(),
        "fit": design.fit,
        "N": design.panels,
        "M": design.storeys,
        "chirality": design.chirality,
        "caps": design.caps,
        "bottom_radius": design.bottom_radius,
        "top_radius": design.top_radius,
        "height": design.height,
        "half_angle": design.half_angle,
        "alpha1_over_phi": design.alpha1_over_phi,
        "stowed_height": design.stowed_height,
    });
    // These need a pattern.
    for key in [
        "phi",
        "alpha1",
        "alpha2",
        "beta1",
        "beta2",
        "gamma1",
        "gamma2",
        "theta1",
        "theta2",
        "ring_ratio",
        "closure_defect",
        "lengths",
        "storeys",
        "flat_twist",
        "erected_twist",
        "stowed_volume",
        "stowed_strain",
        "erected_volume",
        "film_area",
    ] {
        answer[key] = Json::Null;
    }
    answer
}

/// A whole number without its ".0".
fn whole(value: f64) -> Json {
    #[expect(clippy::cast_possible_truncation, reason = "whole and small, as checked")]
    if value.fract().abs() > 0.0 || value.abs() >= 1e9 { json!(value) } else { json!(value as i64) }
}

/// A pattern as rows of a table: angles in degrees.
pub(super) fn rows(pattern: &FoldPattern) -> Vec<Vec<Value>> {
    let row = |name: &str, value: f64, unit: &str| {
        vec![Value::Text(name.into()), Value::Number(value), Value::Text(unit.into())]
    };
    let angles = &pattern.angles;
    let lengths = pattern.lengths(0);
    let mut rows = vec![vec![Value::Text("feasible".into()), Value::Bool(true), Value::Null]];
    for (name, angle) in [
        ("phi", angles.phi),
        ("alpha1", angles.alpha1),
        ("alpha2", angles.alpha2),
        ("beta1", angles.beta1),
        ("beta2", angles.beta2),
        ("gamma1", angles.gamma1),
        ("gamma2", angles.gamma2),
        ("theta1", angles.theta1),
        ("theta2", angles.theta2),
        ("half_angle", pattern.half_angle),
        ("flat_twist", pattern.flat_twist()),
        ("erected_twist", pattern.erected_twist()),
    ] {
        rows.push(row(name, angle.to_degrees(), "deg"));
    }
    let stowed = pattern.design.stowed_height;
    rows.extend([
        row("alpha1_over_phi", angles.alpha1 / angles.phi, "1"),
        row("ring_ratio", angles.ring_ratio, "1"),
        row("closure_defect", pattern.closure_defect(), "1"),
        row("bottom_radius", pattern.bottom_radius, "m"),
        row("top_radius", pattern.top_radius, "m"),
        row("height", pattern.height, "m"),
        row("AB", lengths.ab, "m"),
        row("DE", lengths.de, "m"),
        row("AD", lengths.ad, "m"),
        row("AE", lengths.ae, "m"),
        row("opening_radius", pattern.opening_radius(pattern.design.storeys - 1), "m"),
        row("stowed_height", stowed, "m"),
        row("stowed_volume", pattern.stowed_volume(stowed), "m3"),
        row("stowed_strain", pattern.stowed_strain(stowed), "1"),
        row("erected_volume", pattern.erected_volume(), "m3"),
        row("film_area", pattern.film_area(), "m2"),
    ]);
    rows
}

/// The reason of an infeasible design, and the nearest feasible values.
pub(super) fn infeasible_rows(reason: &str, nearest: &[Nearest]) -> Vec<Vec<Value>> {
    let mut rows = vec![
        vec![Value::Text("feasible".into()), Value::Bool(false), Value::Null],
        vec![Value::Text("reason".into()), Value::Text(reason.into()), Value::Null],
    ];
    for near in nearest {
        rows.push(vec![
            Value::Text(format!("nearest {}", near.key)),
            Value::Number(near.value),
            Value::Text(
                if near.key.ends_with("radius") || near.key == "height" { "m" } else { "1" }.into(),
            ),
        ]);
    }
    rows
}
