//! Time histories: one column a quantity, one row a sample.

/// The series a run leaves, sampled at [`crate::scene::Outputs::sample_interval`]. Every column
/// has the length of `time`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct History {
    /// Columns in the order of [`COLUMNS`].
    columns: Vec<Vec<f64>>,
}

/// Name, unit and meaning of a history column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HistoryColumn {
    /// Name, as in the file.
    pub name: &'static str,
    /// SI unit; "1" for a pure number.
    pub unit: &'static str,
    /// Meaning, one line.
    pub meaning: &'static str,
}

macro_rules! columns {
    ($($name:literal [$unit:literal] $meaning:literal),+ $(,)?) => {
        /// Every column of a history, in stored order.
        pub const COLUMNS: &[HistoryColumn] = &[$(HistoryColumn { name: $name, unit: $unit, meaning: $meaning }),+];
    };
}

columns! {
    "time" ["s"] "time since the start of the run",
    "z_centre" ["m"] "height of the top centre node",
    "z_rim" ["m"] "mean height of the top ring",
    "z_max" ["m"] "largest height of any node",
    "vz" ["m/s"] "velocity of the top centre node along z",
    "volume" ["m3"] "enclosed volume",
    "pressure" ["Pa"] "gas pressure",
    "temperature" ["K"] "gas temperature (film temperature while there is no gas)",
    "gas_mass" ["kg"] "gas inside",
    "lid_force" ["N"] "force on the packing lid",
    "kinetic_energy" ["J"] "kinetic energy of the film",
    "strain_energy" ["J"] "elastic energy of the film",
    "contact_energy" ["J"] "elastic energy of contact",
    "gas_work" ["J"] "work of the gas on the film since time 0",
    "ambient_work" ["J"] "work of the ambient pressure on the film since time 0",
    "gravity_work" ["J"] "work of gravity on the film since time 0",
    "support_work" ["J"] "work of moving supports and the lid on the film since time 0",
    "viscous_work" ["J"] "energy dissipated by film viscosity since time 0",
    "friction_work" ["J"] "energy dissipated by friction since time 0",
    "heat" ["J"] "heat given by the film to the gas since time 0",
    "enthalpy_in" ["J"] "enthalpy let in since time 0",
    "enthalpy_out" ["J"] "enthalpy leaked since time 0",
    "ledger_residual" ["1"] "energy ledger residual over the energy moved so far",
    "gas_residual" ["1"] "gas energy and mass balance residual, relative",
    "passages" ["1"] "film through film counted so far",
    "intersections" ["1"] "intersections of the mesh at this sample",
}

impl History {
    /// An empty history.
    pub fn new() -> Self {
        Self { columns: vec![Vec::new(); COLUMNS.len()] }
    }

    /// Appends one sample: values in the order of [`COLUMNS`].
    pub fn push(&mut self, sample: &[f64; COLUMNS.len()]) {
        for (column, value) in self.columns.iter_mut().zip(sample) {
            column.push(*value);
        }
    }

    /// The column of that name.
    ///
    /// # Panics
    /// When no column has that name: names are fixed at compile time, so that is a mistake in code.
    pub fn column(&self, name: &str) -> &[f64] {
        let index = COLUMNS.iter().position(|column| column.name == name);
        &self.columns[index.unwrap_or_else(|| panic!("no history column {name:?}"))]
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Whether there is no sample yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Columns with their names, in stored order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static HistoryColumn, &[f64])> {
        COLUMNS.iter().zip(self.columns.iter().map(Vec::as_slice))
    }
}
