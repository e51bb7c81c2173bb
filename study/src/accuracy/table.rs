//! The table of mesh errors: how far a measure is from its value on the finest mesh, by model, mesh and kind of
//! scene. `billow-checks converge --table` writes it from stored results, `billow-checks held-back --table` widens it to
//! what other scenes keep too; the program contains it.
//!
//! ```text
//! b = F ln(m/m_ref)                            bias of a mesh: median over seeds, m_ref on the reference mesh
//! F = (1/n − 1/n_f)/(1/n − 1/n_ref)            to the finest mesh n_f: errors go as 1/n
//! e(n) = e₁ + (e₂ − e₁) ln(n/n₁)/ln(n₂/n₁)     error between two meshes of the table
//! ```

use std::collections::BTreeMap;
use std::sync::OnceLock;

use billow_solver::scene::Scene;
use serde::{Deserialize, Serialize};

use super::assumed::AssumedRanges;
use super::coordinates::Coordinates;
use super::entry::{Entry, Method, RelativeError};
use super::features::{Coverage, Features};
use super::promised::Promised;

/// Name of the format.
pub const FORMAT: &str = "billow-mesh-errors";
/// Version of the format that this program writes and reads.
pub const VERSION: u64 = 4;

/// The table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshErrors {
    /// Name of the format.
    pub format: String,
    /// Version of the format.
    pub version: u64,
    /// Version of the physics of the runs.
    pub physics_version: u32,
    /// Studies whose results it was made from.
    pub studies: Vec<String>,
    /// Subdivisions of the mesh of the runs with which the others are compared.
    pub reference: u32,
    /// Subdivisions of the mesh against which the errors are, by their first order.
    pub finest: u32,
    /// The scenes that it covers.
    pub coverage: Coverage,
    /// The coordinates of the biases.
    pub coordinates: Coordinates,
    /// The errors, by measure.
    pub errors: BTreeMap<String, Vec<Entry>>,
    /// The changes with each assumed value, as in `film.loss_factor 0.003`, by measure and by that value.
    pub assumed: BTreeMap<String, BTreeMap<String, Entry>>,
}

impl MeshErrors {
    /// The table that the program contains.
    pub fn shipped() -> &'static Self {
        static TABLE: OnceLock<MeshErrors> = OnceLock::new();
        TABLE.get_or_init(|| {
            let text = include_str!("mesh_errors.json");
            serde_json::from_str(text)
                .unwrap_or_else(|error| unreachable!("mesh_errors.json: {error}"))
        })
    }

    /// The meshes of which it has errors, coarsest first.
    pub fn meshes(&self) -> Vec<u32> {
        let single = self.errors.values().flatten().filter_map(|entry| match entry.meshes[..] {
            [n] => Some(n),
            _ => None,
        });
        let mut meshes: Vec<u32> = single.collect();
        meshes.sort_unstable();
        meshes.dedup();
        meshes
    }

    /// Why the error of a run is not known, for any measure; `None` if the scene is covered.
    pub fn gap(&self, scene: &Scene, features: &Features) -> Option<String> {
        self.coverage.gap(scene, features)
    }

    /// Relative error of a measure of a scene that is covered; between two meshes of the table linear in ln n.
    ///
    /// # Errors
    /// Why it is not known.
    pub fn error(
        &self,
        method: &Method,
        features: &Features,
        promised: &Promised,
    ) -> Result<RelativeError, String> {
        let measure = promised.measure.name();
        let u = self.coordinates.of(&features.values);
        if let Some(entry) = self.entry(method, measure) {
            return Ok(entry.error(&u));
        }
        let no_runs = || format!("{}: the table has no such runs", method.name());
        let [n] = method.meshes[..] else { return Err(no_runs()) };
        let known = self.of_measure(measure).iter().filter(|entry| entry.model == method.model);
        let known = known.filter_map(|entry| match entry.meshes[..] {
            [mesh] => Some((mesh, entry)),
            _ => None,
        });
        let mut known: Vec<(u32, &Entry)> = known.collect();
        known.sort_by_key(|(mesh, _)| *mesh);
        let below = known.iter().rfind(|(mesh, _)| *mesh < n);
        let above = known.iter().find(|(mesh, _)| *mesh >= n);
        if let (Some((coarse, coarse_entry)), Some((fine, fine_entry))) = (below, above) {
            let log = |mesh: u32| libm::log(f64::from(mesh));
            let part = (log(n) - log(*coarse)) / (log(*fine) - log(*coarse));
            let [coarse, fine] = [coarse_entry, fine_entry].map(|entry| entry.error(&u));
            let between = |coarse: f64, fine: f64| coarse + part * (fine - coarse);
            return Ok(RelativeError {
                of_reference: between(coarse.of_reference, fine.of_reference),
                of_itself: [0, 1].map(|side| between(coarse.of_itself[side], fine.of_itself[side])),
            });
        }
        match (known.first(), below) {
            // A finer mesh than those of the table keeps the error of its finest.
            (_, Some((_, finest))) => Ok(finest.error(&u)),
            (Some((first, _)), None) => {
                Err(format!("design.subdivisions {n}: the table has {first} and finer meshes"))
            }
            (None, None) => Err(no_runs()),
        }
    }

    /// Relative change of a measure over the range of each assumed value, below and above it, for a scene that is
    /// covered: 19 of 20 runs change less. `None` where the table has no such runs.
    ///
    /// ```text
    /// v = ln(m'/m) within b ± w at an end of a range: above m by e^(b + w) − 1 at most, below by 1 − e^(b − w)
    /// a² = Σ over the assumed values of (the larger one at the two ends of its range)²      on each side
    /// ```
    pub fn assumed(
        &self,
        features: &Features,
        promised: &Promised,
        ranges: &AssumedRanges,
    ) -> Option<[f64; 2]> {
        let u = self.coordinates.of(&features.values);
        let mut largest: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
        for (value, entry) in self.assumed.get(promised.measure.name())? {
            let Some((key, part)) = ranges.part(value) else { continue };
            let known = largest.entry(key).or_default();
            for (known, change) in known.iter_mut().zip(entry.change(&u)) {
                *known = known.max(part * change);
            }
        }
        let sum =
            |side: usize| largest.values().map(|sides| sides[side] * sides[side]).sum::<f64>();
        Some([0, 1].map(|side| sum(side).sqrt()))
    }

    /// The entry of a method, as it stands in the table.
    pub fn entry(&self, method: &Method, measure: &str) -> Option<&Entry> {
        let is = |entry: &&Entry| entry.model == method.model && entry.meshes == method.meshes;
        self.of_measure(measure).iter().find(is)
    }

    /// The entries of a measure.
    pub fn of_measure(&self, measure: &str) -> &[Entry] {
        self.errors.get(measure).map_or(&[], Vec::as_slice)
    }
}
