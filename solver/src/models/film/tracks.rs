//! Tracks and frames of the film: followed nodes and elements, the top centre, contact, plates.

use super::FilmRun;
use super::pleats::{self, PLEATS};
use crate::geometry::mesh::Pleat;
use crate::mechanics::forces::membrane::strain;
use crate::mechanics::gas::Gas;
use crate::mechanics::resultants::resultants;
use crate::output::frames::{Frame, rounded};
use crate::output::history::Track;
use crate::system::PressureLoad;

/// Name, unit and meaning of the track of film stress that one element does not decide.
pub const FILM_STRESS_99: (&str, &str, &str) = (
    "film_stress_99",
    "Pa",
    "stress that 99 % of the film's area does not exceed (largest principal second Piola-Kirchhoff stress)",
);
/// Fraction of the area that reaches [`FILM_STRESS_99`].
const ABOVE_99: f64 = 0.01;

/// Tracks of contact: name, unit, meaning.
pub const CONTACT: [(&str, &str, &str); 7] = [
    ("interlayer_pressure", "Pa", "largest pressure of film on film at any node"),
    ("interlayer_pressure_mean", "Pa", "mean pressure of film on film over the area in contact"),
    ("contact_area_fraction", "1", "area in contact over the area of the film"),
    (
        "smallest_gap",
        "m",
        "smallest distance between film and film, capped at the contact distance",
    ),
    ("contact_pairs", "1", "number of active contacts of film with film"),
    ("broad_phase_rebuilds", "1", "complete rebuilds of the broad phase since time 0"),
    (
        "collision_impulses",
        "1",
        "impulses that resolved a collision of film with film since time 0",
    ),
];

fn track(name: String, unit: &'static str, meaning: &'static str) -> Track {
    Track { name, unit, meaning, values: Vec::new() }
}

/// The tracks without values: followed nodes and elements first.
pub(super) fn names(run: &FilmRun) -> Vec<Track> {
    let nodes = run.nodes.iter().flat_map(|node| {
        ["x", "y", "z"]
            .map(|axis| track(format!("node_{node}_{axis}"), "m", "position of a followed node"))
    });
    let meaning = "principal membrane force of a followed element, per reference width";
    let elements = run.elements.iter().flat_map(|element| {
        ["N1", "N2"].map(|name| track(format!("element_{element}_{name}"), "N/m", meaning))
    });
    let mut all: Vec<Track> = nodes.chain(elements).collect();
    let (name, unit, meaning) = FILM_STRESS_99;
    all.push(track(name.to_owned(), unit, meaning));
    if run.rings.is_some() {
        let meaning = "velocity of the top centre node along z";
        all.push(track("vz_centre".to_owned(), "m/s", meaning));
    }
    if let Some(contact_model) = &run.view().system.contact {
        all.extend(CONTACT.map(|(name, unit, meaning)| track(name.to_owned(), unit, meaning)));
        let plates = contact_model.plates.iter();
        all.extend(plates.map(|plate| {
            let meaning = "force of the film on a plate, against the plate's normal";
            track(format!("plate_{}_force", plate.name), "N", meaning)
        }));
    }
    if followed_pleats(run).is_some() {
        all.extend(PLEATS.map(|(name, unit, meaning)| track(name.to_owned(), unit, meaning)));
    }
    all
}

/// The pleats whose gas is followed, and the gas: those of a capsule with gas and contact.
fn followed_pleats(run: &FilmRun) -> Option<(&[Pleat], &Gas)> {
    let system = run.view().system;
    let PressureLoad::Gas(gas) = &system.pressure_load else { return None };
    let pleats = &run.rings.as_ref()?.pleats;
    (system.contact.is_some() && !pleats.is_empty()).then_some((pleats, gas))
}

/// The values of the tracks now, in the order of [`names`].
pub(super) fn values(run: &FilmRun, values: &mut Vec<f64>) {
    let film = run.view();
    let (model, state) = (&film.system.model, film.state);
    for node in &run.nodes {
        let position = state.positions.get(*node as usize);
        values.extend([position.x, position.y, position.z]);
    }
    for element in &run.elements {
        values.extend(resultants(model, &state.positions, *element as usize).principal);
    }
    values.push(film.stress_on_fraction(ABOVE_99));
    if let Some(rings) = &run.rings {
        values.push(state.velocities.z[rings.top_centre as usize]);
    }
    if let Some(contact_model) = &film.system.contact {
        let (contact_state, accounting) = (&state.contact, film.accounting());
        let areas: Vec<f64> =
            model.mass.iter().map(|mass| mass / contact_model.area_density).collect();
        let interlayer = contact_model.interlayer_pressure(&state.positions, &areas, contact_state);
        values.extend([
            interlayer.largest,
            interlayer.mean,
            interlayer.area_fraction,
            film.smallest_gap().min(contact_model.distance),
            contact_state.contacts.len() as f64,
            accounting.broad_phase_rebuilds as f64,
            accounting.collision_impulses as f64,
        ]);
        values.extend(contact_state.plates.iter().map(|plate| plate.force));
    }
    if let Some((followed, gas)) = followed_pleats(run) {
        values.extend(pleats::values(followed, gas, state));
    }
}

/// The shape of the film now.
pub(super) fn frame(run: &FilmRun) -> Frame {
    let film = run.view();
    let (model, state) = (&film.system.model, film.state);
    #[expect(clippy::cast_possible_truncation, reason = "frames are in single precision")]
    let positions = state.positions.iter().map(|x| [x.x as f32, x.y as f32, x.z as f32]).collect();
    let mut regimes = Vec::with_capacity(model.elements());
    let mut stresses = Vec::with_capacity(model.elements());
    for element in 0..model.elements() {
        let strain = strain(model, &state.positions, element);
        let (first, second) = model.material.stress(strain).tensor.principal();
        regimes.push(model.material.regime(strain));
        stresses.push([rounded(first), rounded(second)]);
    }
    let velocities = state.velocities.iter().map(|v| [v.x, v.y, v.z].map(rounded)).collect();
    let contact_model = film.system.contact.as_ref();
    let gaps = contact_model.map_or_else(Vec::new, |contact_model| {
        contact_model.node_gaps(&state.positions, &state.contact)
    });
    let gaps = gaps.into_iter().map(rounded).collect();
    Frame { time: state.time, positions, regimes, velocities, stresses, gaps }
}
