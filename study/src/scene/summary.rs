//! The summary that `billow solve` prints of a solved scene: one JSON object, SI.
//! docs/guide/scene.md says what each key means.

use billow_solver::collision::monitor::intersections::intersections;
use billow_solver::geometry::field::Field;
use billow_solver::geometry::topology::Topology;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::material::Regime;
use billow_solver::mechanics::resultants::{largest_stress, resultants, stretches, thickness};
use billow_solver::models::film::{FILM_STRESS_99, FilmRun};
use billow_solver::models::run::FILM_SPEED;
use billow_solver::output::outcome::{Deployment, FailureKind, Stop};
use billow_solver::scene::film_scene::Filling;
use billow_solver::statics::StaticSolution;
use billow_solver::system::PressureLoad;
use nalgebra::Vector3;
use serde_json::{Map, Value as Json, json};

use crate::input::value::Value;
use crate::job::Status;
use crate::scene::file::SceneFile;
use crate::scene::next_steps;
use crate::scene::solve::{Ended, Solved};

/// The summary of a solved scene.
pub fn summary(scene: &SceneFile, solved: &Solved) -> Json {
    let mut summary = match &solved.end {
        Ended::Motion(motion) => in_motion(scene, &motion.0, &motion.1),
        Ended::Equilibrium(solution) => in_equilibrium(scene, solution, solved.status),
        Ended::NoEquilibrium(failure) => {
            let stop = json!({
                "kind": Status::NoEquilibrium.name(),
                "time": null,
                "location": format!("node {}: {failure}", node_place(scene, failure.node)),
            });
            let elements = scene.film.shell.triangles.len();
            json!({"stop": stop, "steps": failure.iterations, "elements": elements})
        }
    };
    let next = next_steps::of(scene, &summary, solved);
    if !next.is_empty() {
        summary["stop"]["next"] = next.into();
    }
    if !scene.notes.is_empty() {
        summary["notes"] = scene.notes.clone().into();
    }
    summary["status"] = solved.status.name().into();
    summary["wall_seconds"] = solved.wall_seconds.into();
    summary
}

/// Number of a node in the user's file, from 0.
fn node_name(scene: &SceneFile, node: usize) -> String {
    let vertex = u32::try_from(node).ok().and_then(|node| scene.numbering.vertex(node));
    vertex.map_or_else(|| format!("{node} of the run"), |vertex| vertex.to_string())
}

/// Number of a node in the user's file, from 0, and its place at the start.
fn node_place(scene: &SceneFile, node: usize) -> String {
    let place = scene.film.shell.positions.get(node);
    let place = place.map(|place| <[f64; 3]>::from(place + scene.numbering.origin));
    let place = place.map_or_else(String::new, |place| format!(" (at {place:?} m)"));
    format!("{}{place}", node_name(scene, node))
}

/// What every film has: nodes, resultants, extents.
fn film(scene: &SceneFile, model: &FilmModel, positions: &Field) -> Json {
    let nodes =
        scene.recorded.nodes.iter().zip(&scene.film.outputs.nodes).map(|(name, node)| {
            (name.clone(), json!(<[f64; 3]>::from(positions.get(*node as usize))))
        });
    let elements = scene.recorded.elements.iter().zip(&scene.film.outputs.elements);
    let elements = elements.map(|(name, element)| {
        let forces = resultants(model, positions, *element as usize);
        let thickness = thickness(model, *element as usize);
        let [n1, n2] = forces.principal;
        let [p1, p2] = forces.nominal;
        let [t1, t2] = forces.cauchy;
        let regime = match forces.regime {
            Regime::Taut => "taut",
            Regime::Wrinkled => "wrinkled",
            Regime::Slack => "slack",
        };
        let value = json!({
            "N1": n1, "N2": n2, "P1": p1, "P2": p2, "T1": t1, "T2": t2,
            "S1": n1 / thickness, "S2": n2 / thickness, "regime": regime,
        });
        (name.clone(), value)
    });
    json!({
        "nodes": nodes.collect::<Map<_, _>>(),
        "resultants": elements.collect::<Map<_, _>>(),
        "extents": extents(model, positions),
        "elements": model.elements(),
        "stretch": {
            "start": stretches(model, &Field::of(&scene.film.shell.positions)).map(|(stretch, _)| stretch),
            "end": stretches(model, positions).map(|(stretch, _)| stretch),
        },
    })
}

/// Smallest and largest coordinates of nodes with film, m.
fn extents(model: &FilmModel, positions: &Field) -> Json {
    let range = |column: &[f64]| {
        let film = model.mass.iter().zip(column).filter(|(mass, _)| **mass > 0.0);
        let (low, high) = film
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, coordinate)| {
                (low.min(*coordinate), high.max(*coordinate))
            });
        json!([low, high])
    };
    json!({"x": range(&positions.x), "y": range(&positions.y), "z": range(&positions.z)})
}

/// Force and moment of a support on the film, from those of the film on the support.
fn reaction([force, moment]: [Vector3<f64>; 2]) -> Json {
    // Subtraction from 0 gives 0, not −0.
    let reversed = |vector: Vector3<f64>| <[f64; 3]>::from(vector.map(|part| 0.0 - part));
    json!({"force": reversed(force), "moment": reversed(moment)})
}

fn in_motion(scene: &SceneFile, run: &FilmRun, deployment: &Deployment) -> Json {
    let now = run.view();
    let mut summary = film(scene, &now.system.model, &now.state.positions);
    let ledger = now.ledger();
    let temperature = match now.system.pressure_load {
        PressureLoad::Gas(gas) => gas.temperature(now.state.gas),
        PressureLoad::Overpressure(_) => scene.film.film.temperature,
    };
    let reactions = scene.film.supports.iter().map(|support| {
        let on_support = now.reaction(&support.nodes, &support.hold.projector());
        (support.name.clone(), reaction(on_support))
    });
    let largest = |track: &str| deployment.followed(track).iter().copied().fold(0.0, f64::max);
    let more = json!({
        "volume": run.volume(),
        "pressure": now.state.pressure,
        "overpressure": now.overpressure(),
        "temperature": temperature,
        "gas_mass": now.state.gas.mass,
        "reactions": reactions.collect::<Map<_, _>>(),
        "ledger": {
            "kinetic": ledger.kinetic,
            "strain": ledger.strain,
            "contact": ledger.contact,
            "gas_work": ledger.gas_work,
            "ambient_work": ledger.ambient_work,
            "gravity_work": ledger.gravity_work,
            "support_work": ledger.support_work,
            "material_loss": ledger.material_loss,
            "numerical_dissipation": ledger.numerical_dissipation,
            "friction_work": ledger.contact_dissipation,
            "damping_work": ledger.damping_work,
            "residual": deployment.audit.ledger_residual,
            "gas_residual": deployment.audit.gas_residual,
        },
        "passages": deployment.audit.passages,
        "intersections": deployment.audit.intersections,
        "contact": contact(run, deployment),
        "imperfection_amplitude": scene.imperfection_amplitude,
        "measures": {
            "peak_vz": deployment.measures.peak_vz,
            "t_peak_vz": deployment.measures.t_peak_vz,
            "peak_film_speed": largest(FILM_SPEED.0),
            "peak_kinetic_energy": deployment.measures.peak_kinetic_energy,
        },
        "energies": {"kinetic": ledger.kinetic, "strain": ledger.strain},
        "film_stress": now.accounting().film_stress,
        "film_stress_99": largest(FILM_STRESS_99.0),
        "steps": now.steps(),
        "end_time": now.state.time,
    });
    merge(&mut summary, more);
    if let Stop::Failed(failure) = &deployment.stop {
        summary["stop"] = json!({"kind": failure.kind.name(), "time": failure.time, "location": in_file(scene, &failure.place)});
    }
    summary
}

/// A place of the run ("node 3, element 5: …") with the face or the vertex of the user's file.
fn in_file(scene: &SceneFile, place: &str) -> String {
    let number = |word: &str| -> Option<usize> {
        let rest = place.split_once(word)?.1;
        rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    };
    let face = number("element ").map(|element| scene.numbering.place(element));
    let vertex = number("node ").map(|node| format!("vertex {}", node_place(scene, node)));
    match face.or(vertex).filter(|_| scene.rings.is_none()) {
        Some(known) => format!("{place}; in the file {known}"),
        None => place.to_owned(),
    }
}

/// Contact, with its extremes over the samples; `null` where it is off.
fn contact(run: &FilmRun, deployment: &Deployment) -> Json {
    let now = run.view();
    let Some(model) = &now.system.contact else { return Json::Null };
    let (state, accounting) = (&now.state.contact, now.accounting());
    let largest = |name: &str| deployment.followed(name).iter().copied().fold(0.0, f64::max);
    let plates = model.plates.iter().zip(&state.plates);
    let stored = state.stored_energy();
    json!({
        "distance": model.distance,
        "smallest_gap": deployment.followed("smallest_gap").iter().copied().fold(model.distance, f64::min),
        "interlayer_pressure": largest("interlayer_pressure"),
        "contact_area_fraction": largest("contact_area_fraction"),
        "broad_phase_rebuilds": accounting.broad_phase_rebuilds,
        "pairs": largest("contact_pairs"),
        "collision_impulses": accounting.collision_impulses,
        "unrecovered_contact_energy": now.ledger().contact - stored + accounting.collision_dissipation,
        "plates": plates.map(|(plate, state)| (plate.name.clone(), state.force.into()))
            .collect::<Map<_, _>>(),
    })
}

fn in_equilibrium(scene: &SceneFile, solution: &StaticSolution, status: Status) -> Json {
    let mut summary = film(scene, &solution.model, &solution.positions);
    let pressure = match scene.film.filling {
        Filling::Pressure(pressure) => pressure,
        Filling::Gas { .. } => unreachable!("the scene file refuses gas with solver.static"),
    };
    let reactions = solution
        .reactions
        .iter()
        .map(|support| (support.name.clone(), reaction([support.force, support.moment])))
        .collect::<Map<_, _>>();
    let topology = Topology::new(solution.model.nodes(), &solution.model.triangles);
    let stop = match status {
        Status::Failed(FailureKind::InvertedVolume) => {
            Some(format!("the film is turned inside out: V {:.6} m3", solution.volume))
        }
        Status::Failed(FailureKind::Overstretched) => {
            let [_, (stretch, element)] = stretches(&solution.model, &solution.positions);
            let place = scene.numbering.place(element);
            Some(format!("{place}: stretched to {stretch:.2} times its length"))
        }
        _ => None,
    };
    if let Some(location) = stop {
        summary["stop"] = json!({"kind": status.name(), "time": null, "location": location});
    }
    let more = json!({
        "volume": solution.volume,
        "pressure": pressure,
        "overpressure": pressure,
        "temperature": scene.film.film.temperature,
        "gas_mass": 0.0,
        "reactions": reactions,
        "passages": null,
        "intersections": intersections(&topology, &solution.positions).len(),
        "energies": {
            "kinetic": 0.0, "strain": solution.strain_energy, "potential": solution.potential_energy,
        },
        "ledger": {"strain": solution.strain_energy, "residual": solution.residual},
        "film_stress": largest_stress(&solution.model, &solution.positions),
        "steps": solution.iterations,
        "end_time": null,
    });
    merge(&mut summary, more);
    summary
}

fn merge(summary: &mut Json, more: Json) {
    if let (Json::Object(summary), Json::Object(more)) = (summary, more) {
        summary.extend(more);
    }
}

/// The summary as rows of quantity and value.
pub fn rows(summary: &Json) -> Vec<Vec<Value>> {
    let mut rows = Vec::new();
    flatten("", summary, &mut rows);
    rows
}

fn flatten(name: &str, json: &Json, rows: &mut Vec<Vec<Value>>) {
    let below = |part: &str| {
        if name.is_empty() { part.to_owned() } else { format!("{name}.{part}") }
    };
    let value = match json {
        Json::Object(members) => {
            return members.iter().for_each(|(part, json)| flatten(&below(part), json, rows));
        }
        Json::Array(items) => {
            let parts = (0..).zip(items);
            return parts.for_each(|(at, json)| flatten(&below(&format!("{at}")), json, rows));
        }
        Json::Null => Value::Null,
        Json::Bool(flag) => Value::Bool(*flag),
        Json::String(text) => Value::Text(text.clone()),
        Json::Number(number) => match number.as_i64() {
            Some(whole) => Value::Integer(whole),
            None => number.as_f64().map_or(Value::Null, Value::Number),
        },
    };
    rows.push(vec![Value::Text(name.to_owned()), value]);
}
