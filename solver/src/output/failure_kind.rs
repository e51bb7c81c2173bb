//! The kinds of failure a run can end in, by name.

/// The kinds of failure a run can end in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailureKind {
    /// A step was unstable: the state is not finite, or its energy grew without a source.
    Unstable,
    /// The film is stretched beyond the validity of its material model; its energy balances.
    Overstretched,
    /// The energy ledger residual is above its bound
    /// ([`MAX_LEDGER_RESIDUAL`](super::audit::MAX_LEDGER_RESIDUAL)).
    EnergyDrift,
    /// The enclosed volume is zero or negative.
    InvertedVolume,
    /// The run needs more steps than allowed, or a step is too small to advance time.
    StepLimit,
    /// Film passed through film.
    Interpenetrated,
    /// The state contradicts itself: a defect of the program or of the machine.
    Inconsistent,
}

impl FailureKind {
    /// Every kind, in the order of the documentation.
    pub const ALL: [Self; 7] = [
        Self::Unstable,
        Self::Overstretched,
        Self::EnergyDrift,
        Self::InvertedVolume,
        Self::StepLimit,
        Self::Interpenetrated,
        Self::Inconsistent,
    ];

    /// Name, as in the `status` column of the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unstable => "unstable",
            Self::Overstretched => "overstretched",
            Self::EnergyDrift => "energy_drift",
            Self::InvertedVolume => "inverted_volume",
            Self::StepLimit => "step_limit",
            Self::Interpenetrated => "interpenetrated",
            Self::Inconsistent => "inconsistent",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}
