//! Flow rates as volumes of gas at a standard state (SLPM, sccm) become mass flow rates.
//!
//! ```text
//! ṁ = p₀ Q/(R T₀)      p₀ = 101325 Pa, T₀ = 273.15 K (0 °C);  R specific gas constant of the gas of the file
//! ```

use crate::input::json::Json;
use crate::input::keys::{FORMULAS, Named, SPECIES};
use crate::input::source::Source;
use crate::input::units::{STANDARD_FLOWS, number_length};
use crate::input::value::brief_number;
use crate::platform::error::InputError;

/// p₀/T₀, Pa/K.
const STANDARD_STATE: f64 = 101_325.0 / 273.15;

/// Replaces every flow rate in such a unit, as "5 SLPM", in a study or a scene. Returns what a reader must know.
///
/// # Errors
/// Such a flow rate where the file has no gas that is known before its grid.
pub(crate) fn convert(tree: &mut Json, source: &Source) -> Result<Option<String>, InputError> {
    let Some((key, text)) = first(tree, "") else { return Ok(None) };
    let gas = tree.get("gas").and_then(|gas| gas.get("species"));
    let varies = matches!(tree.get("grid"), Some(grid) if names_species(grid));
    let known = gas_constant(gas).filter(|_| !varies);
    let Some((name, gas_constant)) = known else {
        let problem = "is a volume at a standard state, and the gas of the file is not one gas";
        let allowed = "a mass flow rate, as in \"5 g/s\"; or one gas.species";
        return Err(source.error(&key, format!("{text:?}"), problem, allowed));
    };
    replace(tree, STANDARD_STATE / gas_constant);
    let grams = 1e3 * STANDARD_STATE / gas_constant * 1e-3 / 60.0;
    Ok(Some(format!(
        "1 SLPM (1000 sccm) of {name} is {} g/s: a litre a minute at 0 °C and 101325 Pa",
        brief_number(grams)
    )))
}

/// The number and the unit of a flow rate at the standard state, m³/s.
fn volume_flow(text: &str) -> Option<f64> {
    let (number, unit) = text.trim().split_at(number_length(text.trim())?);
    let cubic_metres = match unit.trim() {
        unit if !STANDARD_FLOWS.contains(&unit) => return None,
        unit if unit.eq_ignore_ascii_case("sccm") => 1e-6,
        _ => 1e-3,
    };
    Some(number.trim().parse::<f64>().ok()? * cubic_metres / 60.0)
}

/// The first text that is such a flow rate, with its key.
fn first(json: &Json, key: &str) -> Option<(String, String)> {
    match json {
        Json::Text(text) => volume_flow(text).map(|_| (key.to_owned(), text.clone())),
        Json::List(items) => items
            .iter()
            .enumerate()
            .find_map(|(index, item)| first(item, &format!("{key}[{index}]"))),
        Json::Object(members) => members.iter().find_map(|(name, value)| {
            let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            first(value, &key)
        }),
        _ => None,
    }
}

/// Replaces every such text by a mass flow rate, with this density of the gas at the standard state, kg/m³.
fn replace(json: &mut Json, density: f64) {
    match json {
        Json::Text(text) => {
            if let Some(flow) = volume_flow(text) {
                *text = format!("{} g/s", 1e3 * flow * density);
            }
        }
        Json::List(items) => {
            for item in items {
                replace(item, density);
            }
        }
        Json::Object(members) => {
            for (_, value) in members {
                replace(value, density);
            }
        }
        _ => {}
    }
}

/// Whether a grid varies the gas.
fn names_species(grid: &Json) -> bool {
    match grid {
        Json::List(items) => items.iter().any(names_species),
        Json::Object(members) => members.iter().any(|(name, value)| {
            name.split('.').any(|part| part == "species") || names_species(value)
        }),
        _ => false,
    }
}

/// Name and specific gas constant (J/(kg K)) of a gas as a file gives it; nitrogen where it gives none.
fn gas_constant(gas: Option<&Json>) -> Option<(String, f64)> {
    let named = |name: &str| {
        let name =
            FORMULAS.iter().find(|(formula, _)| *formula == name).map_or(name, |(_, gas)| gas);
        let found = SPECIES.iter().find(|Named { name: known, .. }| *known == name)?;
        Some((name.to_owned(), found.value.gas_constant))
    };
    match gas {
        None => named("nitrogen"),
        Some(Json::Text(name)) => named(name),
        Some(object) => match object.get("gas_constant")? {
            Json::Number(number) => Some(("this gas".to_owned(), *number)),
            Json::Integer(number) => Some(("this gas".to_owned(), *number as f64)),
            _ => None,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::syntax::parse;

    #[test]
    fn a_volume_at_the_standard_state_is_a_mass_of_the_gas_of_the_file() {
        // Densities at 0 °C and 101325 Pa, kg/m³, from tables of gases.
        for (species, density) in [
            ("", 1.2498),
            (r#""species": "N2","#, 1.2498),
            (r#""species": "helium","#, 0.17857),
            (r#""species": "CO2","#, 1.9635),
            (r#""species": "air","#, 1.2922),
            (r#""species": {"gas_constant": 296.803, "cp": 1039},"#, 1.2498),
        ] {
            for (flow, litres) in
                [("60 SLPM", 1.0), ("60 slpm", 1.0), ("6e4 sccm", 1.0), ("30 slm", 0.5)]
            {
                let text = format!(
                    r#"{{"gas": {{{species} "mass_flow_rate": "{flow}"}}, "grid": {{"mass_flow_rate": ["1 g/s", "{flow}"]}}}}"#
                );
                let mut tree = parse(&text, "f").unwrap();
                let note = convert(&mut tree, &Source::new("f")).unwrap().unwrap();
                assert!(note.contains("0 °C and 101325 Pa"), "{note}");
                let Some(Json::List(values)) = tree.get("grid").unwrap().get("mass_flow_rate")
                else {
                    panic!("{tree:?}")
                };
                let Json::Text(converted) = &values[1] else { panic!("{values:?}") };
                let grams: f64 = converted.strip_suffix(" g/s").unwrap().parse().unwrap();
                assert!(
                    (grams / (litres * density) - 1.0).abs() < 3e-4,
                    "{species} {flow}: {grams}"
                );
                assert_eq!(values[0], Json::Text("1 g/s".to_owned()));
            }
        }
        let refused = |text: &str| {
            convert(&mut parse(text, "f").unwrap(), &Source::new("f")).unwrap_err().to_string()
        };
        let text =
            r#"{"gas": {"mass_flow_rate": "5 SLPM"}, "grid": {"species": ["helium", "air"]}}"#;
        assert!(refused(text).contains("gas.mass_flow_rate"));
        let text = r#"{"gas": {"species": "xenon", "windows": [{"mass_flow_rate": "5 sccm"}]}}"#;
        assert!(refused(text).contains("gas.windows[0].mass_flow_rate"));
        let mut plain = parse(r#"{"question": "How many SLPM?"}"#, "f").unwrap();
        assert_eq!(convert(&mut plain, &Source::new("f")), Ok(None));
    }
}
