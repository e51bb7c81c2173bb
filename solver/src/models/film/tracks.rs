//! What film is followed by beside its samples: nodes, elements, the cap's centre, contact; its shape.

use super::FilmRun;
use crate::mechanics::forces::membrane::strain;
use crate::mechanics::resultants::resultants;
use crate::output::frames::Frame;
use crate::output::history::Track;

/// Tracks of contact: name, unit, meaning.
pub const CONTACT: [(&str, &str, &str); 7] = [
    ("interlayer_pressure", "Pa", "largest pressure of film on film at a node"),
    ("interlayer_pressure_mean", "Pa", "mean of it over the area in contact"),
    ("contact_area_fraction", "1", "share of the film's area in contact"),
    (
        "smallest_gap",
        "m",
        "smallest distance of film held apart; the contact distance where none is",
    ),
    ("contact_pairs", "1", "pairs of film pressed together"),
    ("contact_searches", "1", "searches for near pairs from nothing since time 0"),
    ("contact_impulses", "1", "approaches of film to film taken out by an impulse since time 0"),
];

fn track(name: String, unit: &'static str, meaning: &'static str) -> Track {
    Track { name, unit, meaning, values: Vec::new() }
}

/// Names of the tracks: followed nodes and elements first.
pub(super) fn names(run: &FilmRun) -> Vec<Track> {
    let nodes = run.nodes.iter().flat_map(|node| {
        ["x", "y", "z"]
            .map(|axis| track(format!("node_{node}_{axis}"), "m", "place of a followed node"))
    });
    let meaning = "principal membrane force of a followed element, per reference width";
    let elements = run.elements.iter().flat_map(|element| {
        ["N1", "N2"].map(|name| track(format!("element_{element}_{name}"), "N/m", meaning))
    });
    let mut all: Vec<Track> = nodes.chain(elements).collect();
    if run.rings.is_some() {
        let meaning = "velocity of the top centre node along z";
        all.push(track("vz_centre".to_owned(), "m/s", meaning));
    }
    if let Some(law) = &run.film.setting.contact {
        all.extend(CONTACT.map(|(name, unit, meaning)| track(name.to_owned(), unit, meaning)));
        let plates = law.plates.iter();
        all.extend(plates.map(|plate| {
            let meaning = "force of the film on a plate along its normal, against it";
            track(format!("plate_{}_force", plate.name), "N", meaning)
        }));
    }
    all
}

/// Their values now, in the same order.
pub(super) fn values(run: &FilmRun, values: &mut Vec<f64>) {
    let (model, state) = (&run.film.model, &run.film.state);
    for node in &run.nodes {
        let place = state.places.get(*node as usize);
        values.extend([place.x, place.y, place.z]);
    }
    for element in &run.elements {
        values.extend(resultants(model, &state.places, *element as usize).principal);
    }
    if let Some(rings) = &run.rings {
        values.push(run.film.velocities().z[rings.top_centre as usize]);
    }
    if let Some(law) = &run.film.setting.contact {
        let meeting = &state.meeting;
        let areas: Vec<f64> = model.mass.iter().map(|mass| mass / law.area_density).collect();
        let pressed = law.interlayer(&state.places, &areas, meeting);
        values.extend([
            pressed.largest,
            pressed.mean,
            pressed.area_fraction,
            run.film.smallest_gap().min(law.distance),
            meeting.contacts.len() as f64,
            meeting.searches as f64,
            meeting.impulses as f64,
        ]);
        values.extend(meeting.plates.iter().map(|plate| plate.force));
    }
}

/// The film's shape now.
pub(super) fn frame(run: &FilmRun) -> Frame {
    let (model, state) = (&run.film.model, &run.film.state);
    #[expect(clippy::cast_possible_truncation, reason = "single precision is what frames have")]
    let places = state.places.iter().map(|x| [x.x as f32, x.y as f32, x.z as f32]).collect();
    let regime = |element| model.material.regime(strain(model, &state.places, element));
    let regimes = (0..model.elements()).map(regime).collect();
    Frame { time: state.time, places, regimes }
}
