//! Time histories: one column per quantity, one row per sample.

use serde::{Deserialize, Serialize};

use crate::output::ledger::{GasBalance, Ledger};

/// The sampled quantities of a model at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sample {
    /// Time since the start of the run, s.
    pub time: f64,
    /// Height of the top centre node, m.
    pub z_centre: f64,
    /// Mean height of the top ring, m.
    pub z_rim: f64,
    /// Largest height of any node, m.
    pub z_max: f64,
    /// Height of the whole film, from its lowest to its highest node, m.
    #[serde(default)]
    pub height: f64,
    /// Mean velocity of the top ring along z, m/s.
    pub vz: f64,
    /// Enclosed volume, m³.
    pub volume: f64,
    /// Gas pressure, Pa.
    pub pressure: f64,
    /// Gas temperature, K.
    pub temperature: f64,
    /// Force of the film on the packing lid, N; 0 after release.
    pub lid_force: f64,
    /// Impulse along z on the film of all that holds it (supports, lid, floor) since time 0, N s.
    pub support_impulse: f64,
    /// Energy ledger of the film.
    pub ledger: Ledger,
    /// Mass and energy balance of the gas.
    pub gas: GasBalance,
    /// Passages of film through film counted so far.
    pub passages: u64,
    /// Intersections of the mesh now.
    pub intersections: u64,
}

/// The time series of a run, one sample every [`crate::scene::Outputs::sample_interval`]. All stored
/// columns have the length of `time`.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Columns in the order of [`COLUMNS`].
    columns: Vec<Vec<f64>>,
    /// Whether [`RING_COLUMNS`] are filled, and [`HEIGHT`] is not.
    rings: bool,
}

/// Columns that only a capsule has: film without rings leaves them out.
pub const RING_COLUMNS: [&str; 3] = ["z_centre", "z_rim", "vz"];

/// The column that only film without rings has.
pub const HEIGHT: &str = "height";

/// A further time series beside [`COLUMNS`], at the same times: for example the position of a node or the
/// membrane force of an element.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Name, as in the file.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// Meaning, one line.
    pub meaning: &'static str,
    /// One value per sample.
    pub values: Vec<f64>,
}

/// Name, unit and meaning of a history column.
#[derive(Debug, Clone, Copy)]
pub struct HistoryColumn {
    /// Name, as in the file.
    pub name: &'static str,
    /// SI unit; "1" for a pure number.
    pub unit: &'static str,
    /// Meaning, one line.
    pub meaning: &'static str,
    /// Its value in a sample.
    value: fn(&Sample) -> f64,
}

macro_rules! columns {
    ($($name:literal [$unit:literal] $meaning:literal, $value:expr);+ $(;)?) => {
        /// All columns of a history, in stored order.
        pub const COLUMNS: &[HistoryColumn] =
            &[$(HistoryColumn { name: $name, unit: $unit, meaning: $meaning, value: $value }),+];
    };
}

// The residuals follow from the whole series: [`History::of`].
columns! {
    "time" ["s"] "time since the start of the run", |s| s.time;
    "z_centre" ["m"] "height of the top centre node", |s| s.z_centre;
    "z_rim" ["m"] "mean height of the top ring", |s| s.z_rim;
    "z_max" ["m"] "largest height of any node", |s| s.z_max;
    "height" ["m"] "height of the whole film, from its lowest to its highest node", |s| s.height;
    "vz" ["m/s"] "mean velocity of the top ring along z", |s| s.vz;
    "volume" ["m3"] "enclosed volume", |s| s.volume;
    "pressure" ["Pa"] "gas pressure", |s| s.pressure;
    "temperature" ["K"] "gas temperature (film temperature while there is no gas)", |s| s.temperature;
    "gas_mass" ["kg"] "gas inside", |s| s.gas.mass;
    "lid_force" ["N"] "force of the film on the packing lid", |s| s.lid_force;
    "support_impulse" ["N s"] "impulse along z on the film of all that holds it (supports, lid, floor) since time 0",
        |s| s.support_impulse;
    "kinetic_energy" ["J"] "kinetic energy of the film", |s| s.ledger.kinetic;
    "strain_energy" ["J"] "energy stored in the film: elastic, and of creep", |s| s.ledger.strain;
    "contact_energy" ["J"] "elastic energy of contact: minus the work of contact forces since time 0",
        |s| s.ledger.contact;
    "gas_work" ["J"] "work of the gas on the film since time 0", |s| s.ledger.gas_work;
    "ambient_work" ["J"] "work of the ambient pressure on the film since time 0", |s| s.ledger.ambient_work;
    "gravity_work" ["J"] "work of gravity on the film since time 0", |s| s.ledger.gravity_work;
    "support_work" ["J"] "work of moving supports and plates on the film since time 0", |s| s.ledger.support_work;
    "material_loss" ["J"] "energy lost in the film's material since time 0", |s| s.ledger.material_loss;
    "numerical_dissipation" ["J"] "energy taken by numerical damping and time step since time 0",
        |s| s.ledger.numerical_dissipation;
    "friction_work" ["J"] "energy dissipated by friction and by collision impulses since time 0",
        |s| s.ledger.contact_dissipation;
    "damping_work" ["J"] "energy dissipated by mass damping since time 0", |s| s.ledger.damping_work;
    "heat" ["J"] "heat from the film to the gas since time 0", |s| s.gas.heat;
    "enthalpy_in" ["J"] "enthalpy let in since time 0", |s| s.gas.enthalpy_in;
    "enthalpy_out" ["J"] "enthalpy leaked since time 0, negative where gas entered through the leak",
        |s| s.gas.enthalpy_out;
    "ledger_residual" ["1"] "energy ledger residual: energy error over the energy moved so far", |_| 0.0;
    "gas_residual" ["1"] "gas balance residual: the larger relative error of mass and energy", |_| 0.0;
    "passages" ["1"] "passages of film through film counted so far", |s| s.passages as f64;
    "intersections" ["1"] "intersections of the mesh at this sample", |s| s.intersections as f64;
}

impl Default for History {
    fn default() -> Self {
        Self::new()
    }
}

impl History {
    /// An empty history.
    pub fn new() -> Self {
        Self { columns: vec![Vec::new(); COLUMNS.len()], rings: true }
    }

    /// This history without [`RING_COLUMNS`].
    #[must_use]
    pub fn without_rings(mut self) -> Self {
        self.rings = false;
        for (column, values) in COLUMNS.iter().zip(&mut self.columns) {
            if RING_COLUMNS.contains(&column.name) {
                values.clear();
            }
        }
        self
    }

    /// Whether it is that of a capsule.
    pub fn has_rings(&self) -> bool {
        self.rings
    }

    /// Whether it has a column.
    pub fn has(&self, name: &str) -> bool {
        if self.rings { name != HEIGHT } else { !RING_COLUMNS.contains(&name) }
    }

    /// The history of a series of samples. Both residuals use the whole series.
    pub fn of(samples: &[Sample]) -> Self {
        let ledgers: Vec<Ledger> = samples.iter().map(|sample| sample.ledger).collect();
        let gas_balances: Vec<GasBalance> = samples.iter().map(|sample| sample.gas).collect();
        let residuals = crate::output::ledger::residuals(&ledgers);
        let gas_residuals = crate::output::ledger::gas_residuals(&gas_balances);
        let column = |column: &HistoryColumn| match column.name {
            "ledger_residual" => residuals.clone(),
            "gas_residual" => gas_residuals.clone(),
            _ => samples.iter().map(column.value).collect(),
        };
        Self { columns: COLUMNS.iter().map(column).collect(), rings: true }
    }

    /// Appends one sample: values in the order of [`COLUMNS`].
    pub fn push(&mut self, sample: &[f64; COLUMNS.len()]) {
        for (column, value) in self.columns.iter_mut().zip(sample) {
            column.push(*value);
        }
    }

    /// The column of that name; empty if it is left out.
    ///
    /// # Panics
    /// If no column has that name: names are fixed at compile time, so this is an error in the code.
    pub fn column(&self, name: &str) -> &[f64] {
        let index = COLUMNS.iter().position(|column| column.name == name);
        &self.columns[index.unwrap_or_else(|| panic!("no history column {name:?}"))]
    }

    /// Leaves out the columns that are not named, and frees their memory.
    pub fn keep(&mut self, names: &[&str]) {
        for (column, values) in COLUMNS.iter().zip(&mut self.columns) {
            if !names.contains(&column.name) {
                *values = Vec::new();
            }
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Columns with their names, in stored order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static HistoryColumn, &[f64])> {
        let all = COLUMNS.iter().zip(self.columns.iter().map(Vec::as_slice));
        all.filter(|(column, _)| self.has(column.name))
    }
}
