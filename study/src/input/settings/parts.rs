//! What studies and scenes have in common: design, film, the laws of the gas.

use billow_solver::geometry::fold::{Caps, Chirality, Fit, FoldDesign};
use billow_solver::scene::{Film, GasSupply, HeatTransfer, Species};

use super::Settings;
use crate::input::source::{Source, shown};
use crate::input::value::Value;
use crate::platform::error::InputError;

/// The error of a key that is not given.
pub(crate) fn missing(settings: &Settings, path: &str, source: &Source) -> InputError {
    let table = settings.table();
    let key = table.index(path).map(|at| table.keys[at]);
    let leaf = key.map_or(path, |key| key.leaf());
    let allowed = key.map_or_else(String::new, crate::input::keys::Key::allowed);
    let mut error = source.error(path, "", "missing", allowed);
    if table.structured.contains(&"grid") {
        error.hint = format!("give it here, or vary {leaf} under grid");
    } else if let Some(key) = key {
        error.hint = format!("give it, as in {}", key.sample());
    }
    error
}

/// A number that must be there.
pub(crate) fn number(settings: &Settings, path: &str, source: &Source) -> Result<f64, InputError> {
    settings.number(path).ok_or_else(|| missing(settings, path, source))
}

/// A whole number of 32 bits that must be there.
pub(crate) fn whole(settings: &Settings, path: &str, source: &Source) -> Result<u32, InputError> {
    let number = settings.integer(path).and_then(|number| u32::try_from(number).ok());
    number.ok_or_else(|| missing(settings, path, source))
}

/// A whole number that must be there.
pub(crate) fn unsigned(
    settings: &Settings,
    path: &str,
    source: &Source,
) -> Result<u64, InputError> {
    let number = settings.integer(path).and_then(|number| u64::try_from(number).ok());
    number.ok_or_else(|| missing(settings, path, source))
}

/// The fold design.
pub(crate) fn design(settings: &Settings, source: &Source) -> Result<FoldDesign, InputError> {
    Ok(FoldDesign {
        fit: match settings.text("design.fit") {
            "angles" => Fit::Angles,
            "height" => Fit::Height,
            _ => Fit::Cone,
        },
        panels: whole(settings, "design.N", source)?,
        storeys: whole(settings, "design.M", source)?,
        bottom_radius: number(settings, "design.bottom_radius", source)?,
        top_radius: settings.number("design.top_radius"),
        height: settings.number("design.height"),
        half_angle: settings.number("design.half_angle"),
        alpha1_over_phi: settings.number("design.alpha1_over_phi"),
        chirality: match settings.text("design.chirality") {
            "alternate" => Chirality::Alternate,
            _ => Chirality::Same,
        },
        stowed_height: number(settings, "design.stowed_height", source)?,
        subdivisions: whole(settings, "design.subdivisions", source)?,
        caps: match settings.text("design.caps") {
            "circular" => Caps::Circular,
            _ => Caps::Polygon,
        },
    })
}

/// The film.
pub(crate) fn film(settings: &Settings, source: &Source) -> Result<Film, InputError> {
    let get = |path: &str| number(settings, path, source);
    Ok(Film {
        youngs_modulus: get("film.youngs_modulus")?,
        poisson_ratio: get("film.poisson_ratio")?,
        density: get("film.density")?,
        thickness: get("film.thickness")?,
        compression: get("film.compression")?,
        viscosity: get("film.viscosity")?,
        temperature: get("film.temperature")?,
    })
}

/// The gas, without any inside and none let in.
pub(crate) fn gas_laws(settings: &Settings, source: &Source) -> Result<GasSupply, InputError> {
    let get = |path: &str| number(settings, path, source);
    Ok(GasSupply {
        species: species(settings, source)?,
        initial_mass: 0.0,
        windows: Vec::new(),
        ambient_pressure: get("gas.ambient_pressure")?,
        heat_transfer: match settings.get("gas.heat_transfer") {
            Value::Number(coefficient) => HeatTransfer::Coefficient(*coefficient),
            Value::Text(word) if word == "isothermal" => HeatTransfer::Isothermal,
            _ => HeatTransfer::Coefficient(0.0),
        },
        leak_area: get("gas.leak_area")?,
        discharge_coefficient: get("gas.discharge_coefficient")?,
    })
}

/// The named species: ideal gases, R = 8.314462618 J/(mol K) over the molar mass (CODATA 2018), cp
/// at 300 K and low pressure (NIST-JANAF; air: dry air). Nitrogen is that of the reference cases.
const SPECIES: [(&str, f64, f64); 6] = [
    ("nitrogen", 296.803_052, 1_038.810_68),
    ("air", 287.055, 1_005.0),
    ("helium", 2_077.264, 5_193.16),
    ("argon", 208.132, 520.33),
    ("carbon_dioxide", 188.924, 846.0),
    ("hydrogen", 4_124.48, 14_310.0),
];

/// The named species, or the gas of its own; a constant given beside a name takes its place.
fn species(settings: &Settings, source: &Source) -> Result<Species, InputError> {
    let name = settings.maybe_text("gas.species");
    let named = SPECIES.iter().find(|(known, ..)| name == Some(*known));
    let pick = |path: &str, named: Option<f64>| {
        settings.number(path).or(named).ok_or_else(|| missing(settings, path, source))
    };
    let gas_constant = pick("gas.species.gas_constant", named.map(|species| species.1))?;
    let cp = pick("gas.species.cp", named.map(|species| species.2))?;
    if cp <= gas_constant {
        return Err(source.error(
            "gas.species.cp",
            &shown(cp),
            "leaves no heat capacity at constant volume",
            format!("above the gas constant, {gas_constant} J/(kg K)"),
        ));
    }
    Ok(Species { gas_constant, cp })
}
