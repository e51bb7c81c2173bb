//! `gas`: no pressure, a fixed overpressure, or gas in a closed volume.

use billow_solver::geometry::field::Field;
use billow_solver::mechanics::supports::Supports;
use billow_solver::scene::film_scene::Filling;
use billow_solver::scene::film_support::FilmSupport;
use billow_solver::scene::{GasSupply, HeatTransfer, InflowWindow};

use super::components::ZERO_VOLUME;
use super::shape::Shape;
use super::{components, is_static, seams};
use crate::input::json::Json;
use crate::input::keys::SCENE_WINDOW_KEYS;
use crate::input::object::Object;
use crate::input::object::list;
use crate::input::sections::check_window;
use crate::input::settings::Settings;
use crate::input::source::{Source, shown};
use crate::platform::error::InputError;

/// Reads `gas`. With gas, fans close an open film.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    shape: &mut Shape,
    supports: &[FilmSupport],
    notes: &mut Vec<String>,
    source: &Source,
) -> Result<Filling, InputError> {
    let gas = tree.get("gas");
    let Some(gas) = gas.filter(|gas| gas.get("pressure").is_none()) else {
        let pressure = settings.number("gas.pressure").unwrap_or(0.0);
        if let Some(Json::Object(members)) = gas
            && let Some((other, value)) = members.iter().find(|(name, _)| name != "pressure")
        {
            return Err(source.error(
                &format!("gas.{other}"),
                value,
                "is given beside a fixed pressure, which does not depend on the gas",
                "pressure alone, or a gas without it",
            ));
        }
        if pressure != 0.0 {
            seams::check(shape, source)?;
            components::check(shape, notes, source)?;
        }
        // Flat film encloses no volume, and a pressure may separate its layers.
        if shape.shell.is_closed() && !encloses_nothing(shape) {
            check_outward(shape, source)?;
        }
        return Ok(Filling::Pressure(pressure));
    };
    if is_static(settings) {
        return Err(source.error(
            "gas",
            gas,
            "is not a fixed pressure, which solver.static needs",
            "{\"pressure\": \"1 kPa\"}",
        ));
    }
    seams::check(shape, source)?;
    components::check(shape, notes, source)?;
    close(shape, supports, notes);
    let volume = check_outward(shape, source)?;
    let windows = windows(gas.get("windows"), settings, source)?;
    let mut supply = settings.gas(0.0, windows, source)?;
    let initial_temperature = initial_temperature(&supply, settings, source)?;
    supply.initial_mass = initial_mass(&supply, settings, volume, initial_temperature, source)?;
    notes.extend(below_ambient(&supply, volume, initial_temperature));
    Ok(Filling::Gas { supply, initial_temperature })
}

/// Temperature of the gas at the start, K.
fn initial_temperature(
    supply: &GasSupply,
    settings: &Settings,
    source: &Source,
) -> Result<f64, InputError> {
    let film_temperature = settings.needed("film.temperature", source)?;
    let initial_temperature =
        settings.number("gas.initial_temperature").unwrap_or(film_temperature);
    let isothermal = supply.heat_transfer == HeatTransfer::Isothermal;
    if isothermal && initial_temperature.to_bits() != film_temperature.to_bits() {
        return Err(source.error(
            "gas.initial_temperature",
            shown(initial_temperature),
            "is not the film temperature, which isothermal gas always has",
            format!("{} K, or another heat_transfer", shown(film_temperature)),
        ));
    }
    Ok(initial_temperature)
}

/// Gas inside at the start, kg: given, or m = p V/(R T) of the given pressure.
fn initial_mass(
    supply: &GasSupply,
    settings: &Settings,
    volume: f64,
    initial_temperature: f64,
    source: &Source,
) -> Result<f64, InputError> {
    match (settings.number("gas.initial_mass"), settings.number("gas.initial_pressure")) {
        (Some(_), Some(pressure)) => Err(source.error(
            "gas.initial_pressure",
            shown(pressure),
            "is given beside initial_mass",
            "one of initial_mass, initial_pressure",
        )),
        (Some(mass), None) => Ok(mass),
        (None, Some(pressure)) => {
            Ok(pressure * volume / (supply.species.gas_constant * initial_temperature))
        }
        (None, None) => Ok(0.0),
    }
}

/// Pressure of the gas at the start over the ambient pressure below which a note says so. Chosen as for a
/// study.
const MIN_PRESSURE_RATIO: f64 = 0.9;

/// A note on gas that has less than ambient pressure at the start.
fn below_ambient(supply: &GasSupply, volume: f64, temperature: f64) -> Option<String> {
    let pressure = supply.initial_mass * supply.species.gas_constant * temperature / volume;
    (pressure < MIN_PRESSURE_RATIO * supply.ambient_pressure).then(|| {
        format!(
            "the gas starts at {} Pa, below gas.ambient_pressure ({} Pa), which presses the film together; \
             gas.initial_pressure sets it",
            shown(pressure),
            shown(supply.ambient_pressure)
        )
    })
}

/// The inflow windows of the file.
fn windows(
    json: Option<&Json>,
    settings: &Settings,
    source: &Source,
) -> Result<Vec<InflowWindow>, InputError> {
    let Some(json) = json else { return Ok(Vec::new()) };
    let end_time = settings.needed("solver.end_time", source)?;
    let allowed = "a list of {\"from\": 0, \"to\": \"0.3 s\", \"mass_flow_rate\": \"5 g/s\"}";
    let mut windows = Vec::new();
    for (index, json) in list(json, "gas.windows", source, allowed)?.iter().enumerate() {
        let path = format!("gas.windows[{index}]");
        let window = Object::new(json, &path, "an inflow window", SCENE_WINDOW_KEYS, &[], source)?;
        let from = window.needed("from")?;
        let to = window.number("to")?;
        let to = to.unwrap_or(end_time.max(from));
        let end = window.given("to").map(|_| ("to", format!("{} s", shown(to))));
        check_window(&path, [from, to], end, end_time, source)?;
        let mass_flow_rate = window.needed("mass_flow_rate")?;
        let temperature = window.needed("temperature")?;
        windows.push(InflowWindow { from, to, mass_flow_rate, temperature });
    }
    Ok(windows)
}

/// Whether the film encloses no volume.
fn encloses_nothing(shape: &Shape) -> bool {
    let positions = &shape.shell.positions;
    let area = shape.shell.reference_area();
    shape.shell.volume(|node| positions[node as usize]).abs() <= ZERO_VOLUME * area * area.sqrt()
}

/// The enclosed volume, m³.
fn check_outward(shape: &Shape, source: &Source) -> Result<f64, InputError> {
    let positions = &shape.shell.positions;
    let volume = shape.shell.volume(|node| positions[node as usize]);
    if encloses_nothing(shape) {
        return Err(source
            .error(
                "mesh.positions",
                Json::Text(shape.file.clone()),
                "encloses no volume: its layers touch each other",
                "film that encloses a volume where there is gas",
            )
            .with_hint("separate the layers a little, or give gas.pressure"));
    }
    if volume > 0.0 {
        return Ok(volume);
    }
    Err(source
        .error(
            "mesh.positions",
            Json::Text(shape.file.clone()),
            format!("encloses {} m³: its faces are wound inward", shown(volume)),
            "faces counter-clockwise seen from outside",
        )
        .with_hint(
            "flip the normals of all faces (and of those of closure), or reverse every f line",
        ))
}

/// Closes an open film by fans.
fn close(shape: &mut Shape, supports: &[FilmSupport], notes: &mut Vec<String>) {
    let loops = shape.shell.boundary();
    if loops.is_empty() {
        return;
    }
    let edges: usize = loops.iter().map(Vec::len).sum();
    let supports = Supports::new(supports, &Field::of(&shape.shell.positions));
    let tips = shape.shell.close(|node| supports.projector(node as usize));
    let walls = shape.shell.walls.len();
    notes.push(format!(
        "the film is open: {} fan(s) over {edges} free edges close its volume",
        tips.len()
    ));
    if walls > 0 {
        notes.push(format!(
            "supports hold the edges of {walls} fan(s), which count as walls or symmetry planes: reactions \
             leave out the pressure on them"
        ));
    }
}
