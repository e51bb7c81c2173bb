//! `gas`: no pressure, a fixed overpressure, or gas in a closed volume.

use billow_solver::geometry::field::Field;
use billow_solver::mechanics::supports::Supports;
use billow_solver::scene::film_scene::Filling;
use billow_solver::scene::film_support::FilmSupport;
use billow_solver::scene::{GasSupply, HeatTransfer, InflowWindow};

use super::components::ZERO_VOLUME;
use super::reader::Reader;
use super::shape::Shape;
use super::{Checked, components, flow_table, is_static, seams, tank};
use crate::input::json::Json;
use crate::input::keys::SCENE_WINDOW_KEYS;
use crate::input::object::Object;
use crate::input::object::list;
use crate::input::sections::check_window;
use crate::input::settings::Settings;
use crate::input::source::{Source, shown};
use crate::input::value::brief_number;
use crate::job::surroundings::{Surroundings, of_sphere};
use crate::platform::error::Result;

/// Reads `gas`. With gas, fans close an open film.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    shape: &mut Shape,
    supports: &[FilmSupport],
    notes: &mut Vec<String>,
    reader: &mut Reader,
) -> Result<Filling> {
    let source = &reader.source.clone();
    let gas = tree.get("gas");
    let Some(gas) = gas.filter(|gas| gas.get("pressure").is_none()) else {
        let pressure = settings.number("gas.pressure").unwrap_or(0.0);
        if let Some(Json::Object(members)) = gas
            && let Some((other, value)) = members.iter().find(|(name, _)| name != "pressure")
        {
            return Err(source
                .error(
                    &format!("gas.{other}"),
                    value,
                    "is given beside a fixed pressure, which does not depend on the gas",
                    "pressure alone, or a gas without it",
                )
                .into());
        }
        if pressure != 0.0 && supports.is_empty() && !shape.shell.is_closed() {
            notes.push(
                "the film is open and nothing holds it: the pressure has a resultant, which accelerates it; supports \
                 hold it"
                    .to_owned(),
            );
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
        return Err(source
            .error(
                "gas",
                gas,
                "is not a fixed pressure, which solver.static needs",
                "{\"pressure\": \"1 kPa\"}",
            )
            .into());
    }
    let volume = closed(shape, supports, notes, source)?;
    let windows = windows(gas.get("windows"), settings, reader)?;
    let mut supply = settings.gas(0.0, windows, source)?;
    let initial_temperature = initial_temperature(&supply, settings, source)?;
    supply.initial_mass = initial_mass(&supply, settings, volume, initial_temperature, source)?;
    notes.extend(below_ambient(&supply, volume, initial_temperature));
    notes.extend(air_outside(tree, settings, shape, &supply, source)?);
    Ok(Filling::Gas { supply, initial_temperature })
}

/// Closes a film for its gas and returns its volume, m³; refuses film that leaks or is turned.
pub(super) fn closed(
    shape: &mut Shape,
    supports: &[FilmSupport],
    notes: &mut Vec<String>,
    source: &Source,
) -> Checked<f64> {
    seams::check(shape, source)?;
    components::check(shape, notes, source)?;
    close(shape, supports, notes);
    check_outward(shape, source)
}

/// Temperature of the gas at the start, K.
fn initial_temperature(supply: &GasSupply, settings: &Settings, source: &Source) -> Checked<f64> {
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
) -> Checked<f64> {
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

/// Notes on what the air around the film does that no model has, with the volume of a sphere of its area, which is the
/// largest; refuses what needs it.
fn air_outside(
    tree: &Json,
    settings: &Settings,
    shape: &Shape,
    supply: &GasSupply,
    source: &Source,
) -> Checked<Vec<String>> {
    let (area, volume) = of_sphere(shape.shell.reference_area());
    let given = tree.get("gravity");
    let gravity = super::gravity(given, source)?.norm();
    let film = settings.film(source)?;
    let outside = Surroundings::new(&film, supply, [area, volume], gravity > 0.0);
    match outside.refusal() {
        Some(problem) => {
            let value = given.map(Json::to_string).unwrap_or_default();
            Err(source.error("gravity", value, problem, Surroundings::ALLOWED))
        }
        None => Ok(outside.notes()),
    }
}

/// The inflow windows of the file.
fn windows(
    json: Option<&Json>,
    settings: &Settings,
    reader: &mut Reader,
) -> Result<Vec<InflowWindow>> {
    let Some(json) = json else { return Ok(Vec::new()) };
    let source = &reader.source.clone();
    let end_time = settings.needed("solver.end_time", source)?;
    let allowed = "a list of {\"from\": 0, \"to\": \"0.3 s\", \"mass_flow_rate\": \"5 g/s\"}";
    let mut windows = Vec::new();
    for (index, json) in list(json, "gas.windows", source, allowed)?.iter().enumerate() {
        let path = format!("gas.windows[{index}]");
        let window =
            Object::new(json, &path, "an inflow window", SCENE_WINDOW_KEYS, &["table"], source)?;
        let from = window.needed("from")?;
        if let Some(table) = window.given("table") {
            let beside = flow_table::BESIDE.into_iter().find(|key| window.given(key).is_some());
            if let Some(key) = beside {
                let problem = "is given beside table, which has all times and rates";
                return Err(window.error(key, problem, "a table, or one rate").into());
            }
            let start = [from, window.needed("temperature")?];
            windows.extend(flow_table::windows(table, &format!("{path}.table"), start, reader)?);
            continue;
        }
        let temperature = window.needed("temperature")?;
        let tank = tank::Given {
            mass: window.number("mass")?,
            tank_pressure: window.number("tank_pressure")?,
            orifice_area: window.number("orifice_area")?,
            mass_flow_rate: window.number("mass_flow_rate")?,
            temperature,
            from,
            to: window.number("to")?,
        };
        if tank.is_tank() {
            let outside = settings.needed("gas.ambient_pressure", source)?;
            windows.extend(tank.windows(&path, &settings.species(source)?, outside, source)?);
            continue;
        }
        let mass_flow_rate = window.needed("mass_flow_rate")?;
        let to = match (tank.to, tank.mass) {
            (Some(_), Some(_)) => {
                let problem = "the window gives both its end and its mass";
                return Err(window.error("mass", problem, "`to` or `mass`").into());
            }
            (None, Some(mass)) if mass_flow_rate > 0.0 => from + mass / mass_flow_rate,
            (to, _) => to.unwrap_or(end_time.max(from)),
        };
        let end = window.given("to").map(|_| ("to", format!("{} s", shown(to))));
        check_window(&path, [from, to], end, end_time, source)?;
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
fn check_outward(shape: &Shape, source: &Source) -> Checked<f64> {
    let positions = &shape.shell.positions;
    let volume = shape.shell.volume(|node| positions[node as usize]);
    if encloses_nothing(shape) {
        let is_open = !shape.shell.walls.is_empty() || !shape.shell.is_closed();
        let (problem, hint) = if is_open {
            ("is open and encloses no volume", "close the film, or give gas.pressure")
        } else {
            let hint = "separate the layers a little, or give gas.pressure";
            ("encloses no volume: its layers touch each other", hint)
        };
        let allowed = "film that encloses a volume where there is gas";
        let file = Json::Text(shape.file.clone());
        return Err(source.error("mesh.positions", file, problem, allowed).with_hint(hint));
    }
    if volume > 0.0 {
        return Ok(volume);
    }
    Err(source
        .error(
            "mesh.positions",
            Json::Text(shape.file.clone()),
            format!("encloses {} m³: its faces are wound inward", brief_number(volume)),
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
        "the film is open: {} over {edges} free edges close its volume",
        if tips.len() == 1 { "a fan".to_owned() } else { format!("{} fans", tips.len()) }
    ));
    if walls > 0 {
        notes.push(format!(
            "supports hold the edges of fans ({walls}), which count as walls or symmetry planes: reactions leave out \
             the pressure on them"
        ));
    }
}
