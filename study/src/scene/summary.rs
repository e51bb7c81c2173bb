//! What `billow solve` says of a solved scene: one JSON object, SI.
//!
//! | key | meaning |
//! |---|---|
//! | `status` | `done`; `paused`; `unstable`, `energy_drift`, `inverted_volume`, `step_limit`, `interpenetrated`, `no_equilibrium`: no result |
//! | `notes` | what the program decided for itself, where it did |
//! | `stop` | kind, time and place, where there is no result |
//! | `volume` | enclosed, m³; of open film between it and the fans over its free edges |
//! | `pressure`, `overpressure` | inside (of a fixed pressure: the overpressure); less the ambient one, Pa |
//! | `temperature`, `gas_mass` | of the gas: K (of the film where there is none), kg |
//! | `extents` | x, y, z: least and largest place of the film's nodes, m |
//! | `nodes` | place of each node followed, m |
//! | `resultants` | principal membrane forces of each element followed, the larger first, N/m: `N1`, `N2` second Piola-Kirchhoff, per reference width; `P1`, `P2` nominal (first Piola-Kirchhoff): the force itself, per reference width, in size; `T1`, `T2` true (Cauchy): the force itself, per width as it is. `S1`, `S2`: N over thickness, Pa; `regime` taut, wrinkled, slack |
//! | `reactions` | of each support: `force` (N) it exerts on the film and its `moment` about the origin (N m); without inertia; a node of two supports counts in both |
//! | `ledger` | every entry since the start, J, and its largest `residual`; `gas_residual` |
//! | `passages`, `intersections` | film through film: counted over the run; largest number at a sample (at rest: at the end); null where contact is off |
//! | `contact` | `distance` film is held apart at and `smallest_gap`, m; largest `interlayer_pressure`, Pa, and `contact_area_fraction`; `searches`; most `pairs` at once; `impulses` against passing; `not_returned` energy, J; force on each of `plates` at the end, N |
//! | `measures` | largest `peak_vz` of the top ring (m/s) with its time, `peak_kinetic_energy` (J) |
//! | `energies` | kinetic, strain and (at rest) potential, J |
//! | `film_stress` | largest principal second Piola-Kirchhoff stress: over the run, or at rest, Pa |
//! | `steps`, `end_time`, `elements`, `wall_seconds` | steps (at rest: Newton steps); time reached, s; elements; wall time, s |

use billow_solver::collision::contact::intersections::intersections;
use billow_solver::collision::contact::topology::Topology;
use billow_solver::geometry::field::Field;
use billow_solver::integrators::explicit::PressureLoad;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::material::Regime;
use billow_solver::mechanics::resultants::{resultants, thickness};
use billow_solver::models::film::FilmRun;
use billow_solver::output::outcome::Stop;
use nalgebra::Vector3;
use serde_json::{Map, Value as Json, json};

use crate::input::value::Value;
use crate::scene::file::SceneFile;
use crate::scene::solve::{Ended, Solved};

/// The summary of a solved scene.
pub fn summary(scene: &SceneFile, solved: &Solved) -> Json {
    let mut summary = match &solved.end {
        Ended::Motion(motion) => in_motion(scene, &motion.0, &motion.1),
        Ended::Rest(rest) => at_rest(scene, rest),
        Ended::NoRest(failure) => {
            let stop = json!({
                "kind": "no_equilibrium",
                "time": null,
                "place": format!("node {}: {failure}", node_name(scene, failure.node)),
            });
            let elements = scene.film.shell.triangles.len();
            json!({"stop": stop, "steps": failure.iterations, "elements": elements})
        }
    };
    if !scene.notes.is_empty() {
        summary["notes"] = scene.notes.clone().into();
    }
    summary["status"] = solved.status.name().into();
    summary["wall_seconds"] = solved.wall_seconds.into();
    summary
}

/// A node as the user counts, 0-based vertices of the file.
fn node_name(scene: &SceneFile, node: usize) -> String {
    let vertex = u32::try_from(node).ok().and_then(|node| scene.numbering.vertex(node));
    vertex.map_or_else(|| format!("{node} of the run"), |vertex| vertex.to_string())
}

/// What any film shows: nodes, extents, resultants.
fn film(scene: &SceneFile, model: &FilmModel, places: &Field) -> Json {
    let nodes =
        scene.followed.nodes.iter().zip(&scene.film.outputs.nodes).map(|(name, node)| {
            (name.clone(), json!(<[f64; 3]>::from(places.get(*node as usize))))
        });
    let elements = scene.followed.elements.iter().zip(&scene.film.outputs.elements);
    let elements = elements.map(|(name, element)| {
        let own = resultants(model, places, *element as usize);
        let thickness = thickness(model, *element as usize);
        let [n1, n2] = own.principal;
        let [p1, p2] = own.nominal;
        let [t1, t2] = own.cauchy;
        let regime = match own.regime {
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
        "extents": extents(model, places),
        "elements": model.elements(),
    })
}

/// Least and largest place of nodes that bear film, m.
fn extents(model: &FilmModel, places: &Field) -> Json {
    let of = |column: &[f64]| {
        let film = model.mass.iter().zip(column).filter(|(mass, _)| **mass > 0.0);
        let (low, high) = film
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, place)| {
                (low.min(*place), high.max(*place))
            });
        json!([low, high])
    };
    json!({"x": of(&places.x), "y": of(&places.y), "z": of(&places.z)})
}

/// What a support exerts on the film, of what the film exerts on it.
fn reaction([force, moment]: [Vector3<f64>; 2]) -> Json {
    // −0 is 0 to whoever reads it.
    let turned = |vector: Vector3<f64>| <[f64; 3]>::from(vector.map(|part| 0.0 - part));
    json!({"force": turned(force), "moment": turned(moment)})
}

fn in_motion(
    scene: &SceneFile,
    run: &FilmRun,
    deployment: &billow_solver::output::outcome::Deployment,
) -> Json {
    let explicit = &run.film;
    let mut summary = film(scene, &explicit.model, &explicit.state.places);
    let ledger = explicit.ledger();
    let temperature = match explicit.setting.interior {
        PressureLoad::Gas(gas) => gas.temperature(explicit.state.gas),
        PressureLoad::Overpressure(_) => scene.film.film.temperature,
    };
    let reactions = scene.film.supports.iter().map(|support| {
        let borne = explicit.reaction(&support.nodes, &support.hold.projector());
        (support.name.clone(), reaction(borne))
    });
    let more = json!({
        "volume": run.volume(),
        "pressure": explicit.state.pressure,
        "overpressure": explicit.overpressure(),
        "temperature": temperature,
        "gas_mass": explicit.state.gas.mass,
        "reactions": reactions.collect::<Map<_, _>>(),
        "ledger": {
            "kinetic": ledger.kinetic,
            "strain": ledger.strain,
            "contact": ledger.contact,
            "gas_work": ledger.gas_work,
            "ambient_work": ledger.ambient_work,
            "gravity_work": ledger.gravity_work,
            "support_work": ledger.support_work,
            "viscous_work": ledger.viscous_work,
            "friction_work": ledger.friction_work,
            "damping_work": ledger.damping_work,
            "residual": deployment.audit.ledger_residual,
            "gas_residual": deployment.audit.gas_residual,
        },
        "passages": deployment.audit.passages,
        "intersections": deployment.audit.intersections,
        "contact": contact(run, deployment),
        "measures": {
            "peak_vz": deployment.measures.peak_vz,
            "t_peak_vz": deployment.measures.t_peak_vz,
            "peak_kinetic_energy": deployment.measures.peak_kinetic_energy,
        },
        "energies": {"kinetic": ledger.kinetic, "strain": ledger.strain},
        "film_stress": explicit.state.film_stress,
        "steps": explicit.state.steps,
        "end_time": explicit.state.time,
    });
    merge(&mut summary, more);
    if let Stop::Failed(failure) = &deployment.stop {
        summary["stop"] =
            json!({"kind": failure.kind.name(), "time": failure.time, "place": failure.place});
    }
    summary
}

/// What contact did, its extremes over the samples; `null` where it is off.
fn contact(run: &FilmRun, deployment: &billow_solver::output::outcome::Deployment) -> Json {
    let Some(law) = &run.film.setting.contact else { return Json::Null };
    let meeting = &run.film.state.meeting;
    let most = |name: &str| deployment.followed(name).iter().copied().fold(0.0, f64::max);
    let plates = law.plates.iter().zip(&meeting.plates);
    let stored = meeting.contacts.iter().map(|contact| contact.energy).sum::<f64>()
        + meeting.plates.iter().map(|plate| plate.energy).sum::<f64>();
    json!({
        "distance": law.distance,
        "smallest_gap": deployment.followed("smallest_gap").iter().copied().fold(law.distance, f64::min),
        "interlayer_pressure": most("interlayer_pressure"),
        "contact_area_fraction": most("contact_area_fraction"),
        "searches": meeting.searches,
        "pairs": most("contact_pairs"),
        "impulses": meeting.impulses,
        "not_returned": run.film.ledger().contact - stored + meeting.taken,
        "plates": plates.map(|(plate, own)| (plate.name.clone(), own.force.into()))
            .collect::<Map<_, _>>(),
    })
}

fn at_rest(scene: &SceneFile, rest: &billow_solver::statics::StaticSolution) -> Json {
    let mut summary = film(scene, &rest.model, &rest.places);
    let pressure = match scene.film.filling {
        billow_solver::scene::film_scene::Filling::Pressure(pressure) => pressure,
        billow_solver::scene::film_scene::Filling::Gas { .. } => {
            unreachable!("refused with statics")
        }
    };
    let reactions = rest
        .reactions
        .iter()
        .map(|own| (own.name.clone(), reaction([own.force, own.moment])))
        .collect::<Map<_, _>>();
    let stress = (0..rest.model.elements()).fold(0.0_f64, |largest, element| {
        let own = resultants(&rest.model, &rest.places, element);
        largest.max(own.principal[0] / thickness(&rest.model, element))
    });
    let topology = Topology::new(rest.model.nodes(), &rest.model.triangles);
    if scene.film.shell.is_closed() && rest.volume <= 0.0 {
        let place = format!("the film is turned inside out: V {:.6} m3", rest.volume);
        summary["stop"] = json!({"kind": "inverted_volume", "time": null, "place": place});
    }
    let more = json!({
        "volume": rest.volume,
        "pressure": pressure,
        "overpressure": pressure,
        "temperature": scene.film.film.temperature,
        "gas_mass": 0.0,
        "reactions": reactions,
        "passages": null,
        "intersections": intersections(&topology, &rest.places).len(),
        "energies": {
            "kinetic": 0.0, "strain": rest.strain_energy, "potential": rest.potential_energy,
        },
        "ledger": {"strain": rest.strain_energy, "residual": rest.residual},
        "film_stress": stress,
        "steps": rest.iterations,
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
