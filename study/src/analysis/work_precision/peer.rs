//! A peer: another program on the same scene, known by published ratios of time and values with their provenance.

use serde::Deserialize;

use super::{Cost, Diagram};
use crate::input::keys::default_integrator;
use crate::input::keys::numerical::{self, INTEGRATOR, MESH, MODEL};
use crate::input::value::Value;

/// What is known of a peer: `results/pareto/published/peer.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Peer {
    /// Its name.
    pub name: String,
    /// Where the numbers come from: program, mesh, machine, threads.
    pub provenance: String,
    /// Name of the scene.
    pub scene: String,
    /// Its times over those of billow.
    pub times: Vec<PeerTime>,
    /// Measures that can be compared.
    pub measures: Vec<PeerMeasure>,
    /// Other known values, for the reader.
    #[serde(default)]
    pub events: Vec<PeerEvent>,
}

/// A time over that of billow.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeerTime {
    /// Model of billow that it is compared with.
    pub model: String,
    /// Its `design.subdivisions`.
    pub subdivisions: i64,
    /// Simulated time of both, s.
    pub simulated: f64,
    /// Least and largest time of the peer over the time of billow.
    pub ratio: [f64; 2],
}

/// A measure of the peer.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeerMeasure {
    /// Name of the measure.
    pub name: String,
    /// Least and largest value, SI.
    pub range: [f64; 2],
    /// Why it differs.
    pub note: String,
}

/// A time at which a quantity has a value.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeerEvent {
    /// Column of the history.
    pub quantity: String,
    /// Its value, SI.
    pub value: f64,
    /// Time, s.
    pub time: f64,
}

/// A reference point of a peer on the chart of seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct PeerPoint<'a> {
    /// Its time.
    pub time: &'a PeerTime,
    /// Least and largest cost, s for a simulated second.
    pub seconds: [f64; 2],
}

impl Peer {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_text(text: &[u8]) -> Result<Self, String> {
        let peer: Self = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        let ordered = |range: &[f64; 2]| 0.0 < range[0] && range[0] <= range[1];
        if let Some(time) = peer.times.iter().find(|time| !ordered(&time.ratio)) {
            return Err(format!("ratio {:?}: must be positive, the least one first", time.ratio));
        }
        match peer.measures.iter().find(|measure| !ordered(&measure.range)) {
            Some(measure) => Err(format!("range of {}: the least value first", measure.name)),
            None => Ok(peer),
        }
    }

    /// Its points on the chart of a scene: its ratios times the seconds that billow took on this machine.
    pub fn points(&self, diagram: &Diagram) -> Vec<PeerPoint<'_>> {
        if diagram.name != self.scene {
            return Vec::new();
        }
        let usual = diagram.usual();
        let seconds = |time: &PeerTime| {
            let fits = |pair: &(String, Value)| match numerical::path(&pair.0) {
                Some(MODEL) => pair.1 == Value::Text(time.model.clone()),
                Some(MESH) => pair.1 == Value::Integer(time.subdivisions),
                Some(INTEGRATOR) => pair.1 == Value::Text(default_integrator().to_owned()),
                _ => usual.contains(pair),
            };
            let member =
                diagram.members.iter().find(|member| member.configuration.iter().all(fits))?;
            member.cost(Cost::Seconds)
        };
        let point = |time| {
            let seconds = seconds(time)?;
            Some(PeerPoint { time, seconds: time.ratio.map(|ratio| ratio * seconds) })
        };
        self.times.iter().filter_map(point).collect()
    }

    /// Its relative differences from a reference value: least and largest; `None` for a measure that it does not
    /// have. The least one is 0 where the reference lies within its range.
    pub fn difference(&self, measure: &str, reference: f64) -> Option<[f64; 2]> {
        let known = self.measures.iter().find(|known| known.name == measure)?;
        let [low, high] = known.range.map(|value| value / reference - 1.0);
        let within = low <= 0.0 && high >= 0.0;
        let (a, b) = (low.abs(), high.abs());
        Some([if within { 0.0 } else { a.min(b) }, a.max(b)])
    }
}
