//! The table of mesh errors: how far a measure is from its value on the finest mesh, by model, mesh and kind of
//! scene. `billow-checks converge --table` writes it from stored results; the program contains it.
//!
//! ```text
//! b = m/m_ref − 1                              bias of a mesh: median over seeds, m_ref on the finest mesh
//! e(n) = e₁ + (e₂ − e₁) ln(n/n₁)/ln(n₂/n₁)     error between two meshes of the table
//! ```

use std::collections::BTreeMap;
use std::sync::OnceLock;

use billow_solver::scene::ModelKind;
use billow_solver::scene::Scene;
use serde::{Deserialize, Serialize};

use super::coordinates::Coordinates;
use super::entry::{Entry, Limit, Method, RelativeError};
use super::features::{Coverage, Features};
use super::promised::Promised;

/// Name of the format.
pub const FORMAT: &str = "billow-mesh-errors";
/// Version of the format that this program writes and reads.
pub const VERSION: u64 = 2;

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
    /// Subdivisions of the finest mesh.
    pub reference: u32,
    /// The scenes that it covers.
    pub coverage: Coverage,
    /// The coordinates of the biases.
    pub coordinates: Coordinates,
    /// The limit of each measure.
    pub limits: BTreeMap<String, Limit>,
    /// The errors.
    pub errors: Vec<Entry>,
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
        let single = self.errors.iter().filter_map(|entry| match entry.meshes[..] {
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
        let limit = self.limits.get(measure).filter(|limit| limit.known && promised.has_limit);
        let (values, coordinates) = (&features.values, &self.coordinates);
        let of_entry = |entry: &Entry| entry.error(values, coordinates, limit);
        let covers = |entry: &&Entry| entry.covers(values, coordinates);
        if let Some(entry) = self.entry(method, measure).filter(covers) {
            return Ok(of_entry(entry));
        }
        let no_runs = || format!("{}: the table has no such runs of such scenes", method.name());
        let [n] = method.meshes[..] else { return Err(no_runs()) };
        let of_model = |entry: &&Entry| entry.model == method.model && entry.measure == measure;
        let known = self.errors.iter().filter(of_model).filter(covers);
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
            let [coarse, fine] = [coarse_entry, fine_entry].map(|entry| of_entry(entry));
            let between = |coarse: f64, fine: f64| coarse + part * (fine - coarse);
            return Ok(RelativeError {
                of_reference: between(coarse.of_reference, fine.of_reference),
                of_itself: between(coarse.of_itself, fine.of_itself),
            });
        }
        Err(match (known.first(), known.last()) {
            (Some((first, _)), Some((last, _))) => {
                format!("design.subdivisions {n}: for such scenes the table has {first} to {last}")
            }
            _ => no_runs(),
        })
    }

    /// Bias of film on a mesh against the finest mesh, for a scene that is covered; `None` where the table has no such
    /// runs.
    pub fn bias(&self, n: u32, measure: &str, features: &Features) -> Option<f64> {
        if n == self.reference {
            return Some(0.0);
        }
        let entry = self.entry(&Method { model: ModelKind::Film, meshes: vec![n] }, measure)?;
        let (values, coordinates) = (&features.values, &self.coordinates);
        entry.covers(values, coordinates).then(|| entry.bias(values, coordinates))
    }

    /// The entry of a method, as it stands in the table.
    pub fn entry(&self, method: &Method, measure: &str) -> Option<&Entry> {
        let is = |entry: &&Entry| {
            entry.model == method.model && entry.meshes == method.meshes && entry.measure == measure
        };
        self.errors.iter().find(is)
    }
}
