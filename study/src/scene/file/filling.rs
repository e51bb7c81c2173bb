//! What presses from inside: nothing, a fixed overpressure, or gas in a closed volume.

use std::collections::BTreeMap;

use billow_solver::scene::film_scene::Filling;
use billow_solver::scene::{HeatTransfer, InflowWindow};
use nalgebra::Vector3;

use super::object::Object;
use super::shape::Shape;
use crate::input::keys::SCENE_WINDOW_KEYS;
use crate::input::settings::{Settings, gas_laws, list, number};
use crate::input::source::{Source, shown};
use crate::input::study_file::Json;
use crate::platform::error::InputError;

/// Reads `gas`. An open film is closed by fans where there is gas.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    shape: &mut Shape,
    notes: &mut Vec<String>,
    source: &Source,
) -> Result<Filling, InputError> {
    let gas = tree.get("gas");
    let statics = settings.flag("solver.static");
    let Some(gas) = gas.filter(|gas| gas.get("pressure").is_none()) else {
        let pressure = settings.number("gas.pressure").unwrap_or(0.0);
        if let Some(Json::Object(members)) = gas
            && let Some((other, value)) = members.iter().find(|(name, _)| name != "pressure")
        {
            return Err(source.error(
                &format!("gas.{other}"),
                &value.brief(),
                "stands beside a fixed pressure, which no gas decides",
                "pressure alone, or a gas without it",
            ));
        }
        // Film that lies flat encloses nothing, and a pressure may part its layers.
        if shape.shell.is_closed() && !encloses_nothing(shape) {
            check_outward(shape, source)?;
        }
        return Ok(Filling::Pressure(pressure));
    };
    if statics {
        return Err(source.error(
            "gas",
            &gas.brief(),
            "is no fixed pressure, which solver.static needs",
            "{\"pressure\": \"1 kPa\"}",
        ));
    }
    close(shape, notes, source)?;
    let volume = check_outward(shape, source)?;
    let mut supply = gas_laws(settings, source)?;
    supply.windows = windows(gas.get("windows"), settings, source)?;
    let film_temperature = number(settings, "film.temperature", source)?;
    let initial_temperature =
        settings.number("gas.initial_temperature").unwrap_or(film_temperature);
    let isothermal = supply.heat_transfer == HeatTransfer::Isothermal;
    if isothermal && initial_temperature.to_bits() != film_temperature.to_bits() {
        return Err(source.error(
            "gas.initial_temperature",
            &shown(initial_temperature),
            "is not that of the film, which isothermal gas has at all times",
            format!("{} K, or another heat_transfer", shown(film_temperature)),
        ));
    }
    supply.initial_mass =
        match (settings.number("gas.initial_mass"), settings.number("gas.initial_pressure")) {
            (Some(_), Some(pressure)) => {
                return Err(source.error(
                    "gas.initial_pressure",
                    &shown(pressure),
                    "stands beside initial_mass",
                    "one of initial_mass, initial_pressure",
                ));
            }
            (Some(mass), None) => mass,
            (None, Some(pressure)) => {
                pressure * volume / (supply.species.gas_constant * initial_temperature)
            }
            (None, None) => 0.0,
        };
    Ok(Filling::Gas { supply, initial_temperature })
}

/// Inflow windows, cut at the end, in order of time.
fn windows(
    json: Option<&Json>,
    settings: &Settings,
    source: &Source,
) -> Result<Vec<InflowWindow>, InputError> {
    let Some(json) = json else { return Ok(Vec::new()) };
    let end_time = number(settings, "solver.end_time", source)?;
    let allowed = "a list of {\"from\": 0, \"to\": \"0.3 s\", \"rate\": \"5 g/s\"}";
    let mut windows = Vec::new();
    for (at, json) in list(json, "gas.windows", source, allowed)?.iter().enumerate() {
        let place = format!("gas.windows[{at}]");
        let window = Object::new(json, &place, "an inflow window", SCENE_WINDOW_KEYS, &[], source)?;
        let from = window.needed("from")?;
        let to = window.number("to")?.unwrap_or(end_time.max(from));
        if to < from || (to <= from && window.given("to").is_some()) {
            let problem = "the window ends before it begins";
            return Err(window.error("to", problem, format!("above its `from`, {from} s")));
        }
        let (rate, temperature) = (window.needed("rate")?, window.needed("temperature")?);
        windows.push(InflowWindow {
            from,
            to: to.min(end_time),
            mass_flow_rate: rate,
            temperature,
        });
    }
    windows.retain(|window| window.mass_flow_rate > 0.0 && window.from < window.to);
    windows.sort_by(|a, b| a.from.total_cmp(&b.from).then(a.to.total_cmp(&b.to)));
    Ok(windows)
}

/// Whether the volume is rounding, by the film's area.
fn encloses_nothing(shape: &Shape) -> bool {
    let places = &shape.shell.positions;
    let area = shape.shell.reference_area();
    shape.shell.volume(|node| places[node as usize]).abs() <= 1e-12 * area * area.sqrt()
}

/// The enclosed volume, m³, above 0 by the winding of its faces.
fn check_outward(shape: &Shape, source: &Source) -> Result<f64, InputError> {
    let places = &shape.shell.positions;
    let volume = shape.shell.volume(|node| places[node as usize]);
    if encloses_nothing(shape) {
        let mut error = source.error(
            "mesh.positions",
            &Json::Text(shape.file.clone()).brief(),
            "encloses no volume: its layers lie on each other",
            "film with some room inside where there is gas",
        );
        "part the layers a little, or give gas.pressure".clone_into(&mut error.hint);
        return Err(error);
    }
    if volume > 0.0 {
        return Ok(volume);
    }
    let mut error = source.error(
        "mesh.positions",
        &Json::Text(shape.file.clone()).brief(),
        format!("encloses {} m³: its faces are wound inward", shown(volume)),
        "faces counter-clockwise seen from outside",
    );
    "flip the normals of all faces (and of those of closure), or reverse every f line"
        .clone_into(&mut error.hint);
    Err(error)
}

/// Closes an open film by fans, unless it only looks open because its seams are not joined.
fn close(shape: &mut Shape, notes: &mut Vec<String>, source: &Source) -> Result<(), InputError> {
    let loops = shape.shell.boundary();
    if loops.is_empty() {
        return Ok(());
    }
    let mut seen: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    for node in loops.iter().flatten() {
        let place: Vector3<f64> = shape.shell.positions[*node as usize];
        // −0 and 0 are one place.
        let bits: [u64; 3] = (place.add_scalar(0.0)).map(f64::to_bits).into();
        match seen.insert(bits, *node) {
            Some(other) if other != *node => {
                let vertex = |node| shape.numbering.vertex(node).map_or(0, |vertex| vertex + 1);
                let mut error = source.error(
                    "mesh.positions",
                    &Json::Text(shape.file.clone()).brief(),
                    format!(
                        "leaks: its free edges pass through {:?} m twice, at OBJ vertices {} and {} \
                         (counted from 1), which are not joined",
                        <[f64; 3]>::from(place),
                        vertex(other),
                        vertex(*node),
                    ),
                    "film with its seams joined where there is gas inside",
                );
                "join the seam there, or set mesh.weld to 0 (vertices that coincide) or to a \
                 tolerance"
                    .clone_into(&mut error.hint);
                return Err(error);
            }
            _ => {}
        }
    }
    let edges: usize = loops.iter().map(Vec::len).sum();
    let tips = shape.shell.close();
    notes.push(format!(
        "the film is open: its volume is closed by {} fan(s) over {edges} free edges (about the middle \
         of a plane loop, else about the origin)",
        tips.len()
    ));
    Ok(())
}
